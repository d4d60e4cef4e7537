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


def test_conditions_in_latex(command, top):
    code, out, _ = command("families", top, "--degree", "1", "--positive", "J1,J2,J3", "--format", "latex")
    assert code == 0
    lines = out.splitlines()
    assert lines[0].startswith("% top: a further polynomial integral up to degree 1 exists")
    assert r"\[ a_2 = 0,\quad a_3 = 0,\quad J_2 - J_3 = 0 \]" in lines
    assert lines[-1].startswith("% and in no other case")
    assert len(lines) == 6


SPECIAL = """
name = "special"

[bracket]
algebra = "so(3)"
extension = "leibniz(4, epsilon)"

[parameters]
symbols = ["epsilon"]

[hamiltonian]
expression = "{h}"
"""


def test_what_must_not_vanish_is_said_in_all_formats(command, tmp_path):
    """At a = 0 the integral l3 is no polynomial in H = b l3^2 + c l3, unless b = 0."""
    path = tmp_path / "body.toml"
    text = TOP.replace("semidirect(2)", "trivial()").replace(', "alpha"', "").replace("J1*l1^2", "a1*l1^2")
    text = text.replace(
        "(a1*l1^2 + J2*l2^2 + J3*l3^2)/2 + a1*alpha1 + a2*alpha2 + a3*alpha3", "a1*l1^2 + a2*l3^2 + a3*l3"
    )
    path.write_text(text.replace('"J1", "J2", "J3", ', ""), encoding="utf-8")
    outputs = {f: command("families", path, "--degree", "1", "--format", f)[1] for f in ("text", "latex", "json")}
    assert "a1 = 0, where a2 is not 0" in outputs["text"]
    assert r"\[ a_1 = 0,\quad a_2 \neq 0 \]" in outputs["latex"]
    assert {"zero": ["a1"], "not_zero": ["a2"]}.items() <= json.loads(outputs["json"])["cases"][0].items()
    assert "a2" in repr(lp.integrability.integrable_families(lp.read_system(path), degree=1).cases[0].nonzero)


def test_more_casimirs_of_special_parameters_are_said(command, tmp_path):
    path = tmp_path / "special.toml"
    bracket = lp.so(3) @ lp.leibniz(4, "epsilon")
    x = [str(v) for v in bracket.variables]
    linear = f"{x[3]} + 2*{x[4]} + 3*{x[5]} + {x[6]} - {x[7]} + 2*{x[8]} - 3*{x[9]} + {x[10]} + 5*{x[11]}"
    text = SPECIAL.format(h=f"({x[0]}^2 + 2*{x[1]}^2 + 3*{x[2]}^2)/2 + {linear}")
    path.write_text(text, encoding="utf-8")
    code, out, _ = command("families", path, "--format", "json")
    record = json.loads(out)
    assert (code, record["cases"], [one["zero"] for one in record["casimirs"]]) == (0, [], [["epsilon"]])
    assert "% more Casimirs, which do not count, if epsilon = 0" in command("families", path, "--format", "latex")[1]


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


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["families", "kovalevskaya"], "must have parameters without a value"),
        (["families", "clebsch", "--free", "b"], "--free must name a parameter of 'clebsch'"),
        (["families", "clebsch", "--free", "a", "--positive", "a"], "wanted names of a1, a2, a3"),
        (["families", "clebsch", "--free", "a", "--time-limit", "0"], "--time-limit"),
        (["families", "clebsch", "--free", "a", "--on", "m1"], "not invariant"),
        (["families", "clebsch", "--free", "a", "--degree", "0"], "degree"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command(*arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
