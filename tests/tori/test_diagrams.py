"""Slices of diagrams of three integrals, against closed forms."""

from functools import cache

import matplotlib.pyplot as plt
import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import OrbitError, ParameterError, ShapeError
from liepoisson.tori.diagrams import apart

TOP = lp.Top.twisted_lagrange()
ROUND_OFF = 1e-10  # 3e-14 was measured
FIRST, SECOND = "(p_x^2 + x^2)/2", "(p_y^2 + 2*y^2)/2"
OSCILLATORS = lp.System(lp.canonical(names=["x", "y", "z"]), f"{FIRST} + {SECOND} + (p_z^2 + 3*z^2)/2", name="three")
WELL = lp.System(lp.canonical(names=["x", "y", "z"]), f"{FIRST} + {SECOND} + p_z^2/2 - z^2/2 + z^4/4", name="a well")


@cache
def slice_of_well(first):
    """The oscillator x has this energy."""
    return slice_of(WELL, {FIRST: first}, energy_max=1)


def slice_of(system, at, **options):
    momentum = lp.tori.momentum_map(system, [FIRST, SECOND])
    return lp.tori.diagram(lp.Leaf(system, {}), at=at, momentum=momentum, n_starts=20, **options)


def crossings(exact, l3):
    """H and P of the curves of rank 1 at a value of l3, where C3 = 1; C of the equation of the curve is eliminated."""
    c1, c2 = exact.scaled.normal
    e, g = (c1 - c2**2) / 2, np.polynomial.Polynomial([0, 1])
    upper, lower = l3 * g**2 - c2 * g, g**3 - 1  # C = upper/lower
    equation = (g**3 - e * g**2 + 0.5) * lower**2 + c2 * g * upper * lower - 1.5 * upper**2
    places = np.array([root.real for root in equation.roots() if abs(root.imag) < 1e-9])
    cosine = upper(places) / lower(places)
    g, c = places[np.abs(cosine) <= 1], cosine[np.abs(cosine) <= 1]
    q0, q1 = 1 / g, (c2 - c / g) / g
    h = (q1**2 + 2 * q0 + 4 * q1 * g * c + g**2) / 2
    p = q0 * q1 + (q1**2 + 2 * q0) * g * c + q1 * g**2
    values = exact.scaled.integrals(np.stack([np.full_like(g, l3), h, p], -1))
    return values[:, [0, 2]], (c2 - c / g) ** 2 < 4 * g  # whether q has complex roots


@pytest.mark.parametrize(
    ("casimirs", "l3", "energy_max"),
    [
        ((8, 1), 0.3, 0),
        *(
            pytest.param(casimirs, l3, 12, marks=pytest.mark.slow)
            for casimirs in ((8, 1), (-5, 0.5), (0, 2), (0, 0.2))
            for l3 in (-1.0, 0.3, 1.9)
        ),
    ],
)
def test_slices_of_the_twisted_lagrange_top_are_those_in_closed_form(casimirs, l3, energy_max):
    leaf = lp.Leaf(TOP, dict(zip(("C1", "C2", "C3"), (*casimirs, 1), strict=True)))
    exact = lp.tori.lagrange_diagram(leaf)
    found = lp.tori.diagram(leaf, at={"l3": l3}, energy_max=energy_max, n_starts=60 if energy_max else 10)
    assert found.families
    for family in found.families:
        assert family.type == "elliptic"
        values = np.insert(family.values, 1, l3, axis=1)
        assert np.abs(exact.depth(values)).max() < ROUND_OFF, "each value is on the boundary of the image"
        assert np.abs(family.states[:, 2] - l3).max() < ROUND_OFF
    wanted, is_thread = crossings(exact, l3)
    is_low = wanted[:, 0] <= energy_max
    wanted, is_thread = wanted[is_low], is_thread[is_low]
    assert len(found.rest_values) == len(wanted)
    for value, kind in zip(found.rest_values, found.rest_types, strict=True):
        distance = np.abs(wanted - value).max(axis=1)
        assert distance.min() < 1e-8, "where an edge or a thread crosses"
        assert kind == ("focus-focus" if is_thread[distance.argmin()] else "elliptic, elliptic")


@pytest.mark.parametrize("held", [FIRST, "H"])
def test_slices_of_oscillators_are_polygons(held):
    found = slice_of(OSCILLATORS, {held: 0.5}, **({} if held == "H" else {"energy_max": 2}))
    for family in found.families:
        one, other = family.values.T
        lines = [other, one - other - 0.5] if held == FIRST else [one, other, one + other - 0.5]
        assert min(np.abs(line).max() for line in lines) < ROUND_OFF
    corners = {(0.5, 0.0)} if held == FIRST else {(0.0, 0.0), (0.5, 0.0), (0.0, 0.5)}
    assert {tuple(value) for value in found.rest_values.round(9) + 0.0} == corners
    assert set(found.rest_types) == {"elliptic, elliptic"}
    assert len(found.families) == (2 if held == FIRST else 3)


def test_a_saddle_beside_oscillators_is_hyperbolic_in_a_slice():
    found = slice_of_well(0.5)
    offsets = {
        "elliptic": [0.25],
        "hyperbolic": [0.5],
    }  # of H - y's energy at the bottom and top of the well; or y rests
    for family in found.families:
        h, second = family.values.T
        lines = [second, *(h - second - one for one in offsets[family.type])]
        assert min(np.abs(line).max() for line in lines) < ROUND_OFF
    assert {family.type for family in found.families} == {"elliptic", "hyperbolic"}
    places = dict(zip(found.rest_types, found.rest_values.round(9).tolist(), strict=True))
    assert places == {"elliptic, elliptic": [0.25, 0.0], "elliptic, hyperbolic": [0.5, 0.0]}


def test_regions_of_a_slice_have_as_many_tori_as_the_well():
    found = slice_of_well(0.5)
    regions = lp.tori.regions(found, n_values=60, n_states=12)
    for region in regions:
        h, first, second = region.fibre.value
        assert first == pytest.approx(0.5)
        assert region.fibre.n_tori == (2 if h - first - second < 0 else 1)
    assert {region.fibre.n_tori for region in regions} == {1, 2}
    assert list(regions.to_dataframe().columns)[:3] == ["H", FIRST, SECOND]


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ({"l3": 1}, 'wanted "H"'),
        ({}, r"two integrals that are left.* 3 are\. Hold one of three"),
        (None, r"two integrals that are left.* 3 are\. Hold one of three"),
        ({"H": 1, FIRST: 0.2}, "two integrals that are left.* 1 are"),
        ({FIRST: -1}, "inside of its range.*no random state was moved to it"),
        ({FIRST: 0}, "inside of its range.*its flow rests"),
        ({FIRST: float("nan")}, "a finite number"),
        ({FIRST: "x"}, "number"),
        ([0.5], "mapping"),
    ],
)
def test_wrong_slices_are_refused(at, words):
    with pytest.raises(ParameterError, match=words):
        slice_of(OSCILLATORS, at, energy_max=2)


def test_a_slice_of_an_energy_has_no_other_bound():
    with pytest.raises(ParameterError, match="energy_max"):
        slice_of(OSCILLATORS, {"H": 1}, energy_max=2)


def test_two_integrals_have_no_slices():
    leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
    with pytest.raises(ParameterError, match=r"1 are\. Leave it out"):
        lp.tori.diagram(leaf, at={"l3": 0.1})


def test_slices_are_drawn_in_the_plane_and_in_space():
    slices = [slice_of_well(one) for one in (0.2, 0.5)]
    plane = lp.plot.diagram(slices[0])
    words = ["elliptic", "hyperbolic", "relative equilibrium: elliptic, elliptic"]
    words.append("relative equilibrium: elliptic, hyperbolic")
    assert sorted(text.get_text() for text in plane.get_legend().get_texts()) == words
    assert plane.get_ylim()[1] == 1
    space = lp.plot.diagram(slices)
    assert sorted(text.get_text() for text in space.get_legend().get_texts()) == words
    x, _, h = space.lines[0].get_data_3d()
    assert np.allclose(x, 0.2)
    assert np.array_equal(h, slices[0].families[0].values[:, 0])
    plt.close("all")
    whole = lp.tori.diagram(lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1}), n_starts=20)
    for wrong in ([slices[0], whole], [whole], [slices[0], 3], [], lp.tori.regions):
        with pytest.raises(ParameterError, match="found"):
            lp.plot.diagram(wrong)
    with pytest.raises(ParameterError, match="regions, l3"):
        lp.plot.diagram(slices, l3=1)


def test_a_slice_through_a_sleeping_top_has_it_once():
    """On the leaf C1 = 8, C2 = 1 one sleeps at l3 = 7/2, H = 53/4, P = 9/2: all flows rest."""
    leaf = lp.Leaf(TOP, {"C1": 8, "C2": 1, "C3": 1})
    found = lp.tori.diagram(leaf, at={"l3": 3.5}, energy_max=14, n_starts=10)
    near = np.abs(found.rest_values - [13.25, 4.5]).max(axis=1) < 1e-6
    assert [kind for kind, here in zip(found.rest_types, near, strict=True) if here] == ["elliptic, focus-focus"]


PENDULUM = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})


@cache
def wells(energy_max, n_starts=30, seed=0):
    """Two double wells, with K the energy of the first one, which rests at -1/4 and 0, as the second one does."""
    first = "p1^2/2 - q1^2/2 + q1^4/4"
    system = lp.System(lp.canonical(2), f"{first} + p2^2/2 - q2^2/2 + q2^4/4")
    momentum = lp.tori.momentum_map(system, [first])
    return lp.tori.diagram(lp.Leaf(system, {}), momentum=momentum, energy_max=energy_max, n_starts=n_starts, seed=seed)


@pytest.mark.parametrize(("n_starts", "seed"), [(30, 0), (60, 1)])
def test_families_that_are_short_beside_the_figure_are_found(n_starts, seed):
    """Of each of four lines the part below the saddle of the other well, 1/4 long, and that above, 20 long.

    A family may go through the separatrix, where its orbits are no longer in one well, or end there.
    """
    found = wells(20, n_starts, seed)
    for kind, rest in (("elliptic", -0.25), ("hyperbolic", 0.0)):
        for energy in np.concatenate([np.linspace(-0.25, 0, 25), np.linspace(0, 20, 100)]):
            for value in ([energy + rest, rest], [energy + rest, energy]):
                parts = [one.values for one in found.families if one.type == kind]
                assert min(apart(np.array([value]), one[:-1], one[1:]).min() for one in parts) < 2e-3, (kind, value)


def test_a_square_of_an_integral_has_degenerate_values_without_a_curve():
    """d(l3^2) = 0 on all of l3 = 0: its values are a line that is no boundary of types.

    Where the pendulum hangs or stands, only H of H and l3^2 has a linearised flow.
    """
    momentum = lp.tori.momentum_map(PENDULUM.system, ["l3^2"])
    found = lp.tori.diagram(PENDULUM, momentum=momentum, energy_max=2, n_starts=30)
    assert len(found.degenerate_values)
    np.testing.assert_allclose(found.degenerate_values[:, 1], 0, atol=1e-12)
    assert "curves are missing through" in repr(found)
    rows = found.to_dataframe()
    assert (rows["type"][rows["curve"] == -1] == "degenerate").sum() >= len(found.degenerate_values)
    assert len(rows) == len(found)
    plain = lp.tori.diagram(PENDULUM, energy_max=2, n_starts=30)
    assert sorted(plain.rest_types) == ["elliptic, elliptic", "focus-focus"]
    assert set(found.rest_types) == {"degenerate"}
    assert plain.degenerate_values.shape == (0, 2)
    assert "missing" not in repr(plain)
    axes = lp.plot.diagram(found)
    assert "degenerate, no curve" in [text.get_text() for text in axes.get_legend().get_texts()]
    plt.close("all")


def test_regions_without_critical_values():
    below = lp.tori.diagram(PENDULUM, energy_max=-2, n_starts=5)
    assert below.families == ()
    assert len(lp.tori.regions(below, n_values=20)) == 0
    free = lp.System(lp.canonical(2), "p1")
    nothing = lp.tori.diagram(lp.Leaf(free, {}), momentum=lp.tori.momentum_map(free, ["p2"]), n_starts=5)
    assert len(nothing) == 0
    with pytest.raises(OrbitError, match="not compact"):
        lp.tori.regions(nothing, n_values=20, n_states=5)


@pytest.mark.parametrize("call", [lp.tori.diagram, lp.tori.critical_states])
def test_a_spread_of_zero_is_refused(call):
    with pytest.raises(ParameterError, match=r"^spread: "):
        call(PENDULUM, spread=0)


def test_rows_of_states_and_times_have_to_fit():
    momentum = lp.tori.momentum_map(PENDULUM.system)
    states = np.array([[0, 1.3, 0, 0.8, 0, 0.6]] * 3)
    assert momentum.flow(states, [0.1, 0.2]).shape == (3, 6)
    with pytest.raises(ShapeError, match=r"^times: wanted one row"):
        momentum.flow(states, [[0.1, 0.2]] * 2)


def test_numbers_of_tori_are_apart_from_curves_and_the_legend_is_below():
    """A sliver: between H = K and H = K - 1/4 there are few pixels for energies up to 20."""
    for energy_max in (0.5, 20):
        found = wells(energy_max)
        regions = lp.tori.regions(found, n_values=150, n_states=20)
        axes = lp.plot.diagram(found, regions=regions)
        figure = axes.get_figure()
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in axes.texts]
        assert 0 < len(boxes) <= len(regions)
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[:k])
            assert axes.bbox.fully_contains(box.x0, box.y0)
            assert axes.bbox.fully_contains(box.x1, box.y1)
            for line in (one for one in axes.lines if one.get_linestyle() != "None"):
                x, y = axes.transData.transform(np.stack(line.get_data(), axis=1)).T
                share = np.linspace(0, 1, 50)[:, None]
                x, y = ((one[:-1] + share * np.diff(one)).ravel() for one in (x, y))
                assert not ((box.x0 < x) & (x < box.x1) & (box.y0 < y) & (y < box.y1)).any()
        assert axes.get_legend().get_window_extent().y1 < axes.bbox.y0
    plt.close("all")
