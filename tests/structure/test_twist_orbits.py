"""Orbits of twists: the five of binary cubics, those of truncated polynomials, and the maps to representatives."""

import re
from fractions import Fraction
from itertools import product

import pytest
import sympy as sp
from commutative import algebra, in_basis
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.structure.cohomology.binary_cubics import KINDS, cubic_form
from liepoisson.structure.normal_forms import complex_truncated_polynomials

numbers = st.integers(-4, 4)
lean = settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))

CHARGED = lp.so(3) @ lp.semidirect(3)
TWISTS = lp.cocycles(CHARGED)
X, Y = sp.symbols("X Y")


def cocycle_of(cubic, twists=TWISTS):
    """X^3 is e1 e1 = e2, and so on: the cubic is v ^ f(v, v)."""
    a, b, c, d = cubic
    return twists.cocycle({(1, 1): {1: -b, 2: a}, (2, 2): {1: -d, 2: c}})


def expanded(form):
    """The coefficients of X^3, X^2 Y, X Y^2, Y^3."""
    poly = sp.Poly(form, X, Y)
    return [Fraction(int(c.p), int(c.q)) for c in (poly.coeff_monomial(X ** (3 - k) * Y**k) for k in range(4))]


def test_five_real_orbits_four_complex_ones():
    orbits = TWISTS.orbits()
    assert orbits.is_decided
    assert [(o.condition, o.dimension, o.codimension, o.name) for o in orbits] == [
        ("zero", 0, 4, "R[x,y]/(x,y)^2"),
        ("a triple root", 2, 2, "R[x]/(x^3)"),
        ("a double root", 3, 1, "R[x]/(x^2) + R"),
        ("three real roots", 4, 0, "R + R + R"),
        ("one real root", 4, 0, "C + R"),
    ]
    assert len({o.complex_name for o in orbits}) == 4
    for orbit in orbits:
        assert orbit.representative.normal_form().orbit.condition == orbit.condition


FACTORED = {
    "zero": [0],
    "a triple root": [X**3, Y**3, 2 * (X + Y) ** 3, -7 * (3 * X - 5 * Y) ** 3],
    "a double root": [X**2 * Y, X * Y**2, (X + Y) ** 2 * (X - Y), -3 * (2 * X - Y) ** 2 * (X + 4 * Y)],
    "three real roots": [X * Y * (X + Y), X * (X**2 - Y**2), X * (X**2 - 2 * Y**2), X**3 - 3 * X * Y**2 + Y**3,
                         X**3 - 4 * X * Y**2 + Y**3, Y * (X**2 - 5 * X * Y + 3 * Y**2)],
    "one real root": [X * (X**2 + Y**2), X**3 + Y**3, X**3 - 2 * Y**3, Y * (X**2 + X * Y + 5 * Y**2)],
}  # fmt: skip
SAMPLES = [(kind, form) for kind, forms in FACTORED.items() for form in forms]


@pytest.mark.parametrize(("kind", "form"), SAMPLES, ids=str)
def test_sampled_cubics_are_classified_and_brought_to_the_representative(kind, form):
    """With the roots inserted as decimals; the identity itself is verified exactly when the matrix is made."""
    cubic = expanded(form)
    found = cubic_form(tuple(cubic))
    assert found.kind == kind
    M = sp.Matrix([[sp.sympify(v).evalf(30) for v in row] for row in found.rows])
    x, y = (sp.Matrix([[X, Y]]) * M).tolist()[0]
    image = sp.Poly((sp.sympify(form).subs({X: x, Y: y}, simultaneous=True) / M.det()).expand(), X, Y)
    for k, wanted in enumerate(KINDS[kind]):
        assert abs(sp.N(image.coeff_monomial(X ** (3 - k) * Y**k)) - wanted) < 1e-20
    f = cocycle_of(cubic)
    assert f.normal_form().orbit.condition == kind
    wanted = next(o for o in TWISTS.orbits() if o.condition == kind)
    assert f.orbit_dimension == wanted.dimension
    assert f.extension(1).classify().name == wanted.name


FIELDS = [
    (X * (X**2 - Y**2), "Q"),
    (X * (X**2 + Y**2), "Q"),
    (X * (X**2 - 2 * Y**2), "Q(sqrt(2))"),
    (2 * X**3 + 3 * X * Y**2, "Q(sqrt(6))"),
    (X**3 - 3 * X * Y**2 + Y**3, "Q(a root of x**3 - 3*x + 1)"),  # cyclic: one root gives the others
    (X**3 - 4 * X * Y**2 + Y**3, "Q(a root of x**3 - 4*x + 1, sqrt(229))"),
    (X**3 - 2 * Y**3, "Q(a root of x**3 - 2, sqrt(3))"),
]


@pytest.mark.parametrize(("form", "field"), FIELDS, ids=str)
def test_the_map_lies_in_the_field_of_one_root_and_of_the_discriminant(form, field):
    assert cubic_form(tuple(expanded(form))).field_extension == field


@pytest.mark.thorough
@lean
@given(st.lists(numbers, min_size=4, max_size=4), st.lists(numbers, min_size=4, max_size=4))
def test_the_orbit_does_not_depend_on_the_basis(cubic, entries):
    p, q, r, s = entries
    assume(p * s - q * r)
    moved = in_basis(lp.semidirect(3), [[1, 0, 0], [0, p, q], [0, r, s]])
    form = sum(c * X ** (3 - k) * Y**k for k, c in enumerate(cubic))
    other = (
        sp.expand(form.subs({X: p * X + r * Y, Y: q * X + s * Y}, simultaneous=True) / sp.Integer(p * s - q * r))
        if form != 0
        else 0
    )
    assert moved.products == lp.semidirect(3).products
    assert cubic_form(tuple(map(Fraction, cubic))).kind == cubic_form(tuple(expanded(other))).kind


RATIONAL = [X**3 * 5, (X - 3 * Y) ** 3, X * Y**2, (X + Y) ** 2 * (X - Y), X * Y * (X - 4 * Y), X * (X**2 + 9 * Y**2)]


@pytest.mark.parametrize("form", RATIONAL, ids=str)
def test_the_map_is_an_automorphism_that_makes_the_representative(form):
    f = cocycle_of(expanded(form))
    found = f.normal_form()
    assert found.field_extension == "Q"
    P = [list(row) for row in found.automorphism.matrix]
    assert found.automorphism.is_poisson(CHARGED)
    # f in the basis e'_i = sum P_ij e_j, by hand
    inverse = sp.Matrix(P).inv()
    products = {}
    for i, j in product(range(3), repeat=2):
        old = [sum(P[i][a] * P[j][b] * f.tensor[c][a][b] for a in range(3) for b in range(3)) for c in range(3)]
        row = (sp.Matrix([[sp.Rational(v.numerator, v.denominator) for v in map(Fraction, old)]]) * inverse).tolist()[0]
        if i <= j:
            products[i, j] = dict(enumerate(row))
    assert TWISTS.cocycle(products).coordinates == found.orbit.representative.coordinates


def test_another_basis_of_the_same_algebra():
    rows = [[1, 2, 3], [1, 1, 0], [0, 2, 5]]
    twists = lp.cocycles(in_basis(lp.semidirect(3), rows))
    orbits = twists.orbits()
    assert [(o.dimension, o.name) for o in orbits] == [(o.dimension, o.name) for o in TWISTS.orbits()]
    for orbit in orbits:
        assert orbit.representative.normal_form().orbit.name == orbit.name


@pytest.mark.thorough
def test_truncated_polynomials_are_told_apart_by_the_order_of_the_relation():
    orbits = lp.cocycles(lp.leibniz(4)).orbits()
    assert [(o.condition, o.codimension, o.name) for o in orbits] == [
        ("zero", 3, "R[x]/(x^4)"),
        ("x^4 = t*x^2", 2, "R[x]/(x^2) + R + R"),
        ("x^4 = -t*x^2", 2, "C + R[x]/(x^2)"),
        ("x^4 = t*x", 1, "C + R + R"),
        ("x^4 = t", 0, "C + R + R"),
        ("x^4 = -t", 0, "C + C"),
    ]
    for orbit in orbits:
        assert orbit.representative.normal_form().orbit.condition == orbit.condition
    assert len(lp.cocycles(lp.leibniz(7)).orbits()) == 1 + 2 * 3 + 3


@pytest.mark.parametrize(
    ("coordinates", "condition"),
    [
        ((0, 0, -3), "x^4 = -t*x^2"),
        ((0, -5, 1), "x^4 = t*x"),
        (("1/2", 1, -1), "x^4 = t"),
        ((-2, 0, 3), "x^4 = -t"),
        ((0, 0, 0), "zero"),
    ],
)
def test_a_twist_of_a_truncated_algebra_finds_its_orbit(coordinates, condition):
    twists = lp.cocycles(lp.leibniz(4, 3))
    f = twists.combination(coordinates)
    found = f.normal_form().orbit
    assert found.condition == condition
    assert f.orbit_dimension == found.dimension
    # The class of a small twist decides what the algebra becomes only where its first order does; x^n = x^i does.
    assert found.representative.extension(1).classify().name == found.name


SUMS = [
    (lp.leibniz(2) + lp.trivial(), 3),
    (lp.leibniz(2) + lp.leibniz(2), 6),  # pairs of three, in either order
    (lp.leibniz(3) + lp.leibniz(2), 4 * 3),
    (complex_truncated_polynomials(3), 3),
    (lp.trivial() + complex_truncated_polynomials(2), 2),
]


@pytest.mark.parametrize(("extension", "n"), SUMS, ids=str)
def test_orbits_of_a_sum_are_those_of_its_parts(extension, n):
    twists = lp.cocycles(extension)
    orbits = twists.orbits()
    assert len(orbits) == n
    assert [o.dimension for o in orbits] == sorted(o.dimension for o in orbits)
    assert orbits[-1].codimension == 0
    for orbit in orbits:
        assert orbit.representative.normal_form().orbit.condition == orbit.condition
        assert orbit.representative.extension("1/100").classify().name == orbit.name
        assert orbit.representative.orbit_dimension == orbit.dimension


@pytest.mark.thorough
@settings(parent=lean, max_examples=8)
@given(st.lists(numbers, min_size=3, max_size=3), st.permutations(range(5)))
def test_the_orbit_of_a_sum_does_not_depend_on_the_order_of_its_basis(coordinates, places):
    A = lp.leibniz(3) + lp.leibniz(2)
    f = lp.cocycles(A).combination(coordinates)
    rows = [[int(places[i] == j) for j in range(5)] for i in range(5)]
    moved = lp.cocycles(in_basis(A, rows))
    g = moved.cocycle({
        (i, j): {k: f.tensor[places[k]][places[i]][places[j]] for k in range(5)} for i in range(5) for j in range(i, 5)
    })  # fmt: skip
    assert g.normal_form().orbit.condition == f.normal_form().orbit.condition
    assert g.orbit_dimension == f.orbit_dimension == f.normal_form().orbit.dimension


def test_rigid_algebras_have_one_orbit():
    orbits = lp.cocycles(lp.trivial() + lp.trivial()).orbits()
    assert [o.name for o in orbits] == ["R + R"]
    assert orbits[0].codimension == 0


def test_other_algebras_are_not_decided():
    twists = lp.cocycles(lp.semidirect(4))
    orbits = twists.orbits()
    assert not orbits.is_decided
    assert len(orbits) == 0
    assert "not decided" in orbits.reason
    with pytest.raises(ParameterError, match="not decided"):
        twists.basis[0].normal_form()
    with pytest.raises(ParameterError, match=re.escape("depends on the values of symbols")):
        TWISTS.combination(["a", 0, 0, 0]).normal_form()


@pytest.mark.thorough
def test_irrational_cubics_have_their_orbit_without_a_map():
    found = cocycle_of((1, 0, "-sqrt(2)", 0)).normal_form()
    assert found.orbit.condition == "three real roots"
    assert found.automorphism is None
    assert cocycle_of((1, 0, "sqrt(2)", 0)).normal_form().orbit.condition == "one real root"


@lean
@given(st.lists(numbers, min_size=4, max_size=4))
def test_orbit_dimensions_are_those_of_the_roots(cubic):
    """4 - the number of independent infinitesimal symmetries: 4 for different roots, 3, 2, 0."""
    f = cocycle_of(cubic)
    disc = sp.discriminant(sum(c * X ** (3 - k) for k, c in enumerate(cubic)) + X**4 * 0, X) if cubic[0] else None
    if disc is not None and disc != 0:
        assert f.orbit_dimension == 4
    kind = cubic_form(tuple(map(Fraction, cubic))).kind
    assert f.orbit_dimension == {"zero": 0, "a triple root": 2, "a double root": 3}.get(kind, 4)


def test_an_algebra_with_symbols_has_orbits_if_its_name_is_the_same_for_all():
    twists = lp.cocycles(algebra(2, {(1, 1): {}}))
    assert [o.name for o in twists.orbits()] == ["R[x]/(x^2)", "R + R", "C"]
