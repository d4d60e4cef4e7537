"""Misprints and errors of the paper, as the verdicts of this run give them: nothing here is known beforehand."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from liepoisson.studies.twisted_top.claims.model import ClaimResult, Ruling
from liepoisson.studies.twisted_top.claims.steps import Step, StepKind, summary_of

TITLE = "Misprints and errors of the paper, found by computation"

# What stands in the list, the gravest first, and the words for it.
KINDS: dict[Ruling, str] = {
    "wrong": "Wrong as stated",
    "misprint": "Misprints and slips of wording",
    "incomplete": "Right, but less than what can be proved",
    "holds with a condition": "Right only under a condition that is not stated",
}
# Steps that speak for themselves where none was marked as decisive.
_TELLING: tuple[StepKind, ...] = ("counterexample", "rank", "search")


def errata(results: Iterable[ClaimResult]) -> list[dict[str, Any]]:
    """The claims whose verdict differs from "holds", as plain data, the gravest first.

    Each has `id`, `place`, `verdict`, `method`, `statement` (what the paper says), `correct_statement`, and
    `shown_by`: a `summary` of the proof and its `decisive` steps.
    """
    found = [result for result in results if result.verdict.verdict in KINDS]
    order = list(KINDS)
    return [_entry(result) for result in sorted(found, key=lambda r: order.index(r.verdict.verdict))]


def errata_lines(entries: Iterable[Mapping[str, Any]], width: int = 100) -> list[str]:
    """The list as text: for each verdict its entries, with what is printed and what is right."""
    entries = list(entries)
    lines = [TITLE] if entries else ["No misprints or errors were found."]
    for verdict, words in KINDS.items():
        chosen = [entry for entry in entries if entry["verdict"] == verdict]
        lines += [f"  {words}:"] if chosen else []
        for entry in chosen:
            lines.append(f"    {entry['id']}")
            for label, text in (("paper", entry["statement"]), ("right", entry["correct_statement"])):
                indent = f"      {label}: "
                lines += textwrap.wrap(text, width, initial_indent=indent, subsequent_indent=" " * len(indent))
    return lines


def decisive_steps(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """The steps on which the verdict turns: those marked so, else the most telling ones."""
    checked = tuple(step for step in steps if step.kind != "note" and step.succeeded is not False)
    marked = tuple(step for step in checked if step.decisive)
    return marked or tuple(step for step in checked if step.kind in _TELLING) or checked


def _entry(result: ClaimResult) -> dict[str, Any]:
    claim, verdict = result.claim, result.verdict
    return {
        "id": claim.id,
        "place": claim.place,
        "verdict": verdict.verdict,
        "method": verdict.method,
        "statement": claim.statement,
        "correct_statement": verdict.correct_statement,
        "shown_by": {
            "summary": summary_of(verdict.steps),
            "decisive": [step.to_json() for step in decisive_steps(verdict.steps)],
        },
    }
