"""What the exact commands print, for people and for programs.

They are in liepoisson.cli.exact and liepoisson.cli.proofs.
"""

import io
import json
import sys

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.cli.exact import terminal_style
from liepoisson.formula.styles import PLAIN, UNICODE

OF, SYSTEM = lp.integrability, lp.catalog.system
TOP = """
[bracket]
algebra = "so(3)"
extension = "semidirect(2)"
variables = ["l", "alpha"]
[parameters]
symbols = ["J1", "J2", "J3", "a1", "a2", "a3"]
[hamiltonian]
expression = "(J1*l1^2 + J2*l2^2 + J3*l3^2)/2 + a1*alpha1 + a2*alpha2 + a3*alpha3"
"""
TWISTED = """
name = "my top"
[bracket]
algebra = "so(3)"
extension = "leibniz(3, epsilon)"
variables = ["l", "alpha", "beta"]
[parameters]
epsilon = 1
I = [2, 2, 1]
a = [-1, 0, 0]
[hamiltonian]
expression = "l1^2/(2*I1) + l2^2/(2*I2) + l3^2/(2*I3) + dot(a, alpha)"
"""


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "top.toml").write_text(TOP)
    (tmp_path / "mine.toml").write_text(TWISTED)
    return tmp_path


def top_families():
    return OF.integrable_families(lp.read_system("top.toml"), degree=1, positive=["J1", "J2", "J3"])


PRINTED = {
    "darboux rattleback --degree 1": (
        lambda: OF.darboux_polynomials(SYSTEM("rattleback"), degree=1), "P1 = x1, cofactor 4*x3",
    ),
    "integrals kovalevskaya --weight 4": (
        lambda: OF.first_integrals(SYSTEM("kovalevskaya"), weight=4), "proved over the complex numbers",
    ),
    "critical kovalevskaya --leaf C1=0,|alpha|^2=1": (
        lambda: lp.tori.critical_equations(SYSTEM("kovalevskaya"), {"C1": 0, "C2": 1}), "\n1 + H^2 - K = 0\n",
    ),
    "painleve lagrange": (lambda: OF.painleve_test(SYSTEM("lagrange")), "exponents -1, 0, 1, 2, 3, 4"),
    "families top.toml --degree 1 --positive J1,J2 --positive J3": (top_families, "  if a2 = 0, a3 = 0, J2 - J3 = 0\n"),
    "deformations twisted-kovalevskaya --parameter epsilon --weight 6 --order 1": (
        lambda: lp.deformations(
            lp.System(
                lp.so(3) @ lp.leibniz(3, "epsilon"), SYSTEM("twisted-kovalevskaya").hamiltonian,
                name="twisted-kovalevskaya",
            ), weight=6, order=1,
        ),
        "nothing survives, whatever polynomial is added to the Hamiltonian in first order",
    ),
    "integrable henon-heiles --degree 3 --save henon.json": (
        lambda: OF.load_report("henon.json", prove_again=True), "not integrable",
    ),
    "integrable clebsch --certificate clebsch.json": (
        lambda: OF.integrability_report(SYSTEM("clebsch")), "clebsch: Liouville integrable, 2 commuting integrals",
    ),
}  # fmt: skip


@pytest.mark.parametrize("line", PRINTED)
def test_what_is_printed_is_what_python_prints(command, line):
    found, words = PRINTED[line]
    code, out, err = command(*line.split())
    assert (code, err) == (0, "")
    assert out == f"{found()}\n"
    assert words in out
    assert "clebsch" not in line or OF.load_certificate("clebsch.json")["system"] == "clebsch"


def record_of(command, line):
    code, out, _ = command(*line.split(), "--format", "json")
    assert code == 0
    return json.loads(out)


def test_integrals_for_programs_are_read_again(command):
    record = record_of(command, "integrals goryachev-chaplygin --on C1=0 --degree 3")
    assert list(record) == [
        *("system", "degree", "functions", "on", "generic_parameters", "known", "found", "complete", "modulo_ideal"),
        *("notes", "proof"),
    ]
    system = SYSTEM("goryachev-chaplygin")
    claimed, level = system.partial_integrals["G"]
    assert [system.expression(f) for f in record["on"]] == [level]
    assert [k["name"] for k in record["known"]] == ["H", "C1", "C2"]
    (found,) = record["found"]
    assert sp.expand(system.expression(found["expression"]) - claimed) == 0
    assert (found["degree"], found["independent"], record["complete"]) == (3, True, True)
    assert record["proof"]["monomials"] == 83


def test_verdicts_for_programs(command):
    record = record_of(command, "integrable henon-heiles --degree 4")
    assert (record["verdict"], record["searched_degree"]) == ("not integrable", 4)
    assert (record["certificate"], record["commuting"], record["rank"]) == (None, [], 4)
    assert record["obstruction"]["theorem"] == "Morales-Ruiz and Ramis"
    assert [search["degree"] for search in record["searches"]] == [1, 2, 3, 4]
    record = record_of(command, "painleve henon-heiles-kaup-kupershmidt")
    assert list(record) == ["system", "functions", "weights", "balances", "special", "left", "verdict", "scope"]
    assert (record["verdict"], record["weights"]) == ("passes weakly", [{"x": "2", "y": "2", "p_x": "3", "p_y": "3"}])
    exponents = [balance["exponents"] for balance in record["balances"]]
    assert exponents == [["-1", "3/2", "7/2", "6"], ["-7", "-1", "6", "12"]]
    resonance = {"exponent": "3/2", "multiplicity": 1, "kernel": 1, "conditions": []}
    assert record["balances"][0]["resonances"][1] == resonance
    first = record_of(command, "painleve henon-heiles")["balances"][0]
    assert (first["status"], first["exponents"]) == ("fails", ["-1", "6"])
    assert sorted(first["other_exponents"])[1] == pytest.approx([2.5, 47**0.5 / 2])


def test_darboux_polynomials_for_programs(command):
    record = record_of(command, "darboux rattleback --degree 2 --field rational")
    keys = ("system", "degree", "on", "field", "known", "found", "rational_integrals", "time_dependent_integrals")
    keys += ("complete", "left", "proof")
    assert tuple(record) == keys
    system = SYSTEM("rattleback")
    assert (record["field"], record["complete"], record["left"]) == ("rational", True, [])
    for p in record["found"]:
        expression, cofactor = system.expression(p["expression"]), system.expression(p["cofactor"])
        assert sp.expand(system.derivative(expression) - cofactor * expression) == 0
    (integral,) = record["rational_integrals"]
    assert (integral["powers"], integral["polynomial"], integral["independent"]) == ({"P1": 1, "P2": 4}, True, False)
    record = record_of(command, "darboux kovalevskaya --weight 2 --on C1=0")
    assert (record["weight"], record["weights"]) == (2, [1, 1, 1, 2, 2, 2])
    assert [p["cofactor"] for p in record["found"]] == ["I*l3", "-I*l3"]


def test_conditions_on_parameters_of_the_catalog(command):
    record = record_of(command, "families heavy-top --free I --free a --positive I1,I2,I3 --degree 1")
    assert record["parameters"] == ["a1", "a2", "a3", "I1", "I2", "I3"]
    assert record["assumptions"] == "real parameters; I1, I2, I3 > 0"
    # Lagrange's top about each axis, and the spherical one
    assert {frozenset(case["zero"]) for case in record["cases"]} == {
        *map(frozenset, (("I1 - I2", "I1 - I3"), ("I1 - I2", "a1", "a2"))),
        *map(frozenset, (("I1 - I3", "a1", "a3"), ("I2 - I3", "a2", "a3"))),
    }
    assert all(case["integrals"] and set(case["example"]) == set(record["parameters"]) for case in record["cases"])
    assert (record["complete"], record["left"]) == (True, [])


LATEX = {
    "darboux rattleback --degree 1": r"\[ P_1 = x_1, \qquad \dot P_1 = (4 x_3)\, P_1 \]",
    "integrals twisted-lagrange --degree 2": r"\[ F_1 = \ell_3 \]",
    "families top.toml --degree 1 --positive J1,J2,J3": r"\[ a_2 = 0,\quad a_3 = 0,\quad J_2 - J_3 = 0 \]",
    "inspect twisted-top": r"  C_3 &= |\boldsymbol{\beta}|^{2}",
}


@pytest.mark.parametrize("line", LATEX)
def test_formulas_for_a_paper(command, line):
    code, out, _ = command(*line.split(), "--format", "latex")
    assert code == 0
    assert LATEX[line] in out.splitlines()
    assert out.count("{") == out.count("}")


SAID = {
    "painleve henon-heiles-kdv --free B": (0, "For general values of the symbols."),
    "painleve henon-heiles-kdv --weights 1,2,2,3": (0, "orders of poles: 1 for x; 2 for y, p_x; 3 for p_y"),
    "painleve twisted-top --time-limit 1": (1, "verdict: undecided"),  # of which reading the equations needs 0.01
    "integrals heavy-top --set I=2,2,1 --set a=0,0,1 --degree 1": (0, "F1 = l3"),
    "families top.toml --set J1=1 --set J2=1 --set a2=0 --positive J3 --degree 3 --on C1=0": (
        0, "if a3 = 0, J3 - 4 = 0",
    ),
    "families top.toml --time-limit 1e-9": (1, "incomplete, 1 case is left; the time limit ended the search:"),
    "families top.toml --time-limit 1e-9 --format json": (1, '"all parameters"'),
    "inspect twisted-top --set I=2,2,1 --set a=[-1,0,0] --set b=0,0,0 --set epsilon=1/3": (0, "C₁ = |α|² + ⅔ l·β"),
}  # fmt: skip


@pytest.mark.parametrize("line", SAID)
def test_options_change_what_is_asked_and_what_is_left_is_the_exit_code(command, line):
    wanted, words = SAID[line]
    code, out, err = command(*line.split())
    assert (code, err) == (wanted, "")
    assert words in out


def test_no_proof_no_certificate(command, here):
    for name, printed, words in (
        ("henon-heiles", "no polynomial integral up to degree 3", "wanted a proof of integrability"),
        (
            "toda",
            "Liouville integrable",
            "certificates hold polynomials with rational coefficients; this proof has exp(",
        ),
    ):
        code, out, err = command("integrable", name, "--degree", "3", "--certificate", here / "no.json")
        assert (code, (here / "no.json").exists()) == (2, False)
        assert printed in out
        assert words in err


def test_the_twisted_top_is_printed_with_symbols(command):
    code, out, err = command("inspect", "twisted-top")
    assert (code, err) == (0, "")
    for line in (
        *("C₁ = |α|² + 2ε l·β", "C₂ = α·β", "C₃ = |β|²", "l′ = l × ω + α × a + β × b", "α′ = α × ω + ε β × a"),
        *("β′ = β × ω", "H = ½ l·I⁻¹l + a·α + b·β", "Jacobi identity proved", "rank 6, corank 3", "needs values for"),
    ):
        assert line in out


@pytest.mark.parametrize("sign", [1, -1])
def test_a_sign_changed_in_the_file_changes_the_report(command, here, sign):
    """Nothing is quoted: the Casimir and the equation follow the bracket that the file gives."""
    (here / "mine.toml").write_text(TWISTED if sign > 0 else TWISTED.replace(", epsilon)", ", -epsilon)"))
    record = record_of(command, "inspect mine.toml")
    assert (record["name"], record["kernel"]["kind"], record["bracket"]["jacobi"]["proved"]) == ("my top", "top", True)
    casimir, equation = record["casimirs"]["generators"][0], record["equations"]["components"]["alpha2"]
    assert casimir["text"] == f"|alpha|^2 {'+' if sign > 0 else '-'} 2 l.beta"
    assert equation["text"].endswith("- beta3" if sign > 0 else "+ beta3")


def test_a_false_integral_is_called_false(command, here):
    (here / "wrong.toml").write_text(TWISTED + '[integrals]\nQ = "l3"\nH2 = "dot(beta, beta)"\n')
    code, out, err = command("inspect", "wrong.toml")
    assert code == 1
    assert "Q = l₃: NOT constant, Q′ = α₂" in out
    assert err == "liepoisson: my top: the integral Q is not constant.\n"
    code, out, err = command("inspect", "wrong.toml", "--format", "json")
    assert (code, json.loads(out)["failed"]) == (1, ["the integral Q is not constant"])


@pytest.mark.parametrize(("encoding", "style"), [("ascii", PLAIN), ("utf-8", UNICODE)])
def test_ascii_where_the_terminal_has_no_more(monkeypatch, encoding, style):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding=encoding))
    assert terminal_style() is style


LORENZ = """
name = "Lorenz"
[equations]
x = "sigma*(y - x)"
y = "x*(rho - z) - y"
z = "x*y - c2*z"
[parameters]
sigma = 10
rho = 28
c = [1, "8/3"]
"""


def test_commands_that_ask_for_equations_alone_take_a_vector_field(command, tmp_path):
    path = tmp_path / "lorenz.toml"
    path.write_text(LORENZ)
    record = record_of(command, f"darboux {path} --set sigma=3 --set c=1,6 --field rational")
    assert [(p["expression"], p["cofactor"]) for p in record["found"]] == [("x^2 - 6*z", "-6")]
    (integral,) = record["time_dependent_integrals"]
    assert (integral["powers"], integral["rate"], integral["independent"]) == ({"P1": 1}, "-6", True)
    record = record_of(command, f"integrals {path} --degree 3")
    assert (record["found"], record["complete"], record["known"]) == ([], True, [])
    assert record_of(command, f"painleve {path}")["verdict"] == "fails"
    freed = record_of(command, f"painleve {path} --free rho --set sigma=1/2 --set c=1,1")
    assert "rho" in str(freed["balances"])


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("darboux FILE --set sigma", "--set must be name=value; got 'sigma'. Write for example --set sigma=1."),
        ("darboux FILE --set m=1", "'Lorenz' has no parameter 'm'. Known: sigma, rho, c"),
        ("painleve FILE --free x", "--free must name a parameter of 'Lorenz' that has a value; got 'x'."),
        ("inspect FILE", "A vector field has no bracket: lp.read_system reads it, and so do the commands that ask"),
        ("equilibria FILE", "A vector field has no bracket"),
    ],
)
def test_what_commands_refuse_of_a_vector_field(command, tmp_path, line, words):
    path = tmp_path / "lorenz.toml"
    path.write_text(LORENZ)
    code, _, err = command(*line.replace("FILE", str(path)).split())
    assert code == 2
    assert words in " ".join(err.split())
