"""Texts of users in figures: every text is drawn, and drawn as it is."""

import warnings

import pytest
from hostile_names import FAMOUS, REFUSED
from matplotlib.cbook import is_math_text
from matplotlib.mathtext import MathTextParser

from liepoisson.plot.formulas import formula, number
from liepoisson.plot.labels import LONGEST, label, plain, symbol, with_formulas
from liepoisson.plot.style import house_style, new_figure

TEXTS = [
    r"$\nosuch{y}$", "$", "$$", "a$b$c", "\\$", "$" + "{" * 300 + "x" + "}" * 300 + "$", r"\frac{", "a__b", "^_{}%&#~",
    "a\nb\tc", "\x00\x1b[31m", "\udcff", "\u202eabc", "n" * 200_000, "", " ", "_hidden", "e\u0301", "\U0001f600",
]  # fmt: skip


def test_plain_text_is_never_mathematical_text():
    for text in [*TEXTS, *FAMOUS, *REFUSED]:
        assert not is_math_text(plain(text))
        assert len(plain(text)) <= 2 * LONGEST
        assert plain(text).replace(r"\$", "").isprintable()
    assert plain("a$b$c").replace(r"\$", "$") == "a$b$c"
    assert plain("n" * 300, 10) == "nnnnnnnn …"


def test_names_are_mathematical_text_that_can_be_read():
    parser = MathTextParser("path")
    for name in [*FAMOUS, *REFUSED, *TEXTS, "a__b1", "alpha_12", "_1", "p_theta"]:
        parser.parse(f"${symbol(name)}$")
        shown = label(name)
        if is_math_text(shown):
            parser.parse(shown)
    assert (label("alpha1"), label("l_12"), label("Casimir2")) == (
        r"$\alpha_{1}$",
        r"$\ell_{12}$",
        r"$\mathrm{Casimir}_{2}$",
    )
    assert label("ws1m2") == r"$\mathrm{Im}\,w_{1,{-}2}$"
    assert label("psic10_m3") == r"$\mathrm{Re}\,\psi_{10,{-}3}$"
    assert label("alphas12") == r"$\mathrm{alphas}_{12}$"
    assert label("dot(l, l) - 1") == "dot(l, l) - 1"
    assert label("_a") == r"$\mathrm{\_a}$"


@pytest.mark.parametrize("text", TEXTS)
def test_labels_that_cannot_be_read_are_plain_text(text):
    shown = with_formulas(text)
    assert shown == plain(text) or not is_math_text(text) or shown == text
    with house_style(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that no font has
        figure = new_figure(3, 2)
        ax = figure.add_subplot()
        ax.set_xlabel(shown)
        ax.set_title(f"{plain(text)}: {label(text)} = 0")
        ax.plot([0, 1], [0, 1], label=label(text))
        figure.canvas.draw()


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("l3", r"$\ell_{3}$"),
        ("(-1)*(alpha2*beta3 - alpha3*beta2)", r"$-(\alpha_{2}\,\beta_{3} - \alpha_{3}\,\beta_{2})$"),
        ("-dot(l, beta) - 1/2", r"$-\ell\cdot \beta - 1/2$"),
        ("2*dot(l, cross(alpha, beta))^2", r"$2\,(\ell\cdot (\alpha\times \beta))^{2}$"),
        ("a - (b - c)/(d*e)", r"$a - (b - c)/(d\,e)$"),
        ("sqrt(l[1]^2 + 1e-3*2)", r"$\sqrt{{\ell}_{1}^{2} + (1\times 10^{-3})\cdot 2}$"),
        ("sin(l1)**2 + atan2(l1, -l2)", r"$\sin(\ell_{1})^{2} + \mathrm{atan2}(\ell_{1}, -\ell_{2})$"),
        ("(x^2)^3 - (-x)", "$(x^{2})^{3} - (-x)$"),
        ("-(-1)*x + (a/b)/c", r"$-(-1)\,x + (a/b)/c$"),
        ("p_theta", r"$p_{\theta}$"),
        ("p_y^2", r"$p_{y}^{2}$"),
        ("p_theta12 + w_max", r"$p_{\theta_{12}} + w_{\mathrm{max}}$"),
        ("half_width", "half_width"),
        ("a_b_c", "a_b_c"),
        ("l.alpha", "l.alpha"),
    ],
)
def test_formulas_are_mathematical_text(text, shown):
    assert formula(text) == shown


def test_numbers_have_a_minus_sign_and_powers_of_ten():
    assert [number(value) for value in (-0.633009, 1.25e-7, 2.0, float("inf"))] == [
        "-0.633", r"1.25\times 10^{-7}", "2", r"\infty",
    ]  # fmt: skip
