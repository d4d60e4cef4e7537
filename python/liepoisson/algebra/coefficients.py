r"""The exact field that given coefficients generate: structure constants, entries of matrices, terms of a bracket.

* rational numbers: $\mathbb Q$, its elements are Fractions;
* numbers such as $\sin(2\pi/7)$ or $\sqrt 2$, times one common power of pi: a cyclotomic field.  The power is set
  aside as a scale: ranks, Casimirs, ideals and the Jacobi identity do not change when all structure constants are
  multiplied by a number, and what is homogeneous in them is written with its power of the scale;
* other algebraic numbers, and symbols: a SymPy domain such as $\mathbb Q(\sqrt[3]{2})$ or $\mathbb Q(\epsilon)$.
  Symbols are generic.

In these equality is decided exactly, and so it is with one number such as pi or log(2).  Beyond them (functions of
symbols, several logarithms) SymPy is asked to simplify, which may fail to see that a number vanishes; `decides` says
so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property
from itertools import combinations
from math import isqrt, prod
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.cyclotomic import CyclotomicField, cyclotomic_images
from liepoisson.algebra.exact_numbers import MAX_DEGREE, Exact, irrational_parts, is_zero, largest_degree, to_sympy
from liepoisson.algebra.number_fields import Element, NumberField, Rational
from liepoisson.algebra.residues import Residues
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from sympy import Expr

_NO_TABLE: dict[Any, Element] = {}


@dataclass(frozen=True)
class Coefficients(NumberField):
    r"""A field that contains given values.

    Attributes:
        domain: None for $\mathbb Q$, else a CyclotomicField or a SymPy domain.
        scale: What the given values were divided by, a power of pi.
        table: The elements that stand for the given values.
    """

    domain: Any = None
    scale: Exact = Fraction(1)
    table: Mapping[Any, Element] = field(default_factory=_NO_TABLE.copy, repr=False)

    @classmethod
    def containing(cls, values: Iterable[Exact]) -> Coefficients:
        """The smallest such field that contains the values."""
        given = list(dict.fromkeys(values))
        if all(isinstance(value, Fraction) for value in given):
            return cls()
        expressions = list(dict.fromkeys(to_sympy(value) for value in given))
        if not any(e.free_symbols for e in expressions):
            if all(e.is_Rational for e in expressions):
                return cls()
            if found := cls._cyclotomic(expressions):
                return found
        domain, elements = _domain(expressions)
        return cls(domain, table=dict(zip(expressions, elements, strict=True)))

    @classmethod
    def _cyclotomic(cls, expressions: list[Any]) -> Coefficients | None:
        """The values without their common power of pi, if they are cyclotomic numbers then."""
        from sympy import S, pi, tan

        irrational = list(irrational_parts(expressions))
        if len(irrational) == 1 and isinstance(irrational[0], tan):
            return None  # a tangent alone is written as it is
        powers = {e.as_powers_dict().get(pi, S.Zero) for e in expressions if e != 0}
        if len(powers) != 1:
            return None
        scale = pi ** powers.pop()
        images = cyclotomic_images([e / scale for e in expressions])
        if images is None:
            return None
        domain = next(iter(images.values())).field
        return cls(domain, scale, {e: images[e / scale] for e in expressions})

    @property
    def is_rational(self) -> bool:
        r"""Whether this is $\mathbb Q$."""
        return self.domain is None

    @property
    def is_cyclotomic(self) -> bool:
        """Whether this is a cyclotomic field."""
        return isinstance(self.domain, CyclotomicField)

    @property
    def parameters(self) -> tuple[Expr, ...]:
        """The symbols of a field of rational functions; they are taken as generic."""
        return tuple(self.domain.symbols) if getattr(self.domain, "is_FractionField", False) else ()

    @cached_property
    def decides(self) -> bool:
        """Whether an element that is not found zero is certainly not zero: no relations hide in the field.

        They do between generators such as sin(a) and cos(a), which SymPy takes for independent.  One transcendental
        number beside symbols has none.
        """
        others = [s for s in self.parameters if not s.is_Symbol]
        return not getattr(self.domain, "is_EX", False) and len(others) <= 1 and all(map(_is_transcendental, others))

    def read(self, value: Exact) -> Element:
        """The element for one of the given values, divided by the scale.

        Over Q, and over SymPy domains, for any other value in the field as well.
        """
        if self.is_rational:
            rational: Any = value
            return value if isinstance(value, Fraction) else Fraction(int(rational.p), int(rational.q))
        expression = to_sympy(value)
        if expression in self.table or self.is_cyclotomic:
            return self.table[expression]
        return self.domain.from_sympy(expression)

    def number(self, value: Rational) -> Element:
        """The element for a rational number."""
        if self.is_rational:
            return Fraction(value) if isinstance(value, int) else Fraction(int(value.numerator), int(value.denominator))
        if self.is_cyclotomic:
            return self.domain.number(value)
        from sympy import QQ

        return self.domain.convert_from(QQ(int(value.numerator), int(value.denominator)), QQ)

    def write(self, element: Element, degree: int = 0) -> Exact:
        r"""The exact value of an element that is homogeneous of a degree in the given values; a Fraction over Q."""
        if self.is_rational:
            return Fraction(element)
        return self.domain.to_sympy(element) * to_sympy(self.scale) ** degree

    def to_sympy(self, element: Element, degree: int = 0) -> Expr:
        """The exact value (see `write`) as an expression."""
        return to_sympy(self.write(element, degree))

    def vanishes(self, element: Element) -> bool:
        """Whether an element is zero; where the field does not decide, SymPy is asked to simplify it."""
        return not element or (not self.decides and is_zero(self.to_sympy(element)))

    def residues(self, seed: int, skipped: int = 0) -> Residues | None:
        """A homomorphism to the integers modulo a large prime; parameters go to random residues.

        None for domains in which SymPy only simplifies expressions.

        Args:
            seed: Of the random residues.
            skipped: How many primes to pass over: those modulo which a coefficient is not defined, say.
        """
        if self.is_rational:
            return Residues.of_rationals(skipped)
        if self.is_cyclotomic:
            return Residues.of_cyclotomic(self.domain.order, skipped)
        return Residues.of_domain(self.domain, seed, skipped)


def _is_transcendental(number: Any) -> bool:
    """Whether a number certainly is, by the theorem of Hermite and Lindemann."""
    from sympy import E, atan, cos, cosh, exp, log, pi, sin, sinh, tan, tanh

    if isinstance(number, (exp, log, sin, cos, tan, sinh, cosh, tanh, atan)):
        x: Any = number.args[0]
        return bool(x.is_Rational and x != 0 and not (isinstance(number, log) and x == 1))
    return number in {pi, E}


def check_degree(expressions: Iterable[Expr]) -> None:
    """Refuse numbers whose field may be of so large a degree that SymPy does not find it in any time.

    Raises:
        ParameterError: they are such numbers.
    """
    given = list(expressions)
    if (degree := largest_degree(given)) > MAX_DEGREE:
        shown = ", ".join(sorted(map(str, irrational_parts(given))))
        raise ParameterError(
            f"wanted algebraic numbers in a field of degree at most {MAX_DEGREE}; got {shown:.200}, whose field may "
            f"have the degree {degree}. Give rational numbers in the place of some, or names."
        )


def _domain(expressions: list[Any]) -> tuple[Any, list[Element]]:
    """The SymPy domain that the expressions generate, and their elements.

    For roots times symbols these are rational functions over the roots, which SymPy alone does not find.
    """
    from sympy import QQ, CoercionFailed, Pow, Symbol
    from sympy.polys.constructor import construct_domain

    if not any(e.free_symbols for e in expressions):  # with symbols SymPy looks for no such field
        check_degree(expressions)
    constructed: Any = construct_domain(expressions, field=True, extension=True)
    symbols = sorted({s for e in expressions for s in e.free_symbols}, key=str)
    roots = sorted({r for e in expressions for r in e.atoms(Pow) if r.is_number and r.is_algebraic}, key=str)
    if not constructed[0].is_EX or not symbols or not roots or not all(isinstance(s, Symbol) for s in symbols):
        return constructed
    if not all(isinstance(part, Pow) for part in irrational_parts(expressions)):
        return constructed  # whether a sine lies in the field of the roots, SymPy may ask for ever
    check_degree(roots)
    functions: Any = QQ.algebraic_field(*roots).frac_field(*symbols)
    try:
        return functions, [functions.from_sympy(expression) for expression in expressions]
    except (CoercionFailed, ValueError):  # one of both, after the kind of expression that does not fit
        return constructed


def quadratic_roots(a: Fraction, b: Fraction, c: Fraction) -> tuple[Expr, Expr]:
    r"""The zeros of $a x^2 + b x + c$, with the square root of a squarefree number."""
    from sympy import sqrt

    step: Any = sqrt(to_sympy(b * b - 4 * a * c)) / to_sympy(2 * a)
    centre = to_sympy(-b / (2 * a))
    return centre + step, centre - step


def square_root_field(values: Iterable[Expr]) -> Coefficients:
    """The field that the square roots in some numbers generate."""
    independent: list[int] = []
    for d in sorted({d for value in values for d in _radicands(value)}, key=lambda d: (abs(d), d)):
        subsets = (s for n in range(len(independent) + 1) for s in combinations(independent, n))
        if not any(_is_square(d * prod(s)) for s in subsets):
            independent.append(d)
    return _field(tuple(independent))


def square_root_element(value: Expr, field: Coefficients) -> Any:
    """A number with these square roots as an element of the field."""
    from sympy import Add, I, Mul

    total = field.zero
    for term in Add.make_args(value.expand()):
        product = field.one
        for factor in Mul.make_args(term):
            number: Any = factor
            if number.is_Rational:
                product = product * field.number(Fraction(int(number.p), int(number.q)))
            elif number == I:
                product = product * _root(-1, field.domain)
            else:
                product = product * _root(int(number**2), field.domain)  # SymPy has sqrt(2/3) as sqrt(6)/3
        total = total + product
    return total


@cache
def _field(independent: tuple[int, ...]) -> Coefficients:
    """The field of some square roots, none of which is a product of others."""
    from sympy import QQ, sqrt

    return Coefficients(QQ.algebraic_field(*map(sqrt, independent))) if independent else Coefficients()


@cache
def _root(d: int, domain: Any) -> Any:
    """The square root of an integer as an element of a field, for which SymPy factors a polynomial over it."""
    from sympy import sqrt

    return domain.from_sympy(sqrt(d))


def _radicands(value: Expr) -> set[int]:
    """The integers under the square roots of a number, -1 for i."""
    from sympy import I, Pow

    found = {-1} if value.has(I) else set[int]()
    return found | {int(p.base) for p in value.atoms(Pow) if p.base.is_Integer and not p.exp.is_Integer}


def _is_square(d: int) -> bool:
    return d >= 0 and isqrt(d) ** 2 == d
