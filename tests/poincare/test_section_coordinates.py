"""Surfaces that suit a leaf, and axes that fold a section."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.poincare.default_surface import surface_and_reason
from liepoisson.poincare.section_sheets import idle_components, section_axes


@pytest.mark.parametrize(
    ("name", "start", "function"),
    [
        ("twisted-kovalevskaya", {}, "-alpha2*beta3 + alpha3*beta2"),
        ("kovalevskaya", {}, "alpha2"),  # l3' = alpha2 for a = (-1, 0, 0)
        ("lagrange", {}, "alpha1*l2 - alpha2*l1"),  # l3' = 0
        ("henon-heiles", {"y": 0.1, "p_x": 0.3}, None),
        ("twisted-kovalevskaya", {"l": (1, 1, 1), "alpha": (0, 0, 1)}, "alpha2"),  # beta = 0
    ],
)
def test_default_surface_is_the_rate_of_what_moves(name, start, function):
    system = lp.catalog.system(name)
    begin = lp.phase_space.find_start(system, start=start or None)
    surface = lp.sections.default_surface(begin.leaf)
    assert function is None or surface == function
    assert len(lp.section(system, begin.state, surface=surface, t_end=100).time) > 3


def test_components_that_act_on_nothing_are_no_axes():
    top = lp.Top.heavy(inertia=(1, 2, 3), a=(1, 0, 0))
    assert idle_components(top) == {"beta1", "beta2", "beta3"}
    assert idle_components(lp.Top.twisted_kovalevskaya()) == set()
    cyclic = lp.System(lp.canonical(names=["theta", "phi"]), "p_theta^2 + p_phi^2/(1 + theta^2) + theta^2")
    assert idle_components(cyclic) == {"phi"}
    run = lp.section(top, lp.sample_states(top, 3, seed=2), surface="l3", direction=1, t_end=60)
    assert run.default_axes == ("alpha3", "l2")
    parallel = {"l": (1, 0.2, 1), "alpha": (0.6, 0, 0.8), "beta": (0.6, 0, 0.8)}  # a section of dimension 2
    run = lp.section(top, parallel, surface="l3", direction=1, t_end=200)
    assert not any("beta" in axis for axis in run.default_axes)


def test_axes_that_fold_the_section_are_told_from_coordinates():
    # On alpha2 = 0 and |alpha| = 1, alpha = (cos phi, 0, sin phi), and l2 is the momentum of the angle phi.  So phi and
    # l2 are coordinates, and sin phi = alpha3 and l2 where cos phi = alpha1 keeps its sign.
    system = lp.catalog.system("kovalevskaya")
    leaf = lp.Leaf(system, {"C1": 0.3, "C2": 1})
    states = lp.sections.section_starts(leaf, "alpha2", energy=1.5, n_starts=200, seed=1, direction=1)
    right = states[:, 3] > 0
    assert 20 < right.sum() < 180
    for axes, some, expected in (
        (("alpha3", "l2"), states, True),
        (("alpha3", "l2"), states[right], False),
        (("alpha3", "l2"), states[~right], False),
        (("alpha3 + alpha1/2", "l2 - alpha3"), states, True),
        (("sin(alpha3)", "l2"), states[right], False),
    ):
        assert lp.sections.is_folded(system, some, "alpha2", *axes) == expected, axes


OSCILLATOR = lp.catalog.system("henon-heiles")
STARTS = [{"y": 0.1, "p_x": 0.3, "p_y": p_y} for p_y in (0.1, -0.1)]


def test_a_section_says_whether_its_figure_folds_it():
    both = lp.section(OSCILLATOR, STARTS, surface="x", t_end=100, n_crossings=10)
    up = lp.section(OSCILLATOR, STARTS, surface="x", t_end=100, n_crossings=10, direction=1)
    assert both.is_folded()  # p_x is the positive or the negative root at each y and p_y
    assert not up.is_folded()
    assert (up.state[:, 3] > 0).any()
    assert (up.state[:, 3] < 0).any()
    assert up.is_folded("y", "p_y^2")
    assert "two sheets" in str(both)
    assert "two sheets" not in str(up)


def on(system, surface, energy, *, direction=1, casimirs=None, n=600):
    leaf = lp.Leaf(system, casimirs or {})
    return lp.sections.section_starts(leaf, surface, energy=energy, n_starts=n, seed=1, direction=direction)


BODIES = [
    (lp.catalog.system(name), {"C1": c, "C2": 1})
    for name, c in (("kovalevskaya", 0.3), ("lagrange", 0.4), ("kirchhoff", 0.5), ("goryachev-chaplygin", 0))
]


@pytest.mark.parametrize(("system", "casimirs", "k"), [(*body, k % 3) for k, body in enumerate(BODIES)])
def test_an_angle_and_its_momentum_are_coordinates_where_a_component_is_zero(system, casimirs, k):
    """For a kinetic energy that is convex, and crossings in one direction: a theorem, for every body and axis."""
    names = system.component_names
    states = on(system, names[3 + k], 4.0, casimirs=casimirs)
    angle, momentum = f"atan2({names[3 + (k + 2) % 3]}, {names[3 + (k + 1) % 3]})", names[k]
    assert not lp.sections.is_folded(system, states, names[3 + k], angle, momentum)
    both = on(system, names[3 + k], 4.0, casimirs=casimirs, direction=0)
    assert lp.sections.is_folded(system, both, names[3 + k], angle, momentum)
    found = section_axes(system, states, names[3 + k], (names[5], names[1]))
    assert found.is_graph
    assert section_axes(system, both, names[3 + k], (names[5], names[1])).by_direction


def test_the_default_surface_of_the_command_has_unfolded_axes_where_a_component_does():
    begin = lp.phase_space.find_start(lp.catalog.system("kovalevskaya"))
    assert surface_and_reason(begin.leaf, begin.energy, direction=1) == ("alpha2", "the rate of l3")
    leaf = lp.Leaf(lp.catalog.system("heavy-top"), {"C1": 0.3, "C2": 1})
    assert surface_and_reason(leaf, 1.5, direction=1)[0] == "alpha3"


@pytest.mark.parametrize(
    ("name", "energy", "surface"),
    [
        ("goryachev", None, "p1"),  # p3 = 0 is a pole of its potential
        ("henon-heiles", 0.1, "y"),
        ("henon-heiles", 1.0, "-x^2 + y^2 - y"),  # from there orbits escape, and cross y = 0 once at most
        ("neumann", None, "alpha3"),  # the rate of l3 vanishes on two surfaces, one of which a plane shows as a line
    ],
)
def test_a_component_is_taken_only_where_orbits_meet_it_again(name, energy, surface):
    begin = lp.phase_space.find_start(lp.catalog.system(name), energy=energy)
    found, _ = surface_and_reason(begin.leaf, begin.energy, direction=1)
    assert found == surface


def test_angles_stand_in_functions_and_not_in_hamiltonians():
    system, text = lp.catalog.system("kovalevskaya"), "dot(l, l) + atan2(alpha1, alpha2 + 1)"
    x = np.random.default_rng(0).standard_normal((40, 6))
    function = system.functions.of(text)
    wanted = (x[:, :3] ** 2).sum(axis=1) + np.arctan2(x[:, 3], x[:, 4] + 1)
    np.testing.assert_allclose(function(x), wanted, rtol=1e-14)
    h = 1e-6
    for k, unit in enumerate(np.eye(6)):
        slope = (function(x + h * unit) - function(x - h * unit)) / (2 * h)
        np.testing.assert_allclose(function.gradient(x)[:, k], slope, atol=1e-6)
    start = lp.sample_states(system, 3, seed=1)
    states = lp.section(system, start, surface="l3", t_end=100).state
    kept = lp.section(system, start, surface="l3", t_end=100, keep=[text]).state
    assert len(kept) > 5
    np.testing.assert_allclose(kept[:, 0], function(states), rtol=0, atol=1e-12)
