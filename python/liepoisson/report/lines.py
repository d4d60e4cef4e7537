"""Lines of a report: words and formulas in turn, to be written as text or in LaTeX, and as data for JSON."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

from liepoisson.formula.styles import LATEX, LETTERS, PLAIN, UNICODE, Style, split_name
from liepoisson.report.printing import Formula, Vector, write_vector

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.strata import Locus

MOST_TERMS = 12
"""Longer sums are cut off in text and LaTeX; JSON has them whole."""


class Written(Protocol):
    """Anything that is written differently in different styles."""

    def write(self, style: Style) -> str:
        """In one style, without the signs that set it off from words."""
        ...


Piece: TypeAlias = "str | Written"
Line: TypeAlias = "tuple[Piece, ...]"


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


@dataclass(frozen=True)
class Ring:
    """The name of a commutative algebra: R[x]/(x^3), C + R, maximal ideal of R[x]/(x^2)."""

    name: str

    def write(self, style: Style) -> str:
        """The name with its powers."""
        return _formula(self.name, style, lambda word, s: s.ring(word) if len(word) < _WORD else s.text(word))


_WORD = 4
"""Letters of a word; shorter ones are products of variables, as in R[x,y]/(xy)."""


@dataclass(frozen=True)
class Unequal:
    """Something that does not vanish."""

    left: Written

    def write(self, style: Style) -> str:
        """The inequality."""
        return f"{self.left.write(style)} {style.unequal.strip()} 0"


@dataclass(frozen=True)
class Statement:
    """A condition or a map in words and names, for example "epsilon = 0" or "alpha -> s*alpha".

    Attributes:
        statement: In ASCII.
        vectors: Names in it that are vectors.
        scalars: Names in it that are scalars.
    """

    statement: str
    vectors: frozenset[str]
    scalars: frozenset[str]

    @classmethod
    def about(cls, statement: str, bracket: Bracket) -> Statement:
        """A statement about the fields, coordinates and parameters of a bracket."""
        vectors = frozenset[str]() if bracket.has_scalar_fields else frozenset(bracket.fields)
        return cls(statement, vectors, frozenset({*map(str, bracket.variables), *bracket.symbols}))

    def write(self, style: Style) -> str:
        """The same with the names and signs of one style."""
        parts = re.split(r"([A-Za-z]\w*|!=|->|\*|\^\d+|\^\(-\d+\))", self.statement)
        return "".join(self._part(part, style) for part in parts)

    def _part(self, part: str, style: Style) -> str:
        signs = {"!=": style.unequal, "->": style.arrow, "*": style.times}
        if part in signs:
            return signs[part]
        if part.startswith("^"):
            return style.power("", part.strip("^()"))
        if part in self.vectors:
            return style.vector(part)
        if part in self.scalars or (len(part) == 1 and part.isalpha()):
            return style.component(part, *split_name(part))
        return style.text(part) if re.match(r"[A-Za-z]", part) else part


@dataclass(frozen=True)
class Conditions:
    """Where a locus is: beta = 0, alpha x l != 0; it has conditions that can be named.

    Attributes:
        locus: The conditions.
        are_vectors: Whether the fields are vectors; otherwise they have one component.
    """

    locus: Locus
    are_vectors: bool

    def write(self, style: Style) -> str:
        """The conditions with the names and signs of one style."""
        locus, unequal = self.locus, f" {style.unequal.strip()} 0"
        return ", ".join(
            [
                *(f"{self._field(name, style)} = 0" for name in locus.zero),
                *(f"{self._product(pair, style)} = 0" for pair in locus.parallel),
                *(self._some(names, style) + unequal for names in locus.nonzero),
                *(self._product(pair, style) + unequal for pair in locus.not_parallel),
            ]
        )

    def _field(self, name: str, style: Style) -> str:
        return style.vector(name) if self.are_vectors else style.component(name, *split_name(name))

    def _product(self, pair: Iterable[str], style: Style) -> str:
        return style.cross.join(self._field(name, style) for name in pair)

    def _some(self, names: Sequence[str], style: Style) -> str:
        written = ", ".join(self._field(name, style) for name in names)
        return written if len(names) == 1 else style.parentheses(written)


@dataclass(frozen=True)
class VectorName:
    """The name of a vector."""

    vector: Vector

    def write(self, style: Style) -> str:
        """The name, in one style."""
        return write_vector(self.vector, style)


@dataclass(frozen=True)
class Rate:
    """The time derivative of something that has a name."""

    of: Written

    def write(self, style: Style) -> str:
        """The name with a prime."""
        return self.of.write(style) + style.prime


@dataclass(frozen=True)
class Column:
    """A vector by its components."""

    components: tuple[Written, ...]

    def write(self, style: Style) -> str:
        """The components in parentheses."""
        return style.parentheses(", ".join(_short(component, style) for component in self.components))


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


@dataclass(frozen=True)
class Shortened:
    """A formula of which only the first terms are written."""

    formula: Formula

    def write(self, style: Style) -> str:
        """The first terms, and how many there are besides."""
        return _short(self.formula, style)


def _short(piece: Written, style: Style) -> str:
    return piece.write(style, MOST_TERMS) if isinstance(piece, Formula) else piece.write(style)


def write_line(line: Line, style: Style) -> str:
    """Words and formulas one after the other."""
    return "".join(
        style.words(piece) if isinstance(piece, str) else style.formula(piece.write(style)) for piece in line
    )


def joined(pieces: Iterable[Written], separator: str = ", ") -> list[Piece]:
    """Formulas with a separator between them."""
    row: list[Piece] = []
    for piece in pieces:
        row += [separator, piece] if row else [piece]
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
