"""Unstable and stable manifolds, and the error of their starts."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.orbits import invariant_manifold
from liepoisson.orbits.shooting import Flow
from liepoisson.orbits.unstable_spaces import unstable_space

equilibrium = lp.phase_space.equilibrium
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)", name="pendulum")
SADDLE = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10", name="saddle")
CENTRE = lp.System(lp.canonical(2), "(p1^2 - q1^2 + p2^2 + q2^2)/2 + q1^2*q2/2", name="saddle and centre")
FOCUS = lp.System(lp.canonical(2), "p1*q2 + p2^2/2 + q2^2/4 - q1^2/2 + q1^3/3 + q2^3/5", name="saddle-focus")
HENON = lp.catalog.system("henon-heiles")


def loop():
    """A periodic orbit without symmetry, of multiplier 536."""
    return lp.orbits.periodic_orbit(SADDLE, [3.1, 0, 0, 0.4], period=6.3, energy="1.1")


@pytest.fixture(scope="module")
def straight():
    """That of Henon and Heiles, which closes after two loops."""
    return lp.orbits.symmetric_periodic_orbits(HENON, {}, energy="1/8", n_starts=20)[0]


BASES = {
    "pendulum off the origin": lambda: equilibrium(PENDULUM, [-np.pi, 0]),
    "saddle and centre": lambda: equilibrium(CENTRE, [0] * 4),
    "saddle-focus": lambda: equilibrium(FOCUS, [0] * 4),
    "an energy that is no double": lambda: equilibrium(HENON, [0, 1, 0, 0]),
    "a top": lambda: equilibrium(lp.catalog.system("lagrange"), [0, 0, 1, 0, 0, 1]),
    "loop": loop,
}


@pytest.mark.parametrize("kind", ["unstable", "stable"])
@pytest.mark.parametrize("name", BASES)
def test_starts_are_on_the_level_and_leave_it_in_their_direction(name, kind):
    manifold = invariant_manifold(BASES[name](), kind)
    level = manifold.space.level
    assert np.abs(level.deviations(manifold.starts(20))).max() < 1e-15
    one = manifold.followed(6, 3 / manifold.space.rate, n_times=4)
    assert one.time[-1] * manifold.space.direction > 0
    first, last = manifold.space.state, one.state[:, -1] - one.state[:, 0]
    if manifold.space.loop_time == 0:
        assert (np.abs(one.state[:, 0] - first).max(axis=1) < 2 * manifold.amplitude * level.units.max()).all()
        assert (np.linalg.norm(last / level.units, axis=1) > 5 * manifold.amplitude).all()


def test_the_unstable_manifold_of_the_pendulum_is_its_separatrix():
    """p = 2 cos(q/2) on one side, p < 0 on the other: q = 4 arctan(e^t) - pi."""
    orbit = invariant_manifold(equilibrium(PENDULUM, [-np.pi, 0])).followed(2, 15.0)
    q, p = orbit.state[..., 0], orbit.state[..., 1]
    assert np.abs(np.abs(p) - 2 * np.abs(np.cos(q / 2))).max() < 1e-13  # measured 3e-15
    assert (p[0] * p[1] < 0).all()
    middle = np.interp(0, q[p[:, 5] > 0][0], orbit.time)
    np.testing.assert_allclose(q[p[:, 5] > 0][0], 4 * np.arctan(np.exp(orbit.time - middle)) - np.pi, atol=1e-5)


def test_a_section_is_where_the_manifold_crosses_the_surface():
    manifold = invariant_manifold(equilibrium(PENDULUM, [-np.pi, 0]), "stable")
    found = manifold.section("q1", n_starts=2, t_end=20)
    assert (found.time < 0).all()
    np.testing.assert_allclose(found.state, [[0, -2]], atol=1e-12)


@pytest.mark.parametrize("amplitude", [2e-3, 1e-3])
def test_the_error_at_the_start_is_quadratic_and_cubic_where_it_was_followed(straight, amplitude):
    """Measured: 1.4e-6, 3.5e-7 at 1e-3, 5e-4, and 1.1e-8, 1.4e-9 where the amplitude has become 1."""
    one, half = (invariant_manifold(straight, amplitude=d) for d in (amplitude, amplitude / 2))
    assert np.log2(one.error / half.error) == pytest.approx(2, abs=0.02)
    late = [manifold.errors(8, np.log(1 / manifold.amplitude) / manifold.space.rate).max() for manifold in (one, half)]
    assert np.log2(late[0] / late[1]) == pytest.approx(3, abs=0.2)


def test_the_law_of_the_amplitude(straight):
    """(eps / c)^(1/4), so that both errors are alike where the amplitude has become 1: measured 1.2e-11."""
    manifold = invariant_manifold(straight)
    bend = manifold.error / manifold.amplitude**2
    assert bend > 1
    assert manifold.amplitude == pytest.approx((np.finfo(float).eps / bend) ** 0.25, rel=1e-2)
    assert manifold.errors(8, np.log(1 / manifold.amplitude) / manifold.space.rate).max() < 1e-10


def test_beside_a_centre_the_error_does_not_shrink():
    r"""The manifold is $q_2 = -q_1^2/10 + \dots$, so a linear start is off by $cd^2$, which oscillates."""
    saddle = equilibrium(CENTRE, [0] * 4)
    one, half = (invariant_manifold(saddle, amplitude=d) for d in (2e-3, 1e-3))
    assert np.log2(one.error / half.error) == pytest.approx(2, abs=0.01)
    late = one.errors(2, np.log(1e2) / one.space.rate)
    assert (late > one.error / 2).all()
    manifold = invariant_manifold(saddle)
    assert manifold.amplitude == pytest.approx(np.finfo(float).eps ** (1 / 3), rel=1e-9)
    state = manifold.followed(2, 10.0).state  # measured: q2 = -0.1000 q1^2 where q1 = 1e-2
    near = np.abs(np.abs(state[..., 0]) - 1e-2) < 1e-4
    np.testing.assert_allclose(state[near][:, 1], -0.1 * state[near][:, 0] ** 2, rtol=5e-3)


def test_phases_are_along_the_orbit(straight):
    """Starts at a phase are near the orbit at that part of its period, on both manifolds."""
    for base in (straight, loop()):
        path = base.states(9)
        for kind in ("unstable", "stable"):
            manifold = invariant_manifold(base, kind)
            phases = np.arange(8) / 8
            starts = manifold.at(np.ones((8, 1)), phases)
            gaps = np.linalg.norm((starts - path[:-1]) / manifold.space.level.units, axis=1)
            np.testing.assert_allclose(gaps, manifold.amplitude, rtol=1e-3)
            assert np.abs(manifold.at([[1.0]], 1.0) - starts[0]).max() < 1e-12


def test_the_spaces_are_invariant(straight):
    """The derivative of the flow takes the basis at one phase into that at another."""
    for base in (straight, loop()):
        for direction in (1, -1):
            space = unstable_space(base, direction=direction, wholly=False)
            flow = Flow(base.system, 1)
            times = np.array([0.3, 0.9]) * space.period
            points, bases = space.frames(flow, times)
            ends, moved = flow.ends(points[:1], np.array([direction * (times[1] - times[0])]), bases[:1])
            assert np.abs(ends[0] - points[1]).max() < 1e-10
            rate = base.system.vector_field(points[1])
            both = np.stack([bases[1, :, 0], rate], axis=1) / space.level.units[:, None]
            wanted = moved[0, :, 0] / space.level.units
            rest = wanted - both @ np.linalg.lstsq(both, wanted, rcond=None)[0]
            assert np.linalg.norm(rest) < 1e-9 * np.linalg.norm(wanted)


def test_a_sphere_of_directions():
    top = lp.Top.kovalevskaya(epsilon=1)
    leaf, state = lp.Leaf(top, {"C1": "9.6", "C2": -2, "C3": 1}), np.array([2.8, 0, 0, -2, 0, 0, 1, 0, 0])
    manifold = invariant_manifold(equilibrium(top, state))
    assert manifold.base.leaf.casimirs == pytest.approx(leaf.casimirs)
    assert (manifold.dimension, manifold.n_directions) == (3, 3)
    assert not np.array_equal(manifold.starts(4), manifold.starts(4, seed=1))
    assert manifold.space.level.distance(manifold.starts(50)).max() < 1e-13


def heavy_top(still=""):
    return lp.System(
        lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/3 + l3^2 + alpha3 + alpha1/4" + still, name="heavy top"
    )


STILL = "+ 1000000000/3 + 3*dot(l, alpha)^2 + 1e5*dot(alpha, alpha)"


def test_what_does_not_move_changes_no_manifold_of_an_equilibrium():
    """The energy of the equilibrium, as a double, has lost seven digits."""
    ordinary = lp.equilibria(heavy_top(), {"C1": "3/10", "C2": 1})[-1]
    one, other = (invariant_manifold(equilibrium(heavy_top(still), ordinary.state)) for still in ("", STILL))
    assert other.error == pytest.approx(one.error, rel=1e-2)
    np.testing.assert_allclose(other.starts(8), one.starts(8), atol=1e-14)


@pytest.mark.parametrize("along", ["energy", "C1"])
def test_what_does_not_move_changes_no_level_of_a_family(along):
    """Each orbit of a family is on its level to the round-off of what moves, and so are manifolds of it."""
    start = lp.orbits.periodic_orbit(heavy_top(), [-1.178, -0.27, -0.411, -0.527, 0.814, 0.244], period=3.63)
    still = lp.orbits.periodic_orbit(heavy_top(STILL), start.start, period=start.period)
    family = lp.orbits.orbit_family(heavy_top(STILL), still, along=along, max_orbits=4)
    for one in family:
        assert np.abs(one.level.deviations(one.start)).max() < 1e-14
