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


BARRIERS = {
    # a force that is visible at neither end of a long step: potential, start, end time
    "high": ("10*exp(-((q1 - 5)/0.3)^2)", [0.0, 1.0], 10.0),
    "thin": ("10*exp(-((q1 - 3)/0.2)^2)", [0.0, 1.0], 7.0),
    "wide": ("5*exp(-(q1 - 20)^2)", [0.0, 1.0], 30.0),
    "step up": ("tanh(80*(q1 - 4))", [0.0, 1.0], 8.0),
    "step": ("tanh(80*(q1 - 4))/2", [0.0, 1.2], 20.0),
    "two steps": ("1/(1 + exp(-60*(q1 - 3))) + 1/(1 + exp(60*(q1 + 3)))", [0.0, 0.5], 40.0),
    "sech": ("1/cosh(10*(q1 - 6))^2", [0.0, 1.0], 12.0),
    "ramp": ("log(1 + exp(40*(q1 - 4)))/40", [0.0, 1.0], 8.0),
    "in a well": ("q1^2/2 + 3*exp(-300*(q1 - 1)^2)", [-2.0, 0.0], 20.0),
    "pole": ("1e-3/((q1 - 5)^2 + 1e-4)", [0.0, 1.0], 12.0),
}


@pytest.mark.parametrize("name", BARRIERS)
@pytest.mark.parametrize("tol", [1e-15, 1e-9])
def test_a_force_inside_a_step_is_seen(name, tol):
    """The reference takes steps so short that it cannot pass over anything."""
    potential, start, end = BARRIERS[name]
    system = lp.System(lp.canonical(1), f"p1^2/2 + {potential}")
    orbit = lp.integrate(system, start, times=[0, end], method=lp.Taylor(tol=tol))
    reference = lp.integrate(system, start, times=[0, end], method=lp.RungeKutta(step=5e-4))
    assert orbit.outcome[0] == reference.outcome[0] == "finished"
    np.testing.assert_allclose(orbit.state[0, -1], reference.state[0, -1], rtol=1e-5, atol=1e-5)


def test_starts_in_a_well_with_a_step():
    """The energy of each of 200 orbits is that of its start, on whichever side of the step it is."""
    system = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2 + 0.3*tanh(40*(q1 - 1/2))")
    starts = np.random.default_rng(1).uniform(-1.6, 1.6, (200, 2))
    orbits = lp.integrate(system, starts, times=[0, 50])
    assert (orbits.outcome == "finished").all()
    energy = system.functions.energy
    np.testing.assert_allclose(energy(orbits.state[:, -1]), energy(starts), rtol=0, atol=1e-9)


@pytest.mark.parametrize("force", [1e-5, 1e-6, 5e-7, 1e-7, 1e-8])
def test_a_weak_force_is_no_round_off(force):
    """A force F from q = 4 on, met at t = 4 with p = 1: q(8) = 8 - F 4^2/2 and p(8) = 1 - 4 F, up to terms of F^2."""
    system = lp.System(lp.canonical(1), f"p1^2/2 + {force!r}*log(1 + exp(80*(q1 - 4)))/80")
    orbit = lp.integrate(system, [0.0, 1.0], times=[0, 8])
    q, p = orbit.state[0, -1]
    # the edge is symmetric about q = 4: its first moment vanishes, its second is pi^2/3/80^2
    assert abs(q - (8 - 8 * force)) < 1e-3 * force + 1e-12
    assert abs(p - (1 - 4 * force)) < 1e-3 * force + 1e-12
    energy = system.functions.energy(orbit.state[0])
    assert abs(energy[1] - energy[0]) < 1e-11


def test_what_is_seen_depends_on_the_way_and_not_on_the_end_time():
    system = lp.System(lp.canonical(1), "p1^2/2 + exp(-50*(q1 - 5)^2)")
    states = [lp.integrate(system, [0.0, 1.0], times=[0, end]).state[0, -1] for end in (20, 40, 80)]
    assert all(p == pytest.approx(-1, abs=1e-9) for _, p in states)
    np.testing.assert_allclose(np.diff([q for q, _ in states]), [-20, -40], atol=1e-8)


@pytest.mark.parametrize("direction", [1, -1])
def test_nothing_is_shortened_where_nothing_is_hidden(direction):
    """A free particle of a field that is no polynomial still takes one step."""
    system = lp.System(lp.canonical(1), "sqrt(1 + p1^2)")
    orbit = lp.integrate(system, [0.0, 1.0], times=[0, 1e6 * direction])
    assert orbit.n_steps[0] <= 2


@pytest.mark.parametrize("direction", [1, -1])
def test_steps_double_where_something_may_be_hidden(direction):
    """A particle that no force reaches: each step is twice as long as the one before it."""
    system = lp.System(lp.canonical(1), "p1^2/2 + exp(-(q1^2 - 10^14)^2)")
    orbit = lp.integrate(system, [0.0, 1.0], times=[0, 1e6 * direction])
    np.testing.assert_array_equal(orbit.state[0, -1], [1e6 * direction, 1])
    assert 10 < orbit.n_steps[0] <= np.log2(1e6) + 2
