"""Rotation numbers: of rigid rotations, of maps of return, of flows; how fast they converge, and chaos."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError

GOLDEN = (5**0.5 - 1) / 2
HENON = lp.catalog.system("henon-heiles")
SEPARABLE = lp.catalog.system("henon-heiles-sawada-kotera")
PENDULUM = lp.catalog.system("spherical-pendulum")


def ellipse(turn, n, phase=0.0):
    """A rigid rotation, deformed: an ellipse about the origin."""
    angle = 2 * np.pi * (turn * np.arange(n + 1) + phase)
    return np.stack([2 * np.cos(angle), np.sin(angle)], axis=1)


def distance(one, other):
    """That of two rotation numbers, which are known up to whole turns."""
    return abs((one - other + 0.5) % 1 - 0.5)


@pytest.mark.parametrize("turn", [GOLDEN, -GOLDEN, 0.01 * GOLDEN, 0.5 - 0.01 * GOLDEN, 2**0.5])
def test_rigid_rotations_are_found_to_round_off(turn):
    found = lp.tori.rotation_number(ellipse(turn, 20_000, phase=0.3), center=[0.3, 0.2])
    assert distance(found.value[0], turn) < 1e-13
    assert -0.5 <= found.value[0] <= 0.5
    assert found.error[0] < 1e-11


def test_the_average_converges_faster_than_any_power():
    """The slope in a logarithmic plot grows; that of plain means is -1."""
    errors = []
    for n in (50, 200, 800):
        found = lp.tori.rotation_number([ellipse(GOLDEN, n, k / 20) for k in range(20)], center=[0.3, 0.2])
        errors.append(distance(found.value, GOLDEN).max())
        assert (distance(found.value, GOLDEN) < found.error).all()
    slopes = np.log(np.array(errors[1:]) / errors[:-1]) / np.log(4)
    assert slopes[0] < -3  # measured -4.6
    assert slopes[1] < -6  # measured -7.9


def test_from_outside_of_the_circle_nothing_turns():
    found = lp.tori.rotation_number(ellipse(GOLDEN, 2000), center=[3, 0])
    assert abs(found.value[0]) < 1e-12
    assert found.error[0] < 1e-10


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
def test_the_map_of_return_has_the_quotient_of_the_frequencies(seed):
    """The system separates: u'' = -u - u^2 for u = x + y, and v'' = -v + v^2 for v = x - y.

    On the section u = 0 the map turns by the angle of v in a period of u, from v' to v.
    """
    x = np.random.default_rng(seed).uniform(-0.25, 0.25, 4)
    omega = []
    for sign in (1, -1):
        one = lp.System(lp.canonical(names=["u"]), f"p_u^2/2 + u^2/2 + ({sign})*u^3/3")
        torus = lp.tori.period_lattice(one, [x[0] + sign * x[1], x[2] + sign * x[3]])
        omega.append(abs(torus.frequencies[0]))
    crossings = lp.section(SEPARABLE, x, surface="x + y", direction=1, t_end=20_000)
    found = lp.tori.rotation_number(crossings, ["p_x - p_y", "x - y"], center=[0, 0])
    assert distance(found.value[0], omega[1] / omega[0]) < 1e-12
    assert found.error[0] < 1e-9
    both = np.abs(lp.tori.period_lattice(SEPARABLE, x).frequencies)
    np.testing.assert_allclose(np.sort(both), np.sort(omega), rtol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_the_spherical_pendulum_turns_as_its_lattice_says(seed):
    """After a period of the height the azimuth has turned as much as l3's flow has to turn it back."""
    x = lp.sample_states(PENDULUM, 1, seed=seed)[0]
    periods = lp.tori.period_lattice(PENDULUM, x).periods
    crossings = lp.section(PENDULUM, x, surface="l1*alpha2 - l2*alpha1", direction=1, t_end=2000)
    found = lp.tori.rotation_number(crossings, ["alpha1", "alpha2"], center=[0, 0])
    period, turn = periods[np.abs(periods[:, 0]) > 1e-6][0]
    assert distance(found.value[0], np.sign(period) * turn / (2 * np.pi)) < 1e-12
    assert found.error[0] < 1e-11


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["lagrange", "spherical-pendulum"])
def test_the_mean_turn_of_a_flow_is_a_frequency_of_its_torus(name):
    """Orbits go around the vertical: the rate is a combination of the frequencies with whole coefficients."""
    system = lp.catalog.system(name)
    starts = lp.sample_states(system, 4, seed=1)
    runs = lp.integrate(system, starts, times=np.linspace(0, 800, 16_001))
    found = lp.tori.rotation_number(runs, ["alpha1", "alpha2"], center=[0, 0])
    assert found.interval == pytest.approx(0.05, rel=1e-12)
    for k, x in enumerate(starts):
        one, other = lp.tori.period_lattice(system, x).frequencies  # of any basis
        few = np.arange(-3, 4)
        rates = few[:, None] * one + few * other
        assert np.abs(rates - found.frequency[k]).min() < 1e-9  # measured 2e-14
    assert found.error.max() < 1e-12


def test_chaos_has_a_large_error():
    regular = lp.section(HENON, [0, 0.1, 0.35, 0], surface="x", direction=1, t_end=4000)
    chaotic = lp.section(HENON, [0, -0.25, 0.42081, 0], surface="x", direction=1, t_end=4000)
    assert lp.tori.rotation_number(regular, ["y", "p_y"]).error[0] < 1e-8
    assert lp.tori.rotation_number(chaotic, ["y", "p_y"]).error[0] > 1e-4  # measured 2e-3


def test_each_orbit_has_its_own_number_whatever_is_beside_it():
    starts = [[0, 0.1, 0.35, 0], [0, 0.2, 0.3, 0], [0, np.nan, 0.3, 0]]
    many = lp.section(HENON, starts, surface="x", direction=1, t_end=400)
    found = lp.tori.rotation_number(many, ["y", "p_y"])
    for k in range(2):
        one = lp.tori.rotation_number(many.of(k)[:, [1, 3]])
        assert one.value[0] == found.value[k]
        assert one.error[0] == found.error[k]
    assert np.isnan([found.value[2], found.error[2]]).all()
    assert found.n_steps.tolist() == [len(many.of(0)) - 1, len(many.of(1)) - 1, 0]
    assert list(found.to_dataframe()) == ["trajectory", "rotation_number", "error", "n_steps"]
    with pytest.raises(ParameterError, match="points of a map"):
        _ = found.frequency


def test_too_few_points_and_a_point_at_the_center_have_no_number():
    assert np.isnan(lp.tori.rotation_number(ellipse(GOLDEN, 3)).value[0])
    assert np.isfinite(lp.tori.rotation_number(ellipse(GOLDEN, 4)).value[0])
    assert np.isnan(lp.tori.rotation_number(ellipse(GOLDEN, 100), center=[2, 0]).value[0])


def test_kept_functions_are_coordinates_too():
    keep = ["y", "p_y^2 + y"]
    crossings = lp.section(HENON, [0, 0.1, 0.35, 0], surface="x", direction=1, t_end=400, keep=keep)
    whole = lp.section(HENON, [0, 0.1, 0.35, 0], surface="x", direction=1, t_end=400)
    found, wanted = (lp.tori.rotation_number(one, keep) for one in (crossings, whole))
    assert found.value[0] == pytest.approx(wanted.value[0], abs=1e-12)
    with pytest.raises(ParameterError, match=r"plane: wanted one of y, p_y\^2 \+ y; got 'p_y'"):
        lp.tori.rotation_number(crossings, ["y", "p_y"])


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"orbit": np.ones((5, 3))}, ShapeError, "points of a plane"),
        ({"orbit": np.ones(5)}, ShapeError, "points of a plane"),
        ({"orbit": ellipse(GOLDEN, 9), "plane": ["x", "y"]}, ParameterError, "points are in a plane"),
        ({"orbit": ellipse(GOLDEN, 9), "center": [0, 0, 0]}, ShapeError, r"shape \(2,\)"),
        ({"orbit": ellipse(GOLDEN, 9), "center": [0, np.inf]}, ParameterError, "center"),
        ({}, ParameterError, "plane: wanted two names"),
        ({"plane": ["alpha1"]}, ParameterError, "plane: wanted two names"),
        ({"plane": ["alpha1", "gamma"]}, ParameterError, "gamma"),
        ({"plane": "alpha1"}, ParameterError, "plane: wanted"),
    ],
)
def test_what_is_refused(given, error, words):
    run = lp.integrate(PENDULUM, [0.3, 0.8, 0.2, 0.8, 0, 0.6], t_end=5)
    with pytest.raises(error, match=words):
        lp.tori.rotation_number(**({"orbit": run} | given))


def test_times_are_equally_far_apart():
    run = lp.integrate(PENDULUM, [0.3, 0.8, 0.2, 0.8, 0, 0.6], times=[0, 1, 2, 3, 4.1])
    with pytest.raises(ParameterError, match="equally far apart"):
        lp.tori.rotation_number(run, ["alpha1", "alpha2"])
