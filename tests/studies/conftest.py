"""The verdicts on all claims without a run, computed once: they take many seconds."""

import pytest

from liepoisson.studies.twisted_top.claims import ClaimResult, Context, bifurcations, evaluate_claims


@pytest.fixture(scope="session")
def exact_results(shared_by_workers) -> tuple[ClaimResult, ...]:
    # One of the two arithmetics: the other one takes seven times as long, and tests/proofs checks both.  Closing flows
    # take most of the time of all claims: test_lagrange_monodromy.py and the slow test of the study follow them.
    def compute():
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(bifurcations, "_by_flows", lambda top: (0.0, True))
            return tuple(evaluate_claims(Context(arithmetics=("intervals",))))

    return shared_by_workers("exact_results", compute)
