r"""The linearised flow at a state where the vector field vanishes exactly, in exact numbers.

What is zero in the linearisation of rounded numbers is known only relative to the largest of its entries, which says
nothing where these differ by nine and more orders of magnitude.  A state of doubles is a state of rational numbers; if
the field vanishes there exactly, and all coefficients are rational, then so is the linearisation.

Let the columns $c$ of the Poisson tensor J be a basis of its column space, and A the derivative of the field.  As
$J = J_{\cdot c} J_{cc}^{-1} J_{c\cdot}$, in this basis of the tangent space of the leaf the symplectic form is
$W = -J_{cc}$, and the second variation $S = W A_T = -A_{c\cdot} J_{\cdot c}$.  The characteristic polynomial of
$W^{-1}S$ is one of $\lambda^2$.  All roots $\lambda^2$ are real and not positive exactly where no $\lambda$ has a real
part, which Sturm's theorem decides; the signature of S follows from its characteristic polynomial by Descartes' rule of
signs, which is exact where all roots are real.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.equilibrium.linearisation import ComplexArray

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.model.system import System

_LARGEST = 12
"""Components beyond which exact matrices take longer than everything else."""
_DIGITS = 40
"""Digits that the roots have at least."""


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
    matrices = _matrices(system, state)
    if matrices is None:
        return None
    form, hessian = matrices
    signature = _signature(hessian)
    squares = _in_squares(form.inv() * hessian)
    n_zero = 0
    while len(squares) > 1 and squares[-1] == 0:
        squares, n_zero = squares[:-1], n_zero + 2
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


def _matrices(system: System, state: Array) -> tuple[Any, Any] | None:
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
    basis = list(_independent_columns(poisson))
    form = -poisson.extract(basis, basis)
    hessian = -derivative.extract(basis, list(range(len(variables)))) * poisson.extract(
        list(range(len(variables))), basis
    )
    return None if hessian != hessian.T else (form, hessian)


def _independent_columns(matrix: Any) -> Sequence[int]:
    """The columns of a basis of the column space."""
    return matrix.rref(pivots=True, simplify=False)[1]


def _characteristic(matrix: Any) -> list[Any]:
    """The coefficients of the characteristic polynomial, from the highest power."""
    from sympy.polys.domains import QQ
    from sympy.polys.matrices import DomainMatrix

    return [QQ.to_sympy(c) for c in DomainMatrix.from_Matrix(matrix).convert_to(QQ).charpoly()]


def _signature(hessian: Any) -> tuple[int, int, int]:
    """Numbers of positive, negative and vanishing eigenvalues of a symmetric matrix."""
    coefficients = _characteristic(hessian)
    size = len(coefficients) - 1
    zero = 0
    while zero < size and coefficients[size - zero] == 0:
        zero += 1
    signs = [1 if c > 0 else -1 for c in coefficients if c != 0]
    positive = sum(first != second for first, second in pairwise(signs))
    return positive, size - zero - positive, zero


def _in_squares(flow: Any) -> list[Any]:
    """The coefficients of the characteristic polynomial of a Hamiltonian matrix in the square of the eigenvalue."""
    return _characteristic(flow)[::2]


def _roots(squares: list[Any]) -> tuple[list[complex], bool, bool]:
    """The eigenvalues whose squares have this polynomial, whether all are imaginary, and whether all are simple."""
    from sympy import Poly, Symbol

    eigenvalues: list[complex] = []
    is_imaginary = is_simple = True
    for factor, multiplicity in Poly(squares, Symbol("s")).sqf_list()[1]:
        is_simple &= multiplicity == 1
        is_imaginary &= factor.count_roots(None, 0) == factor.degree()
        for value in _square_roots([Fraction(int(c.p), int(c.q)) for c in factor.monic().all_coeffs()]):
            eigenvalues += [value, -value] * multiplicity
    return eigenvalues, is_imaginary, is_simple


def _square_roots(monic: list[Fraction]) -> list[complex]:
    """A square root of each root of a polynomial without multiple roots: the eigenvalues of its companion matrix."""
    from mpmath import mp

    sizes = [abs(c) for c in monic if c]
    spread = max(sizes) / min(sizes)
    with mp.workdps(2 * _DIGITS + len(str(int(spread))) * len(monic)):
        size = len(monic) - 1
        companion = mp.zeros(size)
        for i, c in enumerate(monic[1:]):
            companion[0, i] = -mp.mpf(c.numerator) / c.denominator
        for i in range(1, size):
            companion[i, i - 1] = 1
        roots = mp.eig(companion, left=False, right=False) if size > 1 else [companion[0, 0]]
        # a real root is real to all digits: it is simple
        exact = [mp.re(root) if abs(mp.im(root)) < mp.mpf(10) ** -_DIGITS * abs(root) else root for root in roots]
        return [complex(mp.sqrt(root)) for root in exact]
