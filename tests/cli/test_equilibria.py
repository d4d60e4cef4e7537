"""`liepoisson equilibria`: the equilibria of a leaf, as a table and for programs."""

import json

import pytest

import liepoisson as lp


def test_equilibria_are_those_of_the_leaf(command):
    code, out, err = command("equilibria", "kovalevskaya", "--leaf", "l.alpha=1,C2=1")
    assert (code, err) == (0, "")
    system = lp.catalog.system("kovalevskaya")
    found = lp.equilibria(system, lp.Leaf(system, {"C1": 1, "C2": 1}))
    assert repr(found) in out
    assert "leaf     alpha != 0: C1 = 1, C2 = 1" in out
    assert "(proved by algebra)" in out
    assert "states (l1, l2, l3, alpha1, alpha2, alpha3)\n  0  1, 0, 0, 1, 0, 0" in out


def test_equilibria_for_programs_on_the_leaf_of_a_start(command):
    code, out, _ = command("equilibria", "kovalevskaya", "--start", "1,0,0,1,0,0", "--format", "json")
    assert code == 0
    record = json.loads(out)
    assert record["leaf"] == {"stratum": "alpha != 0", "dimension": 4, "casimirs": {"C1": 1.0, "C2": 1.0}}
    assert record["proved"] is True
    assert [e["linear_stability"] for e in record["equilibria"]] == ["stable spectrum", "unstable"]
    assert record["equilibria"][0]["state"]["l1"] == pytest.approx(1)  # l along alpha: H = l1^2/4 - alpha1
    assert record["equilibria"][0]["energy"] == pytest.approx(-0.75)


@pytest.mark.slow
def test_relative_equilibria_are_those_along_an_integral(command):
    code, out, _ = command("equilibria", "lagrange", "--leaf", "C1=1,C2=1", "--along", "l3=1", "--format", "json")
    assert code == 0
    system = lp.catalog.system("lagrange")
    found = lp.equilibria(system, {"C1": 1, "C2": 1}, along=("l3",), values={"l3": 1})
    assert [e["energy"] for e in json.loads(out)["equilibria"]] == pytest.approx([e.energy for e in found])
    assert all("l3" in e["omega"] for e in json.loads(out)["equilibria"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twisted-top"], "must have numbers for all parameters"),
        (["kovalevskaja"], "Did you mean kovalevskaya"),
        (["lagrange", "--leaf", "C2=-1"], "C2"),
        (["lagrange", "--along", "l3"], "--along must be name=value; got 'l3'. Write for example --along l3=1/2"),
        (["lagrange", "--along", "l4=1"], "the name 'l4' is unknown. l has 3 components. Known are"),
        (["lagrange", "--starts", "0"], "n_starts"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("equilibria", *arguments)
    assert (code, out) == (2, "")
    assert words in err
