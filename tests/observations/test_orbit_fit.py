"""Models beside observed orbits: known parameters, errors that are kept, and what data cannot tell."""

import inspect

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.numeric.run_options import RunOptions
from liepoisson.observations.observations import Observations
from liepoisson.observations.sensitivities import Model

fit_of = lp.fits.orbit_fit


def pendulum(g):
    return lp.System(lp.canonical(1, names=["theta"], angles=["theta"]), "p_theta^2/2 - g*cos(theta)", {"g": g})


def body(*moments):
    return lp.System(lp.so(3) @ lp.trivial(), "dot(l, inv(I)*l)/2", {"I": list(moments)})


SWING = lp.integrate(pendulum("9.81"), [0.4, 0.1], times=np.linspace(0, 3, 31))
TUMBLE = lp.integrate(body(1, 2, 3), [1, 0.5, 0.2], times=np.linspace(0, 20, 41))
RATES = {"t": TUMBLE.time} | {f"l{k}/I{k}": TUMBLE.state[0, :, k - 1] / k for k in (1, 2, 3)}


def moments(seed, sigma=0.02):
    """The components of the body's momentum with errors, which the fit knows."""
    noisy = TUMBLE.state[0] + sigma * np.random.default_rng(seed).standard_normal(TUMBLE.state[0].shape)
    return Observations({"t": TUMBLE.time} | {f"l{k + 1}": noisy[:, k] for k in range(3)}, errors=sigma)


def test_noise_free_data_give_the_parameters_back():
    """Measured: below 1e-14."""
    data = {"t": SWING.time, "theta": SWING.state[0, :, 0]}
    fit = fit_of(pendulum(8), data, ["g", "theta", "p_theta"], starts={"p_theta": 0})
    assert (fit.ending, fit.undetermined) == ("converged", ())
    np.testing.assert_allclose(fit.value, [9.81, 0.4, 0.1], rtol=0, atol=1e-10)
    fit = fit_of(body(1, "2.2", "2.7"), RATES, ["I2", "I3", "l"], starts=[1.1, 0.4, 0.3])
    np.testing.assert_allclose(fit.value, [2, 3, 1, 0.5, 0.2], rtol=0, atol=1e-10)


def test_tangents_along_parameters_are_derivatives_of_orbits():
    r"""The oscillator $\ddot q = -k q$: $q = q_0\cos\omega t + (p_0/\omega)\sin\omega t$, with $\omega = \sqrt k$."""
    system = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 + k*q^2/2", {"k": 4})
    t, q, p, w = np.linspace(0, 5, 11), 0.5, 0.3, 2.0
    model = Model(system, Observations({"t": t, "q": t, "k*q": t}), ["k", "q", "p_q"], np.array([[q, p]]))
    start = np.array([[q, p, w**2]])
    found = model.prediction(start, np.zeros(1), RunOptions.read(default=lp.Taylor()))
    x = q * np.cos(w * t) + p / w * np.sin(w * t)
    by_w = -q * t * np.sin(w * t) + p / w * t * np.cos(w * t) - p / w**2 * np.sin(w * t)
    slopes = np.stack([by_w / (2 * w), np.cos(w * t), np.sin(w * t) / w], axis=1)
    np.testing.assert_allclose(found.value, np.stack([x, w**2 * x], axis=1), atol=1e-13)
    np.testing.assert_allclose(found.derivative[:, 0], slopes, atol=1e-13)
    np.testing.assert_allclose(found.derivative[:, 1], w**2 * slopes + np.outer(x, [1, 0, 0]), atol=1e-12)


def test_large_parameters_take_nothing_from_the_accuracy_of_orbits():
    """A mass on a spring, 1e9 times as heavy and as stiff: without units the last nine digits are lost."""
    system = lp.System(lp.canonical(1, names=["q"]), "1e9*(p_q^2/(2*m) + k*q^2/(2*m))", {"m": 10**9, "k": 1})
    t = np.linspace(0, 50, 101)
    fit = fit_of(system, {"t": t, "q": np.cos(t)}, ["m"], starts={"p_q": 0})
    np.testing.assert_allclose(fit.predicted[:, 0], np.cos(t), atol=1e-13)
    assert fit.value[0] == pytest.approx(1e9, rel=1e-13)


SYSTEMS = {
    "top": (lp.Top.twisted(inertia=(2, 2.5, 1), a=(1, 0, 0), b=(0, 0.5, 0), epsilon=0.7), ["I", "a1", "epsilon", "l"]),
    "drive": (
        lp.System(lp.canonical(1), "p1^2/2 + k*q1^4 - F*q1*cos(w*t)", {"k": 2, "F": 1, "w": 3}),
        ["k", "w", "q1"],
    ),
    "field": (
        lp.VectorField({"x": "s*(y - x)", "y": "x*(r - z) - y", "z": "x*y - b*z"}, {"s": 10, "r": 28, "b": "8/3"}),
        ["s", "r", "b", "y"],
    ),
    "bracket": (lp.System(lp.so(3) @ lp.leibniz(3, "k"), "dot(l, l)/2 + alpha3", {"k": 2}), ["k"]),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_sensitivities_are_central_differences_of_the_original_orbits(name):
    """The orbit with parameters in the state is that of the system, to round-off; differences err by 1e-9."""
    system, names = SYSTEMS[name]
    components, times = system.component_names, 1.5 + np.linspace(0, 2, 5)
    data = Observations({"t": times, components[0]: times, f"2*{components[1]}": times})
    guess = np.array([np.linspace(0.5, 1, len(components))])
    if name == "drive":
        guess[0, components.index("t")] = 1.5
    model = Model(system, data, names, guess)
    options = RunOptions.read(default=lp.Taylor())
    values = np.concatenate([model.numbers, [guess[0, one.place] for one in model.unknowns if one.run is not None]])

    def at(u):
        return model.prediction(model.starts(guess, u), np.array([1.5]), options)

    state = lp.integrate(system, guess[0], times=times).state[0]
    np.testing.assert_allclose(at(values).value, state[:, :2] * [1, 2], rtol=1e-11, atol=1e-11)
    for k, step in enumerate(1e-5 * np.eye(len(values))):
        difference = (at(values + step).value - at(values - step).value) / 2e-5
        np.testing.assert_allclose(at(values).derivative[..., k], difference, rtol=1e-7, atol=1e-7)


def inside(seeds):
    """Of how many of the fits the interval of 95% has the moments 2 and 3."""
    guess, found = body(1, "2.1", "2.8"), []
    for seed in seeds:
        fit = fit_of(guess, moments(seed), ["I2", "I3", "l"])
        assert fit.ending == "converged"
        found.append(np.abs(fit.value[:2] - [2, 3]) < 1.96 * fit.error[:2])
    return np.sum(found, axis=0)


def test_a_fitted_inertia_lies_within_its_error():
    """Of 10 cases fewer than 7 lie inside with the probability 0.001."""
    assert (inside(range(10)) >= 7).all()


def test_parameters_of_a_damped_system_and_of_its_damping_are_found():
    body = lp.System(lp.so(3) @ lp.trivial(), "dot(l, inv(I)*l)/2", {"I": [2, 3, 5]})
    damped, guess = (lp.dissipation.double_bracket(body, "g", parameters={"g": g}) for g in ("1/10", "1/12"))
    run = lp.integrate(damped, [1, 1.2, 0.3], times=np.linspace(0, 10, 21))
    fit = lp.fits.orbit_fit(guess, lp.fits.Observations(run), ["g", "I2", "l"])
    np.testing.assert_allclose(fit.value, [0.1, 3, 1, 1.2, 0.3], atol=1e-9)


@pytest.mark.slow
def test_a_fitted_inertia_lies_within_its_error_in_95_of_100_cases():
    """Counts of 88 to 100 have the probability 0.996, by the binomial law with 0.95. Measured: 95 and 95."""
    assert (inside(range(100)) >= 88).all()


def test_errors_are_those_of_a_straight_line_in_closed_form():
    r"""Free motion, $q = q_0 + p t$: errors of intercept and slope, and $\hat\sigma^2 = \chi^2/(n - 2)$."""
    t = np.arange(6.0)
    y = 1 + 0.5 * t + np.array([0.1, -0.2, 0.05, 0.1, -0.1, 0.05])
    free = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2")
    fit = fit_of(free, {"t": t, "q": y}, ["q", "p_q"], starts={"p_q": 0})
    p, q = np.polyfit(t, y, 1)
    variance = np.sum((y - q - p * t) ** 2) / 4
    spread = np.sum((t - t.mean()) ** 2)
    np.testing.assert_allclose(fit.value, [q, p], rtol=1e-12)
    np.testing.assert_allclose(
        fit.error**2, variance * np.array([1 / 6 + t.mean() ** 2 / spread, 1 / spread]), rtol=1e-10
    )
    assert fit.correlation[0, 1] == pytest.approx(-t.mean() / np.sqrt(np.mean(t**2)))
    known = fit_of(free, Observations({"t": t, "q": y}, errors=0.1), ["q", "p_q"], starts={"p_q": 0})
    np.testing.assert_allclose(known.error, fit.error * 0.1 / np.sqrt(variance), rtol=1e-10)
    assert (known.degrees_of_freedom, known.chi_squared) == (4, pytest.approx(4 * variance / 0.01))


def test_weights_are_errors_of_which_only_ratios_are_known():
    t = SWING.time
    noisy = SWING.state[0, :, 0] + 0.01 * np.random.default_rng(1).standard_normal(len(t))
    table = {"t": t, "theta": noisy, "w": np.where(t < 1, 4.0, 1.0), "sigma": np.where(t < 1, 1.0, 2.0)}
    by_weights = fit_of(pendulum(9), Observations(table, weights="w", columns=["theta"]), ["g"], starts=[0.4, 0.1])
    by_errors = fit_of(pendulum(9), Observations(table, errors="sigma", columns=["theta"]), ["g"], starts=[0.4, 0.1])
    assert by_weights.value[0] == pytest.approx(by_errors.value[0], rel=1e-9)
    scale = np.sqrt(by_errors.chi_squared / by_errors.degrees_of_freedom)
    assert by_weights.error[0] == pytest.approx(by_errors.error[0] * scale, rel=1e-6)


def test_what_the_data_cannot_tell_is_named():
    """A gyroscope sees ratios; H times c with momenta over c, the product; momenta alone, 1/I up to a constant."""
    scale = fit_of(body(1, 2, 3), RATES, ["I", "l"], starts=[1, 0.5, 0.2])
    assert scale.undetermined == ("only the ratios of I1, I2, I3, l1(t0), l2(t0), l3(t0)",)
    assert np.isinf(scale.error).all()
    assert scale.degrees_of_freedom == scale.n_values - 5
    spring = lp.System(lp.canonical(1, names=["q"]), "c*(p_q^2/2 + k*q^2/2)", {"c": 1, "k": 2})
    t = np.linspace(0, 2, 9)
    product = fit_of(spring, {"t": t, "q": np.cos(np.sqrt(2) * t)}, ["c", "k", "p_q"], starts={"p_q": "1/100"})
    assert product.ending == "not determined"
    assert len(product.undetermined) == 1
    assert product.value[0] ** 2 * product.value[1] == pytest.approx(2, abs=1e-9)
    still = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 + k*q^2/2 + c*q^3", {"k": 1, "c": 1})
    nothing = fit_of(still, {"t": t, "q": np.zeros(9)}, ["k", "c"], starts=[0, 0])
    assert nothing.undetermined == ("k changes no observed value", "c changes no observed value")
    three = fit_of(body(1, 2, 3), {"t": TUMBLE.time} | {f"l{k}": TUMBLE.state[0, :, k - 1] for k in (1, 2, 3)}, ["I"])
    assert three.undetermined == ("I1 +0.333%, I2 +0.667%, I3 +1% together change no observed value",)


def test_a_parameter_of_a_hamiltonian_with_its_time_scale_has_no_value_of_its_own():
    """H times c is the same orbit c times as fast: with c and all of H's own numbers free, one direction is left."""
    system = lp.System(lp.so(3) @ lp.trivial(), "c*dot(l, inv(I)*l)/2", {"c": 1, "I": [1, 2, 3]})
    fit = fit_of(system, {"t": RATES["t"], "l1": TUMBLE.state[0, :, 0]}, ["c", "I2"], starts=[1, 0.5, 0.2])
    assert fit.undetermined == ()
    fit = fit_of(system, {"t": RATES["t"], "c*l1/I1": TUMBLE.state[0, :, 0]}, ["c", "I"], starts=[1, 0.5, 0.2])
    assert "only the ratios of c, I1, I2, I3" in fit.undetermined


def test_missing_values_and_runs_of_other_lengths_count_by_what_is_there():
    a = lp.integrate(pendulum(9), [0.3, 0], times=np.linspace(0, 2, 11)).state[0, :, 0]
    b = lp.integrate(pendulum(9), [-0.2, 1], times=np.linspace(0, 1, 6)).state[0]
    table = {
        "time": [*np.linspace(5, 7, 11), *np.linspace(0, 1, 6)],
        "theta": [*a, *b[:, 0]],
        "p_theta": [*[None] * 11, *b[:, 1]],
        "which": ["first"] * 11 + ["second"] * 6,
    }
    table["theta"][3] = np.nan
    starts = [[0.25, 0.05], [-0.25, 0.9]]
    fit = fit_of(pendulum(8), Observations(table, run="which"), ["g", "theta", "p_theta"], starts=starts)
    assert (fit.n_values, fit.runs) == (10 + 12, ("first", "second"))
    assert fit.unknowns[1:3] == ("theta(t0) of run first", "p_theta(t0) of run first")
    np.testing.assert_allclose(fit.value, [9, 0.3, 0, -0.2, 1], atol=1e-10)


def test_the_guess_of_a_start_is_the_first_value_that_is_there():
    fit = fit_of(pendulum(9), {"t": [0.0, 0.1, 0.2], "theta": [None, 0.3, 0.28]}, ["theta"], starts={"p_theta": 0.1})
    assert fit.guess_start.tolist() == [[0.3, 0.1]]


def test_residuals_of_an_angle_are_taken_modulo_a_turn():
    """The angle in degrees from -180 to 180, of a pendulum that turns over."""
    system, t = pendulum(2), np.linspace(0, 6, 41)
    angle = lp.integrate(system, [0.1, 4], times=t).state[0, :, 0]
    data = {"t": t, "degrees": np.rad2deg(np.angle(np.exp(1j * angle)))}
    seen = Observations(data, columns={"degrees": "180/pi*theta"})
    fit = fit_of(pendulum("2.1"), seen, ["g", "p_theta"], starts=[0.1, 3.9])
    np.testing.assert_allclose(fit.value, [2, 4], atol=1e-10)
    top = lp.Top.heavy(inertia=(2, 1.5, 1), a=(0, 0, 1))
    turns = {
        "2*atan2(alpha2, alpha1)": (top, 4 * np.pi),
        "cos(theta)": (system, np.inf),
        "3*theta/2": (system, 3 * np.pi),
    }
    for column, (of, turn) in turns.items():
        model = Model(of, Observations({"t": [0], column: [0]}), [], np.zeros((1, len(of.component_names))))
        assert model.turns == pytest.approx(turn)


def test_time_is_that_of_the_observations():
    r"""A drive $\ddot q = F\cos t$ seen from t = 2 on: $\dot q = p_0 + F(\sin t - \sin 2)$."""
    drive = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 - F*q*cos(t)", {"F": 1})
    t, force = np.linspace(2, 5, 13), 1.5
    q = 0.3 + (0.2 - force * np.sin(2)) * (t - 2) - force * (np.cos(t) - np.cos(2))
    fit = fit_of(drive, {"t": t, "q": q}, ["F", "q", "p_q"], starts={"p_q": 0})
    np.testing.assert_allclose(fit.value, [force, 0.3, 0.2], atol=1e-10)
    assert (fit.start[0, 2], fit.start_time[0]) == (2, 2)
    with pytest.raises(ParameterError, match="t is time"):
        fit_of(drive, {"t": t, "q": q}, ["t"], starts=[0, 0, 0, 0])


def test_an_unknown_stays_within_its_bounds():
    data = {"t": SWING.time, "theta": SWING.state[0, :, 0]}
    fit = fit_of(pendulum(8), data, ["g", "p_theta"], starts=[0.4, 0], bounds={"g": (None, 9)})
    assert (fit.ending, fit.value[0]) == ("at a bound", 9)
    assert np.isnan(fit.error[0])
    assert fit.error[1] > 0
    fit = fit_of(pendulum(12), data, ["g", "p_theta"], starts=[0.4, 0], bounds={"g": (10, None)})
    assert (fit.ending, fit.value[0]) == ("at a bound", 10)
    for bounds, words in (
        ({"g": (9, None)}, "9 to inf for g; got 8; give another value"),
        ({"p_theta": (-2, -1)}, "start"),
    ):
        with pytest.raises(ParameterError, match=f"wanted a guess within them.*{words}"):
            fit_of(pendulum(8), data, ["g", "p_theta"], starts=[0.4, 0], bounds=bounds)
    fit = fit_of(pendulum(8), data, ["g", "p_theta"], starts=[0.4, 0], bounds={"g": (0, 20), "p_theta": (-1, 1)})
    np.testing.assert_allclose(fit.value, [9.81, 0.1], atol=1e-10)


def test_a_search_that_fails_is_an_ending():
    falls = lp.VectorField({"x": "k*x^2"}, {"k": 1})  # x = 1/(1/x0 - k t) ends at t = 1
    fit = fit_of(falls, {"t": [0.0, 0.5, 1.5], "x": [1.0, 1.5, 2.0]}, ["k"])
    assert (fit.ending, fit.outcome[0] != "finished", bool(np.isnan(fit.error[0]))) == ("no trajectory", True, True)
    data = {"t": SWING.time, "theta": SWING.state[0, :, 0]}
    ended = fit_of(pendulum(8), data, ["g"], starts=[0.4, 0.1], most_steps=1)
    assert (ended.ending, bool(np.isnan(ended.error[0]))) == ("most steps", True)
    late = fit_of(pendulum(8), data, ["g"], starts=[0.4, 0.1], time_limit=1e-9)
    assert (late.ending, late.outcome[0]) == ("time limit", "time limit")


@pytest.mark.parametrize("start", [0, 1.3])
def test_a_step_that_ends_early_is_tried_shorter(start):
    """The first step without damping leads to k = 3.6, where the orbit has no value at the last time."""
    falls, t = lp.VectorField({"x": "k*x^2"}, {"k": "1/10"}), np.linspace(0, 1.9, 20)
    fit = fit_of(falls, {"t": t, "x": 1 / (1 - 0.5 * t)}, ["k"])
    assert fit.ending == "converged"
    assert fit.value[0] == pytest.approx(0.5, abs=1e-10)


def test_a_fit_records_what_it_was_given():
    given = {"unknowns": ("I3", "I2"), "starts": TUMBLE.state[0, :1], "start_time": [-1.0], "most_steps": 7}
    bounds = {"I2": (1.0, 5.0), "I3": (-np.inf, np.inf)}
    fit = fit_of(
        body(1, "2.1", "2.8"), moments(3), bounds=bounds, method=lp.Taylor(tol=1e-12), time_limit=77.0, **given
    )
    found = fit.arguments()
    taken = {*inspect.signature(fit_of).parameters} - {"system", "threads", "time_limit", "progress"}
    assert found.keys() == taken
    assert {name: found[name] for name in ("unknowns", "bounds", "method", "most_steps")} == {
        "unknowns": ("I3", "I2"), "bounds": bounds, "method": lp.Taylor(tol=1e-12), "most_steps": 7,
    }  # fmt: skip
    assert (found["starts"].tolist(), found["start_time"].tolist()) == (given["starts"].tolist(), [-1])
    for name in ("names", "runs", "errors_are_known"):
        assert getattr(found["observed"], name) == getattr(moments(3), name)
    for name in ("run", "time", "value", "deviation"):
        np.testing.assert_array_equal(getattr(found["observed"], name), getattr(moments(3), name))


def test_a_fit_has_a_table_a_system_and_curves():
    fit = fit_of(body(1, "2.1", "2.8"), moments(3), ["I2", "I3", "l"])
    assert fit.columns()["unknown"].tolist() == ["I2", "I3", "l1(t0)", "l2(t0)", "l3(t0)"]
    assert float(fit.fitted_system.parameters["I2"]) == fit.value[0]
    time, curve = fit.curve(n_times=41)
    np.testing.assert_allclose(curve, fit.predicted, atol=1e-12)
    assert time[-1] == fit.time[-1]
    assert "chi^2 = 138 with 118 degrees of freedom" in str(fit)


def test_a_number_in_the_bracket_is_found_if_it_has_a_name():
    r"""A charge in a plane, $\dot v_x = B v_y$, $\dot v_y = -B v_x$: a circle of radius 1/B."""
    t, energy = np.linspace(0, 3, 31), "(v_x^2 + v_y^2)/2"
    circle = {"t": t, "x": np.sin(1.2 * t) / 1.2, "y": (np.cos(1.2 * t) - 1) / 1.2}
    named = lp.System(lp.brackets.magnetic(["B"], symbols=["B"]), energy, {"B": 1})
    fit = fit_of(named, circle, ["B"], starts={"v_x": 1})
    assert (fit.value[0], fit.ending) == (pytest.approx(1.2, abs=1e-9), "converged")
    unnamed = lp.System(lp.brackets.magnetic(["B"], parameters={"B": 1}), energy)
    with pytest.raises(ParameterError, match=r"got 'B'.* make the bracket with symbols=\[...\] instead"):
        fit_of(unnamed, circle, ["B"], starts={"v_x": 1})


DATA = {"t": [0.0, 1.0, 2.0], "theta": [0.1, 0.2, 0.3]}
WRONG = {
    "not a parameter": ((DATA, ["h"]), "unknowns: wanted parameters and components .* Known: g, theta, p_theta"),
    "a suggestion": ((DATA, ["thete"]), "Did you mean theta?"),
    "twice": ((DATA, ["g", "g"]), "g comes twice"),
    "no names": ((DATA, "g"), r'write \["g"\]'),
    "a column": (({"t": [0.0], "thete": [1.0]}, ["g"]), "functions of the state; got 'thete'.* Did you mean theta\\?"),
    "no start": (({"t": [0.0, 1, 2], "p_theta": [0.0, 1, 2]}, ["g"]), "theta is not observed"),
    "too few": (({"t": [0.0, 1.0], "theta": [0.0, None]}, ["g", "theta"]), "2 unknowns and 1 value;"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_fitted_is_refused_with_what_to_try(name):
    (data, unknowns), message = WRONG[name]
    with pytest.raises(ParameterError, match=message):
        fit_of(pendulum(9), data, unknowns, starts=None if name == "no start" else {"p_theta": 0})


OPTIONS = {
    "late": ({"start_time": 1}, "start_time: wanted times up to the first of a run, 0; got 1"),
    "bounds": ({"bounds": {"g": (2, 1)}}, "the lower bound first"),
    "one bound": ({"bounds": {"g": 2}}, "wanted two numbers for g"),
    "foreign bound": ({"bounds": {"theta": (0, 1)}}, "bounds: wanted unknowns, g; got 'theta'"),
    "steps": ({"most_steps": 0}, "most_steps: wanted a whole number >= 1|from 1 to"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_mean_nothing_are_refused(name):
    given, message = OPTIONS[name]
    with pytest.raises(ParameterError, match=message):
        fit_of(pendulum(9), DATA, ["g"], **{"starts": {"p_theta": 0}, **given})


def test_starts_are_one_or_one_for_each_run():
    with pytest.raises(ShapeError, match="one state, or one for each of 1 runs; got 2"):
        fit_of(pendulum(9), DATA, ["g"], starts=np.zeros((2, 2)))
    with pytest.raises(ParameterError, match="wanted a system such as"):
        fit_of(pendulum(9).field(), DATA, ["g"])
