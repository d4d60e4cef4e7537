"""The verdicts on all claims without a run, once for the tests of a process: they take many seconds."""

from functools import cache

from liepoisson.studies.twisted_top.claims import ClaimResult, Context, evaluate_claims


@cache
def exact_results() -> tuple[ClaimResult, ...]:
    # One of the two arithmetics: the other one takes seven times as long, and tests/proofs checks both.
    return tuple(evaluate_claims(Context(arithmetics=("intervals",))))
