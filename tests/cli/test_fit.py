"""`liepoisson fit`: a file of observations, and the parameters that it gives."""

import json

import numpy as np
import pytest

import liepoisson as lp

T = np.linspace(0, 2, 21)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a system and degrees that its pendulum with g = 9.81 has."""
    monkeypatch.chdir(tmp_path)
    pendulum = lp.System(lp.canonical(1, names=["theta"]), "p_theta^2/2 - g*cos(theta)", {"g": "9.81"}, name="pendulum")
    lp.systems.write_system(lp.System(pendulum.symbolic_bracket, "p_theta^2/2 - g*cos(theta)", {"g": 9}), "pen.toml")
    angle = np.rad2deg(lp.integrate(pendulum, [0.3, 0.5], times=T).state[0, :, 0])
    rows = [f"{t!r},{a!r},0.1" for t, a in zip(T.tolist(), angle.tolist(), strict=True)]
    (tmp_path / "pen.csv").write_text("\n".join(["time,deg,err", *rows]))
    return tmp_path


LINE = ("fit", "pen.toml", "pen.csv", "--column", "deg=180/pi*theta", "--error", "deg=err", "--start", "theta=0.25")
UNKNOWN = ("--unknown", "g", "--unknown", "theta", "--unknown", "p_theta")


def test_a_file_gives_the_parameters(here, command):
    code, out, err = command(*LINE, *UNKNOWN, "--bound", "g=0:", "--out", "fit.nc", "--figure", "fit.png", "--quiet")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[0].startswith("<OrbitFit of")
    assert [line.split()[0] for line in lines[1:4]] == ["g", "theta(t0)", "p_theta(t0)"]
    assert "g           = 9.81" in lines[1]
    assert lines[-2:] == ["wrote    fit.nc", "wrote    fit.png"]
    np.testing.assert_allclose(lp.load("fit.nc").value, [9.81, 0.3, 0.5], atol=1e-10)


def test_programs_read_json(here, command):
    code, out, _ = command(*LINE, *UNKNOWN, "--format", "json")
    found = json.loads(out)
    assert (code, found["ending"], found["degrees_of_freedom"], found["undetermined"]) == (0, "converged", 18, [])
    assert found["values"]["g"]["value"] == pytest.approx(9.81, abs=1e-10)


def test_a_search_that_does_not_converge_ends_with_1(here, command):
    code, out, err = command(*LINE, "--unknown", "g", "--time-limit", "1e-9")
    assert (code, "time limit" in out) == (1, True)
    assert "did not converge (time limit)" in err
