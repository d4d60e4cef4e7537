r"""A critical point of H on its leaf: the symplectic slice, and the second variation along its directions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.equilibrium.critical_points import CANCELLED, SOFT, VANISHES, HamiltonianFields, multipliers
from liepoisson.equilibrium.linearisation import LinearFlow, linear_flow
from liepoisson.inputs.arrays import Array, norm
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits


_STIFF, _OFF, _OUTGROWN = 1e-3, 100.0, 0.1
"""Directions that are softer, relative, have no part in a step; at how many steps a second variation is compared, and
what is left of it where it vanishes."""


@dataclass(frozen=True)
class CriticalPoint:
    """A critical point with what its second variations are made of."""

    fields: HamiltonianFields
    leaf: LeafInUnits
    x: Array
    omega: Array

    @cached_property
    def tangents(self) -> Array:
        """Orthonormal basis of the tangent space of the leaf."""
        return self.leaf.tangent_basis(self.x)

    @cached_property
    def _directions(self) -> tuple[Array, Array, Array]:
        """Singular vectors and values of the vector fields of the integrals, each relative to its scale."""
        rates, scale = self.fields.fields(self.x)[:, 1:], self.fields.scale(self.x)[1:]
        vectors, sizes, rows = linear.svd(rates / np.where(scale > 0, scale, 1.0))
        return vectors[:, : int((sizes > VANISHES).sum())], sizes, rows

    @property
    def symmetry(self) -> Array:
        """Basis of the span of the vector fields of the integrals, in coordinates of the tangent space of the leaf."""
        return linear.matmul(self.tangents.T, self._directions[0])

    def free(self) -> Array:
        """Combinations of the integrals whose vector fields vanish here, shape (free, k)."""
        vectors, _, rows = self._directions
        scale = self.fields.scale(self.x)[1:]
        return rows[vectors.shape[1] :] / np.where(scale > 0, scale, 1.0)

    def linear_flow(self, coefficients: Array) -> tuple[LinearFlow, float]:
        """The linearised flow of a combination of H and the integrals on the leaf, and its asymmetry."""
        basis, parts = self.tangents, self.fields.parts(self.x)
        derivative = linear.matmul(sum(parts), coefficients)
        # H - Omega K may be constant on the leaf: what is left of terms that cancel there is no second variation
        sizes = [norm(linear.einsum("ai,abk,bj->ijk", basis, part, basis), axis=(0, 1)) for part in parts]
        restricted = linear.matmul(linear.matmul(basis.T, derivative), basis)
        left = CANCELLED * float(linear.matmul(sum(sizes), np.abs(coefficients)))
        if norm(restricted) <= left or self._is_flat(coefficients, restricted):
            derivative = np.zeros_like(derivative)
        return linear_flow(self.fields.poisson(self.x), derivative, basis)

    def _is_flat(self, coefficients: Array, derivative: Array) -> bool:
        r"""Whether the second variation is only what is left of it at a state that is a little off.

        Where H has no terms below the degree m, such as $p^4 + q^4$, the search ends at a distance d from the critical
        point, and the second variation has a size and signs there that say nothing. Newton's step from there is
        $d/(m-1)$, and at 100 times this distance the second variation is larger by a factor of 50 at least; that of
        another critical point is the same.
        """
        x, basis = self.x, self.tangents
        length = float(norm(x)) + self.fields.unit
        rates = linear.matmul(linear.matmul(basis.T, self.fields.fields(x)), coefficients)
        if not (np.isfinite(derivative).all() and np.isfinite(rates).all()):
            return False
        step = float(norm(np.asarray(linear.lstsq(derivative, rates, rcond=_STIFF)[0], dtype=np.float64)))
        off = _OFF * max(step, float(np.finfo(np.float64).eps) * length)
        with np.errstate(all="ignore"):
            around = linear.matmul(
                sum(self.fields.parts(x + off * np.concatenate([basis, -basis], axis=1).T)), coefficients
            )
            sizes = norm(linear.matmul(linear.matmul(basis.T, around), basis), axis=(-2, -1))
        return bool(norm(derivative) <= _OUTGROWN * sizes[np.isfinite(sizes)].max(initial=0.0))


def null_directions(leaf: LeafInUnits, fields: HamiltonianFields, x: Array) -> Array:
    """Orthonormal directions in which a family of (relative) equilibria may go on from x, shape (N, n).

    The kernel of the second variation on the slice, and the motions of the integrals.
    """
    point, flow, basis = _on_slice(leaf, fields, x)
    found = np.concatenate([point.symmetry, linear.matmul(basis, flow.kernel())], axis=1)
    return linear.matmul(point.tangents, (linear.qr(found)[0] if found.size else found))


def soft_directions(leaf: LeafInUnits, fields: HamiltonianFields, x: Array, within: float = SOFT) -> Array:
    """Orthonormal directions in which the second variation on the slice is soft or flat, shape (N, n)."""
    point, flow, basis = _on_slice(leaf, fields, x)
    values, vectors = linear.eigh(flow.hessian)
    sizes = np.abs(values)
    return linear.matmul(linear.matmul(point.tangents, basis), vectors[:, sizes <= within * sizes.max(initial=0.0)])


def symmetry_directions(leaf: LeafInUnits, fields: HamiltonianFields, x: Array) -> Array:
    """Orthonormal directions in which the motions of the integrals carry x, shape (N, n)."""
    point, _, _ = _on_slice(leaf, fields, x)
    return linear.matmul(point.tangents, point.symmetry)


def curvatures(leaf: LeafInUnits, fields: HamiltonianFields, x: Array) -> Array:
    """The moduli of the eigenvalues of the second variation on the slice, relative to the largest, ascending."""
    values = np.sort(np.abs(linear.eigvalsh(_on_slice(leaf, fields, x)[1].hessian)))
    return values / values[-1] if values.any() else values


def _on_slice(leaf: LeafInUnits, fields: HamiltonianFields, x: Array) -> tuple[CriticalPoint, LinearFlow, Array]:
    """The linearised flow on the symplectic slice at x, and the basis of the slice in the tangent space."""
    rates, scale = fields.fields(x), fields.scale(x)
    point = CriticalPoint(fields, leaf, x, multipliers(rates[None], scale[None])[0])
    flow = point.linear_flow(np.array([1.0, *-point.omega]))[0]
    basis = flow.slice_basis(point.symmetry) if point.symmetry.size else np.eye(flow.size)
    return point, flow.restricted(basis), basis
