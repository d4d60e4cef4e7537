"""Ends of trajectories, each at a time of its own: what is kept, and what does not arrive."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.orbits.shooting import Flow

HENON = lp.catalog.system("henon-heiles")
ROOT = lp.System(lp.canonical(1), "p1^2/2 - sqrt(q1)")
STARTS = {
    "polynomial": (HENON, np.random.default_rng(1).normal(size=(40, 4)) * 0.1),
    "with a root": (ROOT, np.array([[1.0, 0.1], [2.0, -0.1], [0.3, 0.0]])),
    "escaping": (HENON, np.array([[0.0, 3.0, 0.0, 3.0], [0.0, 0.1, 0.1, 0.0]])),
    "through a root": (ROOT, np.array([[1.0, -3.0], [1.0, 0.0]])),
}


@pytest.mark.parametrize(("system", "starts"), STARTS.values(), ids=STARTS)
@pytest.mark.parametrize("way", [1, -1])
def test_ends_are_those_of_integrate_bit_for_bit_whatever_was_asked_before(system, starts, way):
    n, N = starts.shape
    times, vectors = way * np.linspace(2.0, 5.0, n), np.eye(N)
    flow = Flow(system, 1)
    flow.ends(starts[::2], times[::2], vectors)
    flow.ends(starts, times)
    for _ in range(2):
        states, moved = flow.ends(starts, times, vectors)
        for k in range(n):
            run = lp.integrate(system, starts[k], times=[0, times[k]], tangents=vectors, kernel="lanes")
            np.testing.assert_array_equal(states[k], run.state[0, -1])
            np.testing.assert_array_equal(moved[k], run.tangent[0, -1].T)


def test_no_more_is_kept_than_the_last_ends():
    flow, starts = Flow(HENON, 1), np.random.default_rng(2).normal(size=(3000, 4)) * 0.01
    first, _ = flow.ends(starts, np.full(3000, 0.1))
    flow.ends(starts, np.full(3000, 0.2))
    again, _ = flow.ends(starts, np.full(3000, 0.1))
    np.testing.assert_array_equal(first, again)
    assert len(flow._known) == 3000
    none, tangents = flow.ends(np.zeros((0, 4)), np.zeros(0), np.eye(4))
    assert none.shape == (0, 4)
    assert tangents.shape == (0, 4, 4)


def test_close_encounters_do_not_end_a_long_search():
    """Of the Kepler problem with the eccentricity 0.9999, at twelve times in a unit, for 40 turns."""
    kepler = lp.System(lp.canonical(2), "(p1^2 + p2^2)/2 - 1/sqrt(q1^2 + q2^2)")
    e, end = 0.9999, 80 * np.pi
    n_times = int(12 * end)
    _, states = (
        Flow(kepler, 1).searching(n_times).survey(np.array([[1 + e, 0, 0, np.sqrt((1 - e) / (1 + e))]]), end, n_times)
    )
    np.testing.assert_allclose(states[0, -1], states[0, 0], atol=1e-6)
