r"""Higher terms of a deformation $W + \sum_\alpha s^\alpha f_\alpha$, by exact linear algebra, order by order.

Associativity at $s^\alpha$ is $\delta f_\alpha = \sum_{\beta + \gamma = \alpha} f_\beta \circ f_\gamma$ with
$(f \circ h)(a, b, c) = f(h(a, b), c) - f(a, h(b, c))$.  What is no differential is left over: its entries, as
polynomials in s, vanish exactly where the deformed product is associative.

References: Gerstenhaber, Ann. of Math. 79 (1964) 59; Nijenhuis and Richardson, Bull. Amer. Math. Soc. 72 (1966) 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any

from liepoisson.algebra.linear_algebra import solve
from liepoisson.algebra.sparse_polynomials import Monomial, of_exponents
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.cohomology.commutative_complex import Cochain, CommutativeComplex, Trilinear, combined


@dataclass(frozen=True)
class Mended:
    """The terms of a deformation, by monomials of its parameters.

    Attributes:
        terms: The cochains, those of degree one first.
        residuals: What no term mends, by monomials; empty if the product is associative as far as was computed.
        order: The highest degree that was computed.
        ends: Whether nothing remains beyond it: all further terms are zero.
        is_free: Whether the terms of lower order leave a choice that was not followed, so that a residual is no proof.
    """

    terms: dict[Monomial, Cochain]
    residuals: dict[Monomial, Trilinear]
    order: int
    ends: bool
    is_free: bool = False


def mended(complex_: CommutativeComplex, first: Mapping[Monomial, Cochain], most: int) -> Mended:
    """The deformation with given terms of degree one, whose further terms have no part in the span of the cocycles.

    Args:
        complex_: The cochains of the algebra.
        first: The terms of degree one.
        most: The degree beyond which terms are followed no further.
    """
    degrees: dict[int, dict[Monomial, Cochain]] = {1: {m: f for m, f in first.items() if f}}
    residuals: dict[Monomial, Trilinear] = {}
    last = 1
    for d in count(2):
        terms = {m: f for degree in degrees.values() for m, f in degree.items()}
        if d > 2 * last or not degrees[1]:
            return Mended(terms, residuals, last, ends=True)
        if last > most:
            return Mended(terms, residuals, last, ends=False)
        degrees[d] = {}
        for monomial, total in _residuals(complex_, degrees, d).items():
            f, left = complex_.mended(total)
            if f:
                degrees[d][monomial], last = f, d
            if left:
                residuals[monomial] = left
    raise AssertionError


def mended_along(complex_: CommutativeComplex, f: Cochain, most: int) -> Mended:
    """The deformation that one cocycle begins; where it does not close, cocycles are added to the term before.

    It stops at the first order at which something is left over.  That proves an obstruction at orders two and three.
    """
    degrees: dict[int, dict[Monomial, Cochain]] = {1: {(1,): f} if f else {}}
    one, last = complex_.field.one, 1
    for d in count(2):
        terms = {m: term for degree in degrees.values() for m, term in degree.items()}
        if d > 2 * last or not f:
            return Mended(terms, {}, last, ends=True)
        if last > most:
            return Mended(terms, {}, last, ends=False)
        term, left = complex_.mended(_residuals(complex_, degrees, d).get((d,), {}))
        if left and d > 2 and (shift := _shift(complex_, f, left)):
            degrees[d - 1] = {(d - 1,): combined([(one, degrees[d - 1].get((d - 1,), {})), (one, shift)])}
            term, left = complex_.mended(_residuals(complex_, degrees, d).get((d,), {}))
        if left:
            return Mended(terms, {(d,): left}, d, ends=False, is_free=d > 3)
        degrees[d] = {(d,): term} if term else {}
        last = d if term else max(k for k, degree in degrees.items() if degree)
    raise AssertionError


def _residuals(
    complex_: CommutativeComplex, degrees: Mapping[int, Mapping[Monomial, Cochain]], d: int
) -> dict[Monomial, Trilinear]:
    """The sums of f o h over pairs of terms whose degrees add up to d, by monomials."""
    one, sums = complex_.field.one, dict[Monomial, list[tuple[Any, Trilinear]]]()
    inner = {m: complex_.inner(h) for k in range(1, d) for m, h in degrees[k].items()}
    for k in range(1, d):
        for m, f in degrees[k].items():
            checkpoint("the terms of a deformation")
            outer = complex_.outer(f)
            for other in degrees[d - k]:
                if part := complex_.composed(outer, inner[other]):
                    sums.setdefault(of_exponents(m, other), []).append((one, part))
    return {m: total for m, terms in sums.items() if (total := combined(terms))}


def _shift(complex_: CommutativeComplex, f: Cochain, left: Trilinear) -> Cochain | None:
    """A cocycle that, added to the term before, takes away what is left over."""
    field, outer, inner = complex_.field, complex_.outer(f), complex_.inner(f)
    effects: list[Trilinear] = []
    for b in complex_.basis:
        both = complex_.composed(outer, complex_.inner(b)), complex_.composed(complex_.outer(b), inner)
        effects.append(complex_.mended(combined([(field.one, part) for part in both]))[1])
    values = solve(effects, {key: -value for key, value in left.items()}, field)
    return None if values is None else combined(list(zip(values, complex_.basis, strict=True)))
