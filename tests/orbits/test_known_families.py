"""Families of systems that the literature knows, against closed forms and an independent integrator."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk

import liepoisson as lp

KOVALEVSKAYA = lp.catalog.system("kovalevskaya")


def off_the_critical_curves(energy, k, ell2):
    """How far K is from the nearest critical value at an energy, with ell = (l.alpha)/2, |alpha| = 1.

    k = 0; k = (h - 2 ell^2)^2; h = s + ell^2/s^2, k = 1 - 2 ell^2/s + ell^4/s^4.
    """
    s = np.roots([1, -energy, 0, ell2])
    s = s[np.abs(s.imag) < 1e-9].real
    values = [0, (energy - 2 * ell2) ** 2, *(1 - 2 * ell2 / s + ell2**2 / s**4)]
    return min(abs(k - value) for value in values)


@pytest.mark.parametrize(("c", "energy"), [("1/2", "1"), ("1/5", "2")])
def test_isolated_orbits_of_kovalevskaya_have_critical_integrals(c, energy):
    """On regular tori orbits belong to families; those that are alone have the values of the bifurcation diagram."""
    k, ell2 = KOVALEVSKAYA.functions.of(KOVALEVSKAYA.invariants["K"]), float(Fraction(c) / 2) ** 2
    found = lp.orbits.periodic_orbits(KOVALEVSKAYA, {"C1": c, "C2": 1}, energy, n_starts=40)
    assert len(found) > 2
    assert found.n_families > 10
    for one in found:
        assert off_the_critical_curves(one.energy, float(k(one.start)), ell2) < 1e-12
    family = lp.orbits.orbit_family(KOVALEVSKAYA, found[0], max_orbits=6)
    assert max(off_the_critical_curves(one.energy, float(k(one.start)), ell2) for one in family) < 1e-11


def test_isolated_orbits_of_lagrange_are_precessions():
    """With l3 free, orbits that are alone on a level stand still for an observer who precesses: alpha3 and l3 rest."""
    top = lp.catalog.system("lagrange")
    found = lp.orbits.periodic_orbits(top, {"C1": "1/2", "C2": 1}, "1", n_starts=40)
    assert len(found) > 0
    for one in found:
        states = one.states(21)
        assert np.ptp(states[:, [2, 5]], axis=0).max() < 1e-9


def three_bodies(mu):
    """The planar restricted problem in the rotating frame."""
    first, second = f"sqrt((q1 + {mu})^2 + q2^2)", f"sqrt((q1 - 1 + {mu})^2 + q2^2)"
    return lp.System(
        lp.canonical(2), f"(p1^2 + p2^2)/2 + q2*p1 - q1*p2 - (1 - {mu})/{first} - {mu}/{second}", name="three bodies"
    )


def closes(one, tolerance):
    """Whether another integrator closes an orbit, to what its neighbours grow."""
    field = one.system.vector_field
    run = solve_ivp(lambda _, x: field(x), (0, one.period), one.start, method="DOP853", rtol=1e-13, atol=1e-14)
    largest = np.abs(one.multipliers).max(initial=1.0)
    return np.abs(run.y[:, -1] - one.start).max() < tolerance * (1 + largest)


@pytest.mark.parametrize("bounds", [(0.5, 0.98), (0.99, 1.5)], ids=["L1", "L2"])
def test_lyapunov_families_of_the_earth_and_the_moon(bounds):
    """They begin with the frequency of the planar oscillation at L1 and L2, and end far from them."""
    mu = 0.01215
    system = three_bodies("0.01215")
    x = brentq(lambda x: x - (1 - mu) * (x + mu) / abs(x + mu) ** 3 - mu * (x - 1 + mu) / abs(x - 1 + mu) ** 3, *bounds)
    rest = lp.phase_space.equilibrium(system, [x, 0, 0, x])
    family = lp.orbits.orbit_family(system, rest, max_orbits=30)
    c = (1 - mu) / abs(x + mu) ** 3 + mu / abs(x - 1 + mu) ** 3
    frequency = np.sqrt(((2 - c) + np.sqrt(9 * c * c - 8 * c)) / 2)
    assert family.period[0] == pytest.approx(2 * np.pi / frequency, rel=1e-3)
    assert np.all(np.diff(family.period[:12]) > 0)
    assert {one.stability for one in family} == {"hyperbolic"}
    assert max(one.residual for one in family) <= 1e-12
    for one in (family[0], family[8], family[15]):
        assert closes(one, 1e-11)  # some hundred steps of 1e-13
    np.testing.assert_allclose(family[20].states(5)[0], family[20].states(5)[-1], atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2))
def test_lyapunov_families_of_a_heavy_top(number):
    """Of each frequency of the lowest equilibrium, every orbit by another integrator."""
    top = lp.catalog.system("heavy-top", {"I": [3, 2, "7/5"], "a": ["1/2", 0, "4/5"]})
    family = lp.orbits.orbit_family(top, lp.equilibria(top, {"C1": "3/10", "C2": 1})[0], mode=number, max_orbits=25)
    for one in family:
        assert closes(one, 1e-11)
        assert one.pair_defect < 1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("turns", range(3))
def test_straight_orbits_of_henon_and_heiles(turns):
    r"""All three, up to the saddle: with the roots $y_1 < y_2 < y_3$ of $2E - y^2 + 2y^3/3$ the period is
    $\sqrt{24/(y_3 - y_1)}\,K(m)$, $m = (y_2 - y_1)/(y_3 - y_1)$."""
    system = lp.catalog.system("henon-heiles")
    angle = 2 * np.pi * turns / 3
    start = [0, 0, -0.2 * np.sin(angle), 0.2 * np.cos(angle)]
    straight = lp.orbits.periodic_orbit(system, start, period=6.3)
    family = lp.orbits.orbit_family(system, straight, until=0.165, longest_step=0.1)
    assert len(family) > 10
    for one in family:
        first, second, third = np.sort(np.roots([2 / 3, -1, 0, 2 * one.energy]).real)
        parameter = (second - first) / (third - first)
        assert one.period == pytest.approx(np.sqrt(24 / (third - first)) * ellipk(parameter), rel=1e-13)
        np.testing.assert_allclose(one.states(9)[:, :2] @ [np.cos(angle), np.sin(angle)], 0, atol=1e-12)


def hill(k, rest_length, amplitude):
    """Of x'' = -k(1 - l0/r(t)) x with r(t) = l0 + 1/k + A cos(sqrt(k) t), the trace after one period, by DOP853."""
    rate = np.sqrt(k)

    def rates(t, z):
        stiffness = k * (1 - rest_length / (rest_length + 1 / k + amplitude * np.cos(rate * t)))
        return [z[1], -stiffness * z[0], z[3], -stiffness * z[2]]

    run = solve_ivp(rates, (0, 2 * np.pi / rate), [1, 0, 0, 1], "DOP853", rtol=1e-13, atol=1e-14)
    return run.y[0, -1] + run.y[3, -1]


@pytest.mark.thorough
def test_the_vertical_orbits_of_a_spring_pendulum():
    r"""They are harmonic, $2\pi/\sqrt k$, with the energy $kA^2/2$, until the mass comes to the pivot; across them the
    motion is Hill's, and at its first parametric resonance the orbits with twice the period leave."""
    k, rest_length = 3, 3 / 4
    system = lp.catalog.system("spring-pendulum", {"k": k, "l0": "3/4"})
    length = rest_length + 1 / k
    rest = lp.phase_space.equilibrium(system, [0, -length, 0, 0])
    np.testing.assert_allclose(rest.frequencies, [length**-0.5, k**0.5], rtol=1e-14)
    family = lp.orbits.orbit_family(system, rest, mode=0, until=rest.energy + k * (0.9 * length) ** 2 / 2)
    assert family.end == "the wanted value"
    np.testing.assert_allclose(family.period, 2 * np.pi / np.sqrt(k), rtol=1e-14)
    for one in family:
        trace = hill(k, rest_length, np.sqrt(2 * (one.energy - rest.energy) / k))
        assert one.multipliers.sum().real == pytest.approx(trace, rel=1e-10)
    (point,) = family.points
    resonance = brentq(lambda amplitude: hill(k, rest_length, amplitude) + 2, 0.1, 0.2, xtol=1e-14)
    assert point.kind == "double period"
    assert point.orbit.energy == pytest.approx(rest.energy + k * resonance**2 / 2, rel=1e-12)


def symbols_of(name):
    """The parameters of an entry without numbers."""
    return {one.partition("[")[0] for one in lp.catalog.entry(name).symbols}


ONLY_IN_FAMILIES = {"charged-lagrange", "leibniz-lagrange-4", "leibniz-lagrange-5", "twisted-lagrange"}
"""Of these the short search below finds orbits that are not alone on their level, which it counts."""
NONE_FOUND = {
    *("henon-heiles-kdv", "henon-heiles-sawada-kotera", "so21-heavy-top", "so21-twisted-top", "three-wave", "toda"),
}
"""Of these, whose levels are not bounded, nothing."""


NUMBERS = {"I": [2, "3/2", 1], "a": [1, 0, "1/2"], "b": [0, "1/3", 0], "epsilon": 1}
"""For the symbols of entries that have no numbers."""


@pytest.mark.slow
@pytest.mark.parametrize("name", lp.catalog.names())
def test_orbits_of_the_catalog_close_by_another_integrator(name):
    """All that are found on the level of a random state."""
    system = lp.catalog.system(name, {symbol: NUMBERS[symbol] for symbol in symbols_of(name)} or None)
    state = 0.4 * np.random.default_rng(1).standard_normal(len(system.component_names))
    if name in {"double-pendulum", "spring-pendulum"}:
        state[1] -= 0.6
    if not system.bracket.has_algebra:  # numbers of species are positive
        state += 1
    leaf = {casimir: float(f(state)) for casimir, f in system.functions.casimirs.items()}
    energy = float(system.functions.energy(state))
    if name == "lotka-volterra-4":  # random states have negative numbers, of which there is no logarithm
        with pytest.raises(lp.errors.LeafError, match="could be moved"):
            lp.orbits.periodic_orbits(system, leaf, energy, n_starts=20)
        return
    found = lp.orbits.periodic_orbits(system, leaf, energy, n_starts=20)
    for one in found:
        assert closes(one, 1e-11)
    assert (len(found) > 0) == (name not in ONLY_IN_FAMILIES | NONE_FOUND)
    assert (len(found) + found.n_families > 0) == (name not in NONE_FOUND)
