"""Sums of terms in decimals: zero is told from a small number, whatever the units."""

import pytest
from sympy import Integer, Rational, Symbol, cos, exp, log, pi, sin, sinh, sqrt

import liepoisson as lp
from liepoisson.algebra.decimals import vanishes_at
from liepoisson.errors import JacobiError, ParameterError
from liepoisson.structure.circles import change, turn

x, y = Symbol("x"), Symbol("y")
POINT = {"x": Rational(123, 457), "y": Rational(-7, 11)}
TINY = Rational(1, 10**80)


@pytest.mark.parametrize("scale", [1, TINY, 1 / TINY])
@pytest.mark.parametrize(
    "terms",
    [
        [sin(x) ** 2, cos(x) ** 2, Integer(-1)],
        [x * (sqrt(2 * x) - sqrt(2) * sqrt(x)), y * (exp(x) ** 2 - exp(2 * x))],
        [sinh(x + y), -sinh(x) * (exp(y) + exp(-y)) / 2, -(exp(x) + exp(-x)) / 2 * sinh(y)],
        [sqrt(2) * sqrt(3 + x), -sqrt(6 + 2 * x)],
        [log(x**2 * exp(y)), -2 * log(x), -y],
    ],
)
def test_identities_hold_and_what_is_added_is_seen(scale, terms):
    scaled = [scale * term for term in terms]
    assert vanishes_at(scaled, POINT)
    for added in (TINY * x, exp(-200 + x), cos(TINY * x) - 1, (x / 1000) ** 20):
        assert not vanishes_at([*scaled, *(scale * added).expand().as_ordered_terms()], POINT)


def test_poles_and_numbers_beyond_all_sizes_have_no_value():
    assert vanishes_at([1 / (x - Rational(123, 457))], POINT) is None
    assert vanishes_at([exp(exp(50 + x))], POINT) is None


@pytest.mark.parametrize(
    ("function", "period", "periodic"),
    [
        (TINY * exp(sin(x / 2) ** 2), turn(), True),
        (TINY * exp(sin(x / 2)), turn(), False),
        (TINY * cos(x) + TINY * x, turn(), False),
        (exp(cos(x)) + TINY * x, turn(), False),
        (cos(2 * x), Rational(1, 10**400), False),
        (cos(TINY * x), 1, False),
        (cos(TINY * x), 2 * pi / TINY, True),
    ],
)
def test_periods_do_not_depend_on_units(function, period, periodic):
    assert (change(function, x, period) == 0) is periodic


def test_verdicts_on_brackets_do_not_depend_on_units():
    sphere = lp.so(3) @ lp.trivial()
    assert sphere.is_casimir("1e-60*exp(l1^2 + l2^2 + l3^2)")
    assert not sphere.is_casimir("exp(l1^2 + l2^2 + l3^2) + 1e-60*exp(l1)")
    two = lp.PoissonTensor(["a", "b", "c", "d"], {("a", "b"): "exp(sin(a))", ("c", "d"): "1e-60*exp(cos(c))"})
    assert two.rank() == 4
    with pytest.raises(JacobiError):
        lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "exp(z)", ("y", "z"): "1e-60*sin(x)*exp(y)", ("z", "x"): "y"})


def test_a_surface_may_have_any_unit():
    pendulum = lp.System(lp.canonical(names=["x"], angles=["x"]), "p_x^2/2 - cos(x)")
    assert lp.section(pendulum, {"p_x": 3}, surface="1e-60*x", t_end=10).count.tolist() == [4]
    with pytest.raises(ParameterError, match="wanted a function on the circle"):
        lp.section(pendulum, {"p_x": 3}, surface="1e-60*exp(x) - 1e-60*exp(1)", t_end=10)
