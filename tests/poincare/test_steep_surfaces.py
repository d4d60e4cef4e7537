"""Sections by functions that are steep, saturate, or leave the range of numbers: those of q = cos t, or a warning.

The oscillator H = (q^2 + p^2)/2 from q = 1 has q = cos t, which is zero at t = pi/2 + k pi: seven times up to t = 22.5,
falling first. Whatever has the sign of q has the same section.
"""

import warnings

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import SurfaceWarning

OSCILLATOR = lp.System(lp.canonical(names=["q"]), "(q^2 + p_q^2)/2")
START = [1.0, 0.0]
T_END = 22.5
ZEROS = np.pi * (0.5 + np.arange(7))

STEEP = (
    "tanh(10000*q)",
    "tanh(100000000*q)",
    "atan(1000000*q)",
    "q/sqrt(1e-12 + q^2)",
    "sin(q)/(1e-9 + q^2)",
    "1/(1 + exp(-1000*q)) - 1/2",
    "exp(1000*q) - 1",
    "log(exp(1000*q))",
    "q*exp(10000*q^2)",
)
BELOW = (
    "q*exp(-10000*q^2)",
    "q*exp(-1000*q^2)",
    "q*exp(-800*q^2)",
    "2e-300*q*exp(-100*q^2)",
    "tanh(q)*exp(-10000*q^2)",
)
"""With the sign of q where they have digits: elsewhere they are below the smallest numbers."""


def crossings(surface, start=START, t_end=T_END, **options):
    """A section whose gaps are not warned of here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SurfaceWarning)
        return lp.section(OSCILLATOR, start, surface=surface, t_end=t_end, **options)


@pytest.mark.parametrize("surface", [*STEEP, *BELOW])
def test_what_has_the_sign_of_q_has_the_section_of_q(surface):
    found = crossings(surface)
    np.testing.assert_allclose(found.time, ZEROS, atol=1e-13)
    assert found.sign.tolist() == [-1, 1, -1, 1, -1, 1, -1]
    assert len(found.touch_time) == 0
    back = crossings(surface, t_end=-T_END)
    np.testing.assert_allclose(back.time, -ZEROS, atol=1e-13)
    rising = crossings(surface, direction=1)
    np.testing.assert_allclose(rising.time, ZEROS[1::2], atol=1e-13)


@pytest.mark.parametrize("surface", [*STEEP, *BELOW])
def test_many_orbits_have_the_section_of_each(surface):
    phases = np.linspace(-1, 1, 7)  # q = cos(t + phase)
    found = crossings(surface, np.stack([np.cos(phases), -np.sin(phases)], axis=1), t_end=10)
    for k, phase in enumerate(phases):
        zeros = np.pi * (np.arange(-2, 8) + 0.5) - phase
        wanted = zeros[(zeros > 0) & (zeros < 10)]
        np.testing.assert_allclose(found.time[found.trajectory == k], wanted, atol=1e-13)


@pytest.mark.parametrize("surface", ["tanh(10000*q)", "q*exp(-10000*q^2)"])
def test_steep_sections_go_on_and_return(surface):
    first = crossings(surface, n_crossings=3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SurfaceWarning)
        more = first.go_on(n_crossings=None, t_end=T_END - first.end_time[0])
        image = lp.sections.first_return(OSCILLATOR, [0.0, 1.0], surface=surface, t_end=20)
    np.testing.assert_allclose([*first.time, *(more.time + first.end_time[0])], ZEROS, atol=1e-13)
    # from q = sin t, which rises at 0 and at 2 pi
    assert image.outcome == "returned"
    assert float(image.time) == pytest.approx(2 * np.pi, abs=1e-13)


@pytest.mark.parametrize("surface", STEEP[:5])
def test_a_steep_surface_is_followed_all_the_time(surface):
    found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    assert found.unresolved_time[0] == 0
    assert found.seen_to[0] == T_END


def test_a_time_without_digits_is_not_seen():
    """q exp(-10^4 q^2) is below 5e-324 where |q| > 0.2727: for 1 - 2 asin(0.2727)/pi = 0.824 of the time."""
    with pytest.warns(SurfaceWarning, match="could not be followed in 8.% of the time.*beyond the range of numbers"):
        found = lp.section(OSCILLATOR, START, surface="q*exp(-10000*q^2)", t_end=20 * np.pi)
    assert found.unresolved_share == pytest.approx(0.824, abs=0.01)
    assert len(found.time) == 20


@pytest.mark.parametrize("surface", ["exp(-10000*q^2)", "tanh(q)^2*exp(-10000*(q - 1/2)^2)"])
def test_a_function_without_zeros_that_underflows_crosses_nowhere(surface):
    found = crossings(surface)
    assert found.unresolved_share > 0.5
    assert len(found.time) == 0


@pytest.mark.parametrize("k", [750, 1000])
def test_the_inverse_of_what_is_beyond_the_range_is_followed_where_it_is_not(k):
    """1/cosh(k q) = 1/2 where |q| = arcosh(2)/k; cosh(k q) is beyond the largest number where |q| > 710/k."""
    found = crossings(f"1/cosh({k}*q) - 1/2")
    assert len(found.time) == 14
    np.testing.assert_allclose(np.abs(found.state[:, 0]), np.arccosh(2) / k, atol=1e-14)


@pytest.mark.parametrize("surface", ["1/(1 + exp(-100000*q)) - 1/2", "1/cosh(2000*q) - 1/2"])
def test_where_an_inverse_falls_too_fast_it_is_told_and_nothing_false_is_found(surface):
    """They fall by 10^308 within a fraction of a step, which takes more parts than are made."""
    with pytest.warns(SurfaceWarning, match="could not be followed"):
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    assert (np.abs(found.state[:, 0]) < 1e-3).all()
    assert found.seen_to[0] < ZEROS[1]


def test_a_narrow_interval_on_which_a_function_is_a_number_is_found():
    """exp(10^7 q^2) is below the largest number where |q| < 0.0084, a hundredth of a step."""
    with pytest.warns(SurfaceWarning, match="could not be followed in 99"):
        found = lp.section(OSCILLATOR, START, surface="q*exp(10000000*q^2)", t_end=T_END)
    np.testing.assert_allclose(found.time, ZEROS, atol=1e-13)
    assert found.unresolved_share > 0.99


@pytest.mark.parametrize("surface", ["tanh(1e15*q)", "q*exp(-100000*(q^2 - 1/4)^2)", "q^41", "q*exp(-1/q^2)"])
def test_a_change_of_sign_that_is_not_seen_is_told(surface):
    """Steeper than round-off of q allows, below the smallest numbers, or flat beyond all digits at q = 0."""
    with pytest.warns(SurfaceWarning, match="its sign changes 7 times meanwhile"):
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    assert len(found.time) == 0
    assert 0 < found.seen_to[0] < ZEROS[0] or found.seen_to[0] == 0
    with pytest.warns(SurfaceWarning, match="its sign changes 4 times meanwhile"):
        lp.section(OSCILLATOR, START, surface=surface, t_end=T_END, direction=-1)


@pytest.mark.parametrize("surface", ["1/q", "1/q^3", "tan(3*q + 1/10)", "sin(q + 1)/q"])
def test_a_pole_is_no_crossing_and_not_warned_of(surface):
    with warnings.catch_warnings():
        warnings.simplefilter("error", SurfaceWarning)
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    # tan(3 q + 1/10) is zero at q = -1/30
    assert len(found.time) == (7 if "tan" in surface else 0)
    assert (np.abs(found.state[:, 0] + 1 / 30) < 1e-13).all()
    assert found.unresolved_time[0] > 0


@pytest.mark.parametrize(
    "t_end",
    [
        1e4,
        pytest.param(1.5e5, marks=pytest.mark.thorough),
        *(pytest.param(t, marks=pytest.mark.slow) for t in (2e5, 4e5)),
    ],
)
def test_an_oscillating_surface_on_a_long_step_is_followed(t_end):
    """theta = 0.1 + t exactly, in one step: sin(theta) has floor((0.1 + t_end)/pi) zeros."""
    rotor = lp.System(lp.canonical(names=("theta",)), "p_theta^2/2")
    found = lp.section(rotor, [0.1, 1.0], surface="sin(theta)", t_end=t_end)
    assert len(found.time) == np.floor((0.1 + t_end) / np.pi)
    assert len(found.touch_time) == 0


def test_a_small_fast_wave_on_a_surface_is_not_passed_over():
    """s = q - 1/2 + sin(1e5 (q - 1/2))/1000 with q = t goes from -1/2 to 3/2, and has 65 zeros near 1/2."""
    flow = lp.System(lp.canonical(1), "p1")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = lp.section(flow, [0.0, 1.0], surface="q1 - 1/2 + sin(100000*(q1 - 1/2))/1000", t_end=2)
    assert len(found.time) == 65 or any(issubclass(one.category, SurfaceWarning) for one in told)
    assert len(found.time) == 65 or float(np.sum(found.unresolved_time)) > 1e-3


def test_an_orbit_that_the_time_limit_stops_in_its_first_step_does_not_lie_in_the_surface():
    """q = cos t crosses sin(1e5 q) = 0 some 60,000 times in a turn."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = lp.section(OSCILLATOR, np.tile(START, (40, 1)), surface="sin(100000*q)", t_end=200, time_limit=0.2)
    assert "time limit" in found.outcome
    assert not any("lie in the surface" in str(one.message) for one in told)


@pytest.mark.parametrize("surface", ["(q - 1/2)*cosh(1800*q)", "exp(2000*q) - exp(2000*p_q)"])
def test_beyond_the_largest_number_a_function_is_not_said_to_have_no_value(surface):
    """Both exist everywhere; exp(710) is no double."""
    with pytest.warns(SurfaceWarning, match="could not be followed"):
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    assert found.undefined_time.sum() == 0
    assert found.unresolved_time.sum() > 0.1 * T_END


def test_no_time_is_less_than_none():
    """q^3 is 1e450 there."""
    with pytest.warns(SurfaceWarning, match="could not be followed in 100%"):
        found = lp.section(OSCILLATOR, [1e150, 0.3e150], surface="q^3 + p_q*q^2", t_end=20)
    assert (found.unresolved_time >= 0).all()
