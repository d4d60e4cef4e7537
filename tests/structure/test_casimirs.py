import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.errors import ParameterError
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import affine, heisenberg, se, sine, sl, so, su

epsilon = sp.Symbol("epsilon")


@pytest.mark.thorough
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
        (su(3) @ leibniz(2), (2, 2, 3, 3)),
    ],
)
def test_generators_of_the_classical_algebras(bracket, degrees):
    report = bracket.casimir_report()
    assert report.degrees == degrees
    assert report.verified
    assert report.complete
    assert report.independent == report.corank == len(degrees)
    for casimir in report.generators:
        assert set(bracket.vector_field(casimir)) <= {0}


def test_casimirs_of_reduced_magnetohydrodynamics():
    bracket = so(3) @ crmhd("beta_e")
    omega, v, p, psi = bracket.fields.values()
    expected = [v.dot(p) - sp.Symbol("beta_e") * omega.dot(psi), v.dot(psi), p.dot(psi), psi.dot(psi)]
    assert [sp.expand(c) for c in bracket.casimirs()] == [sp.expand(c) for c in expected]
    assert bracket.corank() == 4


def test_so21_has_the_casimirs_of_so3_with_its_own_metric():
    bracket = so(2, 1) @ leibniz(3, epsilon)
    l, alpha, beta = bracket.fields.values()

    def dot(u, v):
        return u[0] * v[0] + u[1] * v[1] - u[2] * v[2]

    expected = [dot(alpha, alpha) + 2 * epsilon * dot(l, beta), dot(alpha, beta), dot(beta, beta)]
    assert [sp.expand(c) for c in bracket.casimirs()] == [sp.expand(c) for c in expected]


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_the_closed_form_agrees_with_the_search(n):
    bracket = so(3) @ leibniz(n, "epsilon")
    closed, searched = bracket.casimirs(), bracket.casimirs(degree=2)
    assert len(closed) == len(searched) == n
    polynomials = [sp.Poly(c, *bracket.variables) for c in closed + searched]
    monomials = sorted({m for p in polynomials for m in p.monoms()})
    assert sp.Matrix([[p.coeff_monomial(m) for m in monomials] for p in polynomials]).rank() == n


def test_all_casimirs_up_to_degree_three_of_the_leibniz_extension_of_order_five():
    report = (so(3) @ leibniz(5)).casimir_report(3)
    assert report.dimensions == {1: 0, 2: 5, 3: 0}
    assert report.degrees == (2,) * 5


def test_products_are_counted_but_are_no_generators():
    # Degree 4 of three quadratic generators: 6 products.
    report = (so(3) @ leibniz(3)).casimir_report(4)
    assert report.dimensions == {1: 0, 2: 3, 3: 0, 4: 6}
    assert report.degrees == (2, 2, 2)


def test_a_generator_that_is_not_independent_is_listed_when_a_degree_is_asked_for():
    # Three vectors: six scalar products, which suffice for the corank, and the triple product, whose square they give.
    bracket = so(3) @ semidirect(4)
    assert len(bracket.casimirs()) == 6
    *_, triple = bracket.casimirs(degree=3)
    _, u, v, w = bracket.fields.values()
    assert sp.expand(triple - u.dot(v.cross(w))) * sp.expand(triple + u.dot(v.cross(w))) == 0


def test_exceptional_values_of_a_parameter():
    report = (so(3) @ leibniz(4, "epsilon")).casimir_report()
    assert report.examined == ("epsilon = 0",)
    (case,) = report.exceptional
    assert case.condition == "epsilon = 0"
    assert len(case.generators) == 6
    # For order three, six becomes three: |alpha|^2, alpha.beta, |beta|^2 are all that is left at epsilon = 0.
    order_three = (so(3) @ leibniz(3, "epsilon")).casimir_report()
    assert (order_three.examined, order_three.exceptional) == (("epsilon = 0",), ())


def test_exceptional_values_that_are_not_rational():
    # [e0, e1] = (a^2 - 2) e2: Heisenberg, but abelian where a = sqrt(2) or -sqrt(2).
    a = sp.Symbol("a")
    report = (LieAlgebra.from_brackets(3, {(0, 1): {2: a**2 - 2}}) @ trivial()).casimir_report()
    assert [str(c) for c in report.generators] == ["l3"]
    assert {case.condition for case in report.exceptional} == {"a = sqrt(2)", "a = -sqrt(2)"}
    assert all([str(c) for c in case.generators] == ["l1", "l2", "l3"] for case in report.exceptional)


def test_exceptional_values_are_sorted():
    weights = LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: "k"}})
    report = (weights @ trivial()).casimir_report(3)
    assert [case.condition for case in report.exceptional] == ["k = -2", "k = -1", "k = -1/2", "k = 0"]


def test_exceptional_conditions_on_two_parameters():
    # e0 acts on (e1, e2) by diag(a, b): x1^m x2^n is a Casimir where m a + n b = 0.
    a, b = sp.symbols("a b")
    report = (LieAlgebra.from_brackets(3, {(0, 1): {1: a}, (0, 2): {2: b}}) @ trivial()).casimir_report(2)
    assert report.generators == ()
    assert {case.condition: [str(c) for c in case.generators] for case in report.exceptional} == {
        "a = 0": ["l2"],
        "b = 0": ["l3"],
        "a = -b": ["l2*l3"],
    }


def test_no_case_where_the_bracket_has_a_pole():
    report = (LieAlgebra.from_brackets(3, {(0, 1): {2: 1 / epsilon}}) @ trivial()).casimir_report()
    assert [str(c) for c in report.generators] == ["l3"]
    assert report.exceptional == ()


def without_matrices(algebra):
    """The same algebra by its structure constants alone, as if typed by hand."""
    return LieAlgebra.from_brackets(algebra.dimension, algebra.brackets, check=False)


@pytest.mark.thorough
def test_an_incomplete_search_says_why():
    # su(5) has Casimirs of degree 4 and 5, beyond the size limit; typed by hand, it has no matrices.
    by_hand = LieAlgebra.from_brackets(24, su(5).brackets, check=False)
    report = (by_hand @ trivial()).casimir_report()
    assert (report.complete, report.degrees, report.corank) == (False, (2, 3), 4)
    assert "exceeds the size limit" in report.limits


@pytest.mark.thorough
def test_large_algebras_keep_their_killing_form():
    bracket = without_matrices(so(12)) @ trivial()
    assert bracket.casimirs() == [sp.Add(*(x**2 for x in bracket.variables))]


@pytest.mark.parametrize("degree", [0, -1, 2.0, True, "2"])
def test_degrees_are_positive_integers(degree):
    with pytest.raises(ParameterError, match="degree must be an integer"):
        (so(3) @ leibniz(2)).casimirs(degree)


def test_a_search_that_is_too_large_is_refused():
    with pytest.raises(ParameterError, match="degree 9 exceeds the size limit"):
        (so(3) @ leibniz(3)).casimirs(degree=9)


def test_a_flipped_sign_changes_the_casimirs():
    right = so(3) @ leibniz(3, "epsilon")
    products = {p: dict(row) for p, row in right.extension.products.items()} | {(1, 1): {2: -epsilon}}
    wrong = so(3) @ Extension.from_products(3, products, field_names=right.field_names)
    assert wrong.casimirs()[0] == right.casimirs()[0].subs(epsilon, -epsilon) != right.casimirs()[0]


@pytest.mark.thorough
@settings(deadline=None, max_examples=15, derandomize=True)
@given(st.lists(st.integers(-2, 2), min_size=9, max_size=9).filter(lambda p: sp.Matrix(3, 3, p).det() != 0))
def test_the_number_of_casimirs_does_not_depend_on_the_basis(entries):
    P = sp.Matrix(3, 3, entries)
    inverse, W = P.inv(), leibniz(3).tensor
    moved = [
        [
            [
                sum(
                    inverse[k, lam] * P[mu, a] * P[nu, b] * W[k][a][b]
                    for k in range(3)
                    for a in range(3)
                    for b in range(3)
                )
                for nu in range(3)
            ]
            for mu in range(3)
        ]
        for lam in range(3)
    ]
    report = (so(3) @ Extension(moved)).casimir_report(3)
    assert report.dimensions == {1: 0, 2: 3, 3: 0}
    assert report.verified
    assert report.complete


@pytest.mark.thorough
@pytest.mark.parametrize(
    "bracket",
    [so(3) @ leibniz(3, "epsilon"), so(4) @ leibniz(2), so(3) @ semidirect(4), so(3) @ crmhd(), su(3) @ leibniz(2)],
    ids=str,
)
def test_casimirs_have_one_order(bracket):
    assert tuple(bracket.casimirs()) == bracket.casimir_report().generators


def test_a_generator_has_no_poles_in_the_parameters():
    r"""[e1, e3] = e1 + k e2, [e2, e3] = 2 e1 - e2: $l_1^2 - l_1 l_2 - k l_2^2/2$, for k = 0 too."""
    bracket = LieAlgebra.from_brackets(3, {(0, 2): {0: 1, 1: "k"}, (1, 2): {0: 2, 1: -1}}) @ trivial()
    k = sp.Symbol("k")
    l1, l2, _ = bracket.variables
    (casimir,) = bracket.casimirs()
    assert sp.expand(casimir - (l1**2 - l1 * l2 - k * l2**2 / 2)) == 0
    assert not any(bracket.substitute({"k": 0}).vector_field(casimir.subs(k, 0)))
    report = bracket.casimir_report()
    assert report.generators == (casimir,)
    assert "k = 0" not in [case.condition for case in report.exceptional]


def test_generators_stay_independent_at_all_values():
    """[e1, e4] = k e5, [e2, e4] = [e3, e4] = -e5: l1 + k l2 and l1 + k l3 would coincide for k = 0."""
    bracket = LieAlgebra.from_brackets(5, {(0, 3): {4: "k"}, (1, 3): {4: -1}, (2, 3): {4: -1}}) @ trivial()
    report = bracket.casimir_report()
    l1, l2, l3, _, l5 = bracket.variables
    k = sp.Symbol("k")
    assert report.generators == (l1 + k * l3, l2 - l3, l5)
    assert (report.examined, report.exceptional) == (("k = 0",), ())
    assert bracket.substitute({"k": sp.S.Zero}).casimirs() == [l1, l2 - l3, l5]
