import pickle
from fractions import Fraction

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so

EPSILON = sp.Symbol("epsilon")


def hat(u):
    """The matrix of v -> u x v."""
    return sp.Matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def test_the_poisson_tensor_of_the_twisted_top():
    bracket = so(3) @ leibniz(3, "epsilon")
    l, alpha, beta = (hat(v) for v in bracket.fields.values())
    zero = sp.zeros(3, 3)
    expected = sp.Matrix(sp.BlockMatrix([[l, alpha, beta], [alpha, EPSILON * beta, zero], [beta, zero, zero]]))
    assert bracket.poisson_tensor() == expected


def test_the_bracket_is_the_formula_of_the_paper():
    bracket = so(3) @ leibniz(3, "epsilon")
    l, alpha, beta = bracket.fields.values()
    f = l[0] * alpha[1] + beta[2] ** 2 * l[2] + alpha[0] * alpha[2]
    g = l[1] ** 2 + alpha[2] * beta[0] + alpha[1] * l[2]

    def gradient(h, v):
        return sp.Matrix([h.diff(component) for component in v])

    f_l, f_a, f_b = (gradient(f, v) for v in (l, alpha, beta))
    g_l, g_a, g_b = (gradient(g, v) for v in (l, alpha, beta))
    semi = -l.dot(f_l.cross(g_l)) - alpha.dot(f_l.cross(g_a) + f_a.cross(g_l))
    semi -= beta.dot(f_l.cross(g_b) + f_b.cross(g_l))
    assert sp.expand(bracket(f, g) - semi + EPSILON * beta.dot(f_a.cross(g_a))) == 0
    assert sp.expand((so(3) @ semidirect(3))(f, g) - semi) == 0


def test_entries_are_the_upper_half_of_the_poisson_tensor():
    bracket = so(3) @ leibniz(3, "epsilon")
    J = sp.zeros(9, 9)
    for i, j, m, c in bracket.entries():
        assert i < j
        J[i, j] += c * bracket.variables[m]
        J[j, i] -= c * bracket.variables[m]
    assert bracket.poisson_tensor() == J
    assert all(isinstance(c, Fraction) for *_, c in (so(3) @ leibniz(3)).entries())


@pytest.mark.parametrize(
    ("extension", "point", "rank"),
    [
        # epsilon != 0: rank 6 whenever beta != 0, also where alpha is parallel to beta
        (leibniz(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 6),
        (leibniz(3, "epsilon"), (0, 0, 0, 0, 0, 0, 0, 0, 1), 6),
        (leibniz(3), (1, 2, -1, 0, "1/3", 2, 0, 0, 0), 4),
        (leibniz(3), (1, 2, -1, 0, 0, 0, 0, 0, 0), 2),
        (leibniz(3), (0,) * 9, 0),
        (leibniz(3), (1, 0, 2, sp.sqrt(2), 0, 0, 0, 0, 0), 4),
        # epsilon = 0: rank 6 only where alpha x beta != 0
        (semidirect(3), (1, 2, -1, 0, 0, 2, 0, 0, 1), 4),
        (semidirect(3), (1, 2, -1, 0, 1, 2, 0, 0, 1), 6),
    ],
)
def test_rank_at_a_point(extension, point, rank):
    bracket = so(3) @ extension
    assert bracket.rank(point) == rank
    assert bracket.corank(point) == 9 - rank
    values = dict(zip(bracket.variables, map(sp.sympify, point), strict=True))
    assert bracket.poisson_tensor().subs(values).rank() == rank


TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")


def test_coefficients_of_functions_stay():
    l1, l2, *_ = TWISTED.variables
    a, epsilon, V = sp.Symbol("a"), sp.Symbol("epsilon"), sp.Function("V")
    assert TWISTED(l2, a * l1) == sp.expand(a * TWISTED(l2, l1))
    assert TWISTED(l2, epsilon * l1) == sp.expand(epsilon * TWISTED(l2, l1))
    assert TWISTED(l2, V(l1)) == V(l1).diff(l1) * TWISTED(l2, l1)
    scaling = lp.brackets.Automorphism(((1, 0, 0), (0, 2, 0), (0, 0, 4)))
    doubled = scaling.apply(sp.Symbol("alpha1", positive=True), TWISTED)
    assert doubled == 2 * TWISTED.variables[3]
    system = lp.System(lp.so(3) @ lp.trivial(), "L1*l1^2 + l2^2", symbols=["L1"])
    for one in (system, pickle.loads(pickle.dumps(system))):
        assert one.bracket(one.hamiltonian, one.variables[2]) != 0
        assert sp.Symbol("L1") in one.equations[one.variables[1]].free_symbols


def test_copies_and_renamed_brackets():
    TWISTED.casimir_report()
    again = pickle.loads(pickle.dumps(TWISTED))
    assert again.entries() == TWISTED.entries()
    assert set(again.__dict__) <= {"algebra", "extension", "constant", "_name", "_terms"}
    bracket = (so(3) @ leibniz(2)).rename("m", "p")
    assert (bracket.coordinate_names_in_order, bracket.field_lengths) == (("m1", "m2", "m3", "p1", "p2", "p3"), (3, 3))
    m, p = bracket.fields.values()
    assert bracket.casimirs() == [m.dot(p), p.dot(p)]
    for key in ("epsilon", sp.Symbol("epsilon"), sp.Symbol("epsilon", positive=True)):
        assert TWISTED.substitute({key: 2}).symbols == set()
