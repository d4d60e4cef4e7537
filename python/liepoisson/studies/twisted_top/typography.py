"""Formulas in plain text as they are printed: SymPy's expressions, program text, and variables in italics in HTML."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markupsafe import Markup

_SUBSCRIPTS = str.maketrans("0123456789k", "₀₁₂₃₄₅₆₇₈₉ₖ")
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_GREEK = {
    "alpha": "α", "beta": "β", "epsilon": "ε", "eta": "η", "theta": "θ", "phi": "φ", "psi": "ψ", "omega": "ω",
    "kappa": "κ", "gamma": "γ", "sqrt": "√",
}  # fmt: skip
_LONGEST = 160

_Rule = tuple[str, str | Callable[[re.Match[str]], str]]
_NUMBER = r"\d+(?:\.\d+)?"

_OF_SYMPY: tuple[_Rule, ...] = (
    (r"\bc_(phi|psi|theta)\b", r"cos \1"),
    (r"\bs_(phi|psi|theta)\b", r"sin \1"),
    (rf"(?<![A-Za-z])({'|'.join(_GREEK)})(?![a-z])", lambda m: _GREEK[m[1]]),
    (r"\*\*(?:(\d+)|\((-?\d+)\))", lambda m: (m[1] or m[2]).translate(_SUPERSCRIPTS)),
    (r"(?<=[A-Za-zα-ω])(\d+)", lambda m: m[1].translate(_SUBSCRIPTS)),
    (r"√\((\d+)\)", r"√\1"),
    (r"\*\*", "^"),
    (r"\*", "·"),
    ("-", "−"),
)
_OF_PROGRAMS: tuple[_Rule, ...] = (
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


def _rewritten(text: str, rules: tuple[_Rule, ...]) -> str:
    for pattern, replacement in rules:
        text = re.sub(pattern, replacement, text)
    return text


def show(expression: object) -> str:
    """An expression in one line of Unicode text, for example "2ε·l₁·β₁ + α₁²", cut when it is very long."""
    text = _rewritten(str(expression), _OF_SYMPY)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 2] + " …"


def typeset(text: str) -> str:
    """A sentence with its formulas in program text set as those of the paper: "l2 = 4*x" is "l₂ = 4x".

    Words stay as they are, those with a hyphen, too.
    """
    return _rewritten(text, _OF_PROGRAMS)


_SCRIPTS = "₀₁₂₃₄₅₆₇₈₉⁰¹²³⁴⁵⁶⁷⁸⁹⁻′⊥∥ᵏʷₖᵀ_"
_OPERATORS = r"=≠<>≤≥≃×·+−±/|∇∂√⊗→∈(,"
# A letter that no letter touches, nor the "&" and ";" of an entity of escaped text such as "&lt;".
_START, _END = r"(?<![A-Za-z’&;])", r"(?![A-Za-z’;])"
# What follows a, A and I, which are words too, where they are variables.
_FORMULA = rf"(?=[{_SCRIPTS}]|\s[Ae][{_SCRIPTS}]|\s?[=≠<>≤≥≃×·+−±/|)∇∂⊗→,.])"
_PHRASE = r"(?= and b| equatorial| on the axis| is parallel| for β)"
_NO_WORD = r"(?!\s[A-Za-z]{2})"
_VARIABLE = re.compile(
    "|".join(
        (
            "[α-ωϵ]",
            rf"{_START}d[a-np-zA-Z]{_END}",  # a differential, and not the word "do"
            rf"{_START}(?:kt|xz|yz|wn|vn|hn|ru|vw|va|wb|Ba|BI|Lp|Aw){_END}",
            rf"{_START}[b-zB-HJ-Z]{_END}",
            rf"{_START}[aAI](?:{_FORMULA}|{_PHRASE})",
            rf"(?:(?<=[{_OPERATORS}])|(?<=[{_OPERATORS}]\s))[aAI]{_END}{_NO_WORD}",
            "(?<=ᵀ)A",
            "(?<=matrix )[A-Z]",
        )
    )
)
# Indices that Unicode does not have: p_φ, I_max, and the ⊥ and ∥ of e⊥, e∥.
_INDEX = re.compile(r"_(<i>[α-ωϵ]</i>|max)|(?<=</i>)([⊥∥])")


def mathematics(text: object) -> Markup:
    """The text as HTML with its variables in italics, so that the a of "α × a" does not read as an article."""
    from markupsafe import Markup, escape

    italic = _VARIABLE.sub(r"<i>\g<0></i>", str(escape(str(text))))
    return Markup(_INDEX.sub(lambda found: f"<sub>{found[1] or found[2]}</sub>", italic))
