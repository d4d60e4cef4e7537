r"""Splitting the solutions of a system into components, by factors.

Where an element of a Gröbner basis is a product, the solutions are those at which the first factor vanishes, those at
which it does not and the second does, and so on. For real solutions a sum of terms, or squares, of one sign vanishes
with all of them. What is left when nothing factors is a component; in dimension 0 it is split further, into the zeros
of the irreducible factors of the equation for a linear form that tells them apart.

A component may still be reducible over the rationals: `is_irreducible` says where it is proved not to be. Over the
complex numbers it may be reducible in any case.

References: [cox2015], section 4.6; [gianni1988].
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq_poly

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import GroebnerBasis, groebner_basis
from liepoisson.algebra.ideals.limits import Budget
from liepoisson.algebra.ideals.operations import radical_contains, saturation
from liepoisson.algebra.ideals.signs import never_vanishes, vanishing_parts
from liepoisson.algebra.ideals.solutions import Solutions, solutions


@dataclass(frozen=True, repr=False)
class Component:
    """A part of the solutions of a system.

    Attributes:
        basis: The Gröbner basis of an ideal whose zeros are the closure of this part (of what is assumed not to vanish,
            nothing vanishes on all of it).
        is_irreducible: Whether it is proved that the zeros over the rationals are not the union of two smaller such
            sets, and that the ideal is prime.
    """

    basis: GroebnerBasis
    is_irreducible: bool

    @property
    def dimension(self) -> int:
        """The dimension over the complex numbers."""
        return self.basis.dimension

    @property
    def degree(self) -> int:
        """The degree of the ideal."""
        return self.basis.degree

    @property
    def equations(self) -> tuple[Poly, ...]:
        """The polynomials of the basis."""
        return self.basis.polynomials

    def __repr__(self) -> str:
        shown = ", ".join(f"{p} = 0" for p in self.equations[:4]) or "everything"
        more = ", ..." if len(self.equations) > 4 else ""
        return f"<Component of dimension {self.dimension}, degree {self.degree}: {shown}{more}>"


@dataclass(frozen=True)
class Assumptions:
    """What is known of the variables beside the equations.

    Attributes:
        nonzero: Polynomials that do not vanish.
        positive: Numbers of variables that are positive.
        is_real: Whether only real solutions are wanted.
    """

    nonzero: tuple[Poly, ...] = ()
    positive: frozenset[int] = frozenset()
    is_real: bool = False


def irreducible_factors(p: Poly) -> list[Poly]:
    """The distinct irreducible factors of a polynomial over the rationals, monic; none of a constant."""
    if not p or p.is_constant():
        return []
    return [q / q.leading_coefficient() for q, _ in p.factor()[1]]


def components(generators: Sequence[Poly], assumptions: Assumptions, budget: Budget) -> list[Component]:
    """Components whose union are the solutions that satisfy the assumptions, up to closure, none inside another.

    Raises:
        NotDecidedError: the limits were reached.
    """
    nonzero = {str(q): q for p in assumptions.nonzero for q in irreducible_factors(p)}
    if any(not p for p in assumptions.nonzero):
        return []
    stack = [(list(generators), nonzero)]
    found: list[Component] = []
    while stack:
        given, units = stack.pop()
        basis = groebner_basis(given, budget)
        branches = _branches(basis, units, assumptions)
        if branches is not None:
            stack += reversed(branches)
            continue
        closed = basis
        for q in units.values():
            closed = saturation(closed, q, budget) if not closed.is_one else closed
        if closed.polynomials != basis.polynomials:
            stack.append((list(closed.polynomials), units) if closed.polynomials else ([basis.context.constant(0)], {}))
            if closed.is_one:
                stack.pop()
            continue
        for component in _last_split(basis, units, assumptions, budget):
            _take(found, component, budget)
    return sorted(found, key=lambda c: (-c.dimension, c.degree, str(c.equations)))


def _branches(
    basis: GroebnerBasis, units: dict[str, Poly], assumptions: Assumptions
) -> list[tuple[list[Poly], dict[str, Poly]]] | None:
    """The systems that a basis falls into; None if it stays one."""
    if basis.is_one:
        return []
    for p in basis.polynomials:
        factors = [q for q in irreducible_factors(p) if not _is_unit(q, units, assumptions)]
        if not factors:
            return []
        if len(factors) == 1 and factors[0] == p:
            terms = vanishing_parts(p, assumptions.positive) if assumptions.is_real else None
            if terms is None or (len(terms) == 1 and terms[0] == p):
                continue
            return [([*basis.polynomials, *terms], units)]
        found: list[tuple[list[Poly], dict[str, Poly]]] = []
        known = dict(units)
        for q in factors:
            found.append(([*basis.polynomials, q], dict(known)))
            known[str(q)] = q
        return found
    return None


def _is_unit(q: Poly, units: dict[str, Poly], assumptions: Assumptions) -> bool:
    if str(q) in units:
        return True
    if (
        q.total_degree() == 1
        and len(q) == 1
        and next(v for v, k in enumerate(q.degrees()) if k) in assumptions.positive
    ):
        return True
    return assumptions.is_real and never_vanishes(q, assumptions.positive)


def _last_split(
    basis: GroebnerBasis, units: dict[str, Poly], assumptions: Assumptions, budget: Budget
) -> list[Component]:
    if basis.dimension:
        return [Component(basis, _is_prime(basis.polynomials, range(len(basis.names))))]
    whole = solutions(basis, budget)
    gens = basis.context.gens()
    wanted = set(range(len(whole.factors)))
    if assumptions.is_real:
        positive = [gens[v] for v in assumptions.positive]
        wanted = {s.factor for s in whole.real(8) if all(whole.sign(x, s) > 0 for x in positive)}
    return [
        Component(_part(whole, k, budget), True)
        for k in sorted(wanted)
        if not any(whole.vanishes(q, k) for q in units.values())
    ]


def _part(whole: Solutions, k: int, budget: Budget) -> GroebnerBasis:
    """The maximal ideal of the zeros of one factor."""
    ideal, factor = whole.quotient.ideal, whole.factors[k]
    context = ideal.context
    if whole.degree == factor.degree:
        return ideal
    u = sum((x * c for x, c in zip(context.gens(), whole.form, strict=True)), context.constant(0))
    part = groebner_basis([*ideal.polynomials, at(fmpq_poly(factor.polynomial), u)], budget)
    if part.degree == factor.degree:
        return part
    # the squarefree equations of all variables make an ideal radical (Seidenberg)
    added: list[Poly] = []
    for number, x in enumerate(context.gens()):
        form = tuple(int(j == number) for j in range(len(context.names())))
        own = whole.quotient.characteristic(whole.quotient.multiplication(form))
        added.append(at(own // own.gcd(own.derivative()), x))
    return groebner_basis([*part.polynomials, *added], budget)


def at(polynomial: fmpq_poly, value: Poly) -> Poly:
    """A polynomial in one variable at a polynomial in several."""
    total = value * 0
    for c in reversed(polynomial.coeffs()):
        total = total * value + c
    return total


def _is_prime(polynomials: Sequence[Poly], variables: Collection[int]) -> bool:
    """Whether it is obvious: one irreducible polynomial is left, or none, after variables were solved for."""
    left = [p for p in polynomials if p]
    if not left:
        return True
    for p in left:
        for v in variables:
            if p.degrees()[v] != 1:
                continue
            slope = p.derivative(v)
            if not slope.is_constant():
                continue
            context = p.context()
            values: list[Any] = list(context.gens())
            values[v] = values[v] - p / slope.leading_coefficient()
            rest = [q.compose(*values, ctx=context) for q in left if q is not p]
            return _is_prime(rest, [w for w in variables if w != v])
    return len(left) == 1 and len(irreducible_factors(left[0])) == 1


def _take(found: list[Component], new: Component, budget: Budget) -> None:
    """Add a component unless it lies in another one, and remove those that lie in it."""
    if any(_lies_in(new, other, budget) for other in found):
        return
    found[:] = [other for other in found if not _lies_in(other, new, budget)] + [new]


def _lies_in(inner: Component, outer: Component, budget: Budget) -> bool:
    if inner.dimension > outer.dimension:
        return False
    return all(radical_contains(inner.basis, p, budget) for p in outer.equations)
