"""Hamiltonians that depend on time, against SciPy's integrator and linear algebra, and what is refused."""

import pickle

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import Symbol, cos, symbols

import liepoisson as lp
from liepoisson.errors import BracketError, ExpressionError, ParameterError, SystemFileError, UnsupportedFieldError
from liepoisson.model.system_file_reader import parse_system_file
from liepoisson.model.system_text import system_text
from liepoisson.poincare.section_coordinates import levels_of

X = lp.canonical(names=["x"], angles=["x"])
SHAKEN = "p_x^2/2 - cos(x) + f*cos(x)*cos(w*t)"
FORCED = lp.System(X, SHAKEN, {"f": "3/10", "w": "7/5"}, period="2*pi/w", name="forced pendulum")
PERIOD = 2 * np.pi / 1.4
TOP = lp.System(
    lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2)/4 + l3^2/2 + (1 + cos(t)/2)*alpha3", period="2*pi", name="shaken top"
)


def forced(t, z, w=1.4, f=0.3):
    """The forced pendulum by hand."""
    return [z[1], -np.sin(z[0]) * (1 - f * np.cos(w * t))]


def by_scipy(rate, start, times, **options):
    return solve_ivp(rate, (0, times[-1]), start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=times, **options).y.T


def test_the_stroboscopic_map_is_that_of_another_integrator():
    run = lp.section(FORCED, {"x": 0.4, "p_x": 0.9}, surface="t", t_end=30.5 * PERIOD)
    np.testing.assert_allclose(run.time, PERIOD * np.arange(1, 31), rtol=1e-14)
    wanted = by_scipy(forced, [0.4, 0.9], PERIOD * np.arange(1, 31))
    np.testing.assert_allclose(run.state[:, :2], wanted, atol=2e-8)
    np.testing.assert_allclose(run.state[:, 2], run.time, rtol=1e-14)
    energy = FORCED.functions.energy(run.state)
    np.testing.assert_allclose(energy, energy[0], atol=1e-12)


def test_the_map_of_a_period_has_an_inverse():
    image = lp.sections.first_return(FORCED, [[0.4, 0.9, 0, 0]], surface="t", t_end=2 * PERIOD)
    assert float(image.time[0]) == pytest.approx(PERIOD, rel=1e-14)
    back = lp.sections.first_return(FORCED, image.state, surface="t", t_end=-2 * PERIOD, direction=-1)
    np.testing.assert_allclose(back.state, [[0.4, 0.9, 0, 0]], atol=1e-13)


@pytest.mark.parametrize("strength", [10, 20])
def test_the_derivative_at_the_pendulum_upside_down_is_that_of_its_linear_equation(strength):
    hard = lp.System(X, SHAKEN, {"f": strength, "w": 10}, period="2*pi/w")
    back = lp.sections.return_map(hard, "t", t_end=1)
    matrix = back.derivative([np.pi, 0, 0, 0], ["x", "p_x"])

    def linear(t, z):
        return [z[1], z[0] * (1 - strength * np.cos(10 * t))]

    wanted = np.transpose([by_scipy(linear, unit, [np.pi / 5])[-1] for unit in np.eye(2)])
    np.testing.assert_allclose(matrix, wanted, atol=1e-9)
    assert (abs(np.trace(matrix)) < 2) == (strength == 20)  # Kapitza: stable where f > sqrt(2) w, about
    with pytest.raises(ParameterError, match="wanted one whose Hamiltonian does not depend on time"):
        back.cycles({}, 0)


def test_exponents_of_an_orbit_without_bounds_are_those_of_floquet():
    a, q = 1, 0.5  # Mathieu's equation, in its first resonance: x'' = -(a - 2 q cos 2t) x
    system = lp.System(lp.canonical(names=["x"]), "p_x^2/2 + (a - 2*q*cos(2*t))*x^2/2", {"a": a, "q": q}, period="pi")

    def linear(t, z):
        return [z[1], -(a - 2 * q * np.cos(2 * t)) * z[0]]

    monodromy = np.transpose([by_scipy(linear, unit, [np.pi])[-1] for unit in np.eye(2)])
    exponent = np.log(np.abs(np.linalg.eigvals(monodromy)).max()) / np.pi
    starts = [[0, 0, 0, 0], [0.1, 0, 0, 0]]  # at rest, and growing like exp(exponent t)
    found = lp.lyapunov_exponent(system, starts, t_end=400)
    np.testing.assert_allclose(found.exponent, exponent, atol=1e-3)
    spectrum = lp.lyapunov_spectrum(system, starts, t_end=400)
    at_first = 2 / 400  # the part of the first vector that grows is above exp(-2)
    np.testing.assert_allclose(spectrum.end_exponent, [[exponent, 0, 0, -exponent]] * 2, atol=at_first)
    np.testing.assert_array_equal(spectrum.structure.n_zeros, 2)
    np.testing.assert_allclose(lp.chaos.megno(system, starts, t_end=400).megno[:, -1] / 400, exponent, atol=1e-3)


def test_runs_of_tangent_vectors_tell_the_energy_of_the_drive():
    starts = [[0.4, 0.9, 0, 0], [0.1, 0.2, 3, 7]]
    orbit = lp.integrate(FORCED, starts, t_end=20).end_state
    transient = {"transient": 5, "t_end": 15}
    for found in (
        lp.finite_time_exponents(FORCED, starts, t_end=20),
        lp.lyapunov_spectrum(FORCED, starts, **transient),
        lp.lyapunov_exponent(FORCED, starts, block=0.1, **transient),
    ):
        np.testing.assert_allclose(found.end_state, orbit, atol=1e-10)
    covariant = lp.lyapunov_spectrum(FORCED, starts, covariant=True, **transient).covariant
    np.testing.assert_allclose(covariant.state[:, -1], orbit, atol=1e-10)


@pytest.mark.parametrize("unit", [1e-3, 1, 1e8])
def test_verdicts_are_the_same_in_any_unit_of_time(unit):
    text = "c*(p_x^2/2 - cos(x) + 3*cos(x)*cos(3*c*t)/10)"
    system = lp.System(X, text, {"c": unit}, period="2*pi/(3*c)")
    found = lp.decide(system, [{"p_x": p} for p in (0.5, 1.9, 4)], t_end=1000 / unit)
    assert found.verdict.tolist() == ["regular", "chaotic", "regular"]
    np.testing.assert_allclose(found.natural_time[[0, 2]], [963.1, 839.7], rtol=1e-3)


@pytest.mark.parametrize("surface", ["t", "t - 1/10000", "sin(3000*t)"])
def test_a_drive_that_is_faster_than_the_system_has_its_stroboscopic_map(surface):
    system = lp.System(lp.canonical(names=["x"]), "p_x^2/2 + x^2/2 - x*cos(w*t)", {"w": 3000}, period="2*pi/w")
    period = 2 * np.pi / 3000
    found = lp.section(system, [0.3, 0.1, 0, 0], surface=surface, direction=1, t_end=20.03 * period, time_limit=20)
    at = period * np.arange(1, 21) if "1/" not in surface else 1e-4 + period * np.arange(20)
    np.testing.assert_allclose(found.time, at, rtol=1e-13)
    assert not found.unresolved_time.any()
    amplitude = 1 / (1 - 3000**2)  # x = (0.3 - A) cos t + 0.1 sin t + A cos(w t)
    wanted = (0.3 - amplitude) * np.cos(at) + 0.1 * np.sin(at) + amplitude * np.cos(3000 * at)
    np.testing.assert_allclose(found.state[:, 0], wanted, atol=1e-13)


def test_phases_are_sections_too():
    run = lp.section(FORCED, {"x": 0.4}, surface="t - pi/w", t_end=10 * PERIOD)
    np.testing.assert_allclose(run.time, PERIOD * (np.arange(10) + 0.5), rtol=1e-13)


def test_a_driven_top_moves_as_by_hand():
    start = {"l": (0.2, 0, 1), "alpha": (0.6, 0, 0.8)}

    def top(t, z):
        l, alpha = z[:3], z[3:]
        return np.concatenate(
            [
                np.cross(l, [l[0] / 2, l[1] / 2, l[2]]) + np.cross(alpha, [0, 0, 1 + np.cos(t) / 2]),
                np.cross(alpha, [l[0] / 2, l[1] / 2, l[2]]),
            ]
        )

    orbit = lp.integrate(TOP, start, times=np.linspace(0, 20, 21))
    wanted = by_scipy(top, [0.2, 0, 1, 0.6, 0, 0.8], np.linspace(0, 20, 21))
    np.testing.assert_allclose(orbit.state[0, :, :6], wanted, atol=1e-9)
    assert [str(casimir) for casimir in TOP.bracket.casimirs()] == [
        "alpha1*l1 + alpha2*l2 + alpha3*l3",
        "alpha1**2 + alpha2**2 + alpha3**2",
    ]
    assert not lp.sample_states(TOP, 3, seed=1)[:, 6:].any()
    tips = lp.section(TOP, start, surface="dot(l, alpha) - alpha3 - l3", t_end=20)
    assert len(tips.time)


def test_time_without_a_period():
    ramp = lp.System(lp.canonical(names=["x"]), "p_x^2/2 + x^2/2 - x*t")
    assert ramp.periods == {}
    assert ramp.clock == "t"
    times = np.linspace(0, 10, 11)
    found = lp.integrate(ramp, {}, times=times).state[0, :, 0]
    np.testing.assert_allclose(found, times - np.sin(times), atol=1e-13)
    late = lp.section(ramp, {}, surface="t - 5", t_end=20)
    assert late.time == pytest.approx([5.0], rel=1e-14)


def test_an_expression_may_depend_on_time_as_a_text_may():
    x, p, t = symbols("x p_x t")
    given = lp.System(X, p**2 / 2 - cos(x) + 3 * cos(x) * cos(7 * t / 5) / 10, period="10*pi/7")
    assert given.periods == FORCED.periods
    assert list(given.equations.values()) == list(FORCED.equations.values())
    made = lp.System(lp.canonical(1), lambda q, p: p.dot(p) / 2 + q[0] * cos(Symbol("t")), period="2*pi")
    assert made.component_names == ("q1", "p1", "t", "p_t")


def test_a_name_that_is_known_is_not_time():
    torque = lp.System(lp.canonical(1), "dot(p, p)/2 + t*q1", {"t": 2})
    assert torque.clock is None
    time = lp.System(lp.canonical(names=["t"]), "p_t^2/2 + t^2/2")
    assert time.component_names == ("t", "p_t")


def test_a_splitting_of_a_system_with_time_is_refused_for_its_time():
    for system in (FORCED, TOP):
        with pytest.raises(
            UnsupportedFieldError, match="wanted a Hamiltonian without time; got one that depends on t;"
        ):
            system.pieces()


@pytest.mark.parametrize("system", [FORCED, TOP, lp.System(lp.canonical(1), "dot(p, p)/2 + q1*t")], ids=str)
def test_files_and_copies_keep_time(system, tmp_path):
    path = lp.systems.write_system(system, tmp_path / "driven.toml")
    for again in (lp.read_system(path), pickle.loads(pickle.dumps(system))):
        assert again.equations == system.equations
        assert again.periods == system.periods
    assert "p_t" not in system_text(system)


def test_a_run_of_a_forced_system_is_repeated_from_its_file(tmp_path):
    run = lp.section(FORCED, {"p_x": 1.0}, surface="t", t_end=10 * PERIOD)
    again = lp.rerun(lp.load(run.save(tmp_path / "forced.nc")))
    np.testing.assert_array_equal(again.state, run.state)


def test_reports_tell_what_is_periodic():
    assert "  periodic     x by 2*pi, t by 10*pi/7\n" in str(FORCED)
    bracket = lp.inspect(FORCED).record()["bracket"]
    assert {name: period["text"] for name, period in bracket["periods"].items()} == {"x": "2*pi", "t": "10*pi/7"}


def test_a_figure_shows_the_coordinate_and_its_momentum():
    run = lp.section(FORCED, [{"p_x": 0.5}, {"p_x": 1.0}], surface="t", t_end=20 * PERIOD)
    assert run.default_axes == ("x", "p_x")
    assert levels_of(run).warning == ""
    assert lp.sections.default_surface(lp.Leaf.through(FORCED, run.state[0])) == "t"


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (
            lambda: lp.System(X, SHAKEN, {"f": 1, "w": 2}, period=3),
            ParameterError,
            r"The formula has the period 2\*pi\.",
        ),
        (lambda: lp.System(X, SHAKEN, {"f": 1, "w": 2}, period=-1), ParameterError, "wanted a positive number"),
        (lambda: lp.System(X, SHAKEN, {"f": 1, "w": 2}, period="2*pi/v"), ExpressionError, "'v' is unknown"),
        (lambda: lp.System(X, SHAKEN, {"f": 1, "w": 2}, period="x"), ParameterError, r'Write for example "2\*pi/w"'),
        (lambda: lp.System(X, SHAKEN, {"f": 1, "w": 2}, period="pi*t"), ExpressionError, "'t' is unknown"),
        (lambda: lp.System(X, "p_x^2/2 - cos(x)", period=1), ParameterError, "where t does not occur"),
        (lambda: lp.System(X, "p_x^2/2 - t*cos(x)", {"t": 1}, period=1), ParameterError, "where t is no time"),
        (lambda: lp.System(X, "p_x^2/2 - t*cos(x)", period=1), ParameterError, "Leave the period out of a formula"),
        (lambda: lp.System(X, "p_x^2/2 - t*cos(x) + p_t"), ParameterError, r"added by itself: K = H \+ p_t"),
        (lambda: lp.System(X, cos(Symbol("t")) + Symbol("p_t")), ParameterError, "Leave it out"),
        (
            lambda: parse_system_file('[bracket]\ncanonical = 1\n[hamiltonian]\nexpression = "p1^2*cos(t) + p_t"'),
            SystemFileError,
            "added by itself",
        ),
        (lambda: lp.System(FORCED.bracket, "p_x^2/2 - cos(x)*cos(t)"), ParameterError, r"bracket.base: p_t is added"),
        (lambda: lp.System(lp.canonical(names=["p_t"]), "p_t*cos(t)"), BracketError, "distinct names"),
        (
            lambda: parse_system_file('[bracket]\ncanonical = 1\n[hamiltonian]\nexpression = "p1^2"\nperiod = 2'),
            SystemFileError,
            r"\[hamiltonian\] period: .*where t does not occur",
        ),
    ],
)
def test_what_is_no_period_is_refused_with_the_reason(make, error, words):
    with pytest.raises(error, match=words):
        make()
