"""The verdicts on all claims without a run, computed once: they take many seconds."""

import pytest

from liepoisson.studies.twisted_top.claims import ClaimResult, Context, evaluate_claims


@pytest.fixture(scope="session")
def exact_results(shared_by_workers) -> tuple[ClaimResult, ...]:
    # One of the two arithmetics: the other one takes seven times as long, and tests/proofs checks both.
    return shared_by_workers("exact_results", lambda: tuple(evaluate_claims(Context(arithmetics=("intervals",)))))
