r"""Functions on phase space in ball arithmetic: exponents of any size, and errors that are known.

In doubles $e^{-\cosh q}$ is zero from q = 7.3 on, and so is $1-\tanh^2q$ from q = 19. Arb's balls have as many digits
as are asked for and exponents without bounds, and every ball contains the number that is meant: one that does not
contain zero belongs to a number that is not zero.

References: [johansson2017].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import add, mul
from typing import TYPE_CHECKING, Any

from flint import arb, ctx, fmpq

from liepoisson.compile.private_symbols import name_of_function

if TYPE_CHECKING:
    from sympy import Expr, Symbol

_SAME_NAME = frozenset({
    "exp", "log", "sin", "cos", "tan", "sec", "csc", "cot", "sinh", "cosh", "tanh", "sech", "csch", "coth",
    "asin", "acos", "atan", "asinh", "acosh", "atanh", "erf", "erfc",
})  # fmt: skip
"""Functions that SymPy and Arb call by one name."""

_GUARD = 15
"""Digits of SymPy's results that are not believed."""


class BallFunctions:
    """Several expressions in the same variables, with their common parts evaluated once.

    Args:
        variables: The variables, in their order.
        expressions: SymPy expressions in these.
    """

    def __init__(self, variables: Sequence[Symbol], expressions: Sequence[Expr]) -> None:
        from sympy import cse, numbered_symbols

        self._variables = tuple(variables)
        exact = [expression.replace(_is_cancelling, _without_cancelling) for expression in expressions]
        self._parts, self._expressions = cse(exact, symbols=numbered_symbols("_part"))

    def __call__(self, point: Sequence[arb]) -> list[arb]:
        """Balls that contain their values; not finite where they are not defined as real numbers."""
        known: dict[Any, arb] = dict(zip(self._variables, point, strict=True))
        for symbol, part in self._parts:
            known[symbol] = _ball(part, known)
        return [_ball(expression, known) for expression in self._expressions]


def _is_cancelling(expression: Any) -> bool:
    r"""Whether this is $1-\tanh^2u$, as SymPy writes the derivative of tanh: no number of digits is enough for it."""
    from sympy import tanh

    return expression.is_Add and any(expression == 1 - t**2 for t in expression.atoms(tanh))


def _without_cancelling(expression: Any) -> Any:
    from sympy import cosh, tanh

    return next(cosh(t.args[0]) ** -2 for t in expression.atoms(tanh) if expression == 1 - t**2)


def _ball(expression: Any, known: Mapping[Any, arb]) -> arb:
    if expression.is_Atom:
        return known[expression] if expression.is_Symbol else _number(expression)
    parts = [_ball(part, known) for part in expression.args]
    if expression.is_Add:
        return reduce(add, parts)
    if expression.is_Mul:
        return reduce(mul, parts)
    if expression.is_Pow:
        return parts[0] ** parts[1]
    name = name_of_function(expression)
    if name == "Abs":
        return abs(parts[0])
    return getattr(parts[0], name)() if name in _SAME_NAME else _of_sympy(expression, known)


def _number(value: Any) -> arb:
    """A rational number, or a floating-point one, which is rational, too; or one like pi."""
    from sympy import Rational

    if not (value.is_Rational or value.is_Float):
        return _of_sympy(value, {})
    exact: Any = Rational(value)
    return arb(fmpq(int(exact.p), int(exact.q)))


def _of_sympy(expression: Any, known: Mapping[Any, arb]) -> arb:
    """What Arb has no function for, by SymPy's own arithmetic; its last digits are not trusted."""
    from sympy import Float

    digits = ctx.dps + _GUARD
    at = {s: Float(known[s].mid().str(digits, radius=False), digits) for s in expression.free_symbols}
    value = expression.xreplace(at).evalf(digits)
    if not value.is_Float and not value.is_Rational:
        return arb.nan()
    number = arb(str(value))
    return number + arb(0, abs(number).upper() * arb(10) ** (_GUARD - digits))
