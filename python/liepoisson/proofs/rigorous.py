"""What the rigorous enclosures have in common: field, arithmetic, doubles as bounds of balls, boxes of eigenvalues."""

from __future__ import annotations

import math
import sys
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from liepoisson.algebra.sparse_polynomials import along, value_at
from liepoisson.errors import EnclosureError, ParameterError, ShapeError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import as_count, as_number, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.given import as_scalar, by_name
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import as_system
from liepoisson.proofs.balls.lohner import How
from liepoisson.proofs.box import Box, BoxLike, as_box
from liepoisson.proofs.polynomial_field import PolynomialField, equations_of, polynomial_field

if TYPE_CHECKING:
    from flint import arb, arb_mat
    from numpy.typing import NDArray

    from liepoisson.model.system import System

Arithmetic: TypeAlias = Literal["intervals", "balls"]
ARITHMETICS = ("intervals", "balls")
ORDERS = {"intervals": 20, "balls": 32}
"""Of the Taylor polynomials, by default."""
PRECISION = 128
"""Bits of balls by default: doubles and as much again, which is what the steps lose."""
MAX_STEPS = 1_000_000
_MOST_BITS = 10_000
"""Of the balls: with more, a single step may take longer than any limit of time allows."""
_DIGITS = 2.0**-57
"""Remainders of the series, in units of the largest component: below the round-off of doubles."""
_SMALLEST = sys.float_info.min
_LEAST, _MOST = -100, 60
"""Powers of two between which numbers are small enough for the rational numbers of the core."""


@dataclass(frozen=True)
class Means:
    """How something is enclosed, checked.

    Attributes:
        arithmetic: "intervals" or "balls".
        order: Of the Taylor polynomials.
        step: The longest step; none where the series alone says.
        precision: Bits of the balls.
        deadline: When to give up, on the clock of `time.monotonic`: one for all parts of a run.
        progress: Called with the fraction that is done.
    """

    arithmetic: Arithmetic
    order: int
    step: float | None
    precision: int
    deadline: float
    progress: Callable[[float], Any] | None

    @classmethod
    def of(
        cls,
        arithmetic: object,
        *,
        order: object = None,
        step: object = None,
        precision: object = PRECISION,
        time_limit: float = math.inf,
        progress: Callable[[float], Any] | None = None,
    ) -> Means:
        """What a caller gives.

        Raises:
            ParameterError: an arithmetic has another name, or a number is out of range.
        """
        if not isinstance(arithmetic, str) or arithmetic not in ARITHMETICS:
            raise ParameterError(
                f'arithmetic: wanted "intervals" or "balls"; got {shown(arithmetic)}; intervals are the faster ones'
            )
        longest = None if step is None else positive(step, "step", "leave it out for steps that fit to the series")
        chosen: Arithmetic = arithmetic
        return cls(
            chosen,
            ORDERS[chosen] if order is None else as_count(order, "order", least=2, most=60, hint="try order=20"),
            longest,
            as_count(precision, "precision", least=53, most=_MOST_BITS, hint="try precision=128"),
            clock.monotonic() + as_time_limit(time_limit),
            progress,
        )

    @property
    def time_limit(self) -> float:
        """The seconds that are left.

        Raises:
            EnclosureError: none are.
        """
        left = self.deadline - clock.monotonic()
        if not left > 0:
            raise EnclosureError(
                "no enclosure: the time limit has passed; give a larger time_limit, a smaller set or a shorter time"
            )
        return left

    def of_core(self, box: Box, time: float) -> tuple[int, float, float | None, int]:
        """The same for the core."""
        size = float(max(np.abs(box.lower).max(initial=0.0), np.abs(box.upper).max(initial=0.0)))
        longest = max(abs(time), 1e-300) if self.step is None else self.step
        return self.order, longest, max(_DIGITS * (size or 1.0), _SMALLEST), MAX_STEPS

    def of_balls(self, time: float) -> How:
        """The same for balls."""
        longest = max(abs(time), 1e-300) if self.step is None else self.step
        return How(self.order, longest, self.precision, self.deadline, self.progress)


def positive(given: object, name: str, hint: str, *, or_zero: bool = False) -> float:
    """A finite positive number, exactly the double that it is.

    Raises:
        ParameterError: it is none.
    """
    wanted = "a finite number that is not negative" if or_zero else "a finite positive number"
    number = as_number(given, name, wanted)
    if not (math.isfinite(number) and (number > 0 or (or_zero and number == 0))):
        raise ParameterError(f"{name}: wanted {wanted}; got {number!r}; {hint}")
    return number


def equations(system: System | PolynomialField) -> PolynomialField:
    """The equations of a system, or a field that is none.

    Raises:
        ParameterError: they are not polynomial, or a coefficient is not rational.
    """
    return system if isinstance(system, PolynomialField) else equations_of(as_system(system))


def equations_and_constants(system: System | PolynomialField) -> PolynomialField:
    """The equations, H and the Casimirs.

    Raises:
        ParameterError: they are not polynomial, a coefficient is not rational, or a constant of a field is none.
    """
    if not isinstance(system, PolynomialField):
        return polynomial_field(as_system(system))
    for name, constant in system.constants.items():
        if along(constant, system.rates):
            raise ParameterError(f"{name}: wanted a constant of motion; its rate of change along the field is not zero")
    return system


def name_of(system: System | PolynomialField) -> str:
    """What a result calls its system."""
    return "a polynomial field" if isinstance(system, PolynomialField) else system.name


def box_of_states(given: BoxLike, field: PolynomialField, name: str = "box") -> Box:
    """A box of states.

    Raises:
        ParameterError: it is empty or a bound is not finite.
        ShapeError: it has another shape.
    """
    box = as_box(given, name, field.names)
    if box.lower.shape != (n := len(field.names),):
        raise ShapeError(
            f"{name}: wanted bounds of {n} components ({', '.join(field.names)}); got shape {box.lower.shape}; give "
            "lp.proofs.Box(lower, upper), a tuple of both, or one state"
        )
    return box


def one_state(given: BoxLike, field: PolynomialField, name: str) -> Array:
    """One state as doubles, which need not be exact.

    Raises:
        ParameterError: a number is not finite.
        ShapeError: it has another shape.
    """
    return box_of_states(given, field, name).midpoint


def level_values(
    given: Mapping[str, object] | None, field: PolynomialField, names: Sequence[str], state: Sequence[float]
) -> dict[str, Fraction]:
    """Exact values of constants of motion: those that are given, else the doubles nearest to those of a state.

    Raises:
        ParameterError: a constant has no value or is not known, or a value is not rational.
    """
    if given is None:
        at = [Fraction(v) for v in state]
        return {name: _near(value_at(field.constants[name].items(), at, Fraction), name) for name in names}
    given = by_name(given, "level", "values", _example(names))
    if set(given) != set(names):
        raise ParameterError(
            f"level: wanted values of {', '.join(names) or 'nothing'}; got {', '.join(map(str, given)) or 'nothing'}; "
            f"write {_example(names)}"
        )
    found: dict[str, Fraction] = {}
    for name in names:
        item: Any = as_scalar(given[name])
        number = Fraction(item) if isinstance(item, float) and math.isfinite(item) else read_parameter(item, name)
        if not isinstance(number, Fraction):
            raise ParameterError(f"level: wanted a rational value of {name}; got {shown(item)}; give a double near it")
        found[name] = number
    return found


def _example(names: Sequence[str]) -> str:
    return f"level={{{', '.join(f'{name!r}: ...' for name in names)}}}"


def _near(number: Fraction, name: str) -> Fraction:
    """A double near a number, and 0 where it is tiny: the core has rational numbers of 127 bits."""
    try:
        near = Fraction(float(number))
    except OverflowError as error:
        raise ParameterError(f"level: wanted a value of {name} that a double holds; got {shown(number)}") from error
    return near if near.denominator.bit_length() <= -_LEAST else Fraction(round(near * 2**-_LEAST), 2**-_LEAST)


def down(b: arb) -> float:
    """The largest double known to be below a ball.

    Raises:
        EnclosureError: the ball is not finite.
    """
    return -up(-b)


def up(b: arb) -> float:
    """The smallest double known to be above a ball.

    Raises:
        EnclosureError: the ball is not finite.
    """
    from flint import arb

    if not b.is_finite():
        raise EnclosureError("bounds that are not finite; try a smaller set or a higher precision")
    bound = b.upper()
    found = float(bound.mid())
    while math.isfinite(found) and not (arb(found) >= bound):
        found = math.nextafter(found, math.inf)
    if not math.isfinite(found):
        raise EnclosureError("bounds beyond the range of doubles; try a smaller set or another unit")
    return found


def rounded(balls: Sequence[arb], shape: tuple[int, ...]) -> Box:
    """A box of doubles around balls."""
    low = np.array([down(b) for b in balls], float).reshape(shape)
    return Box(low, np.array([up(b) for b in balls], float).reshape(shape))


def pair(b: arb) -> tuple[float, float]:
    """Doubles around one ball."""
    return down(b), up(b)


def as_ball(lower: float, upper: float) -> arb:
    """A ball that contains an interval."""
    from flint import arb

    return arb(lower).union(arb(upper))


def eigenvalue_boxes(matrix: arb_mat) -> tuple[Box, Box, NDArray[np.bool_]]:
    """Boxes around the real and imaginary parts, and whether a box contains one eigenvalue only.

    Raises:
        EnclosureError: Arb has no enclosure.
    """
    from flint import acb_mat

    n = matrix.nrows()
    if not n:
        return Box(np.zeros(0), np.zeros(0)), Box(np.zeros(0), np.zeros(0)), np.zeros(0, dtype=bool)
    try:
        try:
            found = acb_mat(matrix).eig(multiple=True)
        except ValueError:  # of multiple eigenvalues, where the matrix has many zeros: not in other coordinates
            found = acb_mat(_in_other_coordinates(matrix)).eig(multiple=True)
    except ValueError as error:
        raise EnclosureError(f"eigenvalues: wanted their enclosures; {error}; try a smaller set") from error
    low, high = (np.array([(bound(value.real), bound(value.imag)) for value in found], float) for bound in (down, up))
    simple = np.array([not any(_overlap(low, high, i, j) for j in range(n) if j != i) for i in range(n)])
    conjugate_low, conjugate_high = low.copy(), high.copy()
    conjugate_low[:, 1], conjugate_high[:, 1] = -high[:, 1], -low[:, 1]
    for i in np.nonzero(simple)[0].tolist():
        others = [j for j in range(n) if j != i]
        meets = [bool(np.all(conjugate_low[i] <= high[j]) and np.all(low[j] <= conjugate_high[i])) for j in others]
        if low[i, 1] <= 0 <= high[i, 1] and not any(meets):
            low[i, 1] = high[i, 1] = 0.0  # the conjugate of a single eigenvalue is in no other box: it is real
    order = np.lexsort((low[:, 1], low[:, 0]))[::-1]
    low, high = low[order], high[order]
    return Box(low[:, 0], high[:, 0]), Box(low[:, 1], high[:, 1]), simple[order]


def _in_other_coordinates(matrix: arb_mat) -> arb_mat:
    """A similar matrix, by whole numbers of determinant 1."""
    from flint import arb_mat

    n = matrix.nrows()
    below = {(i, j): (i * j + i + j) % 3 - 1 for i in range(n) for j in range(i)}
    lower = arb_mat(n, n, [1 if i == j else below.get((i, j), 0) for i in range(n) for j in range(n)])
    T = lower * lower.transpose()
    return T.inv() * matrix * T


def _overlap(low: Array, high: Array, i: int, j: int) -> bool:
    return bool(np.all(low[i] <= high[j]) and np.all(low[j] <= high[i]))
