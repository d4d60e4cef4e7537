from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.structure.poisson.exceptional_parameters import special_values

a, b = sp.symbols("a b")
PLANE, LINE = Coefficients.containing([a, b]), Coefficients.containing([a])


def values(*pivots, field=PLANE):
    found, undecided = special_values([field.read(sp.sympify(pivot)) for pivot in pivots], field)
    return [inserted for _, inserted in found], undecided


def test_roots_of_numerators_and_denominators():
    # (a^3 - a)/(a^2 - 2): roots -1, 0, 1, poles -sqrt(2), sqrt(2); in order.
    found, undecided = values((a**3 - a) / (a**2 - 2), field=LINE)
    assert found == [{"a": v} for v in (-sp.sqrt(2), Fraction(-1), Fraction(0), Fraction(1), sp.sqrt(2))]
    assert undecided == ()


@pytest.mark.parametrize("pivot", [sp.Integer(5), a**2 + 1, 1 / (a**4 + a**2 + 1)])
def test_no_real_roots_no_special_values(pivot):
    assert values(pivot, field=LINE) == ([], ())


def test_each_factor_is_listed_once():
    assert values(a * b, a**2, b / a, a**3 * b) == ([{"a": Fraction(0)}, {"b": Fraction(0)}], ())


def test_conditions_on_several_parameters_are_solved_for_one_of_them():
    found, undecided = values((a - 1) * (a * b + 3))
    assert found == [{"a": Fraction(1)}, {"a": -3 / b}]
    assert undecided == ()


def test_conditions_of_higher_degree_in_all_parameters_stay_undecided():
    assert values(a**2 + b**2 - 1, b - 2) == ([{"b": Fraction(2)}], ("a**2 + b**2 - 1 = 0",))


def test_a_solution_inserted_makes_the_pivot_vanish():
    pivot = a * b - 2 * a + 7
    ((_, inserted),) = special_values([PLANE.read(pivot)], PLANE)[0]
    assert sp.simplify(pivot.subs({sp.Symbol(name): value for name, value in inserted.items()})) == 0


def test_the_condition_is_the_text_of_its_values():
    ((text, inserted),) = special_values([PLANE.read(a + b)], PLANE)[0]
    assert text == "a = -b"
    assert inserted == {"a": -b}
