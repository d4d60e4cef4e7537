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
    "atan(1000000*q)",
    "q*exp(10000*q^2)",
)
BELOW = (
    "q*exp(-10000*q^2)",
    "2e-300*q*exp(-100*q^2)",
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


def test_a_time_without_digits_is_not_seen():
    """q exp(-10^4 q^2) is below 5e-324 where |q| > 0.2727: for 1 - 2 asin(0.2727)/pi = 0.824 of the time."""
    with pytest.warns(SurfaceWarning, match="could not be followed in 8.% of the time.*beyond the range of numbers"):
        found = lp.section(OSCILLATOR, START, surface="q*exp(-10000*q^2)", t_end=20 * np.pi)
    assert found.unresolved_share == pytest.approx(0.824, abs=0.01)
    assert len(found.time) == 20


@pytest.mark.parametrize("surface", ["tanh(1e15*q)", "q^41"])
def test_a_change_of_sign_that_is_not_seen_is_told(surface):
    """Steeper than round-off of q allows, below the smallest numbers, or flat beyond all digits at q = 0."""
    with pytest.warns(SurfaceWarning, match="its sign changes 7 times meanwhile"):
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    assert len(found.time) == 0
    assert 0 < found.seen_to[0] < ZEROS[0] or found.seen_to[0] == 0
    with pytest.warns(SurfaceWarning, match="its sign changes 4 times meanwhile"):
        lp.section(OSCILLATOR, START, surface=surface, t_end=T_END, direction=-1)


@pytest.mark.parametrize("surface", ["1/q", "tan(3*q + 1/10)"])
def test_a_pole_is_no_crossing_and_not_warned_of(surface):
    with warnings.catch_warnings():
        warnings.simplefilter("error", SurfaceWarning)
        found = lp.section(OSCILLATOR, START, surface=surface, t_end=T_END)
    # tan(3 q + 1/10) is zero at q = -1/30
    assert len(found.time) == (7 if "tan" in surface else 0)
    assert (np.abs(found.state[:, 0] + 1 / 30) < 1e-13).all()
    assert found.unresolved_time[0] > 0


@pytest.mark.parametrize("t_end", [1e4, pytest.param(4e5, marks=pytest.mark.slow)])
def test_an_oscillating_surface_on_a_long_step_is_followed(t_end):
    """theta = 0.1 + t exactly, in one step: sin(theta) has floor((0.1 + t_end)/pi) zeros."""
    rotor = lp.System(lp.canonical(names=("theta",)), "p_theta^2/2")
    found = lp.section(rotor, [0.1, 1.0], surface="sin(theta)", t_end=t_end)
    assert len(found.time) == np.floor((0.1 + t_end) / np.pi)
    assert len(found.touch_time) == 0
