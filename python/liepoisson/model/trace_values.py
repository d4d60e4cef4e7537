r"""Sums of traces as functions of arrays, with gradients and second derivatives by products of matrices.

$\partial \operatorname{tr}(X_1 \cdots X_k)/\partial x_i$ is the sum of
$\operatorname{tr}(X_{s+1} \cdots X_{s-1} F^i)$ over the places s of the letter that $x_i$ belongs to: one product of
matrices for all coordinates of a field.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear
from liepoisson.structure.trace_words import Word, chain, rotations

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.trace import MatrixMap, Trace


@dataclass(frozen=True)
class TraceTerm:
    """A number times the trace of a word in the matrices of some coordinates.

    Attributes:
        weight: The number, divided by the copies of the matrices.
        matrices: The map to matrices.
        word: Letters; negative ones stand for constant matrices.
        places: For each letter from 0 the coordinates that its matrix is made of, shape (letter, dimension).
    """

    weight: float
    matrices: MatrixMap
    word: Word
    places: Any

    @classmethod
    def of(cls, weight: float, trace: Trace, variables: Sequence[Any]) -> TraceTerm:
        """The term of a trace whose coordinates are among the variables."""
        index = {variable: k for k, variable in enumerate(variables)}
        places = np.array([index[c] for c in trace.coordinates], dtype=np.intp)
        return cls(
            weight / trace.matrices.data.copies,
            trace.matrices,
            trace.word,
            places.reshape(-1, trace.matrices.dimension),
        )

    def factors(self, x: Array) -> dict[int, Any]:
        """The matrix of each letter, shape (..., row, column)."""
        F, m = self.matrices, self.matrices.data.size
        return {
            f: F.matrix(x[..., self.places[f]]) if f >= 0 else np.broadcast_to(F.arrays[-1 - f], (*x.shape[:-1], m, m))
            for f in set(self.word)
        }

    def value(self, x: Array) -> Array:
        """The value, shape (...)."""
        factors = self.factors(x)
        if len(self.word) == 1:
            return self.weight * linear.einsum("...ii->...", factors[self.word[0]]).real
        first = chain(self.word[:-1], factors, linear.matmul)
        return self.weight * linear.einsum("...ij,...ji->...", first, factors[self.word[-1]]).real

    def add_gradient(self, x: Array, total: Array) -> None:
        """Add the gradient to an array of shape (..., N)."""
        factors = self.factors(x)
        turned = rotations(self.word)
        weight = self.weight * len(self.word) / len(turned)
        for turn in turned:
            if turn[-1] >= 0:
                product = self._product(turn[:-1], factors, x)
                total[..., self.places[turn[-1]]] += weight * self._against(product)

    def add_hessian(self, x: Array, total: Array) -> None:
        """Add the second derivatives to an array of shape (..., N, N)."""
        factors = self.factors(x)
        turned = rotations(self.word)
        weight = self.weight * len(self.word) / len(turned)
        F, m, d = self.matrices.arrays, self.matrices.data.size, self.matrices.dimension
        for turn in turned:
            for s in range(len(turn) - 1):
                if turn[-1] < 0 or turn[s] < 0:
                    continue
                # tr(L F^j R F^i) = sum_ab (F^i L)_ab (F^j R)_ba
                left = linear.matmul(F, self._product(turn[:s], factors, x)[..., None, :, :])
                right = linear.matmul(F, self._product(turn[s + 1 : -1], factors, x)[..., None, :, :])
                flat = left.reshape(*left.shape[:-2], m * m)
                turned_right = np.swapaxes(right, -1, -2).reshape(*right.shape[:-2], m * m)
                block = linear.matmul(flat, np.swapaxes(turned_right, -1, -2)).real
                rows, columns = self.places[turn[-1]], self.places[turn[s]]
                total[..., rows[:, None], columns[None, :]] += weight * block.reshape(*x.shape[:-1], d, d)

    def _product(self, word: Word, factors: dict[int, Any], x: Array) -> Any:
        m = self.matrices.data.size
        return chain(word, factors, linear.matmul) if word else np.broadcast_to(np.eye(m), (*x.shape[:-1], m, m))

    def _against(self, product: Any) -> Array:
        """The tr(P F^i), shape (..., dimension)."""
        m = self.matrices.data.size
        transposed = np.swapaxes(product, -1, -2).reshape(*product.shape[:-2], m * m)
        return linear.matmul(transposed, self.matrices.arrays.reshape(-1, m * m).T).real


class TraceSum:
    """A linear combination of traces plus a function without traces.

    Args:
        terms: The traces with their weights.
        rest: The function without traces; zero if there is none.
        variables: All coordinates.
    """

    def __init__(self, terms: Sequence[TraceTerm], rest: Expr, variables: Sequence[Any]) -> None:
        self.terms, self._rest, self._variables = tuple(terms), rest, tuple(variables)

    @classmethod
    def of(cls, expression: Expr, variables: Sequence[Any]) -> TraceSum | None:
        """The parts of a linear combination with numbers; None for anything else, and where there is no trace."""
        from sympy import Add, S

        from liepoisson.structure.trace import Trace, traces_in

        if not traces_in(expression):
            return None
        known, terms, rest = set(variables), list[TraceTerm](), S.Zero
        for part in Add.make_args(expression):
            weight, factor = part.as_independent(*variables, as_Add=False)
            if isinstance(factor, Trace) and weight.is_number and known.issuperset(factor.coordinates):
                terms.append(TraceTerm.of(float(weight), factor, variables))
            elif traces_in(part):
                return None
            else:
                rest += part
        return cls(terms, rest, variables)

    def value(self, x: Array) -> Array:
        """Values, shape (...), at states of shape (..., N)."""
        return sum((term.value(x) for term in self.terms), self._of_rest(0, x))

    def gradient(self, x: Array) -> Array:
        """Gradients, shape (..., N)."""
        total = self._of_rest(1, x)
        for term in self.terms:
            term.add_gradient(x, total)
        return total

    def hessian(self, x: Array) -> Array:
        """Second derivatives, shape (..., N, N)."""
        total = self._of_rest(2, x)
        for term in self.terms:
            term.add_hessian(x, total)
        return total

    def _of_rest(self, order: int, x: Array) -> Array:
        from liepoisson.compile.symbols import evaluated

        n = len(self._variables)
        shape = (*x.shape[:-1], *(n,) * order)
        if self._rest == 0:
            return np.zeros(shape)
        return evaluated(self._variables, self._derivatives_of_rest[order], x).reshape(shape).copy()

    @cached_property
    def _derivatives_of_rest(self) -> tuple[tuple[Expr, ...], ...]:
        """The part without traces, its first and its second derivatives."""
        slopes = [self._rest.diff(v) for v in self._variables]
        return (self._rest,), tuple(slopes), tuple(slope.diff(v) for slope in slopes for v in self._variables)
