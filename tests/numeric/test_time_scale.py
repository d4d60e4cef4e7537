"""The natural unit of time of an orbit, and what is taken in it."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.numeric.time_scale import natural_duration, time_scale, zero_threshold

TOP = lp.Top.twisted_kovalevskaya()


def plain_time_scale(system, x0):
    """The definition, with the exact derivative at the eight times of a stretch of 32 natural times."""
    jacobian = system.functions.jacobian(x0)
    first = np.sqrt(np.abs(jacobian * jacobian.T).sum() / 2)
    states = lp.integrate(system, x0, times=np.linspace(0, 32 / first, 8)).state[0]
    return 1 / np.median([np.abs(np.linalg.eigvals(system.functions.jacobian(state))).max() for state in states])


def test_it_is_what_its_definition_says():
    x0 = lp.sample_states(TOP, 5, seed=1)
    expected = [plain_time_scale(TOP, state) for state in x0]
    assert time_scale(TOP, x0) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("unit", [1e-12, 3.7])
def test_it_follows_the_unit_of_time(unit):
    slow = lp.Top.heavy(inertia=(2 * unit, 2 * unit, unit), a=(-1 / unit, 0, 0))
    x0 = lp.sample_states(TOP, 4, seed=1)
    assert time_scale(slow, x0) == pytest.approx(unit * time_scale(lp.Top.kovalevskaya(), x0), rel=1e-5)


@pytest.mark.parametrize("size", [1e4])
def test_it_knows_no_unit_of_the_components(size):
    """For b = 0 (s l, s^2 alpha, s^3 beta)(s t) is an orbit with (l, alpha, beta)(t)."""
    x0 = lp.sample_states(TOP, 4, seed=1)
    units = np.repeat([size, size**2, size**3], 3)
    assert time_scale(TOP, x0 * units) == pytest.approx(time_scale(TOP, x0) / size, rel=1e-5)


class Linear:
    """x' = A x."""

    name = "linear"

    def __init__(self, matrix):
        self.matrix = matrix

    def field(self):
        entries = [(i, j, float(value)) for (i, j), value in np.ndenumerate(self.matrix) if value]
        return lp.fields.QuadraticField(len(self.matrix), (), tuple(entries), ())


@pytest.mark.parametrize(
    ("matrix", "expected"),
    [
        ([[0, 3], [-3, 0]], 1 / 3),  # an oscillator
        ([[0, 1e-8], [-9e8, 0]], 1 / 3),  # the same, components in other units
        ([[0, 4], [1, 0]], 1 / 2),  # a saddle
        ([[0, 1, 0], [0, 0, 1], [1, 0, 0]], 1.0),  # no two components act on each other
        ([[0, 0], [0, 0]], np.inf),
    ],
)
def test_of_linear_fields(matrix, expected):
    scale = time_scale(Linear(np.array(matrix, float)), [1.0] * len(matrix))
    assert scale == pytest.approx([expected], rel=1e-5)


def test_nothing_has_no_natural_times():
    assert natural_duration(20, np.array([np.inf, np.nan]), otherwise=7.0) == 7.0


def test_members_are_the_same_in_any_ensemble_and_failures_are_nan():
    x0 = lp.sample_states(TOP, 40, seed=1)
    x0[3] = np.nan
    x0[4] *= 1e160
    whole = time_scale(TOP, x0)
    assert np.array_equal(whole[7:9], time_scale(TOP, x0[7:9], threads=1))
    assert np.isnan(whole[3:5]).all()
    assert np.isfinite(np.delete(whole, [3, 4])).all()


def test_thresholds_of_zeros_are_in_natural_times():
    t = np.array([0.0, 1.0, 1e3])
    assert zero_threshold(t, 1.0) == pytest.approx([np.inf, 3.0, 3 * np.log(1e3) / 1e3])
    assert 1e5 * zero_threshold(1e3, 1.0) == pytest.approx(zero_threshold(1e-2, 1e-5))
    assert np.isnan(zero_threshold(10.0, np.nan))


def test_durations_have_two_digits():
    scale = np.array([0.12345, 1.0, 7.0, np.nan])
    assert natural_duration(20, scale, otherwise=0) == 20
    assert natural_duration(20, scale, fastest=True, otherwise=0) == 2.5


@pytest.mark.parametrize("unit", [1e-20, 1e15])
def test_components_that_vanish_have_no_unit_of_their_own(unit):
    """l in units of its own is the same motion; what a component is in the first moment is no unit of it."""
    x = np.array([0.9, 0, 0.3, 0.6, 0, 0.8, 0, 0, 0])
    plain = time_scale(lp.Top.heavy(inertia=(2, 2, 1.2), a=(0, 0, -1)), x)
    top = lp.Top.heavy(inertia=(2 * unit, 2 * unit, 1.2 * unit), a=(0, 0, -unit))
    assert time_scale(top, x * np.repeat([unit, 1, 1], 3)) == pytest.approx(plain, rel=1e-5)


@pytest.mark.parametrize("unit", [1, 2.0**-20, 2.0**20])
def test_a_start_at_which_nothing_turns_tells_nothing_of_the_orbit(unit):
    quartic = lp.System(lp.canonical(names=["x"]), "c*(p_x^2/2 + x^4/4)", {"c": unit})
    scale = lp.orbits.time_scale(quartic, [[0, 1], [1e-8, 1], [2**0.25, 0]]) * unit  # one orbit, at three places
    assert scale == pytest.approx([0.8, 0.8, 0.8], rel=0.2)
