"""Misprints and errors of the paper, as the verdicts of this run give them: nothing here is known beforehand."""

from __future__ import annotations

import textwrap
from collections import Counter
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
    "underspecified": "Implied, or left open by what is not stated",
}
# Steps that speak for themselves where none was marked as decisive.
_TELLING: tuple[StepKind, ...] = ("counterexample", "rank", "search")


def errata(results: Iterable[ClaimResult]) -> list[dict[str, Any]]:
    """The claims whose verdict differs from "holds", as plain data, the gravest and most often repeated first.

    Each has `id`, `place`, `words` (of the paper), `verdict`, `method`, `statement` (what the paper says),
    `correct_statement`, `follows_from` and `shown_by`: a `summary` of the proof and its `decisive` steps.
    `follows_from` is the id of the entry whose mistake this one repeats, and empty where there is none: one mistake is
    one entry without it, and the entries that follow from it come right after it.
    """
    found = [result for result in results if result.verdict.verdict in KINDS]
    order, ids = list(KINDS), {result.claim.id for result in found}
    own = [result for result in found if result.claim.follows_from not in ids]
    groups = [(result, [other for other in found if other.claim.follows_from == result.claim.id]) for result in own]
    entries: list[dict[str, Any]] = []
    for result, same in sorted(groups, key=lambda group: (order.index(group[0].verdict.verdict), -len(group[1]))):
        entries += [_entry(result, ""), *(_entry(other, result.claim.id) for other in same)]
    return entries


def mistakes(entries: Iterable[Mapping[str, Any]]) -> list[tuple[Mapping[str, Any], list[Mapping[str, Any]]]]:
    """The entries of `errata` by mistake: each that stands for itself, with those that follow from it."""
    entries = list(entries)
    return [
        (entry, [other for other in entries if other["follows_from"] == entry["id"]])
        for entry in entries
        if not entry["follows_from"]
    ]


def count_verdicts(claims: Iterable[Mapping[str, Any]], entries: Iterable[Mapping[str, Any]]) -> dict[str, int]:
    """How many claims have which verdict; those that repeat a mistake are left out, so that it is counted once."""
    repeated = {entry["id"] for entry in entries if entry["follows_from"]}
    return dict(Counter(str(claim["verdict"]) for claim in claims if claim["id"] not in repeated))


def errata_lines(entries: Iterable[Mapping[str, Any]], width: int = 100) -> list[str]:
    """The list as text: for each verdict its mistakes, what is printed, what is right, and where it occurs again."""
    entries = list(entries)
    lines = [TITLE] if entries else ["No misprints or errors were found."]
    for verdict, words in KINDS.items():
        chosen = [(entry, same) for entry, same in mistakes(entries) if entry["verdict"] == verdict]
        lines += [f"  {words}:"] if chosen else []
        for entry, same in chosen:
            lines.append(f"    {entry['id']}")
            also = ", ".join(other["id"] for other in same)
            for label, text in (("paper", entry["statement"]), ("right", entry["correct_statement"]), ("same", also)):
                indent = f"      {label}: "
                lines += textwrap.wrap(
                    text, width, initial_indent=indent, subsequent_indent=" " * len(indent), break_on_hyphens=False
                )
    return lines


def decisive_steps(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """The steps on which the verdict turns: those marked so, else the most telling ones."""
    checked = tuple(step for step in steps if step.kind != "note" and step.succeeded is not False)
    marked = tuple(step for step in checked if step.decisive)
    return marked or tuple(step for step in checked if step.kind in _TELLING) or checked


def _entry(result: ClaimResult, follows_from: str) -> dict[str, Any]:
    claim, verdict = result.claim, result.verdict
    return {
        "id": claim.id,
        "place": claim.place,
        "words": claim.words,
        "verdict": verdict.verdict,
        "method": verdict.method,
        "statement": claim.statement,
        "correct_statement": verdict.correct_statement,
        "follows_from": follows_from,
        "shown_by": {
            "summary": summary_of(verdict.steps),
            "decisive": [step.to_json() for step in decisive_steps(verdict.steps)],
        },
    }
