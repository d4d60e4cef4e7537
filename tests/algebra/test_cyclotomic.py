import cmath
import math

import pytest
import sympy as sp

from liepoisson.algebra.cyclotomic import CyclotomicField, cyclotomic_images

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
