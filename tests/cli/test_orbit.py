"""`liepoisson orbit`: starts on leaves and energies, what is printed, and the files."""

import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.cli.options import Where
from liepoisson.cli.starts import find_start

SHORT = ("--t-end", 2, "--points", 21)


@pytest.fixture(scope="module")
def twisted():
    return lp.catalog.system("twisted-kovalevskaya")


def values(out, name):
    """The numbers of the line of a vector."""
    line = re.search(rf"^  {name} +(-?\d.*)$", out, re.MULTILINE)[1]
    return np.array([float(number) for number in line.split(",")])


def test_what_is_printed(command):
    code, out, err = command("orbit", "kovalevskaya", "--start", "1,0,1,0,0,1", "--t-end", 10, "--points", 11)
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[:6] == [
        "kovalevskaya: one orbit to t = 10, 11 points",
        "start    as given",
        "  l      1, 0, 1",
        "  alpha  0, 0, 1",
        "leaf     dimension 4, alpha != 0: C1 = 1, C2 = 1",
        "energy   H = 0.75",  # l1^2/4 + l3^2/2 - alpha1
    ]
    assert re.fullmatch(r"method   Taylor method, tolerance 1e-15, order \d+, quadratic kernel \(\w+\)", lines[6])
    assert re.fullmatch(r"outcome  finished at t = 10, \d+ steps", lines[7])
    assert lines[8] == "drift    largest change along 11 points"
    assert [line.split()[0] for line in lines[9:]] == ["H", "C1", "C2", "K"]
    assert all(float(line.split()[1]) < 1e-13 for line in lines[9:])


@pytest.mark.parametrize(("tol", "said"), [("1e-4", "Runge-Kutta method of order 8"), ("1e-14", "Taylor method")])
def test_the_method_that_was_chosen_is_what_is_printed(command, tol, said):
    _, out, _ = command("orbit", "manakov-so4", "--method", "auto", "--tol", tol, *SHORT)
    assert f"method   {said}, tolerance {float(tol):g}, order" in out


def test_default_start_is_member_0_of_the_seed(command, twisted):
    _, out, _ = command("orbit", "twisted-kovalevskaya", "--seed", 5, *SHORT)
    expected = lp.sample_states(twisted, 1, seed=5)[0].reshape(3, 3)
    for name, vector in zip(("l", "alpha", "beta"), expected, strict=True):
        np.testing.assert_allclose(values(out, name), vector, rtol=1e-8)
    limit = lp.phase_space.bounds(twisted, expected.ravel()).l
    assert f"|l| <= {limit:.6g}" in out


def test_a_guess_is_moved_onto_leaf_and_energy(command):
    wanted = ("--leaf", "C1=1.2,C2=0,C3=1", "--energy", 0.5)
    _, out, _ = command("orbit", "twisted-kovalevskaya", "--guess", "beta=0,0,1", *wanted, *SHORT)
    l, alpha, beta = (values(out, name) for name in ("l", "alpha", "beta"))
    assert alpha @ alpha + 2 * l @ beta == pytest.approx(1.2, abs=1e-7)
    assert alpha @ beta == pytest.approx(0, abs=1e-7)
    assert beta @ beta == pytest.approx(1, abs=1e-7)
    assert l @ (l / [4, 4, 2]) - alpha[0] == pytest.approx(0.5, abs=1e-7)
    moved = float(re.search(r"the guess, moved by ([\d.e+-]+)", out)[1])
    assert moved == pytest.approx(np.linalg.norm(np.concatenate([l, alpha, beta - [0, 0, 1]])), rel=1e-2)


def test_states_are_read_exactly_by_place_or_by_name_and_never_moved(twisted):
    given = find_start(twisted, Where(start=["1/3,-1,sqrt(2)/2,0,0,0,0,1e-3,2"]))
    assert given.state.tolist() == [1 / 3, -1, 2**0.5 / 2, 0, 0, 0, 0, 1e-3, 2]
    named = find_start(twisted, Where(start=["l=1,2,3", "beta2=-4"]))
    assert named.state.tolist() == [1, 2, 3, 0, 0, 0, 0, -4, 0]
    kept = find_start(twisted, Where(start=["beta=0,0,1"], leaf=["C3=1.00000000001"], energy=0))  # within 1e-10
    assert kept.state.tolist() == [0, 0, 0, 0, 0, 0, 0, 0, 1]


def test_values_of_a_leaf_are_taken_together_and_those_that_are_left_out_are_kept(twisted):
    own = lp.sample_states(twisted, 1, seed=3)[0]
    start = find_start(twisted, Where(leaf=["C1=2"]), seed=3)
    assert start.leaf.casimirs["C1"] == 2
    assert start.leaf.casimirs["C2"] == pytest.approx(own[3:6] @ own[6:])
    assert start.leaf.contains(start.state)
    assert find_start(twisted, Where(leaf=["C1=2", "C2=1/2,C3=1"])).leaf.casimirs == {"C1": 2, "C2": 0.5, "C3": 1}


def test_assignments_are_separated_by_commas_or_options(command):
    name = "twisted-kovalevskaya"
    _, apart, _ = command("orbit", name, "--start", "l=1,0,0", "--start", "alpha=0,0,2", *SHORT)
    _, together, _ = command("orbit", name, "--start", "l=1,0,0,alpha=0,0,2", *SHORT)
    assert together == apart


def test_a_degenerate_leaf_is_named(command):
    _, out, _ = command("orbit", "twisted-kovalevskaya", "--start", "l=1,0,0", "--start", "alpha=0,0,2", *SHORT)
    assert "leaf     dimension 4, beta = 0, alpha != 0: " in out
    assert "= 4" in out  # |alpha|^2, a Casimir of this stratum


@pytest.mark.thorough
def test_figures_are_written_where_it_says(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for option, wanted in (
        (("--plot",), ["twisted-kovalevskaya-orbit.png"]),
        (("--figure", "all"), [f"all.{extension}" for extension in ("png", "svg", "pdf")]),
    ):
        _, out, _ = command("orbit", "twisted-kovalevskaya", *option, *SHORT)
        names = [line.split()[1] for line in out.splitlines() if line.startswith("wrote")]
        assert names == wanted
        assert all((tmp_path / name).is_file() for name in names)
    assert len(list(tmp_path.iterdir())) == 4
    _, out, _ = command("orbit", "lagrange", "--figure", "new/mine.svg", *SHORT)
    assert out.splitlines()[-1] == "wrote    new/mine.svg"
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["mine.svg"]


def test_a_start_whose_energy_is_too_large_ends_with_its_outcome(command):
    code, out, _ = command("orbit", "twisted-kovalevskaya", "--start", "1e200,0,0,0,0,1,1,1,1", "--t-end", 2)
    assert code == 0
    assert "energy   H = inf" in out
    assert "outcome  not finite at t = 0" in out
    assert "drift    not known" in out


@pytest.mark.parametrize(("step", "said"), [("1e300", True), ("0.2", True), ("0.1", False), ("0.05", False)])
def test_the_steps_that_were_taken_are_told(command, step, said):
    """21 points to t = -2 are 0.1 apart, and steps end there."""
    backwards = ("--t-end", -2, "--points", 21)
    code, out, _ = command("orbit", "kovalevskaya", *backwards, "--method", "gauss", "--step", step)
    line = f"step     0.1, not {float(step):g}: steps end at the times that are kept (see --points)"
    assert (code, line in out) == (0, said)
