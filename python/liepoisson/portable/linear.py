r"""Linear algebra of small dense matrices in a fixed order: the same bits on every processor.

The functions have the names and the conventions of `numpy.linalg`.  BLAS and LAPACK sum in an order of their own on
each kind of processor, so a start that went through them is another one there, and chaos does the rest.  Here sums run
over the components in their order, and nothing is fused (`crates/liepoisson-core/src/linear/`).  Singular values and
symmetric eigenvalues are found by Jacobi's method, general eigenvalues by Francis's.

Arrays are stacks of matrices, shape (..., n, m).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.portable.elementary import of_parts

__all__ = [
    "LinAlgError",
    "cholesky",
    "cond",
    "cov",
    "det",
    "eig",
    "eigh",
    "eigvals",
    "eigvalsh",
    "einsum",
    "fft",
    "inv",
    "lstsq",
    "matmul",
    "norm",
    "pinv",
    "poly",
    "qr",
    "roots",
    "slogdet",
    "solve",
    "svd",
    "tensordot",
    "times",
]

Array = NDArray[np.float64]


class SVD(NamedTuple):
    """A = U diag(S) Vh."""

    U: Any
    S: Array
    Vh: Any


class Eigen(NamedTuple):
    """Eigenvalues, and eigenvectors as columns."""

    eigenvalues: Any
    eigenvectors: Any


class SignAndLogarithm(NamedTuple):
    """Of a determinant."""

    sign: Array
    logabsdet: Array


class QR(NamedTuple):
    """A = Q R, the diagonal of R not negative."""

    Q: Array
    R: Array


def matmul(a: Any, b: Any) -> Any:
    r"""Products $\sum_k a_{ik} b_{kj}$ of stacks of matrices, or vectors, as `a @ b` has them."""
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype.kind == "c" or b.dtype.kind == "c":
        real = np.asarray(matmul(a.real, b.real)) - matmul(a.imag, b.imag)
        return of_parts(real, np.asarray(matmul(a.real, b.imag)) + matmul(a.imag, b.real))
    row, column = a.ndim == 1, b.ndim == 1
    if row:
        a = a[None, :]
    if column:
        b = b[:, None]
    if a.ndim < 2 or b.ndim < 2 or a.shape[-1] != b.shape[-2]:
        raise ValueError(f"shapes {a.shape} and {b.shape} have no product")
    stack = a.shape[:-2] if a.shape[:-2] == b.shape[:-2] else np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    count = math.prod(stack)
    n, m, p = *a.shape[-2:], b.shape[-1]
    if b.ndim == 2 and a.ndim > 2:  # one matrix from the right is the same for all rows
        values = _core.products(_flat(a), _flat(b), 1, (count * n, m, p))
    else:
        values = _core.products(_stacked(a, stack), _stacked(b, stack), count, (n, m, p))
    shape = (*stack, *(() if row else (n,)), *(() if column else (p,)))
    return values.reshape(shape) if shape else float(values[0])


def times(a: Any, b: Any) -> Any:
    """Products of complex numbers, one by one: NumPy fuses their sums on some processors."""
    a, b = _arrays(a, b)
    return of_parts(a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real)


def tensordot(a: Any, b: Any, axes: int = 1) -> Any:
    """Products summed over the last axis of `a` and the first one of `b`."""
    a, b = _arrays(a, b)
    assert axes == 1
    product = np.asarray(matmul(a.reshape(-1, a.shape[-1]), b.reshape(b.shape[0], -1)))
    return product.reshape((*a.shape[:-1], *b.shape[1:]))[()]


def einsum(subscripts: str, *operands: Any) -> Any:
    """Sums of products by Einstein's convention, as NumPy has it; the result's indices are given after the arrow."""
    if len(operands) == 2:
        a, b = map(np.asarray, operands)
        if (order := _order_of_product(subscripts, a.ndim, b.ndim)) is not None:
            return order.product(a, b)
    inputs, output = subscripts.replace(" ", "").split("->")
    many = any(term.count(letter) > 2 for term in inputs.split(",") for letter in term if letter != ".")
    if many or output.rfind("...") > 0:
        raise ValueError(f"{subscripts}: wanted an ellipsis that comes first, and a letter twice in a term at most")
    pairs = [_ellipsis_first(*pair) for pair in zip(inputs.split(","), map(np.asarray, operands), strict=True)]
    terms, arrays = [term for term, _ in pairs], [array for _, array in pairs]
    term, value = terms[0], arrays[0]
    for k, (other, array) in enumerate(zip(terms[1:], arrays[1:], strict=True), start=2):
        wanted = set(output).union(*terms[k:])
        term, value = _pair(term, value, other, array, wanted)
    term, value = _diagonals(term, value)
    return _arranged(term, value, output)


class _Order(NamedTuple):
    """How the axes of two factors are put so that a product of stacks of matrices is their sum of products.

    The axes of an ellipsis come first, in the factors and in the result, and are aligned from the right.
    """

    first: tuple[int, ...]
    second: tuple[int, ...]
    result: tuple[int, ...]
    heads: tuple[int, int]
    """Axes of the stack in either factor: those of its ellipsis, and of letters that are in both and in the result."""
    n_summed: int

    def product(self, a: NDArray[Any], b: NDArray[Any]) -> Any:
        a, b = a.transpose(self.first), b.transpose(self.second)
        here, there = self.heads
        split = a.ndim - self.n_summed
        rows, inner, columns = a.shape[here:split], a.shape[split:], b.shape[there + self.n_summed :]
        found = matmul(
            a.reshape(*a.shape[:here], math.prod(rows), math.prod(inner)),
            b.reshape(*b.shape[:there], math.prod(inner), math.prod(columns)),
        )
        return found.reshape((*found.shape[:-2], *rows, *columns)).transpose(self.result)[()]


@lru_cache(maxsize=256)
def _order_of_product(subscripts: str, n_first: int, n_second: int) -> _Order | None:
    """The order of two factors of so many axes, whose letters each are wanted or in both; None of others."""
    inputs, output = subscripts.replace(" ", "").split("->")
    terms = [*inputs.split(","), output]
    one, other, wanted = (term.removeprefix("...") for term in terms)
    stacked = (n_first - len(one) if terms[0] != one else 0, n_second - len(other) if terms[1] != other else 0)
    letters = one + other
    if (
        "." in letters + wanted
        or (terms[0] != one or terms[1] != other) != (output != wanted)
        or not output
        or (n_first, n_second) != (stacked[0] + len(one), stacked[1] + len(other))
        or min(stacked) < 0
        or any(term.count(letter) > 1 for term in (one, other, wanted) for letter in term)
        or any(letter not in letters for letter in wanted)
        or any(letter not in wanted for letter in letters if letters.count(letter) == 1)
    ):
        return None
    kept, summed = [x for x in one if x in other and x in wanted], [x for x in one if x in other and x not in wanted]
    mine, yours = [x for x in one if x not in other], [x for x in other if x not in one]
    here, above = [*kept, *mine, *yours], max(stacked)

    def placed(n: int, letters: str | list[str], order: str | list[str]) -> tuple[int, ...]:
        return (*range(n), *(n + letters.index(x) for x in order))

    return _Order(
        placed(stacked[0], one, [*kept, *mine, *summed]),
        placed(stacked[1], other, [*kept, *summed, *yours]),
        placed(above, here, wanted),
        (stacked[0] + len(kept), stacked[1] + len(kept)),
        len(summed),
    )


def _ellipsis_first(term: str, value: NDArray[Any]) -> tuple[str, NDArray[Any]]:
    before, found, _ = term.partition("...")
    if not found or not before:
        return term, value
    n = len(before)
    return "..." + term.replace("...", ""), np.moveaxis(value, range(n), range(-len(term) + 3, -len(term) + 3 + n))


def _diagonals(term: str, value: NDArray[Any]) -> tuple[str, NDArray[Any]]:
    """A letter that occurs twice stands for a diagonal."""
    letters = term.replace("...", "")
    for letter in dict.fromkeys(letters):
        while letters.count(letter) > 1:
            first = letters.index(letter) - len(letters)
            second = letters.index(letter, letters.index(letter) + 1) - len(letters)
            value = np.diagonal(value, axis1=first, axis2=second)
            letters = letters.replace(letter, "") + letter
    return ("..." if "..." in term else "") + letters, value


def _arranged(term: str, value: NDArray[Any], output: str) -> Any:
    """Sums what the output lacks, and brings the others to its order."""
    letters, wanted = term.replace("...", ""), output.replace("...", "")
    for letter in [letter for letter in letters if letter not in wanted]:
        value = value.sum(axis=letters.index(letter) - len(letters))
        letters = letters.replace(letter, "")
    n, stacked = len(letters), np.ndim(value) - len(letters)
    if not n:
        return np.asarray(value)[()]
    order = [*range(stacked), *(stacked + letters.index(letter) for letter in wanted)]
    return np.transpose(value, order)


def _pair(one: str, a: NDArray[Any], other: str, b: NDArray[Any], wanted: set[str]) -> tuple[str, NDArray[Any]]:
    """The product of two factors, summed over the letters that nobody wants any more."""
    (one, a), (other, b) = _diagonals(one, a), _diagonals(other, b)
    left, right = one.replace("...", ""), other.replace("...", "")
    for letters, side in ((left, 0), (right, 1)):  # letters of one factor alone that nobody wants
        for letter in [x for x in letters if x not in wanted and x not in (right, left)[side]]:
            if side == 0:
                a, left = a.sum(axis=left.index(letter) - len(left)), left.replace(letter, "")
            else:
                b, right = b.sum(axis=right.index(letter) - len(right)), right.replace(letter, "")
    both = [letter for letter in left if letter in right]
    kept, summed = [x for x in both if x in wanted], [x for x in both if x not in wanted]
    mine, yours = [x for x in left if x not in right], [x for x in right if x not in left]
    sizes = {letter: a.shape[left.index(letter) - len(left)] for letter in left}
    sizes |= {letter: b.shape[right.index(letter) - len(right)] for letter in right}

    def matrix(array: NDArray[Any], letters: str, order: list[str], split: int) -> NDArray[Any]:
        stacked = array.ndim - len(letters)
        moved = np.transpose(array, [*range(stacked), *(stacked + letters.index(letter) for letter in order)])
        heads = [sizes[x] for x in order[: len(kept)]]
        rows = math.prod(sizes[x] for x in order[len(kept) : split])
        columns = math.prod(sizes[x] for x in order[split:])
        # the axes of the ellipsis of either side come first, aligned from the right
        return moved.reshape(*moved.shape[:stacked], *heads, rows, columns)

    first = matrix(a, left, [*kept, *mine, *summed], len(kept) + len(mine))
    second = matrix(b, right, [*kept, *summed, *yours], len(kept) + len(summed))
    product = np.asarray(matmul(first, second))
    stacked = product.ndim - len(kept) - 2
    shape = [sizes[x] for x in (*kept, *mine, *yours)]
    product = product.reshape((*product.shape[:stacked], *shape))
    return ("..." if stacked else "") + "".join((*kept, *mine, *yours)), product


def norm(x: Any, ord: int | None = None, axis: int | tuple[int, ...] | None = None, keepdims: bool = False) -> Any:
    """Lengths of vectors, or of all numbers; with `ord=2` and two axes, or a matrix, the largest singular value."""
    x = np.asarray(x)
    x = x if np.iscomplexobj(x) else x.astype(np.float64, copy=False)
    if ord not in (None, 2):
        raise ValueError(f"ord: wanted None or 2; got {ord}")
    if ord == 2 and (isinstance(axis, tuple) or (axis is None and x.ndim == 2)):
        matrices = x if axis is None else np.moveaxis(x, axis, (-2, -1))
        found = svd(matrices, compute_uv=False).max(axis=-1, initial=0.0)
        return found[..., None, None] if keepdims else found
    squares = x.real * x.real + x.imag * x.imag if np.iscomplexobj(x) else x * x
    if axis is None and not keepdims:
        squares, axis = squares.ravel(), 0
    return np.sqrt(np.add.reduce(squares, axis=axis, keepdims=keepdims))


def svd(a: Any, full_matrices: bool = True, compute_uv: bool = True) -> Any:
    """Singular values, falling, and vectors.

    Raises:
        LinAlgError: an entry is not finite.
    """
    if np.iscomplexobj(a) and not compute_uv:
        return svd(_doubled(a), compute_uv=False)[..., ::2]
    a = _real(a)
    if not np.isfinite(a).all():
        raise LinAlgError("SVD did not converge")
    n, m = a.shape[-2:]
    wide = n < m
    tall = np.swapaxes(a, -1, -2) if wide else a
    stack, (n, m) = a.shape[:-2], tall.shape[-2:]
    left, values, right = _core.singular(_flat(tall), math.prod(stack), (n, m))
    values = values.reshape(*stack, m)
    if not compute_uv:
        return values
    left, right = left.reshape(*stack, n, m), right.reshape(*stack, m, m)
    if full_matrices and n > m:
        left = np.concatenate([left, complement(left)], axis=-1)
    if wide:
        left, right = np.swapaxes(right, -1, -2), np.swapaxes(left, -1, -2)
    return SVD(left, values, right)


def complement(frame: Any) -> Array:
    """An orthonormal basis of what is orthogonal to orthonormal columns, shape (..., n, n - m)."""
    frame = _real(frame)
    return qr(frame, mode="complete").Q[..., frame.shape[-1] :]


def qr(a: Any, mode: str = "reduced") -> Any:
    """Q and R by Householder's reflections; `mode` is "reduced", "complete" or "r"."""
    a = _real(a)
    stack, (n, m) = a.shape[:-2], a.shape[-2:]
    k = min(n, m)
    if mode == "complete":
        square = np.zeros((*stack, n, n))
        square[..., :k] = a[..., :k]
    else:
        square = a[..., :k]
    rows = square.shape[-1]
    flat = (np.zeros(0), np.zeros(0)) if rows == 0 else _core.orthonormal(_flat(square), n, rows)
    unknown = ~np.isfinite(a).all(axis=(-2, -1))
    frames, triangles = flat[0].reshape(*stack, n, rows), flat[1].reshape(*stack, rows, rows)[..., :k]
    frames[unknown], triangles[unknown] = np.nan, np.nan
    if m > k:
        triangles = np.concatenate([triangles, matmul(np.swapaxes(frames, -1, -2), a[..., k:])], axis=-1)
    return triangles if mode == "r" else QR(frames, triangles)


def solve(a: Any, b: Any) -> Any:
    """Solutions of a x = b; `b` is one vector if it has one axis, else a stack of matrices, as NumPy has it.

    Raises:
        LinAlgError: a matrix is singular.
    """
    a, b = _arrays(a, b)
    if np.iscomplexobj(a) or np.iscomplexobj(b):
        return _solve_complex(a, b)
    vector = b.ndim == 1
    right = b[:, None] if vector else b
    stack = np.broadcast_shapes(a.shape[:-2], right.shape[:-2])
    n, m = a.shape[-1], right.shape[-1]
    if a.shape[-2] != n or right.shape[-2] != n:
        raise ValueError(f"shapes {a.shape} and {b.shape} are no system of equations")
    left, right = np.broadcast_to(a, (*stack, n, n)), np.broadcast_to(right, (*stack, n, m))
    finite: Any = np.isfinite(left).all(axis=(-2, -1))
    unknown: Any = np.logical_not(finite)  # not singular: nothing is known of its solution, as NumPy has it
    whole = np.where(unknown[..., None, None], np.eye(n), left)
    found = _core.solutions(_flat(whole), _flat(right), math.prod(stack), (n, m))
    if found is None:
        raise LinAlgError("Singular matrix")
    found = found.reshape(*stack, n, m)
    found[unknown] = np.nan
    return found[..., 0] if vector else found


def _solve_complex(a: Any, b: Any) -> Any:
    vector, n = b.ndim == 1, a.shape[-1]
    right = b[:, None] if vector else b
    found = solve(_doubled(a), np.concatenate([right.real, right.imag], -2))
    values = found[..., :n, :] + 1j * found[..., n:, :]
    return values[..., 0] if vector else values


def inv(a: Any) -> Any:
    """Inverses.

    Raises:
        LinAlgError: a matrix is singular.
    """
    a = _arrays(a)[0]
    return solve(a, np.eye(a.shape[-1]))


def det(a: Any) -> Any:
    """Determinants."""
    a = _square(a)
    return _core.determinants(_flat(a), math.prod(a.shape[:-2]), a.shape[-1])[0].reshape(a.shape[:-2])[()]


def slogdet(a: Any) -> SignAndLogarithm:
    """Signs and logarithms of determinants."""
    a = _square(a)
    _, sign, logarithm = _core.determinants(_flat(a), math.prod(a.shape[:-2]), a.shape[-1])
    return SignAndLogarithm(sign.reshape(a.shape[:-2])[()], logarithm.reshape(a.shape[:-2])[()])


def cholesky(a: Any) -> Array:
    """Lower factors of symmetric matrices.

    Raises:
        LinAlgError: a matrix is not positive definite.
    """
    a = _square(a)
    found = _core.cholesky(_flat(a), math.prod(a.shape[:-2]), a.shape[-1])
    if found is None:
        raise LinAlgError("Matrix is not positive definite")
    return found.reshape(a.shape)


def eigh(a: Any) -> Eigen:
    """Eigenvalues of symmetric matrices, rising, and orthonormal eigenvectors; the lower triangle is read."""
    a = _square(a)
    values, rows = _core.symmetric(_flat(a), math.prod(a.shape[:-2]), a.shape[-1])
    return Eigen(values.reshape(a.shape[:-1]), np.swapaxes(rows.reshape(a.shape), -1, -2))


def eigvalsh(a: Any) -> Array:
    """Eigenvalues of symmetric or Hermitian matrices, rising."""
    return eigh(_doubled(a)).eigenvalues[..., ::2] if np.iscomplexobj(a) else eigh(a).eigenvalues


def eig(a: Any) -> Eigen:
    """Eigenvalues and eigenvectors of real matrices: real arrays where all of them are real.

    Raises:
        LinAlgError: an entry is not finite, or Francis's steps do not converge.
    """
    a = _square(a)
    found = _core.eigen(_flat(a), math.prod(a.shape[:-2]), a.shape[-1])
    if found is None:
        is_finite = bool(np.isfinite(a).all())
        raise LinAlgError("Eigenvalues did not converge" if is_finite else "Array must not contain infs or NaNs")
    values, rows = (numbers.view(np.complex128) for numbers in found)
    values, vectors = values.reshape(a.shape[:-1]), np.swapaxes(rows.reshape(a.shape), -1, -2)
    return Eigen(values, vectors) if values.imag.any() else Eigen(values.real, vectors.real)


def eigvals(a: Any) -> Any:
    """Eigenvalues of real matrices; a real array where all of them are real."""
    return eig(a).eigenvalues


def lstsq(a: Any, b: Any, rcond: float | None = None) -> tuple[Any, Array, int, Array]:
    """The shortest solution of a x = b with the least error, no residuals, the rank, and the singular values of a.

    Singular values below `rcond` times the largest one count as zero; by default 2.2e-16 times the larger side.
    """
    a, b = _arrays(a, b)
    left, values, right = svd(a, full_matrices=False)
    least = max(a.shape) * float(np.finfo(np.float64).eps) if rcond is None else rcond
    kept = values > least * values[:1]
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    share = matmul(left.T, b)
    x = matmul(right.T, inverse * share if b.ndim == 1 else inverse[:, None] * share)
    return x, np.empty(0), int(kept.sum()), values


def pinv(a: Any, rcond: float = 1e-15) -> Any:
    """Pseudo-inverses; singular values below `rcond` times the largest one count as zero."""
    if np.iscomplexobj(a):
        n, m = np.shape(a)[-2:]
        whole = pinv(_doubled(a), rcond)
        return whole[..., :m, :n] + 1j * whole[..., m:, :n]
    left, values, right = svd(a, full_matrices=False)
    kept = values > rcond * values[..., :1]
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    return matmul(np.swapaxes(right, -1, -2) * inverse[..., None, :], np.swapaxes(left, -1, -2))


def cond(a: Any) -> Any:
    """The largest singular value over the smallest."""
    values = svd(a, compute_uv=False)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values[..., -1] == 0, np.inf, values[..., 0] / values[..., -1])[()]


def cov(samples: Any) -> Array:
    """The covariance of the columns, each row a sample, shape (column, column)."""
    centred = np.asarray(samples, dtype=np.float64)
    centred = centred - centred.mean(axis=0)
    return np.asarray(matmul(centred.T, centred)) / (len(centred) - 1)


def fft(samples: Any, n: int) -> Any:
    r"""Fourier transforms $\sum_j x_j e^{-2\pi ijk/n}$ along the last axis; zeros fill up n, a power of two."""
    given = np.asarray(samples)
    padded = np.zeros((*given.shape[:-1], n), dtype=np.complex128)
    padded[..., : given.shape[-1]] = given
    return _core.fourier_transforms(padded.reshape(-1).view(np.float64), n).view(np.complex128).reshape(padded.shape)


def power_of_two(n: int) -> int:
    """The least power of two that is not below n."""
    return 1 << max(n - 1, 0).bit_length()


def poly(zeros: Any) -> Any:
    """The coefficients of a monic polynomial with these zeros, from the highest power down."""
    found = np.ones(1, dtype=np.complex128)
    for zero in np.asarray(zeros):
        longer = np.append(found, 0.0)
        longer[1:] -= zero.real * found + 1j * (zero.imag * found)
        found = longer
    return found


def roots(coefficients: Sequence[float] | Array) -> Any:
    """The zeros of a polynomial, its coefficients from the highest power down: eigenvalues of the companion matrix."""
    known = np.trim_zeros(np.asarray(coefficients, dtype=np.float64), "f")
    shorter = np.trim_zeros(known, "b")
    n = len(shorter) - 1
    zeros = np.zeros(len(known) - len(shorter))
    if n < 1:
        return zeros
    companion = np.diag(np.ones(n - 1), -1)
    companion[0] = -shorter[1:] / shorter[0]
    return np.concatenate([eigvals(companion), zeros])


def _doubled(a: Any) -> Array:
    """The real matrix of twice the size that does to real and imaginary parts what a complex matrix does."""
    a = _arrays(a)[0]
    return np.concatenate([np.concatenate([a.real, -a.imag], -1), np.concatenate([a.imag, a.real], -1)], -2)


def _arrays(*given: Any) -> tuple[Any, ...]:
    return tuple(np.asarray(each) for each in given)


def _real(a: Any) -> Any:
    array: Any = np.asarray(a)
    if np.iscomplexobj(array):
        raise TypeError("the core has this factorisation for real matrices")
    if array.ndim < 2:
        raise LinAlgError(f"{array.ndim}-dimensional array given. Array must be at least two-dimensional")
    return array


def _square(a: Any) -> Any:
    array = _real(a)
    if array.shape[-1] != array.shape[-2]:
        raise LinAlgError(f"Last 2 dimensions of the array must be square; got {array.shape}")
    return array


def _flat(a: NDArray[Any]) -> Array:
    return np.ascontiguousarray(a, dtype=np.float64).reshape(-1)


def _stacked(a: NDArray[Any], stack: tuple[int, ...]) -> Array:
    """All matrices of a stack, or one for all."""
    return _flat(a) if a.ndim == 2 or a.shape[:-2] == stack else _flat(np.broadcast_to(a, (*stack, *a.shape[-2:])))
