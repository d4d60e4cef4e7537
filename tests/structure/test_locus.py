"""Sets of states given by their fields."""

import pytest

from liepoisson.structure.locus import Locus

PAIR = ("alpha", "beta")


@pytest.mark.parametrize(
    ("locus", "text"),
    [
        (Locus(), "everywhere"),
        (Locus(is_generic=True), "generic"),
        (Locus(zero=("beta",), is_generic=True), "beta = 0, generic"),
        (Locus(zero=("beta", "alpha"), nonzero=(("l",),)), "beta = 0, alpha = 0, l != 0"),
        (Locus(nonzero=(("alpha",), ("beta",))), "alpha != 0, beta != 0"),
        (Locus(nonzero=(PAIR,)), "(alpha, beta) != 0"),
        (Locus(parallel=(PAIR,), nonzero=(PAIR,)), "alpha x beta = 0, (alpha, beta) != 0"),
        (Locus(not_parallel=(PAIR,)), "alpha x beta != 0"),
    ],
)
def test_text(locus, text):
    assert str(locus) == text
    assert locus.is_everywhere is (text == "everywhere")
