"""The genus of plane curves: closed formulas, invariance under changes of coordinates, curves of Lax pairs."""

from fractions import Fraction
from math import gcd
from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.lax.genus import genus, interior_points

z, w = sp.symbols("z w")


def curve(expression):
    terms = sp.Poly(sp.expand(expression), z, w).terms()
    lead = max(terms, key=lambda t: t[0][1])[1]
    return {m: Fraction(int(c.p), int(c.q)) / Fraction(int(lead.p), int(lead.q)) for m, c in terms}


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        (w**2 - z**5 - z - 1, 2),
        (w**2 - z**6 - z - 1, 2),
        (w**2 - z**3, 0),
        (w**2 - z**2 * (z + 1), 0),
        (w**2 - (z**2 + 1) ** 2 * (z**3 - z + 5), 1),
        (w**4 + z**4 + z * w - 1, 3),
        (w**3 - z**3 - 1, 1),
        (w**5 - z**2 - z * w, 1),  # one point inside its Newton polygon, and not degenerate
        ((w**2 - z**3) ** 2 - 4 * z**5 * w - z**7, 0),  # w = t^6 + t^7, z = t^4
        (w**3 - 3 * w * z**2 - 5 * z**3 + z**4, 0),  # three points of a quartic with a triple point come together
        ((w**2 + z**2) ** 3 - 4 * z**2 * w**2, 0),  # the rose of four leaves
        ((w**2 + z**2) ** 2 - w**2 + z**2, 0),  # a lemniscate
        (w**3 + z**3 * w + z, 3),  # Klein's quartic
    ],
)
def test_known_curves(expression, value):
    found = genus(curve(expression))
    assert found.value == value
    assert value <= interior_points(curve(expression))


@pytest.mark.parametrize("seed", range(8))
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


def test_conjugate_branch_points_and_places():
    """Branch points that are conjugate, and branches that are conjugate over one."""
    assert genus(curve(w**3 - (z**2 - 2) ** 2 * (z**3 + z + 1))).value == 1 - 3 + (2 + 3 + 1) * 2 // 2
    # near z = 0 the branches are conjugate, w = +-sqrt(2) z + ..., with e = 2
    assert genus(curve((w**2 - 2 * z**2) ** 2 - z**5 - z**6)).value == 1


@pytest.mark.parametrize("seed", range(6))
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


@pytest.mark.parametrize("seed", range(6))
def test_curves_without_singular_points_have_as_many_holes_as_their_polygon_has_points(seed):
    """Khovanskii's theorem, for random coefficients on random monomials with negative powers of z."""
    random = Random(seed)
    d = random.choice([2, 3, 4])
    f = {(0, d): Fraction(1)}
    for j in range(d):
        low, high = sorted(random.sample(range(-3, 5), 2))
        f |= {(i, j): Fraction(random.choice([-1, 1]) * random.randint(1, 99)) for i in range(low, high + 1)}
    assert genus(f).value == interior_points(f)


def test_the_genus_does_not_depend_on_the_prime(monkeypatch):
    pair = lp.integrability.known_lax_pair("kovalevskaya")
    found = pair.spectral_curve().components[0]
    monkeypatch.setattr("liepoisson.integrability.lax.genus._FIRST_PRIME", 2**40)
    again = pair.spectral_curve().components[0]
    assert (again.genus, again.n_branch_points) == (found.genus, found.n_branch_points)


def test_primes_of_bad_reduction_are_passed_over(monkeypatch):
    """Modulo 5 the zeros 0 and 5 of the discriminant come together: y^2 = x (x - 5) (x - 1) has genus 1, not 0."""
    monkeypatch.setattr("liepoisson.integrability.lax.genus._FIRST_PRIME", 4)
    found = genus(curve(w**2 - z * (z - 5) * (z - 1)))
    assert found.value == 1
    assert found.prime > 5


def test_a_curve_that_splits_over_the_complex_numbers_is_not_decided():
    found = genus(curve(w**2 + z**2))
    assert found.value is None
    assert "irreducible" in found.reason


@pytest.mark.parametrize(
    ("name", "genera"),
    [
        ("lagrange", [0, 1]),
        ("twisted-lagrange", [0, 2]),
        ("leibniz-lagrange-4", [0, 3]),
        ("clebsch", [3]),
        ("manakov-so4", [3]),
        ("kovalevskaya", [5]),
        ("two-field-kovalevskaya", [7]),
        ("toda", [2]),
        ("charged-lagrange", [0, 1]),
        ("charged-twisted-lagrange", [0, 2]),
        ("leibniz-lagrange-5", [0, 4]),
        ("kovalevskaya-gyrostat", [6]),
        ("free-rigid-body", [1]),
        ("neumann", [3]),
        ("three-wave", [1]),
    ],
)
def test_spectral_curves_of_the_catalog(name, genera):
    for seed in (0, 1):
        found = lp.integrability.known_lax_pair(name).spectral_curve(seed=seed)
        assert [c.genus for c in found.components] == genera
        assert found.genus == max(genera)


@pytest.mark.parametrize(
    ("name", "symmetry", "degrees_of_freedom"),
    [
        ("clebsch", "(z, w) -> (-z, w)", 2),
        ("neumann", "(z, w) -> (-z, w)", 2),
        ("manakov-so4", "(z, w) -> (-z, -w)", 2),
        ("free-rigid-body", "(z, w) -> (-z, -w)", 1),
    ],
)
def test_prym_varieties_have_the_dimension_of_the_tori(name, symmetry, degrees_of_freedom):
    pair = lp.integrability.known_lax_pair(name)
    [component] = pair.spectral_curve().components
    assert component.prym_dimensions[symmetry] == degrees_of_freedom == pair.system.bracket.rank() // 2


@pytest.mark.parametrize(("name", "tori"), [("kovalevskaya", 2), ("two-field-kovalevskaya", 3)])
def test_quotients_of_the_curves_of_kovalevskaya(name, tori):
    """The curve in z^2 and w covers an elliptic curve in z^2 and w^2: the Prym variety is as large as the tori."""
    [component] = lp.integrability.known_lax_pair(name).spectral_curve().components
    genera = {q.symmetry: q.genus for q in component.quotients}
    assert genera["(z, w) -> (+-z, +-w)"] == 1
    assert genera["(z, w) -> (-z, w)"] - genera["(z, w) -> (+-z, +-w)"] == tori
    assert component.genus < component.interior_points or name.startswith("two")


def test_points_of_the_curve():
    pair = lp.integrability.known_lax_pair("lagrange")
    found = pair.spectral_curve([1, 2, 3, 1, 0, 0])
    assert found.polynomial.subs({"z": 1, "w": 0}) == 0
    assert sp.expand(found.polynomial - w * (w**2 + (z + 1) ** 2 + 4 * z**2 + (z**2 + 3 * z) ** 2)) == 0
    named = dict(zip(pair.system.component_names, [1, 2, 3, 1, 0, 0], strict=True))
    assert pair.spectral_curve(named).polynomial == found.polynomial
    sphere = pair.spectral_curve([0, 0, 1, 0, 0, 2])  # the sleeping top: the curve degenerates
    assert sphere.genus in (0, None)
    with pytest.raises(ParameterError, match="got none of alpha3"):
        pair.spectral_curve({k: v for k, v in named.items() if k != "alpha3"})
    with pytest.raises(ParameterError, match="wanted values of l1"):
        pair.spectral_curve([1, 2])
    with pytest.raises(ParameterError, match="rational numbers"):
        pair.spectral_curve([1, 2, 3, 1, 0, "sqrt(2)"])
    with pytest.raises(ParameterError, match="with a spectral parameter"):
        lp.integrability.lax_pair(pair.system, "alpha", "inv(I)*l", spectral=None).spectral_curve()
