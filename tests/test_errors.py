"""Hints of messages: the nearest known name, and where a name would have been right."""

import pytest

import liepoisson as lp
from liepoisson.errors import SystemFileError, UnknownNameError, did_you_mean


def test_the_nearest_name_is_asked_for_whatever_the_case_of_its_letters():
    assert did_you_mean("kovalevskaia", ["lagrange", "kovalevskaya"]) == "Did you mean kovalevskaya? "
    assert did_you_mean("Splitting", ["taylor", "splitting"]) == "Did you mean splitting? "
    assert did_you_mean("xyz", ["lagrange"]) == ""
    assert did_you_mean(3, ["lagrange"]) == ""


@pytest.mark.parametrize(
    ("call", "error", "hint"),
    [
        (lambda: lp.catalog.system("Kovalevskaia"), UnknownNameError, "Did you mean kovalevskaya"),
        (lambda: lp.sample_states(lp.Top.kovalevskaya(), 1, ensemble="cubes"), UnknownNameError, "Did you mean cube"),
        (lambda: lp.sweeps.Starts(ensemble="gausian"), UnknownNameError, "Did you mean gaussian"),
        (lambda: lp.read_system("gyrostat"), SystemFileError, r'lp\.catalog\.system\("gyrostat"\)'),
        (lambda: lp.read_system("gyrostat.toml"), SystemFileError, r"Check the path\.$"),
        (
            lambda: lp.System(lp.Bracket(lp.algebras.se(3), lp.extensions.trivial()), "lt4 + dot(l, l)"),
            lp.errors.ExpressionError,
            r"Did you mean lt3\? Known are l, pi; components lr1, lr2, lr3, lt1, lt2, lt3",
        ),
    ],
)
def test_a_mistyped_name_is_followed_by_the_right_one(call, error, hint):
    with pytest.raises(error, match=hint):
        call()
