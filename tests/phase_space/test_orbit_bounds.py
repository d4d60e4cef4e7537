"""Bounds of a top: no orbit exceeds them, and they are attained where they can be."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import InertiaWarning, LeafError, ParameterError

TWISTED = lp.Top.twisted_kovalevskaya()


def lengths(top, states):
    l, alpha, beta = np.moveaxis(states.reshape(-1, 3, 3), 1, 0)
    omega = l / np.array([float(moment) for moment in top.inertia])
    return np.array([np.linalg.norm(v, axis=-1).max() for v in (l, alpha, beta, omega)])


@pytest.mark.thorough
@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from([0, 1, -1, "1/3", -2]), st.booleans(), st.booleans())
def test_no_orbit_exceeds_its_bounds(seed, epsilon, has_beta, has_a):
    """Orbits to t = 50; the ratio to the bounds is 0.88 in the median of such tops, the smallest one 0.37."""
    rng = np.random.default_rng(seed)
    vectors = {"a": rng.normal(size=3) * has_a, "b": rng.normal(size=3)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InertiaWarning)
        top = lp.Top(
            inertia=[float(v) for v in rng.uniform(0.5, 2, 3)],
            epsilon=epsilon,
            **{name: [float(v) for v in vector] for name, vector in vectors.items()},
        )
    x = rng.standard_normal(9)
    x[6:] *= has_beta
    limits = lp.phase_space.bounds(top, x)
    reached = lengths(top, lp.integrate(top, x, times=np.linspace(0, 50, 501)).state)
    # The orbit's own error, below 1e-12 at t = 50, is allowed for.
    assert np.all(reached <= np.array([limits.l, limits.alpha, limits.beta, limits.omega]) * (1 + 1e-11)), (
        reached,
        limits,
    )


def test_bounds_by_values_and_by_state_agree():
    top = lp.Top.twisted_kovalevskaya()
    x = lp.sample_states(top, 1, seed=3)[0]
    energy = float(top.functions.energy(x))
    by_state, by_values = (
        lp.phase_space.bounds(top, x),
        lp.phase_space.bounds(top, leaf=lp.Leaf.through(top, x).casimirs, energy=energy),
    )
    for name in ("l", "alpha", "beta", "omega"):
        assert getattr(by_state, name) == pytest.approx(getattr(by_values, name), rel=1e-10)


def test_bounds_by_leaf_and_by_state_agree_also_on_leaves_with_other_casimirs():
    x = lp.sample_states(TWISTED, 1, seed=3)[0]
    below = np.array([0.3, -0.5, 0.4, 0.6, 0.2, -0.3, 0, 0, 0])
    for top, state in ((TWISTED, x), (TWISTED, below), (lp.Top.heavy((1.5, 1.2, 0.7), (0.6, 0, 0.8)), below)):
        by_state = lp.phase_space.bounds(top, state)
        by_leaf = lp.phase_space.bounds(
            top, leaf=lp.Leaf.through(top, state), energy=float(top.functions.energy(state))
        )
        for name in ("l", "alpha", "beta", "omega"):
            assert getattr(by_leaf, name) == pytest.approx(getattr(by_state, name), rel=1e-10)


def test_a_leaf_of_another_bracket_or_no_leaf_is_refused():
    leaf = lp.Leaf.through(TWISTED, np.ones(9))
    with pytest.raises(ParameterError, match="epsilon = 0; got <Leaf"):
        lp.phase_space.bounds(lp.Top.kovalevskaya(), leaf=leaf, energy=1)
    with pytest.raises(ParameterError, match="wanted a leaf of a top"):
        lp.phase_space.bounds(TWISTED, leaf=lp.Leaf.through(lp.catalog.system("manakov-so4"), np.ones(6)), energy=1)
    with pytest.raises(ParameterError, match="wanted a Leaf"):
        lp.phase_space.bounds(TWISTED, leaf=3, energy=1)
    with pytest.raises(ParameterError, match="both leaf= and energy="):
        lp.phase_space.bounds(TWISTED, leaf=leaf)
    with pytest.raises(ParameterError, match="not both"):
        lp.phase_space.bounds(TWISTED, np.ones(9), leaf=leaf)


def test_casimirs_of_a_leaf_of_lower_rank_are_refused_with_a_way_out():
    leaf = lp.Leaf.through(TWISTED, [0.3, 0.2, 0.1, 1, 0, 0, 0, 0, 0])
    with pytest.raises(ParameterError, match=r"give Leaf\.through\(top, state\)"):
        lp.phase_space.bounds(TWISTED, leaf=leaf.casimirs, energy=0.5)


def test_bounds_of_free_and_hanging_tops_are_attained():
    """a = b = 0 about the axis of the largest moment: |l| = sqrt(2 Imax E). Heavy top: |alpha| is constant."""
    free = lp.Top.free_rigid_body((2, 1.5, 1))
    assert lp.phase_space.bounds(free, [3, 0, 0, 0, 0, 0, 0, 0, 0]).l == pytest.approx(3, rel=1e-11)
    heavy = lp.Top.heavy((2, 1.5, 1), (0, 0, 1))
    limits = lp.phase_space.bounds(heavy, [0, 0, 0, 0, 0, 2, 0, 0, 0])
    # From upright at rest, H = 2, to hanging: |l|^2/(2 Imax) = H + |a||alpha| = 4.
    assert (limits.l, limits.alpha, limits.beta) == pytest.approx((4, 2, 0), rel=1e-10)


def test_negative_first_casimir_needs_momentum():
    r"""C1 < 0: |l| >= -C1/(2 |epsilon| w), so the energy is at least C1^2/(8 epsilon^2 w^2 Imax) - |b| w - |a| rho."""
    top = lp.Top(inertia=(2, 2, 1), b=(0, 0, 1), epsilon=1)
    values = {"C1": -4, "C2": 0, "C3": 1}
    assert lp.phase_space.bounds(top, leaf=values, energy=0.0).l == pytest.approx(2, rel=1e-10)  # 16/16 - 1 = 0
    with pytest.raises(LeafError, match="no state"):
        lp.phase_space.bounds(top, leaf=values, energy=-0.01)


def test_bad_requests_are_refused():
    top = lp.Top.twisted_kovalevskaya()
    with pytest.raises(LeafError, match="no solution"):
        lp.phase_space.bounds(top, leaf={"C1": 1, "C2": 0, "C3": 1}, energy=-50)
    with pytest.raises(LeafError, match="C3"):
        lp.phase_space.bounds(top, leaf={"C1": 1, "C2": 0, "C3": -1}, energy=0)
    with pytest.raises(LeafError, match="C2"):
        lp.phase_space.bounds(lp.Top.kovalevskaya(), leaf={"C1": 1, "C2": 2, "C3": 1}, energy=0)
    with pytest.raises(ParameterError, match="not both"):
        lp.phase_space.bounds(top, np.ones(9), energy=1)
    with pytest.raises(ParameterError, match="both leaf= and energy="):
        lp.phase_space.bounds(top, energy=1)
    with pytest.raises(ParameterError, match="known for tops"):
        lp.phase_space.bounds(lp.catalog.system("manakov-so4"), np.ones(6))


@pytest.mark.parametrize("size", [1e151, 1e200, 1e308])
def test_states_whose_squares_are_no_doubles_are_refused(size):
    top = lp.Top.twisted_kovalevskaya()
    for k in (0, 3, 6):
        with pytest.raises(ParameterError, match="units"):
            lp.phase_space.bounds(top, size * np.eye(9)[k])
    with pytest.raises(ParameterError, match="overflow"):  # 2 epsilon w |l| = 4e308
        lp.phase_space.bounds(top, leaf={"C1": 1, "C2": size, "C3": 1e308}, energy=1e308)
    with pytest.raises(LeafError, match="C2"):
        lp.phase_space.bounds(lp.Top.heavy((2, 1.5, 1), (0, 0, 1)), leaf={"C1": 1, "C2": size, "C3": 1}, energy=1)


def test_states_whose_squares_underflow_are_refused():
    for k in (0, 3, 6):
        with pytest.raises(ParameterError, match="lengths from 1e-140 to 1e"):
            lp.phase_space.bounds(lp.Top.twisted_kovalevskaya(), 1e-150 * np.eye(9)[k])


def test_bounds_of_large_states_are_those_of_small_ones_in_other_units():
    """l by s, alpha, beta and H by s^2, epsilon by s: all bounds scale."""
    x = lp.sample_states(lp.Top.twisted_kovalevskaya(), 1, seed=3)[0]
    scale = np.repeat([1e70, 1e140, 1e140], 3)
    small = lp.phase_space.bounds(lp.Top.twisted_kovalevskaya(), x)
    large = lp.phase_space.bounds(lp.Top.twisted_kovalevskaya(10**70), scale * x)
    wanted = (1e70 * small.l, 1e140 * small.alpha, 1e140 * small.beta, 1e70 * small.omega)
    assert (large.l, large.alpha, large.beta, large.omega) == pytest.approx(wanted, rel=1e-10)


@pytest.mark.thorough
def test_every_state_has_bounds_that_contain_it():
    """1000 states of 40 tops; in the first one the excess is positive at 0, negative from 0.6 to 1, and positive."""
    cases = [(lp.Top(inertia=(1, 1, 1), a=(1, 0, 0), epsilon=1), np.array([0, 0, -1, -(2**0.5), 0, 0, 0, 0, 1]))]
    rng = np.random.default_rng(5)
    for epsilon in rng.choice(3, 40).tolist():
        inertia, (a, b) = rng.choice([0.75, 1, 1.5], 3).tolist(), rng.choice([-1, 0, 0.5, 1], (2, 3)).tolist()
        top = lp.Top(inertia=inertia, a=a, b=b, epsilon=epsilon)
        sizes = rng.choice([1e-100, 1e-3, 1, 1, 1, 1e3], (25, 1))
        cases += [(top, x) for x in rng.choice([-2, -1, 0, 0.5, 1], (25, 9)) * sizes]
    for top, x in cases:
        limits = lp.phase_space.bounds(top, x)
        own = [math.hypot(*v) for v in (*x.reshape(3, 3), x[:3] / [float(moment) for moment in top.inertia])]
        assert np.all(np.array([limits.l, limits.alpha, limits.beta, limits.omega]) >= own), (top, x, limits)


@pytest.mark.parametrize("bad", [None, 3, "kovalevskaya", lp.Top, lp.Top(inertia=("I", 1, 1))])
def test_what_is_no_system_with_numbers_is_refused(bad):
    for call in (
        lambda: lp.phase_space.bounds(bad, np.ones(9)),
        lambda: lp.Leaf.through(bad, np.ones(9)),
        lambda: lp.Leaf(bad, {}),
    ):
        with pytest.raises(ParameterError, match=r"wanted a system|I has none"):
            call()


@pytest.mark.parametrize("bad", ["a", 1j, None, [1, 2], np.nan])
def test_values_that_are_no_finite_numbers_are_refused(bad):
    top, values = lp.Top.twisted_kovalevskaya(), {"C1": 1, "C2": 0, "C3": 1}
    for call in (
        lambda: lp.phase_space.bounds(top, leaf=values | {"C1": bad}, energy=1),
        lambda: lp.phase_space.bounds(top, leaf=bad, energy=1),
        lambda: lp.phase_space.bounds(top, leaf=values, energy=bad),
        lambda: lp.Leaf(top, values | {"C2": bad}),
        lambda: lp.Leaf(top, bad),
    ):
        with pytest.raises(ParameterError):
            call()
