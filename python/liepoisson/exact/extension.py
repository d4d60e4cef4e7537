r"""Extensions: commutative associative algebras A, $e_\mu e_\nu = W_\lambda{}^{\mu\nu} e_\lambda$.

A Lie-Poisson extension of a Lie algebra g is g (x) A.  References: Thiffeault and Morrison, Physica D 136 (2000) 205.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product
from numbers import Integral

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.exact.lie_algebra import Tensor3, read_names, read_tensor, substitute_in_tensor, tensor_symbols
from liepoisson.exact.parameters import Exact, Parameter, is_zero, read_parameter

_FIELD_NAMES = {1: ("l",), 2: ("l", "alpha"), 3: ("l", "alpha", "beta")}


class Extension:
    r"""A commutative associative algebra A by its tensor, $e_\mu e_\nu = \sum_\lambda W_\lambda{}^{\mu\nu} e_\lambda$.

    Args:
        tensor: `W[lam][mu][nu]`, exact, shape (n, n, n).
        name: How it is printed.
        field_names: One name per basis element; l, alpha, beta up to n = 3, else x0, x1, ...
        check: Verify symmetry and associativity (the Jacobi identity of g (x) A needs both).  Switch this off only to
            study what goes wrong.

    Raises:
        ShapeError: `tensor` is not n x n x n, or `field_names` has another length.
        BracketError: not commutative or not associative; the message names the entry.
    """

    def __init__(
        self,
        tensor: Sequence[Sequence[Sequence[Parameter]]],
        name: str = "A",
        field_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> None:
        self.tensor: Tensor3 = read_tensor(tensor, "W")
        self.name = name
        n = len(self.tensor)
        default = _FIELD_NAMES.get(n) or tuple(f"x{i}" for i in range(n))
        self.field_names: tuple[str, ...] = read_names(field_names, "field_names", default)
        if len(self.field_names) != n:
            raise ShapeError(f"field_names must be {n} names; got {len(self.field_names)}. Give one per basis element.")
        if check:
            _check_commutative(self.tensor)
            _check_associative(self.tensor)

    @property
    def dimension(self) -> int:
        """Number n of basis elements, which is the number of fields."""
        return len(self.tensor)

    @property
    def symbols(self) -> set[str]:
        """Names of the free symbols in the tensor."""
        return tensor_symbols(self.tensor)

    def substitute(self, values: Mapping[str, Exact]) -> Extension:
        """The same extension with values for some of its symbols."""
        if not self.symbols & set(values):
            return self
        shown = ", ".join(f"{name} = {values[name]}" for name in sorted(self.symbols & set(values)))
        tensor = substitute_in_tensor(self.tensor, values)
        return Extension(tensor, f"{self.name} at {shown}", self.field_names, check=False)

    def __repr__(self) -> str:
        return self.name


def leibniz(n: int, epsilon: Parameter = 1) -> Extension:
    r"""The Leibniz extension of order n: $\mathbb R[z]/(z^n)$, with the products of non-units scaled by epsilon.

    $e_0 e_\mu = e_\mu$ and $e_\mu e_\nu = \epsilon\, e_{\mu+\nu}$ for $\mu, \nu \ge 1$, zero when $\mu + \nu \ge n$.
    For n = 3 the only cocycle is $e_1 e_1 = \epsilon e_2$: the twisted top.

    Args:
        n: Number of fields, at least 1.
        epsilon: Strength of the cocycle; 0 gives `semidirect(n)`.

    Raises:
        ParameterError: n < 1, or epsilon is not exact.
    """
    strength = read_parameter(epsilon, "epsilon")
    shown = f"epsilon = {strength}" if isinstance(strength, Fraction) else f"{strength}"
    return Extension(_graded_tensor(n, strength), name=f"Leibniz({n}, {shown})")


def semidirect(n: int) -> Extension:
    r"""The semidirect product with n - 1 passive fields: $e_0 e_\mu = e_\mu$, all other products zero.

    For n = 3: the charged heavy top.

    Raises:
        ParameterError: n < 1.
    """
    return Extension(_graded_tensor(n, read_parameter(0, "epsilon")), name=f"semidirect({n})")


def _graded_tensor(n: int, strength: Exact) -> list[list[list[Exact]]]:
    if isinstance(n, bool) or not isinstance(n, Integral) or n < 1:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"an extension needs n >= 1 fields; got n = {n!r}. Use n = 3 for the twisted top.")
    zero, one = read_parameter(0, "0"), read_parameter(1, "1")
    return [
        [[(strength if mu and nu else one) if mu + nu == lam else zero for nu in range(n)] for mu in range(n)]
        for lam in range(n)
    ]


def _check_commutative(W: Tensor3) -> None:
    for lam, mu, nu in product(range(len(W)), repeat=3):
        if not is_zero(W[lam][mu][nu] - W[lam][nu][mu]):
            raise BracketError(
                f"W must be symmetric, W[lam][mu][nu] = W[lam][nu][mu]; got W[{lam}][{mu}][{nu}] = {W[lam][mu][nu]} "
                f"and W[{lam}][{nu}][{mu}] = {W[lam][nu][mu]}. Correct one of the two."
            )


def _check_associative(W: Tensor3) -> None:
    n = len(W)
    zero = W[0][0][0] - W[0][0][0]
    for lam, mu, nu, rho in product(range(n), repeat=4):
        residual = sum((W[k][mu][nu] * W[lam][k][rho] - W[k][nu][rho] * W[lam][mu][k] for k in range(n)), zero)
        if not is_zero(residual):
            raise BracketError(
                f"W must be associative; (e_{mu} e_{nu}) e_{rho} and e_{mu} (e_{nu} e_{rho}) differ by {residual} "
                f"along e_{lam}, wanted 0. Check W[{lam}][.][{rho}] and W[.][{mu}][{nu}]."
            )
