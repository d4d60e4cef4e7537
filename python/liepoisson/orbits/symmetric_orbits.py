r"""Symmetric periodic orbits of a level: a search by shooting between the fixed sets of reversers.

An orbit that meets $\mathrm{Fix}\,\rho_0$ and, after the time T, $\mathrm{Fix}\,\rho_1$ closes up to $\rho_1\rho_0$
after 2T.  On a level of a leaf of dimension 2m both fixed sets usually have the dimension m - 1, so such segments are
isolated zeros of as many equations as unknowns, and every orbit that meets the fixed sets twice is found by a search
that is fine enough.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import blocks, checkpoint, has_passed
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import are_equal
from liepoisson.leaf.starts import find_start
from liepoisson.model.discrete_symmetries import DiscreteSymmetry, discrete_symmetries
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.time_scale import natural_duration
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import SymmetricOrbit, SymmetricOrbits, loop_spectrum
from liepoisson.orbits.shooting import Flow, Segments, Shooting, are_finite, fixed_basis, n_times_of
from liepoisson.portable import linear
from liepoisson.streams import Purpose, Random, stream

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

CLOSES = 1e-12
"""Largest residual of an orbit, in units of the level; longer orbits that are too unstable for it are not kept."""

_NATURAL_TIMES, _TIMES_PER_UNIT = 15.0, 12.0
_SHORTEST = 0.1
"""A segment is at least so many natural times long: near an equilibrium none is shorter than a quarter of a turn."""

_GUESSES_PER_START = 2
_UNITS, _N_UNITS, _ROUNDS = 2**20, 32, 4
"""The stream of the states that give the unit of time, their number, and how often it is made shorter."""

_SINGULAR = 1e-8
_SAME_TIME, _SAME_STATE = 1e-7, 1e-5
_LONGEST_MULTIPLE = 60
_FAMILY = 1e-5
"""A further multiplier this near to 1: a double one scatters by the root of the round-off."""


Segment: TypeAlias = tuple[DiscreteSymmetry, DiscreteSymmetry, Array, float]
"""The reversers at its ends, its start and its time."""


@shows_progress
def symmetric_periodic_orbits(
    system: System,
    leaf: Leaf | Mapping[str, float | str],
    energy: float | str,
    *,
    reversers: Sequence[DiscreteSymmetry] | None = None,
    n_starts: int = 200,
    t_end: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> SymmetricOrbits:
    r"""Periodic orbits that meet the fixed sets of reversers twice, on one level of H and the Casimirs.

    From random states in the fixed set of one reverser, the moments when their orbits come near that of another (or the
    same) are improved by Newton's method in the start and the time.  Each orbit is listed once, with its shortest
    segment, and of orbits that are images of one another under discrete symmetries of the level one is listed.  Those
    with a further multiplier 1 belong to families, as in integrable systems, and are only counted.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + 9*dot(q, q)/2")
        >>> found = lp.orbits.symmetric_periodic_orbits(oscillator, {}, energy=1)
        >>> [round(orbit.period, 12) for orbit in found]  # 2 pi / 3
        [2.094395102393]

    Args:
        system: A system whose parameters are all numbers.
        leaf: A regular leaf, or the values of the Casimirs by name.
        energy: The value of the Hamiltonian; a text is exact.
        reversers: Those of `liepoisson.systems.discrete_symmetries` that are used; by default all that map the level to
            itself and have fixed sets of dimension m - 1 on it.
        n_starts: How many starts, for each pair of reversers.
        t_end: The longest time of a segment, a half of the time in which an orbit returns up to a symmetry; by default
            15 times $1/\rho(Df)$, with the median of the spectral radius along orbits of the level.
        seed: Draws the starts.
        threads: By default all processors, for the survey of all starts; Newton's method runs in one thread.  Results
            do not depend on it, bit for bit.
        time_limit: Seconds after which nothing more is looked for; what was found by then is described to the end, and
            `is_cut_short` is true.

    Returns:
        The orbits by decreasing growth rate; that there are no others is not proved.

    Raises:
        LeafError: the leaf is not regular, no state of it has this energy, or H and the Casimirs depend on each other
            at all states that were found.
        ParameterError: the system has no reverser that maps the level to itself, or a value is not as it must be.
        MemoryLimitError: the states up to `t_end` do not fit into memory.

    References: [devogelaere1958], for the method; [lamb1998].
    """
    run = RunOptions.read(None, threads, time_limit, progress, seed=seed)
    n_starts, seed = as_count(n_starts, "n_starts", least=1), run.seed
    level = searched(level_of(system, leaf, energy), seed)
    chosen = reversers_of(level, reversers)
    flow = Flow(level.system, run.threads)
    draws = [stream(seed, Purpose.SYMMETRIC_ORBITS, k) for k in range(len(chosen))]
    unit = natural_time(level, seed)
    natural = _NATURAL_TIMES * unit
    longest = natural if t_end is None else as_time(t_end, "t_end", example=natural)
    found: list[Segment] = []
    n_families = 0
    pairs = list(combinations_with_replacement(range(len(chosen)), 2))
    n_times = max(16, n_times_of(_TIMES_PER_UNIT * longest, unit))
    n_done, meets, is_regular = 0, False, False
    with run.deadline.running():
        for n in blocks(n_starts):
            starts = [_starts(level, one, n, draw) for one, draw in zip(chosen, draws, strict=True)]
            meets |= any(len(x) for x in starts)
            n_done += n
            if not level.is_regular_at(np.concatenate(starts)).any():
                continue
            is_regular = True
            for k, (i, j) in enumerate(pairs):
                if has_passed():
                    break
                run.tell(0.9 * (n_done - n + n * k / len(pairs)) / n_starts)
                if len(starts[i]):
                    shooting = Shooting(level, chosen[i], chosen[j], flow)
                    guesses = shooting.near(starts[i], longest, n_times, _GUESSES_PER_START * n)
                    solved = shooting.solved(guesses, tolerance=CLOSES, least=_SHORTEST * unit, most=longest)
                    isolated = solved.of(solved.regularity > _SINGULAR)
                    n_families += len(solved) - len(isolated)
                    segments = zip(isolated.start, isolated.time, strict=True)
                    found += [(chosen[i], chosen[j], x, float(T)) for x, T in segments]
        is_cut_short = has_passed()
    if not (meets or is_cut_short):
        raise LeafError(
            f"a symmetric orbit must meet a fixed set; none of {len(chosen)} was found to have states on {level.text}. "
            f"The energies of the leaf are {level.leaf.energy_range()}."
        )
    if not (is_regular or is_cut_short):
        raise LeafError(f"H and the Casimirs must be independent on {level.text}; their gradients are dependent there.")
    group = group_of_level(level)
    shortest = _shortest(level, flow, chosen, _distinct(level, found, group))
    named = [_named_image(level, flow, one, chosen, group) for one in _distinct(level, shortest, group)]
    orbits = [one for one in (symmetric_orbit(level, flow, segment) for segment in named) if one.residual <= CLOSES]
    alone = [one for one in orbits if not _is_of_family(one)]
    alone.sort(key=lambda one: (-round(one.rate, 9), one.period))
    n_families += len(orbits) - len(alone)
    return SymmetricOrbits(level, tuple(alone), tuple(chosen), float(longest), n_done, n_families, is_cut_short)


def reversers_of(level: Level, given: Sequence[DiscreteSymmetry] | None = None) -> list[DiscreteSymmetry]:
    """The reversers of a level: those that are given, or all that suit shooting.

    Raises:
        ParameterError: there is none, or one that is given does not map the level to itself.
    """
    system = level.system
    if given is not None:
        chosen = sequence(given, "reversers", "reversers", "discrete_symmetries(system).reversers")
        for one in chosen:
            if not isinstance(one, DiscreteSymmetry) or not one.is_reverser or not are_equal(one.system, system):  # pyright: ignore[reportUnnecessaryIsInstance]
                raise ParameterError(
                    f"reversers: wanted involutions of {system.name} that reverse time, as discrete_symmetries(system)."
                    f"reversers has them; got {shown(one)}"
                )
            if not one.meets(level.values):
                raise ParameterError(f"reversers must map {level.text} to itself; {one.text} does not")
        if chosen:
            return list(chosen)
    half = (level.dimension - 1) // 2
    every = discrete_symmetries(system).reversers
    found = [one for one in every if one.meets(level.values) and one.fixed_space and one.fixed_dimension == half]
    if not found:
        raise ParameterError(
            f"{system.name} must have a reverser that maps {level.text} to itself and has a fixed set of dimension "
            f"{half} on it; of {len(every)} changes of signs and exchanges of components that reverse time none does"
        )
    return found


def searched(level: Level, seed: int) -> Level:
    """The level in units of its states: of the nearer half of random ones, or of one that a search finds."""
    n = len(level.units)
    if not level.functions["H"].is_polynomial:  # nothing but a state says how large states are
        level = level.in_units_of(level.leaf.state[None])
    draw = stream(seed, Purpose.SYMMETRIC_ORBITS, _UNITS)
    states, arrived = level.projected(draw.standard_normal((_N_UNITS, n)) * level.units, np.eye(n))
    if arrived.any():
        states = states[arrived]
        lengths = linear.norm(states / level.units, axis=1)
        return level.in_units_of(states[lengths <= np.median(lengths)])
    try:
        state = find_start(level.system, leaf=level.leaf, energy=level.number("H"), seed=seed).state
    except LeafError:
        return level
    return level.in_units_of(state[None])


def natural_time(level: Level, seed: int) -> float:
    r"""$1/\mathrm{median}\,\rho(Df)$ along orbits of random states of the level, to two digits; 1 where all vanish.

    States of a level that are drawn at random may all be untypical: hence 32 such times are followed, and the median is
    taken again, until it does not become much shorter.
    """
    n, system = len(level.units), level.system
    draw = stream(seed, Purpose.SYMMETRIC_ORBITS, _UNITS)
    states, arrived = level.projected(draw.standard_normal((_N_UNITS, n)) * level.units, np.eye(n))
    starts, unit = states[arrived], _median_time(system, states[arrived])
    for _ in range(_ROUNDS):
        if not np.isfinite(unit):
            return 1.0
        flow = Flow(system, 1).searching(int(_TIMES_PER_UNIT) * _N_UNITS)
        _, path = flow.survey(starts, _N_UNITS * unit, _N_UNITS)
        before, unit = unit, _median_time(system, path[are_finite(path)])
        if unit > before / 2:
            break
    return natural_duration(1.0, np.array([unit]), otherwise=1.0)


def _median_time(system: System, states: Array) -> float:
    """1 over the median of the spectral radius of Df."""
    if not len(states):
        return np.inf
    median = float(np.median(np.abs(linear.eigvals(system.functions.jacobian(states))).max(axis=-1)))
    return 1 / median if median > 0 else np.inf


def _starts(level: Level, reverser: DiscreteSymmetry, n_starts: int, draw: Random) -> Array:
    """Random states in the fixed set, on the level."""
    basis = fixed_basis(reverser)
    guesses = linear.matmul(draw.standard_normal((n_starts, basis.shape[1])), basis.T) * level.units
    states, arrived = level.projected(guesses, basis)
    return states[arrived]


def _shortest(
    level: Level, flow: Flow, reversers: Sequence[DiscreteSymmetry], found: Sequence[Segment]
) -> list[Segment]:
    """The shortest segment of each orbit: where a part 1/k of the time leads to a fixed set, that part.

    The moments when an orbit is in a fixed set are evenly spaced, so no others need be looked at.
    """
    if not found:
        return []
    parts = np.arange(2, _LONGEST_MULTIPLE + 1)
    starts = np.repeat(np.array([one[2] for one in found]), len(parts), axis=0)
    times = (np.array([one[3] for one in found])[:, None] / parts).ravel()
    ends = flow.ends(starts, times)[0].reshape(len(found), len(parts), -1)
    shortest: list[Segment] = []
    for (first, last, x, T), states in zip(found, ends, strict=True):
        segment = first, last, x, T
        for n, y in reversed(list(zip(parts.tolist(), states, strict=True))):
            met = [r for r in reversers if np.abs((r(y) - y) / level.units).max() < _SAME_STATE]
            if met and (part := _improved(level, flow, (first, met[0], x, T / n))) is not None:
                segment = part
                break
        shortest.append(segment)
    return shortest


def _improved(level: Level, flow: Flow, segment: Segment) -> Segment | None:
    """A segment after Newton's method; None if it does not converge."""
    first, last, start, time = segment
    guess = Segments(start[None], np.array([time]), np.zeros(1), np.ones(1))
    solved = Shooting(level, first, last, flow).solved(guess, tolerance=CLOSES, least=0.5 * time, most=2 * time)
    if not len(solved):
        checkpoint("the description of an orbit")
        return None
    return first, last, solved.start[0], float(solved.time[0])


def _distinct(
    level: Level,
    segments: Sequence[Segment],
    group: Sequence[Array],
) -> list[Segment]:
    """One segment for each orbit, and for its images under a group."""
    flow = Flow(level.system, 1)
    kept: list[Segment] = []
    images: list[Array] = []
    if not segments:
        return kept
    order = sorted(range(len(segments)), key=lambda k: (segments[k][3], k))
    ends = flow.ends(np.array([s[2] for s in segments]), np.array([s[3] for s in segments]))[0]
    for k in order:
        x, T = segments[k][2], segments[k][3]
        seen = False
        for other, places in zip(reversed(kept), reversed(images), strict=True):
            if T - other[3] > _SAME_TIME * T:
                break
            if (np.abs((places - x) / level.units).max(axis=1) < _SAME_STATE).any():
                seen = True
                break
        if not seen:
            kept.append(segments[k])
            images.append(np.array([linear.matmul(g, y) for g in group for y in (x, ends[k])]))
    return kept


def _named_image(
    level: Level, flow: Flow, segment: Segment, reversers: Sequence[DiscreteSymmetry], group: Sequence[Array]
) -> Segment:
    """The image of an orbit that stands for all of them, which does not depend on the starts of the search.

    It begins in the fixed set of the reverser that comes first in the list, at the state that is the last in the order
    of its components.
    """
    first, last, start, time = segment
    numbers = {id(one): k for k, one in enumerate(reversers)}
    (end,), _ = flow.ends(start[None], np.array([time]))
    ways = [(first, last, start, end, False)]
    if numbers[id(last)] < numbers[id(first)]:
        ways = [(last, first, end, start, True)]
    elif first is last:
        ways.append((first, last, end, start, True))

    def is_fixed(one: DiscreteSymmetry, x: Array) -> bool:
        return bool(np.abs((one(x) - x) / level.units).max() < _SAME_STATE)

    images = [
        (f, l, linear.matmul(g, x), is_reversed)
        for f, l, x, y, is_reversed in ways
        for g in group
        if is_fixed(f, linear.matmul(g, x)) and is_fixed(l, linear.matmul(g, y))
    ]
    chosen = max(images, key=lambda one: tuple(np.round(one[2] / level.units, 6) + 0.0))
    named = (*chosen[:3], time)
    return (_improved(level, flow, named) or segment) if chosen[3] else named


def _is_of_family(orbit: SymmetricOrbit) -> bool:
    """Whether a multiplier of the closed orbit, all loops together, is 1."""
    n, closing = 1, linear.matmul(orbit.last.matrix, orbit.first.matrix)
    power = closing
    while not np.array_equal(power, np.eye(len(power))):
        power, n = linear.matmul(closing, power), n + 1
    return bool((np.abs(orbit.multipliers**n - 1) < _FAMILY).any())


def group_of_level(level: Level) -> list[Array]:
    """The matrices of all discrete symmetries that map a level to itself, with the identity."""
    identity = np.eye(len(level.units))
    return [identity, *(one.matrix for one in discrete_symmetries(level.system) if one.meets(level.values))]


def symmetric_orbit(level: Level, flow: Flow, segment: Segment) -> SymmetricOrbit:
    """The orbit of a segment, with its multipliers."""
    first, last, start, time = segment
    system, units = level.system, level.units
    closing = linear.matmul(last.matrix, first.matrix)
    (end,), _ = flow.ends(start[None], np.array([time]))
    _, forwards = flow.matrix(start, 2 * time)
    _, backwards = flow.matrix(start, -2 * time)
    spectrum = loop_spectrum(
        linear.matmul(closing.T, forwards) * units / units[:, None],
        linear.matmul(closing, backwards) * units / units[:, None],
        level.gradients(start) * units,
        system.vector_field(start) / units,
    )
    residual = max(float(np.abs((last(end) - end) / units).max()) / 2, float(level.distance(start)))
    return SymmetricOrbit(
        level, first, last, start, end, time, residual, spectrum.values, spectrum.pair_defect, spectrum.trivial_defect
    )
