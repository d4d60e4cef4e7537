r"""Periodic orbits, and midpoints of homoclinic ones, to any number of digits: Newton's method in Arb.

A homoclinic orbit begins at an amplitude a on the linear unstable space so small that $|a|^3$ is below the tolerance
(see `liepoisson.orbits.homoclinic_orbits`), some loops before it did in doubles, and Newton's method in amplitude and
time puts its end into the fixed set.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from math import ceil, log
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.orbits.precise_flow import (
    Ball,
    Matrix,
    Polynomials,
    PreciseFlow,
    as_ball,
    bits,
    column,
    midpoints,
    solved,
)
from liepoisson.orbits.saved_orbits import SavedOrbits
from liepoisson.orbits.shooting import fixed_basis, mirror_basis
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.closed_orbits import PeriodicOrbit
    from liepoisson.orbits.homoclinic_orbits import HomoclinicOrbit
    from liepoisson.orbits.level import Level
    from liepoisson.orbits.multipliers import SymmetricOrbit

MOST_DIGITS = 1000
_MOST_STEPS = 12


class Precise(SavedOrbits):
    """Decimal texts of an orbit, which liepoisson reads as exact numbers."""

    orbit: Any

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.orbit.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table, which has one row: states by component, time, digits and residual."""
        columns: dict[str, NDArray[Any]] = {}
        for one in fields(self):  # pyright: ignore[reportArgumentType]  # dataclasses
            value = getattr(self, one.name)
            if isinstance(value, tuple):
                names = self.system.component_names
                columns |= {f"{one.name}_{name}": np.array([x]) for name, x in zip(names, value, strict=True)}
            elif one.name != "orbit":
                columns[one.name] = np.array([value])
        return columns


@dataclass(frozen=True)
class PreciseSegment(Precise):
    """A segment of a symmetric orbit, as decimal texts, which liepoisson reads as exact numbers.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> orbit = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)[0]
        >>> precise = orbit.polished(digits=30)
        >>> precise.digits, round(float(precise.time), 10) == round(orbit.time, 10)
        (30, True)

    Attributes:
        orbit: The orbit in doubles.
        start: The components of the state in the fixed set of the first reverser.
        end: Those of the state in the fixed set of the last.
        time: The time between them.
        digits: How many digits of them are right.
        residual: How far the last step of Newton's method moved, relative to the state.
    """

    kind = "precise segment"
    made_by = "orbit.polished"

    orbit: SymmetricOrbit = field(repr=False)
    start: tuple[str, ...]
    end: tuple[str, ...]
    time: str
    digits: int
    residual: float


@dataclass(frozen=True)
class PreciseOrbit(Precise):
    """A periodic orbit as decimal texts, which liepoisson reads as exact numbers.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> precise = lp.orbits.periodic_orbit(system, [0, 0, 0, 0.2], period=6.3).polished(digits=30)
        >>> precise.digits, precise.start[0], round(float(precise.time), 9)
        (30, '0', 6.395230041)

    Attributes:
        orbit: The orbit in doubles.
        start: The components of a state of it.
        time: The time after which it closes, up to the symmetry of the orbit.
        digits: How many digits of them are right, on the level with the exact values of `orbit.level`.
        residual: How far the last step of Newton's method moved, relative to the state.
    """

    kind = "precise orbit"
    made_by = "orbit.polished"

    orbit: PeriodicOrbit = field(repr=False)
    start: tuple[str, ...]
    time: str
    digits: int
    residual: float


def polished_orbit(orbit: PeriodicOrbit, digits: int) -> PreciseOrbit:
    r"""A periodic orbit to so many digits, by least squares of $\varphi_T(x) = Px$ on its level, across the flow.

    Raises:
        ParameterError: the equations are no polynomials, or the orbit closes up to rotations only.
        OrbitError: Newton's method does not converge.
    """
    from flint import ctx

    digits = as_count(digits, "digits", least=10, most=MOST_DIGITS)
    if orbit.momenta:
        raise ParameterError("polished: wanted an orbit that closes without rotations; this one holds momenta")
    growth = float(np.abs(orbit.multipliers).max(initial=1.0))
    working = digits + ceil(2 * log(growth, 10)) + 4  # the normal equations square it
    n, system = len(orbit.start), orbit.system
    with ctx.workprec(bits(working)):
        flow, functions = PreciseFlow(system, working), level_functions(orbit.level)
        wanted = [as_ball(value) for value in orbit.level.constants.values()]
        identity = exact_columns(np.eye(n))
        closing = identity if orbit.symmetry is None else exact_columns(orbit.symmetry.matrix.astype(np.float64))
        x, time = [as_ball(float(v)) for v in orbit.start], as_ball(float(orbit.time))
        across, moved = column(flow.rate(x)).transpose(), 1.0
        for _ in range(_MOST_STEPS):
            end, tangents = flow.end(x, time, identity)
            gap = (column(end) - closing * column(x)).entries()
            rest = [value - c for value, c in zip(functions.values(x), wanted, strict=True)]
            slopes = stacked(
                beside(tangents - closing, column(flow.rate(end))),
                beside(stacked(functions.derivatives(x), across), zeros(len(rest) + 1, 1)),
            )
            step = solved(slopes, column([-value for value in [*gap, *rest, as_ball(0.0)]])).entries()
            x = [(a + b).mid() for a, b in zip(x, step, strict=False)]
            time = (time + step[-1]).mid()
            moved = max(float(abs(value)) for value in step)
            if moved * moved * growth < 10.0 ** -(digits + 2):
                start = tuple(text_of(value, digits) for value in x)
                return PreciseOrbit(orbit, start, text_of(time, digits), digits, moved)
    raise OrbitError(
        f"an orbit must close; Newton's method in {digits} digits still moves by {moved:.1e} after {_MOST_STEPS} steps"
    )


def text_of(value: Ball, digits: int) -> str:
    """A number with so many significant digits, plain where that is short."""
    return "0" if value == 0 else value.mid().str(digits, radius=False)


def refined_segment(orbit: SymmetricOrbit, digits: int) -> PreciseSegment:
    """The segment of an orbit to so many digits.

    Raises:
        ParameterError: the equations are no polynomials.
        OrbitError: Newton's method does not converge.
    """
    from flint import ctx

    digits = as_count(digits, "digits", least=10, most=MOST_DIGITS)
    with ctx.workprec(bits(digits)):
        x, end, T, moved = solved_segment(orbit, digits)
        return PreciseSegment(
            orbit,
            tuple(text_of(value, digits) for value in x),
            tuple(text_of(value, digits) for value in end),
            text_of(T, digits),
            digits,
            moved,
        )


def solved_segment(orbit: SymmetricOrbit, digits: int) -> tuple[list[Ball], list[Ball], Ball, float]:
    """Start, end and time of a segment, and how far the last step moved; inside of the working precision."""
    system, level = orbit.system, orbit.level
    flow, functions = PreciseFlow(system, digits), level_functions(level)
    basis, mirror = exact_matrix(fixed_basis(orbit.first)), exact_matrix(mirror_basis(orbit.last))
    x, time = [as_ball(float(v)) for v in orbit.start], as_ball(float(orbit.time))
    wanted = [as_ball(value) for value in level.constants.values()]
    moved = 1.0
    for _ in range(_MOST_STEPS):
        end, tangents = flow.end(x, time, basis)
        rate = column(flow.rate(end))
        rest = [value - c for value, c in zip(functions.values(x), wanted, strict=True)]
        at_end = (mirror.transpose() * column(end)).entries()
        slopes = stacked(
            beside(functions.derivatives(x) * basis, zeros(len(rest), 1)),
            beside(mirror.transpose() * tangents, mirror.transpose() * rate),
        )
        step = solved(slopes, column([-value for value in [*rest, *at_end]])).entries()
        change = (basis * column(step[:-1])).entries()
        x = [(a + b).mid() for a, b in zip(x, change, strict=True)]
        time = (time + step[-1]).mid()
        moved = max(float(abs(value)) for value in [*change, step[-1]])
        if moved < 10.0 ** (-0.5 * digits - 1) and moved * moved < 10.0 ** -(digits + 2):
            return x, in_fixed_set(orbit.last, flow.end(x, time)[0]), time, moved
    raise OrbitError(
        f"the orbit must close; Newton's method in {digits} digits still moves by {moved:.1e} after {_MOST_STEPS} steps"
    )


def in_fixed_set(symmetry: DiscreteSymmetry, x: Sequence[Ball]) -> list[Ball]:
    """The state without what is off the fixed set, (x + S x) / 2."""
    images = [s * x[p] for p, s in zip(symmetry.permutation, symmetry.signs, strict=True)]
    return [((a + b) / 2).mid() for a, b in zip(x, images, strict=True)]


def level_functions(level: Level) -> Polynomials:
    """H and the Casimirs of a level in Arb's arithmetic."""
    expressions: list[Any] = [f.expression for f in level.functions.values()]
    return Polynomials.of(expressions, level.system.variables, "H and the Casimirs")


def exact_matrix(values: Array) -> Matrix:
    """Columns with one direction as doubles: those of a signed permutation have entries 0, 1 or equal ones.

    They need not be normalised: each column is divided by its largest entry, which makes it exact.
    """
    from flint import arb_mat

    columns = [[round(float(v) / float(max(c, key=abs)), 12) for v in c] for c in values.T]
    rows = [[as_ball(columns[j][i]) for j in range(len(columns))] for i in range(len(values))]
    return arb_mat(len(values), len(columns), [v for row in rows for v in row])


def zeros(rows: int, columns: int) -> Matrix:
    """A matrix of zeros."""
    from flint import arb_mat

    return arb_mat(rows, columns, [as_ball(0.0)] * (rows * columns))


def beside(left: Matrix, right: Matrix) -> Matrix:
    """Two matrices side by side."""
    from flint import arb_mat

    rows: Sequence[Any] = [[*a, *b] for a, b in zip(left.tolist(), right.tolist(), strict=True)]
    return arb_mat(len(rows), left.ncols() + right.ncols(), [v for row in rows for v in row])


def stacked(upper: Matrix, lower: Matrix) -> Matrix:
    """Two matrices, one above the other."""
    from flint import arb_mat

    return arb_mat(upper.nrows() + lower.nrows(), upper.ncols(), [*upper.entries(), *lower.entries()])


_MOST_CORRECTIONS = 15
_TO_LEVEL = 12


@dataclass(frozen=True)
class PreciseMidpoint(Precise):
    """The midpoint of a homoclinic orbit as decimal texts, which liepoisson reads as exact numbers.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> orbit = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/8", n_starts=20)[0]
        >>> found = lp.orbits.symmetric_homoclinic_orbits(orbit, n_starts=10)[0]
        >>> precise = found.polished(digits=16)
        >>> precise.digits, bool(np.allclose([float(text) for text in precise.midpoint], found.midpoint))
        (16, True)

    Attributes:
        orbit: The orbit in doubles.
        midpoint: The components of the state in the fixed set of the reverser.
        digits: How many digits of them are right.
        amplitude: The amplitude at which the orbit began.
        time: The time from there to the midpoint.
        residual: How far the last step of Newton's method moved, relative to amplitude and time.
    """

    kind = "precise midpoint"
    made_by = "orbit.polished"

    orbit: HomoclinicOrbit = field(repr=False)
    midpoint: tuple[str, ...]
    digits: int
    amplitude: float
    time: str
    residual: float


def polished_midpoint(orbit: HomoclinicOrbit, digits: int) -> PreciseMidpoint:
    """The midpoint of an orbit that is homoclinic to a periodic orbit.

    Raises:
        ParameterError: it is homoclinic to an equilibrium, or the equations are no polynomials.
        OrbitError: Newton's method does not converge.
    """
    from flint import ctx

    digits = as_count(digits, "digits", least=10, most=MOST_DIGITS)
    origin = cast("SymmetricOrbit", orbit.origin)
    if orbit.space.loop_time == 0:
        raise ParameterError(
            "polished: wanted an orbit that is homoclinic to a periodic orbit; got one to an equilibrium"
        )
    size = float(linear.norm(orbit.amplitude))
    slowest = float(np.abs(linear.eigvals(orbit.space.matrix)).min())
    n_loops = max(0, ceil((digits / 3 + 1) * log(10) / log(slowest) + log(size) / log(slowest)))
    # what is lost on the way from an amplitude of 10^(-digits/3) to 1
    working = digits + ceil(digits / 3) + 4
    with ctx.workprec(bits(working)):
        start = _Start(orbit, origin, PreciseFlow(orbit.system, working), working)
        closing = linear.matmul(origin.last.matrix, origin.first.matrix)
        middle, a, time, moved = start.solved(n_loops, digits)
        for _ in range(n_loops):  # an odd number of loops leads to the image
            middle = (exact_columns(closing.T) * column(middle)).entries()
        return PreciseMidpoint(
            orbit,
            tuple(text_of(value, digits) for value in middle),
            digits,
            float(sum((float(v) ** 2 for v in a), 0.0) ** 0.5),
            text_of(time, digits),
            moved,
        )


def exact_columns(values: Array) -> Matrix:
    """A matrix of doubles, exactly."""
    from flint import arb_mat

    return arb_mat(values.shape[0], values.shape[1], [as_ball(float(v)) for v in values.ravel()])


class _Start:
    """The linear unstable space of a periodic orbit in many digits, and the states near."""

    def __init__(self, orbit: HomoclinicOrbit, origin: SymmetricOrbit, flow: PreciseFlow, digits: int) -> None:
        self.orbit, self.flow = orbit, flow
        level = origin.level
        self.functions: Polynomials = level_functions(level)
        self.wanted = [as_ball(value) for value in level.constants.values()]
        self.state, _, T, _ = solved_segment(origin, digits)
        n = flow.n
        closing = exact_columns(linear.matmul(origin.last.matrix, origin.first.matrix).T)
        loop = midpoints(closing * flow.end(self.state, 2 * T, exact_columns(np.eye(n)))[1])
        # coordinates as in doubles: those with respect to the basis there
        dual = exact_columns(linear.pinv(orbit.space.basis).astype(np.float64))
        basis = exact_columns(orbit.space.basis)
        change = 1.0
        slowest = float(np.abs(linear.eigvals(orbit.space.matrix)).min())
        for _ in range(ceil(digits * log(10) / log(slowest)) + 10):
            new = loop * basis
            new = midpoints(new * midpoints((dual * new).inv()))
            change = max(float(abs(v)) for v in (new - basis).entries())
            basis = new
        if not change < 10.0 ** -(digits - 8):
            raise OrbitError(f"the unstable space must converge; its last change is {change:.1e}")
        self.basis, self.loop, self.loop_time = basis, midpoints(dual * loop * basis), (2 * T).mid()
        self.constant = midpoints(self.functions.derivatives(self.state).transpose())

    def at(self, amplitude: Matrix) -> tuple[list[Ball], Matrix]:
        """The state x(a), on the level, and its derivative."""
        x = [(p + v).mid() for p, v in zip(self.state, (self.basis * amplitude).entries(), strict=True)]
        for _ in range(_TO_LEVEL):
            rest = [v - c for v, c in zip(self.functions.values(x), self.wanted, strict=True)]
            move = solved(self.functions.derivatives(x) * self.constant, column(rest))
            x = [(v - m).mid() for v, m in zip(x, (self.constant * move).entries(), strict=True)]
            if max(float(abs(v)) for v in rest) < 10.0 ** -(self.flow.digits + 4):
                break
        slopes = self.functions.derivatives(x)
        return x, midpoints(self.basis - self.constant * solved(slopes * self.constant, slopes * self.basis))

    def solved(self, n_loops: int, digits: int) -> tuple[list[Ball], list[Ball], Ball, float]:
        """Midpoint, amplitude, time and the size of the last step."""
        mirror = exact_matrix(mirror_basis(self.orbit.reverser)).transpose()
        a = column([as_ball(float(v)) for v in self.orbit.amplitude])
        for _ in range(n_loops):
            a = solved(self.loop, a)
        time = (as_ball(float(self.orbit.time)) + n_loops * self.loop_time).mid()
        moved = 1.0
        for _ in range(_MOST_CORRECTIONS):
            x, slopes = self.at(a)
            size = max((abs(v) for v in a.entries()), key=float)
            end, tangents = self.flow.end(x, time, midpoints(slopes * size))
            rate = column(self.flow.rate(end))
            step = solved(beside(mirror * tangents, mirror * rate), -(mirror * column(end))).entries()
            a = column([(v + size * s).mid() for v, s in zip(a.entries(), step[:-1], strict=True)])
            time = (time + step[-1]).mid()
            moved = max(float(abs(v)) for v in step)
            if moved < 10.0 ** (-0.5 * digits - 2):
                end, _ = self.flow.end(self.at(a)[0], time)
                return in_fixed_set(self.orbit.reverser, end), a.entries(), time, moved
        raise OrbitError(
            f"a homoclinic orbit must meet the fixed set; Newton's method in {digits} digits still moves by {moved:.1e}"
        )
