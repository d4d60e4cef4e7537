"""Variables in italics, articles not; program text in the type of the paper."""

import pytest

from liepoisson.studies.twisted_top.claims.typography import typeset
from liepoisson.studies.twisted_top.mathematics import mathematics


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("α × a", "_α_ × _a_"),
        ("For ε ≠ 0 a leaf has rank 6", "For _ε_ ≠ 0 a leaf has rank 6"),
        ("about n, a Poisson map", "about _n_, a Poisson map"),
        ("I₁ = I₂, a and b equatorial", "_I_₁ = _I_₂, _a_ and _b_ equatorial"),
        ("2ε sin θ", "2_ε_ sin _θ_"),
        ("β = wn", "_β_ = _wn_"),
        ("we do: dz/dt = yz", "we do: _dz_/_dt_ = _yz_"),
    ],
)
def test_variables_are_in_italics(text, expected):
    assert str(mathematics(text)).replace("<i>", "_").replace("</i>", "_") == expected


def test_what_has_a_meaning_in_html_is_escaped():
    assert str(mathematics('1 < 2 & "so"')) == "1 &lt; 2 &amp; &#34;so&#34;"


def test_indices_that_unicode_lacks_are_set_low():
    assert str(mathematics("p_φ e⊥")) == "<i>p</i><sub><i>φ</i></sub> <i>e</i><sub>⊥</sub>"
    assert str(mathematics("2 I_max")) == "2 <i>I</i><sub>max</sub>"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("l2 = 4*x/(1 + x^2), dalpha1 = 0", "l₂ = 4x/(1 + x²), δα₁ = 0"),
        ("-(2*x - 1 + x^2)*(x^2 - 1)/(2*(1 + x^2)^2)", "−(2x − 1 + x²)(x² − 1)/(2(1 + x²)²)"),
        ("l1*l2^(-1)", "l₁ l₂⁻¹"),
        ("x' = x/2 solves the equations", "dx/dt = x/2 solves the equations"),
        ("at x = 0, x^2 + 1 = 0, infinity are -2, -1, 3", "at x = 0, x² + 1 = 0, ∞ are −2, −1, 3"),
        ("with F_k, F_6/F_5 of rank 1", "with Fₖ, F₆/F₅ of rank 1"),
        ("around x = 0.25-0.25j: 2.53e+07, 1.5e-06", "around x = 0.25 − 0.25i: 2.53 × 10⁷, 1.5 × 10⁻⁶"),
        ("H from -0.749 to -0.423, twisted-unit-vectors: 1", "H from −0.749 to −0.423, twisted-unit-vectors: 1"),
        ("epsilon = 0, J1 - J2 = 0", "ε = 0, J₁ − J₂ = 0"),
    ],
)
def test_program_text_is_typeset(text, expected):
    assert typeset(text) == expected
    assert typeset(expected) == expected
