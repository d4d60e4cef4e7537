r"""Texts of users in figures: the one place where names, formulas and labels become texts that Matplotlib can draw.

Matplotlib reads what is between two dollar signs as mathematical text and fails, when the figure is drawn, on what it
cannot read.  A name of a system is therefore always plain text, the name of a coordinate is mathematical text of a form
that is known to be readable, and only the label of an axis, which a user writes for figures, may contain formulas.
"""

from __future__ import annotations

import re
import unicodedata

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
    r"""Any text as it is, for Matplotlib: no dollar sign begins a formula, no character breaks a line or a file.

    Args:
        text: What is drawn, a name or a formula.
        most: Characters after which it is cut.
    """
    shown = "".join(_drawable(character) for character in str(text)[: most + 1])
    shown = shown if len(shown) <= most else f"{shown[: most - 2]} …"
    return shown.replace("$", r"\$")


def symbol(name: str, letters: dict[str, str] | None = None) -> str:
    r"""A name as mathematical text without its dollar signs: alpha1 is \alpha_{1}, any other one is upright.

    A letter and a name behind an underscore are a letter with a subscript: p_theta2 is p_{\theta_{2}}.
    The modes of truncated fluids are real and imaginary parts: ws1m2 is \mathrm{Im}\,w_{1,{-}2}.

    Args:
        name: An identifier, such as that of a coordinate; anything else is written letter by letter, too.
        letters: Further letters and how they are written.
    """
    if mode := _MODE.fullmatch(name):
        indices = ",".join(k.replace("m", "{-}") for k in mode.groups()[2:] if k)
        return rf"{vector_symbol(name)}_{{{indices}}}"
    known = _LETTERS if letters is None else _LETTERS | letters
    found = _NAME.fullmatch(name)
    if len(name) > LONGEST:
        return upright(name)
    if found is None:
        parts = _WITH_SUBSCRIPT.fullmatch(name)
        if parts is None or (len(parts[1]) > 1 and parts[1] not in known):
            return upright(name)
        return f"{symbol(parts[1], letters)}_{{{symbol(parts[2], letters)}}}"
    stem, digits = found.groups()
    letter = known.get(stem, stem if len(stem) == 1 else rf"\mathrm{{{stem}}}")
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
