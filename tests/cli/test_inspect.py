"""`liepoisson inspect`: what it prints, and what it refuses."""

import io
import json
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
