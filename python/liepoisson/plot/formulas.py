r"""Formulas of the language of system files as mathematical text: -alpha2*beta3 + 1 is $-\alpha_{2}\,\beta_{3} + 1$."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from liepoisson.errors import ExpressionError
from liepoisson.plot.labels import LONGEST, label, plain, symbol, upright

if TYPE_CHECKING:
    from liepoisson.formula.grammar import Node, Product

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
