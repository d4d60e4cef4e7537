"""Segments of symmetric orbits to any number of digits: Newton's method in the arithmetic of Arb."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liepoisson.errors import OrbitError
from liepoisson.formula.scalars import as_count
from liepoisson.orbits.precise_flow import (
    Ball,
    Matrix,
    Polynomials,
    PreciseFlow,
    as_ball,
    bits,
    column,
    solved,
)
from liepoisson.orbits.shooting import fixed_basis, mirror_basis

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.orbits.level import Level
    from liepoisson.orbits.periodic_orbits import SymmetricOrbit

MOST_DIGITS = 1000
_MOST_STEPS = 12


@dataclass(frozen=True)
class PreciseSegment:
    """A segment of a symmetric orbit, as decimal texts, which liepoisson reads as exact numbers.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> orbit = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)[0]
        >>> precise = orbit.polished(digits=30)
        >>> precise.digits, round(float(precise.time), 10) == round(orbit.time, 10)
        (30, True)

    Attributes:
        start: The components of the state in the fixed set of the first reverser.
        end: Those of the state in the fixed set of the last.
        time: The time between them.
        digits: How many digits of them are right.
        residual: How far the last step of Newton's method moved, relative to the state.
    """

    start: tuple[str, ...]
    end: tuple[str, ...]
    time: str
    digits: int
    residual: float


def text_of(value: Ball, digits: int) -> str:
    """A number with so many significant digits, plain where that is short."""
    return "0" if value == 0 else value.mid().str(digits, radius=False)


def polished_segment(orbit: SymmetricOrbit, digits: int) -> PreciseSegment:
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
    wanted = [as_ball(value) for value in level.values.values()]
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
