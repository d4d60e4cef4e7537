"""Gradients by the chain rule: written in vectors where this is right, and only there."""

import pytest
import sympy as sp

from liepoisson.formula.styles import UNICODE
from liepoisson.report import vector_equations
from liepoisson.report.vector_equations import vector_gradient
from liepoisson.report.vector_notation import VectorNotation
from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so

BRACKET = so(3) @ semidirect(2)
NOTATION = VectorNotation(BRACKET)
l, alpha = BRACKET.fields.values()
inertia, r = sp.symbols("I1:4"), sp.Matrix(sp.symbols("r1:4"))
kinetic = sum(l[i] ** 2 / inertia[i] for i in range(3))
S = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S{min(i, j) + 1}{max(i, j) + 1}"))
A = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"A{i + 1}{j + 1}"))
mu = sp.Symbol("mu")


def written(hamiltonian, field):
    formula = vector_gradient(NOTATION, hamiltonian, field)
    return formula and formula.write(UNICODE)


@pytest.mark.parametrize(
    ("hamiltonian", "along_l", "along_alpha"),
    [
        (sp.sqrt(1 + kinetic), "I⁻¹l/√(l·I⁻¹l + 1)", None),
        (-mu / sp.sqrt((alpha - r).dot(alpha - r)), None, "μ (α - r)/|α - r|³"),
        (sp.exp(r.dot(alpha)) * l.dot(l), "2exp(r·α) l", "exp(r·α) |l|² r"),
        (sp.sqrt(1 + l.dot(alpha)), "α/(2√(l·α + 1))", "l/(2√(l·α + 1))"),
        (sp.sin(alpha.dot(S * alpha)), None, "2cos(α·S α) S α"),
        (sp.sin(r.dot(l.cross(alpha))), "cos(r·(l × α)) α × r", "cos(r·(l × α)) r × l"),
    ],
)
def test_gradients(hamiltonian, along_l, along_alpha):
    assert written(hamiltonian, "l") == along_l
    assert written(hamiltonian, "alpha") == along_alpha


@pytest.mark.parametrize(
    "hamiltonian",
    [
        sp.sqrt(1 + l.dot(l)) + l[2],  # a component besides
        l[0] ** 2 + l[1] ** 3,  # nothing recognised
        sp.sin(l.dot(A * l)),  # A need not be symmetric: the gradient is that of (A + A^T)/2
        sp.Symbol("l1"),
    ],
)
def test_what_is_no_function_of_scalars_is_left_in_components(hamiltonian):
    assert written(hamiltonian, "l") is None


def test_a_wrong_derivative_is_not_printed(monkeypatch):
    right = vector_equations._derivative

    def wrong(atom, field):
        return ((2 * n, v) for n, v in right(atom, field))

    assert written(sp.sqrt(1 + l.dot(l)), "l") is not None
    monkeypatch.setattr(vector_equations, "_derivative", wrong)
    assert written(sp.sqrt(1 + l.dot(l)), "l") is None


def test_the_metric_of_so21_is_not_forgotten():
    """The gradient of |l|^2 = l1^2 + l2^2 - l3^2 is not 2 l."""
    bracket = so(2, 1) @ leibniz(1)
    x = bracket.variables
    assert vector_gradient(VectorNotation(bracket), sp.sqrt(1 + x[0] ** 2 + x[1] ** 2 - x[2] ** 2), "l") is None
