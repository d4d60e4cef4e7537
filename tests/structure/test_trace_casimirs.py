"""Casimirs in closed form: how many, that they are those of the search, and when they stand in its place."""

import pickle
from dataclasses import replace

import pytest
import sympy as sp

from liepoisson.catalog import zeitlin
from liepoisson.formula.styles import UNICODE
from liepoisson.model.system import System
from liepoisson.report.describe import inspect
from liepoisson.structure.casimirs import shortage
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie.defining_matrices import defining_matrices
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import gl, heisenberg, se, sine, so, su
from liepoisson.structure.trace import Trace, abbreviated, traces_in
from liepoisson.structure.trace_casimirs import modulo_casimirs, replaces_search, trace_casimirs

COMPLETE = {
    "so(5)": (so(5) @ trivial(), [2, 4]),
    "so(8)": (so(8) @ trivial(), [2, 4, 4, 6]),
    "so(3,2)": (so(3, 2) @ trivial(), [2, 4]),
    "su(5)": (su(5) @ trivial(), [2, 3, 4, 5]),
    "gl(3)": (gl(3) @ trivial(), [1, 2, 3]),
    "sine(5)": (sine(5) @ trivial(), [2, 3, 4, 5]),
    "su(3) @ semidirect(3)": (su(3) @ semidirect(3), [2, 2, 2, 3, 3, 3, 3, 4]),
    "sine(3) @ leibniz(3)": (sine(3) @ leibniz(3), [2, 2, 2, 3, 3, 3]),
    "su(3) + so(4)": ((su(3) + so(4)) @ trivial(), [2, 2, 2, 3]),
}


@pytest.mark.parametrize("name", COMPLETE)
def test_they_are_all(name):
    bracket, degrees = COMPLETE[name]
    found = bracket.trace_casimirs
    assert (list(found.degrees), found.complete, found.limits) == (degrees, True, "")
    assert found.corank == bracket.corank() == len(degrees)


@pytest.mark.parametrize("algebra", [so(4), so(5), so(3, 1), gl(2), sine(3)], ids=str)
def test_they_annihilate_the_bracket_and_are_those_of_the_search(algebra):
    """As expanded polynomials of the same degrees; the search is complete for these."""
    bracket = algebra @ trivial()
    found, searched = bracket.trace_casimirs, bracket.casimir_report()
    assert (sorted(found.degrees), True) == (sorted(searched.degrees), searched.complete)
    for generator in found.generators:
        assert set(bracket.vector_field(generator.expand(trace=True))) <= {0}


def test_small_brackets_keep_polynomials():
    for bracket in (so(3) @ trivial(), so(4) @ trivial(), su(3) @ trivial(), so(5) @ leibniz(3)):
        assert not replaces_search(bracket)
    assert all(not traces_in(c) for c in (so(4) @ trivial()).casimirs())
    assert replaces_search(su(5) @ trivial())
    assert replaces_search(su(5) @ semidirect(3))
    assert not replaces_search(se(3) @ trivial())


@pytest.mark.thorough
def test_traces_stand_where_the_search_finds_fewer():
    """The eighth Casimir of su(3) @ semidirect(3) has degree 4, beyond the limits of the search."""
    bracket = su(3) @ semidirect(3)
    assert len(bracket.casimirs()) == 8
    assert str(bracket.casimirs()[-1]) == "tr(alpha**2*beta**2)"
    assert bracket.casimir_report().complete


@pytest.mark.thorough
def test_symbols_are_generic_and_the_strength_is_examined():
    report = (su(5) @ leibniz(3, "epsilon")).casimir_report()
    epsilon = sp.Symbol("epsilon")
    assert (report.complete, report.examined) == (True, ("epsilon = 0",))
    assert report.generators[0].coeff(epsilon).has(Trace)
    (case,) = report.exceptional
    assert case.condition == "epsilon = 0"
    assert case.jumps
    special = (su(5) @ leibniz(3, "1/3")).casimirs()
    assert [g.subs(epsilon, sp.Rational(1, 3)) for g in report.generators] == special


def test_an_algebra_with_the_matrices_of_another_is_refused():
    """The negative control: so(4) with one sign of its structure constants changed still calls itself so(4)."""
    brackets = {pair: dict(row) for pair, row in so(4).brackets.items()}
    (k,) = brackets[0, 1]
    brackets[0, 1][k] = -brackets[0, 1][k]
    wrong = LieAlgebra.from_brackets(6, brackets, check=False)
    wrong.family = so(4).family
    assert trace_casimirs(wrong @ trivial()) is None


def scaled(matrix, factor, turn=0):
    return {place: tuple((factor * q, (a + turn) % 12) for q, a in roots) for place, roots in matrix.items()}


@pytest.mark.parametrize("algebra", [so(4), so(3, 1), su(3), gl(2), sine(3)], ids=str)
def test_matrices_move_by_conjugation_and_wrong_ones_are_refused(algebra):
    """One with a wrong sign, or all that move: then X moves backwards."""
    right = defining_matrices(algebra)
    first, second, *others = right.matrices
    assert right.defect(algebra) == ""
    assert "is not the combination" in replace(right, matrices=(first, scaled(second, -1), *others)).defect(algebra)
    backwards = {j: scaled(matrix, -1) for j, matrix in right.movers.items()}
    assert "is not the combination" in replace(right, movers=backwards).defect(algebra)


def test_matrices_of_other_fields_and_algebras_are_refused():
    """The modes (1, 0) alone commute with each other: they generate two dimensions of 8."""
    right = defining_matrices(sine(3))
    turned = (scaled(right.matrices[0], 1, turn=4), *right.matrices[1:])
    assert replace(right, matrices=turned).defect(sine(3)) != ""
    assert "do not generate" in replace(right, movers={j: right.movers[j] for j in (0, 1)}).defect(sine(3))
    assert "field" in right.defect(su(3))
    assert defining_matrices(so(4)).defect(so(3, 1)) != ""  # of the same dimension and names


def test_casimirs_commute_with_everything():
    bracket = su(5) @ trivial()
    x, C = bracket.variables, bracket.casimirs()[2]
    h = x[0] ** 2 * x[3] + x[7] * x[20]
    assert [bracket(C, h), bracket(h, C), bracket(C**2 + C, h)] == [0, 0, 0]
    assert bracket(C * x[0], h) == (C * bracket(x[0], h)).expand()


@pytest.mark.thorough
def test_inspect_tells_traces_and_what_their_matrix_is():
    report = inspect(zeitlin(5))
    text, record = report.text(UNICODE), report.record()
    assert all(line in text for line in ("C₁ = tr(w²)", "C₄ = tr(w⁵)", "complete: 4 independent", "rank 20, corank 4"))
    assert "with w = sum of w_n T_n" in text
    assert r"\operatorname{tr}\left(\boldsymbol{w}^{5}\right)" in report.latex()
    casimirs = record["casimirs"]
    assert (casimirs["complete"], casimirs["verified"], len(casimirs["matrices"])) == (True, True, 1)
    assert "expression" not in casimirs["generators"][0]  # the grammar of system files has no traces
    assert record["rank"] == {"lower": 20, "upper": 20, "corank": 4, "proved": True}


def test_reports_say_that_functions_on_leaves_are_missing():
    """[e1, e3] = e1, [e2, e3] = e2/2: no polynomial is constant on its leaves."""
    bracket = LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: "1/2"}}) @ trivial()
    assert [stratum.complete for stratum in bracket.strata()] == [False, True]
    assert shortage(bracket) == "only 0 of 1 independent Casimirs known"
    assert shortage(so(3) @ trivial()) == ""
    lines = str(System(bracket, "dot(l, l)/2")).splitlines()
    assert "    (only 0 of 1 independent Casimirs known)" in lines


@pytest.mark.parametrize("algebra", [se(3), heisenberg(2), LieAlgebra.from_brackets(3, so(3).brackets)], ids=str)
def test_none_without_matrices(algebra):
    assert trace_casimirs((algebra + so(4)) @ trivial()) is None


def test_the_twisted_top_in_traces():
    """C1 = |alpha|^2 + 2 epsilon l.beta, C2, C3, times -2, the trace form of so(3); tr(l beta) alone moves."""
    bracket = so(3) @ leibniz(3, "epsilon")
    traces = bracket.trace_casimirs.generators
    ratios = [sp.cancel(t.expand(trace=True) / c) for t, c in zip(traces, bracket.casimirs(), strict=True)]
    assert ratios == [-2, -2, -2]
    part, h = max(traces_in(traces[0]), key=str), bracket.variables[0] * bracket.variables[4]
    assert traces_in(modulo_casimirs(part, bracket)[0]) != {part}
    assert bracket(part, h).expand(trace=True).expand() != 0
    assert (bracket(part, h) - bracket(part.expand(trace=True), h)).expand(trace=True).expand() == 0


def matrix_su(n, x):
    """X_jk = s_jk - i a_jk off the diagonal, written down from the definition."""
    import numpy as np

    X = np.zeros((n, n), dtype=complex)
    pairs = [(j, k) for j in range(n) for k in range(j + 1, n)]
    for m, (j, k) in enumerate(pairs):
        X[j, k] = x[len(pairs) + m] - 1j * x[m]
        X[k, j] = X[j, k].conj()
    # h_k = (X_kk - X_k+1,k+1)/2 and a trace of zero
    diagonal = np.linalg.solve(np.vstack([np.eye(n)[:-1] - np.eye(n)[1:], np.ones(n)]), [*(2 * x[2 * len(pairs) :]), 0])
    return X + np.diag(diagonal)


@pytest.mark.parametrize(
    ("algebra", "matrix"),
    [(su(3), lambda x: matrix_su(3, x)), (su(4), lambda x: matrix_su(4, x))],
    ids=["su3", "su4"],
)
def test_values_are_traces_of_powers(algebra, matrix):
    import numpy as np

    x = np.random.default_rng(1).standard_normal(algebra.dimension)
    X = matrix(x)
    assert np.allclose(X, X.conj().T)
    bracket = algebra @ trivial()
    traces = bracket.trace_casimirs.generators
    values = sp.lambdify(bracket.variables, list(traces))(*x)
    powers = [np.trace(np.linalg.matrix_power(X, trace.word.__len__())).real for trace in traces]
    np.testing.assert_allclose(values, powers, rtol=1e-12)
    if algebra.dimension < 10:
        assert [trace.expand() for trace in traces] == list(traces)
        written = sp.lambdify(bracket.variables, [trace.expand(trace=True) for trace in traces])(*x)
        np.testing.assert_allclose(values, written, rtol=1e-12)


def test_derivatives_are_those_of_the_expansion():
    bracket = su(3) @ leibniz(2)
    l, alpha = bracket.variables[0], bracket.variables[9]
    for trace in bracket.trace_casimirs.generators:
        for difference in (
            trace.diff(l).expand(trace=True) - trace.expand(trace=True).diff(l),
            trace.diff(l, alpha).expand(trace=True) - trace.expand(trace=True).diff(l, alpha),
        ):
            assert difference.expand() == 0


def test_printing():
    C1, C2, _, _ = (su(3) @ leibniz(2)).trace_casimirs.generators
    assert (str(C1), str(C2)) == ("tr(l*alpha)", "tr(alpha**2)")
    assert sp.latex(C2) == r"\operatorname{tr}\left(\boldsymbol{\alpha}^{2}\right)"
    assert sp.pretty(C2) == "tr(alpha**2)"


def test_exact_values_copies_and_abbreviations():
    bracket = gl(2) @ trivial()
    first, second = bracket.trace_casimirs.generators
    point = dict(zip(bracket.variables, map(sp.Rational, ("1/2", "2", "3", "-5")), strict=True))
    assert (first.subs(point), second.subs(point)) == (sp.Rational(-9, 2), sp.Rational(1, 4) + 2 * 6 + 25)
    x = sp.Symbol("x")
    inserted = second.subs(bracket.variables[0], x**2)
    assert (inserted.diff(x).expand(trace=True) - inserted.expand(trace=True).diff(x)).expand() == 0
    copy = pickle.loads(pickle.dumps(second))
    assert (copy, hash(copy)) == (second, hash(second))
    short, meaning = abbreviated(second**2 + 1)
    assert not short.has(Trace)
    assert short.xreplace(meaning) == second**2 + 1
