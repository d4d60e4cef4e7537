r"""The map of first return as an object: images, derivatives, the area that it keeps, its cycles and exponents.

On the states with $s(x) = 0$ that orbits pass in one direction, with the time $\tau$ of the return,

$$ P(x) = \varphi_{\tau(x)}(x), \qquad DP = \Bigl(1 - \frac{f\,\nabla s^T}{\nabla s\cdot f}\Bigr)D\varphi_\tau , $$

with f and $\nabla s$ at P(x).  On a level of H and the Casimirs P keeps the symplectic form, whose Poisson bracket is
Dirac's for the constraints s and H:

$$ \{x, y\}_s = \{x, y\} - \frac{\{x, s\}\{H, y\} - \{x, H\}\{s, y\}}{\{H, s\}} . $$

So in coordinates $x_i$ of the section P keeps the measure $|\det\{x_i, x_j\}_s|^{-1/2}\,\prod dx_i$.

References: [dirac1950].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OrbitError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_threads, as_time_limit
from liepoisson.indicators.mean_error import mean_error
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import Deadline, checkpoint, has_passed
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import counted
from liepoisson.io.tables import vector_columns
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice, as_method
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.orbits.closed_orbits import CLOSES, PeriodicOrbit, problem_at
from liepoisson.orbits.guesses import shortest
from liepoisson.orbits.level import level_of
from liepoisson.orbits.multipliers import loop_spectrum, orbit_columns
from liepoisson.orbits.saved_orbits import SavedOrbits, SearchedOrbits
from liepoisson.orbits.shooting import Flow
from liepoisson.poincare.equal_steps import check_method, takes_equal_steps, tangents_in_equal_steps
from liepoisson.poincare.first_return import FirstReturn, first_return
from liepoisson.poincare.section import Section, section
from liepoisson.poincare.section_arguments import as_direction, as_end, as_formula, check_that_it_varies
from liepoisson.poincare.surfaces import section_starts
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

_SAME = 1e-7
"""Distance, in units of the level, within which two points of a cycle are one."""
_INDEPENDENT = 1e-7
"""Smallest singular value of gradients on the section, relative to the largest, of what are coordinates there: with
less than that the derivative has no more than half of its digits."""
_TOGETHER = 32
_MOST_STEPS = 20
"""Of Newton's method: from a cycle of the flow it needs as many as the error of the method has digits."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class ReturnMap:
    r"""The map of first return to a side of a surface.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> back = lp.sections.return_map(henon, "x", t_end=100)
        >>> state = [0, 0.1, 0.3, 0.05]
        >>> image = back(state).state
        >>> area = back.density([state, image], ["y", "p_y"])  # dy dp_y is kept
        >>> matrix = back.derivative(state, ["y", "p_y"])
        >>> area.tolist(), round(float(np.linalg.det(matrix)), 9)
        ([1.0, 1.0], 1.0)

    Attributes:
        system: The system.
        surface: The function $s$ that is zero on the section.
        direction: +1 where it increases in the order of travel, -1 where it decreases.
        t_end: The longest time that is waited for a return; negative for the inverse map.
        method: `Taylor()`, perhaps with another tolerance, or a method of equal steps.
        threads: On how many threads; None for all.
    """

    system: System
    surface: PhaseFunction
    direction: int
    t_end: float
    method: Method
    threads: int | None = None

    def __call__(self, states: StartsLike, *, time_limit: float = TIME_LIMIT) -> FirstReturn:
        """Images with their times and outcomes; see `lp.sections.first_return`.

        Args:
            states: States on the section, shape (..., component).
        """
        return first_return(self.system, states, **self._options, time_limit=time_limit)

    @property
    def _options(self) -> dict[str, Any]:
        own = {"t_end": self.t_end, "direction": self.direction, "method": self.method, "threads": self.threads}
        return own | {"surface": self.surface.expression}

    def orbit(self, states: StartsLike, n_returns: int, *, time_limit: float = TIME_LIMIT) -> Section:
        """The next returns of states, as a section.

        Args:
            states: States, shape (component,) or (trajectory, component).
            n_returns: How many returns of each.
        """
        n = as_count(n_returns, "n_returns", least=1)
        options: dict[str, Any] = self._options | {
            "t_end": n * self.t_end,
            "n_crossings": n,
            "start_side": self.direction,
        }
        return section(self.system, states, **options, time_limit=time_limit)

    @np.errstate(all="ignore")
    def derivative(self, states: StartsLike, coordinates: Sequence[str | PhaseFunction] | None = None) -> Array:
        r"""$DP$ at states; NaN where they do not return, or where the functions given are no coordinates.

        Args:
            states: States on the section, shape (component,) or (n, component).
            coordinates: As many functions as the section of the level has dimensions, rank J - 2.

        Returns:
            Without coordinates the derivative by the state, which takes all tangent vectors to the section, shape
            (..., N, N); else the matrix of $\partial x_i(P)/\partial x_j$ along the level, shape (..., k, k).

        Raises:
            ParameterError: the number of coordinates is another.
            TimeLimitError: the deadline of the call has passed.
        """
        given = given_starts(self.system, states)
        x = np.atleast_2d(given)
        once = self(x)
        image, matrix = once.state, self._matrix(x, once)
        if coordinates is None:
            return matrix.reshape(*given.shape[:-1], *matrix.shape[-2:])
        functions = self._coordinates(coordinates)
        tangents = self._tangents(x, len(functions))
        here, there = (np.stack([f.gradient(at) for f in functions], axis=1) for at in (x, image))
        moved, local = linear.matmul(linear.matmul(there, matrix), tangents), linear.matmul(here, tangents)
        sizes = linear.svd(local, compute_uv=False)
        local[~(sizes[:, -1] > _INDEPENDENT * sizes[:, 0])] = np.nan
        local = linear.matmul(moved, linear.inv(local))
        return local.reshape(*given.shape[:-1], *local.shape[-2:])

    def density(self, states: StartsLike, coordinates: Sequence[str | PhaseFunction]) -> Array:
        r"""The density of the measure that P keeps, $|\det\{x_i, x_j\}_s|^{-1/2}$ in coordinates $x_i$, shape (...).

        For two coordinates it is that of the symplectic area, $1/|\{x, y\}_s|$; for a coordinate and its momentum 1.
        $|\det\partial x(P)/\partial x|$ is the density at x over that at P(x).

        Args:
            states: States on the section, shape (component,) or (n, component).
            coordinates: As many functions as the section of the level has dimensions.

        Raises:
            ParameterError: the number of coordinates is another.
        """
        given = given_starts(self.system, states)
        x, functions = np.atleast_2d(given), self._coordinates(coordinates)
        tensor = self.system.functions.poisson_tensor(x)
        wanted = (*functions, self.surface, self.system.functions.energy)
        slopes = np.stack([f.gradient(x) for f in wanted], axis=1)
        brackets = linear.matmul(linear.matmul(slopes, tensor), np.swapaxes(slopes, 1, 2))
        k = len(functions)
        own, to_s, to_h = brackets[:, :k, :k], brackets[:, :k, k], brackets[:, :k, k + 1]
        rate = brackets[:, k + 1, k][:, None, None]  # {H, s}
        crossed = to_s[:, :, None] * to_h[:, None, :] - to_h[:, :, None] * to_s[:, None, :]
        return (1 / np.sqrt(np.abs(linear.det(own + crossed / rate)))).reshape(given.shape[:-1])

    def exponents(self, states: StartsLike, n_returns: int, *, time_limit: float = TIME_LIMIT) -> MapExponents:
        """The Lyapunov exponents of the map on the level, for one return, the largest first.

        Args:
            states: States on the section, shape (component,) or (trajectory, component).
            n_returns: Over how many returns.

        Raises:
            OrbitError: a state does not return so often.
            TimeLimitError: the time limit has passed.
        """
        n, start = as_count(n_returns, "n_returns", least=1), np.atleast_2d(given_starts(self.system, states))
        x = start
        frame = self._tangents(x, self._dimension)
        growth, time = np.empty((len(x), n, frame.shape[2])), np.zeros(len(x))
        with Deadline(as_time_limit(time_limit)).running():
            for j in range(n):
                checkpoint("the exponents of a map")
                once = self(x)
                if not (once.outcome == "returned").all():
                    k = int(np.argmax(once.outcome != "returned"))
                    raise OrbitError(f"states: wanted {n} returns; state {k} has {j}: {once.outcome[k]}")
                frame, triangle = linear.qr(linear.matmul(self._matrix(x, once), frame))
                growth[:, j] = elementary.log(np.abs(np.diagonal(triangle, axis1=1, axis2=2)))
                x, time = once.state, time + once.time
        return MapExponents(self, start, n, growth.mean(axis=1), mean_error(growth), time / n)

    def cycles(
        self,
        leaf: Leaf | Mapping[str, float | str],
        energy: float | str,
        *,
        n_points: int = 1,
        n_starts: int = 100,
        seed: int = 0,
        time_limit: float = TIME_LIMIT,
    ) -> Cycles:
        """Cycles of n points of a level, fixed points for n = 1, by Newton's method from the nearest returns.

        Args:
            leaf: A regular leaf, or the values of the Casimirs by name.
            energy: The value of the Hamiltonian.
            n_points: n, the number of points.
            n_starts: How many random states of the section are followed, with `Taylor()`; cycles of another method are
                those near what is found so, by Newton's method in the derivative of its own map.
            seed: Draws them.

        Returns:
            The cycles, the largest multiplier first; that there are no others is not proved.

        Raises:
            LeafError: the leaf is not regular, or no orbit of this energy crosses the surface.
        """
        n, count = as_count(n_points, "n_points", least=1), as_count(n_starts, "n_starts", least=1)
        if takes_equal_steps(self.method):
            limit = Deadline(as_time_limit(time_limit))
            exact = replace(self, method=Taylor()).cycles(
                leaf, energy, n_points=n, n_starts=count, seed=seed, time_limit=time_limit
            )
            with limit.running():
                return self._own(exact)
        level, found = level_of(self.system, leaf, energy), list[PeriodicOrbit]()
        states: list[Array] = []
        with Deadline(as_time_limit(time_limit)).running():
            starts = section_starts(
                level.leaf, self.surface.expression, energy=level.number("H"), n_starts=count, seed=seed,
                direction=self.direction,
            )  # fmt: skip
            starts, times = self._nearest(starts, n, level.units)
            problem = problem_at(self.system, starts[0], leaf=leaf, energy=energy, threads=self.threads, along=starts)
            try:
                for k in range(0, len(starts), _TOGETHER):
                    some = slice(k, k + _TOGETHER)
                    loops = problem.closing.solved(problem.loops(starts[some], times[some]))
                    for j in np.nonzero(problem.closed(loops))[0]:
                        loop = shortest(problem, loops.of(np.array([j])))
                        one = problem.described(problem.in_short_segments(loop))
                        points = self._points(one, n)
                        if points is not None and not any(_share(points, other, level.units) for other in states):
                            found.append(one)
                            states.append(points)
            except TimeLimitError:
                pass
            cut = has_passed()
        order = sorted(range(len(found)), key=lambda k: (-round(found[k].rate * found[k].period, 9), found[k].period))
        return Cycles(self, tuple(found[k] for k in order), tuple(states[k] for k in order), n, count, level.text, cut)

    @property
    def _dimension(self) -> int:
        """That of the section of a level, rank J - 2."""
        return len(self.system.component_names) - len(self.system.functions.casimirs) - 2

    def _coordinates(self, given: Any) -> list[PhaseFunction]:
        chosen = sequence(given, "coordinates", "functions", '["q2", "p2"]')
        if len(chosen) != self._dimension:
            raise ParameterError(
                f"coordinates: wanted {self._dimension}, as the section of a level has dimensions; got {len(chosen)}"
            )
        return [self.system.functions.of(one) for one in chosen]

    def _tangents(self, x: Array, k: int) -> Array:
        """Orthonormal tangent vectors of the sections of the levels through states, as columns, shape (n, N, k)."""
        functions = self.system.functions
        held = (functions.energy, *functions.casimirs.values(), self.surface)
        rows = np.stack([f.gradient(x) for f in held], axis=1)
        rows = rows / np.maximum(linear.norm(rows, axis=2, keepdims=True), np.finfo(float).tiny)
        return linear.complement(linear.qr(np.swapaxes(rows, 1, 2)).Q)[..., :k]

    def _matrix(self, x: Array, once: FirstReturn) -> Array:
        """The derivatives of P at states by the whole state, shape (n, N, N)."""
        n, N = x.shape
        matrix, known = np.full((n, N, N), np.nan), once.outcome == "returned"
        if known.any():
            image = once.state[known]
            matrix[known] = self._on_surface(image, *self._flow_derivative(x[known], once.time[known], image))
        return matrix

    def _on_surface(self, image: Array, moved: Array, rate: Array) -> Array:
        """The derivatives of P from those of the flow by the state and by the time."""
        slope = self.surface.gradient(image)
        along = linear.einsum("ni,nij->nj", slope, moved) / linear.einsum("ni,ni->n", slope, rate)[:, None]
        return moved - rate[:, :, None] * along[:, None, :]

    def _flow_derivative(self, x: Array, times: Array, image: Array) -> tuple[Array, Array]:
        """The derivatives of the flow by the state, shape (n, N, N), and by the time, shape (n, N), at each time."""
        if takes_equal_steps(self.method):
            each = [
                tangents_in_equal_steps(self.system, y, float(T), self.method) for y, T in zip(x, times, strict=True)
            ]
            return np.stack([one[0] for one in each]), np.stack([one[1] for one in each])
        _, moved = Flow(self.system, self.threads, self.method).ends(x, times, np.eye(x.shape[1]))
        return moved, self.system.vector_field(image)

    def _own(self, exact: Cycles) -> Cycles:
        """The cycles of this map near those of the flow, by Newton's method in its own derivative.

        The map of a method that does not keep H has a cycle on a level but for what leads off the level: of
        $P^n(x) - x$ the part along the section of the level is zero, and `residual` has the rest.
        """
        found = list[tuple[PeriodicOrbit, Array]]()
        for one in exact.found:
            try:
                own = self._own_cycle(one, exact.n_points)
            except TimeLimitError:
                return self._listed(found, exact, is_cut_short=True)
            if own is not None and not any(_share(own[1], points, one.level.units) for _, points in found):
                found.append(own)
        return self._listed(found, exact, is_cut_short=exact.is_cut_short)

    def _listed(self, found: Sequence[tuple[PeriodicOrbit, Array]], exact: Cycles, *, is_cut_short: bool) -> Cycles:
        orbits, points = tuple(one for one, _ in found), tuple(points for _, points in found)
        return replace(exact, back=self, found=orbits, points=points, is_cut_short=is_cut_short)

    def _own_cycle(self, exact: PeriodicOrbit, n: int) -> tuple[PeriodicOrbit, Array] | None:
        """The cycle near an orbit of the flow, with its points; None where Newton's method does not converge."""
        level, x = exact.level, self._on_section(exact.start)
        if x is None:
            return None
        for _ in range(_MOST_STEPS):
            checkpoint("cycles of a map")
            points, times, matrix, _ = self._around(x, n)
            if not np.isfinite(points).all():
                return None
            tangents = self._tangents(x[None], self._dimension)[0]
            gap, off = points[-1] - x, np.append(level.deviations(x), self.surface(x))
            along = linear.matmul(tangents.T, gap)
            rows = np.vstack([level.gradients(x), self.surface.gradient(x)])
            is_on_it = level.distance(x) <= CLOSES  # and on the surface, which the same step leads to
            if is_on_it and np.abs(linear.matmul(tangents, along) / level.units).max() <= CLOSES:
                return self._described(exact, x, points, times), points[:-1].copy()
            slopes = np.vstack([linear.matmul(tangents.T, matrix - np.eye(len(x))), rows])
            x = x - linear.matmul(linear.pinv(slopes), np.concatenate([along, off]))
        return None

    def _on_section(self, start: Array) -> Array | None:
        """The first point of an orbit on the section."""
        once = self(start)
        return once.state if once.outcome == "returned" else None

    def _around(self, x: Array, n: int) -> tuple[Array, Array, Array, Array]:
        """The next n returns with the state itself, (n + 1, N), their times, and the derivatives of map and flow."""
        points, times = [x], list[float]()
        matrix = flow = np.eye(len(x))
        for _ in range(n):
            once = self(points[-1][None])
            if once.outcome[0] != "returned":
                points.append(once.state[0])
                break
            moved, rate = self._flow_derivative(points[-1][None], once.time, once.state)
            flow = linear.matmul(moved[0], flow)
            matrix = linear.matmul(self._on_surface(once.state, moved, rate)[0], matrix)
            points.append(once.state[0])
            times.append(float(once.time[0]))
        return np.array(points), np.array(times), matrix, flow

    def _described(self, exact: PeriodicOrbit, x: Array, points: Array, times: Array) -> PeriodicOrbit:
        """The orbit of a cycle, with its multipliers."""
        level, units = exact.level, exact.level.units
        inverse = replace(self, t_end=-self.t_end, direction=-self.direction)
        forth, back = (one._around(x, len(times))[3] * units / units[:, None] for one in (self, inverse))
        spectrum = loop_spectrum(forth, back, level.gradients(x) * units, self.system.vector_field(x) / units)
        residual = float(np.abs((points[-1] - x) / units).max())
        return replace(
            exact, start=x, time=float(times.sum()), n_segments=1, residual=residual, multipliers=spectrum.values,
            pair_defect=spectrum.pair_defect, trivial_defect=spectrum.trivial_defect,
        )  # fmt: skip

    def _nearest(self, starts: Array, n: int, units: Array) -> tuple[Array, Array]:
        """Starts in the order in which they come nearest to themselves after n returns, and the times of these."""
        run = self.orbit(starts, n)
        last = np.cumsum(run.count)[run.count == n] - 1
        starts, gaps = starts[run.count == n], linear.norm((run.state[last] - starts[run.count == n]) / units, axis=1)
        order = np.argsort(gaps, kind="stable")
        if not len(order):
            raise OrbitError(f"states of the section must return {n} times; none does before t = {n * self.t_end:g}")
        return starts[order], run.time[last][order]

    def _points(self, one: PeriodicOrbit, n: int) -> Array | None:
        """The n points in which an orbit meets the section, shape (n, N); None if it is another number."""
        run = self.orbit(one.start, n + 1)
        if len(run.time) <= n or abs(run.time[n] - run.time[0] - one.period) > _SAME * one.period:
            return None
        return run.state[:n].copy()  # its least period is that of n returns, so they are n points


def _share(points: Array, others: Array, units: Array) -> bool:
    """Whether two cycles have a point in common."""
    return bool((np.abs((others - points[0]) / units).max(axis=1) < _SAME).any())


@dataclass(frozen=True, eq=False, repr=False)
class MapExponents(SavedOrbits):
    """Lyapunov exponents of a map of first return.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> found = lp.sections.return_map(henon, "x", t_end=100).exponents([0, 0.1, 0.49, 0.05], 64)
        >>> found.exponent.shape, bool((abs(found.exponent.sum(axis=1)) < 0.05).all())  # the map keeps areas
        ((1, 2), True)

    Attributes:
        back: The map.
        start: Where the orbits began, shape (trajectory, component).
        n_returns: How many returns of each were followed.
        exponent: The mean growth in one return, the largest first, shape (trajectory, k).
        error: Its standard error as an average along one orbit, shape (trajectory, k); NaN for less than 4 returns.
        time: The mean time of a return, shape (trajectory,): exponent / time is that of the flow.
    """

    kind = "map exponents"
    made_by = "lp.sections.return_map"
    row = "trajectory"

    back: ReturnMap
    start: Array
    n_returns: int
    exponent: Array
    error: Array
    time: Array

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.back.system

    @property
    def method(self) -> Method:
        """How the map follows orbits."""
        return self.back.method

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its start, its exponents with their errors, and the mean time."""
        return {
            **vector_columns("start", self.start, self.system.component_names),
            **vector_columns("exponent", self.exponent),
            **vector_columns("error", self.error),
            "time": self.time,
        }

    def __repr__(self) -> str:
        largest = ", ".join(
            f"{x:.5g} ± {dx:.1g}" for x, dx in zip(self.exponent[:3, 0], self.error[:3, 0], strict=True)
        )
        return (
            f"<MapExponents of {self.system.name!r}: {counted(len(self.time), 'orbit')}, {self.n_returns} returns of "
            f"{self.back.surface.expression} = 0; the largest {largest}{', ...' * (len(self.time) > 3)}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Cycles(SearchedOrbits[PeriodicOrbit]):
    """Cycles of a map of first return, as periodic orbits.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> fixed = lp.sections.return_map(henon, "x", t_end=100).cycles({}, "1/12", n_starts=40)
        >>> len(fixed), fixed.points[0].shape
        (7, (1, 4))

    Attributes:
        back: The map.
        found: The orbits, the largest multiplier first.
        points: Of each the points on the section, in the order of travel, shape (n_points, component).
        n_points: How many.
        n_starts: How many random states were followed.
        level: The values of H and the Casimirs, in words.
        is_cut_short: Whether the time limit ended the search.
    """

    kind = "cycles"
    made_by = "lp.sections.return_map"
    titles = ("period", "stability", "multipliers", "residual")

    back: ReturnMap
    found: tuple[PeriodicOrbit, ...]
    points: tuple[Array, ...]
    n_points: int
    n_starts: int
    level: str
    is_cut_short: bool = False

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.back.system

    @property
    def method(self) -> Method:
        """How the map follows orbits."""
        return self.back.method

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each cycle its period, stability, first point and multipliers."""
        first = [points[0] for points in self.points]
        return vector_columns("point", first, self.system.component_names) | orbit_columns(self.found, self.system)

    def _head(self) -> str:
        noun, where = ("fixed point", "") if self.n_points == 1 else ("cycle", f"of {self.n_points} points ")
        return self._sentence(noun, f"{where}on {self.level}", "{} states of the section")

    def _row(self, one: PeriodicOrbit, /) -> tuple[str, ...]:
        return f"{one.period:.8f}", one.stability, one.multiplier_words, f"{one.residual:.0e}"


@explains_its_arguments
def return_map(
    system: System,
    surface: str | PhaseFunction,
    *,
    t_end: float,
    direction: int = 1,
    method: MethodChoice | None = None,
    threads: int | None = None,
) -> ReturnMap:
    r"""The map of first return to the side of a surface, $P(x) = \varphi_{\tau(x)}(x)$, as an object.

    It is applied to states, `P(states)`; it has a derivative, a density of the measure that it keeps, exponents, and
    cycles.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> P = lp.sections.return_map(henon, "x", t_end=100)
        >>> P([0, 0.1, 0.3, 0.05]).outcome.tolist(), P.cycles({}, "1/12", n_starts=40)[0].stability
        ('returned', 'hyperbolic')

    Args:
        system: A system whose parameters are all numbers.
        surface: The function $s$, as for `lp.section`.
        t_end: The longest time that is waited for a return.
        direction: +1 where $s$ increases in the order of travel, -1 where it decreases.
        method: `Taylor()`; or a method of equal steps, as for `lp.section`: then the map is made of whole steps and a
            shorter one that ends on the surface, and the derivative is that of this map.

    Raises:
        ParameterError: the surface is constant along every orbit, the direction is none of these, or the method has
            neither power series nor equal steps.
    """
    system = as_system(system)
    formula = as_formula(surface, "surface")
    check_that_it_varies(system, formula)
    if as_direction(direction) == 0:
        raise ParameterError("direction: wanted +1 or -1, one side of the surface; got 0")
    count, chosen = None if threads is None else as_threads(threads), as_method(method, Taylor(), in_series=True)
    check_method(chosen)
    return ReturnMap(system, system.functions.of(formula), int(direction), as_end(t_end), chosen, count)
