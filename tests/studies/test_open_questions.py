"""The section on open questions says what the claims of this run bear out, and nothing else."""

import pytest

from liepoisson.studies.twisted_top import TEXTS
from liepoisson.studies.twisted_top.claims import CLAIMS
from liepoisson.studies.twisted_top.findings import open_questions

QUESTIONS = TEXTS["open_questions"]
BY_ID = {claim.id: claim for claim in CLAIMS}


class Shown(dict):
    """The data of a claim, in which every number is its name."""

    def __missing__(self, name):
        return f"<{name}>"


def table(**changed):
    verdicts = {a["claim"]: a["verdict"] for question in QUESTIONS for a in question["answers"]}
    return [{"id": name, "verdict": verdict, "data": Shown()} for name, verdict in (verdicts | changed).items()]


def with_numbers(data):
    """The questions, with the numbers of each claim in the answers."""
    return [
        {**q, "answers": [{**a, "text": a["text"].format_map(data[a["claim"]])} for a in q["answers"]]}
        for q in QUESTIONS
    ]


def test_an_answer_is_given_only_with_its_verdict():
    wanted = with_numbers({claim.id: Shown() for claim in CLAIMS})
    assert open_questions(table()) == wanted
    assert "(<twist>)" in str(wanted)
    changed = open_questions(table(**{"deformation-breaks-integrability": "wrong"}))
    assert [len(q["answers"]) for q in changed] == [
        len(QUESTIONS[0]["answers"]) - 1,
        *(len(q["answers"]) for q in QUESTIONS[1:]),
    ]
    assert "Liouville" not in changed[0]["answers"][0]["text"]


def test_a_question_without_answers_is_not_settled():
    for question in open_questions([]):
        (answer,) = question["answers"]
        assert (answer["status"], answer["claim"]) == ("not settled", "")


@pytest.mark.thorough
def test_verdicts_of_this_package_bear_all_answers_out(exact_results):
    found = [{"id": r.claim.id, "verdict": r.verdict.verdict, "data": r.verdict.data} for r in exact_results]
    answers = open_questions(found)
    assert answers == with_numbers({r.claim.id: r.verdict.data for r in exact_results})
    assert "{" not in "".join(answer["text"] for question in answers for answer in question["answers"])
