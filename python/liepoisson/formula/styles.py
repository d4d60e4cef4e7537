r"""How formulas look: plain ASCII, ASCII names with the signs of vector algebra, Unicode, LaTeX."""

# ruff: noqa: D102 - what each sign means is said once, in Style

from __future__ import annotations

import unicodedata
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, TypeAlias, final

from liepoisson.inputs.names import GREEK

Factors: TypeAlias = "tuple[int, Sequence[str]]"
"""A number and factors after it."""

_UNLIKE_LATIN = ("gamma", "delta", "theta", "lambda", "xi", "pi", "sigma", "phi", "psi", "omega")
LETTERS = {name: chr(ord("α") + k) for k, name in enumerate(GREEK) if name != "omicron"} | {
    name.capitalize(): chr(ord("Α") + k) for k, name in enumerate(GREEK) if name in _UNLIKE_LATIN
}
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FRACTIONS = {(1, 2): "½", (1, 3): "⅓", (2, 3): "⅔", (1, 4): "¼", (3, 4): "¾", (1, 8): "⅛"}
_LATEX_FUNCTIONS = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}
_LATEX_KNOWN = {"exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "arcsin", "arccos", "arctan"}


class Style(ABC):
    """The signs of one way of writing.

    Attributes:
        dot: Between two vectors.
        cross: Between two vectors.
        prime: After a coordinate or field, for its time derivative.
        unequal: Between two numbers that are not equal.
        arrow: Between a thing and its image.
        times: Between two factors in a statement.
        between: Between a product and the vector expressions after it.
    """

    dot: str
    cross: str
    prime: str = "'"
    unequal: str = "!="
    arrow: str = "->"
    times: str = "*"
    between: str = " "

    @abstractmethod
    def component(self, name: str, base: str, index: str) -> str:
        """A scalar by its name, which is made of a base and perhaps an index."""

    @abstractmethod
    def vector(self, name: str) -> str:
        """A vector by its name."""

    @abstractmethod
    def quotient(self, above: Factors, below: Factors, *, before_vectors: bool) -> str:
        """A product of a number and factors over another one."""

    def product(
        self,
        number: int,
        above: Sequence[str],
        denominator: int,
        below: Sequence[str],
        vectors: Sequence[str],
    ) -> str:
        """A product of a number and factors, over a number and factors, with the vector expressions at the end."""
        whole = self.quotient((number, above), (denominator, below), before_vectors=bool(vectors))
        return self.between.join(([] if vectors and whole == "1" else [whole]) + list(vectors))

    @abstractmethod
    def power(self, base: str, exponent: str) -> str:
        """A power."""

    @abstractmethod
    def root(self, text: str) -> str:
        """A square root."""

    @abstractmethod
    def function(self, name: str, arguments: str) -> str:
        """A function applied to its arguments."""

    @abstractmethod
    def image(self, matrix: str, power: int, vector: str) -> str:
        """A matrix, or its inverse, applied to a vector."""

    @abstractmethod
    def gradient(self, field: str) -> str:
        """The derivative of H along a field."""

    def parentheses(self, text: str) -> str:
        """The text in parentheses."""
        return f"({text})"

    def other(self, expression: Any) -> str:
        """Anything that we have no sign for."""
        return str(expression)

    def ring(self, name: str) -> str:
        """A ring of numbers, R or C, or a variable."""
        return name

    def matrix(self, rows: Sequence[Sequence[str]]) -> str:
        """A matrix by its rows."""
        return self.parentheses(", ".join(self.parentheses(", ".join(row)) for row in rows))

    def left_out(self, n_terms: int) -> str:
        """Instead of terms for which there is no room."""
        return f" + ... ({n_terms} more terms)"

    def words(self, text: str) -> str:
        """Words between formulas."""
        return text

    def formula(self, text: str) -> str:
        """A formula between words."""
        return text

    def text(self, words: str) -> str:
        """Words inside a formula."""
        return self.words(words)


@final
class PlainText(Style):
    """ASCII names; products of components with stars, so that they can be typed into a system file."""

    def __init__(self, dot: str, cross: str) -> None:
        self.dot, self.cross = dot, cross

    def component(self, name: str, base: str, index: str) -> str:
        return name

    def vector(self, name: str) -> str:
        return name

    def quotient(self, above: Factors, below: Factors, *, before_vectors: bool) -> str:
        sign, divisors = " " if before_vectors else "*", _factors(below)
        divisor = sign.join(divisors)
        numerator = sign.join(_factors(above)) or "1"
        return numerator + (f"/({divisor})" if len(divisors) > 1 else f"/{divisor}" if divisors else "")

    def power(self, base: str, exponent: str) -> str:
        return f"{base}^{exponent}" if exponent.isalnum() else f"{base}^({exponent})"

    def root(self, text: str) -> str:
        return f"sqrt({text})"

    def function(self, name: str, arguments: str) -> str:
        return f"{name}({arguments})"

    def image(self, matrix: str, power: int, vector: str) -> str:
        return f"{matrix}^-1 {vector}" if power < 0 else f"{matrix} {vector}"

    def gradient(self, field: str) -> str:
        return f"dH/d{field}"

    def words(self, text: str) -> str:
        return text if self.cross.isascii() is False else _ascii(text)


@final
class UnicodeText(Style):
    """Greek letters, superscripts and subscripts, in one line."""

    dot, cross, prime, unequal, arrow, times = "·", " × ", "′", "≠", "→", " "

    def component(self, name: str, base: str, index: str) -> str:
        stem, number = split_name(base)  # the field x0 has the components x01, x02, ...
        letter, rest = LETTERS.get(stem, stem), name[len(stem) :]
        if (number + index).isdigit():
            return letter + rest.translate(_SUBSCRIPTS)
        return letter + (f"_{LETTERS[index]}" if index in LETTERS else rest)

    def vector(self, name: str) -> str:
        return self.component(name, *split_name(name))

    def quotient(self, above: Factors, below: Factors, *, before_vectors: bool) -> str:
        fraction = _FRACTIONS.get((above[0], below[0]))
        if before_vectors and not below[1] and fraction:
            return fraction + " ".join(above[1])
        divisor = f"({_juxtaposed(below)})" if len(_factors(below)) > 1 else _juxtaposed(below)
        return _juxtaposed(above) + ("" if divisor == "1" else f"/{divisor}")

    def power(self, base: str, exponent: str) -> str:
        if exponent.lstrip("-").isdigit():
            return base + exponent.translate(_SUPERSCRIPTS)
        return f"{base}^({exponent})"

    def root(self, text: str) -> str:
        return f"√{text}" if text.isdigit() else f"√({text})"

    def function(self, name: str, arguments: str) -> str:
        return f"{name}({arguments})"

    def image(self, matrix: str, power: int, vector: str) -> str:
        return f"{matrix}⁻¹{vector}" if power < 0 else f"{matrix} {vector}"

    def gradient(self, field: str) -> str:
        return f"∂H/∂{self.vector(field)}"


@final
class Latex(Style):
    r"""LaTeX for mathematical mode; needs `\boldsymbol` (amsmath)."""

    dot, cross, unequal, arrow = r"\cdot ", r"\times ", r"\neq ", r"\mapsto "
    times = between = r"\,"

    def component(self, name: str, base: str, index: str) -> str:
        stem, number = split_name(base)  # the field x0 has the components x_{0,1}, x_{0,2}, ...
        if (number or index) in LETTERS:  # p_theta1 is the momentum of theta_1
            return rf"{_latex_name(stem)}_{{\{number or index}{_latex_index(index) if number else ''}}}"
        return _latex_name(stem) + (
            f"_{{{latex_text(number)},{latex_text(index)}}}" if number and index else _latex_index(number or index)
        )

    def vector(self, name: str) -> str:
        base, index = split_name(name)
        return rf"\boldsymbol{{{_latex_name(base)}}}{_latex_index(index)}"

    def quotient(self, above: Factors, below: Factors, *, before_vectors: bool) -> str:
        numerator, divisor = " ".join(_factors(above)) or "1", " ".join(_factors(below))
        small = r"\tfrac" if before_vectors and not above[1] and not below[1] else r"\frac"
        return f"{small}{{{numerator}}}{{{divisor}}}" if divisor else numerator

    def power(self, base: str, exponent: str) -> str:
        return f"{base}^{{{exponent}}}"

    def root(self, text: str) -> str:
        return rf"\sqrt{{{text}}}"

    def function(self, name: str, arguments: str) -> str:
        latin = _LATEX_FUNCTIONS.get(name, name)
        sign = f"\\{latin}" if latin in _LATEX_KNOWN else rf"\operatorname{{{latex_text(latin)}}}"
        return sign + self.parentheses(arguments)

    def image(self, matrix: str, power: int, vector: str) -> str:
        return f"{_latex_name(matrix)}^{{-1}}{vector}" if power < 0 else f"{_latex_name(matrix)}{vector}"

    def gradient(self, field: str) -> str:
        return rf"\frac{{\partial H}}{{\partial {self.vector(field)}}}"

    def parentheses(self, text: str) -> str:
        return rf"\left({text}\right)"

    def other(self, expression: Any) -> str:
        from sympy import latex

        return latex(expression)

    def ring(self, name: str) -> str:
        return rf"\mathbb{{{name}}}" if name in ("R", "C") else name

    def matrix(self, rows: Sequence[Sequence[str]]) -> str:
        return r"\begin{pmatrix}" + r" \\ ".join(" & ".join(row) for row in rows) + r"\end{pmatrix}"

    def left_out(self, n_terms: int) -> str:
        return rf" + \dots \text{{ ({n_terms} more terms)}}"

    def words(self, text: str) -> str:
        return "".join(_SIGNS_IN_LATEX.get(character, character) for character in latex_text(text))

    def formula(self, text: str) -> str:
        return f"${text}$"

    def text(self, words: str) -> str:
        return rf"\text{{ {self.words(words)} }}"


PLAIN = PlainText(dot=".", cross=" x ")
NAMES = PlainText(dot="·", cross=" × ")
"""ASCII names, so that a formula can be compared with code, and the usual signs between vectors."""
UNICODE = UnicodeText()
LATEX = Latex()


def split_name(name: str) -> tuple[str, str]:
    """A name and its index: "a3" is ("a", "3"), "beta_e" is ("beta", "e"), "epsilon" has none."""
    stem = name.rstrip("0123456789")
    if stem and stem != name:
        return stem.rstrip("_") or stem, name[len(stem) :]
    base, _, index = name.partition("_")
    return (base, index) if base and index else (name, "")


def latex_text(text: str) -> str:
    """Text with the characters that LaTeX reserves escaped."""
    return "".join(_RESERVED.get(character, character) for character in text)


_RESERVED = {character: "\\" + character for character in "#$%&_{}"} | {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
}


_SIGNS_IN_LATEX = {"⊗": r"$\otimes$", "⋉": r"$\ltimes$", "×": r"$\times$", "·": r"$\cdot$", "⊕": r"$\oplus$"}
_SIGNS_IN_ASCII = {"⊗": "(x)", "⋉": "|x", "×": "x", "·": ".", "⊕": "(+)", "–": "-", "—": "-", "’": "'", "′": "'"}


def _ascii(text: str) -> str:
    """The text with signs spelled out and accents left away."""
    spelled = "".join(_SIGNS_IN_ASCII.get(character, character) for character in text)
    return unicodedata.normalize("NFKD", spelled).encode("ascii", "ignore").decode()


def _factors(product: Factors) -> list[str]:
    """A number, if it is not 1, and the factors after it."""
    number, factors = product
    return ([str(number)] if number != 1 else []) + list(factors)


def _juxtaposed(product: Factors) -> str:
    number, factors = product
    return (str(number) if number != 1 else "") + " ".join(factors) or "1"


def _latex_name(name: str) -> str:
    if name == "l":
        return r"\ell"
    if name in LETTERS:
        return f"\\{name}"
    return name if len(name) == 1 else rf"\mathit{{{latex_text(name)}}}"


def _latex_index(index: str) -> str:
    if len(index) < 2:
        return f"_{index}" if index else ""
    if index in LETTERS:
        return f"_{{\\{index}}}"
    return f"_{{{index}}}" if index.isdigit() else rf"_{{\mathrm{{{latex_text(index)}}}}}"
