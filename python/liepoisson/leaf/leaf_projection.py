r"""Newton's method onto a set of equations: the nearest solution to first order, for many states at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array
from liepoisson.model.phase_functions import PhaseFunction, gradients_of, values_of_all
from liepoisson.portable import linear

CONVERGED = 1e-13
"""Largest relative residual of a solution; Newton's method usually ends at 2e-16."""

_MOST_STEPS, _HALVINGS = 80, 14

_STAGES = 16
"""Parts in which values are approached where one leap fails."""


@dataclass(frozen=True)
class Equations:
    r"""The equations $P x = 0$ and $M (f(x) - c) = 0$.

    Attributes:
        pinned: The rows of P, orthonormal, shape (k, N).
        functions: The functions f.
        values: Their values c, shape (function,), or one row for each state.
        mixing: Independent combinations M of the functions, shape (m, function).
        groups: The number of the block $x_b$ of each component whose lengths are told apart; empty where all are of one
            order.
        unit: What is added to their lengths: 1 where zero is a value like others, as of a coordinate, else 0; or one
            for each block, shape (block,).
    """

    pinned: Array
    functions: tuple[PhaseFunction, ...]
    values: Array
    mixing: Array
    groups: tuple[int, ...] = ()
    unit: float | Array = 0.0

    def with_function(self, function: PhaseFunction, value: float) -> Equations:
        """One equation more, f(x) = value."""
        m, n = self.mixing.shape
        mixing = np.zeros((m + 1, n + 1))
        mixing[:m, :n], mixing[m, n] = self.mixing, 1.0
        functions, values = (*self.functions, function), np.append(self.values, value)
        return replace(self, functions=functions, values=values, mixing=mixing)

    def of(self, states: NDArray[np.intp]) -> Equations:
        """The equations of some of the states, if each has values of its own."""
        return replace(self, values=self.values[states]) if self.values.ndim > 1 else self

    def rows(self, x: Array) -> Array:
        """The gradients of all equations, shape (..., equation, N)."""
        pinned = np.broadcast_to(self.pinned, (*x.shape[:-1], *self.pinned.shape))
        return np.concatenate([pinned, linear.matmul(self.mixing, gradients_of(self.functions, x))], axis=-2)

    def relative(self, x: Array) -> tuple[Array, Array]:
        r"""Residuals and gradients, both divided by the size of the terms that must cancel.

        That is $|c| + \sum_b(|x_b| + u)|\nabla_b f|$ with the unit u where fields are told apart, and $|x|$ or
        $\sum_b|P_b||x_b|$ for a row of P that has one block or several.  Both are NaN where a function has no finite
        gradient, as that of a square root at zero.
        """
        values = values_of_all(self.functions, x)
        slopes = linear.matmul(self.mixing, gradients_of(self.functions, x))
        scales = linear.matmul(np.abs(self.values), np.abs(self.mixing).T) + self._of_terms(slopes, x)
        scales[scales == 0] = 1.0
        scales[np.isinf(scales)] = np.nan  # against an infinite gradient any residual would count as zero
        k, m = len(self.pinned), len(self.mixing)
        residuals, rows = np.empty((*x.shape[:-1], k + m)), np.empty((*x.shape[:-1], k + m, x.shape[-1]))
        residuals[..., k:] = linear.einsum("ij,...j->...i", self.mixing, values - self.values) / scales
        rows[..., k:, :] = slopes / scales[..., None]
        if k:
            lengths = self._of_pinned(x)
            lengths = np.where(lengths > 0, lengths, 1.0)
            residuals[..., :k] = linear.matmul(x, self.pinned.T) / lengths
            rows[..., :k, :] = self.pinned / lengths[..., None]
        return residuals, rows

    def _of_terms(self, rows: Array, x: Array) -> Array:
        r"""$\sum_b|x_b||r_b|$ for each row r, shape (..., row)."""
        if not self.groups:
            return linear.norm(x, axis=-1)[..., None] * linear.norm(rows, axis=-1)
        lengths, slopes = (np.sqrt(linear.matmul(v**2, self._membership)) for v in (x, rows))
        return linear.einsum("...b,...ib->...i", lengths + self.unit, slopes)

    @cached_property
    def _membership(self) -> Array:
        """Which component is in which block, shape (N, k)."""
        return np.eye(1 + max(self.groups))[list(self.groups)]

    def _of_pinned(self, x: Array) -> Array:
        """What the products of a state with the rows of P are compared with, shape (..., 1) or (..., row)."""
        size = linear.norm(x, axis=-1)[..., None]
        if not self.groups:
            return size
        blocks = linear.matmul(np.abs(self.pinned), self._membership)
        is_relation = (blocks > 0).sum(axis=-1) > 1
        rows = np.broadcast_to(self.pinned, (*x.shape[:-1], *self.pinned.shape))
        return np.where(is_relation, self._of_terms(rows, x), size)

    def residual(self, x: Array) -> Array:
        """The largest relative residual, shape (...)."""
        residuals = self.relative(x)[0]
        return np.abs(residuals).max(axis=-1) if residuals.shape[-1] else np.zeros(x.shape[:-1])


@np.errstate(all="ignore")  # functions need not exist at guesses; such states do not converge
def solve(equations: Equations, x: Array, *, most_steps: int = _MOST_STEPS) -> tuple[Array, Array]:
    r"""Solutions near x, by Newton steps of minimum norm, $\delta = -G^+ F$, halved where they do not help.

    Args:
        equations: What must hold.
        x: States, shape (trajectory, N).
        most_steps: Where to give up.

    Returns:
        The states and their largest relative residuals; above `CONVERGED` there is no solution near this state, and
        infinite where a function or its gradient does not exist at it.
    """
    x = x - linear.matmul(
        linear.matmul(x, equations.pinned.T), equations.pinned
    )  # exact for fields that vanish, and the origin has no scale
    residual = _finite_or_infinity(equations.residual(x))
    active = np.flatnonzero(np.isfinite(residual))
    for _ in range(most_steps):
        active = active[residual[active] > 2e-16]
        if not active.size:
            break
        moved, reached = _step(equations.of(active), x[active], residual[active])
        better = reached < residual[active]
        x[active[better]], residual[active[better]] = moved[better], reached[better]
        active = active[better]
    return x, residual


@np.errstate(all="ignore")
def approach(equations: Equations, x: Array) -> tuple[Array, Array]:
    """Solutions near x as `solve` finds them; where it finds none, along values from those at x to the wanted ones.

    A residual relative to its terms grows less than the terms do, so that a long leap may look better than it is, and
    end where no step helps.
    """
    found, residual = solve(equations, x)
    left = np.flatnonzero(~(residual <= CONVERGED))
    if left.size:
        closeness = residual[left]
        there = x[left] - linear.matmul(linear.matmul(x[left], equations.pinned.T), equations.pinned)
        begin = values_of_all(equations.functions, there)
        for stage in range(1, _STAGES + 1):
            values = begin + stage / _STAGES * (equations.values - begin) if stage < _STAGES else equations.values
            there, closeness = solve(replace(equations, values=np.broadcast_to(values, begin.shape)), there)
        reached = closeness <= CONVERGED
        found[left[reached]], residual[left[reached]] = there[reached], closeness[reached]
    return found, residual


def _step(equations: Equations, x: Array, residual: Array) -> tuple[Array, Array]:
    values, rows = equations.relative(x)
    rows[~np.isfinite(rows).all(axis=(-2, -1))] = 0.0  # divided by a length that underflows: no step
    delta = -linear.einsum("...ij,...j->...i", linear.pinv(rows, rcond=1e-12), values)
    best, reached = x.copy(), np.full(len(x), np.inf)
    left = np.arange(len(x))
    for halvings in range(_HALVINGS):
        trial = x[left] + delta[left] * 0.5**halvings
        found = _finite_or_infinity(equations.of(left).residual(trial))
        best[left], reached[left] = trial, found
        left = left[found >= residual[left]]
        # At round-off no step helps, and a shorter one helps no more.
        left = left[residual[left] > CONVERGED]
        if not left.size:
            break
    return best, reached


def _finite_or_infinity(residual: Array) -> Array:
    return np.where(np.isfinite(residual), residual, np.inf)


def mixing_of(functions: Sequence[PhaseFunction], pinned: Array, x: Array, n_equations: int) -> Array:
    r"""Combinations of the functions that are independent on the leaf through x, shape (m, function).

    On a lower stratum more Casimirs may be listed than the leaf has equations: for $\alpha = p\,n$, $\beta = q\,n$ the
    three $|\alpha|^2, \alpha\cdot\beta, |\beta|^2$ say one thing.  The relations between their differentials are the
    same along the whole leaf, since coadjoint motions carry $dC$ along; the singular vectors at one point give them.
    """
    m = n_equations - len(pinned)
    if m == len(functions):
        return np.eye(m)
    rows = gradients_of(functions, x)
    rows = rows - linear.matmul(linear.matmul(rows, pinned.T), pinned)
    return linear.svd(rows)[0][:, :m].T
