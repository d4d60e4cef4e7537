"""The bracket with time and its momentum: its tensor, its Casimirs, and what becomes of symbols."""

import pickle

import pytest
from sympy import Symbol, pi

import liepoisson as lp
from liepoisson.errors import BracketError
from liepoisson.structure.suspension import Suspension

w = Symbol("w")
TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")
LINKED = lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "k*x*y", ("y", "z"): "y*z", ("x", "z"): "0"}, symbols=["k"])


@pytest.mark.parametrize("base", [lp.canonical(2), TWISTED, LINKED], ids=repr)
def test_time_and_its_momentum_are_a_pair_that_commutes_with_all_others(base):
    whole, n = Suspension(base), base.dimension
    J = whole.poisson_tensor()
    assert J[:n, :n] == base.poisson_tensor()
    assert J[:n, n:].is_zero_matrix
    assert J[n, n + 1] == 1
    assert whole.jacobi_certificate().proved
    assert whole.rank() == base.rank() + 2


def test_casimirs_are_those_of_the_bracket():
    assert Suspension(TWISTED).casimirs() == TWISTED.casimirs()
    known = LINKED.with_casimirs(["log(x) + k*log(z)"])
    whole = Suspension(known)
    assert whole.casimirs() == known.casimirs()
    again = whole.with_casimirs(whole.casimirs())
    assert (again.clock, again.casimirs()) == (whole.clock, known.casimirs())


def test_symbols_of_bracket_and_period_take_values():
    whole = Suspension(TWISTED, 2 * pi / w)
    assert whole.symbols == {"epsilon", "w"}
    made = pickle.loads(pickle.dumps(whole)).substitute({"w": 4, "epsilon": 2})
    assert made.period == pi / 2
    assert not made.symbols
    assert made.base.poisson_tensor() == TWISTED.substitute({"epsilon": 2}).poisson_tensor()
    assert [*made.vectors] == ["l", "alpha", "beta"]
    assert made.scalars == ("t", "p_t")


def test_a_coordinate_must_not_be_called_like_time():
    with pytest.raises(BracketError, match="distinct names"):
        Suspension(lp.canonical(names=["t"]))
