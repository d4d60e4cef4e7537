r"""Lie-Poisson brackets of g (x) A, $\{f, g\} = -\langle x, [df, dg] \rangle$."""

from __future__ import annotations

from functools import cached_property
from itertools import combinations, combinations_with_replacement, product
from typing import TYPE_CHECKING

from liepoisson.errors import BracketError, ParameterError
from liepoisson.exact.extension import Extension
from liepoisson.exact.lie_algebra import LieAlgebra
from liepoisson.exact.parameters import Column, is_zero, to_sympy

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr, Matrix, Symbol

    from liepoisson.exact.parameters import Exact


class Bracket:
    r"""The (minus) Lie-Poisson bracket on the dual of g (x) A.

    With $x_\lambda$ the field of the basis element $e_\lambda$ of A,

    $$\{f, g\} = -\sum_{\lambda\mu\nu} W_\lambda{}^{\mu\nu}\, \langle x_\lambda,
      [\partial_{x_\mu} f, \partial_{x_\nu} g] \rangle .$$

    Written `algebra @ extension`.  `so(3) @ leibniz(3, epsilon)` is the bracket of the twisted top,
    `so(3) @ semidirect(3)` that of the charged heavy top.

    Args:
        algebra: The Lie algebra g.
        extension: The commutative algebra A.

    Raises:
        BracketError: a coordinate and a parameter have the same name.
        ParameterError: `algebra` is not a LieAlgebra or `extension` not an Extension.

    References: Thiffeault and Morrison (2001), equations for the two brackets; Thiffeault and Morrison (2000).
    """

    def __init__(self, algebra: LieAlgebra, extension: Extension) -> None:
        _check_type(algebra, LieAlgebra, "algebra", "so(3)")
        _check_type(extension, Extension, "extension", "leibniz(3, epsilon)")
        self.algebra = algebra
        self.extension = extension
        names = self.coordinate_names
        if len(names) < self.dimension:
            raise BracketError(f"coordinates must have distinct names; got {sorted(names)}. Rename the fields.")
        self.check_parameter_names(self.symbols)

    @property
    def dimension(self) -> int:
        """Number of coordinates, dim g times dim A."""
        return self.algebra.dimension * self.extension.dimension

    @property
    def coordinate_names(self) -> set[str]:
        """Names of the coordinates; asking for them does not import SymPy."""
        return {f"{field}{base}" for field in self.extension.field_names for base in self.algebra.basis_names}

    def check_parameter_names(self, names: set[str]) -> None:
        """Refuse parameters that are named like a coordinate: a derivative would take one for the other.

        Raises:
            BracketError: there is such a name; the message lists them.
        """
        if clash := names & self.coordinate_names:
            raise BracketError(f"{sorted(clash)} name both coordinates and parameters; rename the parameters.")

    @property
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic."""
        return self.algebra.symbols | self.extension.symbols

    @cached_property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates, field by field: l1, l2, l3, alpha1, ..., beta3 for so(3) and three fields."""
        from sympy import Symbol

        return tuple(Symbol(f + b) for f, b in product(self.extension.field_names, self.algebra.basis_names))

    @property
    def fields(self) -> dict[str, Column]:
        """The coordinates as one column vector per field, by name."""
        from sympy import Matrix

        n = self.algebra.dimension
        blocks = (self.variables[i * n : (i + 1) * n] for i in range(self.extension.dimension))
        return {name: Matrix(block) for name, block in zip(self.extension.field_names, blocks, strict=True)}

    def poisson_tensor(self) -> Matrix:
        r"""The matrix $J_{ij}(x) = \{x_i, x_j\}$, linear in x, shape (N, N)."""
        return self._poisson_tensor.copy()

    def __call__(self, f: Expr, g: Expr) -> Expr:
        r"""The bracket $\{f, g\} = \nabla f \cdot J \nabla g$, expanded."""
        from sympy import S, expand

        return expand(sum((df * v for df, v in zip(self._gradient(f), self.vector_field(g), strict=True)), S.Zero))

    def vector_field(self, h: Expr) -> tuple[Expr, ...]:
        r"""The right-hand side of $\dot x = \{x, h\} = J \nabla h$, one expression per coordinate, expanded."""
        from sympy import S, expand

        dh = self._gradient(h)
        rows = self._poisson_tensor.tolist()
        return tuple(expand(sum((J * d for J, d in zip(row, dh, strict=True) if d != 0), S.Zero)) for row in rows)

    def jacobi_residuals(self) -> dict[tuple[Symbol, Symbol, Symbol], Expr]:
        r"""$\{\{x_i, x_j\}, x_k\}$ + cyclic for all i < j < k: zero throughout if this is a Poisson bracket."""
        from sympy import S

        x, J, N = self.variables, self._poisson_tensor.tolist(), self.dimension
        # J is linear: the derivative of J_ij along x_m is a constant, and {J_ij, x_k} = sum_m dJ_ij/dx_m J_mk.
        pairs = product(range(N), repeat=2)
        slopes = {(i, j): [(m, J[i][j].coeff(x[m])) for m in range(N) if J[i][j].has(x[m])] for i, j in pairs}

        def nested(i: int, j: int, k: int) -> Expr:
            return sum((slope * J[m][k] for m, slope in slopes[i, j]), S.Zero)

        return {
            (x[i], x[j], x[k]): (nested(i, j, k) + nested(j, k, i) + nested(k, i, j)).expand()
            for i, j, k in combinations(range(N), 3)
        }

    def casimirs(self) -> list[Expr]:
        r"""A basis of the Casimir invariants of degree one and two, derived from $J \nabla C = 0$ (exact nullspace).

        For `so(3) @ leibniz(3, epsilon)`: $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$, $|\beta|^2$.
        Symbolic parameters are taken as generic; Casimirs of higher degree, which other algebras have, are not found.
        """
        x = self.variables
        quadratic = [x[i] * x[j] for i, j in combinations_with_replacement(range(self.dimension), 2)]
        return self._null_combinations(list(x)) + self._null_combinations(quadratic)

    def substitute(self, values: Mapping[str, Exact]) -> Bracket:
        """The same bracket with values for some of its symbols."""
        algebra, extension = self.algebra.substitute(values), self.extension.substitute(values)
        unchanged = algebra is self.algebra and extension is self.extension
        return self if unchanged else Bracket(algebra, extension)

    def __repr__(self) -> str:
        return f"{self.algebra.name} ⊗ {self.extension.name}"

    @cached_property
    def _poisson_tensor(self) -> Matrix:
        from sympy import zeros

        n, x, c, W = self.algebra.dimension, self.variables, self.algebra.structure_constants, self.extension.tensor
        J = zeros(self.dimension, self.dimension)
        for mu, nu, lam in product(range(self.extension.dimension), repeat=3):
            if is_zero(W[lam][mu][nu]):
                continue
            for i, j, k in product(range(n), repeat=3):
                term = to_sympy(W[lam][mu][nu]) * to_sympy(c[i][j][k]) * x[lam * n + k]
                J[mu * n + i, nu * n + j] -= term
        return J

    def _gradient(self, f: Expr) -> list[Expr]:
        from sympy import SympifyError, sympify

        try:
            expression = sympify(f, strict=True)  # strict: numbers become SymPy numbers, a string is refused
        except SympifyError:
            raise ParameterError(
                f"a function on phase space must be a SymPy expression; got {f!r} of type {type(f).__name__}. "
                "Build it from bracket.variables."
            ) from None
        return [expression.diff(variable) for variable in self.variables]

    def _null_combinations(self, monomials: list[Expr]) -> list[Expr]:
        """Combinations C of the monomials with J grad C = 0, from the reduced echelon form of a sparse matrix."""
        from sympy import Poly, S
        from sympy.polys.matrices import DomainMatrix

        rows: dict[tuple[int, tuple[int, ...]], dict[int, Expr]] = {}
        for column, monomial in enumerate(monomials):
            for component, value in enumerate(self.vector_field(monomial)):
                for powers, coefficient in Poly(value, *self.variables).terms():
                    if coefficient != 0:
                        rows.setdefault((component, powers), {})[column] = coefficient
        if not rows:
            return list(monomials)
        matrix = DomainMatrix.from_dict_sympy(len(rows), len(monomials), dict(enumerate(rows.values())))
        vectors = matrix.to_field().nullspace(divide_last=True).to_Matrix().tolist()
        return [sum((v * m for v, m in zip(vector, monomials, strict=True)), S.Zero) for vector in vectors]


def _check_type(value: object, wanted: type, name: str, example: str) -> None:
    if not isinstance(value, wanted):
        raise ParameterError(
            f"{name} must be of type {wanted.__name__}; got one of type {type(value).__name__}. Try {example}."
        )
