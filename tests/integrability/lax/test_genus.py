"""The genus of plane curves: closed formulas, invariance under changes of coordinates, curves of Lax pairs."""

from fractions import Fraction
from math import gcd
from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.integrability.lax.genus import genus, interior_points

z, w = sp.symbols("z w")


def curve(expression):
    terms = sp.Poly(sp.expand(expression), z, w).terms()
    lead = max(terms, key=lambda t: t[0][1])[1]
    return {m: Fraction(int(c.p), int(c.q)) / Fraction(int(lead.p), int(lead.q)) for m, c in terms}


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        (w**2 - z**6 - z - 1, 2),
        (w**2 - z**3, 0),
        (w**2 - (z**2 + 1) ** 2 * (z**3 - z + 5), 1),
        (w**5 - z**2 - z * w, 1),  # one point inside its Newton polygon, and not degenerate
        ((w**2 - z**3) ** 2 - 4 * z**5 * w - z**7, 0),  # w = t^6 + t^7, z = t^4
        (w**3 - 3 * w * z**2 - 5 * z**3 + z**4, 0),  # three points of a quartic with a triple point come together
        ((w**2 + z**2) ** 3 - 4 * z**2 * w**2, 0),  # the rose of four leaves
        (w**3 + z**3 * w + z, 3),  # Klein's quartic
    ],
)
def test_known_curves(expression, value):
    found = genus(curve(expression))
    assert found.value == value
    assert value <= interior_points(curve(expression))


@pytest.mark.parametrize("seed", range(5))
def test_roots_of_polynomials(seed):
    """The covering w^n = prod (z - a_k)^m_k: over a_k there are gcd(n, m_k) places."""
    random = Random(seed)
    n = random.choice([2, 3, 4, 6])
    points = random.sample(range(-9, 10), random.randint(2, 4))
    powers = [random.randint(1, 5) for _ in points]
    if gcd(n, *powers) > 1:
        powers[0] = 1
    f = w**n - sp.prod([(z - a) ** m for a, m in zip(points, powers, strict=True)])
    ramification = sum(n - gcd(n, m) for m in (*powers, sum(powers)))
    assert genus(curve(f)).value == 1 - n + ramification // 2


@pytest.mark.parametrize("seed", range(3))
def test_the_genus_does_not_depend_on_the_coordinates(seed):
    random = Random(seed)
    a, b, c = (random.choice([-2, -1, 1, 2, 3]) for _ in range(3))
    f = w**3 + a * z * w**2 + (z**3 + b) * w + z**2 * (z - 1) ** 2 * (z + c)
    value = genus(curve(f)).value
    assert genus(curve(f.subs(w, w + z**2 + b))).value == value
    assert genus(curve(f.subs(z, 2 * z - 3))).value == value
    reflected = sp.expand(f.subs(z, 1 / z) * z**30)
    assert genus({(i - 30, j): v for (i, j), v in curve(reflected).items()} | {(0, 3): Fraction(1)}).value == value
    exchanged = curve(f.subs({z: w, w: z}, simultaneous=True))
    assert genus(exchanged).value == value


@pytest.mark.parametrize("seed", range(3))
def test_curves_without_singular_points_have_as_many_holes_as_their_polygon_has_points(seed):
    """Khovanskii's theorem, for random coefficients on random monomials with negative powers of z."""
    random = Random(seed)
    d = random.choice([2, 3, 4])
    f = {(0, d): Fraction(1)}
    for j in range(d):
        low, high = sorted(random.sample(range(-3, 5), 2))
        f |= {(i, j): Fraction(random.choice([-1, 1]) * random.randint(1, 99)) for i in range(low, high + 1)}
    assert genus(f).value == interior_points(f)


@pytest.mark.parametrize(
    ("name", "genera"),
    [
        ("twisted-lagrange", [0, 2]),
        ("manakov-so4", [3]),
        ("kovalevskaya", [5]),
        ("two-field-kovalevskaya", [7]),
        ("toda", [2]),
        ("leibniz-lagrange-5", [0, 4]),
        ("three-wave", [1]),
    ],
)
def test_spectral_curves_of_the_catalog(name, genera):
    found = lp.integrability.known_lax_pair(name).spectral_curve()
    assert [c.genus for c in found.components] == genera
    assert found.genus == max(genera)


@pytest.mark.parametrize(
    ("name", "symmetry", "degrees_of_freedom"),
    [
        ("neumann", "(z, w) -> (-z, w)", 2),
        ("manakov-so4", "(z, w) -> (-z, -w)", 2),
        ("free-rigid-body", "(z, w) -> (-z, -w)", 1),
    ],
)
def test_prym_varieties_have_the_dimension_of_the_tori(name, symmetry, degrees_of_freedom):
    pair = lp.integrability.known_lax_pair(name)
    [component] = pair.spectral_curve().components
    assert component.prym_dimensions[symmetry] == degrees_of_freedom == pair.system.bracket.rank() // 2


def test_a_curve_that_splits_over_the_complex_numbers_is_not_decided():
    found = genus(curve(w**2 + z**2))
    assert found.value is None
    assert "irreducible" in found.reason


def test_primes_of_bad_reduction_are_passed_over(monkeypatch):
    """Modulo 5 the zeros 0 and 5 of the discriminant come together: y^2 = x (x - 5) (x - 1) has genus 1, not 0."""
    monkeypatch.setattr("liepoisson.integrability.lax.genus._FIRST_PRIME", 4)
    found = genus(curve(w**2 - z * (z - 5) * (z - 1)))
    assert found.value == 1
    assert found.prime > 5
