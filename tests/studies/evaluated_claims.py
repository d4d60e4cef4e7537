"""The verdicts on all claims without a run, once for the tests of a process: they take many seconds."""

from functools import cache

from liepoisson.studies.twisted_top.claims import ClaimResult, evaluate_claims


@cache
def exact_results() -> tuple[ClaimResult, ...]:
    return tuple(evaluate_claims())
