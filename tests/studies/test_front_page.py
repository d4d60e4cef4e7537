"""The first page of the report: every claim is there once, in the words of its verdict."""

from collections import Counter

import pytest

from liepoisson.studies.twisted_top.claims import CLAIMS
from liepoisson.studies.twisted_top.claims.errata import KINDS
from liepoisson.studies.twisted_top.front_page import _CONFIRMED, _NOT_CONFIRMED, _REFINED, front_page
from liepoisson.studies.twisted_top.report import spans

NUMBERS = {claim.id: number for number, claim in enumerate(CLAIMS, 1)}
AS_PRINTED = "The exponent of the ordinary top as printed stays positive."
EXPECTED = dict((*_NOT_CONFIRMED, *_REFINED))
EXPECTED |= {name: "holds" for line in _CONFIRMED for name in line.claims}


def table(**changed):
    """The claims with the verdicts that the lines are written for (what follows from a mistake gets its verdict)."""
    verdicts = {c.id: EXPECTED.get(c.id) or EXPECTED.get(c.follows_from) or "not settled" for c in CLAIMS}
    verdicts |= {name.replace("_", "-"): verdict for name, verdict in changed.items()}
    claims = [{"id": c.id, "statement": c.statement, "verdict": verdicts[c.id]} for c in CLAIMS]
    listed = {c["id"] for c in claims if c["verdict"] in KINDS}
    roots = {c.id: c.follows_from for c in CLAIMS}
    errata = [{**c, "follows_from": roots[c["id"]] if roots[c["id"]] in listed else ""} for c in claims]
    return front_page(claims, [entry for entry in errata if entry["id"] in listed])


def lines(page):
    return (*page.confirmed, *page.not_confirmed, *page.refined, *page.open)


@pytest.mark.parametrize("changed", [{}, {"leibniz_jacobi": "wrong"}, {"kovalevskaya_inertia": "holds"}])
def test_every_claim_is_on_the_first_page_once(changed):
    counts = Counter(name for line in lines(table(**changed)) for name in line.claims)
    assert counts == Counter(claim.id for claim in CLAIMS)


def test_another_verdict_is_never_told_in_the_old_words():
    page = table(collinear_stays_collinear="holds", leibniz_jacobi="wrong")
    assert not any("collinear α and β do not stay collinear" in line.text for line in lines(page))
    assert not any("satisfy the Jacobi identity" in line.text for line in lines(page))
    assert any(line.text == "The Leibniz bracket is a Poisson bracket: wrong." for line in page.not_confirmed)
    assert not any("counter-example" in line.text for line in page.questions)


def test_runs_of_numbers_are_joined():
    numbers = dict(zip("abcdefg", (5, 9, 10, 11, 13, 14, 16), strict=True))
    assert spans("gfedcba", numbers) == [("a", "a"), ("b", "d"), ("e", "e"), ("f", "f"), ("g", "g")]
