"""`liepoisson lyapunov`: exponents of random starts, with what they mean."""

import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.cli.lyapunov import summary

SQRT = """
name = "pendulum with a root"
[bracket]
algebra = "so(3)"
extension = "semidirect(2)"
variables = ["l", "alpha"]
[parameters]
m = "1/2"
[hamiltonian]
expression = "dot(l, l)/2 + sqrt(1 + m*dot(alpha, alpha) + alpha3^2)"
"""


def test_mean_and_quantiles_are_those_of_the_runs(command):
    code, out, err = command("lyapunov", "twisted-kovalevskaya", "--starts", 8, "--t-end", 20, "--seed", 3)
    assert (code, err) == (0, "")
    top = lp.Top.twisted_kovalevskaya()
    x0 = lp.sample_states(top, 8, seed=3)  # the same ensemble if none is named
    last = lp.finite_time_exponents(top, x0, t_end=20, seed=3).exponent[:, -1]
    mean, error = map(float, re.search(r"mean ([\d.]+), standard error over starts ([\d.]+)", out).groups())
    assert mean == pytest.approx(last.mean(), abs=1e-6)
    assert error == pytest.approx(last.std(ddof=1) / np.sqrt(8), rel=0.05)
    assert float(re.search(r"median +([\d.-]+)", out)[1]) == pytest.approx(np.median(last), abs=1e-6)
    assert "outcomes: finished 8" in out
    assert "mixes leaves and energies" in out
    assert "top kernel" in out


def test_a_file_with_a_root_goes_from_text_to_an_exponent(command, tmp_path):
    path = tmp_path / "root.toml"
    path.write_text(SQRT)
    code, out, _ = command("lyapunov", path, "--starts", 2, "--t-end", 5)
    assert code == 0
    assert "tape kernel" in out
    assert "outcomes: finished 2" in out


@pytest.mark.thorough
def test_results_are_saved_on_request(command, tmp_path):
    path = tmp_path / "growth.nc"
    code, _, _ = command("lyapunov", "lagrange", "--starts", 2, "--t-end", 5, "--ensemble", "cube", "--out", path)
    assert code == 0
    assert lp.load(path).dataset["exponent"].sizes == {"trajectory": 2, "time": 200}


@pytest.mark.thorough
def test_a_folder_that_is_missing_is_made_and_one_in_the_place_of_the_file_refused_at_once(command, tmp_path):
    path = tmp_path / "new" / "growth.nc"
    code, _, _ = command("lyapunov", "lagrange", "--starts", 1, "--t-end", 5, "--out", path)
    assert (code, path.is_file()) == (0, True)
    code, out, err = command("lyapunov", "lagrange", "--starts", 1, "--t-end", 1e12, "--out", tmp_path)
    assert (code, out) == (2, "")
    assert f"--out must be a file; {tmp_path} is a folder" in err


def test_failed_runs_are_counted_and_left_out():
    top = lp.Top.twisted_kovalevskaya()
    x0 = lp.sample_states(top, 3, seed=1)
    x0[1] = 1e200  # overflows at once
    growth = lp.finite_time_exponents(top, x0, t_end=5)
    lines = "\n".join(summary(growth, "by hand", 1.0))
    assert "finished 2" in lines
    assert "of the 2 finished runs" in lines
    failed = lp.finite_time_exponents(top, np.full((2, 9), 1e200), t_end=5)
    assert "no run finished" in "\n".join(summary(failed, "by hand", 1.0))


def test_one_run_has_no_standard_error(command):
    _, out, _ = command("lyapunov", "lagrange", "--starts", 1, "--t-end", 5)
    assert "one run: no standard error" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twisted-top"], "must have numbers for all parameters; epsilon, I[3], a[3], b[3] have none"),
        (["lagrange", "--starts", "0"], "--starts must be from 1 to"),
        (["lagrange", "--t-end", "-5"], "positive finite time"),
        (["lagrange", "--t-end", "nan"], "positive finite time"),
        (["lagrange", "--spectrum", "--t-end", "1e12", "--time-limit", "3"], "at most 10000000 intervals"),
        (["lagrange", "--ensemble", "sphere"], "wanted one of unit-vectors, cube, gaussian; got 'sphere'"),
        (["lagrange", "--tol", "2"], "tol"),
        (["lagrange", "--threads", "0"], "--threads: wanted a whole number from 1 to 4096; got 0"),
        (["lagrange", "--seed", "-1"], "--seed: wanted a whole number >= 0"),
        (["lagrange", "--time-limit", "nan"], "--time-limit: wanted a positive number of seconds"),
        (["lagrange", "--out", " "], "--out must name a file"),
        (
            ["lagrange", "--out", "x.txt"],
            "--out must end in one of .nc, .csv; got 'x.txt'. Write for example --out lagrange-exponents.nc.",
        ),
        (["lagrang"], "Did you mean lagrange"),
        (["lagrange", "--start", "1,0,0,0,0,1", "--starts", "3"], "--starts and --start exclude each other"),
        (["lagrange", "--ensemble", "cube", "--energy", "1"], "--ensemble and --leaf exclude each other"),
        (["lagrange", "--energy", "-9"], "On this leaf the energy lies between"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("lyapunov", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


@pytest.mark.parametrize("options", [(), ("--spectrum",)])
def test_after_ctrl_c_it_says_how_to_keep_what_is_done(command, monkeypatch, options):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("liepoisson.indicators.finite_time_exponents.finite_time_exponents", interrupted)
    monkeypatch.setattr("liepoisson.indicators.spectrum.lyapunov_spectrum", interrupted)
    code, _, err = command("lyapunov", "lagrange", *options)
    assert (code, "--time-limit SECONDS" in err) == (130, True)


@pytest.mark.thorough
def test_spectrum_prints_the_mean_of_the_runs_and_the_check(command, tmp_path):
    path = tmp_path / "spectrum.nc"
    code, out, err = command(
        "lyapunov", "twisted-kovalevskaya", "--spectrum", "--starts", 4, "--t-end", 100, "--seed", 3, "--out", path
    )
    assert (code, err) == (0, "")
    rows = np.array([line.split() for line in re.findall(r"^ +\d .*$", out, re.MULTILINE)], dtype=float)
    saved = lp.load(path).dataset
    last = saved["exponent"].to_numpy()[:, -1]
    assert rows[:, 1] == pytest.approx(last.mean(axis=0), abs=1e-5)
    assert rows[:, 3] == pytest.approx(last.min(axis=0), abs=1e-5)
    assert rows[:, 4] == pytest.approx(last.max(axis=0), abs=1e-5)
    assert "structural zeros: 5 of 9" in out
    assert "pairs +x, -x" in out
    assert np.array_equal(lp.rerun(path).exponent, saved["exponent"].to_numpy())


def test_spectrum_of_runs_that_failed_has_nothing_to_tell():
    from liepoisson.indicators.spectrum import lyapunov_spectrum

    failed = lyapunov_spectrum(lp.Top.twisted_kovalevskaya(), np.full((2, 9), 1e200), t_end=5)
    assert "no run finished" in "\n".join(summary(failed, "by hand", 1.0))


def test_one_orbit_is_given_by_its_start(command, tmp_path):
    figure = tmp_path / "growth.svg"
    code, out, err = command(
        "lyapunov", "kovalevskaya", "--start", "1,0,1,0,0,1", "--t-end", 20, "--seed", 2, "--figure", figure
    )
    assert (code, err) == (0, "")
    alone = lp.finite_time_exponents(lp.catalog.system("kovalevskaya"), [1, 0, 1, 0, 0, 1], t_end=20, seed=2)
    assert float(re.search(r"mean ([\d.]+) \(one run", out)[1]) == pytest.approx(alone.exponent[0, -1], abs=1e-6)
    assert "leaf     dimension 4, alpha != 0: C1 = 1, C2 = 1\nenergy   H = 0.75" in out
    assert out.splitlines()[-1] == f"wrote    {figure}"
    assert figure.is_file()


@pytest.mark.slow
def test_random_starts_lie_on_the_leaf_and_at_the_energy_that_are_asked_for(command, tmp_path):
    path = tmp_path / "growth.nc"
    where = ("--leaf", "l.alpha=1/5", "--leaf", "C2=1", "--energy", "3/2")
    code, out, _ = command("lyapunov", "kovalevskaya", *where, "--starts", 5, "--t-end", 5, "--seed", 4, "--out", path)
    assert code == 0
    assert "5 random starts on one leaf and energy (seed 4)" in out
    assert "A mean over random starts mixes chaotic and regular orbits: it is not the exponent of\none orbit." in out
    system = lp.catalog.system("kovalevskaya")
    starts = lp.Leaf(system, {"C1": 0.2, "C2": 1}).sample(5, seed=4, energy=1.5)
    expected = lp.finite_time_exponents(system, starts, t_end=5, seed=4)
    assert np.array_equal(lp.load(path).exponent, expected.exponent)


@pytest.mark.thorough
def test_figures_are_written_where_it_says(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for options, name in (((), "mean.png"), (("--spectrum",), "spectrum.png")):
        code, out, _ = command("lyapunov", "lagrange", "--starts", 3, "--t-end", 30, *options, "--figure", name)
        assert (code, out.splitlines()[-1], (tmp_path / name).is_file()) == (0, f"wrote    {name}", True)


def test_the_default_time_is_natural(command):
    """1,000 natural times of the median orbit, whatever the unit of time."""
    system = lp.catalog.system("free-rigid-body")
    wanted = 1000 * float(np.median(lp.orbits.time_scale(system, lp.sample_states(system, 3, seed=0))))
    _, out, _ = command("lyapunov", "free-rigid-body", "--starts", 3)
    found = float(re.search(r"to t = ([0-9.e+]+), 1,000 natural times", out)[1])
    assert found == pytest.approx(wanted, rel=0.05)  # two digits


def test_a_very_long_run_is_counted_in_powers_of_ten(command):
    _, out, _ = command("lyapunov", "twisted-kovalevskaya", "--starts", 2, "--t-end", 1e300, "--time-limit", 0.01)
    assert re.search(r"1\.\d+e\+300 natural times", out.splitlines()[0])


def test_the_unit_of_time_is_taken_of_some_of_many_starts(monkeypatch):
    from liepoisson.cli.runs import unit_of_time
    from liepoisson.numeric import time_scale

    seen = []
    monkeypatch.setattr(time_scale, "time_scale", lambda _, x0: seen.append(len(x0)) or np.ones(len(x0)))
    assert unit_of_time(lp.Top.kovalevskaya(), np.ones((100_000, 9))) == 1.0
    assert seen == [256]
