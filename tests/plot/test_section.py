"""Figures of sections: which points they show, in which colours, under which labels."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.plot.labels import label as plain_name
from liepoisson.plot.section import _best_turn, titled_section
from liepoisson.plot.section import section as draw
from liepoisson.plot.style import SEQUENCE
from liepoisson.poincare.section_coordinates import default_axes

TOP = lp.Top.kovalevskaya()


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


def test_kept_functions_are_coordinates():
    states = np.random.default_rng(0).standard_normal((9, 3))
    assert default_axes(("x", "y", "z"), states) == default_axes(("x", "y", "z"), states[:0]) == ("x", "y")
    assert default_axes(("x", "y", "z"), states * [0, 1, 1]) == ("y", "z")
    assert default_axes(("x1", "x2", "x3"), states[:0], surface="x1 - 1") == ("x2", "x3")
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
    assert draw(points, title="mine").get_title(loc="left") == "mine"
    assert draw(points.dataset).get_title(loc="left").split("\n")[0] == r"Kovalevskaya top: $\ell_{3}$ = 0"


def test_signs_trajectories_and_values_choose_the_points(points):
    ax = draw(points, np.where(points.state[:, 5] > 0, points.time, np.nan), "l2", sign=1, trajectories=[2, 5])
    wanted = (points.state[:, 5] > 0) & (points.sign == 1) & np.isin(points.trajectory, [2, 5])
    shown = np.concatenate([line.get_xdata() for line in ax.lines])
    np.testing.assert_array_equal(shown, points.time[wanted])
    assert [line.get_color() for line in draw(points, "l1", "l2", colour="black").lines] == ["black"] * 8


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
    states = np.random.default_rng(0).standard_normal((9, 6))
    assert default_axes(("q1", "q2", "q3", "p1", "p2", "p3"), states) == ("q3", "p3")
    names = ("l1", "l2", "l3", "alpha1", "alpha2", "alpha3")
    assert default_axes(names, states) == ("alpha3", "l2")
    states[:, 1] = 1e-17
    assert default_axes(names, states) == ("alpha2", "l1")
    kept = lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface="l3", t_end=60, keep=("l1", "alpha2", "l2^2"))
    assert kept.default_axes == ("l1", "l2^2")


def test_a_long_surface_is_cut_short_on_a_line_of_its_own():
    surface = " + ".join(f"0.{k}*alpha{k}*l{k}" for k in (1, 2, 3, 1, 2, 3, 1))
    long = lp.section(TOP, lp.sample_states(TOP, 2, seed=1), surface=surface, t_end=20)
    name, formula = draw(long).get_title(loc="left").split("\n")[:2]
    assert (name, formula[:15], formula[-6:]) == ("Kovalevskaya top", "0.1*alpha1*l1 +", " … = 0")
    assert len(formula) <= 60


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
    with pytest.raises(ParameterError, match="one of the two sheets"):
        draw(run, ax=left)
    mine = draw(run, ax=plt.figure().add_subplot())
    assert len(mine.lines[-1].get_xdata()) == len(run.time), "given axes get all crossings"


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


def test_all_that_is_drawn_into_one_pair_of_axes_has_the_same_turn():
    """An orbit about an island at the seam, then one that goes round: each alone has another turn."""
    system = lp.System(lp.canonical(2), "(p1^2 + q1^2)/2 + 309/1000*(p2^2 + q2^2)")
    run = lp.section(system, [[-1, 0.2, 0.1, 0.3], [0.3, 0.1, -0.2, 0.3]], surface="q2", direction=1, t_end=600)
    angle = np.arctan2(run.state[:, 2], run.state[:, 0])
    island = np.where((np.abs(angle) > 2.5) | (run.trajectory == 1), run.state[:, 2], np.nan)
    ax = draw(run, "atan2(p1, q1)", island, trajectories=[0])
    draw(run, "atan2(p1, q1)", "p1", trajectories=[1], ax=ax)
    part, whole = (line.get_xdata() for line in ax.lines)
    assert np.ptp(part) < np.pi, "the island is whole"
    assert np.ptp(np.concatenate([part, whole])) <= 2 * np.pi
    alone = draw(run, "atan2(p1, q1)", "p1", trajectories=[1]).lines[0].get_xdata()
    assert np.abs(alone).max() <= np.pi < np.abs(whole).max(), "alone it leaves no gap that chance would not leave"
    given = draw(run, "atan2(p1, q1)", "p1", trajectories=[1], window=0)
    assert given.lines[0].get_xdata().min() >= 0
    with pytest.raises(ParameterError, match=r"window must be 0\.0, where the turn of these axes begins; got 1\.0"):
        draw(run, "atan2(p1, q1)", "p1", window=1, ax=given)
    with pytest.raises(ParameterError, match="the turn of an angle that is drawn"):
        draw(run, "q1", "p1", window=0)


def test_no_island_is_cut_at_a_gap_that_is_no_wider_than_those_beside_it():
    """The largest gap of dense angles with thin ones among them is where these are thin."""
    rng = np.random.default_rng(0)
    angles = np.concatenate([rng.uniform(0, 4, 10_000), rng.uniform(4, 2 * np.pi, 1000)])
    assert _best_turn(angles) == -np.pi
    assert _best_turn(angles[(angles < 4.9) | (angles > 5)]) == pytest.approx(4.95 - 2 * np.pi, abs=0.01)
    chain = np.concatenate([k * 2 * np.pi / 5 + rng.uniform(-0.5, 0.5, 100) for k in range(5)])
    begin = _best_turn(chain)
    assert np.abs((begin - np.pi / 5) / (2 * np.pi / 5) % 1 - 0.5) > 0.4, "between two islands"
    assert [_best_turn(np.array(few)) for few in ([], [1.0])] == [-np.pi] * 2


def test_axes_with_a_section_keep_their_coordinates_and_no_false_title(points):
    other = lp.section(lp.Top.lagrange(), lp.sample_states(lp.Top.lagrange(), 2, seed=1), surface="l1", t_end=60)
    ax = draw(points, "alpha1", "l1", trajectories=[0])
    system, level = ax.get_title(loc="left").split("\n")
    draw(points, trajectories=[0], ax=ax)
    np.testing.assert_array_equal(ax.lines[1].get_xydata(), points.of(0)[:, [3, 0]])
    assert ax.get_title(loc="left").split("\n") == [system, level]
    draw(points, trajectories=[1], ax=ax)
    assert ax.get_title(loc="left") == system, "on another level"
    for wrong in ({"x": "l2"}, {"y": "alpha3"}, {"x": "l1", "y": "alpha1"}):
        with pytest.raises(ParameterError, match="which these axes show; got"):
            draw(points, **wrong, ax=ax)
    assert (ax.get_xlabel(), ax.get_ylabel()) == (r"$\alpha_{1}$", r"$\ell_{1}$")
    draw(other, ax=ax)
    assert ax.get_title(loc="left") == ""
    np.testing.assert_array_equal(ax.lines[-1].get_xydata(), other.of(1)[:, [3, 0]])
    draw(points, "l2", xlabel="first or second", ax=ax)
    draw(points, points.state[:, 0], ax=ax)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("first or second", r"$\ell_{1}$")
    mine = draw(points, title="mine")
    draw(other, "alpha3", ax=mine)
    assert mine.get_title(loc="left") == "mine"
    with pytest.raises(ParameterError, match="x must be given: these axes show values"):
        draw(points, ax=draw(points, points.time, "l1"))


@pytest.mark.parametrize("n", [0, 1])
def test_the_default_axes_of_hardly_any_crossing_vary_on_the_surface(n):
    for system, surface in ((TOP, "alpha3"), (TOP, "l2 - 1/10"), (lp.catalog.system("henon-heiles"), "y")):
        start = lp.sample_states(system, 1, seed=3)[0] / 5
        run = lp.section(system, start, surface=surface, t_end=100, n_crossings=1)
        if not n:
            run = lp.section(system, start, surface=surface, t_end=run.time[0] / 2)
        assert len(run.time) == n
        assert surface.split()[0] not in run.default_axes
        drawn = draw(run.dataset)
        assert plain_name(surface.split()[0]) not in {drawn.get_xlabel(), drawn.get_ylabel()}


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


@pytest.mark.parametrize(
    ("axis", "length", "words"),
    [
        ("2*b", 4 * np.pi, r"$2\,b$ (mod $4\pi$)"),
        ("a - 2*b", 2 * np.pi, r"$a - 2\,b$ (mod $2\pi$)"),
        ("b^2", None, "$b^{2}$"),
    ],
)
def test_a_combination_of_declared_angles_is_cut_by_what_turns_change_it_by(axis, length, words):
    angles = lp.canonical(names=["a", "b"], angles=["a", "b"])
    system = lp.System(angles, "p_a^2/2 + p_b^2/2 - cos(a)/5*(1 + sin(b)/3) - cos(b)/9")
    run = lp.section(system, {"p_a": 1.9, "p_b": 1.3}, surface="a", t_end=100)
    ax = draw(run, axis, "p_b")
    drawn, values = np.concatenate([line.get_xdata() for line in ax.lines]), system.functions.of(axis)(run.state)
    assert ax.get_xlabel() == words
    if length is None:
        np.testing.assert_array_equal(drawn, values)
        return
    assert np.ptp(values) > length > np.ptp(drawn) > length / 2
    np.testing.assert_allclose(np.exp(2j * np.pi * drawn / length), np.exp(2j * np.pi * values / length), atol=1e-9)
    later = draw(run, axis, "p_b", sign=1, ax=ax).lines[1:]  # in the same turn
    assert np.isin(np.concatenate([line.get_xdata() for line in later]), drawn).all()


def test_a_formula_beyond_a_half_turn_is_a_coordinate(points):
    expected = 9 * np.sum(points.state[:, :3] ** 2, axis=1)
    assert expected.max() > np.pi
    ax = draw(points, "l1", "9*dot(l, l)")
    drawn = np.concatenate([line.get_ydata() for line in ax.lines])
    np.testing.assert_allclose(np.sort(drawn), np.sort(expected))
    assert "mod" not in ax.get_ylabel()


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


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"trajectories": [8]}, "from 0 to 7"),
        ({"trajectories": []}, "trajectories must be at least one"),
        ({"trajectories": [1.5]}, "from 0 to 7"),
        ({"sign": 7}, "sign: wanted"),
        ({"size": -1}, "size: wanted"),
        ({"colour": "nocolour"}, "colour must be"),
        ({"colour": ()}, "colour must be"),
    ],
)
def test_options_that_make_no_sense_are_refused(points, options, message):
    for source in (points, points.dataset):
        with pytest.raises(ParameterError, match=message):
            draw(source, "l1", "l2", **options)
