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


@pytest.mark.parametrize(
    ("statement", "unicode", "latex"),
    [
        ("alpha -> s^2*alpha + d*beta", "α → s² α + d β", None),
        ("l -> s^(-1)*l", "l → s⁻¹ l", None),
        ("epsilon = 0", "ε = 0", r"\epsilon = 0"),
        ("alpha -> s*alpha takes epsilon to s^2*epsilon", "α → s α takes ε to s² ε", None),
    ],
)
def test_statements(statement, unicode, latex):
    piece = Statement(statement, *NAMES)
    assert piece.write(UNICODE) == unicode
    assert latex is None or piece.write(LATEX) == latex


PAIR = ("alpha", "beta")


@pytest.mark.parametrize(
    ("locus", "unicode", "latex"),
    [
        (
            Locus(zero=("beta",), nonzero=(("alpha",),)),
            "β = 0, α ≠ 0",
            r"\boldsymbol{\beta} = 0, \boldsymbol{\alpha} \neq 0",
        ),
        (Locus(not_parallel=(PAIR,)), "α × β ≠ 0", r"\boldsymbol{\alpha}\times \boldsymbol{\beta} \neq 0"),
        (
            Locus(parallel=(PAIR,), nonzero=(PAIR,)),
            "α × β = 0, (α, β) ≠ 0",
            r"\boldsymbol{\alpha}\times \boldsymbol{\beta} = 0, "
            r"\left(\boldsymbol{\alpha}, \boldsymbol{\beta}\right) \neq 0",
        ),
        (Locus(zero=("l",), nonzero=(("x",),)), "l = 0, x ≠ 0", None),
    ],
)
def test_conditions_on_vectors(locus, unicode, latex):
    piece = Conditions(locus, are_vectors=True)
    assert (piece.write(PLAIN), piece.write(UNICODE)) == (str(locus), unicode)
    assert latex is None or piece.write(LATEX) == latex


def test_conditions_on_scalars():
    piece = Conditions(Locus(zero=("p_theta",), nonzero=(("q1",),)), are_vectors=False)
    assert piece.write(UNICODE) == "p_θ = 0, q₁ ≠ 0"
    assert piece.write(LATEX) == r"p_{\theta} = 0, q_1 \neq 0"


@pytest.mark.parametrize(
    ("name", "unicode", "latex"),
    [
        ("C1", "C₁", "C_1"),
        ("P'", "P'", "P'"),
        ("l.alpha", "l·α", r"\boldsymbol{\ell}\cdot \boldsymbol{\alpha}"),
        ("Lax 50%", "Lax 50%", r"\text{ Lax 50\% }"),
        ("K^2", "K²", "K^{2}"),
        ("m3+n3", "m₃+n₃", "m_3+n_3"),
        ("energy-like", "energy-like", r"\text{ energy-like }"),
    ],
)
def test_names_of_scalars(name, unicode, latex):
    assert Name(name).write(UNICODE) == unicode
    assert Name(name).write(LATEX) == latex


@pytest.mark.parametrize(
    ("piece", "plain", "unicode", "latex"),
    [
        (Ring("R[x,y]/(x,y)^2"), "R[x,y]/(x,y)^2", "R[x,y]/(x,y)²", r"\mathbb{R}[x,y]/(x,y)^{2}"),
        (Ring("C + R"), "C + R", "C + R", r"\mathbb{C} + \mathbb{R}"),
        (Unequal(Formula(sp.Symbol("epsilon"))), "epsilon != 0", "ε ≠ 0", r"\epsilon \neq 0"),
    ],
)
def test_rings_and_inequalities(piece, plain, unicode, latex):
    assert (piece.write(PLAIN), piece.write(UNICODE), piece.write(LATEX)) == (plain, unicode, latex)


def test_equations_and_columns():
    l3 = Formula(sp.Symbol("l3"), {}, {"l3": ("l", "3")})
    assert Equation(Rate(VectorName("l")), Column((l3, l3))).write(UNICODE) == "l′ = (l₃, l₃)"
    assert Equation(Name("l3"), l3).write(UNICODE) == "l₃"  # not l₃ = l₃
    assert write_line(("on ", l3, ": so(3) ⊗ A"), LATEX) == r"on $\ell_3$: so(3) $\otimes$ A"
    assert write_line(tuple(joined([l3, l3])), PLAIN) == "l3, l3"


def test_long_formulas_are_cut_in_equations():
    xs = sp.symbols("x1:41")
    assert Equation(Name("H"), Formula(sp.Add(*xs))).write(PLAIN).endswith("+ ... (28 more terms)")
