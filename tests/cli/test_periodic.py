"""`liepoisson periodic`, `continue` and `melnikov`: what the functions give, as text, for programs and as tables."""

import json

import numpy as np
import pytest

import liepoisson as lp

HENON = lp.catalog.system("henon-heiles")
STRAIGHT = ("henon-heiles", "--start", "p_y=0.2", "--period", "6.3")


def test_an_orbit_near_a_start(command, tmp_path):
    path = tmp_path / "orbit.csv"
    code, out, err = command("periodic", *STRAIGHT, "--out", path)
    orbit = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3)
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == repr(orbit)
    assert f"period   {orbit.period!r}" in out
    assert path.read_text() == orbit.to_csv(tmp_path / "expected.csv").read_text()
    command("periodic", *STRAIGHT, "--out", tmp_path / "orbit.nc")
    assert lp.load(tmp_path / "orbit.nc").start.tolist() == orbit.start.tolist()


def test_an_orbit_is_moved_to_a_level_and_turns(command):
    given = ("--guess", "l=1,0,1/2", "--guess", "alpha=0,0.6,0.8", "--energy", "3/2", "--period", "4")
    code, out, _ = command("periodic", "lagrange", *given, "--momentum", "l3", "--format", "json")
    assert code == 0
    record = json.loads(out)
    assert record["energy"] == pytest.approx(1.5, rel=1e-13)
    assert list(record["momenta"]) == ["l3"]
    assert len(record["angles"]) == 1


def test_momenta_have_values_where_orbits_are_searched(command):
    level = ("--leaf", "C1=1/5,C2=1", "--energy", "2", "--starts", 5)
    code, out, err = command("periodic", "lagrange", *level, "--momentum", "l3")
    assert (code, out) == (2, "")
    assert "--momentum must come with a value where orbits are searched: --momentum l3=1/2" in err
    code, out, _ = command("periodic", "lagrange", *level, "--momentum", "l3=1/2", "--format", "json")
    assert {one["momenta"]["l3"] for one in json.loads(out)["orbits"]} <= {0.5}


def test_orbits_of_a_level(command, tmp_path):
    code, out, _ = command(
        "periodic", "henon-heiles", "--energy", "1/12", "--starts", 40, "--out", tmp_path / "found.nc"
    )
    found = lp.orbits.periodic_orbits(HENON, {}, "1/12", n_starts=40)
    assert code == 0
    assert out.startswith(repr(found))
    assert repr(lp.load(tmp_path / "found.nc")) == repr(found)
    assert "starts (x, y, p_x, p_y)\n  0  " in out
    code, out, _ = command("periodic", "henon-heiles", "--energy", "1/12", "--starts", 40, "--format", "json")
    assert [one["period"] for one in json.loads(out)["orbits"]] == [one.period for one in found]


def test_a_level_without_orbits_is_told_by_the_exit_code(command, tmp_path):
    free = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2", name="free")
    lp.systems.write_system(free, tmp_path / "free.toml")
    code, out, _ = command("periodic", tmp_path / "free.toml", "--energy", "1", "--starts", 3)
    assert (code, out.startswith("No periodic orbits of 'free'")) == (1, True)


def test_a_family_its_table_and_its_branch(command, tmp_path):
    table, figure = tmp_path / "family.csv", tmp_path / "family.svg"
    given = (*STRAIGHT, "--until", "0.162")
    code, out, err = command("continue", *given, "--out", table, "--figure", figure)
    family = lp.orbits.orbit_family(HENON, lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3), until=0.162)
    assert (code, err) == (0, "")
    assert out.startswith(repr(family))
    assert table.read_text() == family.to_csv(tmp_path / "expected.csv").read_text()
    assert figure.stat().st_size > 1000
    _, out, _ = command("continue", *given, "--branch", 3, "--max-orbits", 15, "--format", "json")
    branch = lp.orbits.orbit_family(HENON, family.points[2], max_orbits=15)
    record = json.loads(out)
    assert [one["period"] for one in record["orbits"]] == pytest.approx(branch.period.tolist())
    assert record["along"] == "energy"
    command("continue", *given, "--out", tmp_path / "family.nc")
    assert repr(lp.load(tmp_path / "family.nc")) == repr(family)
    code, out, err = command("continue", *given, "--branch", 4)
    assert (code, out) == (2, "")
    assert "--branch must be from 1 to 3" in err
    assert "branch at 0.161551515; got 4" in " ".join(err.split())


def test_a_family_around_an_equilibrium(command):
    given = ("--equilibrium", "l1=1", "--equilibrium", "alpha1=1", "--mode", 1, "--max-orbits", 3)
    code, out, _ = command("continue", "kovalevskaya", *given)
    system = lp.catalog.system("kovalevskaya")
    rest = lp.phase_space.equilibrium(system, [1, 0, 0, 1, 0, 0])
    assert (code, out) == (0, f"{lp.orbits.orbit_family(system, rest, mode=1, max_orbits=3)!r}\n")


def test_melnikov(command, tmp_path):
    """-8 sin(2 psi) at psi = pi/4."""
    given = ("--start", "2^(1/2),2^(1/2),0,0,0,-1", "--origin", "alpha3=1", "--integral", "l3")
    settings = ("--set", "I=1,1,1", "--set", "a=0,0,1")
    path = tmp_path / "m.csv"
    code, out, err = command("melnikov", "heavy-top", "(l1^2 - l2^2)/2", *given, *settings, "--out", path)
    assert (code, err) == (0, "")
    assert float(out.split()[2]) == pytest.approx(-8, rel=1e-11)
    assert np.genfromtxt(path, delimiter=",", names=True)["M_l3"] == pytest.approx(-8, rel=1e-11)
    command("melnikov", "heavy-top", "(l1^2 - l2^2)/2", *given, *settings, "--out", tmp_path / "m.nc")
    assert lp.load(tmp_path / "m.nc").perturbation == "l1^2/2 - l2^2/2"
    _, out, _ = command("melnikov", "heavy-top", "(l1^2 - l2^2)/2", *given, *settings, "--format", "json")
    assert json.loads(out)["integrals"][0]["integral"] == "l3"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (("periodic", "henon-heiles", "--period", 6, "--starts", 3), "--starts and --period exclude each other"),
        (("continue", "henon-heiles"), "--period must come with --start or --guess; or write --equilibrium STATE"),
        (("continue", "henon-heiles", "--equilibrium", "0,0,0,0", "--period", 3), "exclude each other; leave one out"),
        (("continue", *STRAIGHT, "--mode", 1), "mode"),
        (("continue", "henon-heiles", "--equilibrium", "x=1"), "must be an equilibrium"),
        (("melnikov", "henon-heiles", "x"), "--start"),
    ],
)
def test_what_is_refused(command, line, words):
    code, out, err = command(*line)
    assert (code, out) == (2, "")
    assert words in " ".join(err.split())
