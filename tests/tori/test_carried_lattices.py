"""Monodromy of known systems, and what does not change it."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import OrbitError, ParameterError, ShapeError, TimeLimitError

PENDULUM = lp.catalog.system("spherical-pendulum")
START = [0, 1.3, 0, 0.8, 0, 0.6]
UNIT = np.eye(2, dtype=int)


def circle(center, radius, n, turned=0.0):
    angle = turned + np.linspace(0, 2 * np.pi, n + 1)
    return np.stack([center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)], axis=1)


@pytest.mark.parametrize(("radius", "n", "turned"), [(0.5, 24, 0.0), (0.5, 7, 0.3), (0.3, 12, 2.0)])
def test_the_spherical_pendulum_turns_one_period_into_the_sum_of_two(radius, n, turned):
    """[[1, 1], [0, 1]] up to a change of basis, whatever the loop: M - 1 is primitive, and M fixes l3's circle."""
    found = lp.tori.monodromy(PENDULUM, START, circle((1, 0), radius, n, turned))
    assert round(np.linalg.det(found.matrix)) == 1
    rest = found.matrix - UNIT
    assert found.is_unipotent
    assert found.trace == 2
    assert np.gcd.reduce(rest.ravel()) == 1
    spin = np.linalg.solve(found.periods.T, [0, 2 * np.pi])
    np.testing.assert_allclose(spin @ found.matrix, spin, atol=1e-9)


@pytest.mark.parametrize("center", [(0.3, 0.3), (2.0, 0.3)])
def test_around_nothing_there_is_none(center):
    assert lp.tori.monodromy(PENDULUM, START, circle(center, 0.15, 5)).is_trivial


def test_closed_flows_are_in_the_order_of_their_guesses():
    """The guess that is the nearer one arrives first."""
    from liepoisson.tori.period_lattices import Closures

    torus = lp.tori.period_lattice(PENDULUM, START)
    flows = Closures.at(torus.momentum, torus.state, lp.Leaf.through(PENDULUM, torus.state).in_units().units)
    for basis in (torus.periods, torus.periods[::-1]):
        guesses = basis + np.array([[0.05, 0.05], [0.0, 0.0]])
        np.testing.assert_allclose(flows.closed(guesses), basis, atol=1e-10)


def test_a_loop_through_a_critical_value_is_refused():
    with pytest.raises(OrbitError, match="cannot be carried beyond"):
        lp.tori.monodromy(PENDULUM, START, [[0, 0.2], [0, -0.2], [-2, 0]])


@pytest.mark.parametrize(
    ("loop", "error"),
    [
        ([0.1, 0.2], ShapeError),
        ([[0.1, 0.2], [0.2, 0.2]], ShapeError),
        (np.ones((4, 3)), ShapeError),
        ([[0.1, 0.2]] * 4, ParameterError),
        ([[0.1, 0.2], [0.2, 0.2], [np.nan, 0.1]], ParameterError),
        ([[-3, 0.2], [-3, 0.1], [-3.5, 0.1]], OrbitError),
    ],
)
def test_what_is_no_loop_is_refused(loop, error):
    with pytest.raises(error, match="loop: "):
        lp.tori.monodromy(PENDULUM, START, loop)


def test_time_may_be_over():
    with pytest.raises(TimeLimitError):
        lp.tori.monodromy(PENDULUM, START, circle((1, 0), 0.5, 24), time_limit=1e-3)


def test_labels_decide_the_order_of_values():
    pd = pytest.importorskip("pandas")
    loop = circle((2.0, 0.3), 0.15, 3)
    given = pd.DataFrame(loop[:, ::-1], columns=["l3", "H"])
    np.testing.assert_array_equal(lp.tori.monodromy(PENDULUM, START, given).loop[: len(loop)], loop)
