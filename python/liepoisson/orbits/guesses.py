"""Where periodic orbits are looked for: what a caller gives, and Newton's method from there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import as_system
from liepoisson.model.discrete_symmetries import DiscreteSymmetry
from liepoisson.numeric.integrate import Orbit
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.orbits.closed_orbits import CLOSES, Momenta, PeriodicOrbit, Problem, problem_at
from liepoisson.orbits.closing import Loops
from liepoisson.orbits.periodic_orbits import SymmetricOrbit
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

Guess: TypeAlias = "StartsLike | PeriodicOrbit | SymmetricOrbit | Orbit"
"""A state, an orbit that was found, or a trajectory that comes back near to itself."""

_SAME = 1e-6
_LARGEST_PART = 12
"""An orbit is looked for whose period is a part of the one that was found, up to this one."""
_RETURNS = 8
"""How many of the nearest returns of a trajectory are tried."""


@shows_progress
def periodic_orbit(
    system: System,
    guess: Guess,
    *,
    period: float | None = None,
    leaf: Leaf | Mapping[str, float | str] | None = None,
    energy: float | str | None = None,
    hold: str = "energy",
    momenta: Momenta = (),
    symmetry: DiscreteSymmetry | None = None,
    n_segments: int | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> PeriodicOrbit:
    r"""The periodic orbit near a guess, on a level of H and the Casimirs, by Newton's method on multiple shooting.

    It need not be symmetric.  The state is moved onto the level first.  Least squares take account of the integrals,
    of the direction of the flow and of rotations, so nothing has to be unfolded.

    Example:
        >>> system = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10")
        >>> orbit = lp.orbits.periodic_orbit(system, [3.1, 0, 0, 0.4], period=6.3, energy="1.1")
        >>> round(orbit.period, 8), orbit.stability  # the orbit above the saddle
        (6.26757814, 'hyperbolic')

    Args:
        system: A system whose parameters are all numbers.
        guess: A state, by components or by name; or an orbit that was found, perhaps on another level or of another
            system; or a trajectory, as `integrate` returns it, whose nearest returns to itself are tried.
        period: The period, about; needed for a state.
        leaf: A regular leaf, or the values of the Casimirs by name; by default that of the guess.
        energy: The value of the Hamiltonian; by default that of the guess.
        hold: "energy", or "period": the orbit of the given period, of whatever energy.
        momenta: Linear integrals, such as "l3", whose values are held, too, those of the guess or given by name; the
            orbit then closes up to their rotations: a relative periodic orbit.
        symmetry: A discrete symmetry up to which the orbit closes after `period`.
        n_segments: Of how many segments it is made; by default of so many that neighbours grow 100 times in each.

    Returns:
        The orbit, with its least period.

    Raises:
        LeafError: the leaf is not regular, or no state of it has this energy.
        OrbitError: Newton's method does not come to an orbit that closes to 1e-12; the message says how near it came.
        ParameterError: no period is given, the guess is an equilibrium or at rest, or a value is not as it must be.
        TimeLimitError: the time limit has passed.

    References: [seydel2010]; [munozalmaraz2003].
    """
    run = RunOptions.read(None, threads, time_limit, progress)
    system = as_system(system)
    holds_period = _holds_period(hold, energy, period)
    count = None if n_segments is None else as_count(n_segments, "n_segments", least=1, most=256)
    if isinstance(guess, Equilibrium):
        raise ParameterError(
            "guess: wanted a state on an orbit; got an equilibrium, whose small orbits are those of "
            "lp.orbits.orbit_family(system, equilibrium)"
        )
    with run.deadline.running():
        states, times, angles = _guesses(system, guess, period)
        problem = problem_at(
            system, states[0], leaf=leaf, energy=energy, holds_period=holds_period, momenta=momenta,
            symmetry=symmetry, threads=run.threads,
        )  # fmt: skip
        rest = linear.norm(system.vector_field(states) / problem.closing.level.units, axis=1) * times
        if not (rest > _SAME).any():
            raise ParameterError(f"guess: wanted a state on an orbit; got {shown(states[0])}, which is at rest")
        k = len(problem.closing.rotations)
        loops = problem.closing.solved(
            problem.loops(states, times, angles if angles.shape[1] == k else None, n_segments=count)
        )
        best = int(np.argmin(loops.residual))
        if not loops.residual[best] <= CLOSES:
            raise OrbitError(
                f"an orbit must close to {CLOSES:g}; from this guess Newton's method comes to {loops.residual[best]:.1e} "
                f"at the period {loops.time[best]:.6g} on {problem.closing.level.text}. Give a nearer guess, or one of "
                "lp.orbits.symmetric_periodic_orbits"
            )
        run.tell(0.5)
        return problem.described(shortest(problem, loops.of(np.array([best]))))


def _holds_period(hold: object, energy: object, period: object) -> bool:
    from liepoisson.inputs.refusals import check_choice

    check_choice(hold, "hold", ("energy", "period"), "by default the energy is held")
    if hold == "period" and (energy is not None or period is None):
        raise ParameterError('hold="period": wanted the period and no energy; the energy is what is found')
    return hold == "period"


def _guesses(system: System, guess: Any, period: object) -> tuple[Array, Array, Array]:
    """States, times and angles from which Newton's method begins."""
    if isinstance(guess, (PeriodicOrbit, SymmetricOrbit)):
        angles = guess.angles[None] if isinstance(guess, PeriodicOrbit) else np.zeros((1, 0))
        own = guess.time if isinstance(guess, PeriodicOrbit) else guess.period
        return guess.start[None], np.array([own if period is None else as_time(period, "period", example=own)]), angles
    if isinstance(guess, Orbit):
        return (
            *_returns(system, guess, None if period is None else as_time(period, "period", example=1.0)),
            np.zeros((_RETURNS, 0)),
        )
    if period is None:
        raise ParameterError("period: wanted the time after which the orbit closes, about; got none; write period=6.3")
    state = given_starts(system, cast("StartsLike", guess), "guess")
    if state.ndim != 1 and len(state) != 1:
        raise ParameterError(f"guess: wanted one state; got {len(state)}")
    return state.reshape(1, -1), np.array([as_time(period, "period", example=6.3)]), np.zeros((1, 0))


def _returns(system: System, orbit: Orbit, period: float | None) -> tuple[Array, Array]:
    """The nearest returns of trajectories to themselves: states and times between; at least a tenth of the run apart."""
    raise NotImplementedError


def shortest(problem: Problem, loops: Loops) -> Loops:
    """The loop whose time is the largest part of that of a loop which also closes, or the loop itself."""
    closing = problem.closing
    x, T, angle = loops.state[:, 0], float(loops.time[0]), loops.angle
    parts = np.arange(2, _LARGEST_PART + 1)
    ends, _ = closing.flow.ends(np.repeat(x, len(parts), axis=0), T / parts)
    turns = closing.turn(angle / parts[:, None])
    gap = np.abs((ends - linear.matmul(turns, x[0])) / closing.level.units).max(axis=1)
    for n in parts[::-1]:
        if gap[n - 2] < _SAME:
            part = closing.solved(problem.loops(x, np.array([T / n]), angle / n))
            if part.residual[0] <= CLOSES and abs(part.time[0] * n / T - 1) < _SAME:
                return part
    return loops
