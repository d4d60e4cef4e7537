r"""Is a level of H and the Casimirs regular? Decided exactly, over the complex numbers.

A level $F = c$ is regular where the differentials of H and the Casimirs are independent. They are dependent at a point
of it if $\sum_k m_k\nabla F_k = 0$ with some $m \ne 0$, of which one component may be taken to be 1. So a level is
regular if, for each k, the equations $\sum_k m_k\nabla F_k = 0$, $F = c$, $m_k = 1$ have no solution: their ideal
contains 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.algebra.sparse_polynomials import derivative, expression, rational_to_sympy
from liepoisson.proofs.polynomial_field import PolynomialField


def is_regular(field: PolynomialField, level: Mapping[str, Fraction]) -> bool:
    """Whether the differentials of H and the Casimirs are independent at all points of a level, also complex ones.

    Raises:
        NotDecidedError: the Gröbner bases cost too much.
    """
    from sympy import Add, Symbol

    x = [Symbol(name) for name in field.names]
    m = [Symbol(f"m_{k}") for k in range(len(field.constants))]
    on_level: list[Any] = [
        Add(expression(f.items(), x), -rational_to_sympy(level[name])) for name, f in field.constants.items()
    ]
    functions = list(field.constants.values())
    for k in range(len(m)):
        # the multipliers before the k-th vanish in what is left
        factors = [0] * k + [1] + m[k + 1 :]
        dependent = [
            Add(
                *(
                    factor * expression(derivative(f, j).items(), x)
                    for factor, f in zip(factors, functions, strict=True)
                )
            )
            for j in range(len(x))
        ]
        unknowns = [*x, *m[k + 1 :]]
        if not PolynomialSystem.of([*dependent, *on_level], unknowns).is_inconsistent:
            return False
    return True
