"""Degenerate equilibria: the answer is right or "undecided", in all coordinates. What is right is algebra on paper."""

from contextlib import suppress

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.phase_space import equilibrium, equilibrium_near

KINETIC = {n: " + ".join(f"p_{q}^2/2" for q in "xyz"[:n]) for n in (1, 2, 3)}
SEEDS = [0, pytest.param(1, marks=pytest.mark.slow)]


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
    ("x", "p_x^4 + (x - sqrt(2))^4 + 10*p_x^2*(x - sqrt(2))^2", []),
    ("xy", "sinh((p_x^2 + p_y^2 + x^2 + y^2)^2 - 1.1*x^4)", []),  # a saddle: < 0 on the x axis, > 0 on the y axis
    ("x", "T + exp(-x^8)", []),
    ("x", "T + x^4*exp(x)", [((-4,), (1, 1, 0))]),
    ("x", "T + (x - 1)^3*(x - 1.001)^3*exp(-x)", [((3 + 0.0005 + np.sqrt(9 + 0.0005**2) + 1,), (1, 1, 0))]),
    ("xy", "T + sinh((x + 2*y - 3)^4 + (x + 2*y - 3)*(2*x - y - 1)^2)", []),  # 4 u^3 + v^2 = 0 and u v = 0
    ("xy", "T + (x + exp(y))^2/2 + tanh(y)^3", []),
    ("xy", "T + cosh(x^10 + y^8)", []),
    # (x - 19/8)^3/2 with its terms, which cancel to more than their round-off
    ("x", "p_x^2/1000 + sinh(x^4/8 - 19*x^3/16 + 1083*x^2/256 - 6859*x/1024)", []),
    # families without a symmetry that is known
    ("x", "exp(p_x^2*x^2)", []),
    ("xy", "T + (x^2 + y^2 - 1)^2*exp(x)", [((-2 - np.sqrt(5), 0), (3, 1, 0)), ((-2 + np.sqrt(5), 0), (2, 2, 0))]),
    ("xy", "T + cosh(10*((x - 1)^2 + y^2 - 1/100))", [((1, 0), (2, 2, 0))]),
    ("xyz", "T + cosh(x*y*z) - 1", []),
    # tails
    ("x", "T + exp(x)", []),
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


@pytest.mark.parametrize("potential", ["alpha3 + 2.5*alpha3^2/2", "exp(1.5*alpha3) - 2*alpha3"])
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


@pytest.mark.parametrize("hamiltonian", ["cosh(l3^8)"])
def test_a_circle_that_is_flat_across_is_undecided(hamiltonian):
    found = lp.equilibria(on_sphere(hamiltonian, l3="l3"), {"C1": 1}, n_starts=20, seed=1)
    decided = [e for e in found if e.family != "undecided"]
    assert [(pole.family, pole.signature) for pole in decided] == [("point", (0, 2, 0))] * 2
    assert all(abs(e.state[2]) < 0.6 for e in found if e.family == "undecided")
