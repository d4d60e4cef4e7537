"""The table of claims as plain data, and its JSON schema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from liepoisson.studies.twisted_top.claims.errata import errata
from liepoisson.studies.twisted_top.claims.model import ClaimResult
from liepoisson.studies.twisted_top.claims.steps import summary_of

SCHEMA_VERSION = 3
PAPER = "J.-L. Thiffeault and P. J. Morrison, The twisted top, Physics Letters A 283 (2001) 335, arXiv:nlin/0101042"


def claims_to_json(results: Iterable[ClaimResult], produced_by: Mapping[str, Any]) -> dict[str, Any]:
    """The table of claims as plain data, schema version 3.

    The document has `schema_version`, `paper`, `errata` (see `errata`) and `claims`, a list of objects with the keys

    - `id`, `place`, `words`, `statement`, `follows_from`: as in `Claim`; ids are stable between versions;
    - `verdict`: "holds", "holds with a condition", "incomplete", "misprint", "wrong", "underspecified", "not settled"
      or "not run";
    - `method`: "exact", "enclosed" or "numerical";
    - `proof`: what the proof consists of, for example "1 counter-example, 3 identities";
    - `steps`: a list of objects, the fields of `Step`;
    - `certificate`: the steps as text, one fact per line, indented below it what was computed;
    - `correct_statement`: text, empty when the claim holds as it stands;
    - `data`: an object;
    - `produced_by`: an object with `check` (the function that computed the verdict) and, beside it, what the caller
      passes.

    Version 2 had neither `words` nor `follows_from` nor the verdict "underspecified".

    Args:
        results: Evaluated claims.
        produced_by: What made the results: package, version, and for numerical claims the run.
    """
    results = list(results)
    return {
        "schema_version": SCHEMA_VERSION,
        "paper": PAPER,
        "errata": errata(results),
        "claims": [_entry(result, produced_by) for result in results],
    }


def _entry(result: ClaimResult, produced_by: Mapping[str, Any]) -> dict[str, Any]:
    claim, verdict = result.claim, result.verdict
    return {
        "id": claim.id,
        "place": claim.place,
        "words": claim.words,
        "statement": claim.statement,
        "follows_from": claim.follows_from,
        "verdict": verdict.verdict,
        "method": verdict.method,
        "proof": summary_of(verdict.steps),
        "steps": [step.to_json() for step in verdict.steps],
        "certificate": verdict.certificate,
        "correct_statement": verdict.correct_statement,
        "data": verdict.data,
        "produced_by": {"check": f"{claim.check.__module__}.{claim.check.__name__}", **produced_by},
    }
