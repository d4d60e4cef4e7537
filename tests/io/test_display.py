"""What a notebook shows of objects that are no results."""

import pytest

import liepoisson as lp
from liepoisson.io.display import as_line, as_table, as_text


def test_text_is_escaped_and_tables_have_a_head():
    assert as_line("<Leaf & more>") == "<p><code>&lt;Leaf &amp; more&gt;</code></p>"
    assert as_text("a\n  <b") == "<pre>a\n  &lt;b</pre>"
    assert as_table([("a", "b"), ("1", "<2")]) == (
        "<table><thead><tr><th>a</th><th>b</th></tr></thead><tbody><tr><td>1</td><td>&lt;2</td></tr></tbody></table>"
    )
    assert as_table([("a", "b")]) == ""


def test_a_bracket_shows_its_poisson_tensor():
    shown = (lp.so(3) @ lp.trivial())._repr_latex_()
    assert shown.startswith(r"$$J(\ell_1, \ell_2, \ell_3) = \begin{pmatrix}")
    assert r"0 & -\ell_3 & \ell_2 \\" in shown  # {l1, l2} = -l3
    gyrostat = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k"})
    assert "k" in gyrostat._repr_latex_()
    assert (lp.su(4) @ lp.trivial())._repr_latex_() is None


def test_a_lie_algebra_shows_the_brackets_of_its_basis():
    shown = lp.algebras.se(2)._repr_latex_()
    assert r"[e_{r}, e_{t1}] &= e_{t2}" in shown
    assert r"[e_{t1}, e_{t2}]" not in shown  # 0
    assert "[e_i, e_j] = 0" in lp.algebras.abelian(2)._repr_latex_()
    assert lp.su(5)._repr_latex_() is None


@pytest.fixture(scope="module")
def leaf():
    return lp.Leaf(lp.catalog.system("lagrange"), {"C1": "1/5", "C2": 1})


def test_a_leaf_shows_its_casimirs(leaf):
    shown = leaf._repr_html_()
    assert shown.startswith("<p><code>&lt;Leaf of dimension 4")
    assert "<td>C1</td>" in shown
    assert "<td>0.2</td>" in shown
    assert "alpha1*l1" in shown
