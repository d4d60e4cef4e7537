"""Claims, verdicts and their record: the types of the table of claims, and its JSON schema."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from liepoisson.exact.extension import leibniz
from liepoisson.exact.lie_algebra import so

if TYPE_CHECKING:
    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.parameters import Parameter

Ruling: TypeAlias = Literal["holds", "holds with a condition", "misprint", "wrong", "not settled", "not run"]
Method: TypeAlias = Literal["exact", "numerical"]

SCHEMA_VERSION = 1
PAPER = "J.-L. Thiffeault and P. J. Morrison, The twisted top, Physics Letters A 283 (2001) 335, arXiv:nlin/0101042"


@dataclass(frozen=True)
class Verdict:
    """What a check found.

    Attributes:
        verdict: Whether the claim holds; "not run" when the measurements that it needs are absent.
        method: "exact" for identities and counterexamples in exact arithmetic, "numerical" for measured numbers.
        certificate: The computation as text, one step per line, each marked ✓ or ✗.
        correct_statement: What is true instead, or the condition; empty when the claim holds as it stands.
        data: Numbers and expressions (as text) behind the verdict, ready for JSON.
    """

    verdict: Ruling
    method: Method
    certificate: str
    correct_statement: str = ""
    data: dict[str, Any] = field(default_factory=dict[str, Any])


def twisted_bracket(epsilon: Parameter) -> Bracket:
    """The paper's bracket: so(3) with the Leibniz extension of order three, semidirect when epsilon = 0."""
    return so(3) @ leibniz(3, epsilon)


@dataclass(frozen=True)
class Context:
    """What the checks work with.

    Attributes:
        bracket: Makes the bracket for a given epsilon.  A test can inject a wrong one.
        measurements: Results of the numerical study as `liepoisson.studies.twisted_top.measurements` writes them, or
            None; which keys the claims use is said in `liepoisson.studies.twisted_top.claims`.
    """

    bracket: Callable[[Parameter], Bracket] = twisted_bracket
    measurements: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and how it is checked.

    Attributes:
        id: Stable name, in lower case with hyphens.
        place: Where the paper says it.
        statement: What it says, in other words.
        check: Computes the verdict anew each time.
    """

    id: str
    place: str
    statement: str
    check: Callable[[Context], Verdict]


@dataclass(frozen=True)
class ClaimResult:
    """A claim with its verdict."""

    claim: Claim
    verdict: Verdict


def claims_to_json(results: Iterable[ClaimResult], produced_by: Mapping[str, Any]) -> dict[str, Any]:
    """The table of claims as plain data, schema version 1.

    The document has `schema_version`, `paper` and `claims`, a list of objects with the keys

    - `id`, `place`, `statement`: as in `Claim`; ids are stable between versions;
    - `verdict`: "holds", "holds with a condition", "misprint", "wrong", "not settled" or "not run";
    - `method`: "exact" or "numerical";
    - `certificate`: text, one step per line;
    - `correct_statement`: text, empty when the claim holds as it stands;
    - `data`: an object;
    - `produced_by`: an object with `check` (the function that computed the verdict) and, beside it, what the caller
      passes.

    Args:
        results: Evaluated claims.
        produced_by: What made the results: package, version, and for numerical claims the run.
    """
    return {
        "schema_version": SCHEMA_VERSION,
        "paper": PAPER,
        "claims": [_entry(result, produced_by) for result in results],
    }


def _entry(result: ClaimResult, produced_by: Mapping[str, Any]) -> dict[str, Any]:
    claim, verdict = result.claim, result.verdict
    return {
        "id": claim.id,
        "place": claim.place,
        "statement": claim.statement,
        "verdict": verdict.verdict,
        "method": verdict.method,
        "certificate": verdict.certificate,
        "correct_statement": verdict.correct_statement,
        "data": verdict.data,
        "produced_by": {"check": f"{claim.check.__module__}.{claim.check.__name__}", **produced_by},
    }
