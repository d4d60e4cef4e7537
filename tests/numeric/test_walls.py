"""Walls that a power series does not show where a step begins: the trajectory bounces, as energy demands."""

import numpy as np
import pytest

import liepoisson as lp

WALLS = {
    # potential: start, end time
    "q^26": ([0.0, 1.0], 10.0),
    "q^64": ([0.001, 1.0], 10.0),
    "exp(-q)": ([150.0, -1.0], 400.0),
    "exp(-1/q^2)": ([1.1, 0.0], 10.0),
}


@pytest.mark.parametrize("potential", WALLS)
@pytest.mark.parametrize("tol", [1e-15, 1e-6])
def test_no_step_passes_through_a_wall(potential, tol):
    start, end = WALLS[potential]
    system = lp.System(lp.canonical(1), f"p1^2/2 + {potential.replace('q', 'q1')}")
    orbit = lp.integrate(system, start, times=np.linspace(0, end, 21), method=lp.Taylor(tol=tol))
    assert orbit.outcome[0] == "finished"
    energy = system.functions.energy(orbit.state[0])
    np.testing.assert_allclose(energy, energy[0], atol=1e4 * tol * (1 + energy[0]), rtol=0)


def test_it_bounces_back_from_an_exponential_wall():
    """With H = 1/2, q(t) = ln(2 cosh^2((t - t0)/2)), far from the wall |t - t0| - ln 2."""
    system = lp.System(lp.canonical(1), "p1^2/2 + exp(-q1)")
    orbit = lp.integrate(system, [150.0, -1.0], times=[0, 400])
    np.testing.assert_allclose(orbit.state[0, -1], [400 - 150 - 2 * np.log(2), 1.0], rtol=1e-12)


BARRIERS = {
    # a force that is visible at neither end of a long step: potential, start, end time
    "thin": ("10*exp(-((q1 - 3)/0.2)^2)", [0.0, 1.0], 7.0),
    "step up": ("tanh(80*(q1 - 4))", [0.0, 1.0], 8.0),
    "two steps": ("1/(1 + exp(-60*(q1 - 3))) + 1/(1 + exp(60*(q1 + 3)))", [0.0, 0.5], 40.0),
    "in a well": ("q1^2/2 + 3*exp(-300*(q1 - 1)^2)", [-2.0, 0.0], 20.0),
    "pole": ("1e-3/((q1 - 5)^2 + 1e-4)", [0.0, 1.0], 12.0),
}


@pytest.mark.parametrize("name", BARRIERS)
def test_a_force_inside_a_step_is_seen(name):
    """The reference takes steps so short that it cannot pass over anything."""
    potential, start, end = BARRIERS[name]
    system = lp.System(lp.canonical(1), f"p1^2/2 + {potential}")
    orbit = lp.integrate(system, start, times=[0, end], method=lp.Taylor(tol=1e-9))
    reference = lp.integrate(system, start, times=[0, end], method=lp.RungeKutta(step=2e-3))
    assert orbit.outcome[0] == reference.outcome[0] == "finished"
    np.testing.assert_allclose(orbit.state[0, -1], reference.state[0, -1], rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("direction", [1, -1])
def test_steps_double_where_something_may_be_hidden(direction):
    """A particle that no force reaches: each step is twice as long as the one before it."""
    system = lp.System(lp.canonical(1), "p1^2/2 + exp(-(q1^2 - 10^14)^2)")
    orbit = lp.integrate(system, [0.0, 1.0], times=[0, 1e6 * direction])
    np.testing.assert_array_equal(orbit.state[0, -1], [1e6 * direction, 1])
    assert 10 < orbit.n_steps[0] <= np.log2(1e6) + 2
