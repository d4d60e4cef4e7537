"""`liepoisson diagram` on leaves on which integrals are known."""

import pytest

import liepoisson as lp


def test_a_leaf_without_enough_integrals_is_refused(command):
    code, _, err = command("diagram", "goryachev-chaplygin", "--leaf", "C1=0.3,C2=1")
    assert code == 2
    assert "On some leaves: G where alpha1*l1 + alpha2*l2 + alpha3*l3 = 0" in err


@pytest.mark.thorough
def test_the_leaf_of_partial_integrals_is_taken_where_none_is_given(command, tmp_path):
    path = tmp_path / "diagram.nc"
    code, out, err = command("diagram", "goryachev-chaplygin", "--energy-max", "-0.8", "--out", path)
    assert (code, err) == (0, "")
    assert out.startswith("Diagram of (H, G) of 'goryachev-chaplygin'")
    found = lp.load(path)
    assert found.leaf.casimirs["C1"] == 0
    assert found.momentum.leaf.casimirs == found.leaf.casimirs
