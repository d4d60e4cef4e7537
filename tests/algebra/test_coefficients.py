import cmath
import math
from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.cyclotomic import CyclotomicField, cyclotomic_images

s, t = sp.symbols("s t")
VALUES = {
    "rational": [Fraction(1, 2), Fraction(-3)],
    "over pi": [sp.sin(2 * sp.pi / 7) / sp.pi, 3 / sp.pi],
    "roots": [sp.sqrt(2), sp.sqrt(3) + 1],
    "cube roots": [sp.cbrt(2), sp.cbrt(4) + 1],
    "symbols": [s, (s + t) / (s - 1)],
    "roots and symbols": [sp.sqrt(2) * s, t],
    "other": [sp.cbrt(2), sp.log(3)],
}


@pytest.mark.parametrize("name", VALUES)
def test_values_are_read_and_written_back(name):
    values = VALUES[name]
    field = Coefficients.containing(values)
    a, b = (field.read(value) for value in values)
    for value in values:
        assert sp.simplify(field.to_sympy(field.read(value), 1) - value) == 0
    assert sp.simplify(field.to_sympy(a * b + a * a, 2) - (values[0] * values[1] + values[0] ** 2)) == 0
    assert sp.simplify(field.to_sympy(a / b) - sp.sympify(values[0]) / values[1]) == 0
    assert field.to_sympy(field.number(Fraction(2, 3))) == sp.Rational(2, 3)
    if name != "other":  # each prime has another homomorphism
        images = [field.residues(seed=1, skipped=k) for k in range(3)]
        assert len({image.p for image in images}) == 3
        assert all(image(a * b - a) == (image(a) * image(b) - image(a)) % image.p for image in images)


def test_a_common_power_of_pi_is_set_aside_and_different_powers_stay_apart():
    field = Coefficients.containing([sp.sqrt(2) / sp.pi**2, sp.S.Zero, 1 / sp.pi**2])
    assert (field.is_cyclotomic, field.scale) == (True, sp.pi**-2)
    root = field.read(sp.sqrt(2) / sp.pi**2)
    assert (field.to_sympy(root * root), field.to_sympy(root * root, 2)) == (2, 2 / sp.pi**4)
    other = Coefficients.containing([sp.pi, sp.S.One])
    assert not other.is_cyclotomic
    assert other.to_sympy(other.read(sp.pi) * other.read(sp.pi) - other.one) == sp.pi**2 - 1


@pytest.mark.parametrize(
    ("values", "zero", "nonzero"),
    [
        ([sp.sin(s), sp.cos(s)], lambda x, y: x * x + y * y - 1, lambda x, y: x * x - y * y),
        ([sp.log(2), sp.log(3), sp.log(6)], lambda x, y, z: z - x - y, lambda x, y, z: z - x),
    ],
)
def test_hidden_relations_vanish(values, zero, nonzero):
    field = Coefficients.containing(values)
    read = [field.read(value) for value in values]
    assert not field.decides
    assert field.vanishes(zero(*read))
    assert not field.vanishes(nonzero(*read))


@pytest.mark.parametrize(
    ("decides", "values"),
    [
        # one transcendental number, by Hermite and Lindemann: Q(number) is a field of rational functions
        *((True, [number]) for number in (sp.pi, sp.log(2), sp.sin(1), sp.exp(2), sp.atan(sp.Rational(1, 5)))),
        (True, [sp.E, s]),
        (True, [sp.cbrt(2)]),
        *((False, v) for v in ([sp.pi, sp.E], [sp.E, sp.sqrt(sp.E)], [sp.EulerGamma], [sp.exp(s), s], [sp.zeta(3)])),
    ],
)
def test_zero_is_decided_where_the_numbers_are_known_to_be_independent(decides, values):
    assert Coefficients.containing([*values, sp.S.One]).decides is decides


ATOMS = [
    sp.sin(sp.pi / 7),
    sp.cos(2 * sp.pi / 9),
    sp.sin(2 * sp.pi / 5),
    sp.cos(sp.pi / 8),
    sp.sin(sp.pi / 15),
    sp.sqrt(2),
    sp.sqrt(3),
    sp.sqrt(sp.Rational(20, 63)),
    1 / sp.sqrt(7),
    sp.sqrt(-5),
    sp.I,
    sp.Rational(-3, 4),
    sp.sin(2 * sp.pi / 11),
]


def value(number):
    """The number at zeta = exp(2 pi i / n), in floating point."""
    zeta = cmath.exp(2j * math.pi / number.field.order)
    return sum(float(int(c.p)) / int(c.q) * zeta**k for k, c in enumerate(number.polynomial.coeffs()))


@pytest.mark.parametrize("atom", ATOMS, ids=str)
def test_images_have_the_value_of_the_expression_and_are_written_back(atom):
    image = cyclotomic_images([atom])[atom]
    assert cmath.isclose(value(image), complex(atom), rel_tol=1e-12, abs_tol=1e-12)
    if atom.is_real:
        again = image.field.to_sympy(image)
        assert not cyclotomic_images([again - atom])[again - atom]


@pytest.mark.parametrize(
    "zero",
    [
        sp.sin(sp.pi / 7) * sp.sin(2 * sp.pi / 7) * sp.sin(3 * sp.pi / 7) - sp.sqrt(7) / 8,
        sp.cos(sp.pi / 7) - sp.cos(2 * sp.pi / 7) + sp.cos(3 * sp.pi / 7) - sp.Rational(1, 2),
        sp.sqrt(6) - sp.sqrt(2) * sp.sqrt(3, evaluate=False),
        sp.sin(sp.pi / 5) ** 2 - sp.sin(2 * sp.pi / 5) ** 2 + sp.sqrt(5) / 4,
    ],
    ids=str,
)
def test_identities_are_decided(zero):
    assert not cyclotomic_images([zero])[zero]
    near = zero + sp.Rational(1, 10**30)
    assert cyclotomic_images([near])[near]


@pytest.mark.parametrize("prime", [2, 3, 5, 7, 11, 13])
def test_gauss_sums_are_positive_square_roots(prime):
    root = CyclotomicField(8 * prime).square_root(prime)
    assert not root * root - root.field.number(prime)
    assert cmath.isclose(value(root), math.sqrt(prime), rel_tol=1e-12)


@pytest.mark.parametrize(
    "other",
    [
        sp.pi,
        sp.Symbol("x"),
        sp.sin(1),
        sp.cbrt(2),
        sp.sqrt(1 + sp.sqrt(2)),
        sp.log(2),
        sp.sqrt(10**9 + 7),
        sp.sin(sp.pi / 5003),
    ],
)
def test_other_numbers_have_no_image(other):
    assert cyclotomic_images([sp.sqrt(2), other]) is None
