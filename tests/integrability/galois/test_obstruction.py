"""Obstructions to integrability: theorems of the literature, the twisted Kovalevskaya top, and integrable controls."""

from itertools import count

import pytest
import sympy as sp
from sympy.polys.matrices import DomainMatrix

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability import galois_obstruction, particular_solution, variational_equations
from liepoisson.integrability.galois.criteria import exact_obstruction, logarithms
from liepoisson.integrability.galois.linear_systems import LinearSystem, linear_system
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


@pytest.mark.parametrize("coefficient", ["-1/2", *(pytest.param(c, marks=pytest.mark.slow) for c in ("-3", "2"))])
def test_garniers_system_has_no_obstruction(coefficient):
    """H = p^2/2 + (A q1^2 + B q2^2)/2 + c |q|^4 is integrable for all A, B, c (Garnier; Wojciechowski)."""
    system = lp.System(PLANE, f"(p_q1^2 + p_q2^2)/2 + (q2^2 - q1^2)/2 + ({coefficient})*(q1^2 + q2^2)^2")
    assert galois_obstruction(system, most=2).verdict != "not integrable"


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
        lp.Top(inertia=(2, 2, 1), a=(0, 0, 1), epsilon=0),
        lp.Top(inertia=(1, 1, 1), a=(1, 0, 0), b=(0, 0, 1), epsilon=0),
        lp.catalog.system("kovalevskaya"),
    ],
    ids=str,
)
def test_integrable_tops_give_no_obstruction(top):
    found = galois_obstruction(top, time_limit=400)
    assert found.verdict == "no obstruction found", str(found)
    assert not found.statement


@pytest.mark.slow
def test_the_spherical_twisted_top_in_two_fields_is_not_integrable():
    """All b that are not parallel to a, and all epsilon that are not 0, are the same system up to scalings."""
    found = galois_obstruction(lp.Top(inertia=(1, 1, 1), a=(1, 0, 0), b=(0, 0, 1), epsilon=1), time_limit=400)
    assert found.verdict == "not integrable"
    assert not found.is_proved_exactly
    assert found.commutator.size > 1e3


@pytest.mark.slow
@pytest.mark.parametrize(("a", "b"), [((1, 2, 0), (0, 0, 0)), ((1, 0, 0), (0, 0, 0)), ((1, 0, 0), (0, 0, 1))])
def test_tops_with_three_moments_are_not_integrable(a, b):
    assert (
        galois_obstruction(lp.Top(inertia=(2, 3, 4), a=a, b=b, epsilon=1), time_limit=400).verdict == "not integrable"
    )


def test_every_second_field_leaves_the_kovalevskaya_top_without_integrals():
    """For all b: N is linear in the couplings, those of b1 and b2 give none, those of epsilon and b3 two lines.

    X is spanned by the rational solution of (l1, l2, alpha3) and by (l3, alpha1, alpha2): beta = 0 modulo X has the
    exponents +-1/sqrt(2) at x = 0, and the quotient by beta = 0 the exponents 0.
    """
    order = (0, 1, 5, 2, 3, 4, 6, 7, 8)
    cases = {"epsilon": (1, (0, 0, 0)), "b1": (0, (1, 0, 0)), "b2": (0, (0, 1, 0)), "b3": (0, (0, 0, 1))}
    whole = {name: along_the_pendulum(epsilon=e, b=b)[2].part(order) for name, (e, b) in cases.items()}
    heavy = flag(whole["epsilon"].part((0, 1, 2)))
    assert heavy.sizes == (1, 2)
    field = whole["epsilon"].entries.domain
    rows = [[field.one if i == j else field.zero for j in range(9)] for i in range(9)]
    for i, row in enumerate(heavy.basis.to_dense().rep.to_list()):
        rows[i][:3] = row
    basis = DomainMatrix(rows, (9, 9), field)
    moved = {name: system.changed(basis).entries.to_dense().rep.to_list() for name, system in whole.items()}
    V, X, beta = (1, 2), (0, 3, 4, 5), (6, 7, 8)
    assert not any(entries[i][j] for entries in moved.values() for i in (*V, *beta) for j in X)

    def quotient(*names):
        """V6/X with one copy of the beta equations for each coupling."""
        size = 2 + 3 * len(names)
        table = [[field.zero] * size for _ in range(size)]
        for i, p in enumerate(V):
            for j, q in enumerate(V):
                table[i][j] = moved["epsilon"][p][q]
        for k, name in enumerate(names):
            for j, q in enumerate(beta):
                for i, p in enumerate(V):
                    table[i][2 + 3 * k + j] = moved[name][p][q]
                for i, p in enumerate(beta):
                    table[2 + 3 * k + i][2 + 3 * k + j] = moved[name][p][q]
        return LinearSystem(x, DomainMatrix(table, (size, size), field), tuple(f"z{k}" for k in range(size)))

    def count(*names):
        system = quotient(*names)
        return system.local(system.singular_points[1]).n_without_logarithm

    assert [count(name) for name in cases] == [4, 5, 5, 4]
    assert count("epsilon", "b3") == 6  # of 8: the images of the two are independent, no b3 makes them cancel
    system = quotient("epsilon")
    origin = system.singular_points[0]
    assert system.part((0, 1)).local(origin).exponents.text == "the roots of 2*e^2 - 1 = 0"
    assert system.part((2, 3, 4)).local(origin).exponents.rational == {0: 3}


@pytest.mark.parametrize(
    "b", [(0, 0, 1), pytest.param((0, 1, 0), marks=pytest.mark.slow), pytest.param((3, -2, 1), marks=pytest.mark.slow)]
)
def test_the_criterion_holds_for_given_second_fields(b):
    _, _, equations = along_the_pendulum(epsilon=1, b=b)
    assert any(exact_obstruction(flag(equations.part(p))) for p in equations.summands)


@pytest.mark.parametrize(
    ("parameters", "verdict"),
    [
        ((1, 1, 1, -1), "no obstruction found"),  # D/C = -1, A = B: separable in q1 +- q2
        pytest.param(
            (3, 1, 1, -6), "no obstruction found", marks=pytest.mark.slow
        ),  # D/C = -1/6: a quartic integral for all A and B
        ((1, 16, 1, -16), "no obstruction found"),  # D/C = -1/16, B = 16 A
        ((1, 1, 1, 1), "not integrable"),  # the system of Henon and Heiles
        # the normal equations are those of Lame with n = 3 and 2, solved in closed form: it takes higher variations
        ((2, 1, 1, -1), "no obstruction found"),
        ((1, 4, 1, -16), "not integrable"),  # D/C = -1/16, but B is not 16 A
        pytest.param((1, 1, 1, -2), "no obstruction found", marks=pytest.mark.slow),
        ((1, 1, 1, -3), "not integrable"),
    ],
)
def test_the_family_of_henon_and_heiles(parameters, verdict):
    found = galois_obstruction(henon_heiles(*parameters), most=1)
    assert found.verdict == verdict, str(found)
    assert found.theorem == "Morales-Ruiz and Ramis"


@pytest.mark.slow
@pytest.mark.parametrize(("mu", "verdict"), [(1, "no obstruction found"), (2, "not integrable")])
def test_an_oscillator_coupled_to_a_double_well(mu, verdict):
    """Poeschl and Teller: xi'' = -(1 + 2 mu sech^2 t) xi is solved in closed form if 2 mu = n (n + 1)."""
    system = lp.System(PLANE, f"(p_q1^2 + p_q2^2)/2 - q1^2/2 + q1^4/4 + (1 + 2*{mu}*q1^2/2)*q2^2/2", name="double well")
    assert galois_obstruction(system, most=1).verdict == verdict


def test_no_solution_is_an_open_end():
    top = lp.Top(inertia=(2, 3, 4), a=(1, 2, 3), epsilon=1)
    found = galois_obstruction(top)
    assert found.verdict == "open"
    assert "none was found: not decided" in str(found)


@pytest.mark.parametrize("n", [60, 90, 120])
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


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "charged-lagrange",
        "charged-twisted-lagrange",
        "henon-heiles-kaup-kupershmidt",
        "henon-heiles-kdv",
        "henon-heiles-sawada-kotera",
        "kovalevskaya-gyrostat",
        "lagrange",
        "spherical-pendulum",
        "two-field-kovalevskaya",
    ],
)
def test_integrable_systems_of_the_catalog_are_never_said_not_to_be(name):
    found = galois_obstruction(lp.catalog.system(name), time_limit=20, most=2)
    assert found.verdict != "not integrable", str(found)
    assert found.solutions


@pytest.mark.slow
def test_the_goryachev_chaplygin_top_is_integrable_on_one_level_only():
    assert galois_obstruction(lp.catalog.system("goryachev-chaplygin")).verdict == "not integrable"


def test_equal_irrational_exponents_commute_with_everything():
    # scalars times a unipotent matrix: the group is abelian, though the exponents at s^2 = 2 are irrational
    s, nilpotent = sp.Symbol("s"), sp.Matrix([[-2, 1], [-4, 2]])
    equal = linear_system(nilpotent / s + sp.eye(2) * 4 / (s**2 - 2), s)
    assert exact_obstruction(flag(equal)) is None
    assert not equal.local(equal.singular_points[1]).exponents.pairwise_irrational
    # exponents -e and e, those of Euler's equation with e^2 = 1/2, differ by irrational numbers
    different = linear_system(sp.Matrix([[0, 1], [sp.Rational(1, 2), 0]]) / s, s)
    assert different.local(different.singular_points[0]).exponents.pairwise_irrational
