"""`liepoisson equilibria`: the equilibria of a leaf, as a table and for programs."""

import json

import pytest

import liepoisson as lp


def test_equilibria_are_those_of_the_leaf(command, tmp_path):
    path = tmp_path / "table.csv"
    code, out, err = command("equilibria", "kovalevskaya", "--leaf", "l.alpha=1,C2=1", "--out", path)
    assert (code, err) == (0, "")
    system = lp.catalog.system("kovalevskaya")
    found = lp.equilibria(system, lp.Leaf(system, {"C1": 1, "C2": 1}))
    assert repr(found) in out
    assert path.read_text() == found.to_csv(tmp_path / "expected.csv").read_text()
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


def test_an_upright_top_that_spins_fast_has_a_hint(command):
    code, out, _ = command("equilibria", "lagrange", "--leaf", "C1=3,C2=1")
    assert code == 0
    hint = "is stable, with an integral added to H: equilibrium(system, state, along=('l3',))"
    assert [line for line in out.splitlines() if line.startswith("hint")] == [
        f"hint     equilibrium {k} {hint}" for k in (1, 2)
    ]
    top = lp.catalog.system("lagrange")
    alone, with_l3 = (lp.phase_space.equilibrium(top, [0, 0, 3, 0, 0, 1], along=along) for along in ((), ("l3",)))
    assert (alone.nonlinear_stability, with_l3.nonlinear_stability) == ("no conclusion", "stable")
    _, out, _ = command("equilibria", "lagrange", "--leaf", "C1=1,C2=1")  # the upright one is unstable
    assert "hint     equilibrium 2" not in out
