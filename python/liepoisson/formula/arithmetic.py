r"""Exact arithmetic on scalars of formulas, with bounds that keep every result small.

SymPy evaluates some operations at once, whatever they cost: $2^{10^{12}}$ fills the memory, and so does
$(l_1 + \dots + l_9)^{64}$ as soon as somebody expands it.  Each operation here is therefore refused when its result
would be too long, too deep, not finite or not real; constants are judged by their values as doubles, which we compute
ourselves from the smallest parts up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.inputs.names import ANGLE, ELEMENTARY_FUNCTIONS

if TYPE_CHECKING:
    from sympy import Expr

MAX_EXPONENT = 64
MAX_EXPONENT_BITS = 128
MAX_BITS = 4096
MAX_ROOT_BITS = 512
MAX_TERMS = 20_000  # a full quadratic form in 120 variables has 14,400
MAX_SIZE = 200_000
MAX_CONSTANT = 1_000  # SymPy fails to compare constants such as sin(10^150)
MAX_ARGUMENT = 300  # SymPy expands the arguments of functions to learn their signs
MAX_FUNCTIONS = 3  # and that takes a time which grows exponentially with their nesting
MAX_DEPTH = 60  # SymPy's derivative takes about 8 frames of the interpreter's stack (1000 by default) per level
MAX_WORK = 100_000
_ENDLESS = 10**12  # a count that is over every limit

_OPERATIONS: dict[str, Callable[..., float]] = {
    "add": lambda *terms: math.fsum(terms),
    "mul": lambda *factors: math.prod(factors),
    "pow": math.pow,
}
_DOUBLES: dict[str, Callable[..., float]] = {
    name: getattr(math, name) for name in (*ELEMENTARY_FUNCTIONS, ANGLE) if name != "sqrt"
}


class RefusedError(Exception):
    """An operation that has no result, or too long a one; who knows the position in the text adds it."""


@dataclass(frozen=True, slots=True)
class Measure:
    """How large an expression is.

    Attributes:
        terms: At most so many terms when it is expanded.
        size: At most so many factors in all of them.
        bits: About so many bits in its longest number.
        depth: So many levels of nesting.
        functions: So many elementary functions, and roots of such, inside of each other.
        value: The value of a constant as a double, None if a name occurs.
    """

    terms: int
    size: int
    bits: int
    depth: int
    functions: int
    value: float | None


def expanded_terms(expression: Expr) -> int:
    """At most so many terms has an expression when it is expanded; counted without expanding it."""
    try:
        return Arithmetic().measure(expression).terms
    except RefusedError:  # a constant in it that no double holds
        return _ENDLESS


class Arithmetic:
    """Sums, products, powers and functions of exact scalars (Fractions and SymPy expressions).

    One object serves one formula: it counts the work done and remembers the measures of subexpressions.
    """

    def __init__(self) -> None:
        self._measures: dict[Expr, Measure] = {}
        self._work = 0

    def sum(self, terms: Sequence[Exact]) -> Exact:
        """The sum of the terms."""
        self._spend(len(terms))
        rational = sum((term for term in terms if isinstance(term, Fraction)), Fraction(0))
        rest = [term for term in terms if not isinstance(term, Fraction)]
        if not rest:
            return _short(rational)
        from sympy import Add

        return self._checked(Add(to_sympy(_short(rational)), *rest))

    def product(self, factors: Sequence[Exact]) -> Exact:
        """The product of the factors."""
        self._spend(len(factors))
        rational = Fraction(1)
        for factor in factors:
            if isinstance(factor, Fraction):
                rational = _short(rational * factor)
        rest = [factor for factor in factors if not isinstance(factor, Fraction)]
        if not rest or rational == 0:
            return rational
        from sympy import Mul

        return self._checked(Mul(to_sympy(rational), *rest))

    def reciprocal(self, divisor: Exact) -> Exact:
        """One over the divisor."""
        return self.power(divisor, Fraction(-1))

    def power(self, base: Exact, exponent: Exact) -> Exact:
        """The base to an exponent that is a rational number, or an expression in symbols.

        Raises:
            RefusedError: division by zero, a root of a negative number, an exponent or a result that is too large.
        """
        self._spend(1)
        self._check_exponent(exponent)
        if base == 0 and isinstance(exponent, Fraction) and exponent < 0:
            raise RefusedError("a divisor must not vanish; this one is 0")
        if isinstance(base, Fraction) and isinstance(exponent, Fraction) and exponent.denominator == 1:
            _check_bits(_bits(base) * abs(int(exponent)))
            return base ** int(exponent)
        if isinstance(exponent, Fraction):
            measure = self.measure(base)
            bits = measure.bits
            _check_bits(bits * math.ceil(abs(exponent)))
            if exponent.denominator != 1:
                # SymPy asks for the signs of factors, and of powers below a root; those of a sum it leaves alone.
                if measure.functions or not (isinstance(base, Fraction) or base.is_Add):
                    _check_argument(measure)
                self._spend(bits)  # SymPy looks for factors of numbers below a root
                _check_bits(bits, MAX_ROOT_BITS)
        from sympy import Pow

        return self._checked(Pow(to_sympy(base), to_sympy(exponent)))

    def apply(self, function: str, argument: Exact) -> Exact:
        """An elementary function of the argument, one of `ELEMENTARY_FUNCTIONS`.

        Raises:
            RefusedError: the argument is outside of the domain, or the value is too large.
        """
        if function == "sqrt":
            return self.power(argument, Fraction(1, 2))
        import sympy

        self._spend(10)
        value = to_sympy(argument)
        _check_argument(self.measure(argument))
        self._check_domain(function, value)
        result = getattr(sympy, function)(value)
        if function == "tan":  # tan(x + pi/2) comes out as -cot(x), which no reader of formulas expects
            result = result.replace(sympy.cot, lambda angle: sympy.cos(angle) / sympy.sin(angle))
        return self._checked(result)

    def angle(self, y: Exact, x: Exact) -> Exact:
        """The angle of the point (x, y), in (-pi, pi].

        Raises:
            RefusedError: the point is 0, or an argument is too large.
        """
        from sympy import atan2

        self._spend(10)
        for argument in (y, x):
            _check_argument(self.measure(argument))
        if y == x == 0:
            raise RefusedError("the point (0, 0) has no angle")
        return self._checked(atan2(to_sympy(y), to_sympy(x)))

    def measure(self, scalar: Exact) -> Measure:
        """How large the scalar is.

        Raises:
            RefusedError: it is a constant that is not finite and real, or too large for a double.
        """
        if isinstance(scalar, Fraction):
            return Measure(1, 1, _bits(scalar), 0, 0, None)
        if scalar not in self._measures:
            self._measures[scalar] = self._measured(scalar)
        return self._measures[scalar]

    def _measured(self, expression: Any) -> Measure:
        parts = [self.measure(part) for part in expression.args]
        depth = 1 + max((part.depth for part in parts), default=0)
        functions = max((part.functions for part in parts), default=0)
        if expression.is_Function or (functions and expression.is_Pow and not expression.exp.is_Integer):
            functions += 1
        value = _double(expression, [part.value for part in parts])
        terms, size, bits = _count(expression, parts)
        return Measure(terms, size, bits, depth, functions, value)

    def _checked(self, result: Any) -> Exact:
        """The result, unless it is too large; a Fraction if it is rational."""
        if result.is_Rational:
            return _short(_fraction(result))
        measure = self.measure(result)
        _check_bits(measure.bits)
        if measure.terms > MAX_TERMS or measure.size > MAX_SIZE:
            raise RefusedError(
                f"a formula must have at most {MAX_TERMS} terms and {MAX_SIZE} factors when it is expanded; "
                "this part may have more"
            )
        if measure.depth > MAX_DEPTH:
            raise RefusedError(f"a formula must be nested at most {MAX_DEPTH} operations deep; this part is deeper")
        return result

    def _check_exponent(self, exponent: Exact) -> None:
        if not isinstance(exponent, Fraction) and not exponent.free_symbols:
            raise RefusedError(f"an exponent must be a rational number or a symbol; got {exponent}")
        atoms: set[Any] = set() if isinstance(exponent, Fraction) else exponent.atoms()
        numbers = [exponent] if isinstance(exponent, Fraction) else [_fraction(a) for a in atoms if a.is_Rational]
        for number in numbers:
            if abs(number) > MAX_EXPONENT:
                raise RefusedError(
                    f"an exponent must be between -{MAX_EXPONENT} and {MAX_EXPONENT}; got one that is not"
                )
            _check_bits(_bits(number), MAX_EXPONENT_BITS)

    def _check_domain(self, function: str, argument: Any) -> None:
        """Refuse what SymPy must not even try: exp(10^15*log(2)) would become 2^(10^15), written out."""
        from sympy import Add, Mul, log

        if function == "exp":
            for factors in map(Mul.make_args, Add.make_args(argument)):
                others = [factor for factor in factors if not isinstance(factor, log)]
                if len(others) < len(factors) and not any(factor.free_symbols for factor in others):
                    raise RefusedError("exp of a multiple of log must be written as a power: x^3 for exp(3*log(x))")
        constant = _double(argument, [part.value for part in map(self.measure, argument.args)])
        if constant is not None:
            if function != "log" and abs(constant) > MAX_CONSTANT:
                raise RefusedError(f"a constant argument of {function} must be at most {MAX_CONSTANT} in size")
            _value_of(lambda: _DOUBLES[function](constant))

    def _spend(self, work: int) -> None:
        self._work += work
        if self._work > MAX_WORK:
            raise RefusedError(f"a formula must not take more than {MAX_WORK} operations to read; this one does")


def _count(expression: Any, parts: Sequence[Measure]) -> tuple[int, int, int]:
    """Terms, size and bits of an expression, from those of its arguments."""
    if not parts:
        return 1, 1, _bits(_fraction(expression)) if expression.is_Rational else 1
    longest = max(part.bits for part in parts)
    if expression.is_Add:
        return sum(part.terms for part in parts), sum(part.size for part in parts), longest
    if expression.is_Mul:
        terms = min(math.prod(part.terms for part in parts), _ENDLESS)
        size = min(sum(part.size * (terms // part.terms) for part in parts), _ENDLESS)
        return terms, size, sum(part.bits for part in parts)
    if expression.is_Pow:
        return _count_power(expression, parts[0])
    return 1, 1 + sum(part.size for part in parts), longest


def _count_power(expression: Any, base: Measure) -> tuple[int, int, int]:
    exponent = expression.exp
    if not exponent.is_Rational:
        return base.terms, base.size + 1, base.bits
    times = math.ceil(abs(_fraction(exponent)))
    if times > MAX_SIZE or min(base.terms - 1, times) > MAX_EXPONENT:
        return _ENDLESS, _ENDLESS, base.bits
    # The multinomial theorem counts the monomials of degree `times` in `terms` unknowns.
    terms = min(math.comb(base.terms + times - 1, times), _ENDLESS)
    return terms, terms * times * -(-base.size // base.terms), base.bits * times


def _double(expression: Any, values: list[float | None]) -> float | None:
    """The value of a constant from those of its arguments; None if a name occurs.

    Raises:
        RefusedError: not finite or not real.
    """
    from sympy import I, S

    if expression is I or expression in (S.NaN, S.Infinity, S.NegativeInfinity, S.ComplexInfinity):
        raise RefusedError("a formula must be finite and real; this part is not")
    if not expression.args:
        return _value_of(lambda: float(expression)) if expression.is_number else None
    if any(value is None for value in values):
        return None
    numbers = [value for value in values if value is not None]
    kind = "add" if expression.is_Add else "mul" if expression.is_Mul else "pow" if expression.is_Pow else ""
    function = _OPERATIONS.get(kind) or _DOUBLES.get(expression.func.__name__)
    if function is None:
        raise RefusedError("a formula must be finite and real; this part is not")
    return _value_of(lambda: function(*numbers))


def _value_of(compute: Callable[[], float]) -> float:
    try:
        value = compute()
    except OverflowError:
        raise RefusedError("a constant must fit into a double (below 1.8e308); this one does not") from None
    except (ValueError, ZeroDivisionError):
        raise RefusedError("a formula must be finite and real; this part is not") from None
    if not math.isfinite(value):
        raise RefusedError("a constant must fit into a double (below 1.8e308); this one does not")
    return value


def _fraction(number: Any) -> Fraction:
    """A SymPy rational as a Fraction."""
    return Fraction(int(number.p), int(number.q))


def _bits(number: Fraction) -> int:
    return number.numerator.bit_length() + number.denominator.bit_length()


def _check_argument(measure: Measure) -> None:
    most = MAX_ARGUMENT // 4**measure.functions
    if measure.size > most or measure.functions >= MAX_FUNCTIONS:
        raise RefusedError(
            f"the argument of a function must have at most {most} factors when expanded ({MAX_ARGUMENT} if there is no "
            f"function in it), with at most {MAX_FUNCTIONS - 1} functions inside of each other; this one may have more"
        )


def _check_bits(bits: int, limit: int = MAX_BITS) -> None:
    if bits > limit:
        raise RefusedError(f"a number must have at most about {int(limit * 0.301)} digits; this one would have more")


def _short(number: Fraction) -> Fraction:
    _check_bits(_bits(number))
    return number
