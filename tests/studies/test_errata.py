"""The list of misprints and errors: made from the verdicts of the run."""

from dataclasses import replace

import pytest

from liepoisson.studies.twisted_top.claims import CLAIMS, Claim, ClaimResult, Context, Verdict
from liepoisson.studies.twisted_top.claims.evidence import Step, certificate, summary_of
from liepoisson.studies.twisted_top.findings import (
    TITLE,
    count_verdicts,
    decisive_steps,
    errata,
    errata_lines,
    mistakes,
)

# What the study is known to find in exact arithmetic; each of these must come out of the computation.
EXPECTED = {
    "wrong": {
        "zero-field-equals-uncharged",
        "charged-lagrange-coplanar",
        "collinear-stays-collinear",
        "never-collinear",
        "always-invertible",
    },
    "underspecified": {"leaves-cotangent-so3"},
    "misprint": {"lagrange-centre-of-rotation", "kovalevskaya-inertia"},
    "incomplete": {
        "charged-integrable-cases",
        "twisted-lagrange-uncharged",
        "deformation-breaks-integrability",
        "rigorous-demonstration",
        "kovalevskaya-painleve",
        "section-surface",
    },
    "holds with a condition": {
        "charged-phase-space",
        "two-field-extensions",
        "epsilon-measures-deviation",
        "bounded-energy-surfaces",
        "v-perp-zero-iff-collinear",
        "angles-from-fields",
        "canonical-bracket",
        "twist-in-hamiltonian",
        "euler-singularity-inflated",
        "leaf-dimension",
        "kovalevskaya-integrable",
        "homoclinic-orbits",
        "chaos-from-bounded-motion",
    },
}


def result(verdict, *steps, name="some-claim", root=""):
    claim = Claim(name, "Section 1", "The moon is green.", follows_from=root)
    return ClaimResult(claim, Verdict(verdict, "exact", steps, "" if verdict == "holds" else "It is grey."))


STEP = Step("identity", "a = b", succeeded=True)


@pytest.mark.thorough
def test_the_paper_has_these_errata(exact_results):
    found = errata(list(exact_results))
    assert {kind: {e["id"] for e in found if e["verdict"] == kind} for kind in EXPECTED} == EXPECTED
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


def test_what_holds_or_is_open_is_not_listed():
    assert errata([result(verdict, STEP) for verdict in ("holds", "not settled", "not run")]) == []


def test_the_gravest_come_first():
    order = ["holds with a condition", "misprint", "wrong", "incomplete"]
    found = errata([result(verdict, STEP) for verdict in order])
    assert [entry["verdict"] for entry in found] == ["wrong", "misprint", "incomplete", "holds with a condition"]


def test_the_text_names_claim_statement_and_correction():
    assert errata_lines(errata([result("wrong", STEP, name="green-moon")])) == [
        TITLE,
        "  Wrong as stated:",
        "    green-moon",
        "      paper: The moon is green.",
        "      right: It is grey.",
    ]
    assert errata_lines([]) == ["No misprints or errors were found."]


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


def test_a_mistake_whose_first_claim_holds_stands_for_itself():
    results = [result("wrong", STEP, name="again", root="first"), result("holds", STEP, name="first")]
    assert [(entry["id"], entry["follows_from"]) for entry in errata(results)] == [("again", "")]


def test_decisive_steps_are_the_marked_ones_else_the_most_telling():
    marked = replace(STEP, decisive=True)
    example = Step("counterexample", "c", succeeded=True)
    failed = Step("rank", "d", succeeded=False, decisive=True)
    assert decisive_steps((STEP, example, marked, failed)) == (marked,)
    assert decisive_steps((STEP, example)) == (example,)
    assert decisive_steps((STEP, Step("note", "n"))) == (STEP,)


def test_a_step_prints_what_was_computed_below_the_fact():
    table = (("weight", "known"), ("4", "12"))
    step = Step("search", "none", succeeded=False, remark="computed 1", computed=("at x = 1",), table=table)
    assert certificate((step, STEP)).split("\n") == [
        "✗ none — computed 1",
        "    at x = 1",
        "    weight  known",
        "         4     12",
        "✓ a = b",
    ]


def test_a_proof_is_summed_up_by_its_kinds():
    steps = (STEP, STEP, Step("note", "n"), Step("counterexample", "c", succeeded=True))
    assert summary_of(steps) == "1 counter-example, 2 identities"
    assert summary_of(()) == ""
