"""`liepoisson darboux`: what it prints, for people and for programs."""

import json

import sympy as sp

import liepoisson as lp


def test_polynomials_are_printed_with_the_proof(command):
    code, out, err = command("darboux", "rattleback", "--degree", "1")
    assert (code, err) == (0, "")
    assert out == f"{lp.integrability.darboux_polynomials(lp.catalog.system('rattleback'), degree=1)}\n"
    assert "P1 = x1, cofactor 4*x3" in out


def test_polynomials_for_programs(command):
    code, out, _ = command("darboux", "rattleback", "--degree", "2", "--field", "rational", "--format", "json")
    assert code == 0
    record = json.loads(out)
    assert list(record) == [
        *("system", "degree", "on", "field", "known", "found", "rational_integrals", "complete", "left", "proof")
    ]
    system = lp.catalog.system("rattleback")
    assert (record["field"], record["complete"], record["left"]) == ("rational", True, [])
    for p in record["found"]:
        expression, cofactor = system.expression(p["expression"]), system.expression(p["cofactor"])
        assert sp.expand(system.derivative(expression) - cofactor * expression) == 0
        assert p["real"]
    (integral,) = record["rational_integrals"]
    assert (integral["powers"], integral["polynomial"], integral["independent"]) == ({"P1": 1, "P2": 4}, True, False)
    assert record["proof"]["cofactor_monomials"] == ["x1", "x2", "x3"]


def test_a_weight_and_a_level(command):
    code, out, _ = command("darboux", "kovalevskaya", "--weight", "2", "--on", "C1=0", "--format", "json")
    record = json.loads(out)
    assert (code, record["weight"], record["weights"]) == (0, 2, [1, 1, 1, 2, 2, 2])
    assert [p["cofactor"] for p in record["found"]] == ["I*l3", "-I*l3"]
    assert record["on"] == ["alpha1*l1 + alpha2*l2 + alpha3*l3"]


def test_polynomials_in_latex(command):
    code, out, _ = command("darboux", "rattleback", "--degree", "1", "--format", "latex")
    assert code == 0
    lines = out.splitlines()
    assert all(line.startswith("% ") for line in lines[:-2])
    assert lines[-2] == r"\[ P_1 = x_1, \qquad \dot P_1 = (4 x_3)\, P_1 \]"
