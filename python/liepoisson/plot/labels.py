r"""Texts of users in figures: the one place where names, formulas and labels become texts that Matplotlib can draw.

Matplotlib reads what is between two dollar signs as mathematical text and fails, when the figure is drawn, on what it
cannot read.  A name of a system is therefore always plain text, the name of a coordinate is mathematical text of a form
that is known to be readable, and only the label of an axis, which a user writes for figures, may contain formulas.
Formulas of the language of system files are mathematical text: -alpha2*beta3 + 1 is $-\alpha_{2}\,\beta_{3} + 1$.
"""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

from liepoisson.errors import ExpressionError

if TYPE_CHECKING:
    from liepoisson.formula.grammar import Node, Product

LONGEST = 200
"""Characters of the longest text that is drawn; the layout of longer ones takes minutes."""
_LETTERS = {
    name: rf"\{name}"
    for name in (
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi",
        "rho", "sigma", "tau", "phi", "chi", "psi", "omega",
    )
} | {"l": r"\ell"}  # fmt: skip
_NAME = re.compile(r"([A-Za-z]+?)_?([0-9]*)")
_WITH_SUBSCRIPT = re.compile(r"([A-Za-z]+)_([A-Za-z]+?[0-9]*)")
"""The momentum p_theta2 of theta2."""
_MODE = re.compile(r"(w|psi)([cs])(?:(m?[0-9]+)_(m?[0-9]+)|(m?[0-9])(m?[0-9]))")
"""Coordinates of truncated fluids: wc1m2 and ws1m2 are the real and the imaginary part of w with index (1, -2)."""
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


def plain(text: object, most: int = LONGEST) -> str:
    r"""Any text for Matplotlib, cut to its length: no dollar sign begins a formula, no character breaks a line."""
    shown = "".join(_drawable(character) for character in str(text)[: most + 1])
    shown = shown if len(shown) <= most else f"{shown[: most - 2]} …"
    return shown.replace("$", r"\$")


def symbol(name: str) -> str:
    r"""A name as mathematical text without its dollar signs: alpha1 is \alpha_{1}, any other one is upright.

    A letter and a name behind an underscore are a letter with a subscript: p_theta2 is p_{\theta_{2}}.
    The modes of truncated fluids are real and imaginary parts: ws1m2 is \mathrm{Im}\,w_{1,{-}2}.
    """
    if mode := _MODE.fullmatch(name):
        indices = ",".join(k.replace("m", "{-}") for k in mode.groups()[2:] if k)
        return rf"{vector_symbol(name)}_{{{indices}}}"
    found = _NAME.fullmatch(name)
    if len(name) > LONGEST:
        return upright(name)
    if found is None:
        parts = _WITH_SUBSCRIPT.fullmatch(name)
        if parts is None or (len(parts[1]) > 1 and parts[1] not in _LETTERS):
            return upright(name)
        return f"{symbol(parts[1])}_{{{symbol(parts[2])}}}"
    stem, digits = found.groups()
    letter = _LETTERS.get(stem, stem if len(stem) == 1 else rf"\mathrm{{{stem}}}")
    return f"{letter}_{{{digits}}}" if digits else letter


def vector_of(name: str) -> str:
    """The name of what a component belongs to: l of l1, and wc, the real parts, of wc1m2."""
    mode = _MODE.fullmatch(name)
    return mode[1] + mode[2] if mode else re.sub(r"[\d_]+$", "", name) or name


def vector_symbol(component: str) -> str:
    r"""What a component belongs to, as mathematical text without its dollar signs: \ell of l1."""
    if mode := _MODE.fullmatch(component):
        part = "Re" if mode[2] == "c" else "Im"
        return rf"\mathrm{{{part}}}\,{_LETTERS.get(mode[1], mode[1])}"
    return symbol(vector_of(component))


def label(name: str) -> str:
    r"""A letter or word with a number or a subscript as mathematical text: alpha1 is $\alpha_1$; other text is plain.

    A name that begins with a hyphen below is mathematical text, too: a legend leaves out plain ones.
    """
    if len(name) > LONGEST or not _IDENTIFIER.fullmatch(name):
        return plain(name)
    written = symbol(name)
    is_word = written == upright(name) and not (_NAME.fullmatch(name) or name.startswith("_"))
    return plain(name) if is_word else f"${written}$"


def with_formulas(text: str) -> str:
    r"""A label in which dollar signs enclose formulas; as plain text if Matplotlib cannot read one of them."""
    from matplotlib.cbook import is_math_text
    from matplotlib.mathtext import MathTextParser

    shown = "".join(character if character == "\n" else _drawable(character) for character in text[: LONGEST + 1])
    if len(shown) > LONGEST or not is_math_text(shown):
        return plain(text)
    try:
        for line in shown.split("\n"):
            MathTextParser("path").parse(line)
    except (ValueError, RecursionError):
        return plain(text)
    return shown


def _drawable(character: str) -> str:
    """The character; a space for one that breaks lines, a mark for one that no font has and no file can hold."""
    if character.isspace():
        return " "
    return "\ufffd" if unicodedata.category(character) in {"Cc", "Cf", "Cs", "Co", "Cn"} else character


def upright(name: str) -> str:
    r"""A name in upright letters, \mathrm{name}: only letters and digits as they are."""
    shown = name if len(name) <= LONGEST else f"{name[: LONGEST - 3]}..."
    letters = "".join(c if c.isascii() and c.isalnum() else r"\_" if c == "_" else r"\ " for c in shown)
    return rf"\mathrm{{{letters}}}"


def name_of_system(run: object) -> str | None:
    """The name of the system of a result, or of the dataset of one; None if it has none."""
    given = getattr(run, "system", None) or getattr(run, "attrs", {}).get("system")
    name = getattr(given, "name", given)
    return name if isinstance(name, str) else None


_SUM, _PRODUCT, _POWER, _ATOM = range(4)
"""How tightly a part holds together: one that stands where a tighter one is wanted has brackets."""
_OF_VECTORS = {"dot": r"\cdot ", "cross": r"\times "}
_NUMBER = re.compile(r"[0-9.]+(?:[eE][+-]?[0-9]+)?")
_KNOWN_TO_MATPLOTLIB = {"sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log"}


def formula(text: str) -> str:
    """A formula as mathematical text; as plain text where it is not in the language, or too long to be drawn."""
    from matplotlib.mathtext import MathTextParser

    from liepoisson.formula.grammar import parse

    if len(text) > LONGEST or text.isidentifier():
        return label(text)
    try:
        shown = f"${_written(parse(text), text)[0]}$"
        MathTextParser("path").parse(shown)
    except (ExpressionError, ValueError, RecursionError):
        return plain(text)
    return shown


def number(value: float, digits: int = 4) -> str:
    r"""A number as mathematical text without its dollar signs: -1.5e-07 is -1.5\times 10^{-7}."""
    mantissa, _, power = f"{value:.{digits}g}".partition("e")
    words = {"nan": r"\mathrm{nan}", "inf": r"\infty", "-inf": r"-\infty"}.get(mantissa, mantissa)
    return rf"{words}\times 10^{{{int(power)}}}" if power else words


def _written(node: Node, text: str) -> tuple[str, int]:  # noqa: PLR0911  # a line for each kind
    """A part of a formula, and how tightly it holds together."""
    from liepoisson.formula.grammar import Call, Component, Name, Negative, Number, Power, Product, Sum

    match node:
        case Number():
            found = _NUMBER.match(text, node.position)
            mantissa, _, power = (found[0] if found else str(node.value)).lower().partition("e")
            return (rf"{mantissa}\times 10^{{{int(power)}}}", _PRODUCT) if power else (mantissa, _ATOM)
        case Name():
            return symbol(node.name), _ATOM
        case Component(children=(vector,)):
            return f"{{{_within(vector, text, _ATOM)}}}_{{{','.join(map(str, node.indices))}}}", _ATOM
        case Negative(children=(child,)):
            return f"-{_within(child, text, _PRODUCT)}", _SUM
        case Power(children=(base, exponent)):
            return f"{_within(base, text, _ATOM)}^{{{_within(exponent, text, _SUM)}}}", _POWER
        case Sum():
            terms = [_within(child, text, _PRODUCT if k else _SUM) for k, child in enumerate(node.children)]
            pairs = zip(node.signs[1:], terms[1:], strict=True)
            return terms[0] + "".join(f" {sign} {term}" for sign, term in pairs), _SUM
        case Product():
            return _product(node, text)
        case Call():
            return _call(node.function, [_written(child, text) for child in node.children])
        case _:
            raise ValueError(f"no such part of a formula: {node!r:.80}")


def _within(node: Node, text: str, wanted: int) -> str:
    """A part, in brackets where it holds together less tightly than is wanted."""
    written, level = _written(node, text)
    return written if level >= wanted else f"({written})"


def _product(node: Product, text: str) -> tuple[str, int]:
    """Factors with a thin space between them; a first factor -1 is a sign."""
    from liepoisson.formula.grammar import Negative, Number

    factors = [*zip(node.operators, node.children, strict=True)]
    sign = ""
    if isinstance(first := factors[0][1], Negative):
        sign, child = "-", first.children[0]
        is_one = isinstance(child, Number) and child.value == 1 and factors[1][0] == "*"
        factors = factors[1:] if is_one else [("*", child), *factors[1:]]
    shown = ""
    for operator, factor in factors:
        part = _within(factor, text, _POWER)
        between = "/" if operator == "/" else r"\cdot " if part[0].isdigit() else r"\,"
        shown += f"{between}{part}" if shown else part
    return (f"-{shown}", _SUM) if sign else (shown, _PRODUCT)


def _call(function: str, arguments: list[tuple[str, int]]) -> tuple[str, int]:
    if function in _OF_VECTORS and len(arguments) == 2:
        sides = (part if level >= _POWER else f"({part})" for part, level in arguments)
        return _OF_VECTORS[function].join(sides), _PRODUCT
    listed = ", ".join(part for part, _ in arguments)
    if function == "sqrt" and len(arguments) == 1:
        return rf"\sqrt{{{listed}}}", _ATOM
    if function == "norm" and len(arguments) == 1:
        return f"|{listed}|", _ATOM
    name = rf"\{function}" if function in _KNOWN_TO_MATPLOTLIB else upright(function)
    return f"{name}({listed})", _ATOM
