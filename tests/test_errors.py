"""Hints of messages: the nearest known name, and where a name would have been right."""

import pytest

import liepoisson as lp
from liepoisson.errors import did_you_mean


def test_the_nearest_name_is_asked_for_whatever_the_case_of_its_letters():
    assert did_you_mean("kovalevskaia", ["lagrange", "kovalevskaya"]) == "Did you mean kovalevskaya? "
    assert did_you_mean("Splitting", ["taylor", "splitting"]) == "Did you mean splitting? "
    assert did_you_mean("xyz", ["lagrange"]) == ""
    assert did_you_mean(3, ["lagrange"]) == ""


TWO_FIELDS = lp.so(3) @ lp.semidirect(2)
TOP = lp.Top.kovalevskaya()


@pytest.mark.parametrize(
    ("module", "name", "message"),
    [
        (lp.catalog, "sytem", "did you mean system"),
        (lp.catalog, "henon_heiles_kdv", r'write liepoisson\.catalog\.system\("henon-heiles-kdv"\)'),
        (lp.plot, "spectrun", "did you mean spectrum"),
        (lp, "toda", r"it is liepoisson\.catalog\.toda"),
        (lp, "tode", r"did you mean liepoisson\.catalog\.toda"),
        (lp.chaos, "time_scale", r"it is liepoisson\.orbits\.time_scale"),
        (lp.chaos, "integrate", r"it is liepoisson\.integrate"),
        (TOP, "casimirs", r"write system\.bracket\.casimirs\(\) or system\.functions\.casimirs$"),
        (TOP, "energy", r"write system\.functions\.energy$"),
        (TOP, "hamiltonean", r"Did you mean hamiltonian\?$"),
    ],
)
def test_a_name_in_another_chapter_is_found(module, name, message):
    with pytest.raises(AttributeError, match=message):
        getattr(module, name)
    assert not hasattr(module, "__no_such_name__")


def test_a_typing_error_in_a_formula_has_a_short_traceback():
    with pytest.raises(lp.errors.ExpressionError) as caught:
        lp.System(TWO_FIELDS, "dot(l, l")
    assert len(caught.traceback) <= 2  # this line, and the one that explains wrong calls
    assert caught.value.__cause__ is None
