"""`liepoisson orbit`: starts on leaves and energies, what is printed, and the files."""

import re

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.cli.options import Where
from liepoisson.cli.orbit import run_lines
from liepoisson.cli.starts import find_start
from liepoisson.errors import LeafError, LiePoissonError

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


def test_casimirs_that_are_left_out_keep_their_values(twisted):
    own = lp.sample_states(twisted, 1, seed=3)[0]
    start = find_start(twisted, Where(leaf=["C1=2"]), seed=3)
    assert start.leaf.casimirs["C1"] == 2
    assert start.leaf.casimirs["C2"] == pytest.approx(own[3:6] @ own[6:])
    assert start.leaf.contains(start.state)


def test_several_values_of_leaf_are_taken_together(twisted):
    assert find_start(twisted, Where(leaf=["C1=2", "C2=1/2,C3=1"])).leaf.casimirs == {"C1": 2, "C2": 0.5, "C3": 1}


def test_a_start_is_never_moved(twisted):
    with pytest.raises(LeafError, match=r"it has C3 = 1 instead of 2.*--guess"):
        find_start(twisted, Where(start=["beta=0,0,1"], leaf=["C3=2"]))
    with pytest.raises(LeafError, match="it has H = 0 instead of 1"):
        find_start(twisted, Where(start=["beta=0,0,1"], energy=1))
    with pytest.raises(LeafError, match=r"it has C3 = 1 instead of 1\.000001"):
        find_start(twisted, Where(start=["beta=0,0,1"], leaf=["C3=1.000001"]))
    kept = find_start(twisted, Where(start=["beta=0,0,1"], leaf=["C3=1.00000000001"], energy=0))  # within 1e-10
    assert kept.state.tolist() == [0, 0, 0, 0, 0, 0, 0, 0, 1]


def test_states_are_read_exactly_by_place_or_by_name(twisted):
    given = find_start(twisted, Where(start=["1/3,-1,sqrt(2)/2,0,0,0,0,1e-3,2"]))
    assert given.state.tolist() == [1 / 3, -1, 2**0.5 / 2, 0, 0, 0, 0, 1e-3, 2]
    named = find_start(twisted, Where(start=["l=1,2,3", "beta2=-4"]))
    assert named.state.tolist() == [1, 2, 3, 0, 0, 0, 0, -4, 0]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["1,2,3"], r"must have 9 numbers \(l1, l2, l3, alpha1, .*beta3\); got 3"),
        (["l=1,2"], "--start l must have 3 numbers; got 2"),
        (["gamma=1,2,3"], "must name a field or a component; got 'gamma'. Known: l, alpha, beta, l1"),
        (["l=1,2,3", "l2=1"], "each component once; l2 comes twice"),
        (["l=1,2,x"], r"--start l: wanted an array of numbers; x: the name 'x' is unknown"),
        (["l=1,2,"], "--start"),
        (["1,2,3", "l=1,2,3"], "must be name=value; got '1,2,3'"),
    ],
)
def test_bad_states_are_refused(twisted, words, message):
    with pytest.raises(LiePoissonError, match=message):
        find_start(twisted, Where(start=words))


def test_a_degenerate_leaf_is_named(command):
    _, out, _ = command("orbit", "twisted-kovalevskaya", "--start", "l=1,0,0", "--start", "alpha=0,0,2", *SHORT)
    assert "leaf     dimension 4, beta = 0, alpha != 0: " in out
    assert "= 4" in out  # |alpha|^2, a Casimir of this stratum


@pytest.mark.thorough
def test_netcdf_can_be_rerun_and_csv_has_all_digits(command, tmp_path):
    nc, csv = tmp_path / "new" / "orbit.nc", tmp_path / "orbit.csv"
    for path in (nc, csv):
        code, out, _ = command("orbit", "lagrange", *SHORT, "--out", path)
        assert (code, out.splitlines()[-1]) == (0, f"wrote    {path}")
    saved = lp.load(nc).dataset
    again = lp.rerun(nc)
    np.testing.assert_array_equal(again.state, saved["state"])
    assert csv.read_text().splitlines()[0] == "trajectory,time,outcome,l1,l2,l3,alpha1,alpha2,alpha3"
    table = np.loadtxt(csv, delimiter=",", skiprows=1, usecols=(1, *range(3, 9)))
    np.testing.assert_array_equal(table[:, 0], saved["time"])
    np.testing.assert_array_equal(table[:, 1:], saved["state"][0])


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


@pytest.mark.parametrize("start", ["1e200,0,0,0,0,1,1e200,1,1", "alpha=1e200,0,0"])
def test_a_start_whose_casimirs_are_too_large_is_refused(command, start):
    code, out, err = command("orbit", "twisted-kovalevskaya", "--start", start, "--t-end", 2)
    assert (code, out) == (2, "")
    assert "Casimirs" in err


def test_a_start_whose_energy_is_too_large_ends_with_its_outcome(command):
    code, out, _ = command("orbit", "twisted-kovalevskaya", "--start", "1e200,0,0,0,0,1,1,1,1", "--t-end", 2)
    assert code == 0
    assert "energy   H = inf" in out
    assert "outcome  not finite at t = 0" in out


@pytest.mark.parametrize(("name", "leaf"), [("twisted-kovalevskaya", "C3=0"), ("two-field-kovalevskaya", "C2=9")])
def test_a_leaf_without_values_points_to_start(command, name, leaf):
    code, _, err = command("orbit", name, "--leaf", leaf)
    assert code == 2
    assert "--start STATE, without --leaf" in err
    assert "leaf_of" not in err


def test_backwards_and_by_another_method(command):
    code, out, _ = command("orbit", "lagrange", "--t-end", -2, "--points", 5, "--method", "gauss", "--step", 0.05)
    assert code == 0
    assert "outcome  finished at t = -2, 40 steps" in out


def test_a_run_that_fails_tells_its_outcome():
    system = lp.catalog.system("twisted-kovalevskaya")
    run = lp.integrate(system, np.full(9, 1e200), times=[0, 1, 2])
    text = "\n".join(run_lines(system, run))
    assert "outcome  not finite at t = 0" in text or "outcome  step too small" in text
    assert "drift    not known" in text


@pytest.mark.parametrize("where", ["typer.main.get_command", "liepoisson.cli.orbit.find_start"])
def test_ctrl_c_before_the_run_is_one_line(command, monkeypatch, where):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(where, interrupted)
    assert command("orbit", "kovalevskaya") == (130, "", "interrupted.\n")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twisted-top"], "must have numbers for all parameters; epsilon, I[3], a[3], b[3] have none"),
        (["kovalevskaya", "--t-end", "0"], "--t-end must be a finite time other than 0"),
        (["kovalevskaya", "--t-end", "nan"], "--t-end must be a finite time other than 0"),
        (["kovalevskaya", "--points", "1"], "--points must be from 2"),
        (["kovalevskaya", "--time-limit", "nan"], "--time-limit: wanted a positive number of seconds; got nan"),
        (["kovalevskaya", "--time-limit", "-1"], "--time-limit: wanted a positive number of seconds; got -1"),
        (["kovalevskaya", "--seed", "-1"], "--seed: wanted a whole number >= 0"),
        (["kovalevskaya", "--leaf", "C2=-1"], "C2"),
        (
            ["kovalevskaya", "--leaf", "C7=1"],
            "must name Casimirs of kovalevskaya; got 'C7'. Known: C1 = l.alpha, C2 = |alpha|^2. Write --leaf C1=1.",
        ),
        (["kovalevskaya", "--leaf", "C1=1,C1=2"], "C1 comes twice"),
        (["kovalevskaya", "--leaf", "C1=1", "--leaf", "C1=2"], "C1 comes twice"),
        (["kovalevskaya", "--energy", "1", "--energy", "2"], "--energy must be given once; it comes twice. Remove one"),
        (["kovalevskaya", "--leaf", "1,2"], "--leaf must be name=value; got '1'. Write for example --leaf C1=1,C2=0"),
        (["kovalevskaya", "--energy", "-5"], "On this leaf the energy lies between"),
        (["kovalevskaya", "--guess", "l=1,0,0"], "--guess must come with --leaf or --energy"),
        (["kovalevskaya", "--start", "l=1,0,0", "--guess", "l=1,0,0"], "exclude each other"),
        (["kovalevskaya", "--out", "orbit.txt"], "--out must end in one of .nc, .csv; got 'orbit.txt'"),
        (["kovalevskaya", "--out", " "], "--out must name a file"),
        (["kovalevskaya", "--out", "."], "--out must be a file; . is a folder"),
        (["kovalevskaya", "--figure", "a.jpg"], "--figure must end in one of .png, .svg, .pdf"),
        (["kovalevskaya", "--method", "euler"], "--method must be one of"),
        (["kovalevskaia"], "kovalevskaia"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("orbit", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def test_an_orbit_too_large_for_a_figure_is_refused_without_a_traceback(command, tmp_path):
    figure = tmp_path / "a.png"
    code, _, err = command("orbit", "kovalevskaya", "--t-end", 5, "--start", "l=1e200,0,0", "--figure", figure)
    assert code == 2
    assert err.startswith("liepoisson: ")
    assert not figure.exists()


@pytest.mark.parametrize(("step", "said"), [("1e300", True), ("0.2", True), ("0.1", False), ("0.05", False)])
def test_the_steps_that_were_taken_are_told(command, step, said):
    """21 points to t = 2 are 0.1 apart, and steps end there."""
    code, out, _ = command("orbit", "kovalevskaya", *SHORT, "--method", "gauss", "--step", step)
    line = f"step     0.1, not {float(step):g}: steps end at the times that are kept (see --points)"
    assert (code, line in out) == (0, said)
