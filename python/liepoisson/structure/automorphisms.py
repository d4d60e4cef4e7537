r"""Linear symmetries of brackets that act on the fields: maps of the algebra A.

A linear map $x_\mu \mapsto \sum_\nu P_{\mu\nu} x_\nu$ of fields takes the bracket of g (x) A to that of g (x) A' if and
only if (unless g is abelian; a constant part must be taken to that of the other besides)

$$\sum_{\alpha\beta} P_{\mu\alpha} P_{\nu\beta} W_\lambda{}^{\alpha\beta}
  = \sum_\kappa W'_\kappa{}^{\mu\nu} P_{\kappa\lambda} .$$

For the twisted top these are $\alpha \mapsto \alpha + d\beta$, and $\alpha \mapsto s\alpha$,
$\beta \mapsto u\beta$, which takes epsilon to $\epsilon s^2/u$.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import ExactMatrix, is_zero, to_sympy
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, listed_rows, read_parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import listed
from liepoisson.structure.derivations import arrows, products

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.extension import Extension


@explains_its_methods
class Automorphism:
    """A linear map of the fields, the same for all components.

    Example:
        >>> bracket = lp.so(3) @ lp.semidirect(3)
        >>> swap = lp.brackets.Automorphism([[1, 0, 0], [0, 0, 1], [0, 1, 0]])
        >>> swap.describe(bracket), swap.is_poisson(bracket), swap.is_poisson(lp.so(3) @ lp.leibniz(3))
        ('alpha -> beta, beta -> alpha', True, False)

    Args:
        matrix: P, exact, shape (n, n): field mu goes to the sum of P[mu][nu] times field nu.

    Raises:
        ShapeError: the matrix is not square.
        ParameterError: an entry is not exact.
    """

    def __init__(self, matrix: Sequence[Sequence[Parameter]]) -> None:
        rows = [listed(row, "matrix") for row in listed_rows(matrix, "matrix") or []]
        if not rows or any(row is None or len(row) != len(rows) for row in rows):
            raise ShapeError(f"matrix must have shape (n, n), one row per field; got {matrix!r}.")
        self.matrix: ExactMatrix = tuple(
            tuple(read_parameter(value, f"matrix[{i}][{j}]") for j, value in enumerate(row or []))
            for i, row in enumerate(rows)
        )

    def __repr__(self) -> str:
        rows = ", ".join(f"[{', '.join(map(str, row))}]" for row in self.matrix)
        return f"Automorphism([{rows}])"

    def is_poisson(self, source: Bracket, target: Bracket | None = None) -> bool:
        """Whether this takes the bracket of the source to that of the target, decided entry by entry of W.

        Args:
            source: Bracket of the states that are mapped.
            target: Bracket of their images; that of the source if left out.

        Raises:
            ParameterError: the two have different Lie algebras.
            ShapeError: the matrix does not have one row per field.
        """
        image = source if target is None else target
        self._check(source)
        self._check(image)
        if source.algebra is not image.algebra and source.algebra.brackets != image.algebra.brackets:
            raise ParameterError(
                f"both brackets must have the same Lie algebra; got {source.algebra!r} and {image.algebra!r}."
            )
        if not self._keeps_constant_parts(source, image):
            return False
        return not source.algebra.brackets or not any(self.residuals(source.extension, image.extension).values())

    def _keeps_constant_parts(self, source: Bracket, target: Bracket) -> bool:
        """Whether the constant part of the one becomes that of the other."""
        if not source.constant and not target.constant:
            return True
        from sympy import Add

        P, n = [[to_sympy(value) for value in row] for row in self.matrix], source.algebra.dimension
        sums: dict[tuple[int, int], list[Any]] = {}
        for (a, i), (b, j), c in source.constants_of_fields:
            for mu, nu in product(range(len(P)), repeat=2):
                sums.setdefault((mu * n + i, nu * n + j), []).append(P[mu][a] * P[nu][b] * to_sympy(c))
        for (mu, i), (nu, j), c in target.constants_of_fields:
            sums.setdefault((mu * n + i, nu * n + j), []).append(-to_sympy(c))
        return all(is_zero(Add(*terms)) for terms in sums.values())

    def residuals(self, source: Extension, target: Extension) -> dict[tuple[int, int, int], Expr]:
        """The difference of the two sides of the condition, by (lam, mu, nu); zero for a homomorphism."""
        from sympy import Add, simplify

        P = [[to_sympy(value) for value in row] for row in self.matrix]
        first = [(a, b, k, to_sympy(w)) for a, b, k, w in products(source)]
        second = [(m, v, k, to_sympy(w)) for m, v, k, w in products(target)]
        n = range(len(P))
        return {
            (lam, mu, nu): simplify(
                Add(
                    *(P[mu][a] * P[nu][b] * w for a, b, k, w in first if k == lam),
                    *(-w * P[k][lam] for m, v, k, w in second if (m, v) == (mu, nu)),
                )
            )
            for lam, mu, nu in product(n, repeat=3)
        }

    def apply(self, expression: Expr, bracket: Bracket) -> Expr:
        """The function after the map: every field replaced by its image.

        Args:
            expression: A function of `bracket.variables`.
            bracket: Says which coordinates make up the fields.

        Raises:
            ParameterError: it is no expression, or has a part that is like a coordinate and none.
        """
        from liepoisson.structure.coordinates import read_function

        self._check(bracket)
        fields: list[Any] = list(bracket.fields.values())
        images: list[Any] = [
            sum((to_sympy(p) * f for p, f in zip(row, fields, strict=True)), 0 * fields[0]) for row in self.matrix
        ]
        flat = [component for image in images for component in image]
        function: Any = read_function(bracket, expression, "expression")
        image: Any = function.subs(dict(zip(bracket.variables, flat, strict=True)), simultaneous=True)
        return image

    def describe(self, bracket: Bracket) -> str:
        """The map in words, for example "alpha -> alpha + d*beta"."""
        return arrows(bracket.field_names, [[to_sympy(value) for value in row] for row in self.matrix])

    def _check(self, bracket: Bracket) -> None:
        if len(self.matrix) != bracket.extension.dimension:
            raise ShapeError(f"matrix must have {bracket.extension.dimension} rows; got {len(self.matrix)}.")
