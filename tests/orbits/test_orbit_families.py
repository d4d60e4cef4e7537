"""Families of periodic orbits: closed forms along them, bifurcations from the literature, branches, ends."""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk

import liepoisson as lp
from liepoisson.orbits.family_loops import LoopCurve

PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
SADDLE = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10", name="saddle")
HENON = lp.catalog.system("henon-heiles")


def trace_less_two(energy):
    """Of the small vibrations across Hénon and Heiles's straight orbit, x'' = -(1 + 2 y(t)) x, after one period."""

    def rates(_, z):
        y, p, first, first_rate, second, second_rate = z
        return [p, y * y - y, first_rate, -(1 + 2 * y) * first, second_rate, -(1 + 2 * y) * second]

    def is_back(t, z):
        return z[0] if t > 1 else 1.0

    is_back.terminal, is_back.direction = True, 1
    start = [0, np.sqrt(2 * energy), 1, 0, 0, 1]
    run = solve_ivp(rates, (0, 40), start, method="DOP853", rtol=1e-13, atol=1e-14, events=is_back)
    return run.y[2, -1] + run.y[5, -1] - 2


@cache
def first_of_the_cascade():
    """Where the orbits R5 and L6 of [brack2001] leave the straight one, in units of the saddle's energy 1/6."""
    return [6 * brentq(trace_less_two, *bounds, xtol=1e-14) for bounds in ((0.161, 0.162), (0.164, 0.1647))]


@pytest.fixture(scope="module")
def straight():
    """The orbit along the axis of Hénon and Heiles's potential, up to the saddle."""
    start = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3)
    return lp.orbits.orbit_family(HENON, start, until=0.1645, longest_step=0.05)


def test_the_pendulum_from_its_equilibrium():
    """T = 4 K(sin(q/2)) with the energy -cos q, from 2 pi on."""
    rest = lp.phase_space.equilibrium(PENDULUM, [0, 0])
    family = lp.orbits.orbit_family(PENDULUM, rest, until="4/5")
    assert family[-1].energy == pytest.approx(0.8, rel=1e-14)
    assert family.end == "the wanted value"
    np.testing.assert_allclose(family.period, 4 * ellipk((1 + family.value) / 2), rtol=1e-12)
    assert family.period[0] == pytest.approx(2 * np.pi, abs=1e-3)


UNITS = {
    "p1^2/2 - cos(q1/10^6)": (1e6, 1, 1e6),
    "10^6*(p1^2/2 - cos(q1/10^6))": (1e6, 1e6, 1),
    "10^-6*(p1^2/2 - cos(10^6*q1))": (1e-6, 1e-6, 1),
    "p1^2/2 - cos(1000*q1)": (1e-3, 1, 1e-3),
}


@pytest.mark.parametrize("text", UNITS)
def test_the_pendulum_in_other_units(text):
    """H is no polynomial, which says in what units it is ordinary: those of the orbit do."""
    length, energy, time = UNITS[text]
    system = lp.System(lp.canonical(1), text)
    start = lp.orbits.periodic_orbit(system, [length, 0], period=7 * time)
    family = lp.orbits.orbit_family(system, start, until=0.8 * energy)
    assert family.end == "the wanted value"
    assert len(family) < 30
    np.testing.assert_allclose(family.period, 4 * time * ellipk((1 + family.value / energy) / 2), rtol=1e-12)
    small = lp.orbits.orbit_family(system, lp.phase_space.equilibrium(system, [0, 0]), max_orbits=20)
    assert small.end == "20 orbits"
    np.testing.assert_allclose(small.period, 4 * time * ellipk((1 + small.value / energy) / 2), rtol=1e-10)


def test_the_lyapunov_family_of_a_saddle():
    """6.2675781399503 at E = 1.1, by DOP853 with fsolve."""
    rest = lp.phase_space.equilibrium(SADDLE, [np.pi, 0, 0, 0])
    family = lp.orbits.orbit_family(SADDLE, rest, until=1.1)
    assert family.period[-1] == pytest.approx(6.2675781399503, rel=1e-12)
    assert {one.stability for one in family} == {"hyperbolic"}
    assert len(family.points) == 0


@pytest.mark.thorough
def test_bifurcations_of_henon_and_heiles(straight):
    branches = [6 * one.orbit.energy for one in straight.points if one.kind == "branch"]
    np.testing.assert_allclose(branches[:2], first_of_the_cascade(), rtol=1e-10)
    assert [one.kind for one in straight.points[:2]] == ["double period", "double period"]
    for one in straight.points[:2]:
        assert abs(one.orbit.multipliers + 1).max() < 1e-5  # a double one scatters by the root of the round-off
    assert max(one.residual for one in straight) <= 1e-12
    assert max(one.pair_defect for one in straight) < 1e-9


@pytest.mark.thorough
def test_branches_have_less_symmetry(straight):
    """R5 is a rotation, stable where it begins; L6 a libration, unstable; orbits of the double period have it."""
    first, second = [one for one in straight.points if one.kind == "branch"][:2]
    rotation = lp.orbits.orbit_family(HENON, first, max_orbits=3, longest_step=0.02)
    libration = lp.orbits.orbit_family(HENON, second, max_orbits=3, longest_step=0.02)
    assert rotation[0].stability == "elliptic"
    assert libration[0].stability == "hyperbolic"
    for family in (rotation, libration):
        assert np.abs(family[-1].states(50)[:, 0]).max() > 1e-3  # it leaves the axis x = 0
        assert family[-1].residual <= 1e-12
    double = straight.points[0]
    twice = lp.orbits.orbit_family(HENON, double, max_orbits=3, longest_step=0.02)
    assert twice[0].period == pytest.approx(2 * double.orbit.period, rel=1e-3)
    assert abs(twice[-1].period / straight.period[0] - 1) > 0.5


def test_a_family_in_a_casimir_leaves_the_energy():
    top = lp.catalog.system("kovalevskaya")
    level = {"C1": 0, "C2": 1}
    one = lp.orbits.symmetric_periodic_orbits(top, level, energy=2, n_starts=20)[0]
    family = lp.orbits.orbit_family(top, one, along="C1", until=0.05)
    assert family.value[-1] == pytest.approx(0.05, rel=1e-13)
    np.testing.assert_allclose([one.energy for one in family], 2, rtol=1e-12)
    values = [top.functions.casimirs["C2"](one.start) for one in family]
    np.testing.assert_allclose(values, 1, rtol=1e-12)


@pytest.mark.thorough
def test_the_pendulum_in_its_weight():
    """T = 4 K(sqrt((E + g)/2g))/sqrt(g) at the energy E."""
    heavy = lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1)", {"g": 1})
    start = lp.orbits.periodic_orbit(heavy, [1, 0], period=7)
    family = lp.orbits.orbit_family(heavy, start, along="g", until=3)
    assert family.end == "the wanted value"
    assert family.value[-1] == 3
    assert family[-1].system.parameters["g"] == 3
    energy, g = start.energy, family.value
    np.testing.assert_allclose([one.energy for one in family], energy, rtol=1e-13)
    np.testing.assert_allclose(family.period, 4 * ellipk((energy + g) / (2 * g)) / np.sqrt(g), rtol=1e-13)
    back = lp.orbits.orbit_family(heavy, family[-1], along="g", until=1, increasing=False)
    assert back.period[-1] == pytest.approx(start.period, rel=1e-13)


@pytest.mark.thorough
def test_bifurcations_in_a_parameter_are_those_in_the_energy():
    """In units in which the potential is x^2 y - y^3/3 times k, the energy counts as k^2 E."""
    text = "(px^2 + py^2 + x^2 + y^2)/2 + k*(x^2*y - y^3/3)"
    scaled = lp.System(lp.canonical(names=("x", "y"), momenta=("px", "py")), text, {"k": 1})
    start = lp.orbits.periodic_orbit(scaled, [0, 0, 0, 0.5], period=6.3)
    family = lp.orbits.orbit_family(scaled, start, along="k", until=1.148, longest_step=0.1)
    branches = [one for one in family.points if one.kind == "branch"]
    k = [float(one.orbit.system.parameters["k"]) for one in branches]
    np.testing.assert_allclose(6 * start.energy * np.array(k) ** 2, first_of_the_cascade(), rtol=1e-10)
    libration = lp.orbits.orbit_family(scaled, branches[1], along="k", max_orbits=2, longest_step=0.02)
    assert libration[0].stability == "hyperbolic"
    assert np.abs(libration[1].states(50)[:, 0]).max() > 1e-3


@pytest.mark.thorough
def test_an_orbit_in_the_strength_of_the_cocycle_keeps_the_casimirs_that_depend_on_it():
    top, level = lp.Top.kovalevskaya(epsilon=1), {"C1": 1, "C2": "1/2", "C3": 1}
    one = lp.orbits.symmetric_periodic_orbits(top, level, energy="1/2", n_starts=40)[0]
    family = lp.orbits.orbit_family(top, one, along="epsilon", until="6/5")
    values = np.array([[*each.level.leaf.casimirs.values(), each.energy] for each in family])
    np.testing.assert_allclose(values, np.broadcast_to([1, 0.5, 1, 0.5], values.shape), rtol=1e-13)
    again = lp.orbits.periodic_orbit(lp.Top.kovalevskaya(epsilon="6/5"), family[-1], leaf=level, energy="1/2")
    assert family.period[-1] == pytest.approx(again.period, rel=1e-13)
    assert max(each.residual for each in family) < 1e-13
    assert max(each.pair_defect for each in family) < 1e-10


@pytest.mark.thorough
def test_a_relative_orbit_in_the_weight_of_a_symmetric_top():
    top = lp.catalog.system("lagrange")
    start = lp.sample_states(top, 1, seed=3)[0]
    orbit = lp.orbits.periodic_orbit(top, start, period=3, momenta=["l3"])
    family = lp.orbits.orbit_family(top, orbit, along="a3", until=1.2)
    last = family[-1]
    assert last.momenta == {"l3": pytest.approx(start[2], rel=1e-13)}
    heavier = lp.catalog.system("lagrange", {"a": [0, 0, 1.2]})
    again = lp.orbits.periodic_orbit(heavier, last, momenta=["l3"])
    assert (again.period, again.angles[0]) == pytest.approx((last.period, last.angles[0]), rel=1e-12)


def test_a_family_that_ends_at_a_separatrix_has_no_orbit_twice():
    """The period grows beyond all bounds at the energy 1 of the upright pendulum."""
    rest = lp.phase_space.equilibrium(PENDULUM, [0, 0])
    family = lp.orbits.orbit_family(PENDULUM, rest, until=2)
    assert family.end == "orbits heteroclinic between 2 equilibria"
    assert np.abs(np.diff([one.start for one in family], axis=0)).max(axis=1).min() > 0


@pytest.mark.thorough
@pytest.mark.parametrize("omega", [1, 10])
def test_a_family_that_shrinks_ends_at_the_equilibrium(omega):
    """It neither goes through it and out again, nor turns there, in the energy and in the weight."""
    swing = lp.System(lp.canonical(1), "p1^2/2 - w*w*g*cos(q1)", {"w": omega, "g": 1})
    start = lp.orbits.periodic_orbit(swing, [1, 0], period=7 / float(swing.parameters["w"]))
    for along in ("energy", "g"):
        family = lp.orbits.orbit_family(swing, start, along=along, increasing=False)
        assert family.end == "an equilibrium"
        assert (np.diff(family.value) < 0).all()
        assert not family.points


def test_a_table_has_a_row_for_each_orbit():
    rest = lp.phase_space.equilibrium(PENDULUM, [0, 0])
    family = lp.orbits.orbit_family(PENDULUM, rest, max_orbits=4)
    frame = family.to_dataframe()
    assert len(frame) == len(family) == 4
    assert list(frame.columns[:3]) == ["energy", "period", "rate"]
    assert family.end == "4 orbits"
    assert repr(family).startswith("4 orbits of a family of")


REFUSED = (
    ({"start": [1, 0]}, "wanted a periodic orbit or an equilibrium"),
    ({"along": "C7"}, "along"),
    ({"along": "g"}, "a parameter of the system"),
    ({"mode": 1}, "frequenc"),
    ({"longest_step": 0}, "longest_step"),
    ({"longest_step": np.nan}, "longest_step"),
    ({"until": np.nan}, "until"),
    ({"max_orbits": 1}, "max_orbits"),
    ({"until": "x"}, "until"),
)


@pytest.mark.parametrize(("given", "words"), REFUSED)
def test_what_is_refused(given, words):
    rest = lp.phase_space.equilibrium(PENDULUM, [0, 0])
    with pytest.raises(lp.errors.LiePoissonError, match=words):
        lp.orbits.orbit_family(PENDULUM, **({"start": rest} | given))


@pytest.mark.parametrize("along", ["energy", "C1"])
@pytest.mark.parametrize("mode", [0, 1])
def test_orbits_of_a_sleeping_top_that_only_turn_are_no_relative_orbits(along, mode):
    """Its normal modes are circles, about the axis whose momentum is held: steady precessions."""
    top = lp.catalog.system("lagrange")
    asleep = lp.phase_space.equilibrium(top, [0, 0, 3, 0, 0, 1])
    with pytest.raises(lp.errors.OrbitError, match=r"only turn, by the flows of l3.*Leave out the momenta"):
        lp.orbits.orbit_family(top, asleep, along=along, momenta=["l3"], mode=mode)
    assert len(lp.orbits.orbit_family(top, asleep, along=along, mode=mode, max_orbits=2)) == 2


@pytest.mark.parametrize("mode", [0, 1])
@pytest.mark.parametrize("length", ["10^-6", "1", "10^6"])
def test_a_family_from_rest_at_zero_in_other_units(length, mode):
    """Nothing at zero says how large an orbit is but the nonlinear terms: p^2/2 - L^2 cos(q/L) + q^2 y/(3 L)."""
    text = "(p1^2 + p2^2)/2 - L^2*cos(q1/L) + q2^2 + q1^2*q2/(3*L)"
    system = lp.System(lp.canonical(2), text, {"L": length})
    rest = lp.phase_space.equilibrium(system, [0, 0, 0, 0])
    size = float(system.parameters["L"]) ** 2
    family = lp.orbits.orbit_family(system, rest, mode=mode, until=-0.9 * size, longest_step=0.1)
    assert family.end == "the wanted value"
    assert len(family) < 12
    assert family[-1].period == pytest.approx([np.pi * np.sqrt(2), 6.3812212580489][mode], rel=1e-11)
    x, y, p, q = family[-1].start / np.sqrt(size)
    end = solve_ivp(
        lambda _, z: [z[2], z[3], -np.sin(z[0]) - 2 * z[0] * z[1] / 3, -2 * z[1] - z[0] ** 2 / 3],
        (0, family[-1].period), [x, y, p, q], method="DOP853", rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    np.testing.assert_allclose(end.y[:, -1], [x, y, p, q], atol=1e-10)


def test_a_saddle_has_no_orbits_around_it():
    top = lp.phase_space.equilibrium(PENDULUM, [np.pi, 0])
    with pytest.raises(lp.errors.ParameterError, match="around which orbits oscillate; this one has none"):
        lp.orbits.orbit_family(PENDULUM, top)


HEAVY = lp.catalog.system("heavy-top", {"I": [3, 2, "7/5"], "a": ["1/2", 0, "4/5"]})
LEAF = {"C1": "3/10", "C2": 1}


@pytest.mark.parametrize("coupling", ["1/20", "1/10", "1/5"])
def test_a_branch_of_lame_is_not_the_family_that_it_leaves(coupling):
    """Of two soft springs in phase the difference obeys Lame's equation: k^2 = 4 c/(3 - 4 c), a^2 = 2 k^2/(1 + k^2)."""
    system = lp.System(
        lp.canonical(2), f"(p1^2 + p2^2)/2 + (q1^2 + q2^2)/2 - (q1^4 + q2^4)/4 + {coupling}*(q1 - q2)^2", name="two"
    )
    rest = lp.phase_space.equilibrium(system, [0] * 4)
    family = lp.orbits.orbit_family(system, rest, mode=1, until=0.45)
    c = float(Fraction(coupling))
    k2 = 4 * c / (3 - 4 * c)
    a2 = 2 * k2 / (1 + k2)
    (point,) = family.points
    assert point.is_located
    assert point.orbit.energy == pytest.approx(a2 - a2**2 / 2, rel=1e-12)
    for one in lp.orbits.orbit_family(system, point, max_orbits=3):
        states = one.states(21)
        assert np.abs(states[:, 0] - states[:, 1]).max() > 1e-2


def test_points_do_not_depend_on_the_step_or_the_direction():
    """Hénon and Heiles's potential has a symmetry of order three; 0.1615515151 is the first branch."""
    found = []
    for angle, step in ((0, 0.2), (2 * np.pi / 3, 0.2), (4 * np.pi / 3, 0.08)):
        way = [0, 0, -0.2 * np.sin(angle), 0.2 * np.cos(angle)]
        start = lp.orbits.periodic_orbit(HENON, way, period=6.3)
        family = lp.orbits.orbit_family(HENON, start, until=0.162, longest_step=step)
        found.append([point.orbit.energy for point in family.points])
        branch = lp.orbits.orbit_family(HENON, family.points[-1], max_orbits=2)
        assert branch[0].stability == "elliptic"
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-12)


def test_two_points_in_one_step():
    """The double period at 0.8014737450 (monodromy of DOP853) is in the same default step as the branch before it."""
    system = lp.System(
        lp.canonical(3), "(p1^2 + p2^2 + p3^2)/2 + (q1^2 + 2*q2^2 + 3*q3^2)/2 + q1^2*q2 + q2*q3^2 - q2^3/3 + q1*q3^2/2"
    )
    family = lp.orbits.orbit_family(system, lp.phase_space.equilibrium(system, [0] * 6), mode=1, until=0.85)
    assert [point.kind for point in family.points] == ["branch", "double period"]
    assert family.points[1].orbit.energy == pytest.approx(0.8014737450, rel=1e-9)
    assert min(abs(family.points[1].orbit.multipliers + 1)) < 1e-6


@pytest.mark.parametrize("along", ["energy", "C1"])
def test_a_family_from_rest_stays_on_its_leaf(along):
    rest = lp.equilibria(HEAVY, LEAF)[0]
    family = lp.orbits.orbit_family(HEAVY, rest, along=along, max_orbits=4)
    table = family.to_dataframe()
    held = {"energy": float(rest.energy), "C1": 0.3, "C2": 1.0}
    del held[along]
    for name, value in held.items():
        np.testing.assert_allclose(table[name], value, rtol=1e-12)


def test_a_family_that_crosses_a_symmetric_one_has_a_branch_there():
    """Its energy turns at 0.7008575390362 (DOP853), where two multipliers touch 1 and part; mirror images follow."""
    start = lp.orbits.periodic_orbits(HEAVY, LEAF, "1.2", n_starts=40)[0]
    assert start.period == pytest.approx(5.978669797971, rel=1e-11)
    family = lp.orbits.orbit_family(HEAVY, start, increasing=False, max_orbits=25)
    (point,) = family.points
    assert (point.kind, point.is_located) == ("branch", True)
    assert point.orbit.energy == pytest.approx(0.7008575390362, rel=1e-12)
    symmetric = lp.orbits.orbit_family(HEAVY, point, max_orbits=3)
    assert (
        max(np.abs(one.states(2001)[:, [1, 4]]).sum(axis=1).min() for one in symmetric) < 0.02
    )  # meets l2 = alpha2 = 0
    assert family.to_dataframe().next_point[point.after] == "branch at 0.700857539"


@pytest.mark.parametrize(("system", "start"), [(PENDULUM, [1, 0]), (HENON, [0, 0, 0, 0.2])])
def test_a_family_ends_at_its_equilibrium(system, start):
    first = lp.orbits.periodic_orbit(system, start, period=6.5)
    family = lp.orbits.orbit_family(system, first, increasing=False)
    assert (family.end, family.points) == ("an equilibrium", ())
    assert np.all(np.diff(family.value) < 0)


def test_the_wanted_value_says_the_direction():
    first = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.5)
    family = lp.orbits.orbit_family(HENON, first, until="1/100")
    assert (family.end, family[-1].energy) == ("the wanted value", pytest.approx(0.01, rel=1e-14))
    assert all(one.is_isolated for one in family)


TOGETHER = {
    "double periods and a branch": (HENON, [0, 0, 0, 0.2], 6.3, {"until": 0.163, "longest_step": 0.01}),
    "in several segments": (SADDLE, [3.1, 0, 0, 0.4], 6.3, {"max_orbits": 33, "longest_step": 0.01}),
    "an equilibrium": (PENDULUM, [0.3, 0], 6.3, {"increasing": False, "longest_step": 0.01}),
    "with rotations": (
        lp.catalog.system("lagrange"), lp.sample_states(lp.catalog.system("lagrange"), 1, seed=3)[0], 3,
        {"max_orbits": 20, "longest_step": 0.02, "momenta": ["l3"]},
    ),
    "in a parameter": (
        lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1)", {"g": 1}), [1, 0], 7,
        {"along": "g", "max_orbits": 20, "longest_step": 0.02},
    ),
    "in a Casimir": (
        lp.catalog.system("kovalevskaya"), [0, 0, 1, 1, 0, 0], 6,
        {"along": "C1", "max_orbits": 14, "longest_step": 0.01},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TOGETHER)
def test_orbits_together_are_those_one_after_the_other(name, monkeypatch):
    """Most orbits come from predictions; they, the points between them and the end are those of single steps."""
    system, start, period, options = TOGETHER[name]
    first = lp.orbits.periodic_orbit(system, start, period=period, momenta=options.get("momenta", ()))
    found, ahead = list[int](), LoopCurve.ahead

    def counted(self, *given):
        points = ahead(self, *given)
        found.append(len(points))
        return points

    monkeypatch.setattr(LoopCurve, "ahead", counted)
    together = lp.orbits.orbit_family(system, first, **options)
    assert sum(found) > len(together) / 2
    assert max(found) > 3
    monkeypatch.setattr(LoopCurve, "together", 1)
    found.clear()
    single = lp.orbits.orbit_family(system, first, **options)
    assert not found
    assert (together.end, len(together)) == (single.end, len(single))
    np.testing.assert_allclose([one.start for one in together], [one.start for one in single], rtol=0, atol=1e-9)
    np.testing.assert_allclose(together.period, single.period, rtol=1e-11)
    np.testing.assert_allclose(together.multipliers, single.multipliers, rtol=1e-8)
    assert [one.is_isolated for one in together] == [one.is_isolated for one in single]
    kinds = [[(one.kind, one.after, one.is_located) for one in family.points] for family in (together, single)]
    assert kinds[0] == kinds[1]
    energies = [[one.orbit.energy for one in family.points] for family in (together, single)]
    np.testing.assert_allclose(*energies, rtol=1e-12)
