r"""Real fields for exact algebra: arithmetic with signs, square roots and factors of polynomials.

Rational numbers are `Fraction`s.  Other numbers and symbols are elements of a SymPy domain: a real number field such as
$\mathbb Q(\sqrt 2)$, or the rational functions of some symbols; then every element that is not identically zero counts
as nonzero, and the field remembers which ones an answer relied on.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING, Any, TypeAlias, final

from liepoisson.algebra.coefficients import check_degree
from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.algebra.number_fields import NumberField, Rational, as_fmpq
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from sympy import Expr

Scalar: TypeAlias = Any
"""An element of the field: a Fraction or an element of a SymPy domain; + - * / are exact, and it is true if nonzero."""

_FACTOR_BITS = 128  # larger integers lose their small square factors only: factoring them may take minutes


@final
class RealRationals(NumberField):
    r"""The field $\mathbb Q$."""

    name = "Q"

    def number(self, value: Rational) -> Scalar:
        """A rational number as a Fraction."""
        return Fraction(int(value.numerator), int(value.denominator))

    def read(self, value: Exact) -> Scalar:
        """The Fraction itself."""
        return value

    def write(self, value: Scalar) -> Exact:
        """The Fraction itself."""
        return value

    def is_constant(self, value: Scalar) -> bool:
        """True: there are no symbols."""
        return True

    def sign(self, value: Scalar) -> int:
        """The sign of a nonzero number."""
        return 1 if value > 0 else -1

    def extract_square(self, value: Scalar) -> tuple[Scalar, Scalar]:
        r"""Elements (r, d) with value = $r^2 d$; d = 1 if the value is a square.

        $p/q = (s/q)^2\, d$ with $pq = s^2 d$, d square-free (for numbers of more than 128 bits: nearly).
        """
        root, radicand = _integer_square(value.numerator * value.denominator)
        return Fraction(root, value.denominator), Fraction(radicand)

    def factors(self, polynomial: Sequence[Scalar]) -> list[list[Scalar]]:
        """The distinct monic irreducible factors of a polynomial, from the leading coefficient down, by FLINT."""
        from flint import fmpq_poly

        given = fmpq_poly([as_fmpq(c) for c in reversed(polynomial)])
        found = [[Fraction(int(c.p), int(c.q)) for c in reversed(list(f))] for f, _ in given.factor()[1]]
        return sorted([[c / f[0] for c in f] for f in found], key=lambda f: (len(f), f))

    def rely_on(self, value: Scalar) -> None:
        """Nothing to note: a nonzero number is not zero."""

    @property
    def conditions(self) -> tuple[Expr, ...]:
        """None: there are no symbols."""
        return ()

    def real_roots(self, polynomial: Sequence[Scalar]) -> int:
        """Number of distinct real roots, by Sturm's theorem."""
        from sympy import Dummy, Poly

        return int(Poly.from_list([to_sympy(c) for c in polynomial], Dummy("x")).count_roots())


def _integer_square(number: int) -> tuple[int, int]:
    """Integers (s, d) with number = s^2 d."""
    from flint import fmpz

    sign, size = (1 if number > 0 else -1), abs(number)
    if isqrt(size) ** 2 == size:
        return isqrt(size), sign
    known = fmpz(size).factor() if size.bit_length() <= _FACTOR_BITS else fmpz(size).factor_smooth(20)
    root, radicand, rest = 1, sign, size
    for prime, power in known:
        if int(prime).bit_length() > _FACTOR_BITS:
            continue
        root *= int(prime) ** (power // 2)
        radicand *= int(prime) ** (power % 2)
        rest //= int(prime) ** power
    cofactor = isqrt(rest)
    return (root * cofactor, radicand) if cofactor**2 == rest else (root, radicand * rest)


@final
class ExtendedField(NumberField):
    """Rational numbers with other real numbers or symbols adjoined, as a SymPy domain.

    Raises:
        ParameterError: numbers that SymPy has no exact field for (several transcendental ones, or irrational numbers
            beside symbols).
    """

    def __init__(self, values: Sequence[Expr]) -> None:
        from sympy.polys.constructor import construct_domain

        if not any(value.free_symbols for value in values):
            check_degree(values)
        domain, elements = construct_domain(list(values), field=True, extension=True)
        self._domain: Any = domain
        # of an algebraic number that is read alone, SymPy looks for the minimal polynomial, which takes seconds
        self._known: dict[Expr, Any] = dict(zip(values, elements, strict=True)) if self._domain.is_Algebraic else {}
        symbols: Sequence[Any] = () if self._domain.is_Algebraic else getattr(self._domain, "symbols", ())
        numbers = [s for s in symbols if not s.is_Symbol]
        # An algebraic number that is taken for a free generator could vanish unnoticed.
        if self._domain.is_EX or (numbers and (len(symbols) > 1 or numbers[0].is_algebraic is not False)):
            shown = ", ".join(dict.fromkeys(str(v) for v in values if not v.is_Rational))
            raise ParameterError(
                f"wanted rational numbers, algebraic numbers, or names with rational coefficients; got {shown}. "
                "Give values to the names, or rational values to the numbers."
            )
        self._has_symbols = bool(symbols) and not numbers
        self._relied: dict[Expr, None] = {}
        self.name = f"Q({', '.join(map(str, symbols))})" if symbols else _number_field_name(self._domain)

    def number(self, value: Rational) -> Scalar:
        """The element for a rational number."""
        return self.read(Fraction(int(value.numerator), int(value.denominator)))

    def read(self, value: Exact) -> Scalar:
        """The element of the domain; a denominator that contains symbols is noted as nonzero."""
        expression = to_sympy(value)
        element = self._known[expression] if expression in self._known else self._domain.from_sympy(expression)
        if self._has_symbols and element:
            self._note(self._domain.to_sympy(element).as_numer_denom()[1])
        return element

    def write(self, value: Scalar) -> Exact:
        """A Fraction if it is rational, else a SymPy expression."""
        expression = self._domain.to_sympy(value)
        return Fraction(int(expression.p), int(expression.q)) if expression.is_Rational else expression

    def is_constant(self, value: Scalar) -> bool:
        """Whether no symbol occurs."""
        return not self._has_symbols or not self._domain.to_sympy(value).free_symbols

    def sign(self, value: Scalar) -> int:
        """The sign of a nonzero element, for all real values of the symbols.

        Raises:
            ParameterError: it depends on symbols.
        """
        from sympy import factor

        expression = factor(self._domain.to_sympy(value))
        real = _real(expression)
        if real.is_nonnegative:
            return 1
        if real.is_nonpositive:
            return -1
        raise ParameterError(
            f"the answer depends on the sign of {expression}; got no values for "
            f"{', '.join(sorted(map(str, expression.free_symbols)))}. Substitute numbers first."
        )

    def extract_square(self, value: Scalar) -> tuple[Scalar, Scalar]:
        """Elements (r, d) with value = r^2 d, from even powers of factors; in a number field a square is recognised."""
        if not self._has_symbols:
            roots = [-f[1] for f in self.factors([self.one, self.zero, -value]) if len(f) == 2]
            if roots:
                return roots[0], self.one
            expression = self._domain.to_sympy(value)
            if not expression.is_Rational:
                return self.one, value
        else:
            expression = self._domain.to_sympy(value)
        return self._extract_factors(expression)

    def _extract_factors(self, expression: Any) -> tuple[Scalar, Scalar]:
        from sympy import factor_list

        top, bottom = expression.as_numer_denom()
        factored: Any = factor_list(top * bottom)
        content, powers = factored
        number, radicand = _integer_square(int(content))
        root = self._domain.from_sympy(to_sympy(Fraction(number)) / bottom)
        left = self._domain.from_sympy(to_sympy(Fraction(radicand)))
        for base, power in powers:
            element = self._domain.from_sympy(base)
            root, left = root * element ** (int(power) // 2), left * element ** (int(power) % 2)
        return root, left

    def factors(self, polynomial: Sequence[Scalar]) -> list[list[Scalar]]:
        """The distinct monic irreducible factors of a polynomial, from the leading coefficient down, by SymPy."""
        from sympy import Dummy, Poly

        found = Poly.from_list(list(polynomial), Dummy("x"), domain=self._domain).factor_list()[1]
        lists = [[self._domain.from_sympy(c) for c in f.all_coeffs()] for f, _ in found]
        return sorted([[c / f[0] for c in f] for f in lists], key=lambda f: (len(f), str(f)))

    def rely_on(self, value: Scalar) -> None:
        """Note the factors of the element that can vanish for real values of the symbols."""
        if self._has_symbols and value:
            top, bottom = self._domain.to_sympy(value).as_numer_denom()
            self._note(top)
            self._note(bottom)

    @property
    def conditions(self) -> tuple[Expr, ...]:
        """The factors relied on, each once: they must not vanish for the answers so far to hold."""
        return tuple(sorted(self._relied, key=str))

    def real_roots(self, polynomial: Sequence[Scalar]) -> int:
        """Not known here.

        Raises:
            ParameterError: in any case.
        """
        raise ParameterError(
            f"real roots of a polynomial of degree {len(polynomial) - 1} are counted for rational coefficients; "
            f"got coefficients in {self.name}. Use rational entries."
        )

    def _note(self, polynomial: Any) -> None:
        from sympy import factor_list

        for base, _ in factor_list(polynomial)[1]:
            if base.free_symbols and not _real(base).is_positive and not _real(base).is_negative:
                self._relied.setdefault(base, None)


def _real(expression: Any) -> Any:
    from sympy import Dummy

    names = [s for s in expression.free_symbols if s.is_real is None]
    return expression.subs({s: Dummy(s.name, real=True) for s in names})


def _number_field_name(domain: Any) -> str:
    generators: Iterable[Any] = getattr(domain, "orig_ext", None) or ()
    shown = ", ".join(str(getattr(g, "as_expr", lambda g=g: g)()) for g in generators)
    return f"Q({shown})" if shown else "Q"


def real_field(values: Iterable[Exact]) -> RealField:
    """The smallest of our fields that contains the values.

    Raises:
        ParameterError: see `ExtendedField`.
    """
    given = list(dict.fromkeys(values))
    if all(isinstance(value, Fraction) for value in given):
        return RealRationals()
    expressions = [to_sympy(value) for value in given]
    return RealRationals() if all(e.is_Rational for e in expressions) else ExtendedField(expressions)


RealField = RealRationals | ExtendedField
"""A field inside the real numbers; symbols stand for real numbers."""


@final
class Surd:
    r"""A sum $\sum_S c_S \prod_{d \in S} \sqrt d$ of square roots of elements d of a field, with coefficients in it.

    An identity between surds that follows from $\sqrt d \sqrt d = d$ is decided exactly.  A surd that is not formally
    zero may still vanish, for example $\sqrt 6 - \sqrt 2 \sqrt 3$: use `norm`.
    """

    __slots__ = ("terms",)

    def __init__(self, terms: dict[frozenset[Scalar], Scalar]) -> None:
        self.terms = {roots: c for roots, c in terms.items() if c}

    @classmethod
    def of(cls, value: Scalar) -> Surd:
        """An element of the field itself."""
        return cls({frozenset(): value})

    @classmethod
    def root(cls, field: RealField, value: Scalar) -> Surd:
        """The square root of an element (up to sign, if it is a square in the field)."""
        factor, radicand = field.extract_square(value)
        return cls({frozenset() if radicand == field.one else frozenset([radicand]): factor})

    @property
    def radicands(self) -> set[Scalar]:
        """The elements whose roots occur."""
        return {d for roots in self.terms for d in roots}

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __add__(self, other: Surd) -> Surd:
        terms = dict(self.terms)
        for roots, c in other.terms.items():
            terms[roots] = terms[roots] + c if roots in terms else c
        return Surd(terms)

    def __neg__(self) -> Surd:
        return Surd({roots: -c for roots, c in self.terms.items()})

    def __sub__(self, other: Surd) -> Surd:
        return self + -other

    def __mul__(self, other: Surd | Scalar) -> Surd:
        if not isinstance(other, Surd):
            return Surd({roots: c * other for roots, c in self.terms.items()})
        total = Surd({})
        for left, a in self.terms.items():
            for right, b in other.terms.items():
                c = a * b
                for shared in left & right:
                    c = c * shared
                total = total + Surd({left ^ right: c})
        return total

    def field_value(self) -> Scalar:
        """The value of a surd without roots, not zero."""
        ((roots, value),) = self.terms.items()
        assert not roots
        return value

    def conjugate(self, radicand: Scalar) -> Surd:
        """The surd with the sign of one root changed."""
        return Surd({roots: -c if radicand in roots else c for roots, c in self.terms.items()})

    def norm(self) -> Scalar:
        """The product of all conjugates, an element of the field (or 0): the surd is not zero if this is not."""
        product = self
        for radicand in self.radicands:
            product = product * product.conjugate(radicand)
        return product.terms.get(frozenset(), 0)

    def write(self, field: RealField) -> Exact:
        """The exact value: a Fraction if it is rational, else a SymPy expression."""
        if not self.terms:
            return Fraction(0)
        if set(self.terms) == {frozenset()}:
            return field.write(self.terms[frozenset()])
        from sympy import S, sqrt

        total: Any = S.Zero
        for roots, c in self.terms.items():
            term: Any = to_sympy(field.write(c))
            for radicand in roots:
                term *= sqrt(to_sympy(field.write(radicand)))
            total += term
        return total
