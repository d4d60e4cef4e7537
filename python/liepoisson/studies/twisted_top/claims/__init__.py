"""The claims of the paper, each with a computed verdict.

J.-L. Thiffeault and P. J. Morrison, "The twisted top", Physics Letters A 283 (2001) 335, arXiv:nlin/0101042.
What the paper says is in `paper.toml`; the modules here have a check for each claim.  `evaluate_claims` checks all of
them anew: exact ones by SymPy on the bracket of the context (identities with symbolic parameters, exact
counterexamples, ranks at rational points), numerical ones by the measurements of the study.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from liepoisson.studies.twisted_top import TEXTS
from liepoisson.studies.twisted_top.claims import (
    bifurcations,
    canonical,
    charged,
    discussion,
    homoclinic,
    leaves,
    nonintegrable,
    numerics,
    twisted,
)
from liepoisson.studies.twisted_top.claims.evidence import (
    CHECKS,
    Check,
    Context,
    Evidence,
    Ruling,
    Verdict,
    twisted_bracket,
)

__all__ = [
    "CLAIMS",
    "Claim",
    "ClaimResult",
    "Context",
    "Verdict",
    "evaluate_claims",
    "twisted_bracket",
]

MODULES = (bifurcations, canonical, charged, discussion, homoclinic, leaves, nonintegrable, numerics, twisted)
"""Where the checks are."""


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and how it is checked."""

    id: str  # stable name, in lower case with hyphens
    place: str  # where the paper says it: section, and equation where there is one
    statement: str  # what it says, in the notation of the study; what it only implies begins with "Implied: "
    words: str = ""  # the words of the paper; empty where the claim is an equation
    follows_from: str = ""  # the claim whose mistake this one repeats or is deduced from; empty if it stands for itself
    verdict: Ruling = "holds"  # what follows if all steps of its check are borne out; measurements decide by themselves
    correct: str = ""  # what is true instead, or the condition

    @property
    def checked_by(self) -> Check:
        """The function that computes the verdict."""
        return CHECKS[self.id]

    def check(self, context: Context) -> Verdict:
        """The verdict, computed anew."""
        evidence = Evidence(self.verdict, self.correct)
        return self.checked_by(evidence, context) or evidence.conclude()


@dataclass(frozen=True)
class ClaimResult:
    """A claim with its verdict."""

    claim: Claim
    verdict: Verdict


CLAIMS: tuple[Claim, ...] = tuple(Claim(**texts) for texts in TEXTS["claims"])
"""All claims, in the order of the paper."""


def evaluate_claims(context: Context | None = None, claims: Iterable[Claim] = CLAIMS) -> list[ClaimResult]:
    """Check these claims, in their order."""
    return [ClaimResult(claim, claim.check(context or Context())) for claim in claims]
