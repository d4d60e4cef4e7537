"""Casimirs in closed form: how many, that they are those of the search, and when they stand in its place."""

from dataclasses import replace

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import rank
from liepoisson.catalog import zeitlin
from liepoisson.formula.styles import UNICODE
from liepoisson.model.system import System
from liepoisson.report.describe import inspect
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.casimirs import shortage
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.lie.defining_matrices import DefiningMatrices, defining_matrices
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import gl, heisenberg, se, sine, sl, so, su
from liepoisson.structure.trace import Trace, traces_in
from liepoisson.structure.trace_casimirs import modulo_casimirs, replaces_search, trace_casimirs

COMPLETE = {
    "so(3)": (so(3) @ trivial(), [2]),
    "so(4)": (so(4) @ trivial(), [2, 2]),
    "so(5)": (so(5) @ trivial(), [2, 4]),
    "so(6)": (so(6) @ trivial(), [2, 3, 4]),
    "so(8)": (so(8) @ trivial(), [2, 4, 4, 6]),
    "so(3,1)": (so(3, 1) @ trivial(), [2, 2]),
    "so(4,2)": (so(4, 2) @ trivial(), [2, 3, 4]),
    "so(3,2)": (so(3, 2) @ trivial(), [2, 4]),
    "su(5)": (su(5) @ trivial(), [2, 3, 4, 5]),
    "sl(4)": (sl(4) @ trivial(), [2, 3, 4]),
    "gl(3)": (gl(3) @ trivial(), [1, 2, 3]),
    "sine(5)": (sine(5) @ trivial(), [2, 3, 4, 5]),
    "so(5) @ leibniz(3)": (so(5) @ leibniz(3), [2, 2, 2, 4, 4, 4]),
    "su(3) @ semidirect(2)": (su(3) @ semidirect(2), [2, 2, 3, 3]),
    "su(3) @ semidirect(3)": (su(3) @ semidirect(3), [2, 2, 2, 3, 3, 3, 3, 4]),
    "so(3) @ crmhd": (so(3) @ crmhd(), [2, 2, 2, 2]),
    "sine(3) @ leibniz(3)": (sine(3) @ leibniz(3), [2, 2, 2, 3, 3, 3]),
    "su(3) + so(4)": ((su(3) + so(4)) @ trivial(), [2, 2, 2, 3]),
}
SMALL = ["so(3)", "so(4)", "so(5)", "so(3,1)", "so(3,2)", "gl(3)", "su(3) @ semidirect(2)", "so(3) @ crmhd"]


@pytest.mark.parametrize("name", COMPLETE)
def test_they_are_all(name):
    bracket, degrees = COMPLETE[name]
    found = bracket.trace_casimirs
    assert (list(found.degrees), found.complete, found.limits) == (degrees, True, "")
    assert found.corank == bracket.corank() == len(degrees)


@pytest.mark.thorough
@pytest.mark.parametrize("name", SMALL)
def test_they_span_what_the_search_finds(name):
    """Degree by degree, modulo products of lower ones, as expanded polynomials."""
    bracket, _ = COMPLETE[name]
    written = [generator.expand(trace=True) for generator in bracket.trace_casimirs.generators]
    searched = bracket.casimirs(max(bracket.trace_casimirs.degrees))
    for degree in sorted({*bracket.trace_casimirs.degrees}):
        ours, theirs = spanned(written, degree, bracket), spanned(searched, degree, bracket)
        both = [*ours, *theirs]
        assert rank_of(ours) == rank_of(theirs) == rank_of(both) > 0


def spanned(generators, degree, bracket):
    """All products of this degree, as dictionaries from monomials to coefficients."""
    polynomials = [sp.Poly(generator, *bracket.variables) for generator in generators]
    found = []

    def extend(start, left, product):
        if left == 0:
            found.append(dict(product.terms()))
        for k in range(start, len(polynomials)):
            if polynomials[k].total_degree() <= left:
                extend(k, left - polynomials[k].total_degree(), product * polynomials[k])

    extend(0, degree, sp.Poly(1, *bracket.variables))
    return found


def rank_of(rows):
    field = Coefficients.containing([c for row in rows for c in row.values()])
    place = {m: k for k, m in enumerate({m for row in rows for m in row})}
    return rank([{place[m]: field.read(c) for m, c in row.items()} for row in rows], field)


def test_the_twisted_top_in_traces():
    """C1 = |alpha|^2 + 2 epsilon l.beta, C2, C3, times -2, the trace form of so(3)."""
    bracket = so(3) @ leibniz(3, "epsilon")
    traces = [generator.expand(trace=True) for generator in bracket.trace_casimirs.generators]
    assert [sp.cancel(t / c) for t, c in zip(traces, bracket.casimirs(), strict=True)] == [-2, -2, -2]


def test_small_brackets_keep_polynomials():
    for bracket in (so(3) @ trivial(), so(4) @ trivial(), su(3) @ trivial(), so(5) @ leibniz(3)):
        assert not replaces_search(bracket)
    assert all(not traces_in(c) for c in (so(4) @ trivial()).casimirs())
    assert replaces_search(su(5) @ trivial())
    assert replaces_search(su(5) @ semidirect(3))
    assert not replaces_search(se(3) @ trivial())


@pytest.mark.thorough
def test_large_brackets_have_traces():
    bracket = sine(7) @ trivial()
    assert [str(c) for c in bracket.casimirs()] == [f"tr(l**{k})" for k in range(2, 8)]
    report = bracket.casimir_report()
    assert (report.complete, report.verified, report.independent, report.corank) == (True, True, 6, 6)
    assert bracket.n_unknown_casimirs == 0
    assert bracket.rank_certificate().proved


@pytest.mark.thorough
def test_traces_stand_where_the_search_finds_fewer():
    """The eighth Casimir of su(3) @ semidirect(3) has degree 4, beyond the limits of the search."""
    bracket = su(3) @ semidirect(3)
    assert not replaces_search(bracket)
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


@pytest.mark.parametrize("algebra", [se(3), heisenberg(2), LieAlgebra.from_brackets(3, so(3).brackets)], ids=str)
def test_none_without_matrices(algebra):
    assert trace_casimirs(algebra @ trivial()) is None
    assert trace_casimirs((algebra + so(4)) @ trivial()) is None


def test_an_algebra_with_the_matrices_of_another_is_refused():
    """The negative control: so(4) with one sign of its structure constants changed still calls itself so(4)."""
    brackets = {pair: dict(row) for pair, row in so(4).brackets.items()}
    (k,) = brackets[0, 1]
    brackets[0, 1][k] = -brackets[0, 1][k]
    wrong = LieAlgebra.from_brackets(6, brackets, check=False)
    wrong.family = so(4).family
    assert trace_casimirs(wrong @ trivial()) is None


def test_the_check_at_a_point_alone_refuses_a_wrong_matrix(monkeypatch):
    """Without the proof on the basis: X with one sign wrong is caught by J grad C != 0."""
    right = defining_matrices(su(3))
    first = {place: tuple((-q, a) for q, a in roots) for place, roots in right.matrices[0].items()}
    wrong = replace(right, matrices=(first, *right.matrices[1:]))
    monkeypatch.setattr("liepoisson.structure.trace_casimirs.defining_matrices", lambda _: wrong)
    monkeypatch.setattr(DefiningMatrices, "defect", lambda *_: "")
    assert trace_casimirs(su(3) @ trivial()) is None


@pytest.mark.thorough
def test_casimirs_commute_with_everything():
    bracket = su(5) @ trivial()
    x = bracket.variables
    h = x[0] ** 2 * x[3] + x[7] * x[20]
    for casimir in bracket.casimirs():
        assert bracket(casimir, h) == 0
        assert bracket(h, casimir) == 0
        assert bracket(casimir**2 + casimir, h) == 0
    C = bracket.casimirs()[2]
    assert bracket(C * x[0], h) == (C * bracket(x[0], h)).expand()


def test_other_traces_are_no_casimirs():
    """tr(l beta) + tr(alpha^2)/2 is one for epsilon = 1; tr(l beta) alone moves."""
    bracket = so(3) @ leibniz(3)
    C = bracket.trace_casimirs.generators[0]
    part = max(traces_in(C), key=str)
    reduced, _ = modulo_casimirs(part, bracket)
    assert traces_in(reduced) != {part}
    h = bracket.variables[0] * bracket.variables[4]
    assert bracket(part, h).expand(trace=True).expand() != 0
    assert (bracket(part, h) - bracket(part.expand(trace=True), h)).expand(trace=True).expand() == 0


def test_an_integral_that_is_a_trace_is_constant():
    bracket = Bracket(su(5), trivial())
    system = System(bracket, sum(k * x**2 for k, x in enumerate(bracket.variables)))
    assert system.is_constant(bracket.casimirs()[-1])
    assert list(system.invariants) == ["H", "C1", "C2", "C3", "C4"]


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
