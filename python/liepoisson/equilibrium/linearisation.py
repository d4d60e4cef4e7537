r"""The linearised flow on a symplectic leaf: second variation, symplectic slice, spectrum, definite combinations.

Let $T$ be the tangent space of the leaf at an equilibrium, $J$ the Poisson tensor and $A$ the derivative of the vector
field, both restricted to $T$. The matrix $S = J^{-1}A$ is symmetric there: it is the second derivative of the
Hamiltonian *along the leaf*, and the same as that of $H - \sum_k\lambda_k C_k$ restricted to $T$, whatever functions of
the Casimirs are taken. No Casimir is needed to compute it, so it exists on every leaf, singular ones included.

**In exact numbers.** What is zero in the linearisation of rounded numbers is known only relative to the largest of its
entries, which says nothing where these differ by nine and more orders of magnitude. A state of doubles is a state of
rational numbers; if the field vanishes there exactly, and all coefficients are rational, then so is the linearisation.

Let the columns $c$ of the Poisson tensor J be a basis of its column space, and A the derivative of the field.  As $J =
J_{\cdot c} J_{cc}^{-1} J_{c\cdot}$, in this basis of the tangent space of the leaf the symplectic form is $W =
-J_{cc}$, and the second variation $S = W A_T = -A_{c\cdot} J_{\cdot c}$.  The characteristic polynomial of $W^{-1}S$ is
one of $\lambda^2$.  All roots $\lambda^2$ are real and not positive exactly where no $\lambda$ has a real part, which
enclosures of the roots decide; the signature of S follows from its characteristic polynomial by Descartes' rule of
signs, which is exact where all roots are real.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array, norm
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from flint import acb, fmpq_mat, fmpq_poly

    from liepoisson.model.system import System

ComplexArray = NDArray[np.complex128]

ZERO = 1e-9
"""Eigenvalues of a second variation below this fraction of the largest count as zero.

They are known to about 1e-13 of the largest: those of a family that Newton's method reached were below 1e-11 in all
systems of the catalog that were tried.
"""
_ROUND_OFF = 100 * np.finfo(np.float64).eps
_NEAR_COLLISION = 1e6
"""Condition number of an eigenvalue from which its real part cannot be told from zero."""


def leaf_tangent(poisson: Array, rank: int) -> Array:
    """Orthonormal bases of the tangent spaces of leaves, shape (..., N, rank), from Poisson tensors (..., N, N)."""
    return linear.svd(poisson)[0][..., :rank]


@dataclass(frozen=True)
class LinearFlow:
    r"""A linear Hamiltonian flow $W\dot y = S y$.

    Attributes:
        hessian: The symmetric matrix S, twice the quadratic Hamiltonian, shape (2n, 2n).
        form: The antisymmetric matrix W of the symplectic form, shape (2n, 2n).
    """

    hessian: Array
    form: Array

    @property
    def size(self) -> int:
        """Dimension of the space, 2n."""
        return len(self.form)

    def with_hessian(self, hessian: Array) -> LinearFlow:
        """The flow of another quadratic Hamiltonian on the same space."""
        return LinearFlow(hessian, self.form)

    def scale(self) -> float:
        """Largest eigenvalue of the second variation, in absolute value."""
        return float(np.abs(linear.eigvalsh(self.hessian)).max(initial=0.0))

    def kernel(self) -> Array:
        """Orthonormal basis of the kernel of the second variation, shape (2n, nullity)."""
        values, vectors = linear.eigh(self.hessian)
        return vectors[:, np.abs(values) <= ZERO * np.abs(values).max(initial=0.0)]

    def signature(self) -> tuple[int, int, int]:
        """Numbers of positive, negative and vanishing eigenvalues of the second variation."""
        values = linear.eigvalsh(self.hessian)
        bound = ZERO * np.abs(values).max(initial=0.0)
        return int((values > bound).sum()), int((values < -bound).sum()), int((np.abs(values) <= bound).sum())

    def has_odd_index(self) -> bool:
        r"""Whether the second variation has no zero and an odd number of negative values, as at a saddle.

        Then $\det W^{-1}S < 0$, which imaginary pairs do not give: there is a real one.
        """
        _, negative, zero = self.signature()
        return bool(self.size) and not zero and negative % 2 == 1

    def slice_basis(self, symmetry: Array) -> Array:
        r"""A basis of the symplectic slice $Z^\perp / (Z\cap Z^\perp)$, shape (2n, m).

        Args:
            symmetry: Columns that span Z; $\perp$ is taken with the symplectic form. If Z is spanned by the vector
                fields of integrals, $Z^\perp$ is the tangent space of their common level set.
        """
        _, sizes, rows = linear.svd(linear.matmul(symmetry.T, self.form))
        level = rows[int((sizes > ZERO * sizes.max(initial=0.0)).sum()) :].T
        vectors, areas, _ = linear.svd(linear.matmul(linear.matmul(level.T, self.form), level))
        return linear.matmul(level, vectors[:, areas > ZERO * np.abs(self.form).max(initial=0.0)])

    def restricted(self, basis: Array) -> LinearFlow:
        """The flow on a symplectic subspace with this basis."""
        return LinearFlow(
            linear.matmul(linear.matmul(basis.T, self.hessian), basis),
            linear.matmul(linear.matmul(basis.T, self.form), basis),
        )

    def without_zeros(self) -> LinearFlow:
        """The flow without its generalised zero eigenvalues.

        Zero is a defective eigenvalue wherever equilibria come in families; computed directly, it would scatter by
        the square root of the round-off. The kernel of S is computed accurately; it is divided out until none is left.
        """
        flow = self
        while flow.size and (kernel := flow.kernel()).size:
            flow = flow.restricted(flow.slice_basis(kernel))
        return flow

    def has_more_than(self, rest: LinearFlow) -> bool:
        r"""Whether zeros were divided out of `rest` that are none: characteristic polynomials that differ.

        An eigenvalue of the second variation that is small beside the largest counts as zero, though in other units of
        the coordinates it may be as large. The coefficients of $\det(\lambda - W^{-1}S)$ are compared in units of a
        norm of the matrix in which rows and columns are of equal size, where they are known to round-off.
        """
        if rest.size == self.size:
            return False
        matrix = _balanced(linear.solve(self.form, self.hessian).astype(np.float64))
        unit = float(norm(matrix)) or 1.0
        mine = linear.poly(linear.eigvals(matrix) / unit)
        left = linear.eigvals(linear.solve(rest.form, rest.hessian)) if rest.size else np.zeros(0)
        theirs = linear.poly(np.append(left, np.zeros(self.size - rest.size)) / unit)
        return bool(np.any(np.abs(mine - theirs) > ZERO))

    def eigenvalues(self) -> tuple[ComplexArray, Array]:
        r"""The eigenvalues of $W^{-1}S$ and bounds on the round-off in them.

        If S is definite they are computed from an antisymmetric matrix and lie on the imaginary axis exactly.
        """
        if not self.size:
            return np.zeros(0, dtype=np.complex128), np.zeros(0)
        definite = definite_sign(self.hessian)
        if definite:
            factor = linear.cholesky(definite * self.hessian)
            rotation = linear.matmul(factor.T, linear.solve(self.form, factor))
            return (1j * linear.eigvalsh(-0.5j * (rotation - rotation.T))).astype(np.complex128), np.zeros(self.size)
        matrix = linear.solve(self.form, self.hessian)
        values, right = linear.eig(matrix)
        left = linear.pinv(right)
        condition = linear.norm(left, axis=1) * linear.norm(right, axis=0)
        return values.astype(np.complex128), _ROUND_OFF * linear.norm(matrix) * condition


def _balanced(matrix: Array) -> Array:
    """A similar matrix with rows as large as columns, by powers of two: nothing is rounded."""
    balanced = matrix.copy()
    for _ in range(_SWEEPS):
        for i in range(len(balanced)):
            column, row = norm(np.delete(balanced[:, i], i)), norm(np.delete(balanced[i], i))
            if column > 0 and row > 0:
                factor = 2.0 ** np.round(elementary.log2(row / column) / 2)
                balanced[:, i] *= factor
                balanced[i] /= factor
    return balanced


_SWEEPS = 10


def linear_flow(poisson: Array, derivative: Array, basis: Array) -> tuple[LinearFlow, float]:
    r"""The linearised flow on the tangent space of a leaf, and how far it is from being Hamiltonian.

    The second number is $\|S - S^T\|/\|S\|$: zero at an equilibrium, where the spectrum is therefore symmetric in both
    axes (quadruples $\pm\lambda, \pm\bar\lambda$).

    Args:
        poisson: Poisson tensor J, shape (N, N).
        derivative: Derivative of the vector field, shape (N, N).
        basis: Orthonormal basis of the tangent space, shape (N, 2n).
    """
    form = linear.inv(linear.matmul(linear.matmul(basis.T, poisson), basis))
    form = (form - form.T) / 2
    hessian = linear.matmul(form, linear.matmul(linear.matmul(basis.T, derivative), basis))
    size = float(norm(hessian))
    asymmetry = float(norm(hessian - hessian.T)) / size if size else 0.0
    return LinearFlow((hessian + hessian.T) / 2, form), asymmetry


def spectral_verdict(values: ComplexArray, bounds: Array, n_zero: int) -> str:
    """What a spectrum says: "unstable", "undecided", "degenerate" or "stable spectrum".

    Args:
        values: The eigenvalues that are not zero.
        bounds: Round-off in each.
        n_zero: Number of zero eigenvalues.
    """
    if np.any(values.real > bounds):
        return "unstable"
    if np.any(bounds > _ROUND_OFF * _NEAR_COLLISION * np.abs(values).max(initial=0.0)):
        return "undecided"
    return "degenerate" if n_zero else "stable spectrum"


def definite_sign(matrix: Array) -> int:
    """1 or -1 for a positive or negative definite matrix, up to round-off; 0 for any other."""
    values = linear.eigvalsh(matrix)
    bound = ZERO * np.abs(values).max(initial=0.0)
    return int(np.all(values > bound)) - int(np.all(values < -bound)) if values.size else 0


def definite_combination(matrices: Sequence[Array]) -> Array | None:
    r"""Coefficients $y$ that make $\sum_j y_j S_j$ positive definite, or None if none was found.

    The ellipsoid method: where the smallest eigenvalue at $y$ has the eigenvector $v$, all solutions lie in the
    half-space $\sum_j z_j\, v^T S_j v > 0$. Its ellipsoid shrinks by a fixed factor each time; the
    search ends when the cone of solutions would be narrower than about 1e-6.

    References: Grötschel, Lovász and Schrijver (1981).
    """
    scales = [float(np.abs(linear.eigvalsh(m)).max(initial=0.0)) or 1.0 for m in matrices]
    scaled = np.array([matrix / scale for matrix, scale in zip(matrices, scales, strict=True)])
    n = len(scaled)
    if n == 1:
        sign = definite_sign(scaled[0])
        return np.array([sign / scales[0]]) if sign else None
    centre, shape = np.zeros(n), np.eye(n)
    centre[0] = 1e-3  # the Hamiltonian itself is tried first
    for _ in range(60 * n * n):
        matrix = linear.tensordot(centre, scaled, axes=1)
        values, vectors = linear.eigh(matrix)
        if definite_sign(matrix) > 0:
            return centre / np.array(scales)
        cut = linear.einsum("i,jik,k->j", vectors[:, 0], scaled, vectors[:, 0])
        width = float(np.sqrt(max(linear.matmul(linear.matmul(cut, shape), cut), 0.0)))
        if values.size == 0 or width < 1e-300:
            return None
        step = linear.matmul(shape, cut) / width
        centre = centre + step / (n + 1)
        shape = n * n / (n * n - 1.0) * (shape - 2.0 / (n + 1) * np.outer(step, step))
    return None


_LARGEST = 12
"""Components beyond which exact matrices take longer than everything else."""
_BITS = 128
"""Of the balls around roots, which are then right to the last bit of a double."""


@dataclass(frozen=True)
class ExactLinearisation:
    """What is known of a linearised flow without round-off.

    Attributes:
        spectrum: The eigenvalues, rounded; those on the axes lie on them, and zeros are zero.
        verdict: "unstable", "undecided" (imaginary eigenvalues are equal, and the second variation is not definite),
            "degenerate" or "stable spectrum".
        growth_rate: The largest real part.
        nullity: Dimension of the kernel.
        signature: Numbers of positive, negative and vanishing eigenvalues of the second variation.
    """

    spectrum: ComplexArray
    verdict: str
    growth_rate: float
    nullity: int
    signature: tuple[int, int, int]


def exact_linearisation(system: System, state: Array) -> ExactLinearisation | None:
    """The linearised flow on the leaf; None where the field does not vanish exactly, or has irrational numbers."""
    from flint import fmpq_poly

    matrices = _matrices(system, state)
    if matrices is None:
        return None
    form, hessian = matrices
    signature = _signature(hessian)
    squares = fmpq_poly(form.solve(hessian).charpoly().coeffs()[::2])  # one of the square of the eigenvalue
    n_zero = 0
    while squares.degree() > 0 and squares[0] == 0:
        squares, n_zero = fmpq_poly(squares.coeffs()[1:]), n_zero + 2
    eigenvalues, is_imaginary, is_simple = _roots(squares)
    values = np.array([*eigenvalues, *[0j] * n_zero], dtype=np.complex128)
    if not np.all(np.isfinite(values)):
        return None
    if not is_imaginary:
        verdict = "unstable"
    elif n_zero:
        verdict = "degenerate"
    else:
        verdict = "stable spectrum" if is_simple or 0 in signature[:2] else "undecided"
    growth = float(values.real.max(initial=0.0)) + 0.0
    return ExactLinearisation(values, verdict, growth, signature[2], signature)


def _matrices(system: System, state: Array) -> tuple[fmpq_mat, fmpq_mat] | None:
    """The symplectic form and the second variation in a basis of the tangent space of the leaf."""
    from sympy import Matrix, Rational

    variables = system.variables
    if len(variables) > _LARGEST or not system.hamiltonian.is_rational_function(*variables):
        return None
    exactly = [Fraction(float(value)) for value in state]
    at: Any = {x: Rational(value) for x, value in zip(variables, exactly, strict=True)}
    rates: Any = Matrix([system.equations[x] for x in variables])
    if any(rate.subs(at) != 0 for rate in rates):  # seldom zero: the first one decides
        return None
    poisson = system.bracket.poisson_tensor().subs(at)
    if not poisson.values() or not all(value.is_Rational for value in poisson):
        return None
    derivative = rates.jacobian(list(variables)).subs(at)
    if not all(value.is_Rational for value in derivative):
        return None
    basis, everything = list(poisson.rref(pivots=True, simplify=False)[1]), list(range(len(variables)))
    form = _rational(-poisson.extract(basis, basis))
    hessian = _rational(-derivative.extract(basis, everything) * poisson.extract(everything, basis))
    return None if hessian != hessian.transpose() else (form, hessian)


def _rational(matrix: Any) -> fmpq_mat:
    """A matrix of rational numbers as FLINT's."""
    from flint import fmpq, fmpq_mat

    return fmpq_mat(matrix.rows, matrix.cols, [fmpq(int(c.p), int(c.q)) for c in matrix])


def _signature(hessian: fmpq_mat) -> tuple[int, int, int]:
    """Numbers of positive, negative and vanishing eigenvalues of a symmetric matrix."""
    coefficients = hessian.charpoly().coeffs()
    size = len(coefficients) - 1
    zero = next(k for k, c in enumerate(coefficients) if c != 0)
    positive = sum((first > 0) != (second > 0) for first, second in pairwise(c for c in coefficients if c != 0))
    return positive, size - zero - positive, zero


def _roots(squares: fmpq_poly) -> tuple[list[complex], bool, bool]:
    """The eigenvalues whose squares have this polynomial, whether all are imaginary, and whether all are simple."""
    from flint import ctx

    with ctx.workprec(_BITS):
        # Roots in balls, those of real roots real, with multiplicities; FLINT's stub forgets the latter.
        found = cast("list[tuple[acb, int]]", squares.complex_roots())
        eigenvalues = [(complex(root.sqrt()), multiplicity) for root, multiplicity in found]
        is_imaginary = all(root.imag == 0 and root.real < 0 for root, _ in found)
    values = [sign * value for value, multiplicity in eigenvalues for sign in (1, -1) for _ in range(multiplicity)]
    return values, is_imaginary, all(multiplicity == 1 for _, multiplicity in found)
