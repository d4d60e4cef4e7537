"""Formulas that the package prints as program text, set in type like those of the paper: "l2 = 4*x" as "l₂ = 4x"."""

from __future__ import annotations

import re
from collections.abc import Callable

_SUBSCRIPTS = str.maketrans("0123456789k", "₀₁₂₃₄₅₆₇₈₉ₖ")
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_GREEK = {"alpha": "α", "beta": "β", "epsilon": "ε"}
_NUMBER = r"\d+(?:\.\d+)?"

_Rule = tuple[str, str | Callable[[re.Match[str]], str]]
_RULES: tuple[_Rule, ...] = (
    # Numbers: 2.53e+07 and 0.25-0.25j.
    (
        rf"({_NUMBER})e([+-]?)0*(\d+)",
        lambda m: f"{m[1]} × 10{(m[2].strip('+') + m[3]).translate(_SUPERSCRIPTS)}",
    ),
    (rf"({_NUMBER})([+-])({_NUMBER})j\b", lambda m: f"{m[1]} {m[2]} {m[3]}i"),
    # Names: dalpha1 is the variation of alpha1, and F_2 a subspace.
    (r"(?<![A-Za-z])d(l|alpha|beta)(?=\d)", r"δ\1"),
    (r"(?<![A-Za-z])(alpha|beta|epsilon)(?![a-z])", lambda m: _GREEK[m[1]]),
    (r"(?<![A-Za-z])((?:δ?[lαβ])|[aIJ])(\d+)", lambda m: m[1] + m[2].translate(_SUBSCRIPTS)),
    (r"\b([A-Z])_(\d+|k)\b", lambda m: m[1] + m[2].translate(_SUBSCRIPTS)),
    (r"\bx' =", "dx/dt ="),
    (r"\binfinity(?=:)", "x = ∞"),
    (r"(?<=, )infinity\b", "∞"),
    # Powers and products: 2*x*(1 + x)*y^2 is 2x(1 + x) y².
    (r"\^(\d+)|\^\((-\d+)\)", lambda m: (m[1] or m[2]).translate(_SUPERSCRIPTS)),
    (r"(?<=\d)\*(?=[^\W\d]|\()|(?<=\))\*(?=\()|(?<=[^\W\d])\*(?=\()", ""),
    (r"\*", " "),
    # Signs.
    (r"(?<= )-(?= )|(?<![^\s(,=/:])-(?=[\w(])", "−"),
)


def typeset(text: str) -> str:
    """A sentence with its formulas in Unicode: Greek letters, indices, powers, products and signs as they are printed.

    Words stay as they are, those with a hyphen, too.
    """
    for pattern, replacement in _RULES:
        text = re.sub(pattern, replacement, text)
    return text
