"""Fields of any size: the same system in other units has the same leaves, extrema, samples, equilibria and sections.

A heavy top on so(3) @ semidirect(2) with l = r L, alpha = s A and time in units 1/r is the same top: its bracket does
not change, and H(l, alpha) = r^2 H'(l/r, alpha/s).
"""

import numpy as np
import pytest
from sympy import Matrix, Rational

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError
from liepoisson.leaf.leaf_in_units import in_units, scaling
from liepoisson.model.phase_functions import gradients_of, values_of_all
from liepoisson.phase_space import find_start

UNITS = [(1e-10, 1.0), (1.0, 1e-9), (1e-30, 1e30)]


def exact(x):
    return Rational(str(x))


def clebsch(r=1.0, s=1.0):
    """H = l1^2/2 + l2^2 + 2 l3^2 + 4 p1^2 + 2 p2^2 + p3^2 in units."""
    base = lp.catalog.system("clebsch")
    l, p = Matrix(base.variables[:3]) / exact(r), Matrix(base.variables[3:]) / exact(s)
    energy = l[0] ** 2 / 2 + l[1] ** 2 + 2 * l[2] ** 2 + 4 * p[0] ** 2 + 2 * p[1] ** 2 + p[2] ** 2
    return lp.System(base.bracket, exact(r) ** 2 * energy)


def pendulum(r=1.0, s=1.0):
    """H = |l|^2/2 + p3, the spherical top, in units."""
    base = lp.catalog.system("clebsch")
    l, p = Matrix(base.variables[:3]) / exact(r), Matrix(base.variables[3:]) / exact(s)
    return lp.System(base.bracket, exact(r) ** 2 * (l.dot(l) / 2 + p[2]))


def values(c1, r, s):
    """l.p = c1, |p|^2 = 1 in units."""
    return {"C1": c1 * r * s, "C2": s**2}


def scaled(x, r, s):
    return np.asarray(x) * np.repeat([r, s], 3)


def test_ordinary_systems_are_left_alone():
    leaf = lp.Leaf(clebsch(), values(0.2, 1, 1))
    assert (leaf.in_units().units == 1.0).all()


@pytest.mark.parametrize(("r", "s"), UNITS)
def test_units_follow_the_fields(r, s):
    leaf = lp.Leaf(pendulum(r, s), values(0.5, r, s))
    units = leaf.in_units().units
    assert np.log2(units) == pytest.approx(np.log2(scaled(np.ones(6), r, s)), abs=1.5)
    assert (np.frexp(units)[0] == 0.5).all()  # powers of two
    assert np.abs(leaf.in_units().state).max() < 20


def test_a_value_that_is_small_by_cancellation_is_no_unit():
    system = pendulum()
    for small in (1e-9, 1e-30):
        leaf = lp.Leaf(system, {"C1": small, "C2": 1})
        assert (leaf.in_units().units == 1.0).all()
    top = lp.Top.twisted_kovalevskaya()
    assert (lp.Leaf(top, {"C1": 1e-12, "C2": 1, "C3": 1}).in_units().units == 1.0).all()


def test_a_field_that_is_strong_in_the_hamiltonian_makes_momenta_long():
    base = lp.catalog.system("clebsch")
    l, p = base.variables[:3], base.variables[3:]
    anisotropic = lp.System(base.bracket, sum(x**2 for x in l) / 2 + 10**9 * p[2] ** 2)
    units = scaling(anisotropic, anisotropic.functions.casimirs, np.array([0.5, 1.0]))
    assert units[0] / units[3] > 1e3


@pytest.mark.parametrize(("r", "s"), UNITS)
def test_lowest_energy_of_the_spherical_top(r, s):
    """H >= (l.p)^2/(2|p|^2) + p3 >= 1/8 - 1 at l.p = 1/2, |p| = 1, attained at p3 = -1 with l along p."""
    low, high = lp.Leaf(pendulum(r, s), values(0.5, r, s)).energy_range()
    assert low / r**2 == pytest.approx(-0.875, rel=1e-12)
    assert high == np.inf


@pytest.mark.parametrize(("r", "s"), [(1e-10, 1e5)])
def test_equilibria_of_a_clebsch_system(r, s):
    here = lp.equilibria(clebsch(), values(0.2, 1, 1), n_starts=40)
    there = lp.equilibria(clebsch(r, s), values(0.2, r, s), n_starts=40)
    assert len(there) == len(here) == 6
    for one, other in zip(here, there, strict=True):
        assert other.energy / r**2 == pytest.approx(one.energy, rel=1e-10)
        assert other.signature == one.signature
        assert other.residual < 1e-12
        assert other.spectrum / r == pytest.approx(one.spectrum, abs=1e-8)
        state = other.state / scaled(np.ones(6), r, s)
        again = lp.phase_space.equilibrium(clebsch(), state)
        assert again.energy == pytest.approx(one.energy, rel=1e-10)
        assert lp.phase_space.equilibrium_near(clebsch(r, s), other.state * (1 + 1e-4)).residual < 1e-12


@pytest.mark.parametrize("size", [1e-6, 1e-20])
def test_a_small_field_is_seen(size):
    system = lp.catalog.system("twisted-kovalevskaya")
    x = np.random.default_rng(3).standard_normal(9) * np.repeat([1, 1, size], 3)
    leaf = lp.Leaf.through(system, x)
    assert leaf.contains(x)
    moved = x * np.r_[np.ones(6), 1 + 1e-6, 1, 1]
    assert leaf.residual(moved) > 1e-8
    assert not leaf.contains(moved)
    back = leaf.project(moved)
    assert leaf.residual(back) < 1e-12
    assert back == pytest.approx(x, rel=1e-5)
    with pytest.raises(LeafError, match="start must lie on the leaf"):
        find_start(system, start=moved, leaf=leaf)
    assert find_start(system, start=x, leaf={"C3": float(x[6:] @ x[6:])}).origin == "as given"


def henon_heiles(a=1.0, b=1.0):
    """Lengths in units a, momenta in units b; the bracket {q, p} = 1 makes the energy one of a b."""
    energy = f"dot(p, p)/2/{b!r}^2 + dot(q, q)/2/{a!r}^2 + (q1^2*q2 - q2^3/3)/{a!r}^3"
    return lp.System(lp.canonical(2), f"{a!r}*{b!r}*({energy})")


CANONICAL = [(1e20, 1e20), (1e-10, 1e-24)]


@pytest.mark.parametrize(("a", "b"), CANONICAL)
def test_equilibria_of_a_canonical_system(a, b):
    """Hénon and Heiles (1964): the origin, and saddles of energy 1/6 at (0, 1) and 120 degrees from it."""
    system = henon_heiles(a, b)
    found = lp.equilibria(system, lp.Leaf(system, {}), n_starts=40)
    assert [e.linear_stability for e in found] == ["stable spectrum", "unstable", "unstable", "unstable"]
    assert [e.signature for e in found] == [(4, 0, 0), (3, 1, 0), (3, 1, 0), (3, 1, 0)]
    assert [e.energy / (a * b) for e in found] == pytest.approx([0, 1 / 6, 1 / 6, 1 / 6], abs=1e-12)
    near = lp.phase_space.equilibrium_near(system, np.array([0.02 * a, 0.98 * a, 0.001 * b, 0.0]))
    assert near.state / [a, a, b, b] == pytest.approx([0, 1, 0, 0], abs=1e-12)
    with pytest.raises(ParameterError, match="state must be an equilibrium"):
        lp.phase_space.equilibrium(system, [0, 0.999 * a, 0, 0])


@pytest.mark.parametrize("size", [10**3, 10**10, 10**11])
def test_a_multiple_of_a_casimir_in_the_hamiltonian_is_no_unit(size):
    """H + c C2 has the equations of H, and its least energy is that of H and c C2: -0.96760024, as for c = 0."""
    top = "(l1^2 + l2^2 + 2*l3^2)/2 + alpha3"
    bracket, state = lp.so(3) @ lp.semidirect(2), [0.3, 0, 0, 0.6, 0, 0.8]
    plain = lp.Leaf.through(lp.System(bracket, top), state).energy_range()[0]
    for function in (f"{top} + {size}*dot(alpha, alpha)", f"{top} + sqrt(2)*{size}*dot(alpha, alpha)"):
        system = lp.System(bracket, function)
        own = float(system.functions.energy(state)) - float(lp.System(bracket, top).functions.energy(state))
        assert lp.Leaf.through(system, state).energy_range()[0] - own == pytest.approx(plain, abs=1e-14 * size + 1e-9)


def test_several_functions_have_together_the_values_that_each_has():
    """Polynomials, also in common units, and where one is none or has other units."""
    top = lp.catalog.system("twisted-kovalevskaya")
    x, units = np.random.default_rng(1).normal(size=(4, 3, 9)), np.repeat([1.0, 1e3, 1e-2], 3)
    plain = [top.functions.energy, *top.functions.casimirs.values()]
    assert all(f.polynomial is not None for f in plain)
    scaled = [in_units(f, units) for f in plain]
    for functions in (plain, scaled, [*plain, top.functions.of("exp(l1)")], [*plain, *scaled], []):
        values, slopes = values_of_all(functions, x), gradients_of(functions, x)
        assert values.shape == (4, 3, len(functions))
        assert slopes.shape == (4, 3, len(functions), 9)
        for k, f in enumerate(functions):
            np.testing.assert_array_equal(values[..., k], f(x))
            np.testing.assert_array_equal(slopes[..., k, :], f.gradient(x))
