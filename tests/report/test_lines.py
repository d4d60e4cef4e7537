"""Words and formulas in turn."""

import pytest
import sympy as sp

from liepoisson.formula.styles import LATEX, PLAIN, UNICODE
from liepoisson.report.lines import (
    Column,
    Conditions,
    Equation,
    Name,
    Rate,
    Ring,
    Statement,
    Unequal,
    VectorName,
    joined,
    write_line,
)
from liepoisson.report.printing import Formula
from liepoisson.structure.locus import Locus

NAMES = (frozenset({"l", "alpha", "beta", "x"}), frozenset({"epsilon", "l1"}))
PAIR = ("alpha", "beta")
L3 = Formula(sp.Symbol("l3"), {}, {"l3": ("l", "3")})


@pytest.mark.parametrize(
    ("piece", "plain", "unicode", "latex"),
    [
        *((Statement(statement, *NAMES), statement, unicode, latex) for statement, unicode, latex in (
            ("alpha -> s^2*alpha + d*beta", "α → s² α + d β", None),
            ("l -> s^(-1)*l", "l → s⁻¹ l", None),
            ("epsilon = 0", "ε = 0", r"\epsilon = 0"),
            ("alpha -> s*alpha takes epsilon to s^2*epsilon", "α → s α takes ε to s² ε", None))),
        *((Conditions(locus, are_vectors=True), plain, unicode, latex) for locus, plain, unicode, latex in (
            (Locus(zero=("beta",), nonzero=(("alpha",),)), "beta = 0, alpha != 0", "β = 0, α ≠ 0",
             r"\boldsymbol{\beta} = 0, \boldsymbol{\alpha} \neq 0"),
            (Locus(not_parallel=(PAIR,)), "alpha x beta != 0", "α × β ≠ 0", None),
            (Locus(parallel=(PAIR,), nonzero=(PAIR,)), "alpha x beta = 0, (alpha, beta) != 0", "α × β = 0, (α, β) ≠ 0",
             None))),
        (Conditions(Locus(zero=("p_theta",), nonzero=(("q1",),)), are_vectors=False), "p_theta = 0, q1 != 0",
         "p_θ = 0, q₁ ≠ 0", r"p_{\theta} = 0, q_1 \neq 0"),
        *((Name(name), None, unicode, latex) for name, unicode, latex in (
            ("C1", "C₁", "C_1"),
            ("P'", "P'", "P'"),
            ("l.alpha", "l·α", r"\boldsymbol{\ell}\cdot \boldsymbol{\alpha}"),
            ("Lax 50%", "Lax 50%", r"\text{ Lax 50\% }"),
            ("K^2", "K²", "K^{2}"),
            ("m3+n3", "m₃+n₃", "m_3+n_3"))),
        (Ring("R[x,y]/(x,y)^2"), "R[x,y]/(x,y)^2", "R[x,y]/(x,y)²", r"\mathbb{R}[x,y]/(x,y)^{2}"),
        (Unequal(Formula(sp.Symbol("epsilon"))), "epsilon != 0", "ε ≠ 0", r"\epsilon \neq 0"),
        (Equation(Rate(VectorName("l")), Column((L3, L3))), "l' = (l3, l3)", "l′ = (l₃, l₃)", None),
        (Equation(Name("l3"), L3), "l3", "l₃", None),  # not l₃ = l₃
    ],
)  # fmt: skip
def test_pieces(piece, plain, unicode, latex):
    assert plain in (None, piece.write(PLAIN))
    assert piece.write(UNICODE) == unicode
    assert latex in (None, piece.write(LATEX))


def test_lines_and_long_formulas():
    assert write_line(("on ", L3, ": so(3) ⊗ A"), LATEX) == r"on $\ell_3$: so(3) $\otimes$ A"
    assert write_line(tuple(joined([L3, L3])), PLAIN) == "l3, l3"
    long = Formula(sp.Add(*sp.symbols("x1:41")))
    assert Equation(Name("H"), long).write(PLAIN).endswith("+ ... (28 more terms)")
