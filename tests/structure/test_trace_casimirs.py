"""Casimirs in closed form: how many, that they are those of the search, and when they stand in its place."""

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import rank
from liepoisson.catalog import zeitlin
from liepoisson.formula.styles import UNICODE
from liepoisson.model.system import System
from liepoisson.report.describe import inspect
from liepoisson.structure.casimirs import shortage
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import gl, heisenberg, se, sine, so, su
from liepoisson.structure.trace import Trace, traces_in
from liepoisson.structure.trace_casimirs import modulo_casimirs, replaces_search, trace_casimirs

COMPLETE = {
    "so(4)": (so(4) @ trivial(), [2, 2]),
    "so(5)": (so(5) @ trivial(), [2, 4]),
    "so(8)": (so(8) @ trivial(), [2, 4, 4, 6]),
    "so(3,1)": (so(3, 1) @ trivial(), [2, 2]),
    "so(3,2)": (so(3, 2) @ trivial(), [2, 4]),
    "su(5)": (su(5) @ trivial(), [2, 3, 4, 5]),
    "gl(3)": (gl(3) @ trivial(), [1, 2, 3]),
    "sine(5)": (sine(5) @ trivial(), [2, 3, 4, 5]),
    "su(3) @ semidirect(3)": (su(3) @ semidirect(3), [2, 2, 2, 3, 3, 3, 3, 4]),
    "sine(3) @ leibniz(3)": (sine(3) @ leibniz(3), [2, 2, 2, 3, 3, 3]),
    "su(3) + so(4)": ((su(3) + so(4)) @ trivial(), [2, 2, 2, 3]),
}
SMALL = ["so(4)", "so(5)", "so(3,1)", "gl(3)"]


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


def test_an_algebra_with_the_matrices_of_another_is_refused():
    """The negative control: so(4) with one sign of its structure constants changed still calls itself so(4)."""
    brackets = {pair: dict(row) for pair, row in so(4).brackets.items()}
    (k,) = brackets[0, 1]
    brackets[0, 1][k] = -brackets[0, 1][k]
    wrong = LieAlgebra.from_brackets(6, brackets, check=False)
    wrong.family = so(4).family
    assert trace_casimirs(wrong @ trivial()) is None


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
