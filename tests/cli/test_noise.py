"""The commands that take a file with a table [noise], and those that refuse it."""

import json

import numpy as np
import pytest

import liepoisson as lp

BODY = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
START = ("--start", "0.48,0.6,0.64")
NOISE = {"noises": ["l1/2", "l2/2", "l3/2"], "inverse_temperature": 2}


def test_an_orbit_is_that_of_python_on_the_path_of_its_seed(command, shaken_body, tmp_path):
    path = tmp_path / "orbit.nc"
    options = ("--set", "s=1/2", "--t-end", 5, "--points", 51, "--step", 0.1, "--seed", 7, "--out", path)
    code, out, err = command("orbit", shaken_body, *START, *options)
    assert (code, err) == (0, "")
    assert "noise    l1/2, l2/2, l3/2; inverse temperature 2; seed 7\n" in out
    times, method = np.linspace(0, 5, 51), lp.Splitting(step=0.1)
    wanted = lp.stochastic.noisy_orbits(BODY, [0.48, 0.6, 0.64], **NOISE, times=times, seed=7, method=method)
    assert np.array_equal(lp.load(path).state, wanted.state)
    assert np.array_equal(lp.rerun(path).state, wanted.state)


def test_exponents_are_those_of_python(command, shaken_body, tmp_path):
    path, figure = tmp_path / "exponents.nc", tmp_path / "figure.png"
    options = ("--set", "s=1/2", "--t-end", 5, "--step", 0.1, "--starts", 3, "--seed", 7, "--out", path)
    code, out, err = command("lyapunov", shaken_body, *options, "--figure", figure)
    assert (code, err) == (0, "")
    starts = lp.sample_states(BODY, 3, seed=7)
    wanted = lp.stochastic.noisy_exponents(BODY, starts, **NOISE, t_end=5, seed=7, method=lp.Splitting(step=0.1))
    assert np.array_equal(lp.load(path).exponent, wanted.exponent)
    assert f"largest exponent {wanted.mean}, error from the spread of 3 finished runs\n" in out
    assert figure.exists()


SWEEP = """
system = "body.toml"
t_end = 5
n_starts = 3
seed = 7
axes = [{ name = "s", values = [0.25, 0.5] }]
method = { name = "splitting", step = 0.1 }
"""


def test_a_sweep_is_made_of_the_runs_of_lyapunov(command, shaken_body, tmp_path):
    (tmp_path / "sweep.toml").write_text(SWEEP)
    code, out, _ = command("sweep", tmp_path / "sweep.toml", "--quiet", "--out", tmp_path / "sweep.nc")
    assert (code, "outcomes: finished 6" in out) == (0, True)
    swept = lp.load(tmp_path / "sweep.nc")
    for s, exponents, errors in zip((0.25, 0.5), swept.value, swept.error, strict=True):
        options = (
            "--set",
            f"s={s}",
            "--t-end",
            5,
            "--step",
            0.1,
            "--starts",
            3,
            "--seed",
            7,
            "--out",
            tmp_path / "a.nc",
        )
        command("lyapunov", shaken_body, *options)
        alone = lp.load(tmp_path / "a.nc")
        assert np.array_equal(exponents, alone.exponent)
        assert np.array_equal(errors, alone.error)


RUN = ("--set", "s=1/2", *START, "--t-end", 8, "--step", 0.1, "--seed", 7, "--trajectories", 5)
STARTS = np.tile([0.48, 0.6, 0.64], (5, 1))


def test_a_law_is_that_of_python(command, shaken_body, tmp_path):
    path, figure = tmp_path / "law.nc", tmp_path / "law.png"
    options = ("--edges", "-1:1:4", "--transient", 2, "--samples", 50)
    code, out, err = command("stationary", shaken_body, "l3", *RUN, *options, "--out", path, "--figure", figure)
    assert (code, err) == (0, "")
    wanted = lp.stochastic.stationary_law(
        BODY, STARTS, "l3", **NOISE, t_end=8, transient=2, n_samples=50, edges=np.linspace(-1, 1, 5), seed=7,
        method=lp.Splitting(step=0.1),
    )  # fmt: skip
    assert np.array_equal(lp.load(path).fraction, wanted.fraction)
    assert "shaken body, s = 1/2: law of l3 from t = 2 to 8, 5 trajectories from one start\n" in out
    assert f"{wanted.density[3]:8.4f}  {wanted.error[3]:8.4f}\noutside of the bins: 0.0000 of the samples\n" in out
    assert figure.exists()
    _, out, _ = command("stationary", shaken_body, "l3", *RUN, "--edges", "0,1/2", "--format", "json")
    assert json.loads(out)["edges"] == [0.0, 0.5]


def test_passages_are_those_of_python(command, shaken_body, tmp_path):
    path, figure = tmp_path / "passages.nc", tmp_path / "passages.png"
    line = ("passages", shaken_body, "l3 + 9/10", *RUN)
    code, out, err = command(*line, "--out", path, "--figure", figure)
    assert (code, err) == (0, "")
    options = {"function": "l3 + 9/10", "t_end": 8, "seed": 7, "method": lp.Splitting(step=0.1)}
    wanted = lp.stochastic.first_passages(BODY, STARTS, **NOISE, **options)
    assert np.array_equal(lp.load(path).time, wanted.time, equal_nan=True)
    assert 0 < wanted.passed.sum() < 5
    assert f"passed   {wanted.passed.sum()} of 5\nmean     t = {wanted.mean}, under the condition" in out
    assert figure.exists()
    record = json.loads(command(*line, "--format", "json")[1])
    assert [time is None for time in record["time"]] == (~wanted.passed).tolist()


def test_the_exit_code_says_that_nothing_passed(command, shaken_body):
    code, out, _ = command("passages", shaken_body, "l3 - 2", *START, "--t-end", 1, "--trajectories", 2)
    assert (code, "passed   0 of 2\n" in out) == (1, True)


REFUSED = {
    "edges": (("stationary", "l3", *START, "--t-end", "1", "--edges", "0:1"), "LOW:HIGH:COUNT"),
    "ensemble": (("passages", "l3", *START, "--t-end", "1", "--ensemble", "cube"), "exclude each other"),
    "method": (("orbit", *START, "--method", "taylor"), "wanted Splitting in double precision"),
    "tol": (("orbit", *START, "--tol", "1e-9"), "--tol is not an option of splitting"),
    "backwards": (("orbit", *START, "--t-end", "-1"), "a positive finite time"),
    "spectrum": (("lyapunov", "--spectrum"), "only the largest"),
    "decide": (("decide",), "a path of noise has none"),
    "section": (("section", *START), "a path of noise has none"),
    "equilibria": (("equilibria",), "a path of noise has none"),
}


@pytest.mark.parametrize(("line", "words"), REFUSED.values(), ids=[*REFUSED])
def test_what_noise_does_not_have_is_refused(command, shaken_body, line, words):
    name, *options = line
    code, _, err = command(name, shaken_body, *options)
    assert code == 2
    assert words in err


def test_inspect_says_what_noise_keeps(command, shaken_body):
    code, out, err = command("inspect", shaken_body, "--format", "json")
    assert (code, err) == (0, "")
    record = json.loads(out)
    assert (record["name"], record["noise"]["constant"]) == ("shaken body", ["C1"])
    assert record["noise"]["inverse_temperature"] == "2"


def test_a_law_of_noise_needs_noise(command):
    code, _, err = command("stationary", "lagrange", "l3", "--t-end", 1, "--edges", "0,1")
    assert (code, "SYSTEM must be a file with a table [noise]; lagrange has no noise" in err) == (2, True)


def test_steps_that_the_damping_cannot_take_are_told(command, shaken_body):
    few = ("l3", "--edges=-1:1:4", "--trajectories", 3, *START)
    for name, more in (("lyapunov", ("--starts", 3)), ("stationary", few)):
        options = ("--set", "beta=1e5", "--t-end", 5, "--step", 0.1)
        code, _, err = command(name, shaken_body, *more, *options)
        assert (code, "damping relaxes (step too large): take a smaller --step.\n" in err) == (1, True), err
