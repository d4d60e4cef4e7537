"""The first page of the report: what was confirmed, what was not, what is asked of the authors.

Each line belongs to claims and to the verdict that it puts into words; it is used only if these claims got that verdict
in this run.  What no line speaks for is listed by its statement and its verdict, so that nothing is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from liepoisson.studies.twisted_top.claims.errata import mistakes


@dataclass(frozen=True)
class Line:
    """A line of the first page.

    Attributes:
        text: The sentence, with the mathematics in plain Unicode.
        claims: Ids of the claims that it speaks for.
    """

    text: str
    claims: tuple[str, ...]


@dataclass(frozen=True)
class FrontPage:
    """What the first page says beside the numbers.

    Attributes:
        confirmed: What holds as the paper says it.
        not_confirmed: Mistakes, misprints and what is underspecified, each once.
        refined: Claims that hold under a condition, or of which more is proved: a short name each.
        open: Claims that are not settled, or whose numbers are not there.
        questions: What is asked of the authors.
    """

    confirmed: tuple[Line, ...]
    not_confirmed: tuple[Line, ...]
    refined: tuple[Line, ...]
    open: tuple[Line, ...]
    questions: tuple[Line, ...]

    @property
    def refined_claims(self) -> tuple[str, ...]:
        """The claims of `refined`."""
        return tuple(line.claims[0] for line in self.refined)

    @property
    def open_claims(self) -> tuple[str, ...]:
        """The claims of `open`."""
        return tuple(line.claims[0] for line in self.open)


_CONFIRMED = (
    Line(
        "Both brackets, (2) and (3), satisfy the Jacobi identity; (3) is not semidirect; the Casimirs (7) are right, "
        "and there are no others.",
        (
            "charged-jacobi",
            "leibniz-jacobi",
            "leibniz-not-semidirect",
            "charged-casimirs",
            "leibniz-casimirs",
        ),
    ),
    Line(
        "The equations of motion (4) to (6); β turns rigidly, α does not.",
        ("leibniz-equations", "charged-rigid-fields", "alpha-not-rigid"),
    ),
    Line(
        "The twisted Lagrange top is integrable: P of (8) is constant and in involution with H and l₃.",
        ("charged-lagrange", "twisted-lagrange-p", "twisted-lagrange-involution"),
    ),
    Line(
        "The matrices and the potentials of the canonical description, (9) to (15), for both choices of axes.",
        (
            "rotation-matrix",
            "momentum-matrix",
            "leaf-coordinates",
            "l-dot-beta-rate",
            "canonical-potential",
            "l-dot-beta-momenta",
            "matrix-lta",
            "lagrange-cyclic-psi",
            "potential-e3-e1",
            "potential-e1-e3",
            "gauge-limits",
        ),
    ),
    Line(
        "The mean exponent of the twisted Kovalevskaya top is positive; that of the ordinary one goes to zero.",
        ("twisted-kovalevskaya-chaotic", "ordinary-exponent-vanishes"),
    ),
)

_NOT_CONFIRMED: dict[tuple[str, str], str] = {
    (
        "collinear-stays-collinear",
        "wrong",
    ): "After (14): collinear α and β do not stay collinear, and others become so. "
    "The map to Euler angles is not always invertible, and does not cover the leaves.",
    ("charged-lagrange-coplanar", "wrong"): "End of Section 2: the case with b on the axis is integrable without (α × "
    "β)·b = 0, which the flow does not keep.",
    (
        "zero-field-equals-uncharged",
        "wrong",
    ): "Introduction: no charge (b = 0) and no field (β = 0) are not equivalent; the second removes the twist.",
    (
        "kovalevskaya-inertia",
        "misprint",
    ): "Section 5: I₃ = 2I₁ is a misprint of I₁ = 2I₃.",
    (
        "lagrange-centre-of-rotation",
        "misprint",
    ): "Introduction: it is the centre of mass that lies on the symmetry axis.",
    ("lyapunov-exponent-value", "underspecified"): "λ ≃ 0.122 depends on the starts, on the window and on the scale of "
    "the inertia, which are not stated.",
}

# What a claim that repeats a mistake adds to its line, and to its question.  It is measured, so runs may be too short.
_REPEATED: dict[str, str] = {
    "dashed-curve-inertia": "The exponent of the ordinary top as printed stays positive.",
}
_ASKED_WITH: dict[str, str] = {"dashed-curve-inertia": "The dashed curve says so."}

_REFINED: dict[tuple[str, str], str] = {
    ("charged-phase-space", "holds with a condition"): "phase space of the charged top (α × β ≠ 0)",
    ("two-field-extensions", "holds with a condition"): "extensions by two fields",
    ("epsilon-measures-deviation", "holds with a condition"): "meaning of ε (only a scale)",
    ("bounded-energy-surfaces", "holds with a condition"): "boundedness (for fixed Casimirs)",
    ("v-perp-zero-iff-collinear", "holds with a condition"): "v⊥ (β ≠ 0)",
    ("leaf-dimension", "holds with a condition"): "dimension of the leaves",
    ("homoclinic-orbits", "holds with a condition"): "homoclinic orbits (some are elementary)",
    ("single-exponent", "holds with a condition"): "one exponent for many energies",
    ("chaos-from-bounded-motion", "holds with a condition"): "chaos from a positive exponent (for a set of starts)",
    ("charged-integrable-cases", "incomplete"): "integrable charged tops (two more families)",
    ("twisted-lagrange-uncharged", "incomplete"): "the charged twisted Lagrange top (integrable, too)",
    ("deformation-breaks-integrability", "incomplete"): "non-integrability of the twisted Kovalevskaya top (a theorem)",
    ("kovalevskaya-painleve", "incomplete"): "the Kovalevskaya–Painlevé analysis (made here: no other top)",
    ("rigorous-demonstration", "incomplete"): "chaos of the twisted Kovalevskaya top on one level (a theorem)",
    ("section-surface", "incomplete"): "a good surface of section, a·(α × β) = 0",
}

_QUESTIONS: dict[tuple[str, str], str] = {
    (
        "lyapunov-exponent-value",
        "underspecified",
    ): "Which starts, which inertia (not only its ratios) and which window gave "
    "0.122? Do the data of the figure still exist?",
    ("kovalevskaya-inertia", "misprint"): "Was the program run with I₁ = I₂ = 2I₃?",
    (
        "collinear-stays-collinear",
        "wrong",
    ): "Do you agree with the counter-example l = α = (0, 0, 0), β = (1, 0, 0), for ε = 1, a = (0, 0, 1), b = 0?",
    ("charged-lagrange-coplanar", "wrong"): "What was (α × β)·b = 0 meant for?",
}

_MISTAKES = ("wrong", "misprint", "underspecified")
_ORDER = (*_MISTAKES, "incomplete", "holds with a condition")


def front_page(claims: Iterable[Mapping[str, Any]], errata: Iterable[Mapping[str, Any]]) -> FrontPage:
    """The lines whose claims got the verdict that they put into words.

    Args:
        claims: The table of claims, in the schema of `claims`.
        errata: Its errata.
    """
    claims, errata = list(claims), list(errata)
    verdicts = {str(claim["id"]): str(claim["verdict"]) for claim in claims}
    confirmed = tuple(line for line in _CONFIRMED if all(verdicts[name] == "holds" for name in line.claims))
    named = {name for line in confirmed for name in line.claims}
    confirmed += tuple(
        Line(claim["statement"], (claim["id"],))
        for claim in claims
        if claim["verdict"] == "holds" and claim["id"] not in named
    )
    # The mistake that most claims share comes first among those of its kind.
    own = sorted(mistakes(errata), key=lambda pair: (_ORDER.index(pair[0]["verdict"]), -len(pair[1])))
    repeats = {str(entry["id"]): same for entry, same in own}
    return FrontPage(
        confirmed=confirmed,
        not_confirmed=tuple(_line(entry, same, _NOT_CONFIRMED) for entry, same in own if entry["verdict"] in _MISTAKES),
        refined=tuple(_line(entry, same, _REFINED) for entry, same in own if entry["verdict"] not in _MISTAKES),
        open=tuple(
            Line(claim["statement"], (claim["id"],))
            for claim in claims
            if claim["verdict"] in ("not settled", "not run")
        ),
        questions=tuple(
            Line(_with(text, repeats.get(name, []), _ASKED_WITH), (name,))
            for (name, verdict), text in _QUESTIONS.items()
            if verdicts[name] == verdict
        ),
    )


def _line(entry: Mapping[str, Any], same: Sequence[Mapping[str, Any]], words: Mapping[tuple[str, str], str]) -> Line:
    fallback = f"{entry['statement'].rstrip('.')}: {entry['verdict']}."
    text = words.get((entry["id"], entry["verdict"]), fallback)
    return Line(_with(text, same, _REPEATED), (entry["id"], *(other["id"] for other in same)))


def _with(text: str, same: Iterable[Mapping[str, Any]], added: Mapping[str, str]) -> str:
    """A text with what is added by the claims that repeat a mistake."""
    return " ".join([text, *(added[other["id"]] for other in same if other["id"] in added)])
