"""`liepoisson relax`, and the commands for orbits of files with damping."""

import csv
import re

import pytest

import liepoisson as lp

TOP = lp.catalog.system("heavy-top")
START = ("--start", "l=1,0,1", "--start", "alpha=0.6,0,0.8")


@pytest.fixture
def file(tmp_path):
    damped = lp.dissipation.double_bracket(TOP, "gamma", parameters={"gamma": "1/10"}, name="damped top")
    return lp.systems.write_system(damped, tmp_path / "top.toml")


def test_a_file_with_damping_relaxes_as_in_python(command, file, tmp_path):
    path = tmp_path / "way.csv"
    code, out, err = command("relax", file, *START, "--set", "gamma=1/3", "--out", path)
    assert (code, err) == (0, "")
    found = lp.dissipation.relax(lp.dissipation.double_bracket(TOP, "1/3"), {"l": (1, 0, 1), "alpha": (0.6, 0, 0.8)})
    assert out.startswith("damped top, gamma = 1/3: relaxation\nstart    as given\n  l      1, 0, 1\n")
    assert f"approach like exp(-{found.decay:.6g} t)" in out
    assert f"ends at  {', '.join(f'{value:.9g}' for value in found.equilibrium.state)}" in out
    rows = [*csv.DictReader(path.read_text().splitlines())]
    assert [*rows[0]] == ["time", "energy", *TOP.component_names]
    assert float(rows[-1]["energy"]) == found.energy[-1]


@pytest.mark.thorough
def test_a_relaxation_is_written_and_drawn(command, file, tmp_path):
    path, figure = tmp_path / "way.nc", tmp_path / "way.png"
    code, out, err = command("relax", file, *START, "--out", path, "--figure", figure)
    assert (code, err) == (0, "")
    assert f"wrote    {path}\nwrote    {figure}\n" in out
    found = lp.load(path)
    assert f"ends at  {', '.join(f'{value:.9g}' for value in found.equilibrium.state)}" in out
    assert figure.exists()


def test_a_system_relaxes_on_a_leaf_with_an_integral(command):
    code, out, _ = command("relax", "lagrange", "--leaf", "C1=0.2,C2=1", "--along", "l3=1/2")
    assert code == 0
    assert "<Equilibrium of 'lagrange, H - 1/2*l3': energy -0.86, stable spectrum" in out


def test_where_it_does_not_arrive_the_code_is_1(command):
    code, out, err = command("relax", "free-rigid-body", "--start", "0,1,0", "--t-end", 100)
    assert code == 1
    assert "outcome  saddle at t = 100" in out
    assert "start beside it" in err
    code, out, err = command("relax", "free-rigid-body", "--start", "0.1,1,0", "--t-end", 1)
    assert code == 1
    assert re.search(r"^outcome  not arrived at t = 1$", out, re.MULTILINE)
    assert "nearby   " in out  # where Newton's method leads is not where it ends
    assert "ends at" not in out


def test_orbits_sections_and_exponents_take_the_file(command, file):
    _, out, _ = command("orbit", file, "--leaf", "C1=0.2,C2=1", "--t-end", 50)
    assert re.search(r"^falls    H from .* to .*, against it 0e\+00$", out, re.MULTILINE)
    assert re.findall(r"^  (\w+)  .e-", out, re.MULTILINE) == ["C1", "C2"]
    _, out, _ = command("section", file, *START, "--surface", "l2", "--t-end", 30)
    assert "  l      1, 0, 1\n  alpha  0.6, 0, 0.8\n" in out
    _, out, _ = command("lyapunov", file, "--spectrum", "--starts", 2, "--t-end", 100)
    assert "finished 2" in out


def test_inspect_says_what_damping_keeps(command, file):
    code, out, err = command("inspect", file)
    assert (code, err) == (0, "")
    assert "H falls (proved)" in out
    assert "Casimirs" in out


def test_commands_for_systems_refuse_it(command, file):
    code, _, err = command("equilibria", file, "--leaf", "C1=0,C2=1")
    assert code == 2
    assert "wanted a system without damping" in err
