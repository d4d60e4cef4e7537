"""Dirac brackets: closed forms, motion with Lagrange multipliers, and constraints that are not of second class."""

import pickle
from itertools import combinations
from random import Random

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import BracketError, ConstraintError, ExpressionError, ParameterError

SPACE = lp.canonical(names=("x", "y", "z"))
ON_SPHERE = ["x^2 + y^2 + z^2 - 1", "x*p_x + y*p_y + z*p_z"]
PENDULUM = lp.System(SPACE.dirac_bracket(ON_SPHERE), "(p_x^2 + p_y^2 + p_z^2)/2 + z")
START = np.array([0.6, 0, -0.8, 0.4, 0.7, 0.3])
TIGHT = {"rtol": 1e-11, "atol": 1e-12}


def test_the_dirac_bracket_of_the_sphere_is_that_of_books():
    """{x_i, x_j} = 0, {x_i, p_j} = delta_ij - x_i x_j/|x|^2, {p_i, p_j} = (x_j p_i - x_i p_j)/|x|^2."""
    bracket = PENDULUM.bracket
    x, p = bracket.variables[:3], bracket.variables[3:]
    square = sum(v**2 for v in x)
    for i in range(3):
        for j in range(3):
            assert bracket(x[i], x[j]) == 0
            assert sp.simplify(bracket(x[i], p[j]) - int(i == j) + x[i] * x[j] / square) == 0
            assert sp.simplify(bracket(p[i], p[j]) - (x[j] * p[i] - x[i] * p[j]) / square) == 0
    assert bracket.jacobi == "proved"
    assert bracket.jacobi_certificate().proved
    assert bracket.casimirs() == [square - 1, sum(a * b for a, b in zip(x, p, strict=True))]
    assert bracket.rank() == 4
    assert list(PENDULUM.invariants) == ["H", "C1", "C2"]


def test_its_orbits_are_those_of_the_pendulum_in_spherical_angles():
    """theta'' = sin theta cos theta phi'^2 + sin theta and L = sin^2 theta phi', with z = cos theta upwards."""

    def rates(_, state):
        theta, _, p = state
        return [p, momentum / np.sin(theta) ** 2, momentum**2 * np.cos(theta) / np.sin(theta) ** 3 + np.sin(theta)]

    x, p = START[:3], START[3:]
    theta = np.arccos(x[2])
    p_theta = -p[2] / np.sin(theta)
    momentum = x[0] * p[1] - x[1] * p[0]
    times = np.linspace(0, 20, 11)
    wanted = solve_ivp(rates, (0, 20), [theta, np.arctan2(x[1], x[0]), p_theta], t_eval=times, **TIGHT).y
    assert abs(x @ p) < 1e-15
    run = lp.integrate(PENDULUM, START, times=times, method=lp.Taylor(tol=1e-15))
    places = np.sin(wanted[0]) * np.cos(wanted[1]), np.sin(wanted[0]) * np.sin(wanted[1]), np.cos(wanted[0])
    np.testing.assert_allclose(run.state[0][:, :3], np.stack(places, 1), atol=1e-8)


@pytest.mark.thorough
def test_the_double_pendulum_in_cartesian_coordinates_is_that_in_angles():
    """Masses and rods of length 1, gravity 1, both places and momenta constrained."""
    plane = lp.canonical(names=("x", "y", "u", "v"))
    rods = ["x^2 + y^2 - 1", "(u - x)^2 + (v - y)^2 - 1"]
    rates = ["x*p_x + y*p_y", "(u - x)*(p_u - p_x) + (v - y)*(p_v - p_y)"]
    bracket = plane.dirac_bracket(rods + rates)
    assert (bracket.rank(), len(bracket.given_casimirs)) == (4, 4)
    here = lp.System(bracket, "(p_x^2 + p_y^2 + p_u^2 + p_v^2)/2 + y + v")
    angles = lp.catalog.system("double-pendulum")
    first, second = 0.9, -0.4
    start = [np.sin(first), -np.cos(first), np.sin(first) + np.sin(second), -np.cos(first) - np.cos(second), 0, 0, 0, 0]
    there = lp.integrate(angles, [first, second, 0, 0], t_end=6).end_state[0]
    state = lp.integrate(here, start, t_end=6).end_state[0]
    np.testing.assert_allclose(state[:2], [np.sin(there[0]), -np.cos(there[0])], atol=1e-9)
    np.testing.assert_allclose(state[2:4] - state[:2], [np.sin(there[1]), -np.cos(there[1])], atol=1e-9)


def test_a_rigid_body_held_in_a_plane_turns_about_one_axis():
    """l1 = l2 = 0 on so(3)* is of second class where l3 != 0: {l1, l2} = -l3; nothing moves on what is left."""
    body = (lp.so(3) @ lp.trivial()).dirac_bracket(["l1", "l2"])
    assert body.rank() == 0
    # of the heavy top with l1 = 0 and alpha2 = 0: {l1, alpha2} = -alpha3
    top = (lp.so(3) @ lp.semidirect(2)).dirac_bracket(["l1", "alpha2"])
    l2, l3, a1, a3 = (sp.Symbol(name) for name in ("l2", "l3", "alpha1", "alpha3"))
    assert top(sp.Symbol("l1"), l3) == 0
    assert sp.simplify(top(l2, a1) - a3) == 0
    assert sp.simplify(top(l2, l3) + sp.Symbol("l1") - a1 * l3 / a3) == 0
    assert top.rank() == 2


# Random brackets and random constraints, against multipliers


def random_polynomial(random, names, degree):
    """A polynomial with a linear part, as text."""
    terms = [f"{random.choice([-2, -1, 1, 2, 3])}*{name}" for name in random.sample(names, 3)]
    for _ in range(3):
        terms.append(f"{random.choice([-2, -1, 1, 2])}/2*" + "*".join(random.choices(names, k=degree)))
    return " + ".join(terms)


def random_bracket(random):
    """A Nambu bracket beside a canonical pair, in bent coordinates: 5 coordinates, rank 4, one Casimir."""
    nambu = lp.brackets.nambu(random_polynomial(random, ["x", "y", "z"], 2), ["x", "y", "z"])
    both = lp.brackets.product(nambu, lp.canonical(names=["q"]))
    a, b = random.choice([-1, 1, 2]), random.choice([-2, 1])
    return both.in_variables(
        {"x": "x", "y": "y", "z": "z", "q": f"q + {a}*x*y", "p": f"p_q + {b}*z"},
        {"x": "x", "y": "y", "z": "z", "q": f"q - {a}*x*y", "p_q": f"p - {b}*z"},
    )


def numbers(names, expressions):
    """The values of formulas at a state, by NumPy."""
    function = sp.lambdify(names, expressions, "numpy")
    return lambda state: np.array(function(*state), float)


def with_multipliers(bracket, constraints, energy):
    r"""x' = J (grad H + sum lambda_a grad phi_a) with lambda such that all phi_a' = 0: no formula of Dirac's."""
    x = bracket.variables
    functions = [sp.sympify(text.replace("^", "**")) for text in [energy, *constraints]]
    J = numbers(x, bracket.poisson_tensor().tolist())
    slopes = numbers(x, [[f.diff(v) for v in x] for f in functions])

    def rates(_, state):
        G, matrix = slopes(state), J(state)
        free = matrix @ G[0]
        forces = matrix @ G[1:].T
        multipliers = np.linalg.solve(G[1:] @ forces, -G[1:] @ free)
        return free + forces @ multipliers

    return rates


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(8))
def test_random_constraints_move_as_with_multipliers(seed):
    random = Random(seed)
    bracket = random_bracket(random)
    names = list(bracket.coordinate_names_in_order)
    constraints = [random_polynomial(random, names, 2) for _ in range(2)]
    energy = " + ".join(f"{name}^2/{k + 2}" for k, name in enumerate(names)) + f" + {names[0]}*{names[3]}/3"
    reduced = bracket.dirac_bracket(constraints)
    rates, system = with_multipliers(bracket, constraints, energy), lp.System(reduced, energy)
    rng = np.random.default_rng(seed)
    x = reduced.variables
    J = numbers(x, reduced.poisson_tensor().tolist())
    slope = numbers(x, [system.hamiltonian.diff(v) for v in x])
    for state in rng.uniform(-1, 1, (5, 5)):
        np.testing.assert_allclose(J(state) @ slope(state), rates(0, state), rtol=1e-8, atol=1e-8)
    assert worst_jacobi(J, 5, rng) < 1e-6
    # constraints and the Casimir of the bracket are Casimirs
    assert len(reduced.given_casimirs) == 3
    for casimir in reduced.given_casimirs:
        slopes = numbers(x, [casimir.diff(v) for v in x])
        for state in rng.uniform(-1, 1, (3, 5)):
            matrix, slope = J(state), slopes(state)
            assert np.abs(matrix @ slope).max() < 1e-9 * (1 + np.abs(matrix).max() * np.abs(slope).max())
    start = rng.uniform(-1, 1, 5)
    speed = np.abs(rates(0, start)).max()
    t_end = 0.3 / max(1, speed)
    run = lp.integrate(system, start, t_end=t_end)
    wanted = solve_ivp(rates, (0, t_end), start, **TIGHT).y[:, -1]
    np.testing.assert_allclose(run.end_state[0], wanted, rtol=1e-7, atol=1e-8)


def worst_jacobi(J, n, rng):
    """The largest cyclic sum at a random state, by differences of the values of the entries."""
    h = 1e-5
    state, unit = rng.uniform(-1, 1, n), np.eye(n)
    here = J(state)
    slope = np.stack([(J(state + h * e) - J(state - h * e)) / (2 * h) for e in unit])  # of J_ij along m
    worst = 0.0
    for i, j, k in combinations(range(n), 3):
        terms = [slope[m, a, b] * here[m, c] for a, b, c in ((i, j, k), (j, k, i), (k, i, j)) for m in range(n)]
        worst = max(worst, abs(sum(terms)) / (1 + np.abs(terms).sum()))
    return worst


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(6))
def test_a_point_on_a_random_surface_obeys_newtons_equations(seed):
    """x'' = -grad V + lambda grad phi on a quadric, with lambda from phi'' = 0; no bracket, no momenta."""
    rng = np.random.default_rng(seed)
    A = np.diag(rng.integers(1, 5, 3)) + np.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]]) * rng.integers(-1, 1) / 2
    phi = f"({A[0, 0]}*x^2 + {A[1, 1]}*y^2 + {A[2, 2]}*z^2 + {int(2 * A[0, 1])}*x*y)/2 - 1"
    slope = [f"{A[0, 0]}*x + {A[0, 1]}*y", f"{A[0, 1]}*x + {A[1, 1]}*y", f"{A[2, 2]}*z"]
    bracket = SPACE.dirac_bracket([phi, " + ".join(f"({s})*p_{v}" for s, v in zip(slope, "xyz", strict=True))])
    system = lp.System(bracket, "(p_x^2 + p_y^2 + p_z^2)/2 + x*y/2 + z")

    def rates(_, state):
        x, v = state[:3], state[3:]
        force = -np.array([x[1] / 2, x[0] / 2, 1])
        normal = A @ x
        return [*v, *(force - normal * (normal @ force + v @ A @ v) / (normal @ normal))]

    x = rng.normal(size=3)
    x /= np.sqrt(x @ A @ x / 2)
    v = np.cross(A @ x, rng.normal(size=3))
    start = [*x, *v / np.linalg.norm(v)]
    wanted = solve_ivp(rates, (0, 5), start, **TIGHT).y[:, -1]
    np.testing.assert_allclose(lp.integrate(system, start, t_end=5).end_state[0], wanted, atol=1e-7)


# What is no set of constraints of second class

FIRST_CLASS = {
    "one alone": (ON_SPHERE[:1], "(x**2 + y**2 + z**2 - 1)", ""),
    "an odd number": ([*ON_SPHERE, "p_x"], "(2*x)*(p_x*x + p_y*y + p_z*z) + (-2)*(p_x)", ""),
    "commuting ones": (["x", "y"], "(x)", ""),
    "one of four": (["x", "p_x", "y + x", "z*p_z"], "(p_z*z)", ""),
    "on a part": (["x*(y - 1)", "p_y"], "(x*(y - 1))", "p_y = 0, x = 0"),
    "an angle": (["x - sin(y)", "cos(y)*p_x + p_y"], "", "10 states"),
}


@pytest.mark.parametrize("case", FIRST_CLASS)
def test_a_combination_of_first_class_is_named(case):
    constraints, combination, part = FIRST_CLASS[case]
    with pytest.raises(ConstraintError, match="second class") as caught:
        SPACE.dirac_bracket(constraints)
    error = caught.value
    assert combination in error.combination
    assert part in error.part
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.combination, again.part) == (str(error), error.combination, error.part)
    assert again.is_proved is error.is_proved is (case != "an angle")


def test_a_casimir_is_first_class():
    with pytest.raises(ConstraintError, match="Casimir") as caught:
        (lp.so(3) @ lp.semidirect(2)).dirac_bracket(["alpha1^2 + alpha2^2 + alpha3^2 - 1", "l3"])
    assert caught.value.combination == "(alpha1**2 + alpha2**2 + alpha3**2 - 1)"


def test_the_surface_decides_and_not_the_space():
    """{x, x p_x + y} = x, which vanishes where x does, and with x - 1 in its place nowhere."""
    for given in (["x", "x*p_x + y"], ["sin(x)", "x*p_x + y"]):
        with pytest.raises(ConstraintError) as caught:
            SPACE.dirac_bracket(given)
        assert caught.value.is_proved is (given[0] == "x")
    assert SPACE.dirac_bracket(["x - 1", "x*p_x + y"]).rank() == 4
    assert SPACE.dirac_bracket(["x^2 + 2*y - 2", "p_x"]).rank() == 4  # 2 x vanishes at some states


REFUSED = {
    "a square": (["x^2", "p_x"], BracketError, "independent gradients"),
    "one twice": (["x", "p_x", "x*p_y - y*p_x", "z", "p_z"], BracketError, "independent gradients"),
    "contradiction": (["x^2 + y^2 + 1", "p_x"], BracketError, "contradict"),
    "never zero": (["exp(x)", "p_x"], BracketError, "not decided"),
    "a number": (["x", "3"], BracketError, "depend on the coordinates"),
    "none": ([], ParameterError, "at least two"),
    "no list": ("x", ParameterError, "list"),
    "an unknown name": (["x", "w"], ExpressionError, "w"),
    "no number": (["x", float("nan")], ParameterError, "finite"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_are_no_constraints_is_refused(case):
    constraints, error, words = REFUSED[case]
    with pytest.raises(error, match=words):
        SPACE.dirac_bracket(constraints)


def test_other_functions_and_parameters():
    """The same sphere by a square root, and with the length of the rod as a name."""
    rooted = SPACE.dirac_bracket(["sqrt(x^2 + y^2 + z^2) - 1", ON_SPHERE[1]])
    rng = np.random.default_rng(2)
    both = [numbers(one.variables, one.poisson_tensor().tolist()) for one in (rooted, PENDULUM.bracket)]
    for state in rng.uniform(-1, 1, (4, 6)):
        np.testing.assert_allclose(both[0](state), both[1](state), atol=1e-12)
    named = SPACE.dirac_bracket({"rod": "x^2 + y^2 + z^2 - d^2", "tangent": ON_SPHERE[1]}, symbols=["d"])
    assert named.poisson_tensor() == PENDULUM.bracket.poisson_tensor()
    assert named.symbols == {"d"}
    assert str(named.given_casimirs[0]) == "-d**2 + x**2 + y**2 + z**2"
    valued = SPACE.dirac_bracket(["x^2 + y^2 + z^2 - d[1]^2", ON_SPHERE[1]], {"d": ["1/3", 2]})
    assert (str(valued.given_casimirs[0]), valued.symbols) == ("x**2 + y**2 + z**2 - 1/9", set())
    with pytest.raises(BracketError, match=r"d is a symbol of the bracket.* bracket.substitute\({'d': ...}\)"):
        named.dirac_bracket(["x - d", "p_x"], {"d": 1})


def test_a_start_where_the_rank_drops_has_an_outcome():
    """l1 = alpha2 = 0 where alpha3 = 0, too: the determinant vanishes, and the bracket has a pole."""
    top = lp.System((lp.so(3) @ lp.semidirect(2)).dirac_bracket(["alpha1", "l2"]), "l1^2/2 + l2^2 + l3^2/3 + alpha3")
    run = lp.integrate(top, [[1, 0, 1, 0, 1, 0], [1, 0, 1, 0, 1, 0.5]], t_end=1)
    assert list(run.outcome) == ["not finite", "finished"]
    with pytest.raises(ParameterError, match="finite"):
        top.bracket.rank([1, 0, 1, 0, 1, 0])


@pytest.mark.parametrize("scale", ["1e-100", "1e100"])
def test_constraints_may_have_any_unit(scale):
    rooted = SPACE.dirac_bracket([f"{scale}*(sqrt(x^2 + y^2 + z^2) - 1)", ON_SPHERE[1]])
    assert rooted.rank() == 4
    with pytest.raises(ConstraintError):
        SPACE.dirac_bracket([f"{scale}*sin(x)", "y"])
