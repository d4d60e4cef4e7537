"""The claims of the paper, each with a computed verdict.

J.-L. Thiffeault and P. J. Morrison, "The twisted top", Physics Letters A 283 (2001) 335, arXiv:nlin/0101042.
`evaluate_claims` checks all of them anew: exact ones by SymPy on the bracket of the context (identities with symbolic
parameters, exact counterexamples, ranks at rational points), numerical ones by the measurements of the study.

The numerical claims read these keys of `Context.measurements`, in the schema of
`liepoisson.studies.twisted_top.measurements` (an estimate has `value` and `standard_error`):

    runs.twisted-<ensemble>    fit.lambda, fit.c1, fit.c0, fit.window, windows[], n_averaged      (three ensembles)
    runs.ordinary-<ensemble>   log_fit.A, log_fit.B, log_fit.with_next_term.D, log_fit.window, n_averaged
    runs.ordinary-unit-vectors, runs.ordinary-as-printed-unit-vectors    mean_at.200, fit.lambda
    runs.twisted-halved-unit-vectors, runs.twisted-halved-cube           fit.lambda
    runs.twisted-unit-vectors  by_energy[]: low, high, mean, standard_error

Where one is missing the verdict is "not run".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from liepoisson.studies.twisted_top.claims import (
    canonical,
    chaos,
    charged,
    charts,
    discussion,
    inferences,
    leaves,
    nonintegrable,
    numerics,
    singularities,
    twisted,
    twisted_lagrange,
)
from liepoisson.studies.twisted_top.claims.model import Claim, ClaimResult, Context, Verdict, twisted_bracket
from liepoisson.studies.twisted_top.claims.record import SCHEMA_VERSION, claims_to_json

__all__ = [
    "CLAIMS",
    "SCHEMA_VERSION",
    "Claim",
    "ClaimResult",
    "Context",
    "Verdict",
    "claims_to_json",
    "evaluate_claims",
    "twisted_bracket",
]

CLAIMS: tuple[Claim, ...] = (
    *charged.CLAIMS,
    *twisted.CLAIMS,
    *twisted_lagrange.CLAIMS,
    *canonical.CLAIMS,
    *charts.CLAIMS,
    *leaves.CLAIMS,
    *discussion.CLAIMS,
    *chaos.CLAIMS,
    *nonintegrable.CLAIMS,
    *singularities.CLAIMS,
    *numerics.CLAIMS,
    *inferences.CLAIMS,
)
"""All claims, in the order of the paper."""


def evaluate_claims(
    context: Context | None = None,
    claims: Iterable[Claim] = CLAIMS,
    progress: Callable[[float], None] | None = None,
) -> list[ClaimResult]:
    """Check the claims of the paper.

    Args:
        context: Bracket and measurements; by default the paper's bracket and no measurements.
        claims: Which claims, by default all.
        progress: Called with the fraction done after each claim.

    Returns:
        One result per claim, in the same order.
    """
    context = context or Context()
    chosen = list(claims)
    results: list[ClaimResult] = []
    for claim in chosen:
        results.append(ClaimResult(claim, claim.check(context)))
        if progress is not None:
            progress(len(results) / len(chosen))
    return results
