"""The section on open questions says what the claims of this run bear out, and nothing else."""

import pytest

from liepoisson.studies.twisted_top.claims import CLAIMS
from liepoisson.studies.twisted_top.open_questions import QUESTIONS, open_questions

BY_ID = {claim.id: claim for claim in CLAIMS}


def table(**changed):
    verdicts = {a.claim: a.verdict for question in QUESTIONS for a in question.answers}
    return [{"id": name, "verdict": verdict} for name, verdict in (verdicts | changed).items()]


def test_an_answer_is_given_only_with_its_verdict():
    assert open_questions(table()) == list(QUESTIONS)
    changed = open_questions(table(**{"deformation-breaks-integrability": "wrong"}))
    assert [len(q.answers) for q in changed] == [
        len(QUESTIONS[0].answers) - 1,
        *(len(q.answers) for q in QUESTIONS[1:]),
    ]
    assert "Liouville" not in changed[0].answers[0].text


def test_a_question_without_answers_is_not_settled():
    for question in open_questions([]):
        (answer,) = question.answers
        assert (answer.status, answer.claim) == ("not settled", "")


@pytest.mark.thorough
def test_verdicts_of_this_package_bear_all_answers_out(exact_results):
    verdicts = [{"id": r.claim.id, "verdict": r.verdict.verdict} for r in exact_results]
    assert open_questions(verdicts) == list(QUESTIONS)
