"""Methods as data: their ranges."""

import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError


@pytest.mark.parametrize("tol", [0.0, -1.0, 1e-17, 0.5, float("nan")])
def test_tolerance_out_of_range_is_refused(tol):
    with pytest.raises(ParameterError, match="tol: wanted a number from"):
        lp.Taylor(tol=tol)


@pytest.mark.parametrize("order", [1, 65, -3])
def test_order_out_of_range_is_refused(order):
    with pytest.raises(ParameterError, match="order: wanted a whole number"):
        lp.Taylor(order=order)


def test_a_budget_of_no_steps_is_refused():
    with pytest.raises(ParameterError, match="max_steps"):
        lp.Taylor(max_steps=0)


def test_a_given_order_is_used():
    assert lp.integrate(lp.Top.kovalevskaya(), [0.1] * 9, t=[0, 1], method=lp.Taylor(order=31)).order == 31
