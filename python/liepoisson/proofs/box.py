"""Boxes: bounds that are doubles, exactly, of states, matrices and numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import ordered
from liepoisson.inputs.refusals import shown

BoxLike: TypeAlias = "Box | tuple[ArrayLike, ArrayLike] | ArrayLike"
"""A box, its lower and upper bounds as a pair, or one point."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Box(ReadOnlyArrays):
    """All arrays of numbers between two bounds; the bounds are doubles, exactly.

    Doubles are taken as they are. Other exact numbers, such as the text "1/3", are rounded outward: the box contains
    them. The arrays are read-only.

    Example:
        >>> box = lp.proofs.Box(["1/3", 0], [0.5, 1])
        >>> box.contains([0.4, "1/7"]), box.contains([0.6, 0])
        (True, False)

    Attributes:
        lower: The lower bounds, of any shape.
        upper: The upper bounds, of the same shape.

    Raises:
        ParameterError: a bound is not finite, or a lower one is above the upper one: the box is empty.
        ShapeError: the bounds are no arrays of numbers of one shape.
    """

    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        """Checks and rounds the bounds."""
        (lower, _), (_, upper) = enclosed_numbers(self.lower, "lower"), enclosed_numbers(self.upper, "upper")
        if lower.shape != upper.shape:
            raise ShapeError(f"box: wanted bounds of one shape; got lower {lower.shape} and upper {upper.shape}")
        if not np.all(lower <= upper):
            place = tuple(int(k[0]) for k in np.nonzero(~(lower <= upper)))
            raise ParameterError(
                f"box: wanted lower bounds that are not above the upper ones; got "
                f"{lower[place].item()!r} and {upper[place].item()!r} at {place}, an empty box; exchange them?"
            )
        vars(self).update(lower=lower, upper=upper)
        super().__post_init__()

    @classmethod
    def around(cls, center: ArrayLike, radius: ArrayLike = 0.0) -> Box:
        """The box of all arrays that differ from a center by at most a radius in each entry, rounded outward.

        Args:
            center: The middle, of any shape.
            radius: A number, or one for each entry; not negative.

        Raises:
            ParameterError: a number is not finite, or a radius is negative.
            ShapeError: the radii do not fit to the center.
        """
        (low, high), (_, far) = enclosed_numbers(center, "center"), enclosed_numbers(radius, "radius")
        if np.any(far < 0):
            raise ParameterError(f"radius: wanted numbers that are not negative; got {shown(far.min().item())}")
        try:
            far = np.broadcast_to(far, low.shape)
        except ValueError as error:
            raise ShapeError(f"radius: wanted one number, or shape {low.shape}; got {far.shape}") from error
        pairs = zip(low.ravel().tolist(), high.ravel().tolist(), far.ravel().tolist(), strict=True)
        bounds = [(below(Fraction(a) - Fraction(r)), above(Fraction(b) + Fraction(r))) for a, b, r in pairs]
        both = np.array(bounds, float).reshape(*low.shape, 2)
        return cls(both[..., 0], both[..., 1])

    @property
    def width(self) -> Array:
        """Upper minus lower bounds, rounded up."""
        difference = self.upper - self.lower
        return np.where(difference > 0, np.nextafter(difference, np.inf), difference)

    @property
    def midpoint(self) -> Array:
        """Doubles in the middle, or next to it; they lie in the box."""
        return np.clip(0.5 * self.lower + 0.5 * self.upper, self.lower, self.upper)

    def contains(self, values: BoxLike) -> bool:
        """Whether an array of numbers, or all of another box, lies in this one; one that is not finite never does.

        Args:
            values: Numbers of the same shape, a box, or the two bounds of one as a tuple.

        Raises:
            ShapeError: they have another shape.
        """
        other = _bounds(values)
        if other is None:
            return False
        low, high = self._matching(other)
        return bool(np.all(self.lower <= low) and np.all(high <= self.upper))

    def overlaps(self, other: BoxLike) -> bool:
        """Whether the two boxes have a point in common.

        Args:
            other: A box of the same shape.

        Raises:
            ShapeError: it has another shape.
        """
        given = _bounds(other)
        if given is None:
            return False
        low, high = self._matching(given)
        return bool(np.all(self.lower <= high) and np.all(low <= self.upper))

    def _matching(self, other: tuple[Array, Array]) -> tuple[Array, Array]:
        if other[0].shape != self.lower.shape:
            raise ShapeError(f"values: wanted shape {self.lower.shape}; got {other[0].shape}")
        return other

    def __getitem__(self, place: Any) -> Box:
        """The box of some of the entries."""
        return Box(self.lower[place], self.upper[place])

    def __repr__(self) -> str:
        if self.lower.ndim == 0:
            return interval_text(float(self.lower), float(self.upper))
        if self.lower.ndim == 1 and len(self.lower) <= 12:
            entries = zip(self.lower.tolist(), self.upper.tolist(), strict=True)
            return f"Box({', '.join(interval_text(a, b) for a, b in entries)})"
        return f"<Box of shape {self.lower.shape}, widths up to {self.width.max(initial=0.0):.2g}>"

    __str__ = __repr__


def interval_text(lower: float, upper: float) -> str:
    """Two bounds, with as many digits as differ and two more; the bounds that are printed lie outside of the others."""
    if lower == upper:
        return f"[{lower!r}]"
    size = max(abs(lower), abs(upper))
    digits = min(17, max(2, 2 + math.ceil(math.log10(size / (upper - lower))))) if upper - lower > 0 else 17
    return f"[{_printed(lower, digits, up=False)}, {_printed(upper, digits, up=True)}]"


def _printed(value: float, digits: int, *, up: bool) -> str:
    """A decimal on the outer side of a bound."""
    from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

    return f"{Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR).create_decimal(Decimal(value)):g}"


def below(value: Fraction) -> float:
    """The largest double that is not above a number."""
    near = _nearest(value)
    return near if Fraction(near) <= value else math.nextafter(near, -math.inf)


def above(value: Fraction) -> float:
    """The smallest double that is not below a number."""
    near = _nearest(value)
    return near if Fraction(near) >= value else math.nextafter(near, math.inf)


def _nearest(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError as error:
        raise ParameterError(f"box: wanted numbers that a double can bound; got {shown(value)}") from error


def enclosed_numbers(values: ArrayLike, name: str, labels: Sequence[str] = ()) -> tuple[Array, Array]:
    """Doubles below and above exact numbers.

    Raises:
        ParameterError: one is not finite, or is no rational number.
        ShapeError: it is no array of numbers.
    """
    given: Any = ordered(values, name, labels)
    if isinstance(given, np.ndarray):
        given = cast("NDArray[Any]", given).copy()
    elif hasattr(given, "__array__") and not isinstance(given, np.generic):
        given = np.array(given)
    doubles = as_array(given, name)
    if not np.all(np.isfinite(doubles)):
        raise ParameterError(f"{name}: wanted finite numbers; got {shown(doubles[~np.isfinite(doubles)][0].item())}")
    kind = cast("NDArray[Any]", given).dtype.str[1:] if isinstance(given, np.ndarray) else ""
    if kind in {"f2", "f4", "f8"}:
        return doubles, doubles.copy()
    items = np.array(given, dtype=object).ravel().tolist() if doubles.size else []
    exact = [_exact(item, name) for item in items]
    lower = np.array([below(e) for e in exact], float).reshape(doubles.shape)
    upper = np.array([above(e) for e in exact], float).reshape(doubles.shape)
    return lower, upper


def _exact(item: Any, name: str) -> Fraction:
    """The rational number that an entry is: a double as it is, a text as what it says."""
    if isinstance(item, (float, np.floating)):
        return Fraction(*item.as_integer_ratio())
    number = read_parameter(item, name)
    if not isinstance(number, Fraction):
        raise ParameterError(
            f"{name}: wanted rational numbers or doubles; got {shown(item)}; give a double below and one above it"
        )
    return number


def _bounds(values: BoxLike) -> tuple[Array, Array] | None:
    """The bounds of a box or of numbers; none if one of the numbers is not finite."""
    try:
        box = as_box(values, "values")
    except ParameterError:
        if isinstance(values, tuple) or not np.all(np.isfinite(as_array(cast("ArrayLike", values), "values"))):
            return None
        raise
    return box.lower, box.upper


def as_box(values: BoxLike, name: str, labels: Sequence[str] = ()) -> Box:
    """A box from what a caller gives: a box, a pair of bounds (a tuple of two arrays), or one array of numbers.

    Labels of the numbers bring them into the order of `labels`.

    Raises:
        ParameterError: it is empty, or a number is not finite.
        ShapeError: it is no array of numbers.
    """
    if isinstance(values, Box):
        return values
    if (
        isinstance(values, tuple)
        and not hasattr(values, "_fields")
        and len(cast("Sequence[Any]", values)) == 2
        and not np.isscalar(values[0])
    ):
        lower, upper = (ordered(side, name, labels) for side in cast("tuple[ArrayLike, ArrayLike]", values))
        return Box(cast("Array", lower), cast("Array", upper))
    lower, upper = enclosed_numbers(cast("ArrayLike", values), name, labels)
    return Box(lower, upper)
