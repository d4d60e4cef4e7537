r"""Newton's method for critical points of the Hamiltonian on a leaf, or on a level set of integrals in it.

Solved are $f_H(x) - \sum_j\Omega_j f_{K_j}(x) = 0$ and $K_j(x) = \kappa_j$ for a state on the leaf, where
$f_F = J\nabla F$. A step is taken in the tangent space of the leaf, then the state is projected back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.linearisation import leaf_tangent
from liepoisson.inputs.arrays import Array, norm
from liepoisson.inputs.deadline import has_passed
from liepoisson.leaf.leaf_in_units import unit_length
from liepoisson.leaf.leaf_projection import CONVERGED, solve
from liepoisson.model.phase_functions import gradients_of
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits, SystemInUnits
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

CANCELLED = 1e-13
"""A sum below this fraction of the sizes of its terms is round-off, and so is a singular value below this fraction of
the largest."""
VANISHES = 1e-8
"""A vector field below this fraction of its scale counts as zero, and a state where it is as a possible equilibrium:
the damping is at least 1e-15 of the squared equations, so that directions in which they are below 3e-8 are slow."""
ROUND_OFF = 1e-14
"""Round-off of a state and of the equations, relative to their terms, at which the iteration stops: at equilibria of
the catalog Newton's method leaves 1 to 8 eps, a fifth of this."""
MOST_STEPS = 100
"""Where the iteration ends in any case."""
_LARGEST = 1e280
"""Second derivatives above this count as none: products of them overflow."""


class HamiltonianFields:
    r"""The vector fields $J\nabla F$ of several functions and their derivatives, at many states.

    Args:
        system: The system whose bracket is meant.
        functions: F, such as the Hamiltonian and integrals.
    """

    def __init__(self, system: System | SystemInUnits, functions: Sequence[PhaseFunction]) -> None:
        self._system = system
        self.functions = tuple(functions)
        self._last: tuple[Array, tuple[Array, Array]] | None = None

    @cached_property
    def unit(self) -> float:
        """What is added to the lengths of states, see `liepoisson.leaf.leaf_in_units`."""
        return unit_length(self._system.bracket)

    @cached_property
    def _at_zero(self) -> Array:
        """The constant part of J, shape (N, N)."""
        return self._system.functions.poisson_tensor(np.zeros(self._system.bracket.dimension))

    @cached_property
    def _constants(self) -> Array:
        """The derivative of a J of degree one: [m, i, j] is that of J_ij along x_m."""
        return self._system.functions.poisson_tensor(np.eye(self._system.bracket.dimension)) - self._at_zero

    def poisson(self, x: Array) -> Array:
        """Poisson tensors, shape (..., N, N)."""
        if not self._system.bracket.is_linear:
            return self._system.functions.poisson_tensor(x)
        tensor = linear.einsum("...m,mij->...ij", x, self._constants)
        return tensor + self._at_zero if self._system.bracket.constant else tensor

    def fields(self, x: Array) -> Array:
        """The vector fields, shape (..., N, function)."""
        return linear.matmul(self.poisson(x), np.moveaxis(gradients_of(self.functions, x), -2, -1))

    def derivatives(self, x: Array) -> Array:
        """Their derivatives, shape (..., N, N, function)."""
        turning, bending = self.parts(x)
        return turning + bending

    def parts(self, x: Array) -> tuple[Array, Array]:
        r"""The terms of the derivatives, $(\partial J)\nabla F$ and $J\partial\nabla F$, shape (..., N, N, function).

        Where F is a function of the Casimirs they cancel, and their sizes tell what is left of the sum is round-off.
        Scales, derivatives and residuals at the same states ask for them one after the other: the last ones are kept.
        """
        if self._last is not None and np.array_equal(self._last[0], x):
            return self._last[1]
        poisson = self.poisson(x)
        slopes = gradients_of(self.functions, x)
        if self._system.bracket.is_linear:
            turning = linear.einsum("mij,...kj->...imk", self._constants, slopes)
        else:
            turning = linear.einsum("...mij,...kj->...imk", self._system.functions.poisson_slopes(x), slopes)
        bending = [linear.matmul(poisson, f.hessian(x)) for f in self.functions]
        found = turning, np.stack(bending, axis=-1)
        self._last = x.copy(), found
        return found

    @cached_property
    def _of_limited_range(self) -> tuple[PhaseFunction, ...]:
        return tuple(f for f in self.functions if not f.is_polynomial)

    def are_defined(self, x: Array) -> NDArray[np.bool_]:
        """At which states, (...,), the derivatives of all functions up to the second ones are finite; polynomials have.

        Near the largest number what is made of them overflows, and a state would be at rest relative to it.
        """
        with np.errstate(all="ignore"):
            finite = np.isfinite(x).all(axis=-1)
            for f in self._of_limited_range:
                finite = finite & np.isfinite(f.gradient(x)).all(axis=-1)
                finite &= (np.abs(f.hessian(x)) <= _LARGEST).all(axis=(-2, -1))
        return np.asarray(finite)

    def scale(self, x: Array) -> Array:
        """What the size of the vector fields is compared with: the norms of `parts` times that of x."""
        size = sum(norm(part, axis=(-3, -2)) for part in self.parts(x))
        return np.asarray(size * (norm(x, axis=-1) + self.unit)[..., None])


@dataclass(frozen=True)
class CriticalEquations:
    """The equations of critical points of H on a leaf and on a level set of integrals, for states and multipliers.

    Attributes:
        leaf: The leaf.
        fields: Those of H and of the integrals K_j.
        values: The values kappa_j.
    """

    leaf: LeafInUnits
    fields: HamiltonianFields
    values: Array

    def tangents(self, x: Array) -> Array:
        """Orthonormal bases of the tangent spaces of the leaf, shape (row, N, rank)."""
        return leaf_tangent(self.fields.poisson(x), self.leaf.rank)

    def residual(self, x: Array, omega: Array) -> Array:
        """The vector field of H - sum Omega K and the integrals' distances from their values, relative, (row, ...)."""
        rates = self.fields.fields(x)
        scale = self.fields.scale(x)[:, :1]
        parts = [(rates[..., 0] - linear.einsum("rij,rj->ri", rates[..., 1:], omega)) / np.where(scale > 0, scale, 1.0)]
        for f, value in zip(self.fields.functions[1:], self.values, strict=True):
            parts.append(((f(x) - value) / self._level_scale(f, value, x))[:, None])
        return np.concatenate(parts, axis=1)

    def _level_scale(self, f: PhaseFunction, value: float, x: Array) -> Array:
        """What the distance of an integral from its value is compared with."""
        scale = abs(value) + (norm(x, axis=1) + self.fields.unit) * norm(f.gradient(x), axis=1)
        return np.where(scale > 0, scale, 1.0)

    def newton_matrix(self, x: Array, omega: Array, basis: Array, among: Array | None = None) -> Array:
        """Derivative of the residual along the leaf and the multipliers, shape (row, N + k, rank + k).

        It is relative to the sizes of the terms at the states themselves, or at those `among` which it is compared.
        """
        among = x if among is None else among
        scale = self.fields.scale(among)[:, :1, None]
        scale = np.where(scale > 0, scale, 1.0)
        slopes = self.fields.derivatives(x)
        along = linear.matmul((slopes[..., 0] - linear.einsum("rimj,rj->rim", slopes[..., 1:], omega)), basis) / scale
        matrix = np.concatenate([along, -self.fields.fields(x)[..., 1:] / scale], axis=2)
        for f, value in zip(self.fields.functions[1:], self.values, strict=True):
            row = linear.einsum("ri,rij->rj", f.gradient(x), basis) / self._level_scale(f, value, among)[:, None]
            row = np.concatenate([row, np.zeros((len(x), len(self.values)))], axis=1)
            matrix = np.concatenate([matrix, row[:, None]], axis=1)
        return matrix

    @property
    def size(self) -> float:
        """The length of the leaf's own state, by which lengths are judged where a state is near zero."""
        return float(norm(self.leaf.state)) + self.fields.unit or 1.0

    def units(self, x: Array, rank: int) -> Array:
        """Natural sizes of the unknowns, (row, rank + k): the length of the state, and |f_H|/|f_K| by their scales."""
        scale = self.fields.scale(x)
        lengths = norm(x, axis=1) + self.fields.unit
        lengths = np.where(lengths > 0, lengths, self.size)[:, None]
        ratios = np.where(scale[:, 1:] > 0, scale[:, :1] / np.where(scale[:, 1:] > 0, scale[:, 1:], 1.0), 1.0)
        return np.concatenate([np.repeat(lengths, rank, axis=1), np.where(ratios > 0, ratios, 1.0)], axis=1)

    def left(self, x: Array) -> Array:
        """How far states of the leaf are from critical points, relative, shape (row,)."""
        omega = multipliers(self.fields.fields(x), self.fields.scale(x))
        return np.asarray(norm(self.residual(x, omega), axis=1))

    def projected(self, x: Array) -> tuple[Array, NDArray[np.bool_]]:
        """The states projected to the leaf, and for which of them that was possible."""
        found, residual = solve(self.leaf.equations, x)
        return found, residual <= CONVERGED


@np.errstate(all="ignore")  # a step may lead to where a function is not defined; it is not taken then
def critical_points(equations: CriticalEquations, starts: Array) -> tuple[Array, Array]:
    r"""Critical points from many starts near or on the leaf, shape (start, N), by Levenberg and Marquardt's method.

    The damping is proportional to the squared residual: it converges quadratically also to points of a family, where
    the linear equations are singular.

    Returns:
        States (start, N), and the relative residuals (start,) that are left; those far from round-off did not
        converge.

    References: Yamashita and Fukushima (2001), for the damping.
    """
    fields = equations.fields
    x, alive = equations.projected(starts)
    x = x[alive]
    x = x[fields.are_defined(x)]
    omega = multipliers(fields.fields(x), fields.scale(x))
    residual = equations.residual(x, omega)
    damping, failed = np.ones(len(x)), np.zeros(len(x), dtype=np.int64)
    for _ in range(MOST_STEPS):
        left = norm(residual, axis=1)
        rows = np.flatnonzero((left > ROUND_OFF) & (damping < 1e12) & ((left > CANCELLED) | (failed < 2)))
        if not rows.size or has_passed():
            break
        trial, trial_omega, possible = _step(equations, x[rows], omega[rows], residual[rows], damping[rows])
        # where the second derivatives overflow, the residual relative to them would count as zero
        possible &= fields.are_defined(trial)
        new = equations.residual(trial, trial_omega)
        better = possible & (norm(new, axis=1) < norm(residual[rows], axis=1))
        taken = rows[better]
        x[taken], omega[taken], residual[taken] = trial[better], trial_omega[better], new[better]
        failed[rows] = np.where(better, 0, failed[rows] + 1)
        damping[rows] *= np.where(better, 0.25, 4.0)
        damping = np.maximum(damping, 1e-10)
    return x, norm(residual, axis=1)


def finished(equations: CriticalEquations, x: Array) -> Array:
    """A state after Newton's steps without damping, while each is less than half as long as the one before.

    A residual relative to the largest curvature is one to round-off before a direction that is soft has converged.
    Components that converge to zero end at numbers too small for all of their digits, and are zero.
    """
    step = _undamped(equations, x)
    while np.isfinite(step).all():
        trial, possible = equations.projected((x + step)[None])
        if not (possible[0] and equations.fields.are_defined(trial)[0]):
            break
        following = _undamped(equations, trial[0])
        if not norm(following) < norm(step) / 2:
            break
        x, step = trial[0], following
    return _without_round_off(equations, x)


def _without_round_off(equations: CriticalEquations, x: Array) -> Array:
    """The state with 0 for components below the round-off of its length, if it solves the equations as well."""
    rounded = np.where(np.abs(x) < np.finfo(float).eps * (norm(x) + equations.fields.unit), 0.0, x)
    on_leaf = equations.leaf.equations.residual(np.array([rounded, x]))
    left = equations.left(np.array([rounded, x]))
    is_as_good = on_leaf[0] <= max(on_leaf[1], CONVERGED) and left[0] <= max(left[1], ROUND_OFF)
    return rounded if is_as_good else x


def _undamped(equations: CriticalEquations, x: Array) -> Array:
    """Newton's step without damping, shape (N,)."""
    omega = multipliers(equations.fields.fields(x[None]), equations.fields.scale(x[None]))
    basis = equations.tangents(x[None])
    units = equations.units(x[None], basis.shape[2])[0]
    matrix = equations.newton_matrix(x[None], omega, basis)[0] * units
    step = linear.lstsq(matrix, equations.residual(x[None], omega)[0], rcond=CANCELLED)[0] * units
    return np.asarray(linear.matmul(-basis[0], step[: basis.shape[2]]))


def _step(
    search: CriticalEquations, x: Array, omega: Array, residual: Array, damping: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """One damped Newton step of each row."""
    basis = search.tangents(x)
    matrix = search.newton_matrix(x, omega, basis)
    # Unknowns in units of their own, so that a change of units changes nothing.
    units = search.units(x, basis.shape[2])
    matrix = matrix * units[:, None, :]
    normal = linear.matmul(np.swapaxes(matrix, 1, 2), matrix)
    size = np.trace(normal, axis1=1, axis2=2)
    weight = damping * np.sum(residual**2, axis=1) + 1e-15
    with np.errstate(invalid="ignore", divide="ignore"):
        normal = normal / size[:, None, None] + weight[:, None, None] * np.eye(normal.shape[1])
        right = linear.matmul(np.swapaxes(matrix, 1, 2), residual[..., None]) / size[:, None, None]
    step = -_solved(normal, right)[..., 0] * units
    move = linear.einsum("rij,rj->ri", basis, step[:, : basis.shape[2]])
    # A step longer than the state itself says nothing about the neighbourhood in which it was computed.
    own = norm(x, axis=1) + search.fields.unit
    length, limit = norm(move, axis=1), 0.5 * own + 1e-3 * search.size
    shrink = np.minimum(1.0, limit / np.where(length > 0, length, np.inf))[:, None]
    shrink = np.where(length[:, None] > 0, shrink, 1.0)
    trial, possible = search.projected(x + shrink * move)
    return trial, omega + shrink * step[:, basis.shape[2] :], possible


def _solved(matrices: Array, right: Array) -> Array:
    """Solutions of many linear systems; a singular one has the shortest, one that is not finite has NaN."""
    result = np.full_like(right, np.nan)
    finite = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))
    try:
        result[finite] = linear.solve(matrices[finite], right[finite])
    except linear.LinAlgError:
        for row in np.flatnonzero(finite):
            result[row] = linear.lstsq(matrices[row], right[row])[0]
    return result


def multipliers(fields: Array, scale: Array) -> Array:
    r"""The least-squares $\Omega$ in $f_H = \sum_j\Omega_j f_{K_j}$, shape (row, k).

    An integral whose vector field depends on those of the integrals before it has the multiplier 0.

    Args:
        fields: Vector fields of H and the K_j, shape (row, N, 1 + k).
        scale: Their scales, shape (row, 1 + k); what is below 1e-8 of its scale counts as zero.
    """
    result = np.zeros((len(fields), fields.shape[2] - 1))
    for row, (field, size) in enumerate(zip(fields, np.where(scale > 0, scale, 1.0), strict=True)):
        columns = field[:, 1:] / size[1:]
        kept = independent_columns(columns)
        result[row, kept] = linear.lstsq(columns[:, kept], field[:, 0])[0] / size[1:][kept]
    return result


def independent_columns(columns: Array) -> list[int]:
    """The columns that do not depend on those before them, to 1e-8."""
    kept: list[int] = []
    basis = np.zeros((len(columns), 0))
    for k, column in enumerate(columns.T):
        new = column - linear.matmul(basis, linear.matmul(basis.T, column))
        if norm(new) > VANISHES:
            kept.append(k)
            basis = np.column_stack([basis, new / norm(new)])
    return kept
