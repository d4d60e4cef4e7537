"""Surfaces that suit a leaf, and axes that fold a section."""

import pytest

import liepoisson as lp


@pytest.mark.parametrize(
    ("name", "start", "function"),
    [
        ("twisted-kovalevskaya", {}, "-alpha2*beta3 + alpha3*beta2"),
        ("kovalevskaya", {}, "alpha2"),  # l3' = alpha2 for a = (-1, 0, 0)
        ("lagrange", {}, "alpha1*l2 - alpha2*l1"),  # l3' = 0
        ("henon-heiles", {"y": 0.1, "p_x": 0.3}, None),
        ("twisted-kovalevskaya", {"l": (1, 1, 1), "alpha": (0, 0, 1)}, "alpha2"),  # beta = 0
    ],
)
def test_default_surface_is_the_rate_of_what_moves(name, start, function):
    system = lp.catalog.system(name)
    begin = lp.phase_space.find_start(system, start=start or None)
    surface = lp.sections.default_surface(begin.leaf)
    assert function is None or surface == function
    assert len(lp.section(system, begin.state, surface=surface, t_end=100).time) > 3


def test_a_leaf_at_rest_has_no_surface():
    system = lp.System(lp.Bracket(lp.so(3), lp.extensions.trivial()), "dot(l, l)")
    with pytest.raises(lp.errors.ParameterError, match="every state is an equilibrium"):
        lp.sections.default_surface(lp.Leaf(system, {"C1": 1}))


def test_axes_that_fold_the_section_are_told_from_coordinates():
    # On alpha2 = 0 and |alpha| = 1, alpha = (cos phi, 0, sin phi), and l2 is the momentum of the angle phi.  So phi and
    # l2 are coordinates, and sin phi = alpha3 and l2 where cos phi = alpha1 keeps its sign.
    system = lp.catalog.system("kovalevskaya")
    leaf = lp.Leaf(system, {"C1": 0.3, "C2": 1})
    states = lp.sections.section_starts(leaf, "alpha2", energy=1.5, n_starts=200, seed=1, direction=1)
    right = states[:, 3] > 0
    assert 20 < right.sum() < 180
    for axes, some, expected in (
        (("alpha3", "l2"), states, True),
        (("alpha3", "l2"), states[right], False),
        (("alpha3", "l2"), states[~right], False),
        (("alpha3 + alpha1/2", "l2 - alpha3"), states, True),
        (("sin(alpha3)", "l2"), states[right], False),
    ):
        assert lp.sections.is_folded(system, some, "alpha2", *axes) == expected, axes


OSCILLATOR = lp.catalog.system("henon-heiles")
STARTS = [{"y": 0.1, "p_x": 0.3, "p_y": 0.1}, {"y": 0.2, "p_x": 0.3, "p_y": 0.1}]


def test_a_section_says_whether_its_figure_folds_it():
    both = lp.section(OSCILLATOR, STARTS, surface="x", t_end=100, n_crossings=10)
    up = lp.section(OSCILLATOR, STARTS, surface="x", t_end=100, n_crossings=10, direction=1)
    assert both.is_folded()  # p_x is the positive or the negative root at each y and p_y
    assert not up.is_folded()
    assert (up.state[:, 3] > 0).any()
    assert (up.state[:, 3] < 0).any()
    assert up.is_folded("y", "p_y^2")
    assert str(both).splitlines() == [
        "henon-heiles: 20 crossings of x = 0, 10 of each of 2 orbits",
        "a figure of y and p_y, the axes by default, folds the section: different states may lie at one point",
    ]
    assert str(up) == "henon-heiles: 20 crossings of x = 0, 10 of each of 2 orbits"


def test_a_section_says_which_orbits_the_end_of_time_cut_short():
    run = lp.section(OSCILLATOR, STARTS, surface="x", t_end=20, n_crossings=100, direction=1)
    assert run.n_short == 2
    assert "2 ended by t = 20 before 100" in repr(run)
    assert "2 of 2 orbits ended at t = 20, before their 100 crossings: give a later t_end" in str(run)
    whole = lp.section(OSCILLATOR, STARTS, surface="x", t_end=20, direction=1)
    assert whole.n_short == 0
    assert "before" not in repr(whole) + str(whole)


@pytest.mark.parametrize(
    ("system", "options", "message"),
    [
        (OSCILLATOR, {"keep": ["y", "p_y"]}, "of which it is not known"),
        (lp.Top.twisted_kovalevskaya(), {}, "got one of dimension 4"),
    ],
)
def test_only_sections_of_dimension_two_with_states_can_be_folded(system, options, message):
    surface = system.component_names[0]
    run = lp.section(system, lp.sample_states(system, 2, seed=1) / 4, surface=surface, t_end=20, **options)
    assert len(run.time)
    with pytest.raises(lp.errors.ParameterError, match=message):
        run.is_folded()
    assert ("a plane shows a projection" in str(run)) == (not options)
