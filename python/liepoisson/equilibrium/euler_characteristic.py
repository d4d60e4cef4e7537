r"""The Euler characteristic of a leaf on which H is proper, where it is known.

If H is proper on a leaf, bounded below or above, and all its critical points on it are nondegenerate, the sum of
$(-1)^{\rm index}$ over them is the Euler characteristic of the leaf; the index is the number of negative eigenvalues of
the second variation. A critical set counts with its own Euler characteristic: a circle 0, a sphere 2. Leaves have
even dimension, so it does not matter whether H or -H is bounded below.

- A compact semisimple algebra: the orbit of x is compact and its Euler characteristic the number of points in which
  it meets a Cartan subalgebra, $|W|/|W_x|$, with the Weyl groups of the algebra and of the stabiliser of x.
  $|W| = \prod_{\alpha>0}({\rm ht}\,\alpha+1)/{\rm ht}\,\alpha$.
- Tops: see `liepoisson.equilibrium.top_equilibria`.
- se(3)* in the form so(3) @ semidirect(2): a leaf with $\alpha\ne0$ is like $T^*S^2$, 2, and with $\alpha=0$ a sphere,
  2; H is proper if it has degree two and is definite in l.

References: [milnor1963], for the sum; [humphreys1990], for the Weyl groups.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.algebra.exact_numbers import as_float
from liepoisson.equilibrium.heavy_equilibria import exact_top
from liepoisson.equilibrium.linearisation import definite_sign
from liepoisson.equilibrium.top_equilibria import euler_characteristic_of_leaf
from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear
from liepoisson.streams import generator

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

_ZERO = 1e-9
"""Numbers below this fraction of the largest count as zero."""


def euler_characteristic(leaf: Leaf) -> int | None:
    """That of the leaf, if it is known and H is known to be proper on it; else None."""
    if leaf.rank == 0:
        return 1
    system = leaf.system
    top = exact_top(system)
    if top is not None:
        return euler_characteristic_of_leaf(leaf, top)
    if not system.bracket.has_algebra:
        return None
    if system.bracket.extension.dimension == 1:
        moved = _without_constant_part(system, leaf.state)
        return None if moved is None else _of_orbit(system, moved)
    if system.bracket.constant:
        return None
    return 2 if leaf.place.is_known and _is_euclidean(system) and _is_definite(system) else None


def _without_constant_part(system: System, x: Array) -> Array | None:
    """The state in coordinates in which the bracket is linear; None if there are none."""
    if not system.bracket.constant:
        return x
    xi = system.bracket.coboundary()
    return None if xi is None else x + np.array([as_float(value, "xi") for value in xi])


def _of_orbit(system: System, x: Array) -> int | None:
    tensor = system.functions.poisson_tensor
    constants = tensor(np.eye(len(x)))  # [m, i, j]: the component of [e_i, e_j] along e_m
    if system.bracket.constant:
        constants = constants - tensor(np.zeros(len(x)))
    adjoint = np.transpose(constants, (1, 0, 2))  # [i]: the matrix of ad e_i
    killing = linear.einsum("iab,jba->ij", adjoint, adjoint)
    if definite_sign(killing) >= 0:
        return None
    element = linear.solve(killing, x)
    positive = _positive_roots(adjoint, killing, element)
    values = np.array([linear.matmul(root, coordinates) for root, coordinates in positive])
    roots = np.array([root for root, _ in positive])
    still = np.abs(values) <= _ZERO * np.abs(values).max(initial=0.0)
    return round(_weyl_order(roots) / _weyl_order(roots[still]))


def _positive_roots(adjoint: Array, killing: Array, element: Array) -> list[tuple[Array, Array]]:
    """Positive roots in an orthonormal basis of a Cartan subalgebra that contains the element, with its coordinates."""
    rng = generator(0)
    stabiliser = _kernel(linear.tensordot(element, adjoint, axes=1))
    generic = linear.matmul(stabiliser, rng.standard_normal(stabiliser.shape[1]))
    cartan = _kernel(linear.tensordot(generic, adjoint, axes=1))
    factor = linear.cholesky(linear.matmul(linear.matmul(-cartan.T, killing), cartan))
    cartan = linear.matmul(cartan, linear.inv(factor).T)
    values, vectors = linear.eig(linear.tensordot(generic, adjoint, axes=1))
    coordinates = linear.matmul(linear.matmul(-cartan.T, killing), element)
    found: list[tuple[Array, Array]] = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag > _ZERO * np.abs(values).max():
            actions = linear.einsum("ik,iab,b->ka", cartan, adjoint, vector)
            found.append((linear.matmul(actions, vector.conj()).imag, coordinates))
    return found


def _kernel(matrix: Any) -> Array:
    _, sizes, rows = linear.svd(matrix)
    return rows[sizes <= _ZERO * sizes[0]].T if sizes[0] > 0 else np.eye(len(matrix))


def _weyl_order(positive: Array) -> float:
    """The order of the Weyl group, from its positive roots (each scaled arbitrarily by the same rule)."""
    if not len(positive):
        return 1.0
    heights = (linear.matmul(positive, positive.T) / np.sum(positive**2, axis=1)).sum(axis=1)
    return float(np.prod((heights + 1) / heights))


def _is_euclidean(system: System) -> bool:
    from liepoisson.structure.extensions import semidirect
    from liepoisson.structure.lie_algebras import so

    return set((so(3) @ semidirect(2)).entries()) == set(system.bracket.entries())


def _is_definite(system: System) -> bool:
    """Whether H is a polynomial of degree two, definite in the first field."""
    from sympy import Poly

    hamiltonian, variables = system.hamiltonian, system.variables
    if not hamiltonian.is_polynomial(*variables) or Poly(hamiltonian, *variables).total_degree() > 2:
        return False
    return definite_sign(system.functions.energy.hessian(np.zeros(len(variables)))[:3, :3]) != 0
