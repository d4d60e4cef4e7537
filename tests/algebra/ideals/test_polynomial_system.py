"""Solutions, components and projections of systems that are solved by hand."""

import pytest
import sympy as sp
from known_systems import cyclic

from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import eliminated, radical_contains
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.errors import ParameterError

X, Y, Z, A = sp.symbols("x y z a")


def system(*equations, **more):
    return PolynomialSystem.of(equations, [X, Y, Z] if any(sp.sympify(e).has(Z) for e in equations) else [X, Y], **more)


def points(found):
    return [tuple(float(v.mid()) for v in s.values) for s in found]


def shown(components):
    return {" ".join(sorted(str(p) for p in c.equations)) for c in components}


def test_two_conics_meet_in_four_points():
    both = system(X**2 + Y**2 - 5, X * Y - 2)
    assert points(both.real_solutions()) == [(-2, -1), (-1, -2), (1, 2), (2, 1)]
    assert repr(both.solutions()) == (
        "<Solutions: 4 complex, 4 real; 4 with multiplicities; factors of degree 1, 1, 1, 1>"
    )


def test_multiplicities_of_a_node_and_a_tangent():
    # x^2 (x - 1)^3 = 0 on the parabola x = y^2: y^4 and (y -+ 1)^3
    found = system(X**2 * (X - 1) ** 3, Y**2 - X).real_solutions()
    assert [(*p, s.multiplicity) for p, s in zip(points(found), found, strict=True)] == [
        (0, 0, 4),
        (1, -1, 3),
        (1, 1, 3),
    ]
    # no linear form has all of the multiplicity for its own: the ideal is not curvilinear
    fat = system(X**2, X * Y, Y**2).real_solutions()
    assert [(s.multiplicity, *map(str, s.values)) for s in fat] == [(3, "0", "0")]


def test_all_seventy_cyclic_roots_are_distinct_and_ten_are_real():
    roots = PolynomialSystem(cyclic(5)[0].context(), tuple(cyclic(5))).solutions()
    assert (roots.degree, roots.n_distinct, roots.n_real) == (70, 70, 10)


def test_signs_are_exact():
    of = system(X**2 - 2, Y**2 - X)
    found = of.solutions()
    (low, high) = of.real_solutions()
    assert [found.sign(of.read(Y**4 - 2), s) for s in (low, high)] == [0, 0]
    almost = of.read(X - sp.Rational(sp.sqrt(2).evalf(60)))
    assert abs(found.sign(almost, high)) == 1
    assert [found.sign(of.read(Y), s) for s in (low, high)] == [-1, 1]
    assert found.vanishes(of.read((X**2 - 2) * Y), 0)


def test_positive_variables_choose_solutions():
    assert points(system(X**2 - 4, Y - X, positive=[Y]).real_solutions()) == [(2, 2)]


@pytest.mark.parametrize(
    ("equations", "assumptions", "expected"),
    [
        ([X * Y, X * Z], {}, {"x", "y z"}),  # a plane and a line
        ([X * Y, X * Z], {"nonzero": [X]}, {"y z"}),
        ([X**2 + Y**2 + Z**2 - 1, X * Y * Z], {}, {"x y^2 + z^2 - 1", "x^2 + z^2 - 1 y", "x^2 + y^2 - 1 z"}),
        ([X**2 - 2, Y**2 - 2], {}, {"x + y y^2 - 2", "x - y y^2 - 2"}),  # pairs of conjugate points
        ([X**2, Y**2 - Y**3], {}, {"x y", "x y - 1"}),
        ([(X - Y**2) * X, (X - Y**2) * Y], {}, {"y^2 - x"}),  # the point lies on the curve
        ([X**2 + Y**2], {}, {"x^2 + y^2"}),
        ([X * Y], {"nonzero": [X, Y]}, set()),
    ],
)
def test_components(equations, assumptions, expected):
    found = system(*equations, **assumptions).components()
    assert shown(found) == expected
    assert all(c.is_irreducible for c in found)


@pytest.mark.parametrize(
    ("equations", "expected"), [([X**2 + Y**2], {"x y"}), ([X**2 + Y**4 + 1], set()), ([X**2 + 1, Y], set())]
)
def test_real_components_where_sums_of_squares_vanish_with_all_of_their_terms(equations, expected):
    assert shown(system(*equations).components(is_real=True)) == expected
    assert system(*equations).is_inconsistent is (not expected)


@pytest.mark.parametrize(
    ("equations", "assumptions"),
    [
        ([X], {"nonzero": [X]}),
        ([X, Y], {"nonzero": [0]}),
        ([X**2 + 3 * X + 2, Y - X], {"positive": [X]}),
        ([X + Y**2], {"positive": [X]}),
        ([X**2 + Y**2 - 5, X * Y - 3], {}),  # four complex solutions
    ],
)
def test_no_real_solutions(equations, assumptions):
    assert system(*equations, **assumptions).is_inconsistent


def test_projection_of_the_twisted_cubic():
    t = sp.Symbol("t")
    curve = PolynomialSystem.of([X - t, Y - t**2, Z - t**3], [t], [X, Y, Z])
    found = eliminated(curve.equations, ["t"], curve.limits.budget())
    assert found.names == ("x", "y", "z")
    assert (found.dimension, found.degree) == (1, 3)
    for e in (X * Z - Y**2, X**2 - Y, X * Y - Z):
        assert found.contains(PolynomialSystem.of([e], [X, Y, Z]).equations[0])


def test_conditions_on_a_parameter():
    # x^2 + a x + 1 has a double root where a^2 = 4
    both = PolynomialSystem.of([X**2 + A * X + 1, 2 * X + A], [X], [A])
    assert [str(p) for p in eliminated(both.equations, ["x"], both.limits.budget()).polynomials] == ["a^2 - 4"]


def test_membership_in_the_ideal_and_in_its_radical():
    of = system(X**2 * Y, Y**3)
    basis, budget = of.groebner(), of.limits.budget()
    assert basis.contains(of.read(X**2 * Y**2))
    assert not basis.contains(of.read(X * Y))
    assert radical_contains(basis, of.read(X * Y), budget)
    assert not radical_contains(basis, of.read(X), budget)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: system(X * Y - 1).real_solutions(), ParameterError, "set of dimension 1"),
        (lambda: system(X**2 - 2, Y**2 - 3, limits=Limits(degree=3)).real_solutions(), NotDecidedError, "4 complex"),
        *((lambda p=p: PolynomialSystem.of([p], [X, Y]), ParameterError, "wanted a polynomial")
          for p in (sp.sin(X), X * A, sp.sqrt(2) * X, sp.pi, 1 / X)),
        (lambda: PolynomialSystem.of([rational_context(["b", "x"]).gens()[0]], [X]), ParameterError, "wanted polynom"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
