"""Lines of a report: words and formulas in turn, to be written as text or in LaTeX, and as data for JSON.

Text is broken to a width: words at blanks, formulas before a + or - and after a comma.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Protocol, TypeAlias

from liepoisson.formula.styles import LATEX, LETTERS, PLAIN, UNICODE, Style, split_name
from liepoisson.report.printing import Formula, Vector, write_vector

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.styles import Style
    from liepoisson.structure.bracket import Bracket

MOST_TERMS = 12
"""Longer sums are cut off in text and LaTeX; JSON has them whole."""


class Written(Protocol):
    """Anything that is written differently in different styles."""

    def write(self, style: Style, /) -> str:
        """In one style, without the signs that set it off from words."""
        ...


Piece: TypeAlias = "str | Written"
Line: TypeAlias = "tuple[Piece, ...]"


@dataclass(frozen=True)
class Sign:
    """Something that is written differently in different styles, as a function of the style says."""

    write: Callable[[Style], str]


@dataclass(frozen=True)
class Name:
    """The name of a scalar: C1, epsilon, P', or l.alpha for a product of two vectors."""

    name: str

    def write(self, style: Style) -> str:
        """The name with its index, in one style."""
        if match := re.fullmatch(r"([A-Za-z]\w*)\.([A-Za-z]\w*)", self.name):
            return style.dot.join(style.vector(part) for part in match.groups())
        if re.fullmatch(r"[A-Za-z]\w*'*", self.name):
            return _scalar(self.name, style)
        if _SIGNS.search(self.name) and all(map(_is_symbol, re.findall(r"[A-Za-z]\w*", self.name))):
            return _formula(self.name, style, _scalar)
        return style.text(self.name)


_SIGNS = re.compile(r"[-+*/^=]")
"""What makes a formula of a name, as in m3+n3 or K^2."""


def _scalar(name: str, style: Style) -> str:
    stem = name.rstrip("'")
    return style.component(stem, *split_name(stem)) + name[len(stem) :]


def _is_symbol(name: str) -> bool:
    """Whether a word is one letter, by itself or by its name, perhaps with an index."""
    base, _ = split_name(name)
    return len(base) == 1 or base in LETTERS


def _formula(text: str, style: Style, write_name: Callable[[str, Style], str]) -> str:
    """A formula in ASCII with the powers and names of a style."""
    if style is PLAIN:
        return text
    parts = re.split(r"([A-Za-z]\w*'*|\^\d+)", text)
    return "".join(
        style.power("", part[1:]) if part.startswith("^") else write_name(part, style) if part[:1].isalpha() else part
        for part in parts
    )


def ring(name: str) -> Sign:
    """The name of a commutative algebra: R[x]/(x^3), C + R, maximal ideal of R[x]/(x^2)."""

    def word(text: str, style: Style) -> str:
        return style.ring(text) if len(text) < _WORD else style.text(text)

    return Sign(lambda style: _formula(name, style, word))


_WORD = 4
"""Letters of a word; shorter ones are products of variables, as in R[x,y]/(xy)."""


def unequal(left: Written) -> Sign:
    """Something that does not vanish."""
    return Sign(lambda style: f"{left.write(style)} {style.unequal.strip()} 0")


@dataclass(frozen=True)
class Statement:
    """A condition or a map in words and names: "epsilon = 0", "alpha x beta != 0" or "alpha -> s*alpha"."""

    statement: str  # in ASCII
    vectors: frozenset[str]  # names in it that are vectors
    scalars: frozenset[str]  # names in it that are scalars

    @classmethod
    def about(cls, statement: str, bracket: Bracket) -> Statement:
        """A statement about the fields, coordinates and parameters of a bracket."""
        vectors = frozenset[str]() if bracket.has_scalar_fields else frozenset(bracket.fields)
        return cls(statement, vectors, frozenset({*map(str, bracket.variables), *bracket.symbols}))

    def write(self, style: Style) -> str:
        """The same with the names and signs of one style."""
        parts = re.split(r"((?<=\w) x (?=\w)|[A-Za-z]\w*|!=|->|\*|\^\d+|\^\(-\d+\))", self.statement)
        written = "".join(self._part(part, style) for part in parts)
        return re.sub(r"\(([^()]+, [^()]+)\)", lambda fields: style.parentheses(fields[1]), written)

    def _part(self, part: str, style: Style) -> str:
        signs = {"!=": style.unequal.strip(), "->": style.arrow, "*": style.times, " x ": style.cross}
        if part in signs:
            return signs[part]
        if part.startswith("^"):
            return style.power("", part.strip("^()"))
        if part in self.vectors:
            return style.vector(part)
        if part in self.scalars or (len(part) == 1 and part.isalpha()):
            return style.component(part, *split_name(part))
        return style.text(part) if re.match(r"[A-Za-z]", part) else part


def vector_name(vector: Vector) -> Sign:
    """The name of a vector."""
    return Sign(lambda style: write_vector(vector, style))


def rate(of: Written) -> Sign:
    """The time derivative of something that has a name."""
    return Sign(lambda style: of.write(style) + style.prime)


def in_parentheses(of: Written) -> Sign:
    """A formula in parentheses."""
    return Sign(lambda style: style.parentheses(of.write(style)))


def column(components: Sequence[Written]) -> Sign:
    """A vector by its components."""
    return Sign(lambda style: style.parentheses(", ".join(_short(component, style) for component in components)))


def shortened(formula: Formula) -> Sign:
    """A formula of which only the first terms are written, and how many there are besides."""
    return Sign(lambda style: _short(formula, style))


@dataclass(frozen=True)
class Equation:
    """What stands on the left equals what stands on the right."""

    left: Written
    right: Written

    def write(self, style: Style) -> str:
        """Both sides; only one of them when they read the same, as for the integral l3."""
        left = self.left.write(style)
        right = _short(self.right, style)
        return right if left == right else f"{left} = {right}"


def _short(piece: Written, style: Style) -> str:
    return piece.write(style, MOST_TERMS) if isinstance(piece, Formula) else piece.write(style)


def write_line(line: Line, style: Style) -> str:
    """Words and formulas one after the other."""
    return "".join(
        style.words(piece) if isinstance(piece, str) else style.formula(piece.write(style)) for piece in line
    )


def joined(pieces: Iterable[Written]) -> list[Piece]:
    """Formulas with commas between them."""
    row: list[Piece] = []
    for piece in pieces:
        row += [", ", piece] if row else [piece]
    return row


def definition_lines(definitions: Sequence[Written]) -> list[Line]:
    """What signs in the formulas above mean, on one line, or nothing."""
    return [("with ", *joined(definitions))] if definitions else []


def record_of(piece: Written) -> dict[str, str]:
    """A piece for JSON: the same in three styles."""
    return {name: piece.write(style) for name, style in (("text", PLAIN), ("unicode", UNICODE), ("latex", LATEX))}


def record_of_formula(formula: Formula, expression: Expr) -> dict[str, str]:
    """A formula for JSON, and the same in components, in the grammar of system files, which has no traces."""
    from liepoisson.structure.trace import traces_in

    components = {} if traces_in(expression) else {"expression": Formula(expression).write(PLAIN)}
    return {**record_of(formula), **components}


_KEPT = "\x00"
"""Stands for a blank where no line is broken."""

_INSIDE = "".join(map(chr, range(1, 9)))
"""Stand for blanks inside parentheses, where a line is broken only if it must: first of all after an outer comma."""

_INDENT = "    "


def wrapped(line: Line, style: Style, width: int) -> list[str]:
    """A line as rows of at most `width` characters; rows after the first are indented where there are formulas.

    A single term that is longer than a row is left whole.
    """
    if all(isinstance(piece, str) for piece in line):
        return wrap("".join(style.words(str(piece)) for piece in line), width)
    text = "".join(
        style.words(piece) if isinstance(piece, str) else breakable(style.formula(piece.write(style))) for piece in line
    )
    rows = [""]
    for chunk in text.split(" "):
        _fill(rows, chunk, width)
    blanks = str.maketrans(dict.fromkeys(_KEPT + _INSIDE, " "))
    return [row.translate(blanks) for row in rows]


def breakable(formula: str) -> str:
    """The formula with a blank left only where a line may be broken: before + and -, and after commas."""
    depth, marked = 0, ""
    for position, character in enumerate(formula):
        depth += (character in "([{") - (character in ")]}")
        if character != " ":
            marked += character
        elif formula[position + 1 : position + 3] in ("+ ", "- ") or formula[position - 1] == ",":
            level = 2 * depth - (formula[position - 1] == ",") - 1
            marked += _INSIDE[min(level, len(_INSIDE) - 1)] if depth else " "
        else:
            marked += _KEPT
    return marked


def _fill(rows: list[str], chunk: str, width: int) -> None:
    """Append a chunk, broken at the outermost of its blanks if there is no better way."""
    # What is left of a row is used if the next one does not hold the chunk either, or if it is most of the row.
    broken = len(chunk) > width - len(_INDENT) or len(rows[-1]) < width // 3
    blank = next((mark for mark in _INSIDE if mark in chunk), None)
    if blank is None or not broken or _fits(rows, chunk, width):
        _append(rows, chunk, width)
        return
    for part in chunk.split(blank):
        _fill(rows, part, width)


def _fits(rows: list[str], chunk: str, width: int) -> bool:
    return len(rows[-1]) + bool(rows[-1]) + len(chunk) <= width


def _append(rows: list[str], chunk: str, width: int) -> None:
    if not rows[-1]:
        rows[-1] = chunk
    elif _fits(rows, chunk, width):
        rows[-1] += f" {chunk}"
    else:
        rows.append(_INDENT + chunk)
