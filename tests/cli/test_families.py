"""`liepoisson families`: conditions on parameters, for people and for programs."""

import json

import pytest

import liepoisson as lp

TOP = """
name = "top"

[bracket]
algebra = "so(3)"
extension = "semidirect(2)"
variables = ["l", "alpha"]

[parameters]
symbols = ["J1", "J2", "J3", "a1", "a2", "a3"]

[hamiltonian]
expression = "(J1*l1^2 + J2*l2^2 + J3*l3^2)/2 + a1*alpha1 + a2*alpha2 + a3*alpha3"
"""


@pytest.fixture
def top(tmp_path):
    path = tmp_path / "top.toml"
    path.write_text(TOP, encoding="utf-8")
    return path


def test_conditions_are_printed_with_the_proof(command, top):
    code, out, err = command("families", top, "--degree", "1", "--positive", "J1,J2", "--positive", "J3")
    assert (code, err) == (0, "")
    found = lp.integrability.integrable_families(lp.read_system(top), degree=1, positive=["J1", "J2", "J3"])
    assert out == f"{found}\n"
    assert "  if a2 = 0, a3 = 0, J2 - J3 = 0\n" in out
    assert "and in no other case: proved" in out


def test_parameters_of_the_catalog_are_freed(command):
    arguments = ("--free", "I", "--free", "a", "--positive", "I1,I2,I3", "--degree", "1", "--format", "json")
    code, out, _ = command("families", "heavy-top", *arguments)
    record = json.loads(out)
    assert code == 0
    assert record["parameters"] == ["a1", "a2", "a3", "I1", "I2", "I3"]
    assert record["assumptions"] == "real parameters; I1, I2, I3 > 0"
    # Lagrange's top about each axis, and the spherical one
    assert sorted(map(set, (case["zero"] for case in record["cases"])), key=sorted) == sorted(
        [{"I1 - I2", "I1 - I3"}, {"I1 - I2", "a1", "a2"}, {"I1 - I3", "a1", "a3"}, {"I2 - I3", "a2", "a3"}], key=sorted
    )
    assert all(case["integrals"] and set(case["example"]) == set(record["parameters"]) for case in record["cases"])
    assert (record["complete"], record["left"]) == (True, [])


def test_a_level(command, top):
    settings = ("--set", "J1=1", "--set", "J2=1", "--set", "a2=0", "--positive", "J3")
    code, out, _ = command("families", top, *settings, "--degree", "3", "--on", "C1 = 0")
    assert code == 0
    assert "if a3 = 0, J3 - 4 = 0" in out
    assert "J3 - 4" not in command("families", top, *settings, "--degree", "3")[1]


@pytest.mark.parametrize("format_", ["text", "latex", "json"])
def test_what_is_left_is_said_and_is_the_exit_code(command, top, format_):
    code, out, err = command("families", top, "--time-limit", "1e-9", "--format", format_)
    assert (code, err) == (1, "")
    assert "all parameters" in out
    if format_ == "json":
        assert (json.loads(out)["complete"], json.loads(out)["left"]) == (False, ["all parameters"])
    else:
        assert "incomplete, 1 case is left:" in out
