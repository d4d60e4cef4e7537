r"""Nonlinear least squares with exact derivatives, and what they say of the unknowns: errors, and what has none.

Levenberg and Marquardt's method with singular values of the scaled matrix of derivatives: with $r(u)$ the residuals in
units of their errors, $A = (\partial r/\partial u) D^{-1} = U S V^T$, D the lengths of its columns, a step is
$D\,\delta = -V (S^2 + \lambda)^{-1} S U^T r$, and $\lambda$ follows from how much of the predicted decrease came.
Directions with $s_k \le 2^{-26} s_1$ are not determined: in the information matrix $A^TA$ they are round-off.  No step
goes along them.

References: Moré, The Levenberg-Marquardt algorithm: implementation and theory, Lecture Notes in Mathematics 630 (1978)
105, for the scales; Nielsen, Damping parameter in Marquardt's method, report IMM-REP-1999-05, for $\lambda$.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

NOTHING = 2.0**-26
"""Singular values below this part of the largest have squares that are its round-off."""
ROUND_OFF = 2.0**-52
"""Of one operation.  Values that are wrong by the part e of their size shift a sum of squares $|r|^2$ by $e|r||y|$: a
smaller decrease is not seen."""
_FIRST_DAMPING = 1e-3
"""Of the largest singular value's square, which is of order 1 where columns have the length 1 (Nielsen)."""

Residuals: TypeAlias = "Callable[[Array], tuple[Array, Array] | None]"
"""Residuals and their derivatives at values of the unknowns, shapes (value,) and (value, unknown), or None."""


@dataclass(frozen=True)
class Frame:
    """Derivatives at some values of the unknowns, in units in which each column has the length 1.

    Attributes:
        unit: Of each unknown, shape (unknown,): the change that changes the model's values by 1.
        is_felt: Whether a change of an unknown changes any value; the unit is 1 where none does.
        held: Whether an unknown stays where it is: at a bound.
        left, singular, right: The decomposition of the derivatives by those that are not held.
    """

    unit: Array
    is_felt: NDArray[np.bool_]
    held: NDArray[np.bool_]
    left: Array
    singular: Array
    right: Array

    @classmethod
    def of(cls, derivative: Array, held: NDArray[np.bool_]) -> Frame:
        """The frame of a matrix of derivatives, shape (value, unknown)."""
        length = np.sqrt(np.sum(derivative**2, axis=0))
        unit = 1.0 / np.where(length > 0, length, 1.0)
        scaled = (derivative * unit)[:, ~held]
        if not scaled.shape[1]:
            return cls(unit, length > 0, held, np.zeros((len(scaled), 0)), np.zeros(0), np.zeros((0, 0)))
        found = linear.svd(scaled, full_matrices=False)
        return cls(unit, length > 0, held, found.U, found.S, found.Vh)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which directions are determined."""
        return self.singular > NOTHING * self.singular.max(initial=0.0)

    @property
    def rank(self) -> int:
        """How many directions are determined."""
        return int(self.known.sum())

    def vectors(self, chosen: NDArray[np.bool_]) -> Array:
        """Directions in scaled unknowns, those that are held being zero, shape (direction, unknown)."""
        found = np.zeros((int(chosen.sum()), len(self.unit)))
        found[:, ~self.held] = self.right[chosen]
        return found

    def step(self, residual: Array, damping: float) -> Array:
        """The step with a damping."""
        s = self.singular[self.known]
        along = -s / (s * s + damping) * linear.matmul(self.left[:, self.known].T, residual)
        return self.unit * linear.matmul(along, self.vectors(self.known))

    def change(self, residual: Array) -> float:
        """By how much the step without damping changes the model's values: the length of what it can explain."""
        return float(linear.norm(linear.matmul(self.left[:, self.known].T, residual)))

    @property
    def covariance(self) -> Array:
        """Of the unknowns for residuals of variance 1, along what is determined, shape (unknown, unknown)."""
        root = self.vectors(self.known) / self.singular[self.known, None] * self.unit
        return np.asarray(linear.matmul(root.T, root)) if len(root) else np.zeros((len(self.unit),) * 2)

    @property
    def null(self) -> Array:
        """The directions that are not determined, shape (direction, unknown), in the unknowns themselves."""
        return self.vectors(~self.known) * self.unit


@dataclass(frozen=True)
class Minimum:
    """Where a search has ended.

    Attributes:
        unknown: The values, shape (unknown,).
        held: Which unknowns are at a bound that the minimum lies beyond, shape (unknown,).
        ending: "converged", "at a bound", "no progress", "most steps", "no trajectory" or "time limit".
        n_steps: Accepted steps.
    """

    unknown: Array
    held: NDArray[np.bool_]
    ending: str
    n_steps: int


def minimum(
    residuals: Residuals,
    guess: Array,
    bounds: tuple[Array, Array],
    *,
    size: float,
    accuracy: float,
    most_steps: int,
    is_late: Callable[[], bool],
    tell: Callable[[float], None],
) -> Minimum:
    """A local minimum of the sum of squares near a guess.

    Args:
        residuals: The residuals, in units of their errors, and their derivatives.
        guess: Where the search begins.
        bounds: Least and largest values of the unknowns.
        size: The length of the observed values in the same units.
        accuracy: Relative error of the model's values.
        most_steps: Most accepted steps.
        is_late: Whether the time is over.
        tell: Hears what fraction is done.
    """
    low, high = bounds
    u = np.clip(guess, low, high)
    if (found := residuals(u)) is None:
        return Minimum(u, low >= high, "time limit" if is_late() else "no trajectory", 0)
    damping, factor = _FIRST_DAMPING, 2.0
    for n in range(most_steps + 1):
        r, J = found
        frame = Frame.of(J, _held(u, r, J, low, high))
        change, length = frame.change(r), float(linear.norm(r))
        seen = length * max(size, length)
        if change**2 <= ROUND_OFF * seen:
            return Minimum(np.clip(u + frame.step(r, 0.0), low, high), frame.held, _settled(frame), n)
        tell(n / (most_steps + 1))
        if n == most_steps:
            return Minimum(u, frame.held, "most steps", n)
        while True:
            if is_late():
                return Minimum(u, frame.held, "time limit", n)
            new = np.clip(u + frame.step(r, damping), low, high)
            moved = linear.matmul(J, new - u)
            if linear.norm(moved) <= ROUND_OFF * max(size, length):  # no shorter step is felt
                ending = _settled(frame) if change**2 <= accuracy * seen else "no progress"
                return Minimum(u, frame.held, ending, n)
            predicted = -float(linear.matmul(moved, 2 * r + moved))
            tried = residuals(new)
            gained = -1.0 if tried is None else float(linear.matmul(r - tried[0], r + tried[0]))
            if tried is not None and gained > 0 and predicted > 0:
                damping *= max(1 / 3, 1 - (2 * min(gained / predicted, 1.0) - 1) ** 3)
                u, found, factor = new, tried, 2.0
                break
            damping, factor = damping * factor, 2 * factor
    raise AssertionError("the last step returns")


def _held(u: Array, r: Array, J: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """Which unknowns are at a bound that a smaller sum of squares lies beyond, or have no room."""
    slope = np.asarray(linear.matmul(J.T, r))
    return ((u <= low) & (slope >= 0)) | ((u >= high) & (slope <= 0)) | (low >= high)


def _settled(frame: Frame) -> str:
    return "at a bound" if frame.held.any() else "converged"


def undetermined(names: tuple[str, ...], values: Array, frame: Frame, size: float) -> tuple[str, ...]:
    """What the data do not tell, in words: changes of the unknowns that change no value.

    Each is a combination of relative changes.  A number that is zero, or so small that the model does not feel it,
    changes by an amount.  Combinations are chosen so that each has an unknown which the others do not have.

    Args:
        names: Of the unknowns.
        values: Theirs.
        frame: The derivatives.
        size: The length of the observed values in units of their errors.
    """
    felt = np.abs(values) > NOTHING * size * frame.unit
    is_zero = ~felt & (frame.is_felt | (values == 0))
    rows = sorted(_echelon(frame.vectors(~frame.known)), key=lambda row: int(np.flatnonzero(row)[0]))
    return tuple(_words(names, row * frame.unit, values, is_zero) for row in rows)


def _echelon(rows: Array) -> Array:
    """The same space by rows of which each has an entry 1, the largest, where the others have 0."""
    for k in range(len(rows)):
        i, j = divmod(int(np.argmax(np.abs(rows[k:]))), rows.shape[1])
        rows[[k, k + i]] = rows[[k + i, k]]
        rows[k] /= rows[k, j]
        others = np.arange(len(rows)) != k
        rows[others] -= rows[others, j][:, None] * rows[k]
    return np.where(np.abs(rows) > NOTHING, rows, 0.0)


def _words(names: tuple[str, ...], row: Array, values: Array, is_zero: NDArray[np.bool_]) -> str:
    """A change of the unknowns, scaled so that the largest relative one is 1 in 100."""
    moving = np.flatnonzero(row)
    if len(moving) == 1:
        return f"{names[moving[0]]} changes no observed value"
    relative = np.array([row[k] if is_zero[k] else row[k] / values[k] for k in moving])
    amounts = is_zero[moving]
    largest = np.abs(relative[~amounts] if not amounts.all() else relative).max()
    relative *= np.sign(relative[0]) / largest
    if not amounts.any() and np.all(np.abs(relative - 1) <= NOTHING):
        return f"only the ratios of {', '.join(names[k] for k in moving)}"
    per = 1.0 if amounts.all() else 0.01
    changes = [f"{per * r:+.3g}" if amount else f"{r:+.3g}%" for r, amount in zip(relative, amounts, strict=True)]
    parts = [f"{names[k]} {change}" for k, change in zip(moving, changes, strict=True)]
    return f"{', '.join(parts)} together change no observed value"
