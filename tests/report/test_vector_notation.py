"""Vector notation is recognised where it is right, and only there."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.formula.styles import PLAIN
from liepoisson.report.vector_notation import VectorNotation, _Recognition, invariant_metric
from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import abelian, heisenberg, se, sl, so, su

BRACKET = so(3) @ leibniz(3, "epsilon")
NOTATION = VectorNotation(BRACKET)
l, alpha, beta = BRACKET.fields.values()
a, b = sp.Matrix(sp.symbols("a1:4")), sp.Matrix(sp.symbols("b1:4"))
inertia = sp.symbols("I1:4")
epsilon = sp.Symbol("epsilon")
A = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"A{i + 1}{j + 1}"))
symmetric = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S{min(i, j) + 1}{max(i, j) + 1}"))
kinetic = sum(l[i] ** 2 / (2 * inertia[i]) for i in range(3))


def plain(expression, notation=NOTATION):
    return notation.formula(sp.sympify(expression)).plain


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        (alpha.dot(alpha) + 2 * epsilon * l.dot(beta), "|alpha|^2 + 2 epsilon l.beta"),
        (kinetic + a.dot(alpha) + b.dot(beta), "1/2 l.I^-1 l + a.alpha + b.beta"),
        (l.dot(alpha) + epsilon * inertia[0] * a[2] * beta[2], "l.alpha + epsilon*I1*a3*beta3"),
        (l.dot(alpha.cross(beta)) / 3, "1/3 l.(alpha x beta)"),
        (l.dot(beta.cross(alpha)), "-l.(alpha x beta)"),
        (sum(inertia[i] * l[i] * alpha[i] for i in range(3)), "l.I alpha"),
        (l.dot(alpha) ** 2 - 1, "(l.alpha)^2 - 1"),
        (sp.sqrt(alpha.dot(alpha) + 1) * l[0], "sqrt(|alpha|^2 + 1)*l1"),
        (l[0] ** 2 + l[1] ** 2 + 2 * l[2] ** 2, "l1^2 + l2^2 + 2*l3^2"),
        (a[0] * alpha[0] + a[1] * alpha[1] + 2 * a[2] * alpha[2], "a1*alpha1 + a2*alpha2 + 2*a3*alpha3"),
        (sum(a[i] * l[i] / inertia[i] for i in range(3)) + kinetic, "1/2 l.I^-1 l + a.I^-1 l"),
        (sum(a[i] * l[i] / inertia[0] for i in range(3)), "1/I1 a.l"),
        (kinetic + (a[1] - a[2]) ** 2 * a[0] / 2 * beta[0] ** 2, "1/2 l.I^-1 l + (a2 - a3)^2*a1*beta1^2/2"),
        ((alpha - a).dot(alpha - a), "|alpha - a|^2"),
        ((alpha - a).dot(alpha - a) + a[0] ** 2, "|alpha|^2 - 2 a.alpha + 2*a1^2 + a2^2 + a3^2"),
        (l.dot(A.T * alpha), "alpha.A l"),
        (l.dot(symmetric * l), "l.S l"),
        (sp.sqrt(1 + l.dot(symmetric * alpha)), "sqrt(l.S alpha + 1)"),
        (l.dot(l) * l.dot(alpha) + alpha.dot(alpha), "|l|^2 (l.alpha) + |alpha|^2"),
    ],
)
def test_what_is_recognised(expression, text):
    assert plain(expression) == text


def test_a_matrix_with_one_entry_changed_is_not_mistaken():
    changed = A.copy()
    changed[0, 1] = A[1, 0]
    assert ".A " not in plain(l.dot(changed * alpha))
    assert ".A " not in plain(alpha.dot(A * alpha) + alpha[0] * alpha[1])


numbers = st.integers(-3, 3)
invariants = [l.dot(l), l.dot(alpha), alpha.dot(beta), beta.dot(beta), a.dot(l), b.dot(beta), l.dot(alpha.cross(beta))]


@settings(max_examples=20)
@given(st.lists(numbers, min_size=7, max_size=7), st.lists(numbers, min_size=9, max_size=9), st.booleans())
def test_formulas_equal_what_they_print(weights, linear, with_parameter):
    """The formal symbols, replaced by what they stand for, give the expression back."""
    expression = sum(w * i for w, i in zip(weights, invariants, strict=True))
    expression += sum(w * x for w, x in zip(linear, BRACKET.variables, strict=True))
    expression = sp.expand(expression * (epsilon if with_parameter else 1))
    recognition = _Recognition(NOTATION, expression)
    rewritten = recognition.rewrite(expression)
    assert sp.expand(rewritten.xreplace(recognition.meanings) - expression) == 0
    if any(weights[:4]):
        assert NOTATION.formula(expression).atoms


def test_a_wrong_recognition_is_printed_in_components(monkeypatch):
    monkeypatch.setattr(_Recognition, "meaning", lambda self, atom: sp.Integer(1))
    assert plain(alpha.dot(beta)) == "alpha1*beta1 + alpha2*beta2 + alpha3*beta3"


@pytest.mark.parametrize(
    ("algebra", "metric"),
    [
        (so(3), (1, 1, 1)),
        (so(2, 1), (1, 1, -1)),
        (so(4), (1,) * 6),
        (se(3), None),
        (heisenberg(1), None),
        (abelian(3), None),
        (sl(2), None),
        (su(2), (1, 1, 1)),
    ],
)
def test_invariant_metric(algebra, metric):
    assert invariant_metric(algebra) == metric


def test_one_dot_has_one_meaning():
    """With the product of so(2,1), a parameter's pairing with a field stays in components, and u.v is defined."""
    bracket = so(2, 1) @ semidirect(2)
    notation = VectorNotation(bracket)
    u, v = bracket.fields.values()
    assert plain(a.dot(v), notation) == "a1*alpha1 + a2*alpha2 + a3*alpha3"
    assert plain(-(v[0] ** 2) - v[1] ** 2 + v[2] ** 2, notation) == "-|alpha|^2"
    assert plain(u.dot(v), notation) == "l1*alpha1 + l2*alpha2 + l3*alpha3"
    weighted = sum(a[i] * u[i] / inertia[i] for i in range(3))
    assert "." not in plain(weighted, notation)
    product, square = u[0] * v[0] + u[1] * v[1] - u[2] * v[2], u[0] ** 2 + u[1] ** 2 - u[2] ** 2
    meaning = "u.v = u1*v1 + u2*v2 - u3*v3"

    def defined(*expressions, by=notation):
        return [d.write(PLAIN) for d in by.definitions(by.formula(sp.sympify(e)) for e in expressions)]

    assert defined(product) == [meaning]
    assert defined(product, square) == defined(square) == [meaning, "|u|^2 = u.u"]
    assert defined(a.dot(v), u[0] ** 2) == []
    assert defined(l.dot(alpha), alpha.dot(alpha), by=NOTATION) == []


def test_parameters_beside_single_coordinates_keep_their_names():
    shown = str(lp.System(lp.canonical(names=["x"]), "p_x^2/2 + k1*x", {"k1": 2}))
    assert "H = x*k1 + p_x^2/2" in shown
