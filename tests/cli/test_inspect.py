"""`liepoisson inspect`: what it prints, and what it refuses."""

import io
import json
import re
import sys

import pytest

from liepoisson.cli.inspect import terminal_style
from liepoisson.formula.styles import PLAIN, UNICODE

TYPED = """
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


@pytest.mark.thorough
def test_the_twisted_top_is_printed_with_symbols(command):
    code, out, err = command("inspect", "twisted-top")
    assert (code, err) == (0, "")
    for line in (
        "C₁ = |α|² + 2ε l·β",
        "C₂ = α·β",
        "C₃ = |β|²",
        "l′ = l × ω + α × a + β × b",
        "α′ = α × ω + ε β × a",
        "β′ = β × ω",
        "H = ½ l·I⁻¹l + a·α + b·β",
        "Jacobi identity proved",
        "rank 6, corank 3",
        "needs values for",
    ):
        assert line in out


def test_a_file_is_read_and_recognised_as_a_top(command, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(TYPED)
    code, out, _ = command("inspect", path, "--format", "json")
    record = json.loads(out)
    assert code == 0
    assert record["name"] == "my top"
    assert record["kernel"]["kind"] == "top"
    assert record["bracket"]["jacobi"]["proved"] is True
    assert record["casimirs"]["generators"][0]["text"] == "|alpha|^2 + 2 l.beta"


@pytest.mark.thorough
def test_a_sign_changed_in_the_file_changes_the_report(command, tmp_path):
    """Nothing is quoted: the Casimir and the equation follow the bracket that the file gives."""
    path = tmp_path / "mine.toml"
    for extension, sign in (("leibniz(3, epsilon)", 1), ("leibniz(3, -epsilon)", -1)):
        path.write_text(TYPED.replace("leibniz(3, epsilon)", extension))
        _, out, _ = command("inspect", path, "--format", "json")
        record = json.loads(out)
        casimir, equation = record["casimirs"]["generators"][0], record["equations"]["components"]["alpha2"]
        assert casimir["text"] == f"|alpha|^2 {'+' if sign > 0 else '-'} 2 l.beta"
        assert equation["text"].endswith("- beta3" if sign > 0 else "+ beta3")


@pytest.mark.thorough
def test_latex_is_a_fragment_for_a_paper_with_balanced_braces(command):
    code, out, _ = command("inspect", "twisted-top", "--format", "latex")
    assert code == 0
    assert "document" not in out
    assert (
        "\\begin{align*}\n"
        r"  C_1 &= |\boldsymbol{\alpha}|^{2} + 2 \epsilon\,\boldsymbol{\ell}\cdot \boldsymbol{\beta} \\"
    ) in out
    assert out.count(r"\begin{align*}") == out.count(r"\end{align*}") == 2
    words = re.sub(r"\$.*?\$|\\\[.*?\\\]|\\begin.*?\\end", "", out.partition("paragraph")[2], flags=re.DOTALL)
    assert not re.search(r"\b(epsilon|alpha|beta|so\(3\)|l1|I2|J)\b", words), "mathematics is set as such"
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", out):
        depth += 1 if brace == "{" else -1
        assert depth >= 0
    assert depth == 0
    assert out.replace(r"\$", "").count("$") % 2 == 0
    assert out.count(r"\[") == out.count(r"\]")


def test_ascii_where_the_terminal_has_no_more(monkeypatch):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert terminal_style() is PLAIN
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="utf-8"))
    assert terminal_style() is UNICODE


@pytest.mark.thorough
def test_a_false_integral_is_called_false(command, tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text(TYPED + '[integrals]\nQ = "l3"\nH2 = "dot(beta, beta)"\n')
    code, out, err = command("inspect", path)
    assert code == 1
    assert "Q = l₃: NOT constant, Q′ = α₂" in out
    assert err == "liepoisson: my top: the integral Q is not constant.\n"
    code, out, err = command("inspect", path, "--format", "json")
    assert (code, json.loads(out)["failed"]) == (1, ["the integral Q is not constant"])
    assert err.count("\n") == 1


def test_values_may_be_given_on_the_command_line(command):
    values = ["--set", "I=2,2,1", "--set", "a=[-1, 0, 0]", "--set", "b=0,0,0", "--set", "epsilon=1/3"]
    code, out, _ = command("inspect", "twisted-top", *values)
    assert code == 0
    assert "C₁ = |α|² + ⅔ l·β" in out
    assert "ε = 1/3" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twistedtop"], "no system 'twistedtop'"),
        (["missing.toml"], "missing.toml"),
        (["/tmp"], "liepoisson: /tmp must be a file; it is a folder. Give the path of a TOML file.\n"),
        (["twisted-top", "--set", "epsilom=1"], "'twisted-top' has no parameter 'epsilom'. Did you mean epsilon?"),
        (["twisted-top", "--set", "a=1,0"], "a must have 3 components; got 2 components. Give for example [1, 2, 3]."),
        (["twisted-top", "--set", "epsilon"], "--set must be name=value; got 'epsilon'"),
        (["twisted-top", "--set", "epsilon=__import__('os')"], "__import__"),
        (["twisted-top", "--format", "html"], "html"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("inspect", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
