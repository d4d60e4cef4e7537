"""Frequency analysis: known signals, order of convergence, tori and chaos, aliasing, bad input."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.tori.frequencies import frequency_drift, main_frequency

LAGRANGE = lp.Top.lagrange()
CHAOTIC = lp.Top.twisted_kovalevskaya()
OMEGA, OTHER = 0.7123456789, -1.318


def two_lines(t):
    return np.exp(1j * OMEGA * t) + 0.5 * np.exp(1j * (OTHER * t + 0.3))


def test_main_frequency_of_two_lines():
    t = 0.25 * np.arange(2049)
    frequency, amplitude = main_frequency(two_lines(t), 0.25)
    assert abs(frequency[0] - OMEGA) < 1e-9  # measured 7e-11
    assert abs(amplitude[0] - 1) < 1e-7  # measured 2e-8


@pytest.mark.parametrize("order", [1, 2])
def test_error_falls_with_the_stated_power_of_the_window(order):
    """T^-(2p + 2): the largest error of several lengths, since it oscillates with T times the distance of the lines."""
    errors = []
    for n in (512, 4096):
        lengths = [n + 8 * k for k in range(12)]
        signals = [two_lines(0.25 * np.arange(length + 1)) for length in lengths]
        errors.append(max(abs(main_frequency(s, 0.25, window_order=order)[0][0] - OMEGA) for s in signals))
    slope = np.log(errors[1] / errors[0]) / np.log(8)
    # 0.5: the lengths do not meet the same phases of the oscillation; measured: -3.99, -6.00
    assert slope < -(2 * order + 2) + 0.5, errors


def test_constant_part_and_real_signals():
    t = 0.25 * np.arange(2049)
    frequency, amplitude = main_frequency(7 + 3 * np.cos(0.9 * t) + np.cos(2.3 * t), 0.25)
    assert frequency[0] == pytest.approx(0.9, abs=1e-8)
    assert amplitude[0] == pytest.approx(3, abs=1e-6)
    frequency, amplitude = main_frequency(5j + 2 * np.exp(-1.1j * t), 0.25)
    assert frequency[0] == pytest.approx(-1.1, abs=1e-8)
    assert amplitude[0] == pytest.approx(2, abs=1e-6)


def test_a_line_beyond_the_nyquist_frequency_is_folded_back():
    """Samples 0.5 apart cannot tell sigma from sigma - 2 pi/0.5."""
    t = 0.5 * np.arange(1025)
    frequency, _ = main_frequency(np.exp(8.0j * t), 0.5)
    assert frequency[0] == pytest.approx(8.0 - 4 * np.pi, abs=1e-10)


def test_precession_of_the_symmetric_free_body_in_closed_form():
    """I = (1, 1, 1/2): l1 + i l2 turns at the rate l3 (1/I1 - 1/I3) or its negative, exactly."""
    body = lp.Top.free_rigid_body(inertia=(1, 1, 0.5))
    x0 = lp.sample_states(body, 6, seed=1)
    result = frequency_drift(body, x0, observable=("l1", "l2"), t_end=400)
    rate = x0[:, 2] * (1 / 1 - 1 / 0.5)
    # l' = l x omega: l1' = l2 l3 (1/I3 - 1/I1), so d(l1 + i l2)/dt = -i l3 (1/I3 - 1/I1) (l1 + i l2)
    resolved = np.abs(rate) > 8 * np.pi / 200  # slower ones are confused with the mean that is taken off
    assert resolved.sum() >= 4
    assert np.abs(result.frequency[:, 0] - rate)[resolved].max() < 1e-7
    assert result.drift[resolved].max() < 1e-7
    assert result.amplitude[resolved, 0] == pytest.approx(np.hypot(x0[:, 0], x0[:, 1])[resolved], rel=1e-4)


@pytest.mark.thorough
def test_frequencies_of_the_lagrange_top_are_constant_and_those_of_chaos_are_not():
    regular = frequency_drift(LAGRANGE, lp.sample_states(LAGRANGE, 32, seed=2), observable=("l1", "l2"), t_end=1000)
    assert regular.drift.max() < 1e-7  # measured 7e-9
    chaotic = frequency_drift(CHAOTIC, lp.sample_states(CHAOTIC, 32, seed=2), observable=("beta1", "beta2"), t_end=1000)
    assert np.median(chaotic.drift) > 1e-3
    assert regular.nyquist == pytest.approx(np.pi * 2048 / 500)
    assert regular.high_power.max() < 1e-4


def test_names_formulas_and_functions_give_the_same():
    x0 = lp.sample_states(LAGRANGE, 3, seed=2)
    run = {"t_end": 120, "n_samples": 256}
    names = frequency_drift(LAGRANGE, x0, observable=("l1", "l2"), **run)
    formulas = frequency_drift(LAGRANGE, x0, observable=("l1 + 0", "2*l2/2"), **run)
    function = frequency_drift(LAGRANGE, x0, observable=lambda x: x[..., 0] + 1j * x[..., 1], **run)
    assert names.frequency == pytest.approx(formulas.frequency, abs=1e-12)
    assert np.array_equal(names.frequency, function.frequency)
    real = frequency_drift(LAGRANGE, x0, observable="l1", **run)
    assert (real.frequency > 0).all()


def test_a_trajectory_has_the_same_bits_in_any_batch_and_one_that_fails_is_an_outcome():
    x0 = lp.sample_states(CHAOTIC, 67, seed=3)  # more than one chunk
    x0[1], x0[2] = 1e200, np.nan
    run = partial(frequency_drift, CHAOTIC, observable=("beta1", "beta2"), t_end=20, n_samples=32)
    whole, part = run(x0, threads=1), run(x0[60:67], threads=2)
    assert list(whole.outcome[:4]) == ["finished", "not finite", "not finite", "finished"]
    for name in ("frequency", "amplitude", "high_power"):
        assert np.array_equal(getattr(part, name), getattr(whole, name)[60:67]), name
        assert np.isnan(getattr(whole, name)[1:3]).all()


drift = partial(frequency_drift, CHAOTIC, np.ones(9), **{"observable": "l1", "t_end": 2})


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (partial(drift, t_end=0), ParameterError, "positive finite time"),
        (partial(drift, n_samples=8), ParameterError, "n_samples"),
        (partial(drift, window_order=0), ParameterError, "window_order"),
        (partial(drift, observable=("l1", "l2", "l3")), ParameterError, "one name or formula"),
        (partial(drift, observable=3), ParameterError, "one name or formula"),
        *(
            (partial(frequency_drift, LAGRANGE, np.ones(9), observable=given, t_end=2), ParameterError, words)
            for given, words in (
                ("l3", 'got .l3., a constant of motion: its bracket with H is zero.*try a component such as "l1"'),
                ("H", "a constant of motion"),
                ("dot(alpha, alpha)^2", "constant on each leaf: its bracket with every component"),
                ("3", "constant on each leaf: no component occurs in it"),
                (("C1", "l3"), "constant on each leaf"),
            )
        ),
        (partial(drift, n_samples=2**24), ParameterError, "at most 4 GiB"),
        (partial(drift, observable=lambda x: x), ShapeError, "Index the last axis"),
        (partial(drift, observable=lambda x: x[..., 0] * np.nan), ParameterError, "finite numbers"),
        (partial(main_frequency, np.ones(5), 1.0), ShapeError, "signal must have shape"),
        (partial(main_frequency, ["a"] * 20, 1.0), ShapeError, "signal must have shape"),
        (partial(main_frequency, np.full(20, np.nan), 1.0), ParameterError, "finite numbers"),
        (partial(main_frequency, np.ones(20), 0.0), ParameterError, "positive time"),
    ],
)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_what_a_quadrature_finds_is_no_constant_though_no_bracket_has_it():
    turning = lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2 + x^2/2", quadratures={"psi": "p^2"})
    found = frequency_drift(turning, [0.3, 0, 0], observable="psi - x", t_end=100, n_samples=256)
    assert found.amplitude.min() > 0.1
    assert len(lp.section(turning, [0.3, 0, 0], surface="psi - 1", t_end=50).time) == 1
