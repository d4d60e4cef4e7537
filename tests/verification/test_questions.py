"""What the questions of the audit rest on: invariants, Poisson tensor, windows, pieces, the page."""

import dataclasses
import json

import numpy as np
import pytest

import contenders
import drift
import liepoisson as lp
import pages
import poisson_defect
import problems
import run
import store
import summary


@pytest.mark.parametrize("name", problems.TOPS)
def test_poisson_tensor_and_invariants_are_those_of_the_bracket(name):
    """x' = J grad H, J grad C = 0; central differences of the invariants are exact, since these are quadratic."""
    top, x = problems.TOPS[name], problems.starts(name, 1)[0]
    J = problems.poisson_tensor(top, x)
    ahead, behind = (problems.invariants(top, x + sign * np.eye(9)) for sign in (1, -1))
    gradients = {key: np.asarray((ahead[key] - behind[key]) / 2, dtype=float) for key in ahead}
    velocity = np.asarray(J, dtype=float) @ gradients["H"]
    assert velocity == pytest.approx(top.vector_field(x), abs=1e-14)
    for key in ("C1", "C2", "C3"):
        assert np.abs(J @ gradients[key]).max() < 1e-14
    for key in set(gradients) - {"C1", "C2", "C3"}:
        assert abs(gradients[key] @ velocity) < 1e-14


def test_the_exact_flow_has_no_defect_and_a_damped_one_has():
    top = problems.TOPS["general"]
    x0 = problems.starts("general", 4)
    orbit = problems.integrate(top, x0, [0.0, 2.0], lp.Taylor(), tangents=np.eye(9))
    state, tangents = orbit.state[:, -1], orbit.tangent[:, -1]
    assert poisson_defect.defect(top, x0, state, tangents).max() < 1e-13  # measured: 1e-14
    assert poisson_defect.defect(top, x0, state, 0.999 * tangents) == pytest.approx(1 - 0.999**2)


def test_windows_cover_the_run_without_overlap():
    edges, inside = drift.windows(1_000_000)
    samples = np.concatenate(inside)
    assert edges[-1] == samples[-1] == 1_000_000
    assert (np.diff(samples) > 0).all()
    assert all(
        low < window[0] <= window[-1] == high for low, high, window in zip(edges, edges[1:], inside, strict=False)
    )


def test_a_run_in_pieces_is_the_run_and_resumes(tmp_path, monkeypatch):
    """Cut at other places, the same states to round-off; a second time, nothing is integrated."""
    run, samples = drift.Run(contenders.TAYLOR, 1e-15, 0.25), np.array([3, 40, 41, 100])
    whole = drift.trajectory("twisted Lagrange", run, samples, 4, store.Store(tmp_path / "whole"))
    monkeypatch.setattr(drift, "WORK_OF_A_PIECE", 4 * 30)
    kept = store.Store(tmp_path / "pieces")
    pieces = drift.trajectory("twisted Lagrange", run, samples, 4, kept)
    assert len(list(kept.folder.iterdir())) == 4
    assert pieces["states"] == pytest.approx(whole["states"], abs=1e-12)
    assert (np.abs(pieces["n_steps"] - whole["n_steps"]) <= 4).all()
    monkeypatch.setattr(drift, "integrate", None)
    again = drift.trajectory("twisted Lagrange", run, samples, 4, kept)
    assert np.array_equal(again["states"], pieces["states"])


def test_a_member_that_fails_stays_out_and_the_others_go_on(tmp_path, monkeypatch):
    """One start cannot finish within the steps that it is given; from then on it is NaN, and a failure in the count."""
    limited = dataclasses.replace(contenders.TAYLOR, make=lambda tol: lp.Taylor(tol=tol, max_steps=200))
    x0 = problems.starts("twisted Lagrange", 4)
    x0[2] *= 50
    monkeypatch.setattr(drift, "starts", lambda top, n: x0)
    monkeypatch.setattr(drift, "WORK_OF_A_PIECE", 4 * 50)
    found = drift.trajectory(
        "twisted Lagrange", drift.Run(limited, 1e-15, 0.25), np.array([10, 150]), 4, store.Store(tmp_path)
    )
    assert np.isnan(found["states"][2, -1]).all()
    assert np.isfinite(found["states"][[0, 1, 3]]).all()


def test_a_table_replaces_what_stands_between_its_markers(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- audit: orders -->\nold\n<!-- end: orders -->\nafter\n")
    pages.put(page, "orders", "| new |\n")
    pages.put(page, "orders", "| new |\n")
    assert page.read_text() == "before\n<!-- audit: orders -->\n| new |\n<!-- end: orders -->\nafter\n"
    with pytest.raises(pages.MissingMarkerError, match="audit: drift"):
        pages.put(page, "drift", "x")


def test_the_page_and_the_tables_show_what_the_results_say():
    results = json.loads((run.DOCS / "verification" / "results.json").read_text(encoding="utf-8"))
    page = (run.DOCS / "verification.md").read_text(encoding="utf-8")
    tables = run.tables_of(run.DOCS).read_text(encoding="utf-8")
    assert summary.table(results) in page
    for name, question in run.QUESTIONS.items():
        assert question.table(results[name]["result"]) in (page if name in run.ON_THE_PAGE else tables), name
