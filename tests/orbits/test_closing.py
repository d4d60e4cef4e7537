"""Newton's method for loops: sums of multipliers, and the last step."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import Deadline
from liepoisson.orbits import closing
from liepoisson.orbits.closed_orbits import problem_at
from liepoisson.orbits.guesses import shortest

HENON = lp.catalog.system("henon-heiles")
SADDLE = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10")
LARGE = lp.System(lp.canonical(2), "(p1^2 + p2^2 + q1^2 + q2^2)/2 + (q1^2*q2 - q2^3/3)/2^20")
TOP = lp.Top.twisted_kovalevskaya()
LAGRANGE = lp.catalog.system("lagrange")


def loop_of(system, start, period, **options):
    orbit = lp.orbits.periodic_orbit(system, start, period=period, **options)
    problem = problem_at(
        system, orbit.start, momenta=orbit.momenta, threads=1, along=orbit.states(20)
    )  # fmt: skip
    guess = problem.loops(orbit.start[None], np.array([orbit.time]), orbit.angles[None])
    return orbit, problem, problem.closing.solved(guess)


def test_the_sum_of_the_multipliers_of_a_loop():
    """Without trivial ones: with Casimirs, with rotations, in several segments, in other units."""
    top = lp.orbits.periodic_orbits(TOP, {"C1": 1, "C2": "1/2", "C3": 1}, "1/2", n_starts=10)[0]
    for orbit, problem, loop in (
        loop_of(HENON, [0, 0, 0, 0.2], 6.3),
        loop_of(LARGE, [0, 0, 0, 0.2 * 2**20], 6.3),
        loop_of(SADDLE, [3.1, 0, 0, 0.4], 6.3, energy="1.1"),
        loop_of(TOP, top.start, top.period),
        loop_of(LAGRANGE, lp.sample_states(LAGRANGE, 1, seed=3)[0], 3.093, momenta=["l3"]),
    ):
        assert problem.closing.sums(loop)[0] == pytest.approx(orbit.multipliers.sum().real, rel=1e-9, abs=1e-9)


def test_a_limit_that_cuts_the_orbit_of_a_loop_is_told():
    """No number of turns is read from an orbit that was not followed to its end."""
    _, problem, loop = loop_of(HENON, [0, 0, 0, 0.2], 6.3)
    with Deadline(1e-9).running(), pytest.raises(TimeLimitError, match="time limit"):
        shortest(problem, loop)


def test_a_loop_is_followed_no_more_once_it_closes(monkeypatch):
    """Each error is the square of the one before; a step whose square is round-off is the last one."""
    orbit, problem, _ = loop_of(HENON, [0, 0.01, 0.02, 0.2], 6.3)
    guess = problem.loops(orbit.start[None] * (1 + 1e-5), np.array([orbit.time]))
    sizes, linearised = [], closing.Closing.linearised

    def counted(self, *here):
        found = linearised(self, *here)
        sizes.append(np.abs(found.gaps).max())
        return found

    monkeypatch.setattr(closing.Closing, "linearised", counted)
    problem.closing.solved(guess)
    assert sizes[-1] < 1e-14
    assert len(sizes) <= 3
