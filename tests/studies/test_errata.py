"""The list of misprints and errors: made from the verdicts of the run."""

from dataclasses import replace

import pytest

from liepoisson.studies.twisted_top.claims import CLAIMS, Claim, ClaimResult, Context, Verdict
from liepoisson.studies.twisted_top.claims.errata import (
    KINDS,
    count_verdicts,
    decisive_steps,
    errata,
    errata_lines,
    mistakes,
)
from liepoisson.studies.twisted_top.claims.steps import Step


def result(verdict, *steps, name="some-claim", root=""):
    def check(context):
        return Verdict(verdict, "exact", steps)

    claim = Claim(name, "Section 1", "The moon is green.", check, follows_from=root)
    return ClaimResult(claim, Verdict(verdict, "exact", steps, "" if verdict == "holds" else "It is grey."))


STEP = Step("identity", "a = b", succeeded=True)


@pytest.mark.thorough
def test_the_paper_has_these_errata(exact_results):
    """Those with verdicts of these kinds; `test_claims.py` says which ones they are."""
    found = errata(list(exact_results))
    assert {(e["id"], e["verdict"]) for e in found} == {
        (r.claim.id, r.verdict.verdict) for r in exact_results if r.verdict.verdict in KINDS
    }
    assert len(found) > 25
    for entry in found:
        assert entry["statement"]
        assert entry["correct_statement"]
        assert entry["shown_by"]["summary"]
        assert entry["shown_by"]["decisive"]
        assert all(step["succeeded"] for step in entry["shown_by"]["decisive"])


def test_the_list_follows_the_verdicts_and_not_the_claims():
    claim = next(c for c in CLAIMS if c.id == "leibniz-jacobi")
    verdict = claim.check(Context())
    assert errata([ClaimResult(claim, verdict)]) == []
    changed = replace(verdict, verdict="wrong", correct_statement="Not so.")
    assert [entry["id"] for entry in errata([ClaimResult(claim, changed)])] == ["leibniz-jacobi"]


def test_the_gravest_come_first():
    order = ["holds with a condition", "misprint", "wrong", "incomplete"]
    found = errata([result(verdict, STEP) for verdict in order])
    assert [entry["verdict"] for entry in found] == ["wrong", "misprint", "incomplete", "holds with a condition"]


def test_a_mistake_that_several_claims_share_is_one():
    results = [
        result("wrong", STEP, name="again", root="first"),
        result("misprint", STEP, name="other"),
        result("wrong", STEP, name="first"),
    ]
    found = errata(results)
    assert [(entry["id"], entry["follows_from"]) for entry in found] == [
        ("first", ""),
        ("again", "first"),
        ("other", ""),
    ]
    assert [(e["id"], [o["id"] for o in same]) for e, same in mistakes(found)] == [("first", ["again"]), ("other", [])]
    claims = [{"id": r.claim.id, "verdict": r.verdict.verdict} for r in results]
    assert count_verdicts(claims, found) == {"misprint": 1, "wrong": 1}
    assert "      same: again" in errata_lines(found)


def test_decisive_steps_are_the_marked_ones_else_the_most_telling():
    marked = replace(STEP, decisive=True)
    example = Step("counterexample", "c", succeeded=True)
    failed = Step("rank", "d", succeeded=False, decisive=True)
    assert decisive_steps((STEP, example, marked, failed)) == (marked,)
    assert decisive_steps((STEP, example)) == (example,)
    assert decisive_steps((STEP, Step("note", "n"))) == (STEP,)
