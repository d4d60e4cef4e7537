"""Fields of any size: the same system in other units has the same leaves, extrema, samples, equilibria and sections.

A heavy top on so(3) @ semidirect(2) with l = r L, alpha = s A and time in units 1/r is the same top: its bracket does
not change, and H(l, alpha) = r^2 H'(l/r, alpha/s).
"""

from fractions import Fraction

import numpy as np
import pytest
from sympy import Matrix, Rational, exp, sin, sqrt

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError
from liepoisson.leaf.leaf_in_units import field_units
from liepoisson.phase_space import find_start
from liepoisson.sections import default_surface, section_starts, section_state

UNITS = [(1e-3, 1.0), (1e-5, 1.0), (1e-10, 1.0), (1e4, 1.0), (1.0, 1e-9), (1e-7, 1e8), (1e-30, 1e30)]
EXTREME = [(1.0, 1.0), *UNITS]


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
    units = field_units(anisotropic, anisotropic.functions.casimirs, np.array([0.5, 1.0]))
    assert units[0] / units[3] > 1e3


@pytest.mark.parametrize(("c1", "c2"), [(700, 1), (7e5, 1), (1e-3, 1e-8), (1e12, 1)])
def test_leaves_by_values_of_other_sizes_exist(c1, c2):
    system = lp.catalog.system("kovalevskaya")
    leaf = lp.Leaf(system, {"C1": c1, "C2": c2})
    l, a = leaf.state.reshape(2, 3)
    assert l @ a == pytest.approx(c1, rel=1e-12)
    assert a @ a == pytest.approx(c2, rel=1e-12)


@pytest.mark.parametrize(("r", "s"), EXTREME)
def test_lowest_energy_of_the_spherical_top(r, s):
    """H >= (l.p)^2/(2|p|^2) + p3 >= 1/8 - 1 at l.p = 1/2, |p| = 1, attained at p3 = -1 with l along p."""
    low, high = lp.Leaf(pendulum(r, s), values(0.5, r, s)).energy_range()
    assert low / r**2 == pytest.approx(-0.875, rel=1e-12)
    assert high == np.inf


@pytest.mark.parametrize(
    ("r", "s"),
    [
        pytest.param(1e-3, 1.0, marks=pytest.mark.slow),
        pytest.param(1e-5, 1.0, marks=pytest.mark.slow),
        (1e-7, 1e8),
        pytest.param(1e4, 1.0, marks=pytest.mark.slow),
    ],
)
def test_sample_of_the_spherical_top(r, s):
    """At H = 1, l.p = 1/2 the momentum across p fills a disc boundary: p is uniform on |p| = 1 where p3 <= 7/8.

    So p3 is uniform on [-1, 7/8], with mean -1/16 and standard deviation 1.875/sqrt(12).  Over 16 seeds the mean of
    2048 states has a standard deviation of 0.009 to 0.011; four of 0.0125 are exceeded with a probability below 1e-4.
    """
    leaf = lp.Leaf(pendulum(r, s), values(0.5, r, s))
    x = leaf.sample(2048, seed=5, energy=r**2)
    p3 = x[:, 5] / s
    assert p3.mean() == pytest.approx(-1 / 16, abs=4 * 0.0125)
    assert p3.std() == pytest.approx(1.875 / np.sqrt(12), rel=0.1)
    assert leaf.residual(x).max() < 1e-12
    assert leaf.system.functions.energy(x) / r**2 == pytest.approx(1.0, rel=1e-10)


def test_sample_at_high_energy():
    """At H = 1e8 gravity does not matter: p is uniform on the sphere, <p3> = 0 and <p3^2> = 1/3."""
    leaf = lp.Leaf(pendulum(), values(0.5, 1, 1))
    p3 = leaf.sample(2048, seed=1, energy=1e8)[:, 5]
    assert p3.mean() == pytest.approx(0.0, abs=4 * 0.0135)
    assert (p3**2).mean() == pytest.approx(1 / 3, abs=4 * 0.007)


@pytest.mark.parametrize(
    ("r", "s"),
    [
        pytest.param(1e-3, 1.0, marks=pytest.mark.slow),
        pytest.param(1e-6, 1.0, marks=pytest.mark.slow),
        (1e-10, 1e5),
        (1e5, 1.0),
    ],
)
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


@pytest.mark.parametrize("size", [1.0, 1e-6, 1e-12, 1e-20, 1e9])
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
    with pytest.raises(LeafError, match="C3 ="):
        find_start(system, start=moved, leaf={"C3": float(x[6:] @ x[6:])})
    assert find_start(system, start=x, leaf={"C3": float(x[6:] @ x[6:])}).origin == "as given"


def test_an_energy_that_is_a_little_off_is_seen_in_any_unit():
    system, x = pendulum(1e-8, 1.0), scaled([0.3, 0.1, 0.2, 0.6, 0.0, 0.8], 1e-8, 1.0)
    energy = float(system.functions.energy(x))
    assert find_start(system, start=x, energy=energy).energy == energy
    with pytest.raises(LeafError, match="H ="):
        find_start(system, start=x, energy=1.001 * energy)


@pytest.mark.parametrize(("r", "s"), [(1e-8, 1.0), (1e4, 1e-4)])
def test_sections_in_units(r, s):
    leaf = lp.Leaf(pendulum(r, s), values(0.5, r, s))
    x = leaf.project(leaf.state * (1 + 0.1 * np.random.default_rng(0).standard_normal((8, 6))))
    assert np.abs(leaf.system.functions.of(default_surface(leaf))(x)).max() > 0
    for spread in (False, True):
        x = section_starts(leaf, "m1", energy=r**2, n_starts=20, spread=spread, direction=1)
        assert np.abs(x[:, 0] / r).max() < 1e-12
        assert leaf.residual(x).max() < 1e-12
        assert np.ptp(x[:, 5] / s) > 0.5
    state = section_state(leaf, "m1", r**2, {"p3": 0.3 * s})
    assert leaf.contains(state)
    assert state[5] / s == pytest.approx(0.3, rel=1e-12)


def henon_heiles(a=1.0, b=1.0):
    """Lengths in units a, momenta in units b; the bracket {q, p} = 1 makes the energy one of a b."""
    energy = f"dot(p, p)/2/{b!r}^2 + dot(q, q)/2/{a!r}^2 + (q1^2*q2 - q2^3/3)/{a!r}^3"
    return lp.System(lp.canonical(2), f"{a!r}*{b!r}*({energy})")


CANONICAL = [(1.0, 1.0), (1e-9, 1e-9), (1e-15, 1e-15), (1e20, 1e20), (1.0, 1e-34), (1e-10, 1e-24), (1e-3, 1e7)]


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


@pytest.mark.parametrize("unit", [1e-12, 1e15])
def test_a_gyrostat_in_other_units(unit):
    """The constant part of its bracket is the length of its states."""
    base = lp.catalog.system("gyrostat")
    constant = {pair: c * Fraction(str(unit)) for pair, c in base.bracket.constant.items()}
    bracket = base.bracket.with_constant(constant)
    system = lp.System(bracket, base.hamiltonian)
    here = lp.equilibria(base, lp.Leaf.through(base, [0.3, 0.5, 0.9]), n_starts=40)
    there = lp.equilibria(system, lp.Leaf.through(system, np.array([0.3, 0.5, 0.9]) * unit), n_starts=40)
    assert len(here) == len(there)
    assert [e.energy / unit**2 for e in there] == pytest.approx([e.energy for e in here], rel=1e-9)


@pytest.mark.parametrize(("r", "s"), [(1.0, 1e-5), (1e-6, 1e-6), (1e6, 1e6), (1e-8, 1.0)])
def test_random_starts_in_any_unit(r, s):
    """A quartic H: Newton's method does not come back from guesses that are far too long in some field."""
    base = lp.catalog.system("clebsch")
    l, p = Matrix(base.variables[:3]) / exact(r), Matrix(base.variables[3:]) / exact(s)
    energy = (l[0] ** 2 / 2 + l[1] ** 2 / Rational(3, 2) + l[2] ** 2) / 2 + p[0] + 3 * p[2] ** 4 / 10 + l[0] ** 4 / 10
    system = lp.System(base.bracket, exact(r) ** 2 * energy)
    x = np.random.default_rng(3).normal(size=6) * np.repeat([r, s], 3)
    leaf = lp.Leaf.through(system, x)
    wanted = leaf.energy_range()[0] + 1.6 * r**2
    for seed in range(4):
        start = find_start(system, leaf=leaf.casimirs, energy=wanted, seed=seed)
        assert start.energy == pytest.approx(wanted, rel=1e-9)
        assert leaf.residual(start.state) < 1e-12


@pytest.mark.parametrize("size", [1e-12, 1e9, *(pytest.param(s, marks=pytest.mark.slow) for s in (1.0, 1e-3, 1e-6))])
def test_one_field_of_a_non_compact_algebra_has_a_unit(size):
    """H(y) is a fixed polynomial of x = size y: the energies of equilibria do not depend on the size."""
    g = lp.so(3, 1) @ lp.trivial()
    y = [x / exact(size) for x in g.variables]
    diagonal = sum(Rational(k + 2, 12) * x**2 + Rational(3 - k % 3, 10) * x**4 for k, x in enumerate(y))
    system = lp.System(g, diagonal + y[0] - y[3] / 2 + y[1] * y[4] / 3)
    start = np.random.default_rng(5).uniform(-1, 1, 6) * size
    found = lp.equilibria(system, lp.Leaf.through(system, start))
    assert len(found) == 2
    assert [e.energy for e in found] == pytest.approx([-0.4580833104, 1.0690820], rel=1e-6)


@pytest.mark.parametrize(
    ("u", "v"),
    [
        (2.0**30, 1.0),
        (2.0**-60, 2.0**30),
        *(pytest.param(*units, marks=pytest.mark.slow) for units in ((1.0, 1.0), (2.0**-30, 1.0), (1.0, 2.0**60))),
    ],
)
def test_energies_of_a_twisted_top_lie_between_the_same_limits_in_any_unit(u, v):
    """alpha in units 1/u and beta in units 1/v: the same top; the lowest energy is that of an equilibrium."""
    a, b = (u * x for x in (0.5, -0.2, 0.9)), (v * x for x in (0.3, 0.4, -0.2))
    top = lp.Top(inertia=("3/2", "11/10", "4/5"), a=tuple(a), b=tuple(b), epsilon=0.75 * v / u**2)
    leaf = lp.Leaf(top, {"C1": u**-2, "C2": 0.3 / (u * v), "C3": 0.9 * v**-2})
    lowest, highest = leaf.energy_range()
    assert lowest == pytest.approx(-1.77297533547723, rel=1e-12)
    assert highest == np.inf


@pytest.mark.parametrize("unit", [2.0**-30, 1.0, 2.0**50, 2.0**60])
def test_states_of_a_section_in_units_of_scalar_fields(unit):
    """Each coordinate of a canonical system is a field, and x = 0 is a value like others."""
    x, y, px, py = (z / exact(unit) for z in lp.canonical(names=("x", "y"), momenta=("px", "py")).variables)
    bracket = lp.canonical(names=("x", "y"), momenta=("px", "py"))
    energy = (px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3
    system = lp.System(bracket, exact(unit) ** 2 * energy)
    leaf = lp.Leaf.through(system, np.array([0.1, 0.2, 0.1, 0.3]) * unit)
    found = section_starts(leaf, "x", energy=0.1 * unit**2, n_starts=5, seed=1)
    assert np.abs(found[:, 0]).max() < 1e-15 * unit
    np.testing.assert_allclose(system.functions.energy(found), 0.1 * unit**2, rtol=1e-12)


@pytest.mark.parametrize(("r", "s"), [(1.0, 1.0), (1e6, 1e-6), (1e-12, 1e3), (1.0, 1e9)])
def test_lowest_energy_where_the_hamiltonian_is_no_polynomial(r, s):
    """H = |l|^2/2 + sqrt(1 + l2^2)/2 + sin(p1 + p2) + exp(-p3^2): the arguments say which units the fields have."""
    base = lp.catalog.system("clebsch")
    l, p = Matrix(base.variables[:3]) / exact(r), Matrix(base.variables[3:]) / exact(s)
    energy = l.dot(l) / 2 + sqrt(1 + l[1] ** 2) / 2 + sin(p[0] + p[1]) + exp(-(p[2] ** 2))
    leaf = lp.Leaf.through(lp.System(base.bracket, exact(r) * energy), scaled([0.3, -0.5, 0.2, 0.6, 0.5, -0.4], r, s))
    # from 300 starts of SciPy's SLSQP on the leaf l.p = -0.15, |p|^2 = 0.77
    assert leaf.energy_range()[0] == pytest.approx(0.42686404633 * r, rel=1e-9)


@pytest.mark.parametrize("k", [6, -6, *(pytest.param(k, marks=pytest.mark.slow) for k in (0, 2, 3, -3))])
def test_each_canonical_coordinate_has_a_unit_of_its_own(k):
    """q2 -> 10^k q2, p2 -> 10^-k p2 is canonical: nothing changes.  Energies from a search of its own with SciPy."""
    q1, q2, p1, p2 = lp.canonical(2).variables
    q2, p2 = q2 * Rational(10) ** k, p2 / Rational(10) ** k
    energy = p1**2 / 2 + 3 * p2**2 / 4 + q1**4 / 4 + q2**4 / 4 + q1**2 * q2**2 / 3 - q1**2 / 2 - q2**2 / 3
    system = lp.System(lp.canonical(2), energy + q1 * q2 / 5 + q1 / 10)
    leaf = lp.Leaf(system, {})
    wanted = [-0.43775, -0.25096, -0.10778, -0.05519, 0.00536]
    assert leaf.energy_range() == (pytest.approx(wanted[0], abs=1e-5), np.inf)
    assert [e.energy for e in lp.equilibria(system, leaf)] == pytest.approx(wanted, abs=1e-5)
    found = leaf.sample(20, seed=1, energy=1.0)
    np.testing.assert_allclose(system.functions.energy(found), 1.0, rtol=1e-9)


@pytest.mark.parametrize("k", [0, 3, -6])
def test_rotations_and_translations_of_one_field_have_units_of_their_own(k):
    """t -> 10^k t is an automorphism of se(3)."""
    bracket = lp.algebras.se(3) @ lp.trivial()
    x = [v * Rational(10) ** (k if i > 2 else 0) for i, v in enumerate(bracket.variables)]
    energy = x[0] ** 2 / 2 + x[1] ** 2 / 3 + x[2] ** 2 / 4 + x[3] + x[4] / 2 - x[3] * x[5] / 3 + x[4] ** 2 / 5
    state = np.array([0.4, -0.3, 0.6, 0.7, 0.2, -0.5]) / np.repeat([1.0, 10.0**k], 3)
    system = lp.System(bracket, energy)
    found = lp.equilibria(system, lp.Leaf.through(system, state))
    # from 3000 starts of SciPy's root for the equations with multipliers
    assert [e.energy for e in found] == pytest.approx([-0.988359, 1.052089], abs=1e-6)


def test_a_leaf_that_numbers_cannot_hold_is_refused():
    system = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + 2*l2^2 + 3*l3^2)/2 + (alpha1 + 3*alpha3/10)/10^15")
    with pytest.raises(lp.errors.LeafError, match="range of numbers"):
        lp.equilibria(system, lp.Leaf(system, {"C1": 1e30, "C2": 0.3e15}))
