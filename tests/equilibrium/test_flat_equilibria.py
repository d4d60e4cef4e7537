"""Degenerate equilibria: the answer is right or "undecided", in all coordinates. What is right is algebra on paper."""

from contextlib import suppress

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.phase_space import equilibrium, equilibrium_near

KINETIC = {n: " + ".join(f"p_{q}^2/2" for q in "xyz"[:n]) for n in (1, 2, 3)}
SEEDS = [0, *(pytest.param(k, marks=pytest.mark.thorough) for k in (1, 2))]


def canonical(names, hamiltonian):
    return lp.System(lp.canonical(names=list(names)), hamiltonian)


def near(system, guess, **options):
    with suppress(ParameterError):
        return equilibrium_near(system, guess, **options)
    return None


def on_sphere(hamiltonian, **integrals):
    return lp.System(lp.so(3) @ lp.trivial(), hamiltonian, integrals=integrals)


DEGENERATE = [
    # names, H, and what may be decided: positions of equilibria with their signatures, degenerate ones by algebra only
    ("x", "p_x^3 + p_x*x^2", [((0,), (0, 0, 2))]),  # no extremum: x' = x^2 on p = 0
    ("x", "p_x^4 + x^4 + 10*p_x^2*x^2", [((0,), (0, 0, 2))]),  # a strict minimum
    ("x", "sinh(p_x^4 + x^4 + 10*p_x^2*x^2)", []),
    ("x", "tanh(p_x^3 + p_x*x^2)", []),
    ("x", "p_x^4 + (x - sqrt(2))^4 + 10*p_x^2*(x - sqrt(2))^2", []),
    ("xy", "sinh((p_x^2 + p_y^2 + x^2 + y^2)^2 - 1.1*x^4)", []),  # a saddle: < 0 on the x axis, > 0 on the y axis
    ("x", "cosh(p_x) + (exp(x - 1) - 1)^14", []),
    ("x", "T + exp(-x^8)", []),
    ("x", "T + x^4*exp(x)", [((-4,), (1, 1, 0))]),
    ("x", "T + tanh((x - 1)^5)", []),
    ("x", "T + (x - 1)^3*(x - 1.001)^3*exp(-x)", [((3 + 0.0005 + np.sqrt(9 + 0.0005**2) + 1,), (1, 1, 0))]),
    (
        "x",
        "T + exp(x)*((x - 1)^2 + 1/1000)^5",
        [((-4 + s * np.sqrt(25 - 1e-3),), (1 + (s > 0), s < 0, 0)) for s in (-1, 1)],
    ),
    ("xy", "T + sinh((x + 2*y - 3)^3 + (x + 2*y - 3)*(2*x - y - 1)^2)", []),  # 3 u^2 + v^2 = 0 and u v = 0
    ("xy", "T + sinh((x + 2*y - 3)^4 + (x + 2*y - 3)*(2*x - y - 1)^2)", []),  # 4 u^3 + v^2 = 0 and u v = 0
    ("xy", "T + (x + exp(y))^2/2 + tanh(y)^3", []),
    ("xy", "T + cosh(x^10 + y^8)", []),
    # (x - 19/8)^3/2 and 3 (x + 27/8)^3/4 with their terms, which cancel to more than their round-off
    ("x", "p_x^2/1000 + sinh(x^4/8 - 19*x^3/16 + 1083*x^2/256 - 6859*x/1024)", []),
    ("x", "T + sinh(3*x^4/16 + 81*x^3/32 + 6561*x^2/512 + 59049*x/2048)", []),
    # families without a symmetry that is known
    ("x", "exp(p_x^2*x^2)", []),
    ("xy", "T + cosh((y - x^2)^2)", []),
    ("xy", "T + (x^2 + y^2 - 1)^2*exp(x)", [((-2 - np.sqrt(5), 0), (3, 1, 0)), ((-2 + np.sqrt(5), 0), (2, 2, 0))]),
    ("xy", "T + cosh(10*((x - 1)^2 + y^2 - 1/100))", [((1, 0), (2, 2, 0))]),
    ("xyz", "T + cosh(x*y*z) - 1", []),
    # tails
    ("x", "T + exp(x)", []),
    ("x", "T + exp(-exp(x))", []),
    ("x", "T + tanh(x + x^3)", []),
    ("x", "T + exp(-1/x^2)", []),
    ("x", "T + tanh(x^9/9 + x^7/2000)", []),
]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("case", DEGENERATE, ids=[case[1] for case in DEGENERATE])
def test_what_is_decided_is_right(case, seed):
    names, hamiltonian, real = case
    system = canonical(names, hamiltonian.replace("T", KINETIC[len(names)]))
    found = lp.equilibria(system, {}, n_starts=20, most_starts=20, seed=seed)
    assert found.n_undecided == sum(e.family == "undecided" for e in found)
    for one in found:
        assert is_right(one, real)
    guesses = np.random.default_rng(seed).normal(size=(4, 2 * len(names))) * [0.3, 1, 1, 0.1][seed]
    for one in filter(None, (near(system, guess) for guess in guesses)):
        assert is_right(one, real)
        with suppress(ParameterError):  # where all is flat the residual of the state is large beside its terms
            assert is_right(equilibrium(system, one.state), real)


def is_right(one, real):
    """Whether an equilibrium is one of those, with its signature; or undecided, and then nothing is said of it."""
    if one.family == "undecided":
        silent = (one.signature[:2], one.growth_rate, one.linear_stability, one.nonlinear_stability)
        return silent == ((0, 0), 0, "undecided", "undecided") and "undecided" in repr(one)
    n = len(one.state) // 2
    return any(
        np.abs(one.state - [*place, *np.zeros(n)]).max() < 1e-9 and one.signature == signature
        for place, signature in real
    )


@pytest.mark.parametrize("scale", ["1", "sqrt(2)"])
def test_flat_poles_of_a_sphere(scale):
    # l1^2 + l2^2 <= 1: extrema at +-e1, the poles are flat
    found = lp.equilibria(on_sphere(f"{scale}*(l1^3 + l1*l2^2)"), {"C1": 1}, n_starts=40)
    decided = [e for e in found if e.family != "undecided"]
    assert sorted(e.signature for e in decided if e.nullity == 0) == [(0, 2, 0), (2, 0, 0)]
    assert all(e.signature == (0, 0, 2) for e in decided if e.nullity)  # by algebra, where the numbers are rational
    assert "missing" not in found.completeness


MATRICES = {
    "turned": np.array([[0.8, 0.6], [-0.6, 0.8]]),
    "scaled": np.diag([2.0, 0.25]),
    "exchanged": np.array([[0.0, 1.0], [1.0, 0.0]]),
}


@pytest.mark.parametrize("how", MATRICES)
@pytest.mark.parametrize(
    "potential", ["sinh({u}^4 + {v}^2)", "cosh({u})*exp({v}^2) - {u}*{v}/3", "tanh({u}^2 - {v}^2)"]
)
def test_coordinates_change_no_verdict(how, potential):
    """With q = M u and the kinetic energy of u, the equilibria are the same states."""
    matrix = MATRICES[how]
    (a, b), (c, d) = np.linalg.inv(matrix).tolist()
    linear = {"u": f"({a}*x + {b}*y)", "v": f"({c}*x + {d}*y)"}
    m = matrix.T.tolist()
    momenta = [f"({row[0]}*p_x + {row[1]}*p_y)^2/2" for row in m]
    first = canonical("xy", f"{KINETIC[2]} + {potential.format(u='x', v='y')}")
    other = canonical("xy", f"{' + '.join(momenta)} + {potential.format(**linear)}")
    lists = [lp.equilibria(system, {}, n_starts=30, most_starts=30) for system in (first, other)]
    decided = [sorted((e.family, e.signature) for e in found if e.family != "undecided") for found in lists]
    assert decided[0] == decided[1]
    assert all(found.n_undecided for found in lists) or "^4" not in potential


def test_curvatures_that_are_small_are_no_flat_ones():
    for size in (1e-6, 1e-9):  # a minimum with quartic terms that are much larger beside it
        found = equilibrium_near(canonical("x", f"{size}*(p_x^2 + sin(x)^2) + p_x^4 + sin(x)^4"), [1e-6, 0])
        assert (found.family, found.signature) == ("point", (2, 0, 0))


def test_the_sum_of_signs_says_nothing_where_circles_cross():
    # four maxima and two great circles that meet at the poles: 4 + (2 - 4) = 2, and not 4 + 0
    found = lp.equilibria(on_sphere("l1^2*l2^2"), {"C1": 1}, n_starts=40)
    assert sum(e.family == "point" for e in found) == 4
    assert found.euler_found is None
    assert "missing" not in found.completeness


@pytest.mark.parametrize("shift", [2, 3])
def test_clusters_beside_a_large_hill(shift):
    # V' = exp(-q^2) (q - a)^4 (q - b)^3 (5 (q - b) + 4 (q - a) - 2 q (q - a)(q - b)); beside a hill of 1e4
    a, b = shift, shift + 0.001
    cubic = np.polynomial.Polynomial([-5 * b - 4 * a, 9]) - 2 * np.polynomial.Polynomial.fromroots([0, a, b])
    system = canonical("q", f"p_q^2/2 + (q - {a})^5*(q - {b})^4*exp(-q^2)")
    for seed in (1, 2, 3):
        found = lp.equilibria(system, {}, seed=seed, n_starts=60, most_starts=60)
        decided = [e.state[0] for e in found if e.family != "undecided"]
        assert all(np.abs(cubic.roots().real - q).min() < 1e-9 for q in decided)
        assert found.n_undecided


@pytest.mark.thorough
@pytest.mark.parametrize("power", [3, 4])
def test_equilibria_of_different_orders_in_tilted_coordinates(power):
    # u^p + u v^2 has u = v = 0 alone: p u^(p-1) + v^2 = 0 and u v = 0
    system = canonical("xy", f"{KINETIC[2]} + sinh((x + 2*y - 3)^{power} + (x + 2*y - 3)*(2*x - y - 1)^2)")
    for seed in range(12):
        found = near(system, np.array([1, 1, 0, 0]) + 0.05 * np.random.default_rng(seed).normal(size=4))
        assert found is None or (found.family, found.signature) == ("undecided", (0, 0, 4))


def test_steep_functions_that_overflow_near_a_state_are_left_out():
    inner = "(3*q1/2 - 2*q2)^2 + (2*q1 - 3*q2/2 - 7/4)^3"
    system = canonical(("q1", "q2"), f"(p_q1^2 + p_q2^2)/2 + 10*sinh({inner})")
    found = lp.equilibria(system, {}, n_starts=300, most_starts=300)
    assert all(e.family == "undecided" or np.abs(e.state - [2, 1.5, 0, 0]).max() < 1e-3 for e in found)


@pytest.mark.parametrize(
    "potential", ["alpha3 + 1.5*alpha3^2/2", "alpha3 + 2.5*alpha3^2/2", "exp(1.5*alpha3) - 2*alpha3"]
)
def test_circles_of_a_heavy_top_whose_symmetry_is_known(potential):
    """Of H = |l|^2/2 + V(alpha3) on l.alpha = 0, |alpha| = 1: l = 0, and V'(alpha3) = 0 or alpha = +-e3."""
    leaf = {"C1": 0, "C2": 1}
    system = lp.System(lp.so(3) @ lp.semidirect(2), f"dot(l, l)/2 + {potential}", integrals={"l3": "l3"})
    found = lp.equilibria(system, leaf, n_starts=40, most_starts=40)
    assert sorted(e.family for e in found) == ["circle", "point", "point"]
    assert found.euler_found == 2
    without = lp.System(lp.so(3) @ lp.semidirect(2), f"dot(l, l)/2 + {potential}")
    undecided = lp.equilibria(without, leaf, n_starts=40, most_starts=40)
    assert {e.family for e in undecided} == {"point", "undecided"}
    assert undecided.euler_found is None


@pytest.mark.parametrize("hamiltonian", ["cosh(l3)", "exp(l3^2)"])
def test_a_circle_on_a_sphere_is_decided_where_its_symmetry_is_known(hamiltonian):
    """grad H is parallel to l at the poles and where l3 = 0."""
    circle, *poles = lp.equilibria(on_sphere(hamiltonian, l3="l3"), {"C1": 1}, n_starts=20, seed=1)
    assert (circle.family, circle.signature) == ("circle", (1, 0, 1))
    assert [(pole.family, pole.signature) for pole in poles] == [("point", (0, 2, 0))] * 2


@pytest.mark.parametrize("hamiltonian", ["l3^4", "cosh(l3^8)"])
def test_a_circle_that_is_flat_across_is_undecided(hamiltonian):
    found = lp.equilibria(on_sphere(hamiltonian, l3="l3"), {"C1": 1}, n_starts=20, seed=1)
    decided = [e for e in found if e.family != "undecided"]
    assert [(pole.family, pole.signature) for pole in decided] == [("point", (0, 2, 0))] * 2
    assert all(abs(e.state[2]) < 0.6 for e in found if e.family == "undecided")


def test_three_waves_at_rest_are_undecided():
    # H is cubic; any one of the waves may have any amplitude if the others are at rest
    system = lp.catalog.system("three-wave")
    for seed in range(3):
        found = equilibrium_near(system, 0.1 * np.random.default_rng(seed).normal(size=6))
        assert (found.family, found.signature) == ("undecided", (0, 0, 6))
    assert equilibrium(system, np.zeros(6)).linear_stability == "degenerate"  # in exact numbers


def test_exact_states_of_families_that_cross_are_degenerate():
    found = lp.equilibria(canonical("x", "(p_x^2 - x^2)^2"), {}, n_starts=20)
    for one in found:
        assert (one.family, one.signature) in {("degenerate", (1, 0, 1)), ("undecided", (0, 0, 2))}


@pytest.mark.parametrize("seed", range(5))
def test_a_sleeping_top_is_no_small_circle(seed):
    # critical cosines of l3^2 (1 - c)/(2 (1 + c)) + c are l3 - 1 > 1
    system = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
    leaf = {"C1": 2.01, "C2": 1}
    (found,) = lp.equilibria(system, leaf, along=("l3",), values={"l3": 2.01}, n_starts=40, seed=seed)
    assert (found.family, found.signature) == ("point", (4, 0, 0))
    s, c = np.sin(tilt := 10.0 ** -(seed + 2)), np.cos(tilt)
    guess = [2.01 * (1 - c) / s, 0, 2.01, s, 0, c]
    reached = near(system, guess, along=("l3",), values={"l3": 2.01})
    verdicts = {("point", (4, 0, 0)), ("undecided", (0, 0, 2)), ("undecided", (0, 0, 4))}
    assert reached is None or (reached.family, reached.signature) in verdicts


def test_stiffness_across_the_leaf_makes_nothing_flat():
    # cosh of a Casimir is constant on the leaf; what is left is the free body with 1/2, 3/2 and 1
    body = "l1^2/2 + 3*l2^2/2 + l3^2 + 3*10^{k}*cosh(l1^2 + l2^2 + l3^2 - 1)"
    found = lp.equilibria(on_sphere(body.format(k=6)), {"C1": 1})
    assert sorted(e.signature for e in found) == [(0, 2, 0)] * 2 + [(1, 1, 0)] * 2 + [(2, 0, 0)] * 2
    assert [round(e.growth_rate, 2) for e in found if e.linear_stability == "unstable"] == [1, 1]
    stiff = lp.equilibria(on_sphere(body.format(k=12)), {"C1": 1}, n_starts=40, most_starts=40)
    for e in stiff:
        axis = int(np.argmax(np.abs(e.state)))
        assert e.family == "undecided" or e.signature == [(2, 0, 0), (0, 2, 0), (1, 1, 0)][axis]


def test_a_rounded_state_makes_no_curvature():
    """x = sqrt(2) is rounded: (x^2 - 2)^2 is not zero there, and its second derivative says nothing."""
    found = lp.equilibria(canonical("x", "p_x^4 + (x^2 - 2)^4"), {})
    assert found.proved
    at_root = [e for e in found if abs(abs(e.state[0]) - np.sqrt(2)) < 1e-9]
    assert len(at_root) == 2
    assert all(e.signature == (0, 0, 2) for e in at_root)
