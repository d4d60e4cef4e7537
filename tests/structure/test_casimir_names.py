r"""C1, C2, ... mean the same, whether parameters of the bracket are symbols, typed numbers or substituted ones."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from liepoisson.structure.casimirs import leading_monomials
from liepoisson.structure.extensions import crmhd, leibniz, normal_form, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import so, su

VALUES = st.one_of(
    st.sampled_from([Fraction(v) for v in (0, 1, -1, 2, -2, "1/2", "-1/2", "4/5")]),
    st.fractions(-3, 3, max_denominator=40),
    st.floats(-3, 3, allow_nan=False).map(lambda v: Fraction(repr(round(v, 15)))),
)


def _diagonal(p, q, r):
    """[e2, e3] = p e1, [e3, e1] = q e2, [e1, e2] = r e3: so(3), so(2,1), se(2), Heisenberg, ..."""
    return LieAlgebra.from_brackets(3, {(1, 2): {0: p}, (0, 2): {1: _negative(q)}, (0, 1): {2: r}})


def _negative(value):
    return -sp.Symbol(value) if isinstance(value, str) else -value


FAMILIES = {
    "order 2": (("epsilon",), lambda e: so(3) @ leibniz(2, e)),
    "twisted": (("epsilon",), lambda e: so(3) @ leibniz(3, e)),
    "twisted so(2,1)": (("epsilon",), lambda e: so(2, 1) @ leibniz(3, e)),
    "order 4": (("epsilon",), lambda e: so(3) @ leibniz(4, e)),
    "plasma": (("beta_e",), lambda e: so(3) @ crmhd(e)),
    "diagonal": (("p", "q", "r"), lambda p, q, r: _diagonal(p, q, r) @ trivial()),
    "diagonal heavy top": (("p", "r"), lambda p, r: _diagonal(p, 1, r) @ semidirect(2)),
    "diagonal twisted top": (("r", "epsilon"), lambda r, e: _diagonal(1, 1, r) @ leibniz(3, e)),
    "linear": (("k",), lambda k: LieAlgebra.from_brackets(4, {(0, 2): {3: k}, (1, 2): {3: 1}}) @ trivial()),
    "sheared": (
        ("k",),
        lambda k: LieAlgebra.from_brackets(3, {(0, 2): {0: 1, 1: k}, (1, 2): {0: 2, 1: -1}}) @ trivial(),
    ),
}


def _cases(values_per_family=VALUES):
    return st.sampled_from(sorted(FAMILIES)).flatmap(
        lambda name: st.tuples(st.just(name), st.tuples(*(values_per_family for _ in FAMILIES[name][0])))
    )


def _inserted(expressions, name, value):
    return [sp.expand(e.subs(sp.Symbol(name), sp.Rational(value.numerator, value.denominator))) for e in expressions]


def _holds(condition, name, value):
    left, right = (sp.sympify(side) for side in condition.split(" = "))
    return (left - right).subs(sp.Symbol(name), sp.Rational(value.numerator, value.denominator)) == 0


@pytest.mark.thorough
@settings(deadline=None, max_examples=40, derandomize=True)
@example(("diagonal", (Fraction(0), Fraction(1), Fraction(1))))
@example(("linear", (Fraction(0),)))
@example(("order 4", (Fraction(0),)))
@example(("diagonal twisted top", (Fraction(0), Fraction(0))))
@given(_cases())
def test_typed_and_substituted_numbers_give_the_same_generators(case):
    """And these are the symbolic ones at the values, except where the report names a jump."""
    name, numbers = case
    names, make = FAMILIES[name]
    bracket, typed = make(*names), make(*numbers)
    assert (
        typed.casimirs()
        == bracket.substitute({n: v for n, v in zip(names, numbers, strict=True) if n in bracket.symbols}).casimirs()
    )
    for value in zip(names, numbers, strict=True):  # one by one: the report examines values of single parameters
        special = bracket.substitute({n: v for n, v in [value] if n in bracket.symbols})
        if leading_monomials(special) == leading_monomials(bracket):
            assert [sp.expand(c) for c in special.casimirs()] == _inserted(bracket.casimirs(), *value)
        else:
            jumps = {case.condition for case in bracket.casimir_report().exceptional if case.jumps}
            assert any(_holds(condition, *value) for condition in jumps)
        bracket = special
    assert bracket.casimirs() == typed.casimirs()


@pytest.mark.thorough
@settings(deadline=None, max_examples=40, derandomize=True)
@given(_cases(st.fractions(-3, 3, max_denominator=40).filter(lambda v: abs(v) > Fraction(1, 20))))
def test_near_by_parameters_have_near_by_generators(case):
    name, numbers = case
    _, make = FAMILIES[name]
    here = make(*numbers)
    near = make(*(v + Fraction(k + 1, 10**12) for k, v in enumerate(numbers)))
    assume(leading_monomials(here) == leading_monomials(near))
    assert len(here.casimirs()) == len(near.casimirs()) > 0
    for first, second in zip(here.casimirs(), near.casimirs(), strict=True):
        assert max(abs(c) for c in sp.Poly(first - second, *here.variables).coeffs()) < 1e-8


@pytest.mark.parametrize(
    "epsilon", [0, 1, "1/3", 1 / 3, 0.1 + 0.2, 0.51, 0.8, -1e-9, 1e6, sp.sqrt(2), sp.pi, "epsilon"]
)
def test_tops_have_the_documented_casimirs_for_every_epsilon(epsilon):
    bracket = so(3) @ leibniz(3, epsilon)
    l, alpha, beta = bracket.fields.values()
    strength = sp.sympify(bracket.extension.tensor[2][1][1])
    wanted = [alpha.dot(alpha) + 2 * strength * l.dot(beta), alpha.dot(beta), beta.dot(beta)]
    assert [sp.expand(found - form) for found, form in zip(bracket.casimirs(), wanted, strict=True)] == [0, 0, 0]


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("epsilon", ["epsilon", "4/5", 1 / 3])
def test_leibniz_extensions_count_from_one(n, epsilon):
    r"""$C_k = \sum_{i+j=n-2+k} x_i\cdot x_j$, halved for odd n + k; epsilon before the terms with $x_0$ if n > 2."""
    bracket = so(3) @ leibniz(n, epsilon)
    x = list(bracket.fields.values())
    strength = sp.sympify(bracket.extension.tensor[2][1][1]) if n > 2 else sp.S.One
    found = bracket.casimirs()
    assert len(found) == n
    for k, casimir in enumerate(found, start=1):
        pairs = [(i, n - 2 + k - i) for i in range(n) if 0 <= n - 2 + k - i < n]
        whole = sum(((strength if 0 in pair else 1) * x[pair[0]].dot(x[pair[1]]) for pair in pairs), sp.S.Zero)
        assert sp.expand(casimir - (whole / 2 if (n + k) % 2 else whole)) == 0


@pytest.mark.parametrize("n", [2, 3, 4])
def test_semidirect_products_have_the_scalar_products_in_lexicographic_order(n):
    bracket = so(3) @ semidirect(n)
    x = list(bracket.fields.values())
    first = [x[0].dot(x[1])] if n == 2 else []
    wanted = [*first, *(x[i].dot(x[j]) for i in range(1, n) for j in range(i, n))]
    assert bracket.casimirs() == [sp.expand(form) for form in wanted]


@pytest.mark.parametrize(("dimension", "number"), [(3, 1), (3, 2), (4, 2), (4, 3), (4, 4), (5, 2), (5, 4), (5, 8)])
def test_normal_forms_have_one_order_and_coefficients_one(dimension, number):
    bracket = so(3) @ normal_form(dimension, number)
    leads = leading_monomials(bracket)
    assert list(leads) == sorted(leads, key=lambda m: (len(m), tuple(i // 3 for i in m), m))
    for casimir, monomial in zip(bracket.casimirs(), leads, strict=True):
        at = sp.Mul(*(bracket.variables[i] for i in monomial))
        assert sp.Poly(casimir, *bracket.variables).coeff_monomial(at) == 1


@pytest.mark.thorough
@pytest.mark.parametrize(
    "bracket", [so(3) @ leibniz(4, "epsilon"), so(4) @ leibniz(2), su(3) @ leibniz(2), so(3) @ semidirect(3)], ids=str
)
def test_strata_and_searches_have_the_same_generators(bracket):
    assert tuple(bracket.casimirs()) == bracket.casimir_report().generators == bracket.strata()[0].casimirs
    degrees = bracket.casimir_report().degrees
    assert bracket.casimirs(max(degrees))[: len(degrees)] == bracket.casimirs()


def test_the_report_names_the_jump():
    """[e1, e3] = k e4, [e2, e3] = e4: l1 - k l2, and for [e1, e3] = e4, [e2, e3] = k e4: l1 - l2/k, at k = 0 l2."""
    smooth = LieAlgebra.from_brackets(4, {(0, 2): {3: "k"}, (1, 2): {3: 1}}) @ trivial()
    broken = LieAlgebra.from_brackets(4, {(0, 2): {3: 1}, (1, 2): {3: "k"}}) @ trivial()
    l1, l2, _, l4 = smooth.variables
    k = sp.Symbol("k")
    report = smooth.casimir_report()
    assert (report.generators, report.examined, report.exceptional) == ((l1 - k * l2, l4), ("k = 0",), ())
    report = broken.casimir_report()
    assert report.generators == (l1 - l2 / k, l4)
    assert report.exceptional == (("k = 0", [l2, l4], ("C1",)),)


@pytest.mark.thorough
def test_the_report_names_what_casimirs_mean_without_a_cocycle():
    (case,) = (so(3) @ leibniz(4, "epsilon")).casimir_report().exceptional
    assert (case.condition, case.jumps) == ("epsilon = 0", ("C1", "C2", "C3", "C4", "C5", "C6"))
    assert case.generators == (so(3) @ semidirect(4)).rename("x0", "x1", "x2", "x3").casimirs()
