"""Coefficients of brackets and parameters as they are read without SymPy: polynomials in names, surds, sines and pi.

A formula is read so where all that is irrational in it is one number, which is then one over the rational numbers, too.
What is anything else is left to `liepoisson.formula.expression`, which alone says what is wrong with a formula.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

from liepoisson.algebra.exact_numbers import Coefficient, Exact
from liepoisson.algebra.symbol_polynomials import Factor, Irrational, SymbolPolynomial
from liepoisson.errors import LiePoissonError
from liepoisson.formula.arithmetic import Arithmetic, RefusedError
from liepoisson.formula.expression import Reader, evaluate
from liepoisson.formula.grammar import Call, Node, names_in, parse
from liepoisson.formula.scope import Scope
from liepoisson.inputs.names import CONSTANTS, FUNCTIONS, MATRIX_FUNCTIONS, NOT_FINITE

_MOST_TERMS, _MOST_FACTORS, _MOST_BITS = 20, 16, 256
"""Far below the limits of formulas, so that none that is refused there is taken here."""

_RATIONAL_SINES, _RATIONAL_COSINES = (1, 2, 6), (1, 2, 3)
"""Denominators of q with rational sin(pi*q) and cos(pi*q) (Niven, Irrational Numbers, 1956, corollary 3.12)."""


class _OtherKindError(Exception):
    """The formula is no such polynomial, or SymPy writes it otherwise than as a sum of its terms."""


def coefficient(tree: Node, text: str, scope: Scope) -> Coefficient:
    """The scalar that a part of a formula stands for, as `evaluate` reads it, if possible without SymPy.

    Raises:
        ExpressionError: as in `liepoisson.formula.expression.read_formula`.
    """
    try:
        found: Any = _CoefficientReader(text, scope, insert_values=True, scalars=_CoefficientArithmetic()).read(tree)
    except (_OtherKindError, RefusedError, LiePoissonError, ZeroDivisionError):
        return evaluate(tree, text, scope)
    if isinstance(found, SymbolPolynomial) and not found.has_one_number:
        return evaluate(tree, text, scope)
    return found


def parameter(text: str) -> Coefficient:
    """What a text stands for in which every name is that of a symbol: "sqrt(2)/2", "2*epsilon", "k*m".

    Raises:
        ExpressionError: as in `liepoisson.formula.expression.read_formula`.
        ParameterError: a name is too long.
    """
    tree = parse(text)
    taken = {*CONSTANTS, *FUNCTIONS}
    symbols = [name for name in names_in(tree) if name not in taken and name.lower() not in NOT_FINITE]
    return coefficient(tree, text, Scope(symbols=symbols))


class _CoefficientReader(Reader):
    """Turns a tree into a Fraction or a polynomial in symbols."""

    def symbol(self, name: str) -> Any:
        return SymbolPolynomial.of(name)

    def given(self, value: Coefficient) -> Any:
        return value

    def circle_number(self) -> Any:
        return SymbolPolynomial.of(Irrational("pi", Fraction(1)))

    def call(self, node: Call, arguments: Sequence[Any]) -> Any:
        if node.function in MATRIX_FUNCTIONS:
            raise _OtherKindError
        return super().call(node, arguments)


class _CoefficientArithmetic(Arithmetic):
    """Sums, products, powers and functions of Fractions and polynomials in symbols."""

    def sum(self, terms: Sequence[Exact]) -> Any:
        return _checked(sum(_known(terms), Fraction(0)))

    def product(self, factors: Sequence[Exact]) -> Any:
        polynomials = [factor for factor in _known(factors) if isinstance(factor, SymbolPolynomial)]
        if len(polynomials) > 1 and any(len(factor.terms) > 1 for factor in polynomials):
            raise _OtherKindError  # SymPy does not expand it
        total: Any = Fraction(1)
        for factor in _known(factors):
            total = total * factor
        return _checked(total)

    def reciprocal(self, divisor: Exact) -> Any:
        if isinstance(divisor, Fraction):
            return 1 / divisor
        factors, number = _only_term(divisor)
        if len(factors) != 1 or not isinstance(factors[0], Irrational) or factors[0].function not in ("sqrt", "pi"):
            raise _OtherKindError
        function, q = factors[0]
        inverse = Irrational(function, 1 / q if function == "sqrt" else -q)
        return SymbolPolynomial({(inverse,): 1 / number})

    def power(self, base: Exact, exponent: Exact) -> Any:
        if exponent == Fraction(1, 2):
            return self.apply("sqrt", base)
        if not isinstance(exponent, Fraction) or exponent.denominator != 1 or not 0 < exponent <= _MOST_FACTORS:
            raise _OtherKindError
        if isinstance(base, Fraction):
            return _checked(base ** int(exponent))
        _ = _only_term(base)
        return self.product([base] * int(exponent))

    def apply(self, function: str, argument: Exact) -> Any:
        if function == "sqrt" and isinstance(argument, Fraction) and argument > 0:
            p, q = argument.numerator, argument.denominator
            if max(p, q).bit_length() > _MOST_BITS or (isqrt(p) ** 2 == p and isqrt(q) ** 2 == q):
                raise _OtherKindError
            return SymbolPolynomial.of(Irrational(function, argument))
        rational = {"sin": _RATIONAL_SINES, "cos": _RATIONAL_COSINES}.get(function)
        factors, number = _only_term(argument)
        if rational is None or factors != (Irrational("pi", Fraction(1)),) or number.denominator in rational:
            raise _OtherKindError
        return SymbolPolynomial.of(Irrational(function, number))


def _known(values: Sequence[Any]) -> list[Any]:
    if not all(isinstance(value, (Fraction, SymbolPolynomial)) for value in values):
        raise _OtherKindError
    return list(values)


def _only_term(value: Any) -> tuple[tuple[Factor, ...], Fraction]:
    """The factors of a polynomial of one term, and the number before them."""
    if not isinstance(value, SymbolPolynomial) or len(value.terms) != 1:
        raise _OtherKindError
    ((factors, number),) = value.terms.items()
    return factors, number


def _checked(value: Fraction | SymbolPolynomial) -> Fraction | SymbolPolynomial:
    """The value, a Fraction if it is one, unless it is large."""
    terms = value.terms if isinstance(value, SymbolPolynomial) else {(): value}
    bits = max((c.numerator.bit_length() + c.denominator.bit_length() for c in terms.values()), default=0)
    if len(terms) > _MOST_TERMS or bits > _MOST_BITS or max(map(len, terms), default=0) > _MOST_FACTORS:
        raise _OtherKindError
    return value.simplest() if isinstance(value, SymbolPolynomial) else value
