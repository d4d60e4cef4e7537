r"""The part of a Hamiltonian that is a function of the Casimirs: it moves nothing, $J\nabla f(C) = 0$.

On a leaf, where $C = c$, the Hamiltonian is $H = (H - f(C)) + f(c)$.  Searches work with the first part, whose terms
are as large as what they move, and with the energy less the number f(c).

Products of the Casimirs that share monomials are taken together.  Their reduced echelon form leaves one part of H that
is the same for H and every $H + f(C)$, the normal form modulo their span.  Which multiple of a Casimir is in H is a
convention, though: of a rigid body it leaves two squares of three.  So H stays as it is in those monomials that the
normal form does not make smaller by a factor of `ORDINARY` each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.algebra.rational_polynomials import (
    MOST_TERMS,
    Expanded,
    RationalPolynomial,
    TooLargeError,
    in_words,
    multiplied,
)
from liepoisson.formula.arithmetic import expanded_terms

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket

ORDINARY = 16.0
"""Sizes that differ by less are of one order."""

_Terms = dict[tuple[int, ...], Any]
"""Coefficients by the sorted tuple of the numbers of the coordinates that are multiplied."""


@dataclass(frozen=True)
class CasimirPart:
    """A Hamiltonian as the sum of a moving part and of a function of the Casimirs.

    Attributes:
        moving: The moving part, a text if its coefficients are rational numbers; None if it is all of H.
        weights: The numbers before products of Casimirs, by the powers of C1, C2, ...
        other: The sum of further terms that are Casimirs, such as exp(C1).
    """

    moving: str | Expr | None
    weights: Mapping[tuple[int, ...], Exact]
    other: Expr | None

    def value(self, casimirs: Sequence[Exact], other: float = 0.0) -> Exact:
        """The function of the Casimirs where C1, C2, ... and `other` have these values."""
        total: Exact = Fraction(other)
        for powers, weight in self.weights.items():
            term = weight
            for c, power in zip(casimirs, powers, strict=True):
                for _ in range(power):
                    term = _product(term, c)
            total = _sum(total, term)
        return total


def casimir_part(bracket: Bracket, hamiltonian: RationalPolynomial | Expr) -> CasimirPart:
    """What in a Hamiltonian is a function of the Casimirs, as far as these are polynomials with rational numbers."""
    terms, rest = _read(bracket, hamiltonian)
    left, weights = _without(bracket, terms, always=False)
    still = [term for term in rest if all(bracket(term, x) == 0 for x in bracket.variables)]
    if not weights and not still:
        return CasimirPart(None, {}, None)
    moving = [term for term in rest if term not in still]
    if not moving and all(isinstance(c, Fraction) for c in left.values()):
        energy: Any = in_words(RationalPolynomial.of(left), bracket.coordinate_names_in_order)
    else:
        energy = sum(moving, start=_expression(left, bracket))
    return CasimirPart(energy, weights, cast("Any", sum(still)) if still else None)


def normal_form(bracket: Bracket, function: Expr) -> tuple[Expr, CasimirPart]:
    """A function modulo polynomials in the Casimirs, the same for all that differ by one; and what was taken out."""
    terms, rest = _read(bracket, function)
    left, weights = _without(bracket, terms, always=True)
    form = cast("Expr", sum(rest, start=_expression(left, bracket))) if weights else function
    return form, CasimirPart(form, weights, None)


def _read(bracket: Bracket, function: Any) -> tuple[_Terms, list[Any]]:
    """The terms of a function that are polynomials, and the others; of a large one all are among the latter."""
    if isinstance(function, RationalPolynomial):
        try:
            return dict(function.expanded), []
        except TooLargeError:
            return {}, []
    from sympy import Add, Poly

    if expanded_terms(function) > MOST_TERMS:
        return {}, []
    variables = bracket.variables
    parts = Add.make_args(function.expand())
    polynomial = [part for part in parts if cast("Any", part).is_polynomial(*variables)]
    terms: _Terms = {}
    for powers, c in Poly(Add(*polynomial), *variables).terms():
        if c != 0:
            value = Fraction(int(c.p), int(c.q)) if c.is_Rational else c
            terms[tuple(k for k, power in enumerate(powers) for _ in range(power))] = value
    return terms, [part for part in parts if part not in polynomial]


def _without(bracket: Bracket, terms: _Terms, *, always: bool) -> tuple[_Terms, dict[tuple[int, ...], Exact]]:
    """The terms without what is a combination of products of Casimirs, and the combination."""
    left, weights = dict(terms), dict[tuple[int, ...], Exact]()
    casimirs = bracket.polynomial_casimirs() if terms else None
    if casimirs is None:
        return left, weights
    try:
        products = dict(_products([c.expanded for c in casimirs], max(map(len, terms))))
    except TooLargeError:
        return left, weights
    for together in _sharing(products):
        monomials = {m for powers in together for m in products[powers]}
        before = {m: left[m] for m in monomials & left.keys()}
        if not before:
            continue
        after, taken = _reduced(before, {powers: products[powers] for powers in together})
        # a number alone, which comes last, is compared with what else is left
        if monomials == {()}:
            rest = [(c, before[()]) for m, c in left.items() if m]
        else:
            rest = [(c, before.get(m)) for m, c in after.items()]
        if taken and (always or all(_is_smaller(c, size) for c, size in rest)):
            left = {m: c for m, c in left.items() if m not in before} | after
            weights |= taken
    return left, weights


def _products(casimirs: Sequence[Expanded], degree: int) -> Iterator[tuple[tuple[int, ...], Expanded]]:
    """The products of Casimirs up to a degree, by their powers, 1 among them.

    Raises:
        TooLargeError: they have too many terms together.
    """
    found: list[tuple[tuple[int, ...], Expanded]] = [((0,) * len(casimirs), {(): Fraction(1)})]
    size = 1
    for k, casimir in enumerate(casimirs):
        own = max(map(len, casimir))
        for powers, product in found:  # grows: every product comes to its own multiple
            if own and max(map(len, product)) + own <= degree:
                more = multiplied(product, casimir)
                size += len(more)
                if size > MOST_TERMS:
                    raise TooLargeError
                found.append(((*powers[:k], powers[k] + 1, *powers[k + 1 :]), more))
    yield from found


def _sharing(products: Mapping[tuple[int, ...], Expanded]) -> list[list[tuple[int, ...]]]:
    """The products in groups without common monomials."""
    groups: list[tuple[set[tuple[int, ...]], list[tuple[int, ...]]]] = []
    for powers, product in products.items():
        monomials, names = set(product), [powers]
        apart: list[tuple[set[tuple[int, ...]], list[tuple[int, ...]]]] = []
        for own, others in groups:
            if own.isdisjoint(monomials):
                apart.append((own, others))
            else:
                monomials, names = monomials | own, others + names
        groups = [*apart, (monomials, names)]
    return [names for _, names in sorted(groups, key=lambda group: group[0] == {()})]


def _reduced(
    terms: _Terms, products: Mapping[tuple[int, ...], Expanded]
) -> tuple[_Terms, dict[tuple[int, ...], Exact]]:
    """The normal form of terms modulo the span of products, and the combination that was subtracted."""
    # Beside each monomial stands which products it comes from; these columns are behind all monomials.
    rows = [
        {**{(0, m): c for m, c in product.items()}, (1, powers): Fraction(1)} for powers, product in products.items()
    ]
    echelon = Echelon(Coefficients(), rows)
    left: dict[Any, Any] = {(0, m): c for m, c in terms.items()}
    for row in echelon.basis():
        lead = min(row)
        if lead in left:
            factor = left[lead]
            for key, c in row.items():
                left[key] = _sum(left.get(key, Fraction(0)), _product(factor, -c))
    left = {key: c for key, c in left.items() if c != 0}
    after = {m: c for (kind, m), c in left.items() if not kind}
    return after, {powers: -c for (kind, powers), c in left.items() if kind}


def _is_smaller(after: Any, before: Any) -> bool:
    """Whether a number is smaller than another one by a large factor; not where one of them is a symbol."""
    if before is None:
        return False
    if any(not isinstance(c, Fraction) and not c.is_number for c in (after, before)):
        return False
    return ORDINARY * abs(float(after)) <= abs(float(before))


def difference(a: Exact, b: Exact) -> Exact:
    """A difference of exact numbers."""
    return _sum(a, _product(b, Fraction(-1)))


def _sum(a: Any, b: Any) -> Any:
    return a + b if isinstance(a, Fraction) and isinstance(b, Fraction) else (to_sympy(a) + to_sympy(b)).expand()


def _product(a: Any, b: Any) -> Any:
    return a * b if isinstance(a, Fraction) and isinstance(b, Fraction) else (to_sympy(a) * to_sympy(b)).expand()


def _expression(terms: _Terms, bracket: Bracket) -> Any:
    from sympy import Add, Mul

    return Add(*(Mul(to_sympy(c), *(bracket.variables[k] for k in m)) for m, c in terms.items()))
