"""Every letter of a claim is explained: in the list of symbols, or where it stands."""

import re

import pytest

from liepoisson.studies.twisted_top import TEXTS
from liepoisson.studies.twisted_top.claims import CLAIMS
from liepoisson.studies.twisted_top.typography import mathematics

VARIABLE = re.compile(r"<i>(.*?)</i>([₀₁₂₃]*)")


def letters(text):
    """The variables of a text, without indices; those written together, as in "vw", one by one."""
    return {
        letter
        for name, _ in VARIABLE.findall(str(mathematics(text)))
        if name[0] != "d"
        for letter in name
        if letter != "π"
    }


LISTED = set().union(*(letters(symbol) for symbol in TEXTS["symbols"]))


def unexplained(text):
    """Letters that are neither listed nor introduced: by "x =", in a vector "= (x, y, 0)", or as "coordinates X, Y"."""
    introduced = r"{0}[₀₁₂₃]?²?(\(t\))? ?(=|the )|= \([^)]*{0}|coordinates [^.]{{0,30}}{0}"
    return {x for x in letters(text) - LISTED if not re.search(introduced.format(x), text)}


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.id)
def test_statements_use_symbols_that_are_listed(claim):
    assert letters(claim.statement) <= LISTED
    assert letters(claim.words) <= LISTED


@pytest.mark.thorough
def test_corrections_use_symbols_that_are_listed_or_explained(exact_results):
    for result in exact_results:
        text = result.verdict.correct_statement
        assert unexplained(text) == set(), f"{result.claim.id}: {text}"


def test_an_unexplained_letter_is_noticed():
    assert unexplained("z = z₀ + 2k²I₃²/(z₀ ± m cosh kt)") >= {"k", "m"}
    assert unexplained("z = 2k², where k² = 1") == set()
