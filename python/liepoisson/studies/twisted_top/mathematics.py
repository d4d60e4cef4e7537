"""Mathematics in running text: variables in italics, so that the a of "α × a" does not read as an article."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markupsafe import Markup

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
    """The text as HTML with its variables in italics."""
    from markupsafe import Markup, escape

    italic = _VARIABLE.sub(r"<i>\g<0></i>", str(escape(str(text))))
    return Markup(_INDEX.sub(lambda found: f"<sub>{found[1] or found[2]}</sub>", italic))
