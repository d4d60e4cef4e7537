"""What the verdicts of a run come to: the table of claims, errata, the first page of the report, the open questions.

Nothing here is known beforehand: each line of the first page and each answer belongs to claims and to the verdict that
it puts into words, and is used only if these claims got that verdict in this run.  What no line speaks for is listed by
its statement and its verdict, so that nothing is left out.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from liepoisson.studies.twisted_top import PAPER, TEXTS
from liepoisson.studies.twisted_top.claims import ClaimResult
from liepoisson.studies.twisted_top.claims.evidence import Ruling, Step, StepKind, summary_of

Entry: TypeAlias = Mapping[str, Any]
"""A claim or an erratum as plain data."""

SCHEMA_VERSION = 3
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
_MISTAKES = ("wrong", "misprint", "underspecified")
_ORDER = (*_MISTAKES, "incomplete", "holds with a condition")

STATUS_CLASSES = {"proved": "good", "computed": "partly", "measured": "partly", "not settled": "open"}
"""How an answer is known, and its colour: proved in exact arithmetic or with rigorous enclosures; computed in floating
point from what is proved; measured on orbits; or none of these."""


def claims_to_json(results: Iterable[ClaimResult], produced_by: Entry) -> dict[str, Any]:
    """The table of claims as plain data, schema version 3: `schema_version`, `paper`, `errata` and `claims`.

    Each of the claims has

    - `id`, `place`, `words`, `statement`, `follows_from`: as in `Claim`; ids are stable between versions;
    - `verdict`, `method`, `correct_statement`, `data`: as in `Verdict`;
    - `proof`: what the proof consists of, for example "1 counter-example, 3 identities";
    - `steps`: a list of objects, the fields of `Step`; `certificate`: the same as text, indented what was computed;
    - `produced_by`: `check`, the function that computed the verdict, and what the caller passes: package, version, run.

    Version 2 had neither `words` nor `follows_from` nor the verdict "underspecified".
    """
    results = list(results)
    claims = [
        {
            **{name: getattr(claim, name) for name in ("id", "place", "words", "statement", "follows_from")},
            "verdict": verdict.verdict,
            "method": verdict.method,
            "proof": summary_of(verdict.steps),
            "steps": [step.to_json() for step in verdict.steps],
            "certificate": verdict.certificate,
            "correct_statement": verdict.correct_statement,
            "data": verdict.data,
            "produced_by": {"check": _name_of(claim.checked_by), **produced_by},
        }
        for claim, verdict in ((result.claim, result.verdict) for result in results)
    ]
    return {"schema_version": SCHEMA_VERSION, "paper": PAPER, "errata": errata(results), "claims": claims}


def _name_of(check: Callable[..., Any]) -> str:
    return f"{check.__module__}.{check.__name__}"


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
        entries += [_erratum(result, ""), *(_erratum(other, result.claim.id) for other in same)]
    return entries


def _erratum(result: ClaimResult, follows_from: str) -> dict[str, Any]:
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


def decisive_steps(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """The steps on which the verdict turns: those marked so, else the most telling ones."""
    checked = tuple(step for step in steps if step.kind != "note" and step.succeeded is not False)
    marked = tuple(step for step in checked if step.decisive)
    return marked or tuple(step for step in checked if step.kind in _TELLING) or checked


def mistakes(entries: Iterable[Entry]) -> list[tuple[Entry, list[Entry]]]:
    """The entries of `errata` by mistake: each that stands for itself, with those that follow from it."""
    entries = list(entries)
    return [
        (entry, [other for other in entries if other["follows_from"] == entry["id"]])
        for entry in entries
        if not entry["follows_from"]
    ]


def count_verdicts(claims: Iterable[Entry], entries: Iterable[Entry]) -> dict[str, int]:
    """How many claims have which verdict; those that repeat a mistake are left out, so that it is counted once."""
    repeated = {entry["id"] for entry in entries if entry["follows_from"]}
    return dict(Counter(str(claim["verdict"]) for claim in claims if claim["id"] not in repeated))


def errata_lines(entries: Iterable[Entry]) -> list[str]:
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
                    text, 100, initial_indent=indent, subsequent_indent=" " * len(indent), break_on_hyphens=False
                )
    return lines


class Line(NamedTuple):
    """A line of the first page."""

    text: str  # the sentence, with the mathematics in plain Unicode
    claims: tuple[str, ...]  # ids of the claims that it speaks for


def front_page(claims: Iterable[Entry], errata: Iterable[Entry]) -> dict[str, list[Line]]:
    """What the first page says beside the numbers: lines whose claims got the verdict that they put into words.

    `confirmed` is what holds as the paper says it; `not_confirmed` are mistakes, misprints and what is underspecified,
    each once; `refined` are claims that hold under a condition, or of which more is proved, with a short name each;
    `open` are those that are not settled, or whose numbers are not there; `questions` is what is asked of the authors.
    """
    claims = list(claims)
    verdicts = {str(claim["id"]): str(claim["verdict"]) for claim in claims}
    lines = (Line(line["text"], tuple(line["claims"])) for line in TEXTS["confirmed"])
    confirmed = [line for line in lines if all(verdicts[name] == "holds" for name in line.claims)]
    named = {name for line in confirmed for name in line.claims}
    confirmed += _stated(claim for claim in claims if claim["verdict"] == "holds" and claim["id"] not in named)
    # The mistake that most claims share comes first among those of its kind.
    own = sorted(mistakes(errata), key=lambda pair: (_ORDER.index(pair[0]["verdict"]), -len(pair[1])))
    repeats = {str(entry["id"]): same for entry, same in own}
    return {
        "confirmed": confirmed,
        "not_confirmed": [_line(*pair, "not_confirmed") for pair in own if pair[0]["verdict"] in _MISTAKES],
        "refined": [_line(*pair, "refined") for pair in own if pair[0]["verdict"] not in _MISTAKES],
        "open": _stated(claim for claim in claims if claim["verdict"] in ("not settled", "not run")),
        "questions": [
            Line(_with(asked["text"], repeats.get(asked["claim"], []), "question"), (asked["claim"],))
            for asked in TEXTS["questions"]
            if verdicts[asked["claim"]] == asked["verdict"]
        ],
    }


def _stated(claims: Iterable[Entry]) -> list[Line]:
    """A line for each claim: its statement."""
    return [Line(claim["statement"], (claim["id"],)) for claim in claims]


def _line(entry: Entry, same: Sequence[Entry], table: str) -> Line:
    """A mistake in the words of a table, or by its statement and its verdict."""
    known = {(line["claim"], line["verdict"]): line["text"] for line in TEXTS[table]}
    fallback = f"{entry['statement'].rstrip('.')}: {entry['verdict']}."
    text = known.get((entry["id"], entry["verdict"]), fallback)
    return Line(_with(text, same, "line"), (entry["id"], *(other["id"] for other in same)))


def _with(text: str, same: Iterable[Entry], where: str) -> str:
    """A text with what is added by the claims that repeat a mistake."""
    added = {repeated["claim"]: repeated[where] for repeated in TEXTS["repeated"]}
    return " ".join([text, *(added[other["id"]] for other in same if other["id"] in added)])


def open_questions(claims: Iterable[Entry]) -> list[dict[str, Any]]:
    """The questions of the paper, each with the answers that this run bears out; without any, it is not settled.

    A question has `text`, `place`, `words` (of the paper) and `answers`; an answer has `status` (a key of
    `STATUS_CLASSES`), `text`, with numbers from the data of this run, and the `claim` whose check shows it, with the
    `verdict` that it must have.
    """
    found = {str(claim["id"]): claim for claim in claims}
    none = {"status": "not settled", "text": "Nothing that was computed for this page decides it.", "claim": ""}

    def borne_out(answers: Iterable[Entry]) -> list[dict[str, Any]]:
        known = [(a, found[a["claim"]]) for a in answers if a["claim"] in found]
        return [
            {**a, "text": a["text"].format_map(claim["data"])} for a, claim in known if claim["verdict"] == a["verdict"]
        ]

    return [{**question, "answers": borne_out(question["answers"]) or [none]} for question in TEXTS["open_questions"]]
