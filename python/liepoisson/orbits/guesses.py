"""The periodic orbit near one guess: what a caller gives, and Newton's method from there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from liepoisson.algebra.residues import primes
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import LeafError, OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import as_system
from liepoisson.model.discrete_symmetries import DiscreteSymmetry
from liepoisson.numeric.integrate import Orbit
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts, as_states, given_starts
from liepoisson.orbits.closed_orbits import CLOSES, SAME, Momenta, PeriodicOrbit, Problem, problem_at
from liepoisson.orbits.closing import Loops
from liepoisson.orbits.multipliers import SymmetricOrbit
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

Guess: TypeAlias = "StartsLike | PeriodicOrbit | SymmetricOrbit | Orbit"
"""A state, an orbit that was found, or a trajectory that comes back near to itself."""

_RETURNS, _OTHER_PERIOD = 8, 0.05
"""How many of the nearest returns of a trajectory are tried, and how much their times differ, relative."""
_NEAR_PERIOD = 0.2
"""How much a return's time may differ from a period that is given."""
SIZES = 32
"""States of the orbit of a guess whose sizes are the units."""
_LOOKS = 1000
"""Times of a trajectory at which returns are looked for; all pairs of them are compared."""


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
    check_moves(guess, "guess")
    with run.deadline.running():
        states, times, angles = _guesses(system, guess, period)
        along = Flow(system, run.threads).paths(states, times, SIZES)
        problem = problem_at(
            system, states[0], leaf=leaf, energy=energy, holds_period=holds_period, momenta=momenta,
            symmetry=symmetry, threads=run.threads, along=along.reshape(-1, states.shape[1]),
        )  # fmt: skip
        rest = linear.norm(system.vector_field(states) / problem.closing.level.units, axis=1) * times
        if not (rest > SAME).any():
            raise ParameterError(
                f"guess: wanted a state on an orbit, which moves in the period; {shown(states[0])} is at rest, or the "
                f"period {times[0]:g} too short: in this time it moves by {rest[0]:.1e} of its size"
            )
        if not holds_period:
            states, arrived = problem.closing.level.projected(states, np.eye(states.shape[1]))
            if not arrived.any():
                raise LeafError(
                    f"an orbit must lie on its level; no state of {problem.closing.level.text} was found near the "
                    f"guess. The energies of the leaf are {problem.closing.level.leaf.energy_range()}."
                )
            states, times, angles = states[arrived], times[arrived], angles[arrived]
        k = len(problem.closing.rotations)
        tried = problem.improved(states, times, angles if angles.shape[1] == k else None, n_segments=count)
        loop, is_orbit = min(tried, key=lambda one: (not one[1], not one[1] and float(one[0].residual[0])))
        if loop.residual[0] <= CLOSES and not is_orbit:
            raise OrbitError(
                f"an orbit must move; from this guess Newton's method comes to {shown(loop.state[0, 0])} on "
                f"{problem.closing.level.text}, which is at rest{' or only turns' if k else ''}"
            )
        if not is_orbit:
            where = ", of any energy" if holds_period else f" on {problem.closing.level.text}"
            raise OrbitError(
                f"an orbit must close to {CLOSES:g}; from this guess Newton's method comes to "
                f"{loop.residual[0]:.1e} at the period {loop.time[0]:.6g}{where}. "
                "Give a nearer guess, or one of lp.orbits.symmetric_periodic_orbits"
            )
        run.tell(0.5)
        return problem.described(shortest(problem, loop))


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
        states, times = _returns(guess, None if period is None else as_time(period, "period", example=1.0))
        return states, times, np.zeros((len(times), 0))
    if period is None:
        raise ParameterError("period: wanted the time after which the orbit closes, about; got none; write period=6.3")
    given = given_starts(system, cast("StartsLike", guess), "guess")
    states = as_states(given, len(system.component_names), "guess", names=system.component_names)
    if len(states) != 1:
        raise ParameterError(f"guess: wanted one state; got {len(states)}; many are taken by lp.orbits.periodic_orbits")
    states = as_starts(system, states, len(system.component_names))  # where H is a real number
    return states, np.array([as_time(period, "period", example=6.3)]), np.zeros((1, 0))


def check_moves(guess: object, name: str) -> None:
    """Refuse an equilibrium as a guess.

    Raises:
        ParameterError: it is one.
    """
    if isinstance(guess, Equilibrium):
        raise ParameterError(
            f"{name}: wanted a state on an orbit; got an equilibrium, whose small orbits are those of "
            "lp.orbits.orbit_family(system, equilibrium)"
        )


def _returns(orbit: Orbit, period: float | None) -> tuple[Array, Array]:
    """The nearest returns of a trajectory to itself: states, and the times after which they come back.

    Raises:
        ParameterError: there is none, or the orbit has more than one trajectory.
    """
    if len(orbit.state) != 1:
        raise ParameterError(f"guess: wanted one trajectory; got {len(orbit.state)}; take orbit.isel(trajectory=[0])")
    keep = np.unique(np.linspace(0, len(orbit.time) - 1, min(len(orbit.time), _LOOKS)).astype(int))
    time, state = orbit.time[keep], orbit.state[0, keep]
    known = np.isfinite(state).all(axis=1)
    time, state = time[known], state[known]
    scale = np.maximum(np.abs(state - state.mean(axis=0)).max(axis=0, initial=0.0), np.finfo(float).tiny)
    gaps = linear.norm((state[:, None] - state[None]) / scale.max(initial=1.0), axis=2)
    found: list[tuple[float, float, int]] = []
    for i in range(len(time) - 2):
        row = gaps[i, i:]
        places = 1 + np.nonzero((row[1:-1] <= row[:-2]) & (row[1:-1] < row[2:]))[0]
        found += [(float(row[k]), abs(float(time[i + k] - time[i])), i) for k in places.tolist()]
    found = sorted(one for one in found if period is None or abs(one[1] / period - 1) < _NEAR_PERIOD)
    chosen: list[tuple[float, float, int]] = []
    for one in found:
        if all(abs(one[1] / other[1] - 1) > _OTHER_PERIOD for other in chosen):
            chosen.append(one)
        if len(chosen) == _RETURNS:
            break
    if not chosen:
        raise ParameterError(
            "guess: wanted a trajectory that comes back near to itself; this one does not; follow it longer"
        )
    return state[[i for _, _, i in chosen]], np.array([T for _, T, _ in chosen])


def shortest(problem: Problem, loops: Loops) -> Loops:
    """The loop of the least time of which this one is a multiple: divided by a prime as long as that closes, too."""
    while (part := _part(problem, loops)) is not None:
        loops = part
    return loops


def _part(problem: Problem, loops: Loops) -> Loops | None:
    """The loop whose time is the largest prime part of that of a loop, if one closes, too."""
    closing, T = problem.closing, float(loops.time[0])
    chain, units = loops.state[0], closing.level.units
    most = _most_parts(problem, loops)
    if most < 2:
        return None
    parts = np.array([*primes(most, 1), 2])
    first = (
        len(chain) - 1
    ) // parts  # of each part the segment in which it ends: the round-off of others does not count
    ends, _ = closing.flow.ends(chain[first], T * (1 / parts - first / len(chain)))
    for n, end in zip(parts.tolist(), ends, strict=True):
        angles = problem.parts(loops.angle[0], n)
        gaps = np.abs((end - linear.matmul(closing.turn(angles), chain[0])) / units).max(axis=1)
        best = int(np.argmin(gaps))
        if gaps[best] < SAME:
            part = closing.solved(problem.loops(chain[:1], np.array([T / n]), angles[best][None]))
            if problem.closed(part)[0] and abs(part.time[0] * n / T - 1) < SAME:
                return part
    return None


def _most_parts(problem: Problem, loops: Loops) -> int:
    r"""A number of orbits that a loop cannot consist of more than: f turns by $2\pi$ or more along each of them.

    Its direction moves by no more than $|Df\,f|/|f|$, of which the mean over some states is taken twice.  Up to a
    rotation, by half a turn at most, $\pi$ is enough.

    Raises:
        TimeLimitError: the deadline of the call has passed.

    References: [fenchel1929].
    """
    system, m, T = problem.system, loops.state.shape[1], float(loops.time[0])
    _, between = problem.closing.flow.survey(loops.state[0], T / m, -(-SIZES // m))
    checkpoint("the shortest time after which an orbit closes")
    states = between[:, :-1].reshape(-1, between.shape[2])
    rates = system.vector_field(states)
    turning = linear.einsum("nij,nj->ni", system.functions.jacobian(states), rates)
    speed, turned = (linear.norm(each / problem.closing.level.units, axis=1) for each in (rates, turning))
    mean = float((turned / np.maximum(speed, np.finfo(float).tiny)).mean())
    return int(np.ceil(2 * T * mean / np.pi / (1 if len(problem.closing.rotations) else 2)))
