"""Local monodromy: exponents and single-valued solutions, against equations whose solutions are known."""

import pytest
import sympy as sp

from liepoisson.errors import ParameterError
from liepoisson.studies.twisted_top.claims.variational import exponents, laurent_solutions, taylor, weighted

p = sp.Symbol("p")


@pytest.mark.parametrize("order", [0, 1, 2, 5])
def test_bessel_equation_of_integer_order_has_one_single_valued_solution(order):
    # u = (f, p f'), p^2 f'' + p f' + (p^2 - n^2) f = 0: J_n is entire, Y_n has a logarithm.
    system = sp.Matrix([[0, 1], [order**2 - p**2, 0]])
    assert set(exponents(system, p)) == {sp.Integer(order), sp.Integer(-order)}
    assert laurent_solutions(system, p) == 1


def test_euler_equations_have_all_powers():
    system = sp.diag(2, -3, sp.Rational(1, 2))
    assert exponents(system, p) == {2: 1, -3: 1, sp.Rational(1, 2): 1}
    assert laurent_solutions(system, p) == 2


def test_a_jordan_block_loses_one_solution():
    assert laurent_solutions(sp.Matrix([[1, 1], [0, 1]]), p) == 1


def test_a_resonance_is_free_of_a_logarithm_only_for_one_coefficient():
    # p u1' = 0, p u2' = u2 + c p u1: u2 = c p ln p + ... unless c = 0.
    assert [laurent_solutions(sp.Matrix([[0, 0], [c * p, 1]]), p) for c in (0, 1, sp.I)] == [2, 1, 1]


def test_taylor_coefficients_of_a_rational_function():
    function = p * (1 + p) / (p * (sp.I - p))
    expected = sp.series((1 + p) / (sp.I - p), p, 0, 4).removeO()
    assert [sp.QQ_I.to_sympy(c) for c in taylor(function, p, 4)] == [sp.expand(expected).coeff(p, k) for k in range(4)]
    with pytest.raises(ParameterError, match="pole"):
        taylor(1 / p, p, 3)


def test_weights_turn_a_double_pole_into_a_simple_one():
    # f'' = 2 f / t^2 as (f, f'): solutions t^2 and 1/t; with weights 1 and 2 the system is p u' = B u.
    A = sp.Matrix([[0, 1], [2 / p**2, 0]])
    system = weighted(A, (1, 2), p, sp.Integer(1))
    assert exponents(system, p) == {3: 1, 0: 1}
    assert laurent_solutions(system, p) == 2
