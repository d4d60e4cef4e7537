r"""Lie algebras by their structure constants, $[e_i, e_j] = c_{ij}^k e_k$."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations, product
from typing import TYPE_CHECKING, TypeAlias

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.exact.parameters import Exact, Parameter, is_zero, listed, read_parameter, symbols_of, to_sympy

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.extension import Extension

Tensor3: TypeAlias = tuple[tuple[tuple[Exact, ...], ...], ...]


class LieAlgebra:
    r"""A finite-dimensional Lie algebra, $[e_i, e_j] = c_{ij}^k e_k$.

    Args:
        structure_constants: `c[i][j][k]`, exact, shape (n, n, n).
        name: How it is printed.
        basis_names: Names of $e_1, \dots, e_n$; "1", "2", ... if left out.
        check: Verify antisymmetry and the Jacobi identity.  Switch this off only to study what goes wrong.

    Raises:
        ShapeError: `structure_constants` is not n x n x n.
        BracketError: antisymmetry or the Jacobi identity fails; the message names the entry.
    """

    def __init__(
        self,
        structure_constants: Sequence[Sequence[Sequence[Parameter]]],
        name: str = "g",
        basis_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> None:
        self.structure_constants: Tensor3 = read_tensor(structure_constants, "structure_constants")
        self.name = name
        n = len(self.structure_constants)
        self.basis_names: tuple[str, ...] = read_names(basis_names, "basis_names", tuple(str(i + 1) for i in range(n)))
        if len(self.basis_names) != n:
            raise ShapeError(f"basis_names must be {n} names; got {len(self.basis_names)}. Give one per basis element.")
        if check:
            _check_antisymmetry(self.structure_constants)
            _check_jacobi(self.structure_constants)

    @property
    def dimension(self) -> int:
        """The dimension n."""
        return len(self.structure_constants)

    @property
    def symbols(self) -> set[str]:
        """Names of the free symbols in the structure constants."""
        return tensor_symbols(self.structure_constants)

    def substitute(self, values: Mapping[str, Exact]) -> LieAlgebra:
        """The same algebra with values for some of its symbols."""
        if not self.symbols & set(values):
            return self
        constants = substitute_in_tensor(self.structure_constants, values)
        return LieAlgebra(constants, self.name, self.basis_names, check=False)

    def __matmul__(self, extension: Extension) -> Bracket:
        """The Lie-Poisson bracket of g (x) A."""
        from liepoisson.exact.bracket import Bracket

        return Bracket(self, extension)

    def __repr__(self) -> str:
        return self.name


def so(n: int) -> LieAlgebra:
    r"""The Lie algebra of rotations, for n = 3: $[e_i, e_j] = \varepsilon_{ijk} e_k$, the cross product.

    Raises:
        ParameterError: n is not 3.
    """
    if n != 3:
        raise ParameterError(
            f"so(n) is available for n = 3; got n = {n}. Use LieAlgebra with your structure constants."
        )
    levi_civita = [[[(i - j) * (j - k) * (k - i) // 2 for k in range(3)] for j in range(3)] for i in range(3)]
    return LieAlgebra(levi_civita, name="so(3)")


def read_tensor(entries: Sequence[Sequence[Sequence[Parameter]]], name: str) -> Tensor3:
    """Read an n x n x n tensor of exact entries; all of them become SymPy expressions as soon as one is.

    Raises:
        ShapeError: the tensor is not n x n x n.
        ParameterError: an entry is not exact.
    """
    planes = _items(entries)
    n = len(planes or ())
    rows = [row for plane in planes or () for row in _items(plane) or (None,)]
    if n == 0 or len(rows) != n * n or any(len(_items(row) or ()) != n for row in rows):
        got = f"its first axis has length {n}" if planes else f"got {type(entries).__name__}"
        raise ShapeError(f"{name} must have shape (n, n, n); {got}. Make every axis that long.")
    read = tuple(
        tuple(tuple(read_parameter(v, f"{name}[{i}][{j}][{k}]") for k, v in enumerate(row)) for j, row in enumerate(p))
        for i, p in enumerate(entries)
    )
    if all(isinstance(read[i][j][k], Fraction) for i, j, k in product(range(n), repeat=3)):
        return read
    # Fraction and SymPy numbers do not mix under multiplication.
    return tuple(tuple(tuple(to_sympy(value) for value in row) for row in plane) for plane in read)


def _items(values: object) -> list[object] | None:
    return None if isinstance(values, str) else listed(values)


def read_names(names: Sequence[str] | None, name: str, default: tuple[str, ...]) -> tuple[str, ...]:
    """Read a sequence of names, or take the default ones.

    Raises:
        ShapeError: not a sequence of strings.
    """
    if names is None:
        return default
    given = listed(names)
    if given is None or isinstance(names, str) or not all(isinstance(item, str) for item in given):
        raise ShapeError(f"{name} must be a sequence of names; got {names!r}. Write for example {name}={default!r}.")
    return tuple(str(item) for item in given)


def tensor_symbols(tensor: Tensor3) -> set[str]:
    """Names of the free symbols in the entries."""
    return {name for plane in tensor for row in plane for value in row for name in symbols_of(value)}


def substitute_in_tensor(tensor: Tensor3, values: Mapping[str, Exact]) -> list[list[list[Expr]]]:
    """The tensor with values for some symbols, as SymPy expressions."""
    from sympy import Symbol

    pairs = [(Symbol(name), to_sympy(value)) for name, value in values.items()]
    return [[[to_sympy(value).subs(pairs) for value in row] for row in plane] for plane in tensor]


def _check_antisymmetry(c: Tensor3) -> None:
    n = len(c)
    for i, j, k in product(range(n), repeat=3):
        if not is_zero(c[i][j][k] + c[j][i][k]):
            raise BracketError(
                f"structure constants must be antisymmetric, c[i][j][k] = -c[j][i][k]; got c[{i}][{j}][{k}] = "
                f"{c[i][j][k]} and c[{j}][{i}][{k}] = {c[j][i][k]}. Correct one of the two."
            )


def _check_jacobi(c: Tensor3) -> None:
    n = len(c)
    zero = c[0][0][0]  # zero by antisymmetry, of the right type
    for (i, j, k), m in product(combinations(range(n), 3), range(n)):
        cyclic = ((i, j, k), (j, k, i), (k, i, j))
        residual = sum((c[p][q][s] * c[s][r][m] for p, q, r in cyclic for s in range(n)), zero)
        if not is_zero(residual):
            raise BracketError(
                f"structure constants must obey the Jacobi identity; for (i, j, k) = ({i}, {j}, {k}) the cyclic sum of "
                f"[[e_i, e_j], e_k] has component {residual} along e_{m} instead of 0. Check the entries c[.][.][.]."
            )
