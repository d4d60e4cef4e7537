"""First passages, laws and exponents of systems with noise."""

import math

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError

STEP = lp.Splitting(step=0.02, order=2)
ROUND = lp.catalog.euler_top_on("so(3)", [1, 1, 1])
EACH = ["l1", "l2", "l3"]


def test_the_first_passage_from_the_pole_to_the_equator_takes_as_long_as_it_must():
    r"""$\frac12\Delta T = -1$ on the sphere, T = 0 on the equator: $T = 2\ln(1 + \cos\theta)$, 2 ln 2 from the pole."""
    start, options = np.tile([0, 0, 1.0], (600, 1)), {"noises": ["l1", "l2"], "t_end": 20, "method": STEP}
    found = lp.stochastic.first_passages(ROUND, start, function="l3", seed=1, **options)
    assert found.passed.all()
    late, mean = found.step_bias, found.mean
    assert late.value > 3 * late.standard_error
    assert abs(mean.value - late.value - 2 * math.log(2)) < 3 * math.hypot(mean.standard_error, late.standard_error)
    with pytest.raises(ParameterError, match="on it"):
        lp.stochastic.first_passages(ROUND, [1, 0, 0], function="l3", **options)


def test_a_trajectory_that_does_not_pass_has_no_time():
    found = lp.stochastic.first_passages(ROUND, [0, 0, 1], function="l3 + 2", noises="l1", t_end=1, method=STEP)
    assert np.isnan(found.time).all()
    assert found.outcome.tolist() == ["finished"]


CONSTANT = {
    "a number": ("1", {}, "constant on each leaf"),
    "a Casimir": ("l1^2 + l2^2 + l3^2 - 2", {}, "constant on each leaf"),
    "a constant of motion of H and of the noise": ("l3 - 2", {"noises": ["l3", "l3^2/2"]}, "H and all noises"),
}


@pytest.mark.parametrize(("function", "change", "words"), CONSTANT.values(), ids=[*CONSTANT])
def test_what_no_path_changes_has_no_passages(function, change, words):
    options = {"noises": EACH, "t_end": 1, "method": STEP} | change
    with pytest.raises(ParameterError, match=f"function: .* {words}"):
        lp.stochastic.first_passages(ROUND, [0, 0, 1], function=function, **options)


def test_a_function_that_is_not_real_at_a_start_has_no_side():
    starts = [[0, 0, 1], [np.nan, 0, 0], [0, 0, -1]]
    with pytest.raises(ParameterError, match=r"function: wanted one that is a real number .* none at start 2"):
        lp.stochastic.first_passages(ROUND, starts, function="sqrt(l3) - 1/2", noises=EACH, t_end=1, method=STEP)


def test_energy_which_noise_moves_has_passages():
    body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
    run = lp.stochastic.first_passages(
        body, [0, 0, 1], function="l1^2/2 + l2^2/4 + l3^2/6 - 1/5", noises=EACH, t_end=20, method=STEP
    )
    assert run.passed.all()


def test_a_passage_is_the_first_change_of_sign_of_the_orbits(monkeypatch):
    monkeypatch.setattr("liepoisson.noise.noise._NUMBERS", 50 * 15)  # many parts
    start, options = np.tile([0, 0, 1.0], (5, 1)), {"noises": ["l1", "l2"], "method": STEP, "seed": 4}
    found = lp.stochastic.first_passages(ROUND, start, function="l3", t_end=10, **options)
    run = lp.stochastic.noisy_orbits(ROUND, start, times=np.linspace(0, 10, 501), **options)
    first = (run.state[:, :, 2] <= 0).argmax(axis=1)
    np.testing.assert_allclose(found.time, run.time[first], rtol=1e-14)
    assert found.n_steps.tolist() == first.tolist()
    np.testing.assert_allclose(found.end_state, run.state[np.arange(5), first], atol=1e-13)


LONG = {"t_end": 200, "noises": EACH, "seed": 2, "method": lp.Splitting(step=0.01, order=2)}
"""20,000 steps, whose times are rounded."""


def test_paths_of_long_runs_do_not_depend_on_the_parts(monkeypatch):
    found = []
    for numbers in (2**22, 3 * 1000):
        monkeypatch.setattr("liepoisson.noise.noise._NUMBERS", numbers)
        passage = lp.stochastic.first_passages(ROUND, [0, 0, 1], function="l3 + 2", **LONG)
        law = lp.stochastic.stationary_law(
            ROUND, [0, 0, 1], "l3", edges=[-1, 0, 1], n_samples=19_000, transient=10, **LONG
        )
        found.append((passage.end_state, law.fraction))
        assert passage.n_steps.tolist() == [20_000]
    np.testing.assert_array_equal(found[0][0], found[1][0])
    np.testing.assert_array_equal(found[0][1], found[1][1])
    run = lp.stochastic.noisy_orbits(
        ROUND, [0, 0, 1], times=np.linspace(0, 200, 20_001), noises=EACH, seed=2, method=LONG["method"]
    )
    assert run.n_steps.tolist() == [20_000]
    np.testing.assert_allclose(found[0][0], run.end_state, atol=1e-9)


@pytest.mark.parametrize("h", [0.01, 0.1, 1 / 3])
def test_a_step_between_rounded_times_is_one(h):
    run = lp.stochastic.noisy_orbits(
        ROUND, [0, 0, 1], times=np.arange(20_001) * h, noises="l1", method=lp.Splitting(step=h, order=2)
    )
    assert run.n_steps.tolist() == [20_000]


def test_a_number_of_a_trajectory_has_48_bits():
    run = {"noises": "l1", "t_end": 1, "method": STEP}
    assert lp.stochastic.noisy_orbits(ROUND, [0, 0, 1], first=2**48 - 1, **run).n_steps[0] > 0
    with pytest.raises(ParameterError, match="first"):
        lp.stochastic.noisy_orbits(ROUND, [0, 0, 1], first=2**48, **run)


def test_the_histogram_is_that_of_the_law_within_its_errors():
    starts = np.tile([1.0, 0, 0], (100, 1))
    options = {"transient": 8, "t_end": 28, "n_samples": 50, "method": lp.Splitting(step=0.05, order=2)}
    law = lp.stochastic.stationary_law(ROUND, starts, "l3", edges=np.linspace(-1, 1, 5), noises=EACH, **options)
    assert (np.abs(law.density - 0.5) < 4 * law.error).all()
    assert law.error.max() < 0.05
    np.testing.assert_allclose(law.fraction.sum(axis=1), 1)


def test_a_histogram_in_parts_is_the_whole(monkeypatch):
    options = {"edges": [-1, 0, 0.5], "noises": EACH, "transient": 1, "t_end": 3, "n_samples": 40, "method": STEP}
    whole = lp.stochastic.stationary_law(ROUND, [[1, 0, 0], [np.nan, 0, 0]], "l3", **options)
    monkeypatch.setattr("liepoisson.noise.noise._NUMBERS", 7 * 6)
    parts = lp.stochastic.stationary_law(ROUND, [[1, 0, 0], [np.nan, 0, 0]], "l3", **options)
    np.testing.assert_array_equal(parts.fraction, whole.fraction)
    assert whole.outcome.tolist() == ["finished", "not finite"]
    for wrong in ({"transient": 3}, {"n_samples": 0}):
        with pytest.raises(ParameterError):
            lp.stochastic.stationary_law(ROUND, [1, 0, 0], "l3", **options | wrong)
    for edges in ([1, 0], [0, 1, 1], [0, math.inf], [0, math.nan]):
        with pytest.raises(ParameterError, match="edges: wanted finite increasing numbers"):
            lp.stochastic.stationary_law(ROUND, [1, 0, 0], "l3", **options | {"edges": edges})
    with pytest.raises(ShapeError, match="2 or more edges"):
        lp.stochastic.stationary_law(ROUND, [1, 0, 0], "l3", **options | {"edges": [1]})


def test_the_exponent_of_a_damped_spin_is_the_mean_of_its_contraction():
    r"""Noise that turns the sphere moves no two points apart, $H = l_3$ moves them at the rate $\frac\beta2 E\,l_3$.

    It does in every direction, since the second derivative of $l_3$ on the sphere is $-l_3$ times the metric; and under
    $e^{-\beta l_3}$ the mean of $-l_3$ is $\coth\beta - 1/\beta$.
    """
    spin, starts = lp.System(lp.so(3) @ lp.trivial(), "l3"), np.tile([1.0, 0, 0], (40, 1))
    options = {"noises": EACH, "t_end": 100, "method": lp.Splitting(step=0.05, order=2)}
    beta = 2.0
    mean = lp.stochastic.noisy_exponents(spin, starts, inverse_temperature=beta, **options).mean
    wanted = -beta / 2 * (1 / math.tanh(beta) - 1 / beta)
    assert abs(mean.value - wanted) < 3 * mean.standard_error
    free = lp.stochastic.noisy_exponents(spin, starts[:2], **options)
    np.testing.assert_allclose(free.exponent, 0, atol=1e-14)
    with pytest.raises(ParameterError, match="no points"):
        lp.stochastic.noisy_exponents(spin, [0, 0, 0], **options)
