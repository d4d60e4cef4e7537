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


DRIVEN = Suspension(lp.canonical(names=["x", "y"], angles=["x"]), 2 * pi / w)
SAME = {name: name for name in DRIVEN.coordinate_names_in_order}


@pytest.mark.parametrize(
    "make",
    [
        lambda: lp.brackets.product(DRIVEN, lp.canonical(1)),
        lambda: lp.brackets.product(lp.canonical(1), DRIVEN),
        lambda: DRIVEN.dirac_bracket(["y", "p_y"]),
        lambda: DRIVEN.in_variables(SAME, SAME),
        lambda: DRIVEN.in_invariants({"p_x": "p_x"}),
        lambda: DRIVEN.rename("u", "v", "p_u", "p_v", "s", "p_s"),
    ],
)
def test_what_would_lose_the_clock_is_refused(make):
    with pytest.raises(BracketError, match=r"has no time; got .* without time"):
        make()


def test_angles_and_casimirs_are_those_of_the_bracket_also_with_values():
    assert DRIVEN.with_angles(["y"]).substitute({"w": 2}).angles == ("y",)
    with pytest.raises(BracketError, match="got 't'"):
        DRIVEN.with_angles(["t"])
    known = Suspension(LINKED, w).with_casimirs(["log(x) + k*log(z)"]).substitute({"w": 2, "k": 3})
    assert [str(one) for one in known.casimirs()] == ["log(x) + 3*log(z)"]
