"""`liepoisson section`: default surfaces, crossings of one leaf and energy, and the files."""

import re
import time

import numpy as np
import pytest

import liepoisson as lp

FEW = ("--starts", 3, "--crossings", 5)


def test_crossings_of_the_kovalevskaya_top(command, tmp_path):
    path = tmp_path / "section.csv"
    code, out, err = command("section", "kovalevskaya", "--leaf", "C1=0.5,C2=1", "--energy", 1, *FEW, "--out", path)
    assert (code, err) == (0, "")
    assert out.startswith("kovalevskaya: crossings where alpha2 increases through 0\nsurface  the rate of l3\n")
    for line in (
        "leaf     dimension 4, alpha != 0: C1 = 0.5, C2 = 1",
        "energy   H = 1",
        "section  dimension 2",
        "outcome  finished 3",
        f"wrote    {path}",
    ):
        assert line in out.splitlines()
    assert "found    15 crossings, 5 of each orbit" in out
    assert path.read_text().splitlines()[0] == "trajectory,time,sign,l1,l2,l3,alpha1,alpha2,alpha3"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    l, alpha = table[:, 3:6], table[:, 6:]
    np.testing.assert_allclose(np.einsum("ij,ij->i", l, alpha), 0.5, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(alpha, axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(l**2 @ [1 / 4, 1 / 4, 1 / 2] - alpha[:, 0], 1, atol=1e-12)  # H
    np.testing.assert_allclose(alpha[:, 1], 0, atol=1e-12)
    k = (l[:, 0] ** 2 / 4 - l[:, 1] ** 2 / 4 + alpha[:, 0]) ** 2 + (l[:, 0] * l[:, 1] / 2 + alpha[:, 1]) ** 2
    assert np.ptp(k.reshape(3, 5), axis=1).max() < 1e-12, "Kovalevskaya's integral is constant on each orbit"
    assert np.ptp(k) > 0.1, "the starts are spread over several tori"
    assert table[:, 2].tolist() == [1] * 15


def test_a_top_with_two_fields_has_the_good_surface_and_a_warning(command):
    _, out, _ = command("section", "twisted-kovalevskaya", *FEW)
    assert "crossings where -alpha2*beta3 + alpha3*beta2 increases" in out
    assert "surface  the rate of -dot(l, beta)" in out
    assert "bounds   |l| <= " in out
    assert "section  dimension 4; a plane shows a projection, which proves neither tori nor chaos" in out


@pytest.mark.parametrize(("direction", "signs"), [("up", {1}), ("down", {-1}), ("both", {-1, 1})])
def test_directions(command, tmp_path, direction, signs):
    path = tmp_path / "section.csv"
    command(
        "section", "lagrange", "--start", "1,0,1,0,0.6,0.8", "--direction", direction, "--crossings", 6, "--out", path
    )
    assert set(np.loadtxt(path, delimiter=",", skiprows=1)[:, 2]) == signs


def test_kept_functions_take_the_place_of_the_state(command, tmp_path):
    path = tmp_path / "section.csv"
    keep = ("--keep", "l3", "--keep", "dot(l, alpha)")
    code, _, _ = command("section", "kovalevskaya", *FEW, "--leaf", "C1=0.25", *keep, "--out", path)
    assert code == 0
    assert path.read_text().splitlines()[0] == 'trajectory,time,sign,l3,"dot(l, alpha)"'
    np.testing.assert_allclose(np.loadtxt(path, delimiter=",", skiprows=1)[:, 4], 0.25, atol=1e-12)


def test_a_surface_that_is_never_crossed_is_said_with_exit_code_1(command, tmp_path):
    path = tmp_path / "section.csv"
    start = ("--start", "1,0,0,0,0,1", "--t-end", 20)
    code, out, err = command("section", "kovalevskaya", "--surface", "l3 - 100", *start, "--plot", "--out", path)
    assert code == 1
    assert "found    0 crossings" in out
    assert err == "liepoisson: no orbit crosses l3 - 100 = 0 up to t = 20.\n"
    assert path.exists()
    assert "wrote    kovalevskaya" not in out


@pytest.mark.thorough
def test_a_surface_beyond_the_energy_surface_is_refused(command):
    code, out, err = command("section", "kovalevskaya", "--surface", "l3 - 100")
    assert code == 2
    assert "must cross l3 - 100 = 0; none of 768 random states could be moved to a crossing" in err
    assert "found" not in out


@pytest.mark.thorough
def test_a_surface_that_does_not_exist_everywhere(command):
    code, out, _ = command(
        "section", "kovalevskaya", "--surface", "sqrt(alpha1) - 1/2", "--starts", 5, "--crossings", 20
    )
    assert code == 0
    assert "missed   the function does not exist in" in out

    code, _, err = command("section", "kovalevskaya", "--surface", "sqrt(alpha1 - 7)", *FEW)
    assert (code, "none of 96 random states could be moved to a crossing" in err) == (2, True)


@pytest.mark.thorough
def test_what_was_not_seen_is_not_said_to_be_missing(command):
    fast = ("section", "kovalevskaya", "--surface", "sin(10^12*l1)", "--starts", 3)
    code, out, err = command(*fast, "--t-end", 2)
    assert code == 1
    assert re.search(r"^missed   the function could not be followed in \S+% of the time$", out, re.MULTILINE)
    assert re.fullmatch(
        r"liepoisson: no crossing of sin\(.*l1\) = 0 was found up to t = 2; the function could not be followed in "
        r"\S+% of the time.\n",
        err,
    )
    begin = time.perf_counter()
    code, out, err = command(*fast, "--time-limit", 1)
    assert time.perf_counter() - begin < 10, "starts and formulas take a second or two beside the run"
    assert (code, "outcome  time limit 3" in out) == (1, True)
    ended = r"where the first orbit ended \(time limit; \d+ was wanted\)(, nor up to t = \S+ on those that went on)?; "
    assert re.search(ended + "the function could not be followed in", err)
    assert "no orbit crosses" not in err


@pytest.mark.thorough
def test_errors_that_no_majorant_bounds_are_said(command):
    _, out, _ = command("section", "goryachev", *FEW)  # its field is not of degree two
    assert "error    of the state estimated, not bounded, in " in out
    _, out, _ = command("section", "kovalevskaya", *FEW)
    assert "error    " not in out


def test_orbits_that_escape_are_told_with_what_to_do(command):
    code, out, _ = command("section", "henon-heiles", "--starts", 6, "--crossings", 9)  # far above the energy of escape
    assert code == 0
    assert "escaped  6 of 6 orbits ran to infinity or to where the equations have no value: their starts" in out
    _, out, _ = command("section", "kovalevskaya", *FEW)
    assert "escaped" not in out


EVEN = """
name = "even"
[bracket]
canonical = ["x", "y"]
[hamiltonian]
expression = "(p_x^2 + p_y^2)/2 + x^2/2 + y^2 + x^2*y^2/2"
"""


def test_a_figure_by_default_has_axes_that_vary_on_the_surface(command, tmp_path, monkeypatch):
    """The rate of p_y is -y times a positive function: y vanishes on the surface, and a figure of it is a line."""
    seen = []
    monkeypatch.setattr("liepoisson.cli.runs.write_figure", lambda figure, stem: seen.append(figure.axes[0]) or [])
    path = tmp_path / "even.toml"
    path.write_text(EVEN)
    code, out, _ = command("section", path, "--starts", 3, "--crossings", 20, "--figure", tmp_path / "even.png")
    assert code == 0
    assert "crossings where -x^2*y - 2*y increases" in out
    assert (seen[0].get_xlabel(), seen[0].get_ylabel()) == ("$x$", "$p_{x}$")
    command("section", path, "--starts", 3, "--crossings", 20, "--figure", tmp_path / "even.png", "--y", "p_y")
    assert (seen[1].get_xlabel(), seen[1].get_ylabel()) == ("$x$", "$p_{y}$")


@pytest.mark.thorough
@pytest.mark.parametrize("surface", ["l3-0.1", "l3^2 + dot(l, alpha)", "dot(l, l)/2 + l3^2/2 + alpha3 - 1"])
def test_a_constant_of_motion_is_no_surface(command, surface):
    words = "a constant of motion: its bracket with H is zero"
    code, _, err = command("section", "lagrange", "--surface", surface)
    assert code == 2
    assert words in err
    assert surface in err
    with pytest.raises(lp.errors.ParameterError, match=words):
        lp.section(lp.catalog.system("lagrange"), [1, 0, 1, 0, 0.6, 0.8], surface=surface, t_end=10)


def test_netcdf_can_be_rerun(command, tmp_path):
    path = tmp_path / "section.nc"
    code, _, _ = command("section", "twisted-kovalevskaya", *FEW, "--out", path)
    assert code == 0
    saved, again = lp.load(path).dataset, lp.rerun(path)
    np.testing.assert_array_equal(again.state, saved["state"])
    assert len(again.time) == 15


@pytest.mark.thorough
def test_figure_of_any_two_functions(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, out, _ = command("section", "twisted-kovalevskaya", *FEW, "--plot", "--x", "dot(l, beta)", "--y", "alpha1")
    assert re.findall(r"^wrote +(\S+)$", out, re.MULTILINE) == ["twisted-kovalevskaya-section.png"]
    code, _, _ = command("section", "kovalevskaya", *FEW, "--keep", "l1", "--keep", "l2", "--figure", "kept.svg")
    assert (code, (tmp_path / "kept.svg").exists()) == (0, True)


def titles(monkeypatch):
    """The titles of the figures that a command draws."""
    found = []

    def keep(figure, stem):
        found.append(figure.axes[0].get_title(loc="left") or figure.axes[0].get_title())
        return [stem]

    monkeypatch.setattr("liepoisson.cli.runs.write_figure", keep)
    return found


@pytest.mark.thorough
def test_title_is_typeset_and_says_what_was_set(command, monkeypatch):
    found = titles(monkeypatch)
    where = (*FEW, "--leaf", "C1=0.5", "--leaf", "C2=1", "--energy", 1, "--figure", "a.svg")
    _, out, _ = command("section", "kovalevskaya", "--surface", "l3", *where)
    lines = found[0].splitlines()
    assert lines[:2] == [
        "kovalevskaya: section $\\ell_{3}$ = 0, increasing",
        "$H$ = $1$, $C_{1}$ = $0.5$, $C_{2}$ = $1$",
    ]
    assert "leaf     dimension 4, alpha != 0: C1 = 0.5, C2 = 1" in out.splitlines()
    _, out, _ = command(
        "section", "kovalevskaya", *FEW, "--set", "I=3/2,1.2,0.7", "--set", "a=[-1,0, sqrt(2)]", "--plot"
    )
    name = "kovalevskaya, I = (3/2, 1.2, 0.7), a = (-1, 0, sqrt(2)):"
    assert out.startswith(f"{name} crossings where ")
    assert found[1].splitlines()[0] == name
    assert out.splitlines()[-1] == "wrote    kovalevskaya-section.png", "files are named after the system alone"


@pytest.mark.thorough
def test_a_figure_that_folds_the_section_says_so(command, monkeypatch):
    titles(monkeypatch)
    folds = "figure   folds the section: different states may lie at one point. Leave out --x and --y for others"
    unfolded = "figure   atan2(alpha1, alpha3) and l2: coordinates on the section"
    for axes, line in ((("--x", "alpha1", "--y", "l1"), folds), ((), unfolded)):
        _, out, _ = command("section", "kovalevskaya", "--starts", 6, "--crossings", 40, "--plot", *axes)
        assert [found for found in out.splitlines() if found.startswith("figure")] == [line]


def curves(ax):
    """The points of a figure, one array for each orbit."""
    return [line.get_xydata() for line in ax.lines]


def test_the_first_own_figure_is_unfolded(command, tmp_path, monkeypatch):
    """An asymmetric top: the rate of l3 vanishes on a section that no plane shows unfolded; alpha3 does not."""
    seen = []
    monkeypatch.setattr("liepoisson.cli.runs.write_figure", lambda figure, stem: seen.append(figure) or [stem])
    own = ("heavy-top", "--set", "I=2,1.5,1", "--set", "a=0.3,0,1")
    path = tmp_path / "own.nc"
    code, out, _ = command("section", *own, "--crossings", 60, "--plot", "--out", path)
    assert code == 0
    assert "crossings where alpha3 increases through 0\nsurface  a component: every plane folds" in out
    assert "figure   atan2(alpha2, alpha1) and l3: coordinates on the section" in out.splitlines()
    (ax,) = seen[0].axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == (r"$\mathrm{atan2}(\alpha_{2}, \alpha_{1})$", r"$\ell_{3}$")
    state = lp.load(path).state
    drawn = np.concatenate(curves(ax))
    turned = np.angle(np.exp(1j * drawn[:, 0]))
    np.testing.assert_allclose(turned, np.arctan2(state[:, 4], state[:, 3]), rtol=0, atol=1e-14)
    # Nearby in the plane is nearby in the state: each pair in a square of side 0.02, in units of the figure.
    scaled = drawn / np.ptp(drawn, axis=0)
    near = np.abs(scaled[:, None] - scaled[None]).max(axis=-1) < 0.02
    far = np.linalg.norm(state[:, None] - state[None], axis=-1)
    assert far[near].max() < 0.25 * far.max()
    assert near.sum() > 1.5 * len(drawn)


def test_two_sheets_are_drawn_side_by_side_and_named(command, monkeypatch):
    seen = []
    monkeypatch.setattr("liepoisson.cli.runs.write_figure", lambda figure, stem: seen.append(figure) or [stem])
    leaf = ("--leaf", "C1=0.5,C2=1", "--energy", 1.5)
    _, out, _ = command("section", "kovalevskaya", "--surface", "l3", *leaf, "--crossings", 60, "--plot")
    line = r"^figure   (.+) and (.+): two sheets side by side, one for each sign of (.+)$"
    assert re.search(line, out, re.MULTILINE)
    left, right = seen[0].axes
    assert left.get_title(loc="left").splitlines()[-1].endswith("$> 0$")
    assert right.get_title(loc="left").endswith("$< 0$")
    assert sum(np.isfinite(one).all(axis=1).sum() for ax in (left, right) for one in curves(ax)) == 24 * 60


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["twisted-top"], "must have numbers for all parameters"),
        (["kovalevskaya", "--surface", "l3 - q"], "the name 'q' is unknown"),
        (["kovalevskaya", "--surface", "abs(l3)"], "abs"),
        (["kovalevskaya", "--keep", "l7"], "l7"),
        (["kovalevskaya", "--surface", "1 - 1"], "a function of the state was wanted; '1 - 1' is constant"),
        (["kovalevskaya", "--surface", "dot(l,alpha)"], "constant on each leaf: its bracket with every component is"),
        (["kovalevskaya", "--leaf", "C1=0.3", "--leaf", "C1=1"], "--leaf must give each Casimir once; C1 comes twice"),
        (["kovalevskaya", "--energy", "1", "--energy", "2"], "--energy must be given once; it comes twice"),
        (["kovalevskaya", "--starts", "0"], "--starts must be from 1 to 100000; got 0"),
        (["kovalevskaya", "--crossings", "0"], "--crossings must be from 1 to 1000000000; got 0. Try 500."),
        (["kovalevskaya", "--t-end", "nan"], "--t-end must be a finite time other than 0; got nan. Leave it out."),
        (["kovalevskaya", "--t-end", "0"], "--t-end must be a finite time other than 0"),
        (["kovalevskaya", "--threads", "0"], "--threads: wanted a whole number from 1 to 4096; got 0"),
        (["kovalevskaya", "--seed", "-1"], "--seed: wanted a whole number >= 0"),
        (["kovalevskaya", "--time-limit", "0"], "--time-limit: wanted a positive number of seconds; got 0"),
        (["kovalevskaya", "--start", "l=1,0,0", "--starts", "3"], "--starts and --start exclude each other"),
        (["kovalevskaya", "--plot", "--keep", "l1", "--x", "l2"], "--x and --y must be kept; 'l2' is not"),
        (["kovalevskaya", "--plot", "--keep", "l1"], "two functions for its axes; only 'l1' is there"),
        (["kovalevskaya", "--out", "/proc/section.nc"], "could not write /proc/section.nc"),
        (["kovalevskaya", "--plot", "--x", "q"], "the name 'q' is unknown"),
        (["kovalevskaya", "--energy", "-5"], "On this leaf the energy lies between"),
        (["kovalevskaya", "--out", "section.png"], "--out must end in one of .nc, .csv"),
        (["kovalevskaya", "--direction", "left"], "left"),
    ],
)
def test_refusals_are_plain(command, arguments, words):
    code, out, err = command("section", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("name", "function"), [("section", "poincare.section.section"), ("orbit", "numeric.integrate.integrate")]
)
def test_after_ctrl_c_it_says_how_to_keep_what_is_done(command, monkeypatch, name, function):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"liepoisson.{function}", interrupted)
    code, _, err = command(name, "kovalevskaya")
    assert (code, "--time-limit SECONDS" in err) == (130, True)
