"""Variables in italics, articles not."""

import pytest

from liepoisson.studies.twisted_top.typography import mathematics


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("α × a", "_α_ × _a_"),
        ("a point", "a point"),
        ("For ε ≠ 0 a leaf has rank 6", "For _ε_ ≠ 0 a leaf has rank 6"),
        ("about n, a Poisson map", "about _n_, a Poisson map"),
        ("I₁ = I₂, a and b equatorial", "_I_₁ = _I_₂, _a_ and _b_ equatorial"),
        ("A Lie algebra; A Aᵀ = 1", "A Lie algebra; _A_ _A_ᵀ = 1"),
        ("2ε sin θ", "2_ε_ sin _θ_"),
        ("β = wn", "_β_ = _wn_"),
        ("The matrix A is; matrix A after", "The matrix _A_ is; matrix _A_ after"),
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
