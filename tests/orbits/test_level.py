"""Levels of H and the Casimirs."""

from fractions import Fraction

import numpy as np

import liepoisson as lp
from liepoisson.orbits.level import level_of

TOP = lp.Top.kovalevskaya(epsilon=1)
CASIMIRS = {"C1": 1, "C2": "1/3", "C3": 1}


def test_values_are_exact():
    level = level_of(TOP, CASIMIRS, "1/2")
    assert level.values == {"H": Fraction(1, 2), "C1": 1, "C2": Fraction(1, 3), "C3": 1}
    assert level.text == "H = 1/2, C1 = 1, C2 = 1/3, C3 = 1"
    assert level.dimension == 5
    assert level_of(TOP, {**CASIMIRS, "C2": 0.1}, 0.5).values["C2"] == Fraction(0.1)


def test_states_are_moved_onto_it():
    level = level_of(TOP, CASIMIRS, "1/2")
    states, arrived = level.projected(np.random.default_rng(0).standard_normal((50, 9)), np.eye(9))
    assert arrived.mean() > 0.9
    good = states[arrived]
    assert np.abs(level.deviations(good)).max() < 1e-12
    np.testing.assert_allclose(TOP.invariant_values(good)["C2"], 1 / 3, atol=1e-13)
    assert level.is_regular_at(good).all()


def test_it_is_not_regular_at_an_equilibrium():
    """(2.8, 0, 0), (-2, 0, 0), (1, 0, 0): all fields along the axis of a symmetric top that is turned by nothing."""
    level = level_of(TOP, {"C1": "9.6", "C2": -2, "C3": 1}, "3.96")
    state = np.array([2.8, 0, 0, -2, 0, 0, 1, 0, 0])
    assert level.distance(state) < 1e-15
    assert not level.is_regular_at(state)
