"""Exact numbers: rational ones as `Fraction`, all others as SymPy expressions, and what is asked of them.

SymPy is imported only for the latter: a name kept symbolic, a square root.  Coefficients of brackets are left as
polynomials in such names and numbers (`liepoisson.algebra.symbol_polynomials`) until somebody asks for them.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import lcm, prod
from numbers import Integral, Rational, Real
from typing import TYPE_CHECKING, Any, TypeAlias, cast, overload

from liepoisson.algebra.symbol_polynomials import SymbolPolynomial, expression_of
from liepoisson.errors import ParameterError
from liepoisson.inputs.given import as_scalar
from liepoisson.inputs.names import check_not_reserved

if TYPE_CHECKING:
    from sympy import Expr

Exact: TypeAlias = "Fraction | Expr"
"""What a parameter is read as."""

Coefficient: TypeAlias = "Exact | SymbolPolynomial"
"""The same, or what becomes an expression when it is asked for."""

ExactMatrix: TypeAlias = "tuple[tuple[Exact, ...], ...]"
"""A matrix of exact numbers, by rows."""


# Decimals of a summand, which SymPy guarantees, and the part of the size of the summands below which a sum of these may
# be zero.
_DIGITS, _ROUND_OFF = 50, Fraction(1, 10**30)


MAX_DEGREE = 128
"""Largest degree of a field of algebraic numbers that SymPy is asked for.

It finds that of seven square roots, degree 128, in 7 s, and was not seen to end for tan(13*pi/45) beside three, degree
192.
"""


def read_number(value: object, name: str) -> Exact:
    """A number or an expression that is no text, read exactly.

    Raises:
        ParameterError: it is neither, or not finite and real.
    """
    value = as_scalar(value)
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "m":  # a time with its unit
        raise not_a_parameter(value, name)
    if isinstance(value, Integral):
        return Fraction(int(value))
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    if isinstance(value, (float, Real)):
        return _read_float(value, name)
    if is_sympy(value):
        return _read_expression(value, name)
    raise not_a_parameter(value, name)


def as_expression(value: object, name: str) -> Expr:
    """A number or an expression that a caller gives, as a SymPy expression: the one way of foreign values into SymPy.

    Nothing is interpreted.  SymPy's own conversions run texts, and the texts of objects that they do not know, as
    Python code; they are given only what this function returns.  `liepoisson.formula.parameters` reads texts.

    Args:
        value: A SymPy expression, which stays as it is, or a number, which is read exactly.
        name: What to call it in an error message.

    Raises:
        ParameterError: it is neither.
    """
    from sympy import Expr

    if isinstance(value, Expr):
        return value
    if isinstance(value, str) or is_sympy(value):  # a matrix, a relation
        raise ParameterError(
            f"{name} must be a SymPy expression; got {value!r:.60} of type {type(value).__name__}. Build it from SymPy "
            "symbols and numbers."
        )
    return to_sympy(read_number(value, name))


def to_sympy(value: Coefficient) -> Expr:
    """The parameter as a SymPy expression."""
    if isinstance(value, SymbolPolynomial):
        return expression_of(value)
    if isinstance(value, Fraction):
        from sympy import Rational as SympyRational

        return SympyRational(value.numerator, value.denominator)
    return value


def exact(value: Coefficient) -> Exact:
    """The coefficient as callers see it: a Fraction or an expression."""
    return expression_of(value) if isinstance(value, SymbolPolynomial) else value


@overload
def substituted(value: Exact, values: Mapping[str, Exact]) -> Exact: ...
@overload
def substituted(value: Coefficient, values: Mapping[str, Coefficient]) -> Coefficient: ...
def substituted(value: Coefficient, values: Mapping[str, Coefficient]) -> Coefficient:
    """The parameter with values for symbols by name, all at once: {"s": t, "t": s} exchanges two of them."""
    if isinstance(value, Fraction):
        return value
    if isinstance(value, SymbolPolynomial):
        given = {s: v for s in value.symbols if isinstance(v := values.get(s), (Fraction, SymbolPolynomial))}
        if given.keys() == value.symbols & values.keys():
            found = value.at(given)
            if isinstance(found, Fraction) or found.has_one_number:
                return found
        value = expression_of(value)
    known: dict[Any, Any] = {s: to_sympy(values[str(s)]) for s in value.free_symbols if str(s) in values}
    return cast("Expr", value.xreplace(known)) if known else value


def is_zero(value: Coefficient) -> bool:
    """Whether the parameter vanishes identically (a free symbol does not).

    A polynomial in its symbols is expanded, and does so if its coefficients do.  That a coefficient does not vanish is
    proved by its decimals.  A rational function vanishes if its numerator does.  Only coefficients whose decimals leave
    it open, and other expressions whose value at a point does, are simplified, and False may then mean that SymPy did
    not succeed.
    """
    if isinstance(value, Fraction) or (isinstance(value, SymbolPolynomial) and value.has_one_number):
        return not value
    value = to_sympy(value)
    if value.is_zero:
        return True
    expanded = cast("Expr", value.expand())
    if expanded == 0:
        return True
    symbols = tuple(expanded.free_symbols)
    if not expanded.is_polynomial(*symbols):
        from sympy import fraction, simplify, together

        numerator: Any = fraction(together(value))[0]
        if numerator.is_polynomial(*symbols):
            return is_zero(numerator)
        return not _is_nonzero_at_a_point(expanded) and bool(simplify(value) == 0)
    return all(_vanishes(terms) for terms in _coefficients(expanded, symbols))


def _is_nonzero_at_a_point(expanded: Expr) -> bool:
    """Whether the decimals at a point tell an expression from zero, which saves its simplification."""
    from sympy import Add, Rational

    from liepoisson.algebra.decimals import vanishes_at

    point = {s: Rational(k, k + 2) for k, s in enumerate(sorted(expanded.free_symbols, key=str), start=1)}
    return vanishes_at(Add.make_args(expanded), point) is False


def _coefficients(expanded: Expr, symbols: Sequence[Any]) -> list[list[Expr]]:
    """The summands of each coefficient of an expanded polynomial."""
    from sympy import Add

    found: dict[Expr, list[Expr]] = {}
    for term in Add.make_args(expanded):
        number, monomial = term.as_independent(*symbols, as_Add=False)
        found.setdefault(monomial, []).append(number)
    return list(found.values())


def _vanishes(terms: Sequence[Expr]) -> bool:
    """Whether a sum of constants vanishes."""
    from sympy import Add
    from sympy.core.evalf import PrecisionExhausted

    try:
        decimals: Any = [term.evalf(_DIGITS, strict=True) for term in terms]
    except PrecisionExhausted:  # a summand may vanish itself
        decimals = []
    if decimals and all(value.is_Float or value.is_Rational for value in decimals):
        size = sum(abs(value) for value in decimals)
        if abs(sum(decimals)) > size * to_sympy(_ROUND_OFF):
            return False
    from liepoisson.algebra.cyclotomic import cyclotomic_images

    number = Add(*terms)
    if (images := cyclotomic_images([number])) is not None:
        return not images[number]
    # simplifies, and asks for the minimal polynomial of an algebraic number
    return largest_degree([number]) <= MAX_DEGREE and number.equals(0) is True


def irrational_parts(expressions: Iterable[Expr]) -> set[Any]:
    """The roots of numbers, and the sines, cosines and tangents of rational multiples of pi, of which they are made."""
    from sympy import Pow, pi, sin
    from sympy.functions.elementary.trigonometric import TrigonometricFunction

    parts = {part for expression in expressions for part in expression.atoms(Pow, TrigonometricFunction)}
    return {
        part
        for part in parts
        if (isinstance(part, Pow) and part.is_number and part.exp.is_Rational and not part.exp.is_Integer)
        or (isinstance(part, TrigonometricFunction) and (part.args[0] / pi).is_Rational and sin(part.args[0]).is_number)
    }


def largest_degree(expressions: Iterable[Expr]) -> int:
    """A bound of the degree over the rationals of the field that the irrational parts of these numbers generate.

    All sines and cosines lie in the real part of one cyclotomic field; SymPy does not see that tangents do, too.
    """
    from sympy import Pow, cos, pi, sin, totient

    parts = irrational_parts(expressions)
    orders = {part: 4 * int((part.args[0] / pi).q) for part in parts if not isinstance(part, Pow)}
    fields = [lcm(*(n for part, n in orders.items() if isinstance(part, (sin, cos))))]
    fields += [n for part, n in orders.items() if not isinstance(part, (sin, cos))]
    degrees = [max(int(totient(n)) // 2, 1) for n in fields]
    return prod(degrees) * prod(int(part.exp.q) for part in parts - orders.keys())


@overload
def product_of(first: Exact, second: Exact) -> Exact: ...
@overload
def product_of(first: Coefficient, second: Coefficient) -> Coefficient: ...
def product_of(first: Coefficient, second: Coefficient) -> Coefficient:
    """The product: a Fraction of Fractions, otherwise an expression; Python multiplies neither by the other."""
    if isinstance(first, (Fraction, SymbolPolynomial)) and isinstance(second, (Fraction, SymbolPolynomial)):
        return first * second
    return to_sympy(first) * to_sympy(second)


def sum_of(first: Exact, second: Exact) -> Exact:
    """The sum: a Fraction of Fractions, otherwise an expression."""
    if isinstance(first, Fraction) and isinstance(second, Fraction):
        return first + second
    return to_sympy(first) + to_sympy(second)


def is_negative(value: Exact) -> bool:
    """Whether the parameter is known to be negative."""
    return value < 0 if isinstance(value, Fraction) else value.is_negative is True


def exceeds_sum(value: Exact, first: Exact, second: Exact) -> bool:
    """Whether the parameter is known to exceed the sum of the two others (False when symbols leave it open)."""
    if isinstance(value, Fraction) and isinstance(first, Fraction) and isinstance(second, Fraction):
        return value > first + second
    return (to_sympy(value) - to_sympy(first) - to_sympy(second)).is_positive is True


def symbols_of(value: Coefficient) -> set[str]:
    """Names of the free symbols in the parameter; empty for a number."""
    if isinstance(value, SymbolPolynomial):
        return value.symbols
    return set() if isinstance(value, Fraction) else {str(symbol) for symbol in value.free_symbols}


def as_float(value: Exact, name: str) -> float:
    """The nearest double.

    Raises:
        ParameterError: the parameter is symbolic (the message names it) or too large for a double.
    """
    if free := symbols_of(value):
        raise ParameterError(
            f"{name} must be a number for numerical work; got {value} with the free symbol "
            f"{', '.join(sorted(free))}. Give it a value."
        )
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    except TypeError:
        raise ParameterError(f"{name} must be a real number; got {value}. Give it a value.") from None
    if not math.isfinite(number):
        raise ParameterError(f"{name} must fit into a double (below 1.8e308); got a larger number. Rescale the system.")
    return number


def as_coefficient(value: Exact, name: str) -> float:
    """The nearest double, with all its digits: a term of an equation may not vanish because its number is small.

    Raises:
        ParameterError: the parameter is symbolic, too large for a double, or not zero and too small for one.
    """
    number = as_float(value, name)
    if abs(number) < sys.float_info.min and not is_zero(value):
        raise ParameterError(
            f"{name} must fit into a double (above 2.2e-308); got a smaller number. Rescale the system, or set what is "
            "nearly 0 to 0."
        )
    return number


def _read_float(value: float | Real, name: str) -> Fraction:
    number = float(value)
    if not math.isfinite(number):
        raise ParameterError(f"{name} must be a finite number; got {number}. Check the calculation it comes from.")
    # float(float32(0.1)) prints 17 digits; str() of the NumPy scalar prints the shortest ones of its own type.
    return Fraction(repr(value) if type(value) is float else str(value))


def _read_expression(value: Any, name: str) -> Exact:
    from sympy import Atom, Expr, Float, Symbol, nan
    from sympy import Rational as SympyRational
    from sympy.core.function import AppliedUndef

    if isinstance(value, Float):
        return _read_float(float(value), name)
    if isinstance(value, SympyRational) and value.is_finite:
        return Fraction(int(value.p), int(value.q))
    if (
        not isinstance(value, Expr)
        or value.has(nan, AppliedUndef)
        or value.is_finite is False
        or value.is_real is False
    ):
        raise ParameterError(f"{name} must be a finite real number or name; got {value}. Check the expression.")
    for part in (*value.free_symbols, *value.atoms(Atom)):  # an element k[1] is no atom, and free
        if not part.is_number and type(part) is not Symbol:
            raise ParameterError(
                f"{name} must consist of numbers and plain symbols; got {part}, a SymPy {type(part).__name__}. Take a "
                "Symbol in its place."
            )
    for symbol in value.free_symbols:
        check_not_reserved(str(symbol), f"{name}: the name of a symbol")
    return value


def is_sympy(value: object) -> bool:
    """Whether the value is an object of SymPy; asked without importing SymPy."""
    # An undefined function such as f(1) has a class of its own, without a module: its bases tell.
    return any(str(base.__module__).partition(".")[0] == "sympy" for base in type(value).__mro__)


def not_a_parameter(value: object, name: str, reason: str = "") -> ParameterError:
    """The refusal of what is no parameter."""
    shown = repr(value)
    shown = shown if len(shown) <= 60 else shown[:57] + "..."
    return ParameterError(
        f"{name} must be a number, a name or a formula; got {shown} of type {type(value).__name__}"
        f"{f' ({reason})' if reason else ''}. "
        'Write for example 2, 0.5, Fraction(1, 3), "1/3", "sqrt(2)", "epsilon" or "2*epsilon".'
    )
