"""Obstructions to integrability: theorems of the literature, the twisted Kovalevskaya top, and integrable controls."""

from itertools import count

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability import galois_obstruction, particular_solution, variational_equations
from liepoisson.integrability.galois.criteria import exact_obstruction, logarithms
from liepoisson.integrability.galois.linear_systems import linear_system
from liepoisson.integrability.galois.variational import flag

x = sp.Symbol("x")
Z = 4 * x / (1 + x**2)
PENDULUM = {"l3": Z, "alpha1": Z**2 / 2 - 1, "alpha2": x * Z.diff(x)}
PLANE = lp.canonical(names=("q1", "q2"))


def along_the_pendulum(**parameters):
    """The top with I = (2, 2, 1), a = (-1, 0, 0), its separatrix and the variational equations."""
    top = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), **parameters)
    solution = particular_solution(top, PENDULUM, variable=x, rate=x)
    return top, solution, variational_equations(top, solution)


def henon_heiles(A, B, D, C):
    """The family with x^2 y and y^3; the plane q1 = 0 is invariant."""
    return lp.System(PLANE, f"(p_q1^2 + p_q2^2)/2 + ({A}*q1^2 + {B}*q2^2)/2 + {D}*q1^2*q2 - ({C})*q2^3/3", name="HH")


def test_the_twisted_kovalevskaya_top_is_not_integrable():
    found = galois_obstruction(lp.Top.twisted_kovalevskaya())
    assert found.verdict == "not integrable"
    assert found.is_proved_exactly
    assert found.theorem == "Ayoul and Zung"
    assert {step.how for step in found.steps} == {"checked exactly", "theorem"}
    assert "3 commuting fields" in found.statement
    assert "6 common independent integrals" in found.statement
    assert "4 of 5 solutions have no logarithm" in str(found)


def test_the_steps_of_the_theorem():
    _, _, equations = along_the_pendulum(epsilon=1)
    block = equations.part((0, 1, 5, 6, 7))
    chain = flag(block)
    poles = block.singular_points[1]
    log = logarithms(chain, poles)
    assert [(one.low, one.high, one.rank) for one in log] == [(1, 3, 1)]
    assert not logarithms(chain, block.singular_points[0])  # its exponents are not rational
    found = exact_obstruction(chain)
    assert found.image.text == "the roots of 2*e^2 - 1 = 0"
    assert found.source.rational == {0: 1}


def test_garniers_system_has_no_obstruction():
    """H = p^2/2 + (A q1^2 + B q2^2)/2 + c |q|^4 is integrable for all A, B, c (Garnier; Wojciechowski)."""
    system = lp.System(PLANE, "(p_q1^2 + p_q2^2)/2 + (q2^2 - q1^2)/2 - (q1^2 + q2^2)^2/2")
    assert galois_obstruction(system, most=1).verdict != "not integrable"


@pytest.mark.parametrize("parameters", [{"epsilon": 0}, {"epsilon": 0, "b": (0, 1, 0)}])
def test_integrable_tops_have_no_logarithm_there(parameters):
    _, _, equations = along_the_pendulum(**parameters)
    for places in equations.summands:
        block = equations.part(places)
        assert exact_obstruction(flag(block)) is None
        if len(places) > 1:
            assert block.local(block.singular_points[-1]).n_without_logarithm == len(places)


@pytest.mark.slow
@pytest.mark.parametrize(
    "top",
    [
        lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon=0),
        lp.Top(inertia=(2, 2, 1), a=(0, 0, 1), epsilon=1),
        lp.Top(inertia=(1, 1, 1), a=(1, 0, 0), b=(0, 0, 1), epsilon=0),
    ],
    ids=["kovalevskaya", "twisted lagrange", "two fields"],
)
def test_integrable_tops_give_no_obstruction(top):
    found = galois_obstruction(top, time_limit=400)
    assert found.verdict == "no obstruction found", str(found)
    assert not found.statement


@pytest.mark.parametrize("b", [(0, 0, 1), pytest.param((3, -2, 1), marks=pytest.mark.slow)])
def test_the_criterion_holds_for_given_second_fields(b):
    _, _, equations = along_the_pendulum(epsilon=1, b=b)
    assert any(exact_obstruction(flag(equations.part(p))) for p in equations.summands)


@pytest.mark.parametrize(
    ("parameters", "verdict"),
    [
        # D/C = -1, A = B: separable in q1 +- q2
        pytest.param((1, 1, 1, -1), "no obstruction found", marks=pytest.mark.slow),
        pytest.param(
            (3, 1, 1, -6), "no obstruction found", marks=pytest.mark.slow
        ),  # D/C = -1/6: a quartic integral for all A and B
        ((1, 16, 1, -16), "no obstruction found"),  # D/C = -1/16, B = 16 A
        ((1, 1, 1, 1), "not integrable"),  # the system of Henon and Heiles
        # the normal equations are those of Lame with n = 3 and 2, solved in closed form: it takes higher variations
        ((2, 1, 1, -1), "no obstruction found"),
        ((1, 4, 1, -16), "not integrable"),  # D/C = -1/16, but B is not 16 A
        pytest.param((1, 1, 1, -3), "not integrable", marks=pytest.mark.slow),
    ],
)
def test_the_family_of_henon_and_heiles(parameters, verdict):
    found = galois_obstruction(henon_heiles(*parameters), most=1)
    assert found.verdict == verdict, str(found)
    assert found.theorem == "Morales-Ruiz and Ramis"


@pytest.mark.parametrize("n", [60, 120])
def test_short_time_is_an_open_end(monkeypatch, n):
    """The deadline passes when it is asked for it the n-th time."""
    from liepoisson.inputs import deadline

    system, n_asked = lp.catalog.system("henon-heiles"), count()
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 100.0 if next(n_asked) > n else 0.0)
    found = galois_obstruction(system, time_limit=60)
    assert found.verdict == "open"
    assert "time limit" in str(found)


def test_what_is_not_polynomial_is_refused():
    with pytest.raises(ParameterError, match="polynomial equations"):
        galois_obstruction(lp.System(lp.canonical(names=("q",)), "p_q^2/2 - cos(q)", name="pendulum"))
    with pytest.raises(ParameterError, match="ParticularSolution"):
        galois_obstruction(lp.Top.twisted_kovalevskaya(), solution="separatrix")


def test_equal_irrational_exponents_commute_with_everything():
    # scalars times a unipotent matrix: the group is abelian, though the exponents at s^2 = 2 are irrational
    s, nilpotent = sp.Symbol("s"), sp.Matrix([[-2, 1], [-4, 2]])
    equal = linear_system(nilpotent / s + sp.eye(2) * 4 / (s**2 - 2), s)
    assert exact_obstruction(flag(equal)) is None
    assert not equal.local(equal.singular_points[1]).exponents.pairwise_irrational
    # exponents -e and e, those of Euler's equation with e^2 = 1/2, differ by irrational numbers
    different = linear_system(sp.Matrix([[0, 1], [sp.Rational(1, 2), 0]]) / s, s)
    assert different.local(different.singular_points[0]).exponents.pairwise_irrational
