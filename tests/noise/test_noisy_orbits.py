"""Noise of Stratonovich by Hamiltonians: Casimirs on every path, orders, laws, the same bits everywhere."""

import math

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.stochastic import noisy_orbits

BODY = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
X = [0.48, 0.6, 0.64]
EACH = ["l1/2", "l2/2", "l3/2"]
KUBO = lp.System(lp.so(3) @ lp.trivial(), "13*l1/10", name="Kubo's oscillator")
"""The frequency 1.3 with white noise, as (q, p) = (l2, l3): the bracket of l1 with them is a rotation."""


def step(size, order=2):
    return lp.Splitting(step=size, order=order)


def copies(n, x=X):
    return np.tile(x, (n, 1))


def ends(noises, size, increments, n=300, **options):
    return noisy_orbits(
        BODY, copies(n), noises=noises, times=[0, 1], method=step(size), increments=increments, seed=1, **options
    ).end_state


def largest_gap(values):
    """The statistic of Kolmogorov and Smirnov of values that should be uniform, times the root of their number."""
    n, u = len(values), np.sort(values)
    return math.sqrt(n) * max((np.arange(1, n + 1) / n - u).max(), (u - np.arange(n) / n).max())


ONE_IN_A_THOUSAND = 1.95
"""What the statistic exceeds with this probability; the seeds are fixed."""


def test_kubos_oscillator_has_the_means_of_its_solution():
    r"""$E z = z_0 e^{-\sigma^2t/2 + i\omega t}$, as $z = z_0 e^{i(\omega t + \sigma W)}$; within 4 standard errors."""
    sigma, n = 0.7, 4000
    run = noisy_orbits(KUBO, copies(n, [0, 1, 0]), noises=f"{sigma}*l1", times=[0, 1, 2, 3], method=step(0.5), seed=3)
    decay = np.exp(-(sigma**2) * run.time / 2)
    wanted = [decay * np.cos(1.3 * run.time), -decay * np.sin(1.3 * run.time)]
    np.testing.assert_allclose(run.state[:, :, 1:].mean(axis=0).T, wanted, atol=4 * math.sqrt(0.5 / n))
    assert run.drift["C1"].max() < 1e-14


def test_without_noise_orbits_are_those_of_splitting_bit_for_bit():
    for system, noises in ((BODY, ["1e-300*l1", [], "0"]), (lp.Top.kovalevskaya(), ["1e-300*alpha1", [], "l1 - l1"])):
        start = np.linspace(0.3, 0.9, len(system.component_names))
        options = {"t_end": 20, "method": lp.Splitting(step=0.05)}
        plain = lp.integrate(system, start, **options)
        for noise in noises:
            run = noisy_orbits(system, start, noises=noise, inverse_temperature=2 * (noise == []), **options)
            np.testing.assert_array_equal(run.state, plain.state)


def test_a_noise_of_amplitude_zero_leaves_the_paths_of_the_others():
    options = {"t_end": 5, "seed": 7, "method": step(0.1), "inverse_temperature": 2}
    with_zero = noisy_orbits(BODY, copies(3), noises=["l1/2", "0", "l3/2"], **options).state
    almost = noisy_orbits(BODY, copies(3), noises=["l1/2", "1e-300*l2", "l3/2"], **options).state
    np.testing.assert_array_equal(with_zero, almost)


@pytest.mark.thorough
@pytest.mark.parametrize("noises", ["4*l1/5", "4*l1^2/5"])
@pytest.mark.parametrize("beta", [0, 2])
def test_the_strong_order_of_one_noise_is_one(noises, beta):
    exact = ends(noises, 2**-9, 1, inverse_temperature=beta)
    errors = [np.linalg.norm(ends(noises, 2.0**-k, 2 ** (9 - k), inverse_temperature=beta) - exact) for k in (3, 6)]
    assert 0.85 < math.log2(errors[0] / errors[1]) / 3 < 1.15  # measured: 1.01 to 1.03


@pytest.mark.thorough
def test_the_strong_order_of_noises_that_do_not_commute_is_a_half():
    noises = ["4*l1/5", "l2/2"]
    exact = ends(noises, 2**-9, 1)
    errors = [np.linalg.norm(ends(noises, 2.0**-k, 2 ** (9 - k)) - exact) for k in (2, 5)]
    assert 0.4 < math.log2(errors[0] / errors[1]) / 3 < 0.65  # without the areas of the path there is no more


@pytest.mark.slow
def test_the_weak_order_is_two():
    r"""$E l$ obeys $\dot y = (M_H + \frac12\sum_k M_k^2)\,y$ where all Hamiltonians are linear; independent paths.

    Strang's composition of the semigroups has the errors 0.0083 and 0.0020; measured with 4,000,000 paths: 0.0085 and
    0.0022, each within some 0.0005.
    """
    turn = np.cross(np.eye(3)[None], np.eye(3)[:, None]).transpose(0, 2, 1)  # turn[k] x = x cross e_k
    rate = 4 * turn[2] + turn[0] @ turn[0] / 2 + 0.3**2 * turn[1] @ turn[1] / 2
    exact = np.array(X)
    for _ in range(4000):
        exact = exact + rate @ (exact + rate @ exact / 8000) / 4000
    spin, n, errors = lp.System(lp.so(3) @ lp.trivial(), "4*l3"), 1_000_000, []
    for size in (0.25, 0.125):
        runs = [
            noisy_orbits(spin, copies(n), noises=["l1", "3*l2/10"], times=[0, 1], method=step(size), seed=seed)
            for seed in range(round(100 * size), round(100 * size) + 4)
        ]
        errors.append(np.linalg.norm(np.mean([run.end_state.mean(axis=0) for run in runs], axis=0) - exact))
    assert 1.5 < math.log2(errors[0] / errors[1]) < 2.6, errors


@pytest.mark.slow
def test_casimirs_are_kept_over_a_million_steps():
    run = noisy_orbits(BODY, X, noises=EACH, times=np.linspace(0, 10_000, 101), method=step(0.01))
    assert run.n_steps == 1_000_000
    assert run.drift["C1"].max() < 1e-12


def test_the_same_bits_whatever_the_threads_lanes_and_number_of_trajectories(monkeypatch):
    starts = np.linspace([0.1, 0.2, 0.3], [0.9, 0.1, 0.4], 11)
    run = {"noises": ["l1", "l2^2"], "inverse_temperature": 1, "t_end": 2, "method": step(0.05), "seed": 2**100}
    whole = noisy_orbits(BODY, starts, threads=1, **run)
    np.testing.assert_array_equal(noisy_orbits(BODY, starts, threads=2, **run).state, whole.state)
    np.testing.assert_array_equal(noisy_orbits(BODY, starts[4:6], first=4, **run).state, whole.state[4:6])
    for simd in lp._core.available_simd():
        monkeypatch.setenv("LIEPOISSON_SIMD", simd)
        np.testing.assert_array_equal(noisy_orbits(BODY, starts, **run).state, whole.state)
    assert not (noisy_orbits(BODY, starts, **run | {"seed": 1}).state[:, -1] == whole.state[:, -1]).any()


WELL = lp.System(lp.algebras.heisenberg(1) @ lp.trivial(), "lp1^2/2", name="one velocity")
"""A velocity p, which noise "lq1" moves alone: damped to a temperature it is the process of Ornstein and Uhlenbeck."""
IN_WELL = [0, 0, -1]
"""$\\lbrace q, p\\rbrace = -l_c = 1$."""


@pytest.mark.parametrize("share", [0.1, 0.45])
def test_a_step_that_is_not_short_beside_the_damping_widens_the_law_as_it_must(share):
    r"""With $z = h\lambda$, $\lambda = \beta/2$: a half step of the midpoint rule is $a = 1 - z/2 + z^2/8$, so that the
    variance is $\frac h2\frac{1 + a^4}{1 - a^4} = \frac1\beta(1 + \frac38z^2 + \dots)$; within 4 standard errors.
    Of the start $a^{400}$ is left.
    """
    n, beta = 40_000, 200
    h = 2 * share / beta
    run = noisy_orbits(
        WELL, copies(n, IN_WELL), noises="lq1", times=[0, 100 * h], method=step(h), inverse_temperature=beta, seed=6
    )
    a = 1 - share / 2 + share**2 / 8
    wanted = h / 2 * (1 + a**4) / (1 - a**4)
    assert 1 <= wanted * beta < 1.1
    assert run.end_state[:, 1].var() == pytest.approx(wanted, rel=4 * math.sqrt(2 / n))


@pytest.mark.parametrize(("beta", "h"), [(100, 0.0101), (1000, 0.05), (1e4, 1)])
def test_a_step_that_the_damping_cannot_take_is_an_outcome(beta, h):
    options = {"times": [0, 10 * h], "method": step(h), "inverse_temperature": beta}
    for noises in ("lq1", ["lq1/2"] * 4):  # the same law by one noise and by four
        run = noisy_orbits(WELL, IN_WELL, noises=noises, **options)
        assert (run.outcome.tolist(), run.end_time.tolist(), run.n_steps.tolist()) == (["step too large"], [0], [0])
        np.testing.assert_array_equal(run.end_state, [IN_WELL])


def test_where_the_damping_becomes_too_fast_does_not_depend_on_the_other_trajectories():
    """In $p^4/4$ the rate grows like $p^2$: trajectories end at different times, each at its own."""
    quartic = lp.System(WELL.bracket, "lp1^4/4")
    starts = np.column_stack([np.zeros(11), np.linspace(0, 1.6, 11), -np.ones(11)])
    times = np.linspace(0, 10, 151)
    options = {"noises": "lq1", "times": times, "method": step(0.07), "inverse_temperature": 2, "seed": 3}
    whole = noisy_orbits(quartic, starts, threads=1, **options)
    assert {*whole.outcome} == {"finished", "step too large"}
    assert len({*whole.end_time}) > 3
    for k, start in enumerate(starts):
        alone = noisy_orbits(quartic, start, first=k, **options)
        np.testing.assert_array_equal(alone.state[0], whole.state[k])
        assert (alone.outcome[0], alone.end_time[0]) == (whole.outcome[k], whole.end_time[k])


def test_the_law_of_a_shaken_body_is_uniform_on_its_sphere():
    run = noisy_orbits(BODY, copies(2000), noises=["l1", "l2", "l3"], times=[0, 8], method=step(0.05), seed=5)
    for k in range(3):
        assert largest_gap((run.end_state[:, k] + 1) / 2) < ONE_IN_A_THOUSAND


def test_the_law_of_a_damped_body_is_that_of_gibbs():
    r"""$e^{-\beta H}$ on the sphere, here $\propto e^{-\beta l_3^2/4}$ in $l_3$, for moments 2, 2 and 1."""
    beta, body = 4.0, lp.catalog.euler_top_on("so(3)", [2, 2, 1])
    run = noisy_orbits(
        body, copies(1500), noises=["l1", "l2", "l3"], inverse_temperature=beta, times=[0, 5], method=step(0.1), seed=6
    )
    z = np.linspace(-1, 1, 20_001)
    law = np.cumsum(np.exp(-beta * z**2 / 4))
    assert largest_gap(np.interp(run.end_state[:, 2], z, law / law[-1])) < ONE_IN_A_THOUSAND
    assert run.drift["C1"].max() < 1e-13


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"noises": {"l1": "1"}}, "which may leave it"),
        ({"noises": [["l1", "l2", "0"]]}, "stay on the leaf"),
        ({"noises": "l1^2 + l2^2 + l3^2"}, "a function of Casimirs; leave it out"),
        ({"noises": "exp(l1)"}, "no exact flow"),
        ({"noises": "x"}, "x"),
        ({"noises": "3"}, "move something"),
        ({"method": lp.Taylor()}, "try Splitting"),
        ({"method": lp.Splitting(step=0.1, precision="single")}, "try Splitting"),
        ({"seed": 0.5}, "seed"),
        ({"increments": 0}, "increments"),
        ({"times": [1, 0]}, "increasing"),
        ({"times": None}, "times or t_end"),
        ({"inverse_temperature": -1}, "inverse_temperature"),
    ],
)
def test_what_is_refused(options, said):
    with pytest.raises((ParameterError, UnsupportedFieldError, lp.errors.ExpressionError), match=said):
        noisy_orbits(BODY, X, **{"noises": "l1", "times": [0, 1], "method": step(0.1)} | options)


def test_a_bracket_without_linear_flows_is_refused():
    with pytest.raises(UnsupportedFieldError, match="linear in the state"):
        noisy_orbits(lp.catalog.system("henon-heiles"), [0, 0.1, 0.1, 0], noises="x", times=[0, 1], method=step(0.1))


def test_increments_beyond_all_sense_are_outcomes():
    run = noisy_orbits(BODY, X, noises="1e6*l1", times=[0, 1, 2], method=step(1))
    assert run.outcome.tolist() == ["not finite"]
    assert np.isnan(run.state[0, 1:]).all()
