"""The section "The open questions": what the paper leaves open, and what is known of it now.

Each answer belongs to a claim and to the verdict that it puts into words; it is used only if the claim got that verdict
in this run.  A question of which no answer is left is said to be not settled.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

Status: TypeAlias = Literal["proved", "computed", "measured", "not settled"]
"""Proved in exact arithmetic or with rigorous enclosures; computed in floating point from what is proved; measured on
orbits; or none of these."""

STATUS_CLASSES: dict[Status, str] = {
    "proved": "good",
    "computed": "partly",
    "measured": "partly",
    "not settled": "open",
}


@dataclass(frozen=True)
class Answer:
    """What is known of a question.

    Attributes:
        status: How it is known.
        text: The sentence, with the mathematics in plain Unicode.
        claim: The claim whose check shows it; what is not settled has none, or the one that says so.
        verdict: The verdict that the claim must have.
    """

    status: Status
    text: str
    claim: str
    verdict: str


@dataclass(frozen=True)
class Question:
    """A question that the paper leaves open.

    Attributes:
        text: The question.
        place: Where the paper leaves it open.
        words: The words of the paper.
        answers: What is known.
    """

    text: str
    place: str
    words: str
    answers: tuple[Answer, ...]


_NEARBY = ("nearby-integrable-case", "not settled")
_CHAOS = ("rigorous-demonstration", "incomplete")
_HOMOCLINIC = ("homoclinic-orbits", "holds with a condition")

QUESTIONS: tuple[Question, ...] = (
    Question(
        "Is there an integrable twisted top close to the Kovalevskaya values?",
        "Section 5, third paragraph",
        "The presence of chaos does not rule out the existence of an integrable case with parameters “close” to the "
        "Kovalevskaya values … We have not found such a case.",
        (
            Answer(
                "proved",
                "At the Kovalevskaya values with b = 0 the twisted top is not Liouville integrable with meromorphic "
                "integrals.",
                "deformation-breaks-integrability",
                "incomplete",
            ),
            Answer(
                "proved",
                "It has no polynomial integral of weight ≤ 12 (l 1, α 2, β 3) besides H and the Casimirs.",
                *_NEARBY,
            ),
            Answer(
                "proved",
                "For b = 0, any inertia and any a, a further integral of degree ≤ 2 exists for the spherical top, for "
                "symmetric tops with a on the axis and for a = 0, and in no other case.",
                *_NEARBY,
            ),
            Answer(
                "proved",
                "A twisted top all of whose solutions are single-valued functions of complex time is Lagrange’s, with "
                "b along a, or has a = 0 and (I, b) of Euler, Lagrange or Kovalevskaya, where the twist is inert.",
                "kovalevskaya-painleve",
                "incomplete",
            ),
            Answer(
                "proved",
                "Three neighbours are not Liouville integrable with meromorphic integrals: Kovalevskaya’s inertia with "
                "b = (0, 0, 1), the spherical top with b across a, and I = (2, 3, 4), a = (1, 0, 0), b = 0.",
                *_NEARBY,
            ),
            Answer(
                "not settled",
                "Integrals of degree ≥ 3 for other parameters, b ≠ 0, and integrals that are not polynomial, but for "
                "these cases.",
                *_NEARBY,
            ),
        ),
    ),
    Question(
        "Can it be demonstrated rigorously that the twisted Kovalevskaya top is chaotic?",
        "Section 5, fourth paragraph",
        "A rigorous demonstration that the twisted Kovalevskaya top is chaotic could in principle be achieved using a "
        "Melnikov analysis",
        (
            Answer(
                "proved",
                "On the level H = 1/2, C₁ = 1, C₂ = 1/2, C₃ = 1 the twisted Kovalevskaya top is chaotic: a transversal "
                "homoclinic orbit of a hyperbolic periodic orbit, a full shift on two symbols, positive topological "
                "entropy; by covering relations, without Melnikov’s method.",
                *_CHAOS,
            ),
            Answer("not settled", "The measure of the chaotic set, and chaos on every level.", *_CHAOS),
        ),
    ),
    Question(
        "Can chaos be shown by the method of Melnikov?",
        "Section 5, fourth paragraph",
        "The present case is less straightforward because of the complicated form of the homoclinic orbits.",
        (
            Answer(
                "proved",
                "For a = (a₁, 0, 0), b = (0, 0, b₃) and any inertia some homoclinic orbits are elementary.",
                *_HOMOCLINIC,
            ),
            Answer(
                "not settled", "The integral of Melnikov along them, and the other homoclinic orbits.", *_HOMOCLINIC
            ),
        ),
    ),
)


def open_questions(claims: Iterable[Mapping[str, Any]]) -> list[Question]:
    """The questions with the answers that this run bears out.

    Args:
        claims: The table of claims, in the schema of `claims`.
    """
    verdicts = {str(claim["id"]): str(claim["verdict"]) for claim in claims}
    found: list[Question] = []
    for question in QUESTIONS:
        answers = tuple(a for a in question.answers if verdicts.get(a.claim) == a.verdict)
        if not answers:
            answers = (Answer("not settled", "Nothing that was computed for this page decides it.", "", ""),)
        found.append(Question(question.text, question.place, question.words, answers))
    return found
