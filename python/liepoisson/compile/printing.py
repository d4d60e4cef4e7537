"""SymPy's expressions as texts in the grammar of formulas, which the core reads.

The coordinates are x1, x2, ..., whatever they are called, and s1, s2, ... are parts that several expressions share, or
that would be nested deeply.  So nothing depends on the names of a user, and a text is about as long as its expression
has different parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.rounded import rational
from liepoisson.compile.symbols import in_compiler_symbols, name_of_function
from liepoisson.errors import UnsupportedFieldError

if TYPE_CHECKING:
    from sympy import Expr, Symbol

FUNCTIONS = ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asin", "acos", "atan")
"""Elementary functions that the core knows, under the names of SymPy."""

_DEPTH = 16
"""Parts that are nested deeper than this are named; the core reads 64 levels, and one part makes three at most."""


class PrintedExpressions:
    """Expressions in these variables, and the parts that they share.

    Args:
        variables: The coordinates.
        expressions: What is printed.
        angles: Whether angles of pairs, atan2(y, x), may occur.
        shares: Whether parts are named.
        names: What the coordinates are called, in place of x1, x2, ...

    Attributes:
        n_components: The number of coordinates.
        parts: Texts of s1, s2, ..., each in those before it.
        texts: Of the expressions.

    Raises:
        ParameterError: a symbol is not among the variables, or a constant is no finite real number.
        UnsupportedFieldError: a function is not smooth or not known.
    """

    def __init__(
        self,
        variables: Sequence[Symbol],
        expressions: Sequence[Expr],
        *,
        angles: bool = False,
        shares: bool = True,
        names: Sequence[str] | None = None,
    ) -> None:
        private, given = in_compiler_symbols(variables, expressions)
        self.n_components = len(variables)
        self.parts: list[str] = []
        self._angles, self._shares = angles, shares
        called = [f"x{k}" for k in range(1, len(private) + 1)] if names is None else names
        self._known: dict[Any, tuple[str, int]] = {
            symbol: (name, 0) for symbol, name in zip(private, called, strict=True)
        }
        self._uses: dict[Any, int] = {}
        for expression in given:
            self._count(expression)
        self.texts = [self._text(expression)[0] for expression in given]

    def number(self, value: Exact) -> str:
        """A number as a text, which may be that of a part."""
        if isinstance(value, Fraction):
            return str(value)
        text, depth = self._text(value)
        if depth:
            self.parts.append(text)
            text, _ = self._known[value] = f"s{len(self.parts)}", 0
        return text

    def _count(self, expression: Any) -> None:
        """Counts how often each part is used."""
        waiting = [expression]
        while waiting:
            part = waiting.pop()
            uses = self._uses[part] = self._uses.get(part, 0) + 1
            if uses == 1:
                waiting += part.args

    def _text(self, expression: Any) -> tuple[str, int]:
        """A text, and how deep it is nested."""
        known = self._known.get(expression)
        if known is not None:
            return known
        # what is deep inside is printed first, so that no call is nested deeper than the rest
        waiting = [expression]
        while waiting:
            part = waiting[-1]
            unknown = [inner for inner in self._inner(part) if inner not in self._known]
            if unknown:
                waiting += unknown
                continue
            waiting.pop()
            if part not in self._known:
                self._known[part] = self._named(part, *self._printed(part))
        return self._known[expression]

    def _inner(self, part: Any) -> Sequence[Any]:
        """The parts of which a text is made."""
        if part.is_Pow and part.exp.is_Rational:
            return (part.base,)
        if part.is_Add or part.is_Mul or part.is_Pow or self._is_function(part):
            return part.args
        return ()

    def _is_function(self, part: Any) -> bool:
        name = name_of_function(part) if part.is_Function else None
        return name in FUNCTIONS or (name == "atan2" and self._angles)

    def _named(self, part: Any, text: str, depth: int) -> tuple[str, int]:
        if self._shares and depth and (self._uses.get(part, 0) > 1 or depth > _DEPTH):
            self.parts.append(text)
            return f"s{len(self.parts)}", 0
        return text, depth

    def _printed(self, part: Any) -> tuple[str, int]:
        inner = [self._known[one] for one in self._inner(part)]
        texts = [text for text, _ in inner]
        if not texts:
            return self._constant(part), 0
        if part.is_Add:
            text = " + ".join(texts)
        elif part.is_Mul:
            text = "*".join(_factor(one, text) for one, text in zip(part.args, texts, strict=True))
        elif part.is_Pow:
            text = self._power(part.base, part.exp, texts)
        else:
            text = f"{name_of_function(part)}({', '.join(texts)})"
        return text, 1 + max(depth for _, depth in inner)

    def _power(self, base: Any, exponent: Any, texts: Sequence[str]) -> str:
        from sympy import E, exp

        if base == E:
            return f"exp({texts[-1]})"
        if isinstance(base, exp):  # a power of a real exponential, for any exponent
            argument = self._known[cast("Any", base).args[0]][0]
            return f"exp(({exponent if exponent.is_Rational else texts[1]})*({argument}))"
        if exponent.free_symbols:  # u^v = exp(v log u)
            return f"exp(({texts[1]})*log({texts[0]}))"
        return f"{_factor(base, texts[0])}^({exponent if exponent.is_Rational else rational(exponent)})"

    def _constant(self, part: Any) -> str:
        """A number; one that the grammar does not have is rounded to 40 digits."""
        from sympy import E, pi

        if part.is_Rational:
            return str(part)
        if part in (pi, E):
            return "pi" if part == pi else "exp(1)"
        if part.is_number:
            return str(rational(part))
        shown = str(part)
        shown = shown if len(shown) < 60 else shown[:57] + "..."
        raise UnsupportedFieldError(
            "to be integrated, a field must be made of + - * / ^ sqrt exp log and trigonometric functions of the "
            f"variables; got {shown}. Replace it by a smooth expression."
        )


def printed_number(value: Expr) -> str:
    """A number as one text, in which no part has a name."""
    return PrintedExpressions((), [value], shares=False).texts[0]


def printed_functions(variables: Sequence[Symbol], functions: Sequence[Expr]) -> list[str]:
    """Functions as texts in the names of the variables, in which no part has a name."""
    return PrintedExpressions(variables, functions, shares=False, names=[str(v) for v in variables]).texts


def _factor(part: Any, text: str) -> str:
    """A text as a factor, or as the base of a power."""
    is_whole = text.isalnum() or (part.is_Function and text[0].isalpha())
    return text if is_whole else f"({text})"
