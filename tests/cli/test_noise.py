"""The commands that take a file with a table [noise], and those that refuse it."""

import numpy as np
import pytest

import liepoisson as lp

BODY = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
START = ("--start", "0.48,0.6,0.64")
TEXT = """
name = "shaken body"
[bracket]
algebra = "so(3)"
variables = ["l"]
[parameters]
I = [1, 2, 3]
s = 0.25
[hamiltonian]
expression = "dot(l, inv(I)*l)/2"
[noise]
noises = ["s*l1", "s*l2", "s*l3"]
inverse_temperature = 2
"""
NOISE = {"noises": ["l1/2", "l2/2", "l3/2"], "inverse_temperature": 2}


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "body.toml"
    path.write_text(TEXT)
    return path


def test_an_orbit_is_that_of_python_on_the_path_of_its_seed(command, file, tmp_path):
    path = tmp_path / "orbit.nc"
    options = ("--set", "s=1/2", "--t-end", 5, "--points", 51, "--step", 0.1, "--seed", 7, "--out", path)
    code, out, err = command("orbit", file, *START, *options)
    assert (code, err) == (0, "")
    assert "noise    l1/2, l2/2, l3/2; inverse temperature 2; seed 7\n" in out
    times, method = np.linspace(0, 5, 51), lp.Splitting(step=0.1)
    wanted = lp.stochastic.noisy_orbits(BODY, [0.48, 0.6, 0.64], **NOISE, times=times, seed=7, method=method)
    assert np.array_equal(lp.load(path).state, wanted.state)
    assert np.array_equal(lp.rerun(path).state, wanted.state)


def test_exponents_are_those_of_python(command, file, tmp_path):
    path, figure = tmp_path / "exponents.nc", tmp_path / "figure.png"
    options = ("--set", "s=1/2", "--t-end", 5, "--step", 0.1, "--starts", 3, "--seed", 7, "--out", path)
    code, out, err = command("lyapunov", file, *options, "--figure", figure)
    assert (code, err) == (0, "")
    starts = lp.sample_states(BODY, 3, seed=7)
    wanted = lp.stochastic.noisy_exponents(BODY, starts, **NOISE, t_end=5, seed=7, method=lp.Splitting(step=0.1))
    assert np.array_equal(lp.load(path).exponent, wanted.exponent)
    assert f"largest exponent {wanted.mean}, error from the spread of 3 finished runs\n" in out
    assert figure.exists()


REFUSED = {
    "method": (("orbit", *START, "--method", "taylor"), "wanted Splitting in double precision"),
    "tol": (("orbit", *START, "--tol", "1e-9"), "--tol is not an option of splitting"),
    "backwards": (("orbit", *START, "--t-end", "-1"), "a positive finite time"),
    "spectrum": (("lyapunov", "--spectrum"), "only the largest"),
    "decide": (("decide",), "a path of noise has none"),
    "section": (("section", *START), "a path of noise has none"),
    "equilibria": (("equilibria",), "a path of noise has none"),
    "inspect": (("inspect",), "a path of noise has none"),
}


@pytest.mark.parametrize(("line", "words"), REFUSED.values(), ids=[*REFUSED])
def test_what_noise_does_not_have_is_refused(command, file, line, words):
    name, *options = line
    code, _, err = command(name, file, *options)
    assert code == 2
    assert words in err
