"""Exponents, logarithms and local monodromy, against equations whose solutions are known."""

from fractions import Fraction

import pytest
import sympy as sp
from flint import fmpq_poly

from liepoisson.algebra.function_fields import root_text
from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.integrability import linear_system

p, s = sp.symbols("p s")
ORIGIN = fmpq_poly([0, 1])


def at_origin(B):
    """The system p u' = B u at p = 0."""
    return linear_system(sp.Matrix(B) / p, p).local(ORIGIN)


@pytest.mark.parametrize("order", [0, 2])
def test_bessel_equation_of_integer_order_has_one_single_valued_solution(order):
    # u = (f, p f'), p^2 f'' + p f' + (p^2 - n^2) f = 0: J_n is entire, Y_n has a logarithm.
    local = at_origin([[0, 1], [order**2 - p**2, 0]])
    assert local.exponents.rational == ({order: 1, -order: 1} if order else {0: 2})
    assert local.n_single_valued == local.n_without_logarithm == 1


def test_solutions_with_logarithms_are_those_of_the_bessel_equation():
    found = at_origin([[0, 1], [-(p**2), 0]]).solutions(terms=6)
    values = [[row.to_Matrix() for row in powers] for powers in found.coefficients]
    # J_0 = 1 - p^2/4 + p^4/64 - p^6/2304; Y_0 = (2/pi)(ln(p/2) + gamma) J_0 + ...: the factor of ln p is J_0
    with_log = [c for c in range(2) if values[0][1][0, c] != 0]
    assert len(with_log) == 1
    factor = values[0][1][0, with_log[0]]
    series = [m[1][0, with_log[0]] / factor for m in values]
    assert series == [1, 0, sp.Rational(-1, 4), 0, sp.Rational(1, 64), 0, sp.Rational(-1, 2304)]
    N = found.nilpotent.to_Matrix()
    assert sp.zeros(2) != N
    assert sp.zeros(2) == N * N


def test_long_jordan_blocks_have_powers_of_the_logarithm():
    local = at_origin([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    assert local.n_without_logarithm == 1
    found = local.solutions()
    assert found.nilpotent.to_Matrix() ** 2 != sp.zeros(3)
    # u = exp(B ln p) c: the factor of ln p is B c
    constant, factor = (found.coefficients[0][j].to_Matrix() for j in range(2))
    assert factor == sp.Matrix([[0, 1, 0], [0, 0, 1], [0, 0, 0]]) * constant
    assert constant * found.nilpotent.to_Matrix() == factor


@pytest.mark.parametrize(("c", "count"), [(0, 2), (1, 1)])
def test_a_resonance_is_free_of_a_logarithm_only_for_one_coefficient(c, count):
    # p u1' = 0, p u2' = u2 + c p u1: u2 = c p ln p + ... unless c = 0.
    assert at_origin([[0, 0], [c * p, 1]]).n_single_valued == count


def test_an_irregular_point_is_refused():
    local = linear_system(sp.Matrix([[1 / p**2]]), p).local(ORIGIN)
    assert not local.is_regular
    with pytest.raises(ParameterError, match="irregular"):
        _ = local.exponents


def test_points_that_are_not_rational_have_a_field_of_their_own():
    # (s^2 + 1) y' = s y has y = sqrt(s^2 + 1): the exponent is 1/2 at i and -i
    local = linear_system(sp.Matrix([[s / (s**2 + 1)]]), s)
    point = local.singular_points[0]
    assert root_text(point, s) == "s^2 + 1 = 0"
    assert local.local(point).exponents.rational == {Fraction(1, 2): 1}
    assert local.local().exponents.rational == {-1: 1}
    # y' = y / (s^2 + 1) has the exponents 1/(2i) at i and -1/(2i) at -i
    turning = linear_system(sp.Matrix([[1 / (s**2 + 1)]]), s).local(point).exponents
    assert turning.rational == {}
    assert turning.text == "the roots of 4*e^2 + 1 = 0"


def test_the_power_of_a_monodromy_without_roots_of_unity():
    square = sp.Matrix([[0, 2], [1, 0]])  # exponents +-sqrt(2), and the same shifted by 1/3
    local = at_origin(sp.diag(square, square + sp.eye(2) / 3, sp.Rational(1, 4)))
    assert local.exponents.neat_power == 3
    assert not at_origin(square).exponents.differ_irrationally(at_origin(square + sp.eye(2) / 3).exponents)
    assert at_origin(square).exponents.differ_irrationally(at_origin(sp.diag(5, 7)).exponents)
    assert not at_origin(sp.diag(5, 7)).exponents.differ_irrationally(at_origin(sp.diag(sp.Rational(1, 2))).exponents)


@pytest.mark.parametrize(
    ("matrix", "variable", "error", "words"),
    [
        (sp.Matrix([[sp.sqrt(2) / s]]), s, ParameterError, "rational coefficients"),
        (sp.Matrix([[sp.exp(s)]]), s, ParameterError, "rational function of s"),
        (sp.Matrix([[p]]), s, ParameterError, "rational function of s"),
        (sp.Matrix([[1, 2]]), s, ShapeError, "square"),
        ("nonsense", s, ParameterError, "SymPy matrix"),
        (sp.Matrix([[1]]), "s", ParameterError, "SymPy symbol"),
    ],
)
def test_what_is_no_linear_system_is_refused(matrix, variable, error, words):
    with pytest.raises(error, match=words):
        linear_system(matrix, variable)


def test_entries_are_texts_or_numbers_and_never_run(tmp_path):
    ran = tmp_path / "ran"
    given = linear_system([["s/3", 0.1], [0.3333, sp.Float(0.7) * s]], s)
    assert given.matrix == sp.Matrix([[s / 3, sp.Rational(1, 10)], [sp.Rational(3333, 10000), sp.Rational(7, 10) * s]])
    with pytest.raises(ExpressionError):
        linear_system([[f"__import__('pathlib').Path({str(ran)!r}).touch()"]], s)
    assert not ran.exists()
