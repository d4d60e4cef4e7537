"""`liepoisson section`: default surfaces, crossings of one leaf and energy, and the files."""

import re

import numpy as np
import pytest

import liepoisson as lp

FEW = ("--starts", 3, "--crossings", 5)


@pytest.fixture
def drawn(monkeypatch):
    """The figures that a command would write."""
    figures = []
    monkeypatch.setattr("liepoisson.cli.runs.write_figure", lambda figure, stem: figures.append(figure) or [stem])
    return figures


def test_crossings_of_the_kovalevskaya_top(command, tmp_path):
    path = tmp_path / "section.csv"
    code, out, err = command("section", "kovalevskaya", "--leaf", "C1=0.5,C2=1", "--energy", 1, *FEW, "--out", path)
    assert (code, err) == (0, "")
    assert out.startswith("kovalevskaya: crossings where alpha2 increases through 0\nsurface  the rate of l3\n")
    for line in (
        *("leaf     dimension 4, alpha != 0: C1 = 0.5, C2 = 1", "energy   H = 1", "section  dimension 2"),
        *("outcome  finished 3", f"wrote    {path}"),
    ):
        assert line in out.splitlines()
    assert "found    15 crossings, 5 of each orbit" in out
    assert path.read_text().splitlines()[0] == "trajectory,time,sign,l1,l2,l3,alpha1,alpha2,alpha3"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    l, alpha = table[:, 3:6], table[:, 6:]
    np.testing.assert_allclose((l * alpha).sum(axis=1), 0.5, atol=1e-12)
    np.testing.assert_allclose((alpha**2).sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(l**2 @ [1 / 4, 1 / 4, 1 / 2] - alpha[:, 0], 1, atol=1e-12)  # H
    np.testing.assert_allclose(alpha[:, 1], 0, atol=1e-12)
    k = (l[:, 0] ** 2 / 4 - l[:, 1] ** 2 / 4 + alpha[:, 0]) ** 2 + (l[:, 0] * l[:, 1] / 2 + alpha[:, 1]) ** 2
    assert np.ptp(k.reshape(3, 5), axis=1).max() < 1e-12, "Kovalevskaya's integral is constant on each orbit"
    assert np.ptp(k) > 0.1, "the starts are spread over several tori"
    assert table[:, 2].tolist() == [1] * 15


def test_a_top_with_two_fields_has_the_good_surface_and_a_warning_and_can_be_rerun(command, tmp_path):
    path = tmp_path / "section.nc"
    _, out, _ = command("section", "twisted-kovalevskaya", *FEW, "--out", path)
    assert "crossings where -alpha2*beta3 + alpha3*beta2 increases" in out
    assert "surface  the rate of -dot(l, beta)" in out
    assert "bounds   |l| <= " in out
    assert "section  dimension 4; a plane shows a projection, which proves neither tori nor chaos" in out
    np.testing.assert_array_equal(lp.rerun(path).state, lp.load(path).state)
    assert "escaped" not in out
    assert "error    " not in out


@pytest.mark.parametrize(
    ("given", "method"),
    [
        ((), lp.Taylor()),
        (("--tol", "1e-9"), lp.Taylor(tol=1e-9)),
        (("--method", "gauss", "--step", "0.1", "--order", "6"), lp.Gauss(step=0.1, order=6)),
        (("--method", "runge-kutta", "--step", "0.1"), lp.RungeKutta(step=0.1)),
    ],
)
def test_the_method_is_that_of_python(command, tmp_path, given, method):
    path = tmp_path / "section.nc"
    start = ("--start", "y=0.1", "--start", "p_x=0.3", "--surface", "x", "--crossings", "4")
    code, out, err = command("section", "henon-heiles", *start, *given, "--out", path)
    assert (code, err) == (0, "")
    assert f"method   {method}, order" in out
    run = lp.load(path)
    wanted = lp.section(run.system, run.start, surface="x", t_end=run.t_end, direction=1, n_crossings=4, method=method)
    np.testing.assert_array_equal(run.state, wanted.state)
    assert run.method == method


def test_a_default_step_is_a_tenth_of_the_natural_time(command, tmp_path):
    path = tmp_path / "section.nc"
    command("section", "henon-heiles", "--energy", "1/10", *FEW, "--method", "gauss", "--out", path)
    run = lp.load(path)
    assert run.method == lp.Gauss(step=float(f"{run.t_end / 5 / 100 / 10:.1e}"))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("--method", "euler"), "--method must be one of taylor"),
        (("--method", "runge-kutta"), "--method runge-kutta must come with --step where crossings are wanted"),
        (("--method", "gauss", "--tol", "1e-9"), "--tol is not an option of gauss"),
        (("--step", "0.1"), "--step is not an option of taylor"),
    ],
)
def test_methods_that_are_refused(command, given, words):
    code, out, err = command("section", "henon-heiles", *FEW, *given)
    assert (code, out) == (2, "")
    assert words in err


@pytest.mark.parametrize("alone", [True, False])
@pytest.mark.parametrize("name", ["heavy-top", "henon-heiles", "kovalevskaya", "twisted-lagrange"])
def test_the_surface_by_default_is_that_of_python(command, name, alone):
    system = lp.catalog.system(name, {"I": (1, "4/5", "3/2")} if name == "heavy-top" else None)
    begin = lp.phase_space.find_start(system, seed=3)
    state = ",".join(map(repr, begin.state.tolist()))
    start = ("--start", state, *FEW[2:]) if alone else ("--energy", begin.energy, *FEW)
    given = ("--set", "I=1,4/5,3/2") if name == "heavy-top" else ()
    _, out, _ = command("section", name, *start, *given, "--seed", 3)
    surface = lp.sections.default_surface(begin.leaf, energy=None if alone else begin.energy, seed=3)
    assert f" crossings where {surface} increases through 0" in out.splitlines()[0]


@pytest.mark.parametrize(("direction", "signs"), [("up", {1}), ("down", {-1}), ("both", {-1, 1})])
def test_directions_and_kept_functions(command, tmp_path, direction, signs):
    path = tmp_path / "section.csv"
    start = ("--start", "1,0,1,0,0.6,0.8", "--keep", "l3", "--keep", "dot(l, alpha)")
    command("section", "lagrange", *start, "--direction", direction, "--crossings", 6, "--out", path)
    assert path.read_text().splitlines()[0] == 'trajectory,time,sign,l3,"dot(l, alpha)"'
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert set(table[:, 2]) == signs
    np.testing.assert_allclose(table[:, 4], 0.8, atol=1e-12)


@pytest.mark.parametrize(("surface", "n"), [("l3 - 100", 96), ("sqrt(alpha1 - 7)", 96)])
def test_a_surface_beyond_the_energy_surface_is_refused(command, surface, n):
    code, out, err = command("section", "kovalevskaya", "--surface", surface, *FEW)
    assert (code, "found" in out) == (2, False)
    assert f"must cross {surface} = 0; none of {n} random states could be moved to a crossing" in err


def test_a_surface_that_is_never_crossed_is_said_with_exit_code_1(command, tmp_path, drawn):
    path = tmp_path / "section.csv"
    start = ("--start", "1,0,0,0,0,1", "--t-end", 20)
    code, out, err = command("section", "kovalevskaya", "--surface", "l3 - 100", *start, "--plot", "--out", path)
    assert code == 1
    assert "found    0 crossings" in out
    assert err == "liepoisson: no orbit crosses l3 - 100 = 0 up to t = 20.\n"
    assert path.exists()
    assert not drawn


@pytest.mark.thorough
def test_what_was_not_seen_is_not_said_to_be_missing(command):
    fast = ("section", "kovalevskaya", "--surface", "sin(10^12*l1)", "--starts", 3)
    code, out, err = command(*fast, "--t-end", 2)
    assert code == 1
    assert re.search(r"^missed   the function could not be followed in \S+% of the time$", out, re.MULTILINE)
    assert re.search(r"was found up to t = 2; the function could not be followed in \S+% of the time", err)
    assert "no orbit crosses" not in err
    code, out, err = command(*fast, "--time-limit", 0.2)
    assert (code, "outcome  time limit 3" in out) == (1, True)
    assert re.search(r"where the first orbit ended \(time limit; \d+ was wanted\)", err)


@pytest.mark.thorough
def test_what_limits_the_run_is_told(command):
    _, out, _ = command("section", "kovalevskaya", "--surface", "sqrt(alpha1) - 1/2", "--starts", 5, "--crossings", 20)
    assert "missed   the function does not exist in" in out
    _, out, _ = command("section", "goryachev", *FEW)  # its field is not of degree two
    assert "error    of the state estimated, not bounded, in " in out
    code, out, _ = command("section", "henon-heiles", "--starts", 6, "--crossings", 9)  # far above the energy of escape
    assert code == 0
    assert "escaped  6 of 6 orbits ran to infinity or to where the equations have no value: their starts" in out


def test_axes_vary_on_the_surface_and_may_be_any_functions(command, tmp_path, drawn):
    """The rate of p_y is -y times a positive function: y vanishes on the surface, and a figure of it is a line."""
    path = tmp_path / "even.toml"
    hamiltonian = "(p_x^2 + p_y^2)/2 + x^2/2 + y^2 + x^2*y^2/2"
    path.write_text(f'[bracket]\ncanonical = ["x", "y"]\n[hamiltonian]\nexpression = "{hamiltonian}"\n')
    for axes, labels in (((), ("$x$", "$p_{x}$")), (("--y", "p_y"), ("$x$", "$p_{y}$"))):
        code, out, _ = command("section", path, "--starts", 3, "--crossings", 20, "--figure", "even.png", *axes)
        assert code == 0
        assert "crossings where -x^2*y - 2*y increases" in out
        assert (drawn[-1].axes[0].get_xlabel(), drawn[-1].axes[0].get_ylabel()) == labels
    _, out, _ = command("section", "kovalevskaya", *FEW, "--plot", "--x", "dot(l, alpha)", "--y", "alpha1")
    assert out.splitlines()[-1] == "wrote    kovalevskaya-section.png"
    command("section", "kovalevskaya", *FEW, "--keep", "l1", "--keep", "l2", "--figure", "kept.svg")
    assert drawn[-1].axes[0].get_xlabel() == r"$\ell_{1}$"


@pytest.mark.thorough
def test_title_is_typeset_and_says_what_was_set(command, drawn):
    where = (*FEW, "--leaf", "C1=0.5", "--leaf", "C2=1", "--energy", 1, "--figure", "a.svg")
    command("section", "kovalevskaya", "--surface", "l3", *where)
    set_ = ("--set", "I=3/2,1.2,0.7", "--set", "a=[-1,0, sqrt(2)]", "--plot")
    _, out, _ = command("section", "kovalevskaya", *FEW, *set_)
    titles = [figure.axes[0].get_title(loc="left").splitlines() for figure in drawn]
    name = "kovalevskaya, I = (3/2, 1.2, 0.7), a = (-1, 0, sqrt(2)):"
    assert titles[0][:2] == [
        "kovalevskaya: section $\\ell_{3}$ = 0, increasing", "$H$ = $1$, $C_{1}$ = $0.5$, $C_{2}$ = $1$",
    ]  # fmt: skip
    assert out.startswith(f"{name} crossings where ")
    assert titles[1][0] == name
    assert out.splitlines()[-1] == "wrote    kovalevskaya-section.png", "files are named after the system alone"


def curves(ax):
    """The points of a figure, one array for each orbit."""
    return [line.get_xydata() for line in ax.lines]


def test_the_first_own_figure_is_unfolded(command, tmp_path, drawn):
    """An asymmetric top: the rate of l3 vanishes on a section that no plane shows unfolded; alpha3 does not."""
    own = ("heavy-top", "--set", "I=2,1.5,1", "--set", "a=0.3,0,1")
    path = tmp_path / "own.nc"
    _, out, _ = command("section", *own, "--crossings", 60, "--plot", "--out", path)
    assert "crossings where alpha3 increases through 0\nsurface  a component: every plane folds" in out
    assert "figure   atan2(alpha2, alpha1) and l3: coordinates on the section" in out.splitlines()
    (ax,) = drawn[0].axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == (r"$\mathrm{atan2}(\alpha_{2}, \alpha_{1})$", r"$\ell_{3}$")
    state, points = lp.load(path).state, np.concatenate(curves(ax))
    turned = np.angle(np.exp(1j * points[:, 0]))
    np.testing.assert_allclose(turned, np.arctan2(state[:, 4], state[:, 3]), rtol=0, atol=1e-14)
    # Nearby in the plane is nearby in the state: each pair in a square of side 0.02, in units of the figure.
    scaled = points / np.ptp(points, axis=0)
    near = np.abs(scaled[:, None] - scaled[None]).max(axis=-1) < 0.02
    far = np.linalg.norm(state[:, None] - state[None], axis=-1)
    assert far[near].max() < 0.25 * far.max()
    assert near.sum() > 1.5 * len(points)
    _, out, _ = command("section", "kovalevskaya", *FEW, "--plot", "--x", "alpha1", "--y", "l1")
    assert "figure   folds the section: different states may lie at one point. Leave out --x and --y" in out


def test_two_sheets_are_drawn_side_by_side_and_named(command, drawn):
    leaf = ("--leaf", "C1=0.5,C2=1", "--energy", 1.5)
    _, out, _ = command("section", "kovalevskaya", "--surface", "l3", *leaf, "--crossings", 60, "--plot")
    line = r"^figure   (.+) and (.+): two sheets side by side, one for each sign of (.+)$"
    assert re.search(line, out, re.MULTILINE)
    left, right = drawn[0].axes
    assert left.get_title(loc="left").splitlines()[-1].endswith("$> 0$")
    assert right.get_title(loc="left").endswith("$< 0$")
    assert sum(np.isfinite(one).all(axis=1).sum() for ax in (left, right) for one in curves(ax)) == 24 * 60
