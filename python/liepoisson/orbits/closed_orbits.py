r"""Periodic orbits near a guess: with or without symmetry, up to a discrete symmetry or to rotations.

A guess is a state with a period, an orbit that was found, a trajectory that comes back near to itself, or an
equilibrium, around which there are small orbits for each pair of imaginary eigenvalues $\pm i\omega$ that no other one
is a multiple of (Lyapunov's centre theorem).

References: [lyapunov1907]; [seydel2010], multiple shooting; [munozalmaraz2003], conservative systems.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import named, sequence
from liepoisson.inputs.refusals import check_kind
from liepoisson.leaf._checks import are_equal
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.discrete_symmetries import DiscreteSymmetry
from liepoisson.model.free_parameter import FreeParameter, StateAndParameters
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.orbits.closing import GROWTH, MOST_SEGMENTS, Closing, Loops, guessed
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import HYPERBOLIC, ClosedOrbit, ComplexArray, loop_spectra
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.orbits.refine import PreciseOrbit

CLOSES = 1e-12
"""Largest residual of an orbit, in units of its level."""
ISOLATED = 1e-8
"""The smallest singular value of the equations, relative to the largest, of an orbit that is alone on its level."""
SAME = 1e-6
"""What differs by less, relative to the period or in units of the level, is the same."""

_DEPENDENT = 1e-12
"""The smallest singular value, relative, of rotations that are one and the same."""

_ANGLES = 64
"""In a turn, of which the best is where Newton's method begins: the others are a tenth of a radian away."""

Momenta: TypeAlias = "Sequence[str | PhaseFunction] | Mapping[str, float]"


@explains_its_methods
@dataclass(frozen=True, eq=False)
class PeriodicOrbit(ClosedOrbit):
    r"""A periodic orbit of a level, perhaps relative: $\varphi_T(x) = P\,e^{\sum_k\theta_k G_k}x$.

    Example:
        >>> pendulum = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
        >>> orbit = lp.orbits.periodic_orbit(pendulum, [1, 0], period=7)
        >>> round(orbit.period, 9)  # 4 K(sin(1/2))
        6.699975664

    Attributes:
        level: The energy and the leaf.
        start: A state of it, shape (N,).
        time: T, the time after which it closes up to `symmetry` and rotations.
        symmetry: P; None for the identity.
        momenta: The linear integrals that were held, with their values; $G_k$ generates the flow of the k-th.
        angles: $\theta_k$, shape (k,): how far the orbit has turned after T.
        n_segments: How many segments it was computed in.
        residual: The largest gap between them, in units of the level, and deviation from the level, relative.
        is_isolated: Whether the orbit is alone on its level (and values of the momenta), within what doubles can tell.
        multipliers: Those of the loop on the level across the flow (and the rotations), the largest first, then their
            reciprocals in the same order.
        pair_defect: A check of the multipliers: how far they are from reciprocal pairs; round-off.
        trivial_defect: Another: how far the flow, H, the Casimirs and the momenta are from the multiplier 1; round-off.
    """

    kind = "periodic orbit"
    made_by = "lp.orbits.periodic_orbit"

    level: Level
    start: Array
    time: float
    symmetry: DiscreteSymmetry | None
    momenta: Mapping[str, float]
    angles: Array
    n_segments: int
    residual: float
    is_isolated: bool
    multipliers: ComplexArray
    pair_defect: float
    trivial_defect: float

    @property
    def is_relative(self) -> bool:
        """Whether it closes up to rotations only."""
        return bool(self.angles.size and np.abs(self.angles).max() > SAME)

    @property
    def return_time(self) -> float:
        """T: after this time the orbit is at the image of its start under P and the rotations."""
        return self.time

    @property
    def period(self) -> float:
        """The time after which it closes up to rotations: T times the number of images of the start under P."""
        if self.symmetry is None:
            return self.time
        x, n = self.symmetry(self.start), 1
        while np.abs((x - self.start) / self.level.units).max() > SAME:
            x, n = self.symmetry(x), n + 1
        return n * self.time

    def polished(self, *, digits: int = 30) -> PreciseOrbit:
        """The same orbit to so many digits, of polynomial equations without rotations.

        Raises:
            ParameterError: the equations are no polynomials, or momenta are held.
            OrbitError: Newton's method does not converge.
        """
        from liepoisson.orbits.refine import polished_orbit

        return polished_orbit(self, digits)

    def __repr__(self) -> str:
        big = f", |mu| = {abs(self.multipliers[0]):.6g}" if self.multipliers.size else ""
        turned = f", turned by {', '.join(f'{a:.6g}' for a in self.angles)}" if self.is_relative else ""
        alone = "" if self.is_isolated else ", one of a family on its level"
        return (
            f"<PeriodicOrbit of {self.system.name!r} on {self.level.text}: period {self.period:.8g}{turned}, "
            f"{self.stability}{big}{alone}>"
        )


@dataclass(frozen=True, eq=False)
class Problem:
    """What orbits are looked for, as it was read.

    Attributes:
        closing: The equations.
        symmetry: P.
        momenta: The linear integrals that are held, with their values.
    """

    closing: Closing
    symmetry: DiscreteSymmetry | None
    momenta: Mapping[str, float]

    def in_units(self, units: Array) -> Problem:
        """The same in other units of the level."""
        return replace(self, closing=replace(self.closing, level=replace(self.closing.level, units=units)))

    def loops(
        self, states: Array, times: Array, angles: Array | None = None, *, n_segments: int | None = None
    ) -> Loops:
        """Guesses from states and periods: the states between are those of their orbits.

        Args:
            states: Shape (n, N).
            times: Shape (n,).
            angles: Shape (n, k), by default those by which the states turn towards where their orbits end.
            n_segments: Of how many segments; by default as many as one needs, and several where neighbours grow most.
        """
        angles = self._turned(states, self.closing.flow.ends(states, times)[0]) if angles is None else angles
        if n_segments is None:
            wanted = self._counts(states, times, angles) if len(states) == 1 else self._wanted(states, times)
            n_segments = int(wanted.max())
        return self._chained(states, times, angles, n_segments)

    def improved(
        self, states: Array, times: Array, angles: Array | None = None, *, n_segments: int | None = None
    ) -> list[tuple[Loops, bool]]:
        """What Newton's method makes of each guess, and whether that is an orbit.

        Each is made of as many segments as it needs, and those of as many are improved together, so that no loop
        depends on the other guesses.

        Args:
            states: Shape (n, N).
            times: Shape (n,).
            angles: As for `loops`.
            n_segments: Of how many segments all are.
        """
        angles = self._turned(states, self.closing.flow.ends(states, times)[0]) if angles is None else angles
        counts = np.full(len(states), n_segments or 0)
        if n_segments is None:
            counts = self._counts(states, times, angles)
        found: dict[int, tuple[Loops, bool]] = {}
        for count in np.unique(counts).tolist():
            rows = np.nonzero(counts == count)[0]
            loops = self.closing.solved(self._chained(states[rows], times[rows], angles[rows], count))
            left = ~self.closed(loops) & np.isfinite(loops.residual)
            if left.any():  # once more, held across the flow where they came, not at a far guess
                loops = loops.replaced(left, self.closing.solved(loops.of(left)))
            each = zip(rows.tolist(), self.closed(loops).tolist(), strict=True)
            found |= {row: (loops.of(np.array([j])), is_orbit) for j, (row, is_orbit) in enumerate(each)}
        return [found[row] for row in range(len(states))]

    def _wanted(self, states: Array, times: Array) -> NDArray[np.intp]:
        """So many segments that neighbours grow by `GROWTH` in each, if they do so evenly; 1 for lost ones."""
        units = self.closing.level.units
        _, tangents = self.closing.flow.ends(states, times, np.eye(states.shape[1]))
        growth = np.abs(tangents * (units / units[:, None])).sum(axis=2).max(axis=1)
        growth = np.where(np.isfinite(growth), growth, 1.0)  # an orbit that does not reach the time has none between
        wanted = np.ceil(elementary.log(np.maximum(growth, 1.0)) / elementary.log(GROWTH))
        return np.clip(wanted, 1, MOST_SEGMENTS).astype(np.intp)

    def _counts(self, states: Array, times: Array, angles: Array) -> NDArray[np.intp]:
        """The least numbers of segments in each of which neighbours grow by no more than `GROWTH`.

        Neighbours that move apart and together again grow in each segment more than in all.  Up to twice as many
        segments are tried; where these do not help, the number with the least growth is taken.
        """
        first = self._wanted(states, times)
        tried, best, least = first.copy(), first.copy(), np.full(len(first), np.inf)
        left = np.arange(len(first))
        while left.size:
            for count in np.unique(tried[left]).tolist():
                rows = left[tried[left] == count]
                growth = self.closing.growth(self._chained(states[rows], times[rows], angles[rows], count))
                better = rows[growth < least[rows]]
                best[better], least[better] = count, growth[growth < least[rows]]
            left = left[~(least[left] <= GROWTH) & (tried[left] < 2 * first[left])]
            tried[left] += 1
        return best

    def _chained(self, states: Array, times: Array, angles: Array, n_segments: int) -> Loops:
        """Guesses of so many segments."""
        return guessed(self.closing.flow.paths(states, times, n_segments)[:, :-1], times, angles)

    def in_short_segments(self, loops: Loops) -> Loops:
        """A loop that was found among others, in segments of its own where neighbours grow too much in one of these."""
        if not self.closing.growth(loops)[0] > GROWTH:
            return loops
        alone = self.closing.solved(self.loops(loops.state[:, 0], loops.time, loops.angle))
        return alone if self.closed(alone)[0] else loops

    def _turned(self, states: Array, ends: Array) -> Array:
        """The angles, of one rotation after the other, by which states come nearest to ends, of 64 in a turn each."""
        angles = np.zeros((len(states), len(self.closing.rotations)))
        for k, rotation in enumerate(self.closing.rotations):
            tried = np.repeat(angles[:, None], _ANGLES, axis=1)
            tried[..., k] = 2 * np.pi / _rate(rotation) * (np.arange(_ANGLES) / _ANGLES - 0.5)
            turns = self.closing.turn(tried.reshape(-1, angles.shape[1])).reshape(*tried.shape[:2], *rotation.shape)
            gaps = (linear.einsum("naij,nj->nai", turns, states) - ends[:, None]) / self.closing.level.units
            nearest = np.argmin(linear.norm(gaps, axis=2), axis=1)
            angles[:, k] = tried[np.arange(len(states)), nearest, k]
        return angles

    def parts(self, angles: Array, n: int) -> Array:
        """The angles of which n times is the same rotation as angles that are given, shape (n**k, k)."""
        turns = np.array([2 * np.pi / rate for rate in map(_rate, self.closing.rotations)])
        whole = np.stack(np.meshgrid(*[np.arange(n)] * len(turns), indexing="ij"), axis=-1) if len(turns) else 0
        return (angles + turns * np.reshape(whole, (-1, len(turns)))) / n if len(turns) else angles[None]

    def gaps(self, starts: Array, states: Array) -> Array:
        """How far states are from starts that are turned towards them, in units of the level, shape (n, time).

        Args:
            starts: Shape (n, N).
            states: Shape (n, time, N).
        """
        return linear.norm(self.ways(starts, states), axis=2)

    def ways(self, starts: Array, states: Array) -> Array:
        """From states to starts that are turned towards them, in units of the level, shape (n, time, N).

        Args:
            starts: Shape (n, N).
            states: Shape (n, time, N).
        """
        x, y = np.broadcast_to(starts[:, None], states.shape), states / self.closing.level.units
        for rotation in self.closing.rotations:
            rate = _rate(rotation)
            across = linear.einsum("ij,ntj->nti", rotation / rate, x)
            along = -linear.einsum("ij,ntj->nti", rotation / rate, across)
            parts = [(one / self.closing.level.units * y).sum(axis=2) for one in (across, along)]
            angle = elementary.arctan2(*parts)[..., None]
            x = x - along + elementary.cos(angle) * along + elementary.sin(angle) * across
        return x / self.closing.level.units - y

    def closed(self, loops: Loops) -> NDArray[np.bool_]:
        """Which loops are orbits: they close, and are no equilibria, nor relative ones, that close after any time."""
        return (loops.residual <= CLOSES) & (self.closing.extent(loops) > SAME)

    def described(self, loops: Loops, row: int = 0) -> PeriodicOrbit:
        """A loop that was found, with its multipliers."""
        return self.descriptions(loops.of(np.array([row])))[0]

    def descriptions(self, loops: Loops, levels: Sequence[Level] | None = None) -> list[PeriodicOrbit]:
        """Loops that were found, with their multipliers.

        Args:
            levels: Of each its own, along a family, on which it is alone if no multiplier is 1; by default the one of
                the problem, on which the equations tell.
        """
        closing, level = self.closing, self.closing.level
        x, T, angle, turn = loops.state, loops.time, loops.angle, closing.turn(loops.angle)
        (n, m, N), first = x.shape, x[:, 0]
        after = np.concatenate([x[:, 1:], linear.matmul(turn, first[..., None])[:, None, :, 0]], axis=1)
        forth, back = (
            closing.flow.ends(states.reshape(-1, N), np.repeat(times / m, m), np.eye(N))[1].reshape(n, m, N, N)
            for states, times in ((x, T), (after, -T))
        )
        forwards, backwards = np.broadcast_to(np.eye(N), (2, n, N, N))
        for i in range(m):
            forwards, backwards = linear.matmul(forth[:, i], forwards), linear.matmul(backwards, back[:, i])
        units, undone = level.units, linear.inv(turn)
        turned = linear.matmul(closing.rotations, first[:, None, :, None])[..., 0]
        rates = np.concatenate([self.system.vector_field(first)[:, None], turned], axis=1)
        functions = {**level.functions, **{name: f for name, (f, _) in closing.held.items()}}
        gradients = np.stack([f.gradient(first) for f in functions.values()], axis=1)
        spectra = loop_spectra(
            linear.matmul(undone, forwards) * units / units[:, None],
            linear.matmul(backwards, turn) * units / units[:, None],
            gradients * units,
            rates / units,
        )
        if levels is None:
            levels = [level.through(one) if closing.holds_period else level for one in first]
            alone = loops.regularity > ISOLATED
        else:
            alone = [(np.abs(one.values - 1) > HYPERBOLIC).all() for one in spectra]
        return [
            PeriodicOrbit(
                levels[k], first[k].copy(), float(T[k]), self.symmetry, self.momenta, angle[k].copy(), m,
                float(loops.residual[k]), bool(alone[k]), one.values, one.pair_defect,
                one.trivial_defect,
            )
            for k, one in enumerate(spectra)
        ]  # fmt: skip

    @property
    def system(self) -> System:
        """The system."""
        return self.closing.level.system


def _rate(rotation: Array) -> float:
    """The angular velocity of a rotation by its angle."""
    return float(np.abs(linear.eigvals(rotation)).max(initial=0.0)) or 1.0


def problem_at(
    system: System,
    state: Array,
    *,
    leaf: Leaf | Mapping[str, float | str] | None = None,
    energy: float | str | None = None,
    holds_period: bool = False,
    momenta: Momenta = (),
    symmetry: DiscreteSymmetry | None = None,
    threads: int | None = None,
    along: Array | None = None,
) -> Problem:
    """The problem of a level, by default that of a state.

    Args:
        along: States whose sizes are the units, shape (n, N), such as those of the orbit of a guess.

    Raises:
        LeafError: the leaf is not regular, or no state has these values.
        ParameterError: a momentum is no linear integral, or the symmetry does not keep the level.
    """
    level = level_of(
        system,
        Leaf.through(system, state) if leaf is None else leaf,
        float(system.functions.energy(state)) if energy is None else energy,
    )
    if leaf is None and energy is None:
        level = level.through(state)
    if along is not None:
        level = level.in_units_of(along)
    if symmetry is not None:
        wanted = "one of discrete_symmetries(system)"
        check_kind(symmetry, DiscreteSymmetry, "symmetry", wanted, "leave it out if the orbit closes without one")
        if not are_equal(symmetry.system, system):
            raise ParameterError(f"symmetry: wanted {wanted}; got one of {symmetry.system.name!r}")
    if symmetry is not None and (symmetry.is_reverser or not symmetry.meets(level.values)):
        raise ParameterError(
            f"symmetry: wanted one of discrete_symmetries(system) that keeps time and {level.text}; got {symmetry.text}"
        )
    held = {name: (function, level.constant(name)) for name, function in level.functions.items()}
    names, rotations = _rotations(system, momenta, state)
    if holds_period:
        del held["H"]
    matrix = np.eye(len(state)) if symmetry is None else symmetry.matrix.astype(np.float64)
    momentum_values = {name: value for name, (_, value) in names.items()}
    closing = Closing(level, Flow(system, threads), held | names, matrix, rotations, holds_period)
    return Problem(closing, symmetry, momentum_values)


def with_parameter(problem: Problem, variable: FreeParameter) -> Problem:
    """The problem for the state with a parameter behind it, which is held like H and the Casimirs."""
    closing, space, number = problem.closing, StateAndParameters(variable.symbolic, variable.name), variable.value
    functions = {**space.functions(), **{name: space.function(name) for name in problem.momenta}}
    values = {name: value for name, (_, value) in closing.held.items()} | {"H": closing.level.number("H")}
    held = {name: (functions[name], values[name]) for name in closing.held}
    held[variable.name] = space.function(space.parameters[0]), number
    k, n = len(closing.rotations), len(closing.level.units) + 1
    rotations = np.zeros((k, n, n))
    rotations[:, :-1, :-1] = closing.rotations
    level: Any = SimpleNamespace(units=np.append(closing.level.units, abs(number) or 1.0), system=space)
    flow = Flow(cast("Any", space), closing.flow.threads)
    return replace(problem, closing=Closing(level, flow, held, np.eye(n), rotations))


def _rotations(system: System, momenta: Momenta, state: Array) -> tuple[dict[str, tuple[PhaseFunction, float]], Array]:
    """The momenta with their values, and the matrices that generate their flows, shape (k, N, N).

    Raises:
        ParameterError: one of them is not conserved, or its flow is not linear.
    """
    values = named(momenta, "momenta")
    given: Sequence[Any] = tuple(values) if values is not None else sequence(momenta, "momenta", "integrals", '["l3"]')
    n = len(state)
    if not given:
        return {}, np.zeros((0, n, n))
    functions = [system.functions.of(one) for one in given]
    found: dict[str, tuple[PhaseFunction, float]] = {}
    fields = HamiltonianFields(system, functions)
    at_zero, at_state = fields.derivatives(np.zeros(n)), fields.derivatives(state)
    sizes = np.abs(at_state).max(axis=(0, 1))
    for k, (one, function) in enumerate(zip(given, functions, strict=True)):
        name = one if isinstance(one, str) else str(function.expression)
        if all(system.bracket(function.expression, x) == 0 for x in system.bracket.variables):
            raise ParameterError(
                f"momenta: wanted integrals that move states; {name} is a Casimir, which moves nothing"
            )
        if np.any(at_zero[..., k] != at_state[..., k]) or fields.fields(np.zeros(n))[..., k].any():
            raise ParameterError(
                f"momenta: wanted integrals whose flows are linear, such as 'l3'; that of {name} is not"
            )
        if not system.is_constant(function.expression):
            raise ParameterError(f"momenta: wanted integrals; {name} is not constant along orbits of {system.name!r}")
        rows = (at_state[..., : k + 1] / sizes[: k + 1]).reshape(-1, k + 1)
        if name in found or linear.svd(rows, compute_uv=False)[-1] < _DEPENDENT:
            raise ParameterError(f"momenta: wanted each once; {name} is one of the others, or a combination of them")
        value = function(state) if values is None else as_number(values[one], f"momenta: {name}", "a finite number")
        if not np.isfinite(value):
            raise ParameterError(f"momenta: {name}: wanted a finite number; got {value}")
        found[name] = function, float(value)
    return found, np.moveaxis(at_state, 2, 0).copy()
