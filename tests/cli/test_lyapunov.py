"""`liepoisson lyapunov`: exponents of random starts, with what they mean."""

import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.cli.chaos import summary


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


@pytest.mark.thorough
def test_spectrum_prints_the_mean_of_the_runs_and_the_check(command, tmp_path):
    path, figure = tmp_path / "new" / "spectrum.nc", tmp_path / "spectrum.png"
    run = ("--spectrum", "--starts", 4, "--t-end", 100, "--seed", 3)
    code, out, err = command("lyapunov", "twisted-kovalevskaya", *run, "--out", path, "--figure", figure)
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
    assert figure.is_file()


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


def test_the_default_time_is_natural(command):
    """1,000 natural times of the median orbit, whatever the unit of time."""
    system = lp.catalog.system("free-rigid-body")
    wanted = 1000 * float(np.median(lp.orbits.time_scale(system, lp.sample_states(system, 3, seed=0))))
    _, out, _ = command("lyapunov", "free-rigid-body", "--starts", 3)
    found = float(re.search(r"to t = ([0-9.e+]+), 1,000 natural times", out)[1])
    assert found == pytest.approx(wanted, rel=0.05)  # two digits


def test_the_unit_of_time_is_taken_of_some_of_many_starts(monkeypatch):
    from liepoisson.cli.runs import unit_of_time
    from liepoisson.numeric import time_scale

    seen = []
    monkeypatch.setattr(time_scale, "time_scale", lambda _, x0: seen.append(len(x0)) or np.ones(len(x0)))
    assert unit_of_time(lp.Top.kovalevskaya(), np.ones((100_000, 9))) == 1.0
    assert seen == [256]
