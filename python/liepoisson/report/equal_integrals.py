"""Whether two integrals are the same up to a factor, the energy and Casimirs."""

from __future__ import annotations

from itertools import combinations_with_replacement
from math import prod
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import rank

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System

_MOST_LETTERS = 2
_HIGHEST_DEGREE = 4  # with products of six, nine coordinates have thousands of monomials


def _written_out(casimirs: list[Expr]) -> list[Any]:
    """The Casimirs that are polynomials, or quadratic traces; written out, traces of higher degree are too long."""
    from liepoisson.structure.trace import traces_in

    short = [c for c in casimirs if all(len(trace.word) <= _MOST_LETTERS for trace in traces_in(c))]
    return [c.expand(trace=True) if traces_in(c) else c for c in short]


def same_integral(known: Expr, given: Expr, system: System) -> bool:
    r"""Whether $K' = cK + F$ with a nonzero number c and a polynomial F in H and the Casimirs.

    Decided exactly for polynomials, F being of at most their degree.  Other functions are the same only if equal.
    """
    from sympy import Integer, Poly, PolynomialError, total_degree

    if (known - given).expand() == 0:
        return True
    x = system.variables
    invariants = [system.hamiltonian, *_written_out(system.bracket.casimirs())]
    if any(value == 0 or not value.is_polynomial(*x) for value in (known, given, *invariants)):
        return False
    degree = max(int(total_degree(value, *x)) for value in (known, given))
    if degree > _HIGHEST_DEGREE:
        return False
    one: Any = Integer(1)
    factors: list[Any] = [one, *(v for v in invariants if total_degree(v, *x) <= degree)]
    products: set[Any] = {prod(chosen) for chosen in combinations_with_replacement(factors, degree)}
    fitting = [p for p in products if total_degree(p, *x) <= degree]
    try:
        rows = [dict(Poly(value, *x).terms()) for value in (known, given, *fitting)]
    except PolynomialError:
        return False
    field = Coefficients.containing(c for row in rows for c in row.values())
    monomials = {monomial: k for k, monomial in enumerate({m for row in rows for m in row})}
    read = [{monomials[m]: field.read(c) for m, c in row.items()} for row in rows]
    base = rank(read[2:], field)
    one_more = [rank([row, *read[2:]], field) for row in read[:2]]
    return one_more == [base + 1, base + 1] and rank(read, field) == base + 1
