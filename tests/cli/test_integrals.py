"""`liepoisson integrals` and `liepoisson integrable`: what they print, for people and for programs."""

import json

import sympy as sp

import liepoisson as lp


def test_integrals_are_printed_with_the_proof(command):
    code, out, err = command("integrals", "kovalevskaya", "--weight", "4")
    assert (code, err) == (0, "")
    assert out == f"{lp.integrability.first_integrals(lp.catalog.system('kovalevskaya'), weight=4)}\n"
    assert "F1 = 16*alpha2*l1*l2" in out
    assert "proved over the complex numbers" in out


def test_integrals_for_programs_are_read_again(command):
    code, out, _ = command("integrals", "goryachev-chaplygin", "--on", "C1 = 0", "--degree", "3", "--format", "json")
    assert code == 0
    record = json.loads(out)
    assert list(record) == [
        *("system", "degree", "functions", "on", "generic_parameters", "known", "found", "complete", "modulo_ideal"),
        *("notes", "proof"),
    ]
    system = lp.catalog.system("goryachev-chaplygin")
    claimed, level = system.partial_integrals["G"]
    assert [system.expression(f) for f in record["on"]] == [level]
    assert [k["name"] for k in record["known"]] == ["H", "C1", "C2"]
    assert system.expression(record["known"][0]["expression"]) == system.hamiltonian
    (found,) = record["found"]
    assert sp.expand(system.expression(found["expression"]) - claimed) == 0
    assert "^" in found["expression"]
    assert (found["degree"], found["independent"], record["complete"]) == (3, True, True)
    assert record["proof"]["monomials"] == 83


def test_integrals_in_latex(command):
    code, out, _ = command("integrals", "twisted-lagrange", "--degree", "2", "--format", "latex")
    assert code == 0
    lines = out.splitlines()
    assert all(line.startswith("% ") for line in lines[:-2])
    assert lines[-2] == r"\[ F_1 = \ell_3 \]"
    assert r"\alpha_1 \ell_1" in lines[-1]


def test_parameters_that_are_set(command):
    code, out, _ = command("integrals", "heavy-top", "--set", "I=2,2,1", "--set", "a=0,0,1", "--degree", "1")
    assert (code, "F1 = l3" in out) == (0, True)


def test_an_integrable_system_with_its_certificate(command, tmp_path):
    path = tmp_path / "clebsch.json"
    code, out, err = command("integrable", "clebsch", "--certificate", path)
    assert (code, err) == (0, "")
    assert out.startswith("clebsch: Liouville integrable, 2 commuting integrals")
    assert lp.integrability.load_certificate(path)["system"] == "clebsch"


def test_a_verdict_for_programs(command):
    code, out, _ = command("integrable", "henon-heiles", "--degree", "4", "--format", "json")
    record = json.loads(out)
    assert code == 0
    assert (record["verdict"], record["searched_degree"]) == ("not integrable", 4)
    assert (record["certificate"], record["commuting"], record["rank"]) == (None, [], 4)
    assert record["obstruction"]["theorem"] == "Morales-Ruiz and Ramis"
    assert record["singularities"]["verdict"] == "fails"
    assert [search["degree"] for search in record["searches"]] == [1, 2, 3, 4]


def test_the_whole_report_is_saved(command, tmp_path):
    path = tmp_path / "henon.json"
    code, out, _ = command("integrable", "henon-heiles", "--degree", "3", "--save", path)
    assert code == 0
    assert str(lp.integrability.load_report(path, prove_again=True)) == out.rstrip("\n")


def test_no_proof_no_certificate(command, tmp_path):
    path = tmp_path / "henon.json"
    code, out, err = command("integrable", "henon-heiles", "--degree", "3", "--certificate", path)
    assert code == 2
    assert "no polynomial integral up to degree 3" in out
    assert "wanted a proof of integrability" in err
    assert not path.exists()
