import cmath
import math

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.algebra.cyclotomic import CyclotomicField, cyclotomic_images

exactly = settings(deadline=None, max_examples=50, derandomize=True)

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
def test_images_have_the_value_of_the_expression(atom):
    images = cyclotomic_images([atom])
    assert images is not None
    assert cmath.isclose(value(images[atom]), complex(atom), rel_tol=1e-12, abs_tol=1e-12)


@pytest.mark.thorough
@exactly
@given(st.lists(st.sampled_from(ATOMS[:8]), min_size=3, max_size=3))
def test_arithmetic_follows_that_of_the_numbers(atoms):
    images = cyclotomic_images(atoms)
    a, b, c = (images[atom] for atom in atoms)
    x, y, z = (complex(atom) for atom in atoms)
    assert cmath.isclose(value((a + b) * c - a / b), (x + y) * z - x / y, rel_tol=1e-9, abs_tol=1e-9)
    assert not (a + b) * c - a * c - b * c
    assert not a / b * b - a
    assert -a + a == a - a or not (-a + a)


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


@exactly
@given(st.integers(1, 30), st.integers(1, 15))
def test_squares_of_sine_and_cosine_add_up(p, q):
    field = CyclotomicField(math.lcm(4, 2 * q))
    s, c = field.sine(p, q), field.cosine(p, q)
    assert not s * s + c * c - field.one


@pytest.mark.parametrize("prime", [2, 3, 5, 7, 11, 13])
def test_gauss_sums_are_positive_square_roots(prime):
    root = CyclotomicField(8 * prime).square_root(prime)
    assert not root * root - root.field.number(prime)
    assert cmath.isclose(value(root), math.sqrt(prime), rel_tol=1e-12)


@exactly
@given(st.sampled_from([atom for atom in ATOMS if atom.is_real]))
def test_real_numbers_are_written_back(atom):
    image = cyclotomic_images([atom])[atom]
    again = image.field.to_sympy(image)
    assert not cyclotomic_images([again - atom])[again - atom]


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


def test_division_by_zero_is_an_error():
    field = CyclotomicField(12)
    with pytest.raises(ZeroDivisionError):
        field.one / field.zero
