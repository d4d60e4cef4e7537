"""Figures of sections: which points they show, in which colours, under which labels."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.plot.labels import label
from liepoisson.plot.section import _in_one_turn, titled_section
from liepoisson.plot.section import section as draw
from liepoisson.plot.style import SEQUENCE
from liepoisson.poincare.section_coordinates import default_axes

TOP = lp.Top.kovalevskaya()


@pytest.fixture(autouse=True)
def no_windows():
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


@pytest.fixture(scope="module")
def points():
    return lp.section(TOP, lp.sample_states(TOP, 8, seed=1), surface="l3", t_end=60)


def test_each_trajectory_has_its_points_and_a_colour(points):
    ax = draw(points, "l1", "alpha3")
    assert len(ax.lines) == 8
    for k, line in enumerate(ax.lines):
        np.testing.assert_array_equal(line.get_xdata(), points.of(k)[:, 0])
        np.testing.assert_array_equal(line.get_ydata(), points.of(k)[:, 5])
        assert line.get_color() == SEQUENCE[k % len(SEQUENCE)]
    assert (ax.get_xlabel(), ax.get_ylabel()) == (r"$\ell_{1}$", r"$\alpha_{3}$")


def test_a_dataset_gives_the_same_figure(points):
    for one, other in zip(draw(points, "l1", "l2").lines, draw(points.dataset, "l1", "l2").lines, strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())


def test_kept_functions_are_coordinates():
    kept = lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface="l3", t_end=60, keep=("l1", "dot(l, alpha)"))
    for source in (kept, kept.dataset):
        ax = draw(source, "l1", "dot(l, alpha)", ylabel="c")
        np.testing.assert_array_equal(ax.lines[1].get_ydata(), kept.of(1)[:, 1])
        assert ax.get_ylabel() == "c"


def test_axes_have_defaults(points):
    for source, name, k in ((points, "alpha", 5), (points.dataset, "beta", 8)):  # a Dataset does not know what is idle
        ax = draw(source)
        assert (ax.get_xlabel(), ax.get_ylabel()) == (rf"$\{name}_{{3}}$", r"$\ell_{2}$")
        np.testing.assert_array_equal(ax.lines[3].get_xydata(), points.of(3)[:, [k, 1]])
    assert draw(points, "l1").get_ylabel() == r"$\ell_{2}$"
    with pytest.raises(ParameterError, match="'l2' for both"):
        draw(points, "l2")


def test_axes_of_kept_functions_have_defaults():
    kept, one = (
        lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface="l3", t_end=60, keep=keep)
        for keep in (("l1", "alpha2", "dot(l, alpha)"), ("l1",))
    )
    for source in (kept, kept.dataset):
        ax = draw(source)
        assert (ax.get_xlabel(), ax.get_ylabel()) == (r"$\ell_{1}$", r"$\ell\cdot \alpha$")
    with pytest.raises(ParameterError, match=r"'l1' for both.*y=points\.time"):
        draw(one)
    np.testing.assert_array_equal(draw(one, y=one.time).lines[1].get_xdata(), one.of(1)[:, 0])


def test_a_new_figure_has_system_and_surface_for_its_title(points):
    for source in (points, points.dataset):
        assert draw(source).get_title(loc="left").split("\n")[0] == r"Kovalevskaya top: $\ell_{3}$ = 0"
        assert draw(source, title="mine").get_title(loc="left") == "mine"
        assert draw(source, title="").get_title(loc="left") == ""
    ax = draw(points)
    ax.set_title("mine", loc="left")
    assert draw(points, ax=ax).get_title(loc="left") == "mine"


def test_a_long_surface_is_cut_short_on_a_line_of_its_own():
    surface = " + ".join(f"0.{k}*alpha{k}*l{k}" for k in (1, 2, 3, 1, 2, 3, 1))
    long = lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface=surface, t_end=20)
    for source in (long, long.dataset):
        name, formula = draw(source).get_title(loc="left").split("\n")[:2]
        assert name == "Kovalevskaya top"
        assert formula.startswith("0.1*alpha1*l1 + ")
        assert formula.endswith(" … = 0")
        assert len(formula) <= 60


@pytest.mark.parametrize(
    ("name", "text"),
    [("l3", r"$\ell_{3}$"), ("C1", "$C_{1}$"), ("H", "$H$"), ("p_theta2", r"$p_{\theta_{2}}$"), ("l.alpha", "l.alpha")],
)
def test_names_become_mathematical_text(name, text):
    assert label(name) == text


def test_signs_trajectories_and_values_choose_the_points(points):
    ax = draw(points, np.where(points.state[:, 5] > 0, points.time, np.nan), "l2", sign=1, trajectories=[2, 5])
    wanted = (points.state[:, 5] > 0) & (points.sign == 1) & np.isin(points.trajectory, [2, 5])
    shown = np.concatenate([line.get_xdata() for line in ax.lines])
    np.testing.assert_array_equal(shown, points.time[wanted])
    assert [line.get_color() for line in draw(points, "l1", "l2", colour="black").lines] == ["black"] * 8


def test_axes_by_default_are_not_constant_on_the_section():
    """On y = 0 the last coordinate y and its momentum would show a line: x and p_x are taken."""
    system = lp.catalog.system("henon-heiles")
    start = {"x": 0.1, "p_y": 0.3}
    for surface, expected in (("y", ("$x$", "$p_{x}$")), ("x", ("$y$", "$p_{y}$"))):
        run = lp.section(system, {"x": 0.1, "y": 0.1, "p_y": 0.3}, surface=surface, t_end=100)
        for source in (run, run.dataset):
            ax = draw(source)
            assert (ax.get_xlabel(), ax.get_ylabel()) == expected
    one = lp.section(system, start, surface="x - 0.1", t_end=1e-3)
    assert draw(one).get_xlabel() == "$y$", "of one crossing nothing varies"
    states = np.random.default_rng(0).standard_normal((9, 6))
    for names, axes in (
        (("q1", "q2", "q3", "p1", "p2", "p3"), ("q3", "p3")),
        (("l1", "l2", "l3", "alpha1", "alpha2", "alpha3"), ("alpha3", "l2")),
    ):
        assert default_axes(names, states) == axes
    states[:, 1] = 1e-17
    assert default_axes(("l1", "l2", "l3", "alpha1", "alpha2", "alpha3"), states) == ("alpha2", "l1")


def test_axes_by_default_are_independent_of_each_other_and_of_units():
    """Surfaces that tie y and p_y together, and a coordinate of 1e-11 beside a momentum of one."""
    system = lp.catalog.system("henon-heiles")
    starts = [[0.1, 0.1, 0.2, 0.1], [0.0, 0.2, 0.1, 0.2], [0.2, -0.1, 0.1, 0.15]]
    for surface in ("y + p_y", "y - 3*p_y - 1/20"):
        run = lp.section(system, starts, surface=surface, t_end=200)
        assert run.default_axes == ("x", "p_x")
        assert draw(run.dataset).get_xlabel() == "$x$"
    stiff = lp.System(lp.canonical(2), "(p1^2 + p2^2)/200000000000 + (q1^2 + 2*q2^2)*50000000000")
    run = lp.section(stiff, [[1e-11, 2e-11, 0.5, 0.7]], surface="q2", t_end=100)
    assert run.default_axes == ("q1", "p1")


def test_both_directions_are_drawn_side_by_side():
    system = lp.catalog.system("henon-heiles")
    run = lp.section(system, {"x": 0.1, "y": 0.1, "p_y": 0.3}, surface="x", t_end=300)
    left, right = draw(run).figure.axes
    assert (left.get_title(loc="left"), right.get_title(loc="left")) == (
        "henon-heiles: $x$ = 0\n$H$ = $0.05567$\nincreasing",
        "decreasing",
    )
    assert [len(ax.lines[0].get_xdata()) for ax in (left, right)] == [(run.sign > 0).sum(), (run.sign < 0).sum()]
    assert left.get_xlim() == right.get_xlim()
    mine = draw(run, ax=left)
    assert mine is left, "given axes get all crossings"
    assert len(mine.lines[-1].get_xdata()) == len(run.time)


def test_formulas_and_angles_are_axes(points):
    ax = draw(points, "atan2(l2, l1)", "dot(l, l)")
    assert ax.get_xlabel() == r"$\mathrm{atan2}(\ell_{2}, \ell_{1})$"
    l = points.state[:, :3]
    drawn = np.concatenate([line.get_xydata() for line in ax.lines])
    drawn[:, 0] = np.angle(np.exp(1j * drawn[:, 0]))
    np.testing.assert_allclose(drawn, np.stack([np.arctan2(l[:, 1], l[:, 0]), (l**2).sum(axis=1)], axis=1), rtol=1e-13)


def test_orbits_of_several_levels_are_told_and_those_of_one_have_its_values():
    system = lp.catalog.system("kovalevskaya")
    mixed = lp.section(system, lp.sample_states(system, 6, seed=2), surface="alpha3", direction=1, t_end=60)
    n = len(np.unique(mixed.trajectory))
    assert f"the orbits lie on {n} levels of H, C1, C2: curves of different levels cross" in str(mixed).splitlines()
    title = draw(mixed).get_title(loc="left").split("\n")
    assert title == [
        r"kovalevskaya: $\alpha_{3}$ = 0, increasing",
        f"{n} levels of $H$, $C_{{1}}$, $C_{{2}}$: their curves cross",
    ]
    assert "levels" not in draw(mixed, trajectories=[mixed.trajectory[0]]).get_title(loc="left")
    leaf = lp.Leaf(system, {"C1": 0, "C2": 1})  # a Casimir of round-off is one value
    starts = lp.sections.section_starts(leaf, "alpha3", energy=1, n_starts=9, direction=1)
    same = lp.section(system, np.round(starts, 11), surface="alpha3", direction=1, t_end=60)
    assert "levels" not in str(same)
    assert draw(same).get_title(loc="left").split("\n")[1].startswith("$H$ = $1$, $C_{1}$ = $")


def test_an_angle_is_cut_where_the_points_leave_the_largest_gap():
    system = lp.System(lp.canonical(2), "(p1^2 + q1^2)/2 + (p2^2 + q2^2)/3")
    run = lp.section(system, [-1, 0.2, 0.1, 0.3], surface="q2", direction=1, t_end=60)
    wound = np.sort(np.angle(run.state[:, 0] + 1j * run.state[:, 2]))
    ax = draw(run, "atan2(p1, q1)", "p1")
    drawn = np.sort(ax.lines[0].get_xdata())
    assert np.ptp(drawn) == pytest.approx(2 * np.pi - np.diff(wound, append=wound[0] + 2 * np.pi).max(), abs=1e-9)
    np.testing.assert_allclose(np.sort(np.angle(np.exp(1j * drawn))), wound, atol=1e-12)
    ax.figure.canvas.draw()
    ticks = {text.get_text(): x for text, x in zip(ax.get_xticklabels(), ax.get_xticks(), strict=True)}
    assert ticks["$0$"] == 0
    assert ticks[r"$\pi/2$"] == pytest.approx(np.pi / 2)
    mine = draw(run, "atan2(p1, q1)", "p1", ax=ax)
    assert np.abs(mine.lines[-1].get_xdata()).max() <= np.pi, "given axes keep their window"


def test_a_cloud_around_pi_is_not_cut():
    angles = np.concatenate([np.linspace(2.5, np.pi, 20), np.linspace(-np.pi, -2.6, 20)])
    turned = _in_one_turn(angles, np.ones(len(angles), bool))
    assert np.ptp(turned) == pytest.approx(2 * np.pi - 2.6 - 2.5)
    alone = _in_one_turn(np.array([1.0, np.nan]), np.array([True, False]))
    assert alone[0] == pytest.approx(1.0)


def test_a_bump_on_a_line_is_no_angle():
    """A shift by a whole turn leads out of the reach of its force, and one by 1 into it."""
    system = lp.System(lp.canonical(2), "(p1^2 + p2^2)/2 + q2^2/2 + 5*exp(-40*(q1 - 3)^2)")
    starts = [[2.0, 0.1, 0.001, 1.0], [4.0, 0.1, -0.001, 1.0]]
    run = lp.section(system, starts, surface="q2", t_end=100)
    ax = titled_section(run, lp.Leaf(system, {}), "q2", ("q1", "p1")).axes[0]
    assert ax.get_xlabel() == "$q_{1}$"


def test_an_angle_is_drawn_within_a_turn_and_other_coordinates_are_not():
    def shown(expression, axes, start):
        system = lp.System(lp.canonical(names=["theta", "x"]), expression)
        run = lp.section(system, start, surface="sin(x)", t_end=200, direction=1)
        leaf = lp.Leaf.through(system, start)
        ax = titled_section(run, leaf, run.surface, axes).axes[0]
        return ax, np.concatenate([line.get_xdata() for line in ax.lines]), run

    energy = "p_theta^2/2 + p_x^2/2 - cos(theta)*(1 + sin(x)/5)"
    ax, drawn, run = shown(energy, ("theta", "p_theta"), [0.1, 0.0, 3.0, 1.0])
    assert np.abs(run.state[:, 0]).max() > 100
    assert np.ptp(drawn) <= 2 * np.pi
    np.testing.assert_allclose(
        np.sin(np.sort(np.angle(np.exp(1j * drawn)))),
        np.sin(np.sort(np.angle(np.exp(1j * run.state[:, 0])))),
        atol=1e-9,
    )
    assert ax.get_xlabel() == r"$\theta$ (mod $2\pi$)"
    ax, drawn, run = shown("p_theta^2/2 + p_x^2/2 - cos(x)/5", ("theta", "p_theta"), [0.1, 0.0, 3.0, 1.0])
    assert ax.get_xlabel() == r"$\theta$", "a cyclic coordinate need not be an angle"
    np.testing.assert_array_equal(drawn, run.state[:, 0])


def test_a_long_surface_stands_on_a_line_of_its_own():
    system = lp.catalog.system("double-pendulum")
    surface = lp.sections.default_surface(lp.Leaf(system, {}))
    run = lp.section(system, [0.4, 0.2, 0.1, 0.3], surface=surface, t_end=30, direction=1)
    title = titled_section(run, lp.Leaf.through(system, [0.4, 0.2, 0.1, 0.3]), surface, ("p_theta2", "theta2"))
    lines = title.axes[0].get_title(loc="left").split("\n")
    assert lines[0] == "double-pendulum:"
    assert max(map(len, lines)) <= 84, "what fits above six inches"


def test_coordinates_that_are_not_there_are_refused(points):
    with pytest.raises(ParameterError, match=r"y must be a coordinate that was kept \(l1, .*got 'gamma1'"):
        draw(points.dataset, "l1", "gamma1")
    with pytest.raises(lp.errors.ExpressionError, match="the name 'gamma1' is unknown"):
        draw(points, "l1", "gamma1")
    with pytest.raises(ParameterError, match=r"For a formula keep it: section\(\.\.\., keep="):
        draw(points.dataset, "atan2(l1, l2)", "l1")
    with pytest.raises(lp.errors.ExpressionError, match="atan2 takes two scalars"):
        draw(points, "atan2(l1)", "l1")
    with pytest.raises(ShapeError, match=r"x must have shape \(crossing,\)"):
        draw(points, points.state, "l1")


def test_a_section_without_points_is_an_empty_figure():
    none = lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface="l3 - 100", t_end=1)
    assert not draw(none, "l1", "l2").lines


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"trajectories": [8]}, "from 0 to 7"),
        ({"trajectories": "a"}, "from 0 to 7"),
        ({"trajectories": [1.5]}, "from 0 to 7"),
        ({"sign": 7}, "sign must be"),
        ({"sign": "up"}, "sign must be"),
        ({"size": -1}, "size must be"),
        ({"size": "big"}, "size must be"),
        ({"colour": "nocolour"}, "colour must be"),
        ({"colour": ()}, "colour must be"),
        ({"colour": 5}, "colour must be"),
    ],
)
def test_options_that_make_no_sense_are_refused(points, options, message):
    for source in (points, points.dataset):
        with pytest.raises(ParameterError, match=message):
            draw(source, "l1", "l2", **options)


@pytest.mark.parametrize("keep", [["l1", "l2 + alpha1", "dot(l, alpha)"], ["l1"]])
def test_axes_of_kept_functions_are_the_first_and_the_last(keep):
    top = lp.Top.kovalevskaya()
    run = lp.section(top, lp.sample_states(top, 2, seed=1), surface="l3", t_end=20, keep=[*keep, top.hamiltonian])
    assert run.default_axes == (run.coordinates[0], run.coordinates[-1])
    energy = top.functions.energy(run.start)[run.crossing_trajectory]
    np.testing.assert_allclose(run.state[:, -1], energy, rtol=1e-12)
