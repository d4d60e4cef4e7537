r"""What Gröbner bases say about ideals: elimination, saturation, membership in the radical, images."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import GroebnerBasis, groebner_basis, new_name, rational_context
from liepoisson.algebra.ideals.limits import Budget
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.algebra.sparse_polynomials import Monomial


def in_context(p: Poly, context: Any) -> Poly:
    """The polynomial in another context that has all variables that occur in it, by name."""
    names, places = p.context().names(), context.names()
    where = [places.index(name) if name in places else -1 for name in names]
    terms: dict[tuple[int, ...], Any] = {}
    for monomial, c in p.terms():
        powers = [0] * len(places)
        for place, k in zip(where, monomial, strict=True):
            if k:
                powers[place] = int(k)
        terms[tuple(powers)] = c
    return context.from_dict(terms)


def radical_contains(basis: GroebnerBasis, p: Poly, budget: Budget) -> bool:
    """Whether a polynomial vanishes at all complex zeros of an ideal: I and $1 - tp$ have no zero in common."""
    if basis.is_one or basis.contains(p):
        return True
    t = new_name(basis.names)
    wider = rational_context((*basis.names, t))
    inverse = 1 - wider.gens()[-1] * in_context(p, wider)
    return groebner_basis([*(in_context(q, wider) for q in basis.polynomials), inverse], budget).is_one


def saturation(basis: GroebnerBasis, p: Poly, budget: Budget) -> GroebnerBasis:
    r"""The ideal $I : p^\infty$ of what vanishes on the zeros of I at which p does not.

    With a variable z for p, and all made homogeneous, z is last in the order: then an element of a Gröbner basis is
    divisible by z if its leading monomial is, and the quotients generate the saturation [bayer1987].
    """
    z, h = new_name(basis.names), new_name((*basis.names, new_name(basis.names)))
    wider = rational_context((*basis.names, z))
    with_z = groebner_basis(
        [*(in_context(q, wider) for q in basis.polynomials), wider.gens()[-1] - in_context(p, wider)], budget
    )
    both = rational_context((*basis.names, h, z))
    homogeneous: list[Poly] = []
    for q in with_z.polynomials:
        total = int(q.total_degree())
        terms = {(*m[:-1], total - sum(m), m[-1]): c for m, c in _terms(q)}
        homogeneous.append(both.from_dict(terms))
    context, one = basis.context, basis.context.constant(1)
    found: list[Poly] = []
    for q in groebner_basis(homogeneous, budget).polynomials:
        least = min(m[-1] for m, _ in _terms(q))
        total = one * 0
        for m, c in _terms(q):
            total = total + context.from_dict({m[:-2]: c}) * p ** (m[-1] - least)
        found.append(total)
    return groebner_basis(found or [one * 0], budget)


def _terms(p: Poly) -> list[tuple[tuple[int, ...], Any]]:
    return [(tuple(int(k) for k in m), c) for m, c in p.terms()]


def eliminated(generators: Sequence[Poly], names: Collection[str], budget: Budget) -> GroebnerBasis:
    """The polynomials of an ideal without some variables: the closure of the projection of its complex zeros.

    By a basis in lexicographic order, with these variables first.

    Args:
        generators: Generators, at least one.
        names: The variables that are eliminated.
        budget: Where the work is accounted.
    """
    given = generators[0].context().names()
    kept = [name for name in given if name not in names]
    order = rational_context((*(name for name in given if name in names), *kept), lexicographic=True)
    lexicographic = groebner_basis([in_context(g, order) for g in generators], budget)
    rest = rational_context(kept)
    without = [p for p in lexicographic.polynomials if not any(p.degrees()[: len(given) - len(kept)])]
    return groebner_basis([in_context(p, rest) for p in without] or [rest.constant(0)], budget)


class Image:
    r"""The image of the zeros of an ideal under polynomials $f_1, \dots, f_m$: the P with P(f) in the ideal.

    They are found by linear algebra among the normal forms of the monomials in f, without a basis in another order.

    Args:
        basis: The Gröbner basis of the ideal.
        functions: The polynomials f, of its context.
        context: FLINT's context of the polynomials P.
        budget: Where the work is accounted.
    """

    def __init__(self, basis: GroebnerBasis, functions: Sequence[Poly], context: Any, budget: Budget) -> None:
        self._basis, self._context, self._budget = basis, context, budget
        self._functions = [basis.remainder(f, budget) for f in functions]
        self._forms = {(0,) * len(functions): basis.context.constant(1)}

    def _form(self, monomial: Monomial) -> Poly:
        """The normal form of a monomial in the functions."""
        if monomial not in self._forms:
            k = next(k for k, power in enumerate(monomial) if power)
            lower = (*monomial[:k], monomial[k] - 1, *monomial[k + 1 :])
            self._forms[monomial] = self._basis.remainder(self._form(lower) * self._functions[k], self._budget)
        return self._forms[monomial]

    def vanishes(self, p: Poly) -> bool:
        """Whether P(f) is in the ideal."""
        return not sum((self._form(m) * c for m, c in _terms(p)), self._basis.context.constant(0))

    def relations(self) -> list[Poly]:
        """The polynomials P of the least degree: a basis of their space.

        Raises:
            NotDecidedError: the limits were reached; so they are where the functions are independent.
        """
        n, degree = len(self._functions), 0
        monomials: list[Monomial] = [(0,) * n]
        while True:
            degree += 1
            monomials += (tuple(map(m.count, range(n))) for m in combinations_with_replacement(range(n), degree))
            rows: dict[Monomial, dict[int, Fraction]] = {}
            for column, monomial in enumerate(monomials):
                for m, c in _terms(self._form(monomial)):
                    rows.setdefault(m, {})[column] = Fraction(int(c.p), int(c.q))
            self._budget.spend(sum(map(len, rows.values())) * len(monomials) / 10, "relations between functions")
            found = nullspace(list(rows.values()), len(monomials), Coefficients()).vectors
            if found:
                terms = ({monomials[k]: as_fmpq(c) for k, c in vector.items()} for vector in found)
                return [self._context.from_dict(one) for one in terms]
