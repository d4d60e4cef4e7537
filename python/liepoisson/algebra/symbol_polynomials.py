r"""Polynomials with rational coefficients in symbols and in numbers such as $\sqrt 2$ and $\sin(2\pi/3)$.

Most coefficients of a bracket that are not rational, and most such parameters, are of this kind.  They are added and
multiplied, and values are inserted for symbols, without SymPy, whose import takes longer than many an integration.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from sympy import Expr


class Irrational(NamedTuple):
    r"""One of the irrational numbers $\sqrt q$, $\sin(\pi q)$, $\cos(\pi q)$ and $\pi^q$ with a rational q.

    Attributes:
        function: "sqrt", "sin", "cos" or "pi".
        argument: q.
    """

    function: str
    argument: Fraction

    def __str__(self) -> str:
        """The number as a formula."""
        if self.function == "pi":
            return f"pi^({self.argument})"
        return f"{self.function}({self.argument}{'' if self.function == 'sqrt' else '*pi'})"

    def expression(self) -> Expr:
        """The number as SymPy writes it."""
        import sympy

        q: Any = sympy.Rational(self.argument.numerator, self.argument.denominator)
        if self.function == "pi":
            return sympy.pi**q
        return getattr(sympy, self.function)(q if self.function == "sqrt" else q * sympy.pi)


Factor: TypeAlias = "str | Irrational"
"""A symbol by its name, or a number."""

Monomial: TypeAlias = tuple[Factor, ...]
"""The factors in the order of their texts."""


class SymbolPolynomial:
    """A sum of products of symbols and irrational numbers, with rational numbers before them.

    Args:
        terms: The rational numbers by monomials; those that are zero are left out.
    """

    __slots__ = ("_hash", "terms")

    def __init__(self, terms: Mapping[Monomial, Fraction]) -> None:
        self.terms: dict[Monomial, Fraction] = {m: c for m, c in terms.items() if c}
        self._hash: int | None = None

    @classmethod
    def of(cls, factor: Factor) -> SymbolPolynomial:
        """One symbol or number."""
        return cls({(factor,): Fraction(1)})

    @property
    def symbols(self) -> set[str]:
        """The names that occur."""
        return {factor for monomial in self.terms for factor in monomial if isinstance(factor, str)}

    @property
    def has_one_number(self) -> bool:
        r"""Whether all that is irrational in its terms is the same number, such as $\sin(2\pi/3)/\pi$, if anything is.

        It is one over the rational numbers then, so that the polynomial vanishes only without terms.
        """
        numbers = {tuple(f for f in monomial if isinstance(f, Irrational)) for monomial in self.terms} - {()}
        factors = [factor.function == "pi" for number in numbers for factor in number]
        return len(numbers) <= 1 and factors.count(True) <= 1 and factors.count(False) <= 1

    def at(self, values: Mapping[str, Fraction | SymbolPolynomial]) -> Fraction | SymbolPolynomial:
        """The polynomial with values for some symbols."""
        total: Fraction | SymbolPolynomial = Fraction(0)
        for monomial, c in self.terms.items():
            term: Fraction | SymbolPolynomial = c
            for f in monomial:
                term = term * (values[f] if isinstance(f, str) and f in values else SymbolPolynomial.of(f))
            total = total + term
        return total.simplest() if isinstance(total, SymbolPolynomial) else total

    def simplest(self) -> Fraction | SymbolPolynomial:
        """A Fraction in place of a polynomial that is a rational number as it is written."""
        return self.terms.get((), Fraction(0)) if self.terms.keys() <= {()} else self

    def formula(self) -> str:
        """The polynomial in the grammar of formulas."""
        return " + ".join("*".join(map(str, (f"({c})", *monomial))) for monomial, c in self.terms.items()) or "0"

    def __add__(self, other: Fraction | SymbolPolynomial) -> SymbolPolynomial:
        total = dict(self.terms)
        for monomial, c in _terms_of(other).items():
            total[monomial] = total.get(monomial, Fraction(0)) + c
        return SymbolPolynomial(total)

    __radd__ = __add__

    def __neg__(self) -> SymbolPolynomial:
        return SymbolPolynomial({monomial: -c for monomial, c in self.terms.items()})

    def __sub__(self, other: Fraction | SymbolPolynomial) -> SymbolPolynomial:
        return self + -other

    def __rsub__(self, other: Fraction) -> SymbolPolynomial:
        return -self + other

    def __mul__(self, other: Fraction | SymbolPolynomial) -> SymbolPolynomial:
        product: dict[Monomial, Fraction] = {}
        for first, c in self.terms.items():
            for second, d in _terms_of(other).items():
                monomial = tuple(sorted((*first, *second), key=str))
                product[monomial] = product.get(monomial, Fraction(0)) + c * d
        return SymbolPolynomial(product)

    __rmul__ = __mul__

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SymbolPolynomial) and self.terms == other.terms

    def __hash__(self) -> int:
        if self._hash is None:
            self._hash = hash(frozenset(self.terms.items()))
        return self._hash

    def __reduce__(self) -> tuple[type[SymbolPolynomial], tuple[dict[Monomial, Fraction]]]:
        """What is pickled: without the hash, which is another one in each process."""
        return SymbolPolynomial, (self.terms,)

    def __str__(self) -> str:
        """The polynomial as SymPy writes it."""
        ((monomial, c),) = self.terms.items() if len(self.terms) == 1 else [((), Fraction(0))]
        if len(monomial) != 1 or not isinstance(monomial[0], str):
            return str(expression_of(self))
        above, below = abs(c.numerator), "" if c.denominator == 1 else f"/{c.denominator}"
        return ("-" if c < 0 else "") + (f"{above}*" if above != 1 else "") + monomial[0] + below

    __repr__ = __str__


@lru_cache(maxsize=10_000)
def expression_of(polynomial: SymbolPolynomial) -> Expr:
    """The polynomial as a SymPy expression."""
    from sympy import Add, Mul, Rational, Symbol

    factors = {factor for monomial in polynomial.terms for factor in monomial}
    known: Any = {f: Symbol(f) if isinstance(f, str) else f.expression() for f in factors}
    terms = polynomial.terms.items()
    return Add(*(Mul(Rational(c.numerator, c.denominator), *map(known.get, monomial)) for monomial, c in terms))


def _terms_of(value: Fraction | SymbolPolynomial) -> Mapping[Monomial, Fraction]:
    return value.terms if isinstance(value, SymbolPolynomial) else {(): Fraction(value)}
