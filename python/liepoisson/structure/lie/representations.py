r"""Representations of a Lie algebra by matrices, and its semidirect sums."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact
from liepoisson.errors import BracketError, ShapeError
from liepoisson.formula.tensors import read_names
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.structure.lie.sparse_matrices import add_multiple, commutator, entries_of, in_field, read_matrices
from liepoisson.structure.lie_algebra import LieAlgebra, joined_names


@explains_its_arguments
def semidirect_sum(
    algebra: LieAlgebra,
    representation: Sequence[object],
    name: str | None = None,
    module_names: Sequence[str] | None = None,
) -> LieAlgebra:
    r"""The semidirect sum $g \ltimes V$: $[e_i, v] = \rho_i v$, $[V, V] = 0$; the basis of g first.

    Example:
        >>> so3 = lp.so(3)
        >>> motions = lp.algebras.semidirect_sum(so3, so3.adjoint_representation())  # so(3) acts on vectors
        >>> motions.brackets == lp.algebras.se(3).brackets
        True

    Args:
        algebra: The Lie algebra g.
        representation: The matrices $\rho_i$ on V, exact, shape (dim g, dim V, dim V); complex ones act on the real
            space of twice the dimension, real parts first.
        name: How it is printed.
        module_names: Names of the basis of V; "v1", "v2", ... if left out.

    Raises:
        ShapeError: not one square matrix per basis element of g.
        BracketError: not a representation; the message names the pair $[\rho_i, \rho_j] \ne c_{ij}^k \rho_k$.
        ParameterError: an entry is not exact.
    """
    columns = read_representation(algebra, representation)
    n, m = algebra.dimension, len(columns[0])
    action = {
        (i, n + j): {n + k: c for k, c in column.items()}
        for i, rho in enumerate(columns)
        for j, column in enumerate(rho)
        if column
    }
    given = read_names(module_names, "module_names", tuple(f"v{j + 1}" for j in range(m)))
    names = joined_names(algebra.basis_names, given)
    sum_name = f"{algebra.name} ⋉ R^{m}" if name is None else name
    return LieAlgebra.from_brackets(n + m, {**algebra.brackets, **action}, sum_name, names, check=False)


def read_representation(algebra: LieAlgebra, matrices: Sequence[object]) -> list[list[dict[int, Exact]]]:
    r"""The columns of the matrices $\rho_i$, sparse, after a check that $[\rho_i, \rho_j] = c_{ij}^k \rho_k$.

    Raises:
        ShapeError: not one square matrix per basis element, all of one size.
        BracketError: not a representation; the message names the pair.
    """
    read, size = read_matrices(matrices, "representation")
    if len(read) != algebra.dimension:
        raise ShapeError(
            f"representation must be {algebra.dimension} matrices, one per basis element of {algebra.name}; "
            f"got {len(read)}."
        )
    constants = [c for row in algebra.brackets.values() for c in row.values()]
    field = Coefficients.containing([*constants, *entries_of(read)])
    basis = [in_field(matrix, field) for matrix in read]
    for i, j in combinations(range(algebra.dimension), 2):
        left = commutator(basis[i], basis[j], field)
        for k, c in algebra.brackets.get((i, j), {}).items():
            add_multiple(left, basis[k], -field.read(c))
        if any(not field.vanishes(value) for row in left.values() for value in row.values()):
            raise BracketError(
                f"representation must obey [rho_i, rho_j] = c_ij^k rho_k; it fails for (i, j) = ({i}, {j}). "
                "Check these two matrices and those of their bracket."
            )
    return [[{k: row[j] for k, row in matrix.items() if j in row} for j in range(size)] for matrix in read]
