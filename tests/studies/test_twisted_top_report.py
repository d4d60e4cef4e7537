"""The whole study of the twisted top, very small: what it writes, and how the report says it."""

from __future__ import annotations

import json
import re
from types import SimpleNamespace

import pytest
from small_study import SHORT

from liepoisson.results import Estimate
from liepoisson.studies.twisted_top import PRINTED, integration, runs
from liepoisson.studies.twisted_top.claims import CLAIMS, evaluate_claims
from liepoisson.studies.twisted_top.figures import FIGURES
from liepoisson.studies.twisted_top.findings import TITLE
from liepoisson.studies.twisted_top.integration import RunStore, Tracker
from liepoisson.studies.twisted_top.measurements import measurements
from liepoisson.studies.twisted_top.report import (
    _overshoot,
    _scan_ranges,
    moments,
    power_of_ten,
    scientific,
    true_minus,
)
from liepoisson.studies.twisted_top.runs import plan
from liepoisson.studies.twisted_top.study import judge, reproduce, run_all


@pytest.fixture(scope="module")
def study(tmp_path_factory, exact_results):
    """The study and what it told; verdicts that need no run are those that the other tests look at, computed once."""
    known = {result.claim.id: result for result in exact_results if result.verdict.method != "numerical"}

    def judge(context):
        measured = iter(evaluate_claims(context, [claim for claim in CLAIMS if claim.id not in known]))
        return [known.get(claim.id) or next(measured) for claim in CLAIMS]

    out = tmp_path_factory.mktemp("study")
    heard = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liepoisson.studies.twisted_top.claims.evaluate_claims", judge)
        result = reproduce(SHORT, out, progress=lambda activity, done, total: heard.append((activity, done, total)))
    return result, heard


@pytest.mark.slow
def test_a_study_comes_to_these_verdicts_by_itself(study):
    """It checks the proof of chaos in both arithmetics, and follows loops around threads by closing flows.

    The verdicts of the tests have one arithmetic and no flows.
    """
    claims = json.loads(json.dumps(judge(study[0].measurements, SHORT)))
    shared = json.loads(json.dumps(study[0].claims))
    for document in (claims, shared):
        chaos = [entry for entry in document["claims"] if entry["id"] == "rigorous-demonstration"]
        (entry,) = chaos
        assert entry["data"].pop("arithmetics")[0] == "intervals"
        (threads,) = [other for other in document["claims"] if other["id"] == "lagrange-bifurcations"]
        for key in ("proof", "steps", "certificate", "data"):
            entry.pop(key, None)
            threads.pop(key, None)
    assert claims["claims"] == shared["claims"]


@pytest.mark.thorough
def test_study_writes_figures_data_numbers_and_report(study):
    result, _ = study
    out = result.out
    for name in FIGURES:
        for extension in ("png", "svg", "pdf"):
            assert (out / f"{name}.{extension}").stat().st_size > 5000
    assert {path.stem for path in (out / "data").glob("*.nc")} == {run.name for run in plan(SHORT)}
    numbers = json.loads((out / "measurements.json").read_text())
    assert numbers == json.loads(json.dumps(result.measurements))
    assert numbers["printed"] == PRINTED
    claims = json.loads((out / "claims.json").read_text())
    assert claims == json.loads(json.dumps(result.claims))
    assert all(claim["verdict"] != "not run" for claim in claims["claims"])


@pytest.mark.thorough
def test_measurements_follow_their_schema(study):
    numbers = study[0].measurements
    assert set(numbers) == {"schema_version", "produced_by", "printed", "runs"}
    for name, run in numbers["runs"].items():
        assert run["outcomes"] == {"finished": 50}, name
        assert set(run["mean_at"]) == {"20", "50", "100", "200"}
        for estimate in (run["fit"]["lambda"], run["fit"]["c1"], run["log_fit"]["with_next_term"]["E"]):
            assert set(estimate) == {"value", "standard_error", "low", "high"}
            assert estimate["low"] <= estimate["value"] <= estimate["high"]
        assert run["fit"]["window"] == [20.0, 200.0]
        assert sum(group["members"] for group in run["by_energy"]) == 50
        lows = [group["low"] for group in run["by_energy"]]
        assert lows == sorted(lows)
    assert numbers["produced_by"]["command"] == "liepoisson reproduce twisted-top --members 50 --end-time 200"


@pytest.mark.thorough
def test_report_is_self_contained_and_holds_every_claim(study):
    result, _ = study
    page = (result.out / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](?!data:|#)""", page)
    assert "http" not in page.replace("http://www.w3.org", "")
    assert page.count("data:image/svg+xml;base64,") == len(FIGURES)
    assert TITLE in page
    assert page.index(TITLE) < page.index('id="figure"')
    # Formulas, points, ranks and sizes that the computation printed.
    for computed in ("{{<i>l</i>₁, <i>l</i>₂}, <i>α</i>₁} = <i>α</i>₂", "|<i>α</i>|² + 2<i>ε</i> <i>l</i>·<i>β</i>"):
        assert computed in page
    assert "<td>12</td><td>3439</td><td>3431</td><td>8</td><td>8</td>" in page
    assert "the minor of <i>J</i> with rows and columns" in page
    assert "0.122" in page
    assert "{{ " not in page
    assert not re.search(r"\b(nan|inf|None)\b", re.sub(r'"data:[^"]*"', "", page))


def test_the_range_of_each_ensemble_lies_within_that_of_all():
    """The first page gives both. An ensemble with larger errors must not let in windows that the others leave out."""

    def scanned(name, *fits):
        scan = [SimpleNamespace(window=w, lambda_=v, standard_errors={"lambda": e}) for w, v, e in fits]
        return SimpleNamespace(run=SimpleNamespace(ensemble=name), scan=scan)

    exact = scanned("exact", ((5, 50), 0.2, 0.001), ((10, 50), 0.12, 0.002), ((20, 50), 0.13, 0.0045))
    rough = scanned("rough", ((10, 50), 0.11, 0.003), ((20, 50), 0.10, 0.005), ((30, 50), 0.05, 0.007))
    ranges, whole = _scan_ranges([exact, rough])
    assert whole["limit"] == 0.006
    assert (ranges["exact"]["low"], ranges["exact"]["high"]) == (0.12, 0.13)
    assert (ranges["rough"]["low"], ranges["rough"]["high"]) == (0.10, 0.11)
    assert (whole["low"], whole["high"]) == (0.10, 0.13)


@pytest.mark.thorough
def test_second_call_gives_the_same_numbers_without_integrating(study, monkeypatch):
    first, _ = study
    monkeypatch.setattr(integration, "integrate_piece", None)
    stores = [RunStore(first.out, run) for run in plan(SHORT)]
    results = run_all(stores, None, Tracker(stores, None))
    assert measurements(list(results.values()), SHORT) == first.measurements


# Words and numbers of the report


@pytest.mark.parametrize(
    ("fitted", "above", "below"), [(0.1290, True, False), (0.1257, False, False), (0.1200, False, True)]
)
def test_the_fit_is_compared_with_the_mean_beyond_its_window(fitted, above, below):
    measured = Estimate(0.12569, 0.0003, 0.1251, 0.1263)
    run = SimpleNamespace(
        run=SimpleNamespace(end_time=1000.0),
        curve=SimpleNamespace(at=lambda time: measured),
        fit=SimpleNamespace(window=(20.0, 200.0), curve=lambda time: fitted),
    )
    found = _overshoot(run)
    assert (found["continues"], found["above"], found["below"]) == (True, above, below)
    assert found["outside"] == (above or below)


def test_numbers_are_set_as_in_print():
    assert scientific(Estimate(1.04e-5, 1.3e-6, 0, 0)) == "(1.04\u00a0±\u00a00.13)\u00a0×\u00a010⁻⁵"
    assert scientific(Estimate(-2.8e-6, 2.7e-6, 0, 0)).startswith("(\u22122.80")
    assert power_of_ten(1e-13) == "10⁻¹³"
    assert power_of_ten(2.5e-9) == "2.5\u00a0×\u00a010⁻⁹"
    assert true_minus("-1.2 to x-3") == "\u22121.2 to x-3"
    assert moments(runs.KOVALEVSKAYA_HALVED) == "(1,\u00a01,\u00a0½)"
