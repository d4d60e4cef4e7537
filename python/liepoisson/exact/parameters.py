"""Exact parameters: how the numbers and names that a caller gives are read, and a few questions about them.

A parameter is a `Fraction` when it is a rational number, and a SymPy expression when it is anything else (a name kept
symbolic, a square root).  SymPy is imported only for the latter.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import lcm, prod
from numbers import Integral, Rational, Real
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.errors import ExpressionError, ParameterError, ShapeError, did_you_mean
from liepoisson.exact.names import CONSTANTS, NOT_FINITE, check_name, check_not_reserved
from liepoisson.given import as_scalar, by_name, listed

if TYPE_CHECKING:
    from sympy import Expr

Parameter: TypeAlias = "int | float | Fraction | str | Expr"
"""What a caller may write for a parameter."""

Exact: TypeAlias = "Fraction | Expr"
"""What a parameter is read as."""

Column: TypeAlias = Any
"""A SymPy column of three expressions (Matrix, 3 x 1); SymPy's annotations of its entries are too loose to be used."""

# A bounded exponent: Fraction("1e999999999") would fill the memory with digits.
_NUMBER = re.compile(r"[+-]?(\d+/\d+|(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?)")
_MAX_CHARACTERS = 200
# Decimals of a summand, which SymPy guarantees, and the part of the size of the summands below which a sum of these may
# be zero.
_DIGITS, _ROUND_OFF = 50, Fraction(1, 10**30)
MAX_DEGREE = 128
"""Largest degree of a field of algebraic numbers that SymPy is asked for.

It finds that of seven square roots, degree 128, in 7 s, and was not seen to end for tan(13*pi/45) beside three, degree
192.
"""
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


def read_parameter(value: object, name: str) -> Exact:
    """Read one parameter exactly.

    A float is read as the decimal it prints as (0.1 is 1/10); a string is a number ("1/3", "0.25", "sqrt(2)/2"), an
    identifier, which stays symbolic, or a formula in such ("2*epsilon").  No string is ever evaluated as code.

    Args:
        value: int, Fraction, float, NumPy scalar, string or SymPy expression.
        name: What to call the parameter in an error message.

    Returns:
        A Fraction for a rational number, else a SymPy expression.

    Raises:
        ParameterError: not a number or name, or a number that is not finite and real.
    """
    value = as_scalar(value)
    if isinstance(value, str):
        return _read_string(value, name)
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "m":  # a time with its unit
        raise _not_a_parameter(value, name)
    if isinstance(value, Integral):
        return Fraction(int(value))
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    if isinstance(value, (float, Real)):
        return _read_float(value, name)
    if is_sympy(value):
        return _read_expression(value, name)
    raise _not_a_parameter(value, name)


def read_symbol(value: object, name: str) -> str | None:
    """The name of the symbol that a parameter is given as; None if it is given as anything but the text of a name.

    Raises:
        ParameterError: a user may not choose this name.
    """
    text = value.strip() if isinstance(value, str) else ""
    if not _NAME.fullmatch(text) or text.lower() in NOT_FINITE or text in CONSTANTS:
        return None
    return check_name(text, f"{name}: the name of a symbol")


def read_vector(values: object, name: str, components: str) -> tuple[Exact, Exact, Exact]:
    """Read three parameters, for example the moments of inertia.

    Args:
        values: A sequence of 3 parameters (list, tuple, array, SymPy Matrix).
        name: What to call the vector in an error message.
        components: What its components are, for example "(I1, I2, I3)".

    Raises:
        ShapeError: not a sequence of 3 scalars.
        ParameterError: a component that is not an exact finite real parameter, or labels other than the components.
    """
    names = components.strip("()").split(", ")
    items = listed(values, name, names)
    if items is None:
        raise ShapeError(f"{name} must be 3 numbers {components}; got {values!r}. Write for example {name}=(1, 1, 2).")
    if len(items) != 3 or any(listed(item) is not None for item in items):
        got = f"shape {_shape(values, items)}"
        raise ShapeError(f"{name} must be 3 numbers {components}; got {got}. Give exactly three components.")
    first, second, third = (read_parameter(item, part) for item, part in zip(items, names, strict=True))
    return first, second, third


def as_expression(value: object, name: str) -> Expr:
    """A number or an expression that a caller gives, as a SymPy expression: the one way of foreign values into SymPy.

    Nothing is interpreted.  SymPy's own conversions run texts, and the texts of objects that they do not know, as
    Python code; they are given only what this function returns.  `liepoisson.exact.expression` reads texts.

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
    return to_sympy(read_parameter(value, name))


def to_sympy(value: Exact) -> Expr:
    """The parameter as a SymPy expression."""
    from sympy import Rational as SympyRational

    if isinstance(value, Fraction):
        return SympyRational(value.numerator, value.denominator)
    return value


def substituted(value: Exact, values: Mapping[str, Exact]) -> Exact:
    """The parameter with values for symbols by name, all at once: {"s": t, "t": s} exchanges two of them."""
    if isinstance(value, Fraction):
        return value
    known: dict[Any, Any] = {s: to_sympy(values[str(s)]) for s in value.free_symbols if str(s) in values}
    return cast("Expr", value.xreplace(known)) if known else value


def values_of_symbols(given: object, symbols: Iterable[str]) -> dict[str, Exact]:
    """Values for some of these symbols, by their names, also where a caller gives the symbols themselves.

    Raises:
        ParameterError: not a mapping, a name is none of them or comes twice, or a value is not exact.
    """
    known, values = {*symbols}, dict[str, Exact]()
    for key, value in by_name(given, "values", "values", '{"epsilon": 1}').items():
        if (name := str(key)) not in known:
            raise ParameterError(
                f"values: wanted the names of symbols, {', '.join(sorted(known)) or 'of which there are none'}; got "
                f"{name!r:.60}. {did_you_mean(name, known)}Correct the name or leave it out."
            )
        if name in values:
            raise ParameterError(f"values: wanted each symbol once; {name} comes twice. Leave one out.")
        values[name] = read_parameter(value, name)
    return values


def is_zero(value: Exact) -> bool:
    """Whether the parameter vanishes identically (a free symbol does not).

    A polynomial in its symbols is expanded, and does so if its coefficients do.  That a coefficient does not vanish is
    proved by its decimals; only one whose decimals leave it open, and what is no polynomial, is simplified, and False
    may then mean that SymPy did not succeed.
    """
    if isinstance(value, Fraction):
        return value == 0
    if value.is_zero:
        return True
    expanded = cast("Expr", value.expand())
    if expanded == 0:
        return True
    symbols = tuple(expanded.free_symbols)
    if not expanded.is_polynomial(*symbols):
        from sympy import simplify

        return bool(simplify(value) == 0)
    return all(_vanishes(terms) for terms in _coefficients(expanded, symbols))


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
    from liepoisson.exact.linear.cyclotomic import cyclotomic_images

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


def product_of(first: Exact, second: Exact) -> Exact:
    """The product: a Fraction of Fractions, otherwise an expression; Python multiplies neither by the other."""
    if isinstance(first, Fraction) and isinstance(second, Fraction):
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


def symbols_of(value: Exact) -> set[str]:
    """Names of the free symbols in the parameter; empty for a number."""
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


def display(value: Exact) -> str:
    """The parameter as text, as short as possible."""
    return str(value)


def _read_string(text: str, name: str) -> Exact:
    if (symbol := read_symbol(text, name)) is not None:
        from sympy import Symbol

        return Symbol(symbol)
    stripped = text.strip()
    if len(stripped) > _MAX_CHARACTERS:
        raise _not_a_parameter(text, name)
    if not _NUMBER.fullmatch(stripped):
        return _read_formula(stripped, name)
    try:
        return Fraction(stripped)
    except ZeroDivisionError:
        raise ParameterError(f"{name} must be a finite number; got {text!r}. Use a nonzero denominator.") from None


def _read_formula(text: str, name: str) -> Exact:
    """A formula whose names are those of symbols: "sqrt(2)", "2*epsilon"."""
    from liepoisson.exact.expression import parameter

    try:
        return parameter(text)
    except ExpressionError as error:
        raise _not_a_parameter(text, name, error.message) from None


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


def _not_a_parameter(value: object, name: str, reason: str = "") -> ParameterError:
    shown = repr(value)
    shown = shown if len(shown) <= 60 else shown[:57] + "..."
    return ParameterError(
        f"{name} must be a number, a name or a formula; got {shown} of type {type(value).__name__}"
        f"{f' ({reason})' if reason else ''}. "
        'Write for example 2, 0.5, Fraction(1, 3), "1/3", "sqrt(2)", "epsilon" or "2*epsilon".'
    )


def _shape(values: object, items: list[object]) -> tuple[int, ...]:
    shape = getattr(values, "shape", None)
    if isinstance(shape, tuple):
        return cast("tuple[int, ...]", shape)
    inner = listed(items[0]) if items else None
    return (len(items),) if inner is None else (len(items), len(inner))
