"""Brackets of invariants: closed forms, reduced motion against the full one, and functions that are not closed."""

from random import Random

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import BracketError, ExpressionError, ParameterError, ShapeError

PLANE = lp.canonical(2)
HOPF = {"w1": "q1*q2 + p1*p2", "w2": "q1*p2 - q2*p1", "w3": "(q1^2 + p1^2 - q2^2 - p2^2)/2"}
ACTION = {"I": "(q1^2 + p1^2 + q2^2 + p2^2)/2"}
RADIAL = {"r": "q1^2 + q2^2", "s": "q1*p1 + q2*p2", "k": "p1^2 + p2^2"}
MOMENTUM = {"L": "q1*p2 - q2*p1"}
SPACE = lp.canonical(names=("x", "y", "z"))
ABOUT_Z = {"z": "z", "u": "p_z", "r": "x^2 + y^2", "s": "x*p_x + y*p_y", "k": "p_x^2 + p_y^2"}
ON_SPHERE = ["x^2 + y^2 + z^2 - 1", "x*p_x + y*p_y + z*p_z"]


def test_two_equal_oscillators_reduce_to_so3():
    """The Hopf variables: {w_i, w_j} = 2 eps_ijk w_k, w.w = I^2."""
    reduced = PLANE.in_invariants(HOPF, levels=ACTION)
    w1, w2, w3 = reduced.variables
    assert (reduced(w1, w2), reduced(w2, w3), reduced(w3, w1)) == (2 * w3, 2 * w1, 2 * w2)
    assert (reduced.jacobi, reduced.symbols) == ("proved", {"I"})
    (relation,) = reduced.casimirs()
    assert sp.expand(relation**2 - (w1**2 + w2**2 + w3**2 - sp.Symbol("I") ** 2) ** 2) == 0
    # with the action as a coordinate it is a Casimir by itself
    both = PLANE.in_invariants(HOPF | ACTION)
    assert {*both.casimirs()} >= {sp.Symbol("I")}
    assert (both.rank(), both.corank()) == (2, 2)


def test_resonance_one_to_two():
    """X + i Y = z1^2 conj(z2), N = |z1|^2/2, I = |z1|^2/2 + |z2|^2: X^2 + Y^2 = 4 N^2 (I - N)."""
    invariants = {"X": "(q1^2 - p1^2)*q2 + 2*q1*p1*p2", "Y": "2*q1*p1*q2 - (q1^2 - p1^2)*p2", "N": "(q1^2 + p1^2)/2"}
    reduced = PLANE.in_invariants(invariants, levels={"I": "(q1^2 + p1^2)/2 + q2^2 + p2^2"})
    X, Y, N = reduced.variables
    (relation,) = reduced.casimirs()
    assert sp.cancel(relation / (X**2 + Y**2 - 4 * N**2 * (sp.Symbol("I") - N))).is_number
    gradient = [relation.diff(v) for v in (X, Y, N)]  # a Nambu bracket with this Casimir
    matrix = [reduced(X, Y), reduced(Y, N), reduced(N, X)]
    factor = sp.cancel(matrix[0] / gradient[2])
    assert [
        sp.expand(m - factor * g) for m, g in zip(matrix, (gradient[2], gradient[0], gradient[1]), strict=True)
    ] == [0] * 3


def test_kepler_without_its_angle():
    """The ellipse of the semi-axis 1 and eccentricity e = 1/2 is farthest from the centre after half a period, pi."""
    reduced = PLANE.in_invariants(RADIAL, levels=MOMENTUM)
    system = lp.System(reduced, "k/2 - 1/sqrt(r)")
    start = [0.25, 0.0, 3.0]  # at the distance 1 - e with v^2 = (1 + e)/(1 - e)
    run = lp.integrate(system, start, times=[0, np.pi, 2 * np.pi], method=lp.Taylor(tol=1e-15))
    np.testing.assert_allclose(run.state[0][:, 0], [0.25, 2.25, 0.25], rtol=1e-10)
    assert str(system.invariants["C1"]) in ("L**2 - k*r + s**2", "-L**2 + k*r - s**2")


def test_the_spherical_pendulum_is_reduced_before_and_after_it_is_constrained():
    levels = {"L": "x*p_y - y*p_x"}
    before = SPACE.in_invariants(ABOUT_Z, levels=levels).dirac_bracket(["z^2 + r - 1", "z*u + s"])
    after = SPACE.dirac_bracket(ON_SPHERE).in_invariants(ABOUT_Z, levels=levels)
    assert (before.poisson_tensor() - after.poisson_tensor()).applyfunc(sp.cancel) == sp.zeros(5)
    assert before.rank() == after.rank() == 2
    assert len(before.given_casimirs) == len(after.given_casimirs) == 3
    # z'^2 = 2 (h - z)(1 - z^2) - L^2 of the textbooks
    x, p = np.array([0.6, 0, -0.8]), np.array([0.4, 0.7, 0.3])
    momentum, energy = x[0] * p[1] - x[1] * p[0], p @ p / 2 + x[2]
    system = lp.System(before, "(u^2 + k)/2 + z", {"L": momentum})
    start = [x[2], p[2], x[0] ** 2 + x[1] ** 2, x[0] * p[0] + x[1] * p[1], p[0] ** 2 + p[1] ** 2]
    states = lp.integrate(system, start, times=np.linspace(0, 10, 21)).state[0]
    z, speed = states[:, 0], system.vector_field(states)[:, 0]
    np.testing.assert_allclose(speed**2, 2 * (energy - z) * (1 - z**2) - momentum**2, atol=1e-10)
    assert np.ptp(z) > 0.3


def turned(random):
    """A random linear canonical change of (q, p), and the texts of the old coordinates in the new ones."""
    names = sp.symbols("q1 q2 p1 p2")
    state = dict(zip(("q1", "q2", "p1", "p2"), names, strict=True))
    for _ in range(2):
        a, b, c = (random.choice([-2, -1, 1, 2]) for _ in range(3))
        state["p1"] += a * state["q1"] + b * state["q2"]
        state["p2"] += b * state["q1"] + c * state["q2"]
        a, b, c = (random.choice([-1, 0, 1]) for _ in range(3))
        state["q1"] += a * state["p1"] + b * state["p2"]
        state["q2"] += b * state["p1"] + c * state["p2"]
    return {sp.Symbol(name): sp.expand(value) for name, value in state.items()}


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(8))
def test_reduced_motion_is_the_image_of_the_motion(seed):
    """In random canonical coordinates, with a random Hamiltonian of the invariants; brackets at random states."""
    random = Random(seed)
    change = turned(random)
    invariants = {k: sp.sympify(f.replace("^", "**")).subs(change, simultaneous=True)
                  for k, f in (HOPF if seed % 2 else RADIAL).items()}  # fmt: skip
    levels = {k: sp.sympify(f.replace("^", "**"), locals={"I": sp.Symbol("I")}).subs(change, simultaneous=True)
              for k, f in (ACTION if seed % 2 else MOMENTUM).items()}  # fmt: skip
    reduced = PLANE.in_invariants(invariants, levels=levels)
    x = PLANE.variables
    functions = sp.lambdify(x, [*invariants.values(), *levels.values()], "numpy")
    slopes = sp.lambdify(x, [[f.diff(v) for v in x] for f in invariants.values()], "numpy")
    J = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    entries = sp.lambdify([*reduced.variables, *map(sp.Symbol, levels)], reduced.poisson_tensor().tolist(), "numpy")
    rng = np.random.default_rng(seed)
    for state in rng.uniform(-1, 1, (5, 4)):
        gradient = np.array(slopes(*state), float)
        np.testing.assert_allclose(gradient @ J @ gradient.T, entries(*functions(*state)), rtol=1e-9, atol=1e-9)
    y = reduced.variables
    energy = sum(random.choice([-1, 1, 2]) * sp.Rational(1, 20) * v for v in y) + y[0] * y[2] / 50
    full = energy.xreplace(dict(zip(y, invariants.values(), strict=True)))
    rates = sp.lambdify(x, [full.diff(x[2]), full.diff(x[3]), -full.diff(x[0]), -full.diff(x[1])], "numpy")
    start = rng.uniform(-0.3, 0.3, 4)
    end = solve_ivp(lambda _, s: rates(*s), (0, 1), start, rtol=1e-11, atol=1e-13).y[:, -1]
    values = dict(zip(levels, map(float, functions(*start)[3:]), strict=True))
    run = lp.integrate(lp.System(reduced, energy, values), functions(*start)[:3], t_end=1)
    np.testing.assert_allclose(run.end_state[0], functions(*end)[:3], rtol=1e-7, atol=1e-9)


def test_relations_decide_which_formulas_obey_the_jacobi_identity():
    """q^2, q p, p^2 of one degree of freedom are sp(2), with its one Casimir 0."""
    reduced = lp.canonical(1).in_invariants({"a": "q1^2", "b": "q1*p1", "c": "p1^2"})
    a, b, c = reduced.variables
    assert (reduced(a, b), reduced(b, c), reduced(a, c)) == (2 * a, 2 * c, 4 * b)
    assert [sp.expand(one - (a * c - b**2)) for one in reduced.casimirs()] == [0]


def test_denominators_that_are_invariants_stay():
    """Cotangent of the sphere in the coordinates of a cone: {z, u} = r/(r + z^2)."""
    reduced = SPACE.dirac_bracket(ON_SPHERE).in_invariants(ABOUT_Z, levels={"L": "x*p_y - y*p_x"})
    z, u, r, *_ = reduced.variables
    assert sp.cancel(reduced(z, u) - r / (r + z**2)) == 0
    quotient = lp.canonical(1).in_invariants({"a": "q1/p1", "b": "q1*p1"})
    assert quotient(*quotient.variables) == 2 * quotient.variables[0]


REFUSED = {
    "not closed": (
        {"r": "q1^2 + q2^2", "k": "p1^2 + p2^2"},
        {},
        BracketError,
        r"\{r, k\} = 4\*p1\*q1 \+ 4\*p2\*q2 is no",
    ),
    "not closed, of degree 4": ({"a": "q1^3", "b": "q1^2*p1"}, {}, BracketError, "3[*]q1[*][*]4"),
    "no momentum": (RADIAL, {"L": "q1*p2"}, BracketError, "a level must have the bracket 0"),
    "a root": ({"r": "sqrt(q1^2 + q2^2)"}, {"L": "1"}, ParameterError, "rational functions"),
    "one name for two things": (RADIAL, {"r": "q1*p2 - q2*p1"}, BracketError, "r is given twice"),
    "an unknown name": ({"r": "q3^2"}, {}, ExpressionError, "q3"),
    "no mapping": (["q1^2"], {}, ParameterError, "invariants"),
    "none": ({}, {}, ShapeError, "names"),
    "no name": ({"2r": "q1"}, {}, ParameterError, "2r"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_closed_is_refused(case):
    invariants, levels, error, words = REFUSED[case]
    with pytest.raises(error, match=words):
        PLANE.in_invariants(invariants, levels=levels)
