"""Casimirs: closed forms, what C1, C2, ... mean whatever the parameters are, and where parameters are exceptional."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from liepoisson.structure.casimirs import leading_monomials
from liepoisson.structure.extensions import crmhd, leibniz, normal_form, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, heisenberg, se, sine, sl, so, su

a, b, epsilon, k = sp.symbols("a b epsilon k")


def of(n, brackets):
    return LieAlgebra.from_brackets(n, brackets) @ trivial()


@pytest.mark.parametrize(
    ("bracket", "degrees"),
    [
        (su(3) @ trivial(), (2, 3)),
        (so(4) @ trivial(), (2, 2)),
        (so(5) @ trivial(), (2, 4)),
        (se(3) @ trivial(), (2, 2)),
        (sl(3) @ trivial(), (2, 3)),
        (sine(3) @ trivial(), (2, 3)),
        (heisenberg(2) @ trivial(), (1,)),
        (affine(1) @ trivial(), ()),
        (abelian(1) @ leibniz(2), (1, 1)),
        (su(3) @ leibniz(2), (2, 2, 3, 3)),
    ],
    ids=str,
)
def test_generators_of_the_classical_algebras(bracket, degrees):
    report = bracket.casimir_report()
    assert report.degrees == degrees
    assert report.verified
    assert report.complete
    assert report.independent == report.corank == len(degrees)
    assert tuple(bracket.casimirs()) == report.generators == bracket.strata()[0].casimirs
    for casimir in report.generators:
        assert set(bracket.vector_field(casimir)) <= {0}


def convolutions(bracket, strength):
    r"""$C_k = \sum_{i+j=n-2+k} x_i\cdot x_j$, halved for odd n + k; epsilon before the terms with $x_0$ if n > 2."""
    x = list(bracket.fields.values())
    n = len(x)
    for j in range(1, n + 1):
        pairs = [(i, n - 2 + j - i) for i in range(n) if 0 <= n - 2 + j - i < n]
        whole = sum(((strength if 0 in pair else 1) * x[pair[0]].dot(x[pair[1]]) for pair in pairs), sp.S.Zero)
        yield whole / 2 if (n + j) % 2 else whole


@pytest.mark.parametrize("strength", ["epsilon", "4/5", 1 / 3, 0.1 + 0.2, -1e-9, 1e6, sp.sqrt(2), sp.pi])
@pytest.mark.parametrize("n", [2, 3, 4, 6])
def test_leibniz_extensions_have_the_convolutions(n, strength):
    r"""For n = 3 the paper's $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$, $|\beta|^2$."""
    bracket = so(3) @ leibniz(n, strength)
    exact = sp.sympify(bracket.extension.tensor[2][1][1]) if n > 2 else sp.S.One
    found = zip(bracket.casimirs(), convolutions(bracket, exact), strict=True)
    assert [sp.expand(casimir - wanted) for casimir, wanted in found] == [0] * n


@pytest.mark.thorough
def test_lifts_of_a_cubic_depend_on_the_strength():
    for strength in (2, 3):
        (cubic,) = [c for c in (su(3) @ leibniz(3, strength)).casimirs() if sp.Poly(c).total_degree() == 3][:1]
        values = [(su(3) @ leibniz(3, other)).vector_field(cubic) for other in (2, 3)]
        assert [not any(value) for value in values] == [strength == 2, strength == 3]


def test_casimirs_of_reduced_magnetohydrodynamics():
    bracket = so(3) @ crmhd("beta_e")
    omega, v, p, psi = bracket.fields.values()
    expected = [v.dot(p) - sp.Symbol("beta_e") * omega.dot(psi), v.dot(psi), p.dot(psi), psi.dot(psi)]
    assert [sp.expand(c) for c in bracket.casimirs()] == [sp.expand(c) for c in expected]


@pytest.mark.parametrize(
    ("bracket", "degree", "dimensions", "degrees"),
    [
        (so(3) @ leibniz(5), 3, {1: 0, 2: 5, 3: 0}, (2,) * 5),
        (so(3) @ leibniz(3), 4, {1: 0, 2: 3, 3: 0, 4: 6}, (2, 2, 2)),  # products are counted and are no generators
    ],
)
def test_all_casimirs_up_to_a_degree(bracket, degree, dimensions, degrees):
    report = bracket.casimir_report(degree)
    assert (report.dimensions, report.degrees) == (dimensions, degrees)
    assert bracket.casimirs(degree)[: len(degrees)] == bracket.casimirs()


def test_a_generator_that_is_not_independent_is_listed_when_a_degree_is_asked_for():
    """Of three vectors six scalar products suffice for the corank; they give the square of the triple product."""
    bracket = so(3) @ semidirect(4)
    assert len(bracket.casimirs()) == 6
    *_, triple = bracket.casimirs(degree=3)
    _, u, v, w = bracket.fields.values()
    assert sp.expand(triple - u.dot(v.cross(w))) * sp.expand(triple + u.dot(v.cross(w))) == 0


@pytest.mark.parametrize(
    ("bracket", "degree", "generators", "exceptional"),
    [
        # Heisenberg, but abelian where a = sqrt(2) or -sqrt(2)
        (of(3, {(0, 1): {2: a**2 - 2}}), None, ["l3"], {f"a = {s}sqrt(2)": ["l1", "l2", "l3"] for s in ("-", "")}),
        # e0 acts on (e1, e2) by diag(a, b): x1^m x2^n is a Casimir where m a + n b = 0
        (of(3, {(0, 1): {1: a}, (0, 2): {2: b}}), 2, [], {"a = 0": ["l2"], "b = 0": ["l3"], "a = -b": ["l2*l3"]}),
        (of(3, {(0, 2): {0: 1}, (1, 2): {1: "k"}}), 3, [],
         {"k = -2": ["l1**2*l2"], "k = -1": ["l1*l2"], "k = -1/2": ["l1*l2**2"], "k = 0": ["l2"]}),
        (of(3, {(0, 1): {2: 1 / epsilon}}), None, ["l3"], {}),  # none at a pole
        (of(4, {(0, 2): {3: "k"}, (1, 2): {3: 1}}), None, ["-k*l2 + l1", "l4"], {}),
        (of(4, {(0, 2): {3: 1}, (1, 2): {3: "k"}}), None, ["l1 - l2/k", "l4"], {"k = 0": ["l2", "l4"]}),
        # a generator has no poles in the parameters: l1^2 - l1 l2 - k l2^2/2
        (of(3, {(0, 2): {0: 1, 1: "k"}, (1, 2): {0: 2, 1: -1}}), None, ["-k*l2**2/2 + l1**2 - l1*l2"], None),
        # l1 + k l2 and l1 + k l3 would coincide for k = 0
        (of(5, {(0, 3): {4: "k"}, (1, 3): {4: -1}, (2, 3): {4: -1}}), None, ["k*l3 + l1", "l2 - l3", "l5"], {}),
    ],
)  # fmt: skip
def test_exceptional_values_of_parameters(bracket, degree, generators, exceptional):
    report = bracket.casimir_report(degree) if degree else bracket.casimir_report()
    assert [str(c) for c in report.generators] == generators
    found = {case.condition: [str(c) for c in case.generators] for case in report.exceptional}
    if exceptional is None:
        assert "k = 0" not in found
    else:
        assert found == exceptional
        assert list(found) == [case.condition for case in report.exceptional]


def test_the_report_names_what_casimirs_mean_without_a_cocycle():
    report = (so(3) @ leibniz(4, "epsilon")).casimir_report()
    (case,) = report.exceptional
    assert report.examined == ("epsilon = 0",)
    assert (case.condition, case.jumps) == ("epsilon = 0", ("C1", "C2", "C3", "C4", "C5", "C6"))
    assert case.generators == (so(3) @ semidirect(4)).rename("x0", "x1", "x2", "x3").casimirs()
    three = (so(3) @ leibniz(3, "epsilon")).casimir_report()  # all three forms are left
    assert (three.examined, three.exceptional) == (("epsilon = 0",), ())


@pytest.mark.thorough
def test_an_incomplete_search_says_why_and_large_algebras_keep_their_killing_form():
    """Typed by hand they have no matrices; su(5) has Casimirs of degree 4 and 5, beyond the size limit."""
    report = (LieAlgebra.from_brackets(24, su(5).brackets, check=False) @ trivial()).casimir_report()
    assert (report.complete, report.degrees, report.corank) == (False, (2, 3), 4)
    assert "exceeds the size limit" in report.limits
    bracket = LieAlgebra.from_brackets(66, so(12).brackets, check=False) @ trivial()
    assert bracket.casimirs() == [sp.Add(*(x**2 for x in bracket.variables))]


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


def _cases():
    return st.sampled_from(sorted(FAMILIES)).flatmap(
        lambda name: st.tuples(st.just(name), st.tuples(*(VALUES for _ in FAMILIES[name][0])))
    )


def _inserted(expressions, name, value):
    return [sp.expand(e.subs(sp.Symbol(name), sp.Rational(value.numerator, value.denominator))) for e in expressions]


def _holds(condition, name, value):
    left, right = (sp.sympify(side) for side in condition.split(" = "))
    return (left - right).subs(sp.Symbol(name), sp.Rational(value.numerator, value.denominator)) == 0


@pytest.mark.thorough
@settings(deadline=None, max_examples=25, derandomize=True)
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


@pytest.mark.parametrize(("dimension", "number"), [(3, 2), (4, 3), (4, 4), (5, 4), (5, 8)])
def test_normal_forms_have_one_order_and_coefficients_one(dimension, number):
    bracket = so(3) @ normal_form(dimension, number)
    leads = leading_monomials(bracket)
    assert list(leads) == sorted(leads, key=lambda m: (len(m), tuple(i // 3 for i in m), m))
    for casimir, monomial in zip(bracket.casimirs(), leads, strict=True):
        at = sp.Mul(*(bracket.variables[i] for i in monomial))
        assert sp.Poly(casimir, *bracket.variables).coeff_monomial(at) == 1
