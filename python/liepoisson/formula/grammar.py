"""The grammar of formulas: text to tokens to a tree.  No text is ever run as code.

    sum       = product { ("+" | "-") product }
    product   = factor { ("*" | "/") factor }
    factor    = ("+" | "-") factor | power
    power     = component [ ("^" | "**") factor ]
    component = atom [ "[" index { "," index } "]" ]
    atom      = number | name | name "(" sum { "," sum } ")" | "(" sum ")"

`^` is a power, binds to the right and tighter than a sign: -x^2 is -(x^2), 2^3^2 is 2^9.  Components are
counted from 1.  The method is recursive descent; what the tree means is said in `liepoisson.formula.expression`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from liepoisson.errors import ExpressionError
from liepoisson.inputs.names import GREEK, MAX_NAME

MAX_CHARACTERS = 20_000
MAX_NESTING = 64
MAX_DIGITS = 200

_TOKEN = re.compile(
    r"[ \t\r\n]+|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z_0-9]*)|(?P<sign>\*\*|[-+*/^()\[\],])"
)


# What people write instead of our signs, and what to write.
_INSTEAD = {
    ".": "A dot is no operator here: a component is l[1], a scalar product dot(u, v).",
    "=": "Write one expression, without '='.",
    "'": "Text in quotes has no place in a formula.",
    '"': "Text in quotes has no place in a formula.",
    "·": "Write * between numbers and dot(u, v) for vectors.",
    "⋅": "Write * between numbers and dot(u, v) for vectors.",
    "×": "Write * between numbers and cross(u, v) for vectors.",
    "∧": "Write cross(u, v).",
    "−": "Write the minus sign as -.",
    "–": "Write the minus sign as -.",
    "²": "Write ^2.",
    "³": "Write ^3.",
    "√": "Write sqrt(x).",
    "|": "Write norm(v) or dot(v, v) for the length of a vector.",
    "{": "Use ( and ).",
    "}": "Use ( and ).",
    "\\": "Write names without a backslash: alpha, sqrt(x).",
    "ϵ": "Write epsilon.",
    "ϑ": "Write theta.",
    "ϕ": "Write phi.",
    "ℓ": "Write l.",
}


@dataclass(frozen=True, slots=True)
class Node:
    """A part of a formula.

    Attributes:
        position: Offset in the text to which an error about this part points.
        children: Its own parts, from left to right.
    """

    position: int
    children: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Number(Node):
    """An exact rational number."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Name(Node):
    """A name: a variable, a parameter, a component in short form (l1)."""

    name: str


@dataclass(frozen=True, slots=True)
class Sum(Node):
    """A sum; `signs` holds "+" or "-" for each of `children`, `positions` where it stands."""

    signs: tuple[str, ...]
    positions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Product(Node):
    """A product from left to right; `operators` holds "*" or "/" for each of `children` ("*" for the first)."""

    operators: tuple[str, ...]
    positions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Negative(Node):
    """Minus its only child."""


@dataclass(frozen=True, slots=True)
class Power(Node):
    """Base and exponent."""


@dataclass(frozen=True, slots=True)
class Component(Node):
    """A component of a vector, or of a matrix with two indices, counted from 1."""

    indices: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Call(Node):
    """A function of its children."""

    function: str


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str  # "number", "name", "end" or the sign itself
    text: str
    position: int


def parse(text: str) -> Node:
    """The tree of a formula.

    Raises:
        ExpressionError: the text is not in the grammar, or too long, too deep, or with too long a number.
    """
    if not isinstance(text, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ExpressionError(f"a formula must be text; got {type(text).__name__}. Put it in quotes", "", 0)
    if len(text) > MAX_CHARACTERS:
        raise ExpressionError(
            f"a formula must have at most {MAX_CHARACTERS} characters; got {len(text)}. Use vectors to shorten it",
            text,
            0,
        )
    try:
        return _tree(text)
    except RecursionError:  # the caller stands deep in the stack already
        raise ExpressionError("the formula is nested too deeply. Simplify it", text, 0) from None


@lru_cache(maxsize=64)
def _tree(text: str) -> Node:
    """Kept, as a family of systems has the same formulas for all values of its parameters."""
    return _Parser(text).formula()


def names_in(tree: Node) -> dict[str, int]:
    """The names in a formula (not those of functions), each with the position where it stands first."""
    found: dict[str, int] = {}
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Name):
            found.setdefault(node.name, node.position)
        waiting.extend(reversed(node.children))
    return found


def _tokens(text: str) -> list[_Token]:
    tokens: list[_Token] = []
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _unknown_character(text, position)
        if match.lastgroup:
            kind = match.group() if match.lastgroup == "sign" else match.lastgroup
            tokens.append(_Token("^" if kind == "**" else kind, match.group(), position))
        position = match.end()
    return [*tokens, _Token("end", "", len(text))]


def _unknown_character(text: str, position: int) -> ExpressionError:
    character = text[position]
    hint = _INSTEAD.get(character, "Use numbers, names, + - * / ^, brackets and functions.")
    for first in "αΑ":
        if 0 <= (index := ord(character) - ord(first)) < len(GREEK):
            name = GREEK[index] if first == "α" else GREEK[index].capitalize()
            hint = f"Names are written in ASCII: {name}."
    return ExpressionError(f"{character!r} has no meaning here. {hint.removesuffix('.')}", text, position)


class _Parser:
    """Recursive descent over the tokens; each rule of the grammar is a method."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = _tokens(text)
        self.next = 0
        self.nesting = 0

    def formula(self) -> Node:
        if self.at("end"):
            raise self.error("a formula is empty. Write for example dot(l, l)/2")
        tree = self.sum()
        if not self.at("end"):
            raise self.unexpected()
        return tree

    def sum(self) -> Node:
        children = [self.product()]
        signs, positions = ["+"], [children[0].position]
        while self.at("+", "-"):
            sign = self.take()
            children.append(self.product())
            signs.append(sign.kind)
            positions.append(sign.position)
        if len(children) == 1:
            return children[0]
        return Sum(positions[1], tuple(children), tuple(signs), tuple(positions))

    def product(self) -> Node:
        children = [self.factor()]
        operators, positions = ["*"], [children[0].position]
        while self.at("*", "/"):
            operator = self.take()
            children.append(self.factor())
            operators.append(operator.kind)
            positions.append(operator.position)
        if len(children) == 1:
            return children[0]
        return Product(positions[1], tuple(children), tuple(operators), tuple(positions))

    def factor(self) -> Node:
        if not self.at("+", "-"):
            return self.power()
        sign = self.take()
        child = self.nested(self.factor, sign)
        return child if sign.kind == "+" else Negative(sign.position, (child,))

    def power(self) -> Node:
        base = self.component()
        if not self.at("^"):
            return base
        sign = self.take()
        return Power(sign.position, (base, self.nested(self.factor, sign)))

    def component(self) -> Node:
        atom = self.atom()
        if not self.at("["):
            return atom
        bracket = self.take()
        indices = [self.index()]
        while self.at(","):
            self.take()
            indices.append(self.index())
        self.expect("]", bracket)
        if self.at("["):
            raise self.error("a component has no components. Write A[1,2] for an entry of a matrix")
        return Component(bracket.position, (atom,), tuple(indices))

    def index(self) -> int:
        token = self.token
        if token.kind != "number" or not token.text.isdigit() or len(token.text) > 6 or int(token.text) < 1:
            raise self.error(f"an index is a whole number from 1 on; got {self.shown(token)}. Write for example l[1]")
        return int(self.take().text)

    def atom(self) -> Node:
        token = self.token
        if token.kind == "number":
            return Number(token.position, (), self.number(self.take()))
        if token.kind == "name":
            return self.name(self.take())
        if token.kind == "(":
            self.take()
            inside = self.nested(self.sum, token)
            self.expect(")", token)
            return inside
        raise self.error(f"a number, a name or a bracket is wanted here; got {self.shown(token)}. Complete the formula")

    def name(self, token: _Token) -> Node:
        if len(token.text) > MAX_NAME:
            message = f"a name must have at most {MAX_NAME} characters; got {len(token.text)}. Shorten it"
            raise ExpressionError(message, self.text, token.position)
        if not self.at("("):
            return Name(token.position, (), token.text)
        bracket = self.take()
        arguments = [] if self.at(")") else [self.nested(self.sum, bracket)]
        while self.at(","):
            self.take()
            arguments.append(self.nested(self.sum, bracket))
        self.expect(")", bracket)
        return Call(token.position, tuple(arguments), token.text)

    def number(self, token: _Token) -> Fraction:
        mantissa, _, exponent = token.text.lower().partition("e")
        if sum(map(str.isdigit, mantissa)) > MAX_DIGITS or len(exponent.lstrip("+-")) > 3:
            message = f"a number must have at most {MAX_DIGITS} digits, and 3 in its exponent. Shorten it"
            raise ExpressionError(message, self.text, token.position)
        return Fraction(token.text)

    @property
    def token(self) -> _Token:
        return self.tokens[self.next]

    def at(self, *kinds: str) -> bool:
        return self.token.kind in kinds

    def take(self) -> _Token:
        self.next += 1
        return self.tokens[self.next - 1]

    def nested(self, rule: Callable[[], Node], token: _Token) -> Node:
        """A rule one level deeper; the limit keeps the interpreter's stack, and SymPy's, from overflowing."""
        self.nesting += 1
        if self.nesting > MAX_NESTING:
            message = f"a formula must be nested at most {MAX_NESTING} levels deep. Simplify it"
            raise ExpressionError(message, self.text, token.position)
        node = rule()
        self.nesting -= 1
        return node

    def expect(self, kind: str, opened: _Token) -> None:
        if self.at(kind):
            self.take()
        elif self.at("end"):
            raise ExpressionError(f"this {opened.kind!r} is never closed. Add {kind!r}", self.text, opened.position)
        else:
            raise self.unexpected()

    def unexpected(self) -> ExpressionError:
        """Why no formula goes on with the present token."""
        token = self.token
        before = self.tokens[self.next - 1] if self.next else token
        if token.kind in ("number", "name", "(") and before.kind in ("number", "name", ")", "]"):
            left, right = before.text[:20], token.text[:20]
            return self.error(f"a product needs its sign. Write {left}*{right}")
        if token.kind == "," and before.kind == "number":
            return self.error("',' is not expected here. Write decimals with a point: 0.5")
        return self.error(f"{self.shown(token)} is not expected here. Remove it, or write what belongs before it")

    def shown(self, token: _Token) -> str:
        return "the end of the formula" if token.kind == "end" else repr(token.text[:40])

    def error(self, message: str) -> ExpressionError:
        return ExpressionError(message, self.text, self.token.position)
