"""Every kind of field integrates, with tangent vectors, and gives what the same system gives by another kind."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, TapeField
from liepoisson.compile.lowering import lower, tape_of_bracket


def twisted_top():
    return lp.Top(inertia=(2, 3, "5/2"), a=(1, -2, "1/3"), b=("1/2", 0, 1), epsilon="3/2")


def as_quadratic(top):
    return lower(top.bracket, top.hamiltonian)


def as_tape(top):
    return tape_of_bracket(top.bracket, top.hamiltonian)


@pytest.mark.parametrize("lowered", [as_quadratic, as_tape])
def test_a_top_as_another_field_has_the_same_orbits_and_tangents(lowered):
    top = twisted_top()
    other = lowered(top)
    assert isinstance(other, (QuadraticField, TapeField))
    x0 = lp.sample_states(top, n_starts=5, seed=1)
    tangents = np.eye(9)[:3]
    t = np.linspace(0, 10, 5)
    first = lp.integrate(top, x0, times=t, tangents=tangents)
    second = lp.integrate(other, x0, times=t, tangents=tangents)
    assert (second.outcome == "finished").all()
    # round-off grows with the tangent vectors: by their size, measured here, times 1e-14
    growth = np.abs(first.tangent).max()
    np.testing.assert_allclose(second.state, first.state, atol=1e-14 * growth)
    np.testing.assert_allclose(second.tangent, first.tangent, atol=1e-14 * growth**2)


def test_a_trajectory_that_leaves_the_domain_is_an_outcome():
    """x' = -1/x from x = 1 is x = sqrt(1 - 2t): it ends at t = 1/2; its neighbour goes on."""
    x = sp.Symbol("x")
    from liepoisson.compile.lowering import tape_of_equations

    orbit = lp.integrate(tape_of_equations((x,), (-1 / x,)), [[1.0], [2.0]], times=[0, 0.25, 1])
    assert list(orbit.outcome == "finished") == [False, True]
    assert orbit.end_time[0] == pytest.approx(0.5, abs=1e-3)
    assert orbit.state[1, :, 0] == pytest.approx(np.sqrt([4, 3.5, 2]), rel=1e-14)
    assert orbit.state[0, 1, 0] == pytest.approx(np.sqrt(0.5), rel=1e-14)
    assert np.isnan(orbit.state[0, 2, 0])


@pytest.mark.parametrize(
    "entries",
    [
        (3, ((-1, 1.0),), (), ()),
        (3, ((2**70, 1.0),), (), ()),
        (3, ((0.0, 1.0),), (), ()),
        (3, ((0, "1"),), (), ()),
        (3, ((0, 1j),), (), ()),
        (3, ((0,),), (), ()),
        (3, None, (), ()),
        (3, (), {}, ()),
        (3.0, (), (), ()),
        (True, (), (), ()),
        (3, (), (), ((0, 1, 3, 1.0),)),
        (3, (), (), ((0, 1, 1, float("nan")),)),
    ],
)
def test_a_quadratic_field_is_checked_when_it_is_made(entries):
    with pytest.raises(lp.errors.ParameterError, match="wanted"):
        QuadraticField(*entries)


@pytest.mark.parametrize(
    "lines",
    [
        (1, None, (0,)),
        (1, (("sin", (0,)),), (1,)),
        (1, ((3, (0,), ()),), (1,)),
        (1, (("sin", (1,), ()),), (1,)),
        (1, (("sin", (0.0,), ()),), (1,)),
        (1, (("power", (0,), (float("inf"),)),), (1,)),
        (1, (), (-1,)),
        (1, (), None),
    ],
)
def test_a_tape_is_checked_when_it_is_made(lines):
    with pytest.raises(lp.errors.ParameterError, match="wanted"):
        TapeField(*lines)


def test_entries_of_one_product_are_added_up():
    """x' = 2 x y written as x y + y x."""
    field = QuadraticField(2, [], [[1, 0, 1]], [(0, 0, 1, 1.0), (0, 1, 0, 1)])
    assert field == QuadraticField(2, (), ((1, 0, 1.0),), ((0, 0, 1, 2.0),))


@pytest.mark.parametrize("u", [1e-40, 1e100])
def test_no_term_of_a_field_is_lost_beside_larger_ones(u):
    field = lower(lp.canonical(1), lp.System(lp.canonical(1), f"p1^2/(2*{u!r}) + {u!r}*q1^2/2").hamiltonian)
    assert [(i, j) for i, j, _ in field.linear] == [(0, 1), (1, 0)]
    assert [c for _, _, c in field.linear] == pytest.approx([1 / u, -u], rel=1e-15)


def test_terms_that_cancel_but_for_the_rounding_of_irrational_numbers_are_none():
    # two names of one number, which SymPy does not recognise: as numbers they differ in digit 40
    sine, root = sp.sin(sp.pi / 7) ** 2, (1 - sp.cos(2 * sp.pi / 7)) / 2
    bracket = lp.canonical(1)
    q, p = bracket.variables
    field = lower(bracket, sine * q * p - root * p * q + p**2)
    assert field.linear == ((0, 1, 2.0),)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (
            lambda: lp.integrate(as_quadratic(twisted_top()), np.ones(9), times=[0, 1], kernel="components"),
            lp.errors.ParameterError,
            "kind 'quadratic'",
        ),
        (
            lambda: lp.integrate(TapeField(1, (("gamma", (0,), ()),), (1,)), [1.0], times=[0, 1]),
            lp.errors.UnknownNameError,
            "wanted linear, product",
        ),
    ],
)
def test_what_the_core_does_not_have_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()
