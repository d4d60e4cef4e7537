"""Steps of a check, and how they are printed."""

import sympy as sp

from liepoisson.studies.twisted_top.claims.evidence import Evidence, summary_of
from liepoisson.studies.twisted_top.typography import show


def test_expressions_are_shown_in_unicode():
    x = sp.symbols("l1 alpha2 beta3 epsilon I3")
    assert show(2 * x[3] * x[0] * x[2] + x[1] ** 2) == "α₂² + 2·β₃·ε·l₁"
    assert show(1 / x[4] - x[0] ** -2) == "−1/l₁² + 1/I₃"
    assert show(sp.Symbol("p_psi") ** 12) == "p_ψ¹²"
    assert len(show(sp.expand((x[0] + x[1] + x[2]) ** 12))) == 160


def test_evidence_records_each_step():
    x = sp.Symbol("x")
    evidence = Evidence("holds")
    assert evidence.zero("a", (x + 1) ** 2 - x**2 - 2 * x - 1)
    assert evidence.zero("b", [x - x, 1 / x - (x + 1) / (x**2 + x)])
    assert evidence.equal("c", 2, 2)
    assert evidence.nonzero("d", sp.Matrix([0, x]))
    evidence.note("e")
    verdict = evidence.conclude()
    assert (verdict.verdict, verdict.method, verdict.correct_statement) == ("holds", "exact", "")
    assert verdict.certificate == "✓ a\n✓ b\n✓ c: 2\n✓ d\n    computed: x\n  e"
    assert not evidence.zero("f", x * (x + 1))
    assert not evidence.equal("g", 3, 2)
    assert not evidence.nonzero("h", 0)
    evidence.verdict, evidence.correct_statement = "holds with a condition", "never mind"
    failed = evidence.conclude()
    assert failed.verdict == "wrong"
    assert "✗ f — residual x·(x + 1)" in failed.certificate
    assert "✗ g: 2 — computed 3" in failed.certificate
    assert failed.correct_statement.endswith("g: 2 (computed 3); h (the value is 0).")
    evidence.verdict = "wrong"
    assert evidence.conclude().verdict == "not settled"


def test_floating_point_numbers_are_no_part_of_a_proof():
    evidence = Evidence("holds")
    evidence.zero("a", sp.Integer(0))
    assert evidence.computation("b", True, ["c"], [("d", "e"), (-1, "2·10⁻³")])
    verdict = evidence.conclude()
    assert summary_of(verdict.steps) == "1 identity"
    assert verdict.certificate == "✓ a\n✓ In floating point: b\n    c\n     d       e\n    −1  2·10⁻³"
    assert not evidence.computation("f", False)
    assert "✗ In floating point: f — not borne out" in evidence.conclude().certificate
