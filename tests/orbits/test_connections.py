"""Homoclinic and heteroclinic orbits without symmetry."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.orbits import connecting_orbits
from liepoisson.orbits.symmetric_orbits import group_of_level

equilibrium = lp.phase_space.equilibrium
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)", name="pendulum")
WELL = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 + q1^4/4", name="well")
OFF = lp.System(lp.canonical(1), "p1^2/2 - (q1 - 1)^2/2 - (q1 - 1)^3/3 + p1*(q1 - 1)^2/5", name="off the origin")
FOCUS = "p1*q2 + p2^2/2 + q2^2/4 - q1^2/2 + q1^3/3"
SYMMETRIC = lp.System(lp.canonical(2), FOCUS, name="saddle-focus")
BROKEN = lp.System(lp.canonical(2), f"{FOCUS} + q2^3/5", name="saddle-focus without reverser")
MAGNETIC = lp.System(
    lp.canonical(2, names=["x", "y"]),
    "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3 + x^2*p_y/10",
    name="Henon and Heiles in a magnetic field",
)


def two_pendula(coupling):
    """A pendulum and an oscillator, and the periodic orbits above the saddles at -pi and pi."""
    system = lp.System(lp.canonical(2), f"p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + {coupling}*q2*sin(q1)", name="two")
    return [lp.orbits.periodic_orbit(system, [angle, 0, 0, 0.4], period=6.3, energy="1.1") for angle in (-np.pi, np.pi)]


def test_the_separatrix_of_the_pendulum_connects_its_upper_equilibria():
    """q = 4 arctan(e^t) - pi."""
    (one,) = connecting_orbits(*(equilibrium(PENDULUM, [angle, 0]) for angle in (-np.pi, np.pi)))
    times, states = one.states(101)
    place = np.log(np.tan((one.middle[0] + np.pi) / 4))
    np.testing.assert_allclose(states[:, 0], 4 * np.arctan(np.exp(times + place)) - np.pi, atol=1e-12)
    assert times[[0, -1]].tolist() == [-one.times[0], one.times[1]]
    assert len(times) == 101
    assert one.residual < 1e-13
    assert "heteroclinic" in repr(one)


def test_the_two_loops_of_the_double_well():
    """sqrt(2)/cosh(t) on both sides: a symmetric search lists one of them."""
    found = connecting_orbits(equilibrium(WELL, [0, 0]))
    assert len(found) == 2
    for one in found:
        times, states = one.states(101)
        place = np.arccosh(np.sqrt(2) / abs(one.middle[0])) * -np.sign(one.middle[0] * one.middle[1])
        x = np.sign(one.middle[0]) * np.sqrt(2) / np.cosh(times + place)
        np.testing.assert_allclose(states[:, 0], x, atol=1e-7)


def test_an_equilibrium_off_the_origin_without_reverser():
    """A gauge: with P = p + (q - 1)^2 / 5 it is a cubic, on the level of the saddle p is known from q."""
    (one,) = connecting_orbits(equilibrium(OFF, [1, 0]))
    _, states = one.states(201)
    q, p = states.T
    energy = p**2 / 2 - (q - 1) ** 2 / 2 - (q - 1) ** 3 / 3 + p * (q - 1) ** 2 / 5
    np.testing.assert_allclose(energy, 0, atol=1e-12)  # d^3: measured 3.4e-13
    assert q.min() < 0
    assert np.abs(states[[0, -1]] - [1, 0]).max() < 1e-3


@pytest.mark.parametrize("system", [SYMMETRIC, BROKEN], ids=["with a reverser", "without"])
@pytest.mark.parametrize("n_starts", [100, pytest.param(400, marks=pytest.mark.slow)])
def test_a_saddle_focus(system, n_starts):
    r"""Rates $0.61 \pm 0.79i$; its orbits are solutions of $u'''' + u''/2 + u = u^2$ if nothing is broken."""
    origin = equilibrium(system, [0] * 4)
    assert np.abs(origin.spectrum.imag).min() > 0.5
    assert bool(lp.systems.discrete_symmetries(system).reversers) == (system is SYMMETRIC)
    found = connecting_orbits(origin, n_starts=n_starts)
    assert len(found) > 0
    assert found[0].angles[0] > 1
    for one in found:
        assert one.residual < 1e-11
        assert follows_scipy(one) < 1e-7


def follows_scipy(one):
    """The largest difference from another integrator, from the middle both ways."""
    times, states = one.states(41)
    most = 0.0
    for part in (times >= 0, times <= 0):
        t, x = times[part], states[part]
        t, x = (t, x) if t[0] == 0 else (t[::-1], x[::-1])
        run = solve_ivp(lambda _, y: one.system.vector_field(y), (0, t[-1]), x[0], "DOP853", t, rtol=1e-13, atol=1e-15)
        most = max(most, float(np.abs(run.y.T - x).max()))
    return most


def test_symmetric_ones_are_found_again_without_the_symmetry():
    origin = equilibrium(SYMMETRIC, [0] * 4)
    wanted = lp.orbits.symmetric_homoclinic_orbits(origin, n_starts=100)[0]
    paths = [one.states(4001)[1] for one in connecting_orbits(origin)]
    assert min(np.linalg.norm(path - wanted.midpoint, axis=1).min() for path in paths) < 1e-2


def test_heteroclinic_orbits_between_periodic_ones():
    source, target = two_pendula("1/10")
    found = connecting_orbits(source, target, n_starts=100)
    assert len(found) > 2
    for one in found:
        _, states = one.states(11)
        np.testing.assert_allclose(one.system.functions.energy(states), 1.1, atol=1e-9)
        assert abs(states[0, 0] + np.pi) < 0.1
        assert abs(states[-1, 0] - np.pi) < 0.1
        assert one.angles[0] > 1e-3
    assert (
        connecting_orbits(source, target, n_starts=20)
        .to_dataframe()
        .equals(connecting_orbits(source, target, n_starts=20, threads=1).to_dataframe())
    )


def test_manifolds_that_coincide_are_families():
    """Without the coupling the manifolds of both are one: nothing is isolated."""
    found = connecting_orbits(*two_pendula("0"), n_starts=10)
    assert len(found) == 0
    assert found.n_families > 0
    assert "do not cross" in str(found)


@pytest.mark.thorough
def test_a_periodic_orbit_without_any_reverser():
    """Checked by another integrator: the states on the way, and that both ends are near the periodic orbit."""
    assert not lp.systems.discrete_symmetries(MAGNETIC).reversers
    gamma = lp.orbits.periodic_orbits(MAGNETIC, {}, energy="1/8", n_starts=10)[0]
    found = connecting_orbits(gamma, n_starts=60)
    assert len(found) > 10
    path = gamma.states(4001)
    for one in found[:1]:
        _, states = one.states(11)
        assert np.linalg.norm(path - states[0], axis=1).min() < 1e-3
        assert np.linalg.norm(path - states[-1], axis=1).min() < 1e-3
        assert follows_scipy(one) < 1e-5


@pytest.mark.slow
def test_that_of_the_proof_is_found_without_the_reversers(twisted_orbits, homoclinic_orbits):
    """The first of 52 symmetric ones, among them that of the proof, by the angles where it meets its mirror image."""
    gamma = twisted_orbits[0]
    found = connecting_orbits(gamma, n_starts=400)
    group = np.array(group_of_level(gamma.level))
    paths = np.concatenate([one.states(4001)[1] for one in found])
    missed = [
        k
        for k, one in enumerate(homoclinic_orbits[:6])
        if min(np.linalg.norm(paths - image, axis=1).min() for image in group @ one.midpoint) > 1e-2
    ]
    assert missed == []


def test_other_levels_and_systems_are_refused():
    upright = equilibrium(PENDULUM, [np.pi, 0])
    low, high = (lp.orbits.periodic_orbit(two_pendula("0")[0].system, [np.pi, 0, 0, v], period=6.3) for v in (0.4, 0.6))
    spun = [equilibrium(lp.catalog.system("lagrange"), [0, 0, s, 0, 0, 1]) for s in (0.1, 0.2)]
    for source, target, words in (
        (upright, equilibrium(WELL, [0, 0]), "target: wanted one of"),
        (low, high, "same energy"),
        (*spun, "target: wanted one with the same"),
        (equilibrium(PENDULUM, [0, 0]), None, "source: wanted hyperbolic directions; the equilibrium is a centre"),
        (upright, equilibrium(PENDULUM, [0, 0]), "target: wanted hyperbolic directions"),
        (upright, "upright", "target: wanted a periodic orbit or an equilibrium"),
    ):
        with pytest.raises(ParameterError, match=words):
            connecting_orbits(source, target)
