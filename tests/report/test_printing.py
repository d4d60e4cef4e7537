"""Formulas in four styles; that they mean what they should is tested in test_vector_notation.py."""

import re
from fractions import Fraction
from itertools import accumulate

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.formula.styles import LATEX, NAMES, PLAIN, UNICODE, latex_text, split_name
from liepoisson.report.lines import (
    Equation,
    Name,
    Statement,
    column,
    joined,
    rate,
    ring,
    unequal,
    vector_name,
    wrapped,
    write_line,
)
from liepoisson.report.printing import (
    Cross,
    Decimal,
    Dot,
    Form,
    Formula,
    Gradient,
    Image,
    Itself,
    Shifted,
    Square,
    Triple,
    write_atom,
    write_vector,
)
from liepoisson.structure.locus import Locus

FIELDS = ("l", "alpha", "beta")
COORDINATES = {f"{f}{i}": (f, str(i)) for f in FIELDS for i in (1, 2, 3)}
l1, l2, l3, alpha1, alpha2 = sp.symbols("l1 l2 l3 alpha1 alpha2")
I1, I3, a3, epsilon = sp.symbols("I1 I3 a3 epsilon")
square, dot, cross, image, shifted = sp.symbols("SQUARE DOT CROSS IMAGE SHIFTED")
ATOMS = {
    square: Square("alpha"),
    dot: Dot("l", "beta"),
    cross: Cross("beta", "a"),
    image: Image("I", -1, "l"),
    shifted: Itself(Shifted("alpha", -1, "r")),
}
HALF = sp.Rational(1, 2)


def formula(expression):
    return Formula(sp.sympify(expression), ATOMS, COORDINATES)


@pytest.mark.parametrize(
    ("expression", "plain", "unicode", "latex"),
    [
        (
            square + 2 * epsilon * dot,
            "|alpha|^2 + 2 epsilon l.beta",
            "|α|² + 2ε l·β",
            r"|\boldsymbol{\alpha}|^{2} + 2 \epsilon\,\boldsymbol{\ell}\cdot \boldsymbol{\beta}",
        ),
        (l1**2 / 4 - alpha1, "l1^2/4 - alpha1", "l₁²/4 - α₁", r"\frac{\ell_1^{2}}{4} - \alpha_1"),
        (-l1 * l2 / (2 * I3), "-l1*l2/(2*I3)", "-l₁ l₂/(2I₃)", r"-\frac{\ell_1 \ell_2}{2 I_3}"),
        (
            dot + epsilon * I1 * a3 * l3,
            "l.beta + epsilon*I1*a3*l3",
            "l·β + ε I₁ a₃ l₃",
            r"\boldsymbol{\ell}\cdot \boldsymbol{\beta} + \epsilon I_1 a_3 \ell_3",
        ),
        (square**2 * dot, "|alpha|^4 (l.beta)", "|α|⁴ (l·β)", None),
        ((dot + 1) ** 2 * (l1 + 1), "(l.beta + 1)^2*(l1 + 1)", "(l·β + 1)² (l₁ + 1)", None),
        (sp.sqrt(1 + l1**2) / l2, "sqrt(l1^2 + 1)/l2", "√(l₁² + 1)/l₂", r"\frac{\sqrt{\ell_1^{2} + 1}}{\ell_2}"),
        (l1 ** sp.Rational(-3, 2), "1/sqrt(l1)^3", "1/√(l₁)³", r"\frac{1}{\sqrt{\ell_1}^{3}}"),
        (sp.exp(-l2) * sp.sin(l1), "exp(-l2)*sin(l1)", "exp(-l₂) sin(l₁)", None),
        (2**l1, "2^l1", "2^(l₁)", "2^{\\ell_1}"),
        (epsilon * cross, "epsilon beta x a", "ε β × a", r"\epsilon\,\boldsymbol{\beta}\times \boldsymbol{a}"),
        (sp.Symbol("beta_e") * l1, "beta_e*l1", "β_e l₁", r"\beta_e \ell_1"),
        (3 * sp.sqrt(3) * l1, "3*sqrt(3)*l1", "3√3 l₁", r"3 \sqrt{3} \ell_1"),
        (l1 / sp.sqrt(square) ** 3, "l1/|alpha|^3", "l₁/|α|³", None),
        (image / (2 * sp.sqrt(l1)), "I^-1 l/(2*sqrt(l1))", "I⁻¹l/(2√(l₁))", None),
        (l1 * shifted / square, "l1*(alpha - r)/|alpha|^2", "l₁ (α - r)/|α|²", None),
        (0, "0", "0", "0"),
        (-(l1 + l2), "-l1 - l2", "-l₁ - l₂", r"-\ell_1 - \ell_2"),
    ],
)
def test_formulas_in_three_styles(expression, plain, unicode, latex):
    written = formula(expression)
    assert written.plain == str(written) == plain
    assert written.unicode == unicode
    assert latex is None or written.latex == latex


@pytest.mark.parametrize(
    ("atom", "plain", "unicode", "latex"),
    [
        (Form("l", "I", -1, "l"), "l.I^-1 l", "l·I⁻¹l", r"\boldsymbol{\ell}\cdot I^{-1}\boldsymbol{\ell}"),
        (Form("l", "M", 1, "p"), "l.M p", "l·M p", r"\boldsymbol{\ell}\cdot M\boldsymbol{p}"),
        (Image("I", -1, "l"), "I^-1 l", "I⁻¹l", r"I^{-1}\boldsymbol{\ell}"),
        (Triple("a", "l", "psi"), "a.(l x psi)", "a·(l × ψ)", None),
        (Cross("l", Gradient("beta")), "l x dH/dbeta", "l × ∂H/∂β", None),
    ],
)
def test_vector_expressions(atom, plain, unicode, latex):
    assert write_atom(atom, PLAIN) == plain
    assert write_atom(atom, UNICODE) == unicode
    assert latex is None or write_atom(atom, LATEX) == latex


def test_fields_with_a_number_keep_it_apart_from_the_component():
    assert write_vector("x0", LATEX) == r"\boldsymbol{x}_0"
    x01 = Formula(sp.Symbol("x01"), {}, {"x01": ("x0", "1")})
    assert (x01.plain, x01.unicode, x01.latex) == ("x01", "x₀₁", "x_{0,1}")
    M12 = Formula(sp.Symbol("M12"), {}, {"M12": ("M", "12")})
    assert (M12.unicode, M12.latex) == ("M₁₂", "M_{12}")
    wc1m1 = Formula(sp.Symbol("wc1m1"), {}, {"wc1m1": ("w", "c1m1")})
    assert (wc1m1.unicode, wc1m1.latex) == ("wc1m1", r"w_{\mathrm{c1m1}}")


@pytest.mark.parametrize(
    ("written", "text"),
    [
        (formula(square + 2 * epsilon * dot).write(NAMES), "|alpha|^2 + 2 epsilon l·beta"),
        (Formula(sum(sp.symbols("x1:31"))).write(PLAIN, most_terms=3), "x1 + x10 + x11 + ... (27 more terms)"),
        (Formula(10**200 * l1).write(PLAIN), "1e200*l1"),
        (Formula(sp.Rational(15, 10**321) * l1).write(PLAIN), "1.5e-320*l1"),
        (Formula(10**200 * l1).write(LATEX), r"10^{200} \ell_1"),
        (Formula(sp.Rational(1, 3 * 10**20) * l1).write(PLAIN), "1e-20*l1/3"),
        (PLAIN.words("so(3) ⊗ A, Poincaré — 1910"), "so(3) (x) A, Poincare - 1910"),
        (latex_text(r"100% of $x_1 & {y} #2 \z ^~"),
         r"100\% of \$x\_1 \& \{y\} \#2 \textbackslash{}z \textasciicircum{}\textasciitilde{}"),
        *((split_name(name), parts) for name, parts in (("a3", ("a", "3")), ("x_12", ("x", "12")))),
    ],
)  # fmt: skip
def test_texts(written, text):
    assert written == text


@given(st.integers(-(10**20), 10**20), st.integers(-340, 340))
def test_decimals_are_exact(mantissa, exponent):
    value = Fraction(mantissa) * Fraction(10) ** exponent
    written = Decimal.of(value)
    assert written is not None
    assert Fraction(written.write(PLAIN)) == value
    assert len(written.write(PLAIN)) < 30
    assert Decimal.of(Fraction(1, 3)) is None


leaves = st.sampled_from([l1, l2, alpha1, epsilon, I1, sp.Integer(2), sp.Rational(-1, 3), sp.Integer(-1)])
trees = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.builds(lambda a, b: a + b, inner, inner),
        st.builds(lambda a, b: a * b, inner, inner),
        st.builds(lambda a, n: a**n, inner.filter(lambda a: a != 0), st.integers(-2, 3)),
        st.builds(lambda a: sp.sqrt(a**2 + 1), inner),
        st.builds(sp.sin, inner),
    ),
    max_leaves=8,
)


@settings(max_examples=40)
@given(trees)
def test_plain_components_read_back_as_the_same_expression_and_braces_balance(expression):
    """The printed text is in the grammar of system files, and means what was printed."""
    scope = Scope({"l": "123", "alpha": "123"}, {}, ["epsilon", "I[3]"])
    written = Formula(expression, {}, COORDINATES)
    read = read_expression(written.plain, scope)
    point = {l1: 0.3, l2: -1.2, alpha1: 0.7, epsilon: 1.1, I1: 2.3}
    assert complex(read.subs(point)) == pytest.approx(complex(expression.subs(point)), rel=1e-9, abs=1e-9)
    braces = re.findall(r"(?<!\\)[{}]", written.latex)
    depths = list(accumulate(1 if brace == "{" else -1 for brace in braces))
    assert min(depths, default=0) >= 0
    assert depths[-1:] in ([], [0])
    assert written.latex.count(r"\left") == written.latex.count(r"\right")


KNOWN = (frozenset({"l", "alpha", "beta", "x"}), frozenset({"epsilon", "l1"}))
PAIR = ("alpha", "beta")
L3 = Formula(sp.Symbol("l3"), {}, {"l3": ("l", "3")})


@pytest.mark.parametrize(
    ("piece", "plain", "unicode", "latex"),
    [
        *((Statement(statement, *KNOWN), statement, unicode, latex) for statement, unicode, latex in (
            ("alpha -> s^2*alpha + d*beta", "α → s² α + d β", None),
            ("l -> s^(-1)*l", "l → s⁻¹ l", None),
            ("epsilon = 0", "ε = 0", r"\epsilon = 0"),
            ("alpha -> s*alpha takes epsilon to s^2*epsilon", "α → s α takes ε to s² ε", None))),
        *((Statement(str(locus), *KNOWN), plain, unicode, latex) for locus, plain, unicode, latex in (
            (Locus(zero=("beta",), nonzero=(("alpha",),)), "beta = 0, alpha != 0", "β = 0, α ≠ 0",
             r"\boldsymbol{\beta} = 0, \boldsymbol{\alpha} \neq 0"),
            (Locus(not_parallel=(PAIR,)), "alpha x beta != 0", "α × β ≠ 0", None),
            (Locus(parallel=(PAIR,), nonzero=(PAIR,)), "alpha x beta = 0, (alpha, beta) != 0", "α × β = 0, (α, β) ≠ 0",
             None))),
        (Statement("p_theta = 0, q1 != 0", frozenset(), frozenset({"p_theta", "q1"})), "p_theta = 0, q1 != 0",
         "p_θ = 0, q₁ ≠ 0", r"p_{\theta} = 0, q_1 \neq 0"),
        *((Name(name), None, unicode, latex) for name, unicode, latex in (
            ("C1", "C₁", "C_1"),
            ("P'", "P'", "P'"),
            ("l.alpha", "l·α", r"\boldsymbol{\ell}\cdot \boldsymbol{\alpha}"),
            ("Lax 50%", "Lax 50%", r"\text{ Lax 50\% }"),
            ("K^2", "K²", "K^{2}"),
            ("m3+n3", "m₃+n₃", "m_3+n_3"))),
        (ring("R[x,y]/(x,y)^2"), "R[x,y]/(x,y)^2", "R[x,y]/(x,y)²", r"\mathbb{R}[x,y]/(x,y)^{2}"),
        (unequal(Formula(sp.Symbol("epsilon"))), "epsilon != 0", "ε ≠ 0", r"\epsilon \neq 0"),
        (Equation(rate(vector_name("l")), column((L3, L3))), "l' = (l3, l3)", "l′ = (l₃, l₃)", None),
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


x = sp.symbols("x1:13")


def rows(formula, width=30, style=PLAIN):
    return wrapped((formula,), style, width)


def test_sums_are_broken_before_signs():
    assert rows(Equation(Name("H"), Formula(sp.Add(*x[:6])))) == ["H = x1 + x2 + x3 + x4 + x5", "    + x6"]


def test_parentheses_are_broken_only_if_they_must_and_between_components_first():
    square = Formula((x[0] + x[1]) ** 2 + (x[2] + x[3]) ** 2)
    assert rows(square, 20) == ["(x1 + x2)^2", "    + (x3 + x4)^2"]
    written = column((Formula(x[0] + x[1]), Formula(x[2] + x[3]), Formula(x[4])))
    assert rows(written, 20) == ["(x1 + x2, x3 + x4,", "    x5)"]
    assert rows(written, 9) == ["(x1 + x2,", "    x3", "    + x4,", "    x5)"]


@settings(max_examples=40)
@given(st.lists(st.integers(-9, 9), min_size=12, max_size=12), st.integers(12, 60))
def test_nothing_is_lost_and_no_row_is_too_long(weights, width):
    formula = Formula(sp.Add(*(w * v for w, v in zip(weights, x, strict=True))))
    written = rows(formula, width)
    assert " ".join(row.strip() for row in written) == formula.plain
    assert max(map(len, written)) <= width
