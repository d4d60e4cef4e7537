"""Benchmarks: the page says what the files in benchmarks/processors/ say; both sides have the same equations."""

import copy
import re
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from script_folders import modules_of

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "benchmarks"


NAMES = "report", "processors", "kernels", "measure", "general", "general_problems", "general_liepoisson_worker"
report, processors, kernels, measure, general, problems, worker = modules_of(FOLDER, *NAMES)
FILES = processors.load()
KNOWN = next(one for one in FILES if one["processor"]["vendor_id"] == "GenuineIntel")
BLOCK = re.compile(r"<!-- table ([\w.-]+) -->\n(.*?)<!-- end of table -->", re.DOTALL)


def page(*documents):
    texts = [document.read_text(encoding="utf-8") for document in documents or (report.DOCUMENT, report.DETAILS)]
    return dict(BLOCK.findall("".join(texts)))


def test_the_page_shows_what_the_files_say():
    shown = page()
    for name, text in report.blocks({}, FILES).items():
        assert shown[name] == f"\n{text}\n", name


def row(seconds, model):
    """A table of the ensembles as `run.py` writes it: who, of what kind, with which instructions, and how long."""
    measured = []
    for (name, kind, simd), times in seconds.items():
        request = {"method": {"tol": 1e-13, "name": name.removesuffix(", AVX2")}}
        setting = {"request": request, "order": 20, "state": 2e-14, "tangent": 3e-14, "meets": True}
        contender = {"name": name, "side": name.split()[0].strip(","), "kind": kind, "simd": simd, "work": None}
        contender |= {"request": request, "setting": setting}
        measured.append({"contender": contender, "seconds": times, "answers": [{}]})
    facts = copy.deepcopy(KNOWN["facts"]) | {"date": "2099-01-02T03:04"}
    facts["processor"]["model"] = model
    head = {"kind": "row", "title": "Ensemble", "work": 1e5, "wall": False, "absent": {}, "rounds": 3}
    return head | {"measured": measured, "facts": facts}


SECONDS = {
    ("heyoka", "", None): [2.0, 2.2, 2.4],
    ("heyoka, fast_math", "", None): [1.0, 1.2, 1.5],
    ("liepoisson Taylor", "double", None): [0.5, 0.5, 0.5],
    ("liepoisson Taylor, mixed precision", "mixed", None): [0.25, 0.2, 0.25],
    ("liepoisson Taylor, both errors at most heyoka's", "", None): [0.1, 0.1, 0.1],
    ("liepoisson Taylor, AVX2", "", "avx2"): [2.0, 2.0, 2.0],
}


def test_a_new_run_renews_its_own_rows_and_takes_the_head(tmp_path):
    folder, documents = tmp_path / "processors", [tmp_path / "benchmarks.md", tmp_path / "tables.md"]
    shutil.copytree(processors.FOLDER, folder)
    for document, known in zip(documents, (report.DOCUMENT, report.DETAILS), strict=True):
        shutil.copy(known, document)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    tables = {"1e-13": row(SECONDS, model="999")}
    assert processors.update(folder, tables) == ["genuineintel-6-999.json"]
    assert all((folder / name).read_bytes() == content for name, content in before.items())
    files = processors.load(folder)
    found = next(one for one in files if one["processor"]["model"] == "999")["rows"]["1e-13"]["lines"]
    said = [(line["kind"], line["simd"], line["ratios"]["rounds"], line["heyoka"]["name"]) for line in found]
    peer = "heyoka, fast_math"
    assert said == [("double", "avx512", 2.4, peer), ("mixed", "avx512", 6.0, peer), ("double", "avx2", 0.6, peer)]

    for document in documents:
        report.write_document(document, report.blocks(tables, files))
    shown = page(*documents)
    assert "The detailed tables are of GenuineIntel family 6 model 999" in shown["head"]
    assert shown["summary"].startswith("\nMeasured on GenuineIntel family 6 model 999, 2099-01-02.")
    assert "model 999" in shown["environment"]
    assert "model 999" in shown["1e-13"]
    first = shown["processors"].splitlines()
    cells = dict(zip(first[3].split(" | "), first[5].split(" | "), strict=True))
    assert cells["GenuineIntel family 6 model 999, AVX-512"] == "2.40"
    assert {ratio for column, ratio in cells.items() if column.startswith("GenuineIntel family 6 model 999, AVX2")} == {
        "**0.60** |"
    }
    for name, text in page().items():  # what was not measured again stays, with its processor
        if name not in ("head", "summary", "environment", "processors", "1e-13"):
            assert shown[name] == text, name


def test_an_older_table_does_not_replace_a_newer_row(tmp_path):
    processors.update(tmp_path, {"1e-13": row(SECONDS, model="999")})
    old = row({name: [10.0] for name in SECONDS}, model="999")
    old["facts"]["date"] = "2098-01-01"
    written = (tmp_path / "genuineintel-6-999.json").read_bytes()
    processors.update(tmp_path, {"1e-13": old})
    assert (tmp_path / "genuineintel-6-999.json").read_bytes() == written


def test_mixed_precision_does_less_than_double():
    order, tol = 22, 5.6e-14
    mixed, double = kernels.mixed_taylor_operations(order, tol), kernels.taylor_operations(order)
    assert mixed["f64"] < 0.2 * double  # the state up to half the order is a quarter of a third
    assert 0.3 * double < sum(mixed.values()) < 0.8 * double


def test_a_kernel_of_two_precisions_is_compared_with_both_peaks():
    request = {"method": {"tol": 1e-9}}
    contender = {"name": "Mixed, avx512", "simd": "avx512", "setting": {"request": request}}
    one = {"contender": contender, "seconds": [6.0, 5.0], "answers": [{"n_steps": 10**9}]}
    data = {
        "peaks": {"avx512 f64": 100.0, "avx512 f32": 200.0},
        "operations": {"Mixed, avx512": {"f64": 100, "f32": 300}},
    }
    facts = {"date": "2099-01-01"}
    reached = processors.peak_of(data | {"measured": [one], "rounds": 2}, facts)["reached"]
    # at the peaks a step would take 1 + 1.5 ns, and it takes 5
    assert reached == [{"kernel": "Mixed", "simd": "avx512", "gflops": 80.0, "fraction": 0.5}]
    assert kernels.lines(data | {"measured": [one]})[1][2:] == ["5.0", "80.0", "160.0 (avx512 f64 and f32)", "50%"]


def test_typed_systems_have_tables_of_their_own(tmp_path):
    name = "general-toda-8-1e-8"
    seconds = {
        ("heyoka, batch 8", "", None): [2.0, 2.0, 2.0],
        ("liepoisson RungeKutta", "double", None): [1.0, 1.0, 1.0],
        ("liepoisson RungeKutta, not compiled", "not compiled", None): [4.0, 4.0, 4.0],
        ("liepoisson Taylor, avx2", "double", "avx2"): [4.0, 4.0, 4.0],
    }
    table = row(seconds, model="999")
    table["facts"]["commit"] = "abc"
    largest = {what: {"error": 7e-12, "start": 3, "growth": 2.0} for what in ("state", "tangent")}
    for k, one in enumerate(table["measured"]):
        one["contender"]["setting"] |= {"largest": largest, "cold": 0.0 if k else 0.5}
        one["answers"] = [{"cold": 0.3}, {"cold": 0.25}]
    processors.update(tmp_path, {name: table})
    found = report.blocks({name: table}, [*FILES, *processors.load(tmp_path)])
    assert name not in found
    assert name not in found["processors"]
    assert "AVX-512; rows: 1, median 2.00, least 2.00." in found["general"]
    assert "| Toda chain of 8 |  | 2.00 RungeKutta (0.50) |  |  |" in found["general"]
    assert "| Toda chain of 8 |  | **0.50** Taylor |  |  |" in found["general"]
    sides = ("RungeKutta, tol 1.0e-13 | 2.0e-14 / 3.0e-14 | 7.0e-12 / 7.0e-12 | 1 s | 250 ms",)
    sides += ("batch 8, tol 1.0e-13 | 2.0e-14 / 3.0e-14 | 7.0e-12 / 7.0e-12 | 2 s | 500 ms",)
    assert f"| toda-8-1e-8 | {' | '.join(sides)} | 2.00 / 2.00 / 2.00 |" in found["general-details"]


QUADRATIC = {"henon-heiles", "manakov-so4", "euler-su5", "twisted-top"}  # as the page says
each_problem = pytest.mark.parametrize("name", problems.PROBLEMS)


@each_problem
def test_both_sides_have_the_same_equations(name):
    one = problems.PROBLEMS[name]
    states = problems.starts(one, 20)[:, : one.n]
    typed = one.typed(lp).vector_field(states)
    by_hand = np.stack([np.broadcast_to(rate, 20) for rate in one.rates(list(states.T), np)], axis=1)
    off = np.linalg.norm(typed - by_hand, axis=1) / np.linalg.norm(typed, axis=1)
    assert off.max() < 1e-14  # measured: 2e-15


def derivative(one, x):
    """The rates of states and tangent vectors, shape (n_starts, 2 n), as heyoka is given them."""
    both = list(x.T)
    rates = problems.rates_with_tangent(one, both[: one.n], both[one.n :], np)
    return np.stack([np.broadcast_to(rate, len(x)) for rate in rates], axis=1)


@each_problem
def test_tangent_vectors_have_the_derivative_of_the_equations(name):
    one = problems.PROBLEMS[name]
    x, v = np.split(problems.starts(one, 20), 2, axis=1)
    shifted = list((x + 1e-30j * v).T)  # the imaginary part is the derivative along v, times 1e-30
    slopes = np.stack([np.broadcast_to(rate, 20).imag * 1e30 for rate in one.rates(shifted, np)], axis=1)
    off = np.linalg.norm(derivative(one, np.hstack([x, v]))[:, one.n :] - slopes, axis=1)
    assert (off / np.linalg.norm(slopes, axis=1)).max() < 1e-13  # measured: 5e-15


def fourth_order(rate, x, t_end, n_steps):
    """The classical method of Runge and Kutta."""
    h = t_end / n_steps
    for _ in range(n_steps):
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3))
    return x


@each_problem
@pytest.mark.parametrize("tangent", [True, False])
def test_the_worker_follows_them(name, tangent, tmp_path):
    one, data = problems.PROBLEMS[name], problems.starts(problems.PROBLEMS[name], 5)
    np.save(tmp_path / "starts.npy", data)
    request = {"system": name, "problem": str(tmp_path / "starts.npy"), "tangent": tangent}
    request |= {"t_end": 0.1, "t_accuracy": 0.1, "repeats": 2, "out": str(tmp_path / "found.npy")}
    methods = [{"method": {"name": family.method, "tol": 1e-11}} for family in general.FAMILIES]
    refused = {"method": {"name": "RungeKutta", "tol": 1e-17}}
    settings = worker.scan(request | {"methods": [*methods, refused]})["settings"]
    assert [setting["request"] for setting in settings] == methods
    exact = fourth_order(partial(derivative, one), data, 0.1, 100)[:, : (2 if tangent else 1) * one.n]
    for ends in np.load(tmp_path / "found.npy"):
        assert problems.problem.relative_error(ends, exact).max() < 1e-7
    answer = worker.run(request | methods[0])
    assert len(answer["seconds"]) == 2
    assert 0 < max(answer["seconds"]) < answer["cold"]
    assert answer["field"] == ("quadratic" if name in QUADRATIC else "tape")


@pytest.mark.thorough
@pytest.mark.skipif(not measure.PYTHON["heyoka"].exists(), reason="heyoka.py is not installed: make bench installs it")
@pytest.mark.parametrize("name", ["general-double-pendulum-1e-8", "general-henon-heiles-1e-13-one"])
def test_a_small_row_beside_heyoka(name, tmp_path, monkeypatch):
    system = problems.ROWS[name][0]
    monkeypatch.setitem(
        general.PROBLEMS, system, replace(problems.PROBLEMS[system], t_accuracy=1.0, t_end=2.0, t_one=5.0)
    )
    monkeypatch.setattr(general, "SEARCHES", tmp_path)
    monkeypatch.setattr(general, "ORDERS", range(8, 20, 2))
    monkeypatch.setattr(general, "FLAGS", [{"fast_math": True, "compact_mode": True}])
    facts = copy.deepcopy(KNOWN["facts"]) | {"date": "2099-01-02T03:04", "commit": "abc"}
    bench = general.Bench(system, 16, facts)
    assert bench.search["reference_error"] < 1e-16
    found = bench.row(name, [None])
    peer, ours, plain = found.contenders
    assert peer.setting["meets"]
    assert ours.setting["meets"]
    assert all(ours.setting[what] <= max(peer.setting[what], general.ROUND_OFF) for what in ("state", "tangent"))
    data = report.record(found, measure.run_row(found, 2), 2)
    assert [len(one["seconds"]) for one in data["measured"]] == [2, 2, 2]
    assert not any(answer["kernel"].endswith("compiled") for answer in data["measured"][2]["answers"])
    assert plain.kind == processors.row_of(data, facts)["lines"][1]["kind"]
    again = general.Bench(system, 16, facts)  # what was searched is kept
    assert again.search == bench.search
