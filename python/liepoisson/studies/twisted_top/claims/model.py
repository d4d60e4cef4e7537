"""Claims, verdicts and what they are judged by: the types of the table of claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebras import so
from liepoisson.studies.twisted_top.claims.steps import Step, certificate

if TYPE_CHECKING:
    from liepoisson.formula.parameters import Parameter
    from liepoisson.structure.bracket import Bracket

Ruling: TypeAlias = Literal[
    "holds", "holds with a condition", "incomplete", "misprint", "wrong", "underspecified", "not settled", "not run"
]
Method: TypeAlias = Literal["exact", "enclosed", "numerical"]


@dataclass(frozen=True)
class Verdict:
    """What a check found.

    Attributes:
        verdict: Whether the claim holds; "incomplete" when it is right as far as it goes and more is proved here;
            "underspecified" when the paper only implies it, or leaves open what decides it; "not run" when the
            measurements that it needs are absent.
        method: "exact" for identities and counterexamples in exact arithmetic, "enclosed" for strict inequalities
            between rigorous enclosures, "numerical" for measured numbers.
        steps: The computation, step by step.
        correct_statement: What is true instead, or the condition; empty when the claim holds as it stands.
        data: Numbers and expressions (as text) behind the verdict, ready for JSON.
    """

    verdict: Ruling
    method: Method
    steps: tuple[Step, ...]
    correct_statement: str = ""
    data: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def certificate(self) -> str:
        """The computation as text, one step per line, each marked ✓ or ✗, with what was computed below."""
        return certificate(self.steps)


def extended_rotations(extension: Extension) -> Bracket:
    """The bracket of so(3) extended by a commutative algebra."""
    return so(3) @ extension


def twisted_bracket(epsilon: Parameter) -> Bracket:
    """The paper's bracket: so(3) with the Leibniz extension of order three, semidirect when epsilon = 0."""
    return so(3) @ leibniz(3, epsilon)


@dataclass(frozen=True)
class Context:
    """What the checks work with.

    Attributes:
        bracket: Makes the paper's bracket of three fields for a given epsilon.  A test can inject a wrong one.
        extended: Makes the bracket of so(3) with any extension, for claims about other extensions.
        measurements: Results of the numerical study as `liepoisson.studies.twisted_top.measurements` writes them, or
            None; which keys the claims use is said in `liepoisson.studies.twisted_top.claims`.
        arithmetics: Those that check the certificate of chaos.
    """

    bracket: Callable[[Parameter], Bracket] = twisted_bracket
    extended: Callable[[Extension], Bracket] = extended_rotations
    measurements: Mapping[str, Any] | None = None
    arithmetics: tuple[str, ...] = ("intervals", "balls")


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and how it is checked.

    Attributes:
        id: Stable name, in lower case with hyphens.
        place: Where the paper says it: section, and equation where there is one.
        statement: What it says, in the notation of the study; what it only implies begins with "Implied: ".
        check: Computes the verdict anew each time.
        words: The words of the paper; empty where the claim is an equation.
        follows_from: The claim whose mistake this one repeats or is deduced from; empty if it stands for itself.
    """

    id: str
    place: str
    statement: str
    check: Callable[[Context], Verdict]
    words: str = ""
    follows_from: str = ""


@dataclass(frozen=True)
class ClaimResult:
    """A claim with its verdict."""

    claim: Claim
    verdict: Verdict
