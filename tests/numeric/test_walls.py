"""Walls that a power series does not show where a step begins: the trajectory bounces, as energy demands."""

import numpy as np
import pytest

import liepoisson as lp

WALLS = {
    # potential: start, end time
    "q^26": ([0.0, 1.0], 10.0),
    "q^64": ([0.001, 1.0], 10.0),
    "q^14": ([0.0, 1.0], 10.0),
    "exp(-q)": ([150.0, -1.0], 400.0),
    "exp(-50*q)": ([5.0, -1.0], 12.0),
    "exp(-1/q^2)": ([1.1, 0.0], 10.0),
}


@pytest.mark.parametrize("potential", WALLS)
@pytest.mark.parametrize("tol", [1e-15, 1e-10, 1e-6])
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


def test_particles_of_a_toda_lattice_do_not_pass_through_each_other():
    system = lp.System(lp.canonical(2), "(p1^2 + p2^2)/2 + exp(q1 - q2)")
    orbit = lp.integrate(system, [0.0, 200.0, 0.5, -0.5], times=[0, 600])
    np.testing.assert_allclose(orbit.state[0, -1, 2:], [-0.5, 0.5], rtol=1e-12)
    section = lp.section(system, [0.0, 200.0, 0.5, -0.5], surface="q2 - q1", t_end=600)
    assert not len(section.time)


@pytest.mark.parametrize("direction", [1, -1])
def test_nothing_is_shortened_where_nothing_is_hidden(direction):
    """A free particle of a field that is no polynomial still takes one step."""
    system = lp.System(lp.canonical(1), "sqrt(1 + p1^2)")
    orbit = lp.integrate(system, [0.0, 1.0], times=[0, 1e6 * direction])
    assert orbit.n_steps[0] <= 2
