"""Program text in the type of the paper, and no program text in any step of any claim."""

import pytest
from program_text import PROGRAM_TEXT, lines_of

from liepoisson.studies.twisted_top.typography import typeset


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("l2 = 4*x/(1 + x^2), dalpha1 = 0", "l₂ = 4x/(1 + x²), δα₁ = 0"),
        ("-(2*x - 1 + x^2)*(x^2 - 1)/(2*(1 + x^2)^2)", "−(2x − 1 + x²)(x² − 1)/(2(1 + x²)²)"),
        ("(beta3^2 + beta2)*beta3 = 0", "(β₃² + β₂) β₃ = 0"),
        ("l1*l2^(-1)", "l₁ l₂⁻¹"),
        ("x' = x/2 solves the equations", "dx/dt = x/2 solves the equations"),
        ("at x = 0, x^2 + 1 = 0, infinity are -2, -1, 3", "at x = 0, x² + 1 = 0, ∞ are −2, −1, 3"),
        ("x = 0: 0, -1, infinity: 0", "x = 0: 0, −1, x = ∞: 0"),
        ("with F_k, F_6/F_5 of rank 1", "with Fₖ, F₆/F₅ of rank 1"),
        ("around x = 0.25-0.25j: 2.53e+07, 1.5e-06", "around x = 0.25 − 0.25i: 2.53 × 10⁷, 1.5 × 10⁻⁶"),
        ("an entry of gh - hg; the two-field top", "an entry of gh − hg; the two-field top"),
        ("H from -0.749 to -0.423, twisted-unit-vectors: 1", "H from −0.749 to −0.423, twisted-unit-vectors: 1"),
        ("epsilon = 0, J1 - J2 = 0", "ε = 0, J₁ − J₂ = 0"),
    ],
)
def test_program_text_is_typeset(text, expected):
    assert PROGRAM_TEXT.search(text)
    assert typeset(text) == expected
    assert typeset(expected) == expected


def test_no_step_of_a_claim_is_program_text(exact_results):
    verdicts = [result.verdict for result in exact_results if result.verdict.verdict != "not run"]
    assert len(verdicts) > 40
    assert {line for verdict in verdicts for line in lines_of(verdict) if PROGRAM_TEXT.search(line)} == set()
