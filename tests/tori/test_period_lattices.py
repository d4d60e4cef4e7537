"""Period lattices against frequencies of orbits, elliptic integrals and quadrature on the spectral curve."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from lattices import check_frequencies, same_lattice
from scipy.special import ellipk

import liepoisson as lp
from liepoisson.errors import OrbitError, ParameterError, ShapeError, TimeLimitError

TOP = lp.Top.twisted_lagrange()
PENDULUM = lp.catalog.system("spherical-pendulum")
ON_SPHERE = [0.3, 0.8, 0.2, 0.8, 0, 0.6]
SIGNALS = {
    "free-rigid-body": ("l1", "l2", "l3"),
    "lagrange": ("l1", "alpha1", "alpha3"),
    "kovalevskaya": ("l3", "alpha3"),
    "goryachev-chaplygin": ("l2", "l3", "alpha1"),
    "spherical-pendulum": ("alpha1", "alpha3"),
    "manakov-so4": ("M12", "M13", "M14"),
    "henon-heiles-sawada-kotera": ("x + y", "x - y"),
    "twisted-lagrange": ("l1", "beta3", "alpha1"),
}
"""What is analysed along orbits; the last system has three frequencies."""


def state_of(system, seed):
    """A random state, of the polynomial one inside of the well."""
    if system.name.startswith("henon"):
        return np.random.default_rng(seed).uniform(-0.25, 0.25, 4)
    state = lp.sample_states(system, 1, seed=seed)[0]
    if system.partial_integrals:  # away from the resonance 1:2 of the equilibrium, where combinations are slow
        return lp.Leaf(system, {"C1": 0, "C2": 1}).project(state * [3, 3, 3, 1, 1, 1])
    return state


def momentum_of(system):
    return lp.tori.momentum_map(system, leaf=lp.Leaf(system, {"C1": 0, "C2": 1}) if system.partial_integrals else None)


@pytest.mark.thorough
@pytest.mark.parametrize("name", SIGNALS)
def test_frequencies_are_those_of_orbits(name):
    system = lp.catalog.system(name)
    start = state_of(system, 3 if name != "twisted-lagrange" else 7)
    check_frequencies(momentum_of(system), start, SIGNALS[name][:1])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("name", SIGNALS)
def test_frequencies_of_many_tori_are_those_of_orbits(name, seed):
    system = lp.catalog.system(name)
    check_frequencies(momentum_of(system), state_of(system, seed), SIGNALS[name])


@pytest.mark.parametrize("seed", range(5))
def test_the_spherical_pendulum_has_its_elliptic_integrals(seed):
    r"""With $\dot z^2 = 2(z_3 - z)(z_2 - z)(z - z_1)$ and $z = z_m + z_r\sin\theta$.

    The period is $T = 2\int d\theta/\sqrt{2(z_3 - z)}$, the azimuth turns by $\int -l_3/(1 - z^2)\,dt$, and the flow of
    l3 turns it by -1 per time.
    """
    x = state_of(PENDULUM, seed)
    x[3:] /= np.linalg.norm(x[3:])
    x[:3] -= (x[:3] @ x[3:]) * x[3:]
    with mp.workdps(30):
        h, l3 = mp.fsum(mp.mpf(v) ** 2 for v in x[:3]) / 2 + mp.mpf(x[5]), mp.mpf(x[2])
        low, high, above = sorted(mp.re(root) for root in mp.polyroots([2, -2 * h, -2, 2 * h - l3**2], extraprec=100))
        # near the pole 1 + z is small
        width, depth, gap = (float(part) for part in (high - low, 1 + low, above - low))
    theta = (np.arange(2000) + 0.5) * np.pi / 2000 - np.pi / 2
    rise = width / 2 * (1 + np.sin(theta))
    rate = np.sqrt(2 * (gap - rise))
    period = 2 * np.pi * (1 / rate).mean()
    turn = 2 * np.pi * (float(l3) / ((depth + rise) * (2 - depth - rise)) / rate).mean()
    torus = lp.tori.period_lattice(PENDULUM, x)
    assert same_lattice(torus.periods, np.array([[period, -turn], [0, 2 * np.pi]])) < 1e-13
    middle = depth - 1 + width / 2
    seen = lp.section(PENDULUM, x, surface=f"alpha3 - {middle!r}", direction=1, t_end=5 * period)
    azimuth = np.unwrap(np.arctan2(seen.state[:, 4], seen.state[:, 3]))
    np.testing.assert_allclose(np.diff(seen.time), period, rtol=1e-12)
    np.testing.assert_allclose((np.diff(azimuth) + turn + 1e-9) % (2 * np.pi), 1e-9, atol=1e-11)


@pytest.mark.parametrize("seed", range(10))
def test_the_free_body_has_the_period_of_jacobi(seed):
    r"""$T = 4K\sqrt{I_1I_2I_3/((I_3 - I_2)(M^2 - 2EI_1))}$, for $M^2 > 2EI_2$; else with 1 and 3 exchanged."""
    body = lp.catalog.system("free-rigid-body")
    moments = [1 / float(body.hamiltonian.diff(v, 2)) for v in body.variables]
    x = state_of(body, seed)
    order = np.argsort(moments)
    first, middle, last = (moments[k] for k in order)
    square, twice = x @ x, x @ (x / moments)
    if square < twice * middle:
        first, last = last, first
    scale = (last - middle) * (square - twice * first)
    parameter = (middle - first) * (twice * last - square) / scale
    wanted = 4 * ellipk(parameter) * np.sqrt(first * middle * last / scale)
    torus = lp.tori.period_lattice(body, x)
    np.testing.assert_allclose(np.abs(torus.periods), [[wanted]], rtol=1e-13)


def charged():
    return lp.Top.twisted(inertia=(2, 2, 1), a=(0, 0, "3/2"), b=(0, 0, -1), epsilon="5/7")


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("make", [lp.Top.twisted_lagrange, charged])
def test_the_lattice_on_the_spectral_curve_is_that_of_closing_flows(make, seed):
    top = make()
    x = state_of(top, seed)
    diagram = lp.tori.lagrange_diagram(lp.Leaf.through(top, x))
    by_flows = lp.tori.period_lattice(diagram.momentum, x)
    by_quadrature = lp.tori.lagrange_lattice(diagram, by_flows.values)
    assert same_lattice(by_quadrature, by_flows.periods) < 1e-11
    circle = by_quadrature[0] - by_quadrature[1] + by_quadrature[2]
    np.testing.assert_allclose(circle, [0, 2 * np.pi, 0], atol=1e-12)


def slope(function, x, k, step=0.02, n=5):
    """The derivative along x_k, by central differences and Richardson's extrapolation."""
    unit = np.eye(len(x))[k]
    rows = [(function(x + h * unit) - function(x - h * unit)) / (2 * h) for h in step / 2.0 ** np.arange(n)]
    for order in range(1, n):
        rows = [(4**order * fine - rough) / (4**order - 1) for rough, fine in pairwise(rows)]
    return rows[0]


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("make", [lp.Top.twisted_lagrange, charged])
def test_periods_are_derivatives_of_actions(make, seed):
    r"""$2\pi\,dJ = $ periods, and $J_1 - J_2 + J_3$ is $\ell_3$ but for a constant of the leaf."""
    top = make()
    x = state_of(top, seed)
    diagram = lp.tori.lagrange_diagram(lp.Leaf.through(top, x))
    values = diagram.momentum(x)
    step = 0.02 * min(1.0, diagram.depth(values) * 10)

    def actions(at):
        return lp.tori.lagrange_actions(diagram, at)

    slopes = np.stack([slope(actions, values, k, step) for k in range(3)], axis=1)
    periods = lp.tori.lagrange_lattice(diagram, values)
    np.testing.assert_allclose(slopes, periods / (2 * np.pi), atol=1e-8)
    there = values + step * np.array([0.3, -0.5, 0.4])
    change = actions(there) - actions(values)
    np.testing.assert_allclose(change[0] - change[1] + change[2], there[1] - values[1], atol=1e-13)


@pytest.mark.thorough
def test_other_seeds_give_the_same_lattice_and_a_reduced_basis():
    bases = [lp.tori.period_lattice(TOP, state_of(TOP, 7), seed=seed).periods for seed in range(3)]
    assert max(same_lattice(bases[0], other) for other in bases[1:]) < 1e-12


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: lp.tori.period_lattice(PENDULUM, [0, 0, 0, 0, 0, 1]), OrbitError, "critical one"),
        (lambda: lp.tori.period_lattice(PENDULUM, [ON_SPHERE, ON_SPHERE]), ShapeError, "one state"),
        (lambda: lp.tori.period_lattice(PENDULUM, ON_SPHERE, integrals=["l1"]), ParameterError, "l1"),
        (
            lambda: lp.tori.period_lattice(PENDULUM, ON_SPHERE, integrals=["l3", "l2"]),
            ParameterError,
            "wanted 1 beside",
        ),
        (lambda: lp.tori.period_lattice(PENDULUM, ON_SPHERE, time_limit=1e-4), TimeLimitError, "time limit"),
        (
            lambda: lp.tori.period_lattice(lp.System(lp.canonical(names=["q"]), "p_q^2/2 - q^2/2"), [1, 0]),
            OrbitError,
            "not compact",
        ),
    ],
)
def test_what_is_no_torus_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_values_outside_of_the_image_have_no_lattice():
    diagram = lp.tori.lagrange_diagram(lp.Leaf(TOP, {"C1": 0.5, "C2": 0.2, "C3": 1}))
    for function in (lp.tori.lagrange_lattice, lp.tori.lagrange_actions):
        with pytest.raises(OrbitError, match="inside of the image"):
            function(diagram, [-9, 0, 0])
        with pytest.raises(ShapeError, match="values: wanted"):
            function(diagram, [3, 0.5])
