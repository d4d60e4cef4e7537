r"""Gröbner bases over the rational numbers: computed modulo primes, lifted, and proved.

The generators are made homogeneous, $f^h = h^{\deg f} f(x/h)$. Their reduced Gröbner basis is computed modulo one prime
after the other, and its coefficients are lifted to rational numbers as soon as these predict the next prime. The lifted
polynomials G are then checked over $\mathbb Q$:

1. every $f^h$ has the remainder zero modulo G, so the ideal of the generators lies in that of G;
2. all S-polynomials of G have the remainder zero, so G is a Gröbner basis of its own ideal;
3. G has the leading monomials of a complete run modulo a prime.

From these follows that the two ideals are equal. In degree n let $I_n$, $(I_p)_n$ and $\langle G\rangle_n$ be the parts
of the ideals of the $f^h$, of these modulo p, and of G. A matrix has modulo p at most the rank that it has over
$\mathbb Q$, so $\dim\,(I_p)_n\le\dim I_n$; by 1, $\dim I_n\le\dim\langle G\rangle_n$; and by 2 and 3,
$\dim\langle G\rangle_n = \dim\,(I_p)_n$. With h = 1, G is a Gröbner basis of the ideal of the generators. Nothing
is left to chance but the time.

The leading monomials tell the dimension and the degree. The standard monomials, which none of them divides, are counted
by the Hilbert series $K(t)/(1-t)^n$. Adding a leading monomial m changes the numerator by $-t^{\deg m}K_{I:m}$. With
dimension d the degree is $K(t)/(1-t)^{n-d}$ at t = 1.

References: [arnold2003]; [cox2015], chapter 9, for the Hilbert series.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpz_poly, nmod_mpoly_ctx

from liepoisson.algebra.flint_pickles import register
from liepoisson.algebra.ideals.buchberger import Poly, Run, are_groebner, buchberger, leading, reduced, remainder
from liepoisson.algebra.ideals.limits import Budget, Limits
from liepoisson.algebra.residues import Lift, primes
from liepoisson.algebra.sparse_polynomials import Monomial, divides

register()  # results have polynomials


@dataclass(frozen=True, repr=False)
class GroebnerBasis:
    """The reduced Gröbner basis of an ideal, proved.

    Attributes:
        context: FLINT's context of the polynomials, with the names of the variables and the order of monomials.
        polynomials: The basis, monic, by increasing degree; empty for the zero ideal.
    """

    context: Any
    polynomials: tuple[Poly, ...]

    def __repr__(self) -> str:
        names = ", ".join(self.names)
        shown = ", ".join(str(p) for p in self.polynomials[:4])
        more = f", ... ({len(self.polynomials)} polynomials)" if len(self.polynomials) > 4 else ""
        return f"<Groebner basis in {names}: {shown}{more}>"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the variables."""
        return tuple(self.context.names())

    @cached_property
    def leads(self) -> tuple[Monomial, ...]:
        """The exponents of the leading monomials."""
        return tuple(leading(p) for p in self.polynomials)

    @property
    def is_one(self) -> bool:
        """Whether the ideal contains 1: there is no solution, not even a complex one."""
        return any(not any(lead) for lead in self.leads)

    @cached_property
    def dimension(self) -> int:
        """The dimension of the set of complex solutions, -1 if it is empty."""
        return dimension(self.leads, len(self.names))

    @cached_property
    def degree(self) -> int:
        """The degree of the ideal; in dimension 0 the number of complex solutions with multiplicities."""
        return degree(self.leads, len(self.names))

    @cached_property
    def words(self) -> int:
        """The size of the largest coefficient in machine words."""
        return _words(self.polynomials)

    def remainder(self, p: Poly, budget: Budget | None = None) -> Poly:
        """The normal form of a polynomial modulo the ideal."""
        return remainder(p, self.polynomials, budget, self.words, self.leads)

    def contains(self, p: Poly) -> bool:
        """Whether a polynomial lies in the ideal."""
        return not self.remainder(p)

    def is_standard(self, monomial: Monomial) -> bool:
        """Whether a monomial is no multiple of a leading one."""
        return not any(divides(lead, monomial) for lead in self.leads)

    def standard_monomials(self) -> list[Monomial]:
        """The monomials that are no multiples of leading ones, a basis of the quotient; in dimension 0 or less."""
        return standard_monomials(self.leads, len(self.names))


def groebner_basis(generators: Sequence[Poly], limits: Limits | Budget | None = None) -> GroebnerBasis:
    """The reduced Gröbner basis of the ideal that some polynomials generate, in the order of their context.

    Args:
        generators: Polynomials over the rationals of one context, at least one; its order is degrevlex or lex.
        limits: What it may cost.

    Raises:
        NotDecidedError: the limits were reached.
    """
    budget = limits if isinstance(limits, Budget) else (limits or Limits()).budget()
    context = generators[0].context()
    given = [g for g in generators if g]
    if any(g.is_constant() for g in given):
        return GroebnerBasis(context, (context.constant(1),))
    if len(given) < 2:
        return GroebnerBasis(context, reduced(given))
    lifted = _Lift(_homogeneous(given), budget).proved()
    affine = [_affine(p, context) for p in lifted]
    return GroebnerBasis(context, reduced(affine, budget, _words(affine)))


class _Lift:
    """The homogeneous basis, from run to run."""

    def __init__(self, generators: list[Poly], budget: Budget) -> None:
        self._generators, self._budget = generators, budget
        self._context = generators[0].context()
        self._primes = primes()

    def proved(self) -> list[Poly]:
        """The basis over the rationals."""
        while True:
            _, first = self._run(frozenset())
            shape = [leading(p) for p in first.basis]
            found = self._with_shape(first, shape)
            if found is not None:
                return found

    def _with_shape(self, first: Run, shape: list[Monomial]) -> list[Poly] | None:
        """The proved basis with these leading monomials; None if another prime, or the proof, is against them."""
        residues = [Lift() for _ in shape]
        n_primes, attempt = 0, 1
        candidate: list[Poly] | None = None
        while True:
            p, run = self._run(first.idle)
            if [leading(q) for q in run.basis] != shape:
                return None
            terms = [{tuple(map(int, m)): int(c) for m, c in q.terms()} for q in run.basis]
            if candidate is not None and self._predicts(candidate, terms, p):
                return candidate if self._is_proved(candidate, shape) else None
            for kept, new in zip(residues, terms, strict=True):
                kept.add(new, p)
            n_primes += 1
            self._budget.spend(0.4 * n_primes * sum(map(len, terms)) / 3, "lifting")
            candidate = None
            if n_primes >= attempt:
                candidate = self._lifted(residues)
                attempt = n_primes + max(1, n_primes // 4)

    def _lifted(self, residues: list[Lift]) -> list[Poly] | None:
        found: list[Poly] = []
        for one in residues:
            terms = one.lifted()
            if terms is None:
                return None
            found.append(self._context.from_dict(terms))
        return found

    def _predicts(self, candidate: list[Poly], terms: list[dict[Monomial, int]], p: int) -> bool:
        return all(
            {m: c for m, c in (_residues_of(q.terms(), p) or {}).items() if c} == found
            for q, found in zip(candidate, terms, strict=True)
        )

    def _run(self, idle: frozenset[int]) -> tuple[int, Run]:
        """A prime that divides no denominator, and the basis modulo it."""
        while True:
            p = next(self._primes)
            modular = nmod_mpoly_ctx.get(self._context.names(), modulus=p, ordering=self._context.ordering())
            images = [_residues_of(((tuple(map(int, m)), c) for m, c in g.terms()), p) for g in self._generators]
            known = [image for image in images if image is not None]
            if len(known) == len(images):
                return p, buchberger([modular.from_dict(image) for image in known], self._budget, idle)

    def _is_proved(self, candidate: list[Poly], shape: list[Monomial]) -> bool:
        """The three steps; the shape is that of a complete run."""
        if [leading(p) for p in candidate] != shape:
            return False
        words = _words(candidate)
        in_ideal = all(not remainder(g, candidate, self._budget, words, shape) for g in self._generators)
        return in_ideal and are_groebner(candidate, self._budget, words)


def _residues_of(terms: Iterable[tuple[Monomial, fmpq]], p: int) -> dict[Monomial, int] | None:
    """The coefficients modulo a prime, or None if it divides a denominator."""
    found: dict[Monomial, int] = {}
    for monomial, c in terms:
        denominator = int(c.q) % p
        if not denominator:
            return None
        found[monomial] = int(c.p) * pow(denominator, -1, p) % p
    return found


def _homogeneous(generators: Sequence[Poly]) -> list[Poly]:
    """The polynomials with a last variable that makes all of their terms of one degree, primitive."""
    context = generators[0].context()
    wider = fmpq_mpoly_ctx.get((*context.names(), new_name(context.names(), "h")), context.ordering())
    found: list[Poly] = []
    for g in generators:
        total = g.total_degree()
        terms = {(*map(int, m), int(total) - sum(map(int, m))): c for m, c in g.terms()}
        found.append(wider.from_dict(terms) / g.leading_coefficient())
    return found


def _affine(p: Poly, context: Any) -> Poly:
    """The polynomial with 1 for the last variable."""
    return context.from_dict({tuple(map(int, m))[:-1]: c for m, c in p.terms()})


def _words(polynomials: Sequence[Poly]) -> int:
    bits = max((max(int(c.p).bit_length(), int(c.q).bit_length()) for p in polynomials for c in p.coeffs()), default=1)
    return 1 + bits // 64


def new_name(names: Collection[str], letter: str = "t") -> str:
    """A name that no variable has: a letter, as often as is needed."""
    return next(name for k in count(1) if (name := letter * k) not in names)


def rational_context(names: Sequence[str], *, lexicographic: bool = False) -> Any:
    """FLINT's context of polynomials over the rationals, in degree reverse lexicographic order by default."""
    return fmpq_mpoly_ctx.get(tuple(names), Ordering.lex if lexicographic else Ordering.degrevlex)


def dimension(leads: Sequence[Monomial], n: int) -> int:
    """The largest number of variables of which no generator is a product; -1 if 1 is a generator."""
    if any(not any(m) for m in leads):
        return -1
    supports = {frozenset(k for k, power in enumerate(m) if power) for m in leads}
    return n - _least_cover([s for s in supports if not any(other < s for other in supports)], n)


def _least_cover(supports: Sequence[frozenset[int]], most: int) -> int:
    """The smallest number of variables that meet all supports."""
    if not supports:
        return 0
    if most <= 0:
        return 1
    smallest = min(supports, key=len)
    best = most
    for k in smallest:
        best = min(best, 1 + _least_cover([s for s in supports if k not in s], best - 1))
    return best


def degree(leads: Sequence[Monomial], n: int) -> int:
    """The degree of the ideal, in dimension 0 the number of standard monomials; 0 if 1 is a generator."""
    d = dimension(leads, n)
    if d < 0:
        return 0
    numerator = _numerator(_minimal(leads))
    return int((numerator // fmpz_poly([1, -1]) ** (n - d))(1))


def _numerator(generators: Sequence[Monomial]) -> fmpz_poly:
    if not generators:
        return fmpz_poly([1])
    if all(
        not any(a and b for a, b in zip(m, o, strict=True)) for i, m in enumerate(generators) for o in generators[:i]
    ):
        total = fmpz_poly([1])
        for m in generators:
            total *= 1 - fmpz_poly([0, 1]) ** sum(m)
        return total
    *others, last = sorted(generators, key=sum)
    quotients = _minimal([tuple(max(a - b, 0) for a, b in zip(m, last, strict=True)) for m in others])
    return _numerator(others) - fmpz_poly([0, 1]) ** sum(last) * _numerator(quotients)


def _minimal(monomials: Sequence[Monomial]) -> list[Monomial]:
    distinct = list(dict.fromkeys(monomials))
    return [m for m in distinct if not any(other != m and divides(other, m) for other in distinct)]


def standard_monomials(leads: Sequence[Monomial], n: int) -> list[Monomial]:
    """The monomials that no generator divides, by degree; of an ideal of dimension 0."""
    level: list[Monomial] = [(0,) * n] if all(any(m) for m in leads) else []
    found: list[Monomial] = []
    while level:
        found += level
        above = dict.fromkeys((*m[:k], m[k] + 1, *m[k + 1 :]) for m in level for k in range(n))
        level = [m for m in above if not any(divides(lead, m) for lead in leads)]
    return found
