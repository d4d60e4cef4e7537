"""Fields, linear algebra and series of balances, on examples small enough to know the answer."""

from fractions import Fraction
from random import Random

import pytest
from flint import fmpq, fmpq_poly

import liepoisson as lp
from liepoisson.algebra.function_fields import (
    AlgebraicFunctions,
    AlgebraicNumbers,
    RationalFunctions,
    Rationals,
    polynomial_at,
)
from liepoisson.algebra.ideals.coordinate_ring import Resolvent
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.algebra.matrices import characteristic_polynomial, eliminated
from liepoisson.integrability.derivation import derivation_of_rates
from liepoisson.integrability.painleve.expansion import OverField, condition_text, expand, exponents_of
from liepoisson.integrability.painleve.generic_points import generic_points, of_family
from liepoisson.integrability.painleve.quasi_homogeneous import LocalField, QuasiHomogeneous

Q = Rationals()
SQRT2 = AlgebraicNumbers(fmpq_poly([-2, 0, 1]))
FUNCTIONS = RationalFunctions(["s"])
S = FUNCTIONS.element(FUNCTIONS.context.gens()[0])
ROOT = AlgebraicFunctions(FUNCTIONS, [-S, FUNCTIONS.number(0)])
"""theta^2 = s."""

SAMPLES = [
    (Q, fmpq(3, 7)),
    (SQRT2, SQRT2.element(fmpq_poly([1, 3]))),
    (FUNCTIONS, S * S + FUNCTIONS.number(2)),
    (ROOT, ROOT.element([S, FUNCTIONS.number(5)])),
]


@pytest.mark.parametrize(("field", "x"), SAMPLES, ids=lambda one: type(one).__name__)
def test_fields_know_their_rational_numbers(field, x):
    assert field.rational(x * field.inverse(x)) == 1
    assert field.rational(field.number(Fraction(2, 3))) == fmpq(2, 3)


def test_generators_satisfy_their_equations():
    theta = SQRT2.element(fmpq_poly([0, 1]))
    assert SQRT2.rational(theta * theta) == 2
    theta = ROOT.element([FUNCTIONS.number(0), FUNCTIONS.number(1)])
    assert not (theta * theta - ROOT.element([S]))


def rational_matrix(rows):
    return [[fmpq(x) for x in row] for row in rows]


def conjugated(matrix, random):
    """The matrix in another basis."""
    n = len(matrix)
    while True:
        basis = rational_matrix([[random.randint(-3, 3) for _ in range(n)] for _ in range(n)])
        unit = rational_matrix([[int(i == j) for j in range(n)] for i in range(n)])
        found = eliminated(basis, unit, Q)
        if not found.kernel:
            return times(times(basis, matrix), found.particular)


def times(left, right):
    return [
        [sum((a * b for a, b in zip(row, column, strict=True)), fmpq(0)) for column in zip(*right, strict=True)]
        for row in left
    ]


JORDAN = rational_matrix([[-1, 0, 0, 0, 0], [0, 2, 1, 0, 0], [0, 0, 2, 0, 0], [0, 0, 0, 3, 0], [0, 0, 0, 0, 3]])


def test_exponents_and_jordan_blocks_of_matrices():
    matrix = conjugated(JORDAN, Random(1))
    exponents = exponents_of(characteristic_polynomial(matrix, Q.number), Q)
    assert exponents.rational == ((-1, 1), (2, 2), (3, 2))
    assert exponents.are_integers
    over_field = OverField(matrix, Q)
    resolvent = Resolvent(matrix, exponents.rational, Q)
    for r, m, kernel in ((Fraction(-1), 1, 1), (Fraction(2), 2, 1), (Fraction(3), 2, 2)):
        projector = resolvent.projector(r, m)
        assert times(projector, projector) == projector
        assert sum((projector[k][k] for k in range(5)), fmpq(0)) == m
        assert over_field.kernel(r) == kernel
        assert any(x for row in resolvent.nilpotent(r, projector) for x in row) == (kernel < m)


@pytest.mark.parametrize("k", [0, 2, 3])
def test_the_resolvent_solves_what_elimination_solves(k):
    random = Random(2)
    matrix = conjugated(JORDAN, random)
    resolvent = Resolvent(matrix, ((Fraction(-1), 1), (Fraction(2), 2), (Fraction(3), 2)), Q)
    m = {2: 2, 3: 2}.get(k, 0)
    right = [[fmpq(random.randint(-5, 5))] for _ in range(5)]
    if m:  # a right-hand side without a part in the eigenspace
        projected = times(resolvent.projector(Fraction(k), m), right)
        right = [[a[0] - b[0]] for a, b in zip(right, projected, strict=True)]
    found, conditions = resolvent.solved(Fraction(k), m, right)
    assert not any(x for row in conditions for x in row)
    image = times(matrix, found)
    assert [[k * a[0] - b[0]] for a, b in zip(found, image, strict=True)] == right


def test_irrational_exponents_in_a_number_field():
    """The matrix with eigenvalues sqrt(2), 1 and i: one is rational over Q(sqrt(2)), and two others are not."""
    theta, zero, one = SQRT2.element(fmpq_poly([0, 1])), SQRT2.number(0), SQRT2.number(1)
    matrix = [[theta, one, zero, zero], [zero, one, zero, zero], [zero, zero, zero, -one], [zero, zero, one, zero]]
    exponents = exponents_of(characteristic_polynomial(matrix, SQRT2.number), SQRT2)
    assert exponents.rational == ((1, 1),)
    assert [str(p) for p, _ in exponents.over_rationals] == ["x^2 + 1"]
    assert len(exponents.rest) == 2
    values = sorted((complex(z) for z in exponents.others), key=lambda z: (z.real, z.imag))
    assert values == pytest.approx([-(2**0.5), -1j, 1j, 2**0.5])


def parts(equations, names):
    return PolynomialSystem.of(equations, names).components()


def test_generic_points_of_curves():
    x, y = lp.systems.CanonicalSystem(["x"], ["y"], "y^2").variables
    budget = PolynomialSystem.of([x], [x, y]).limits.budget()
    for equation, degrees in ((x * y - 1, [1]), (x**2 + y**2 - 1, [2]), (y**2 - x**3 - x - 1, [2])):
        (part,) = parts([equation], [x, y])
        points = generic_points(part, (), budget)
        assert [p.field.degree for p in points] == degrees
        ring = of_family(part, ["x", "y"], budget)
        for point in (*points, ring):
            (residual,) = PolynomialSystem.of([equation], [x, y]).equations
            assert not polynomial_at(residual, point.values, point.field)
        # what is the number 3 on the family has no zeros, and a coordinate of the ring is named
        assert all(condition_text([()], [point.field.number(3)], point.field) == "1" for point in (*points, ring))
        assert condition_text([()], [ring.values["y"]], ring.field) == "y"
        assert ring.field.generator == ""


def expansion(rates, variables, weights, point):
    field, _ = derivation_of_rates(variables, rates)
    system = QuasiHomogeneous.of(field, tuple(map(Fraction, weights)))
    local = LocalField.of(system, Q, {})
    values = [fmpq(c) for c in point]
    at = dict(zip(system.context.names(), values, strict=True))
    assert not any(polynomial_at(e, at, Q) for e in system.indicial_equations())
    matrix = local.kovalevskaya_matrix(values)
    exponents = exponents_of(characteristic_polynomial(matrix, Q.number), Q)
    return expand(local, values, OverField(matrix, Q), exponents)


def test_the_series_of_weierstrass_function():
    r"""$\wp'' = 6\wp^2 - g_2/2$: $\wp = \tau^{-2} + g_2\tau^2/20 + g_3\tau^4/28 + g_2^2\tau^6/1200 + \dots$"""
    x, y = lp.systems.CanonicalSystem(["x"], ["y"], "y^2").variables
    found = expansion([y, 6 * x**2 - 10], [x, y], [2, 3], [1, -2])  # g2 = 20
    assert [(r.exponent, r.multiplicity, r.kernel, r.conditions) for r in found.resonances] == [
        (-1, 1, 1, None),
        (6, 1, 1, ()),
    ]
    assert found.coefficients[4][0] == {(): fmpq(1)}
    assert [found.coefficients[k][0] for k in (1, 2, 3, 5)] == [{}] * 4
    assert len(found.constants) == 1


THETA = ROOT.element([FUNCTIONS.number(0), FUNCTIONS.number(1)])
POWERS = [(0,), (1,), (2,)]


@pytest.mark.parametrize(
    ("field", "row", "expected"),
    [
        (Q, [0, 0, 0], None),
        (Q, [fmpq(-2, 3), 0, 0], "1"),
        (Q, [0, 0, fmpq(5)], "C1"),
        (Q, [fmpq(3), 0, fmpq(-2)], "-3/2 + C1^2"),
        (SQRT2, [SQRT2.element(fmpq_poly([1, 3])), SQRT2.number(0), SQRT2.number(0)], "1"),
        (
            FUNCTIONS,
            [FUNCTIONS.number(3) - S * S * S - S * S * S, FUNCTIONS.number(0), FUNCTIONS.number(0)],
            "s^3 - 3/2",
        ),
        (FUNCTIONS, [FUNCTIONS.number(0), S * S * S + S * S, FUNCTIONS.number(0)], "(s*(s + 1))*C1"),
        (ROOT, [THETA, ROOT.number(0), ROOT.number(0)], "s"),  # theta^2 = s: theta vanishes where s does
        (ROOT, [ROOT.element([S]) - THETA * ROOT.number(2), ROOT.number(0), ROOT.number(0)], "s*(s - 4)"),
    ],
    ids=lambda one: type(one).__name__,
)
def test_conditions_say_where_they_hold(field, row, expected):
    """The norm of s - 2 theta is (s - 2 theta)(s + 2 theta) = s^2 - 4s."""
    row = [field.number(c) if isinstance(c, int) else c for c in row]
    assert condition_text(POWERS, row, field) == expected
