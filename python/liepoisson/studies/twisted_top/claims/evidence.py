"""Collecting the steps of an exact check, and printing expressions as plain text with Unicode mathematics."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from liepoisson.studies.twisted_top.claims.model import Ruling, Verdict

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_GREEK = {
    "alpha": "α",
    "beta": "β",
    "epsilon": "ε",
    "eta": "η",
    "theta": "θ",
    "phi": "φ",
    "psi": "ψ",
    "omega": "ω",
    "kappa": "κ",
    "gamma": "γ",
    "sqrt": "√",
}
_LONGEST = 160


def show(expression: object) -> str:
    """An expression in one line of Unicode text, for example "2ε·l₁·β₁ + α₁²", cut when it is very long."""
    text = str(expression)
    for name, letter in _GREEK.items():
        text = re.sub(rf"(?<![A-Za-z]){name}(?![a-z])", letter, text)
    text = re.sub(r"\*\*\(?(-?\d+)\)?(?!/)", lambda match: match[1].translate(_SUPERSCRIPTS), text)
    text = re.sub(r"(?<=[A-Za-zα-ω])(\d+)", lambda match: match[1].translate(_SUBSCRIPTS), text)
    text = text.replace("**", "^").replace("*", "·").replace("-", "−")
    return text if len(text) <= _LONGEST else text[: _LONGEST - 2] + " …"


class Evidence:
    """The steps of a check.  Each step states a fact and records whether the computation bears it out."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._failed: list[str] = []
        self.data: dict[str, Any] = {}

    def note(self, text: str) -> None:
        """A line of explanation, without a computation."""
        self._lines.append(f"  {text}")

    def zero(self, what: str, residual: Any) -> bool:
        """State that `what` (a text with its reason) holds because `residual` vanishes identically.

        Args:
            what: The fact.
            residual: An expression, a matrix or an iterable of expressions.
        """
        left = [value for value in _entries(residual) if not _vanishes(value)]
        return self._record(what, not left, f"residual {show(_readable(left[0]))}" if left else "")

    def nonzero(self, what: str, value: Any) -> bool:
        """State that `what` holds because `value` (or one entry of it) does not vanish identically."""
        return self._record(what, any(not _vanishes(entry) for entry in _entries(value)), "the value is 0")

    def equal(self, what: str, got: object, wanted: object) -> bool:
        """State that the computed `got` is `wanted`."""
        return self._record(f"{what}: {show(wanted)}", got == wanted, f"computed {show(got)}")

    def conclude(self, verdict: Ruling, correct_statement: str = "", otherwise: Ruling | None = None) -> Verdict:
        """The verdict if all steps are borne out, else `otherwise` with the failing steps as the reason.

        Args:
            verdict: What follows from the steps.
            correct_statement: What is true instead, or the condition.
            otherwise: Verdict when a step fails: by default "wrong" for a claim that should hold, and "not settled" for
                one whose refutation fails.
        """
        certificate = "\n".join(self._lines)
        if not self._failed:
            return Verdict(verdict, "exact", certificate, correct_statement, self.data)
        fallback: Ruling = "wrong" if verdict.startswith("holds") else "not settled"
        reason = "The computation does not bear it out: " + "; ".join(self._failed) + "."
        return Verdict(otherwise or fallback, "exact", certificate, reason, self.data)

    def _record(self, what: str, succeeded: bool, remark: str) -> bool:
        if succeeded:
            self._lines.append(f"✓ {what}")
        else:
            self._lines.append(f"✗ {what} — {remark}")
            self._failed.append(f"{what} ({remark})")
        return succeeded


def _entries(value: Any) -> Iterable[Any]:
    from sympy import sympify
    from sympy.matrices import MatrixBase

    if isinstance(value, MatrixBase):
        return list(value.flat())
    return (
        [sympify(v, strict=True) for v in value] if isinstance(value, (list, tuple)) else [sympify(value, strict=True)]
    )


def _readable(value: Any) -> Any:
    """Factored when that is quick; a large expression is cut by `show` anyway."""
    return value.factor() if value.count_ops() < 100 else value


def _vanishes(value: Any) -> bool:
    from sympy import cancel, together

    expanded = value.expand()
    return bool(expanded == 0 or cancel(together(expanded)) == 0)
