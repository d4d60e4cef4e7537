r"""Local monodromy of a linear system at a regular singular point, exactly: exponents and solutions without logarithms.

A system $p\,u' = B(p)\,u$ with B holomorphic has, at p = 0, the exponents of B(0).  If these are integers the local
monodromy is unipotent, and it leaves fixed just the solutions that are Laurent series; those are counted here by linear
algebra over Q(i).

References: W. Wasow, Asymptotic Expansions for Ordinary Differential Equations (1965), chapters I and II.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liepoisson.errors import ParameterError


def exponents(system: Any, variable: Any) -> dict[Any, int]:
    """The exponents at 0 of p u' = B(p) u with their multiplicities.

    Args:
        system: B, entries rational in p and holomorphic at 0, shape (n, n).
        variable: The symbol p.
    """
    residue = system.applyfunc(lambda entry: entry.cancel(extension=True).subs(variable, 0))
    return dict(residue.eigenvals())


def laurent_solutions(system: Any, variable: Any) -> int:
    r"""The number of independent solutions of p u' = B(p) u that are Laurent series at 0, hence single valued there.

    With $u = \sum u_n p^n$ the equations are $(n - B_0) u_n = \sum_{k>0} B_k u_{n-k}$.  Below the smallest integer
    exponent all u_n vanish and beyond the largest one they are determined, so finitely many equations decide.

    Args:
        system: B, entries rational in p over Q(i) and holomorphic at 0, shape (n, n).
        variable: The symbol p.
    """
    from sympy import QQ_I
    from sympy.polys.matrices import DomainMatrix

    whole = [int(root) for root in exponents(system, variable) if root.is_integer]
    if not whole:
        return 0
    n, first, last = system.shape[0], min(whole), max(whole)
    count = last - first + 1
    series = [[taylor(system[i, j], variable, count) for j in range(n)] for i in range(n)]
    rows = [[QQ_I(0)] * (n * count) for _ in range(n * count)]
    for m in range(count):
        for k in range(m + 1):
            for i in range(n):
                for j in range(n):
                    rows[n * m + i][n * (m - k) + j] -= series[i][j][k]
        for i in range(n):
            rows[n * m + i][n * m + i] += QQ_I(first + m)
    return n * count - int(DomainMatrix(rows, (n * count, n * count), QQ_I).rank())


def taylor(function: Any, variable: Any, count: int) -> list[Any]:
    """The first Taylor coefficients at 0 of a rational function over Q(i), as elements of that field.

    Raises:
        ParameterError: the function has a pole at 0.
    """
    from sympy import QQ_I, fraction, together

    top, bottom = (_coefficients(part, variable) for part in fraction(together(function)))
    shift = next(k for k, c in enumerate(bottom) if c)
    if any(top[:shift]):
        raise ParameterError(f"{function} has a pole at {variable} = 0; change the weights of the components.")
    top, bottom = top[shift:], bottom[shift:]
    result: list[Any] = []
    for k in range(count):
        value = top[k] if k < len(top) else QQ_I(0)
        for j in range(1, min(k, len(bottom) - 1) + 1):
            value -= bottom[j] * result[k - j]
        result.append(value / bottom[0])
    return result


def weighted(matrix: Any, weights: Sequence[int], variable: Any, rate: Any) -> Any:
    """B of the system p u' = B u for v_i = p^(-w_i) u_i, where dv/dt = A v and dp/dt = rate.

    Args:
        matrix: A, rational in p, shape (n, n).
        weights: One per component.
        variable: The symbol p.
        rate: dp/dt as a function of p.
    """
    from sympy import Matrix, diag, together

    places = range(len(weights))
    powers = [[variable ** (weights[i] - weights[j] + 1) / rate for j in places] for i in places]
    scaled: Any = matrix.multiply_elementwise(Matrix(powers)).applyfunc(together)
    return scaled + diag(*weights)


def _coefficients(polynomial: Any, variable: Any) -> list[Any]:
    """Coefficients over Q(i), from the constant term up."""
    from sympy import QQ_I, Poly

    return list(reversed(Poly(polynomial, variable, domain=QQ_I).rep.to_list()))
