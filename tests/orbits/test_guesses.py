"""Periodic orbits near a guess, and those of a level: closed forms, closing, multipliers, what is refused."""

import time
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from sympy import Rational

import liepoisson as lp
from liepoisson.orbits.closed_orbits import Problem

SADDLE = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10", name="saddle")
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
TWISTED = lp.Top.twisted_kovalevskaya()
LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}
HENON = lp.catalog.system("henon-heiles")


@pytest.mark.parametrize("q", [0.1, 1.0, 2.5])
def test_a_pendulum(q):
    """T = 4 K(sin(q/2))."""
    orbit = lp.orbits.periodic_orbit(PENDULUM, [q, 0], period=4 * ellipk(np.sin(q / 2) ** 2) + 0.1)
    assert orbit.period == pytest.approx(4 * ellipk(np.sin(q / 2) ** 2), rel=1e-13)
    assert (orbit.stability, orbit.multipliers.size) == ("neutral", 0)


def test_the_orbit_above_a_saddle():
    """Two hundred digits of guesses were not needed: three are; 6.2675781399503 by DOP853 with fsolve."""
    orbit = lp.orbits.periodic_orbit(SADDLE, [3.1, 0, 0, 0.4], period=6.3, energy="1.1")
    assert orbit.period == pytest.approx(6.2675781399503, rel=1e-12)
    assert orbit.residual < 1e-14
    assert orbit.pair_defect < 1e-12 > orbit.trivial_defect


def test_the_number_of_segments_changes_nothing():
    found = [
        lp.orbits.periodic_orbit(SADDLE, [3.1, 0, 0, 0.4], period=6.3, energy="1.1", n_segments=n) for n in (1, 3, 8)
    ]
    for one in found[1:]:
        assert one.period == pytest.approx(found[0].period, rel=1e-13)
        np.testing.assert_allclose(one.multipliers, found[0].multipliers, rtol=1e-9)
    assert [one.n_segments for one in found] == [1, 3, 8]


def test_the_least_period_is_found():
    once = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3)
    again = lp.orbits.periodic_orbit(HENON, once.start, period=3 * once.period)
    assert again.period == pytest.approx(once.period, rel=1e-12)


MU = "9537/10000000"
SUN_JUPITER = lp.System(
    lp.canonical(2),
    f"(p1^2 + p2^2)/2 - q1*p2 + q2*p1 - (1 - {MU})/sqrt((q1 + {MU})^2 + q2^2) - {MU}/sqrt((q1 - 1 + {MU})^2 + q2^2)",
)


@pytest.mark.parametrize(
    ("start", "period", "energy"),
    [([0.8324, 0, 0, 1.176], 7.015, -1.49194316), ([0.6314, 0, 0, 1.4395], 7.996, -1.4552504)],
)
def test_no_segment_begins_where_neighbours_have_moved_far_apart(start, period, energy):
    """Orbits around L1 come near to Jupiter after half of their period: what grows before it shrinks behind it."""
    found, *others = (
        lp.orbits.periodic_orbit(SUN_JUPITER, start, period=period, energy=energy, n_segments=n) for n in (None, 5, 7)
    )
    assert found.pair_defect < 1e-10
    for one in others:
        assert found.multipliers[0] == pytest.approx(one.multipliers[0], rel=1e-9)


@pytest.mark.parametrize("n", [2, 4, 9, 12, 13, 17, 26, 37, 64, 169])
def test_periods_are_least(n):
    """Whatever the multiple that is guessed."""
    orbit = lp.orbits.periodic_orbit(PENDULUM, [1, 0], period=n * 6.7)
    assert orbit.period == pytest.approx(4 * ellipk(np.sin(0.5) ** 2), rel=1e-12)


@pytest.mark.parametrize("n", [2, 3, 5, 13])
def test_periods_of_relative_orbits_are_least(n):
    """Between two passages of the largest alpha3; by how much the top turns is known up to full turns."""
    for start, once in nutations():
        orbit = lp.orbits.periodic_orbit(once.system, start, period=n * once.period + 1e-3, momenta=["l3"])
        assert orbit.period == pytest.approx(once.period, rel=1e-10)


@cache
def nutations():
    """Random states of Lagrange's top with the relative orbits near them, of the period that is seen."""
    top = lp.catalog.system("lagrange")
    found = []
    for start in lp.sample_states(top, 6, seed=3):
        once = lp.orbits.periodic_orbit(top, start, period=nutation(top, start), momenta=["l3"])
        assert once.period == pytest.approx(nutation(top, once.start), rel=1e-3)
        found.append((start, once))
    return found


def nutation(top, start):
    height = lp.integrate(top, start, times=np.linspace(0, 100, 20001)).state[0, :, 5]
    peaks = np.nonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:]))[0]
    return np.diff(peaks).mean() / 200


def test_relative_orbits_of_a_level_are_found_by_turning():
    """With l3 held, too, the Lagrange top has one nutation."""
    top = lp.catalog.system("lagrange")
    start = lp.sample_states(top, 1, seed=3)[0]
    leaf, energy = lp.Leaf.through(top, start), float(top.functions.energy(start))
    found = lp.orbits.periodic_orbits(top, leaf, energy, momenta={"l3": start[2]}, n_starts=20)
    assert [one.period for one in found] == pytest.approx([nutation(top, start)], rel=1e-3)


def test_a_symmetric_orbit_is_the_same_without_its_symmetry():
    for one in lp.orbits.symmetric_periodic_orbits(HENON, {}, energy="1/10", n_starts=20)[:3]:
        orbit = lp.orbits.periodic_orbit(HENON, one, energy="1/10")
        assert orbit.period == pytest.approx(one.period, rel=1e-12)
        loops = round(one.period / one.return_time)
        np.testing.assert_allclose(sum(orbit.multipliers), sum(one.multipliers**loops), rtol=1e-9)


def test_the_nearest_return_of_a_trajectory():
    run = lp.integrate(TWISTED, lp.sample_states(TWISTED, 1, seed=2), t_end=100)
    orbit = lp.orbits.periodic_orbit(TWISTED, run)
    assert orbit.residual < 1e-12
    assert np.abs(orbit.states(2)[1] - orbit.start).max() < 1e-11
    assert len(orbit.multipliers) == 4


def test_a_relative_orbit_of_a_symmetric_top():
    """Between two passages of the least alpha3 the Lagrange top turns about its axis."""
    top = lp.catalog.system("lagrange")
    start = lp.sample_states(top, 1, seed=3)[0]
    orbit = lp.orbits.periodic_orbit(top, start, period=3, momenta=["l3"])
    assert orbit.is_relative
    assert orbit.momenta == {"l3": start[2]}
    run = lp.integrate(top, orbit.start, times=[0, orbit.period]).state[0, 1]
    turn = np.eye(6)
    c, s = np.cos(orbit.angles[0]), np.sin(orbit.angles[0])
    for k in (0, 3):
        turn[k : k + 2, k : k + 2] = [[c, s], [-s, c]]
    np.testing.assert_allclose(run, turn @ orbit.start, atol=1e-12)
    at = lp.integrate(top, start, times=np.linspace(0, 40, 4001)).state[0, :, 5]
    peaks = np.nonzero((at[1:-1] > at[:-2]) & (at[1:-1] >= at[2:]))[0]
    assert orbit.period == pytest.approx(np.diff(peaks).mean() / 100, abs=0.01)


@pytest.mark.thorough
def test_a_function_of_the_casimirs_in_the_hamiltonian_changes_energies_only():
    bracket, body = lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/4 + l3^2/6 + alpha3"
    plain, lifted = (lp.System(bracket, text) for text in (body, body + " + dot(alpha, alpha)"))
    one = lp.orbits.symmetric_periodic_orbits(plain, {"C1": 0, "C2": 1}, energy="1/2", n_starts=20)[0]
    orbit = lp.orbits.periodic_orbit(lifted, one.start, period=one.period)
    assert orbit.period == pytest.approx(one.period, rel=1e-13)
    assert orbit.energy == pytest.approx(3 / 2, rel=1e-13)
    family = lp.orbits.orbit_family(lifted, orbit, until="8/5")
    assert family.value[-1] == pytest.approx(8 / 5, rel=1e-13)


def test_the_period_can_be_held_instead_of_the_energy():
    orbit = lp.orbits.periodic_orbit(PENDULUM, [1, 0], period=7, hold="period")
    assert orbit.period == 7
    assert 4 * ellipk((1 + orbit.energy) / 2) == pytest.approx(7, rel=1e-12)


@pytest.mark.parametrize("period", [6.29, 6.3, 6.31])
def test_a_held_period_leads_to_orbits_that_are_smaller_than_the_guess(period):
    """Newton's method holds the state across the flow at the guess, which may be further away than they are large."""
    orbit = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=period, hold="period")
    assert orbit.period == period
    assert lp.orbits.periodic_orbit(HENON, orbit).period == pytest.approx(period, rel=1e-12)


def test_no_energy_is_said_to_be_held_where_the_period_is():
    with pytest.raises(lp.errors.OrbitError, match=r"at the period 6\.2, of any energy\. Give"):
        lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.2, hold="period")


@pytest.mark.parametrize(("system", "energy"), [(PENDULUM, 0), (HENON, "1/10")], ids=["pendulum", "henon-heiles"])
def test_a_constant_in_the_hamiltonian_changes_no_orbit(system, energy):
    wanted = lp.orbits.periodic_orbits(system, {}, energy, n_starts=10)
    for constant in (100, 10**9):
        other = lp.System(system.bracket, system.hamiltonian + constant)
        found = lp.orbits.periodic_orbits(other, {}, f"{energy} + {constant}", n_starts=10)
        assert len(found) == len(wanted) > 0
        np.testing.assert_allclose([one.period for one in found], [one.period for one in wanted], rtol=1e-10)
        orbit = lp.orbits.periodic_orbit(other, wanted[0].start, period=wanted[0].period)
        assert orbit.period == pytest.approx(wanted[0].period, rel=1e-12)
        assert orbit.energy == pytest.approx(wanted[0].energy + constant, rel=1e-15)


HEAVY = lp.System(lp.catalog.system("heavy-top").bracket, "l1^2/4 + l2^2/3 + l3^2/2 + 3*alpha1/10 + alpha3")
UNITS = [
    (PENDULUM, [1, 0], 6.7, (s, action / s)) for s, action in ((1e-6, 1), (1e6, 1), (1, 1e3), (1e-3, 1e-3), (10, 1))
]
UNITS += [
    (SADDLE, [3.1, 0, 0, 0.4], 6.3, (s, r, action / s, action / r))
    for s, r, action in ((1e-6, 1e-6, 1), (1e6, 1e-3, 1), (1, 1, 1e-6), (30, 1, 1))
]
UNITS += [
    (HENON, [0, 0, 0, 0.2], 6.3, (s, s, action / s, action / s)) for s, action in ((1e3, 1), (1e-6, 1e-12), (1, 1e3))
]
UNITS += [
    (HEAVY, [0.3, 0.1, 1.2, 0.4, 0.1, 0.9], 4.7, (c, c, c, a, a, a))
    for c, a in ((1e-4, 1e-4), (1e-2, 1e-2), (1e3, 1e3), (1e4, 1e4), (1, 1e3), (1e6, 1e-6), (1e-3, 1e-3), (30, 30))
]


def in_units(system, units):
    """The same motion, of y = x/u: the bracket is as large as the first unit of a field or the action says."""
    exact = [Rational(str(u)) for u in units]
    canonical = not system.bracket.entries()
    whole = exact[0] * exact[len(units) // 2] if canonical else exact[0]
    names = dict(zip(system.bracket.variables, exact, strict=True))
    scaled = system.hamiltonian.subs({x: u * x for x, u in names.items()}, simultaneous=True) / whole
    return lp.System(system.bracket, scaled), float(whole)


@cache
def orbit_near(system, guess, period):
    return lp.orbits.periodic_orbit(system, guess, period=period)


@cache
def orbits_through(system, x):
    return lp.orbits.periodic_orbits(system, lp.Leaf.through(system, x), float(system.functions.energy(x)), n_starts=12)


@pytest.mark.parametrize(("system", "guess", "period", "units"), UNITS)
def test_an_orbit_is_the_same_in_other_units(system, guess, period, units):
    """Newton's method comes to it, its multipliers are those, and whether it is alone on its level is not in doubt."""
    wanted = orbit_near(system, tuple(guess), period)
    other, whole = in_units(system, units)
    for near in (1.0, 1.003):
        found = lp.orbits.periodic_orbit(
            other, wanted.start / units, period=near * wanted.period, energy=wanted.energy / whole
        )
        assert found.period == pytest.approx(wanted.period, rel=1e-10)
        assert (found.stability, found.is_isolated) == (wanted.stability, wanted.is_isolated)
        assert abs(found.multipliers).max(initial=1) == pytest.approx(abs(wanted.multipliers).max(initial=1), rel=1e-7)
        assert found.energy * whole == pytest.approx(wanted.energy, rel=1e-10)


@pytest.mark.parametrize(("system", "units"), [(one[0], one[3]) for one in UNITS])
def test_orbits_of_a_level_are_found_in_other_units(system, units):
    x = {4: (0.1, 0.3, 0.2, 0.1), 2: (1, 0.2), 6: (0.3, 0.1, 1.2, 0.4, 0.1, 0.9)}[len(units)]
    wanted, (other, whole) = orbits_through(system, x), in_units(system, units)
    energy = float(system.functions.energy(x))
    found = lp.orbits.periodic_orbits(other, lp.Leaf.through(other, x / np.array(units)), energy / whole, n_starts=12)
    assert found.n_families * 4 <= len(found)
    periods, known = ({round(orbit.period, 6) for orbit in each} for each in (found, wanted))
    assert len(periods & known) >= min(2, len(known)), (periods, known)


def test_a_casimir_that_is_round_off_gives_no_unit():
    """m.p of a state where it vanishes is 1e-17; H is no polynomial and says nothing."""
    system = lp.catalog.system("goryachev")
    draw = np.random.default_rng(1)
    for _ in range(20):
        p = draw.standard_normal(3)
        m = np.cross(p, draw.standard_normal(3))
        leaf = lp.Leaf.through(system, np.concatenate([m, p]))
        np.testing.assert_array_equal(leaf.in_units().units, 1.0)


@pytest.mark.parametrize("hold", ["energy", "period"])
def test_an_orbit_is_on_the_level_that_it_names(hold):
    orbit = lp.orbits.periodic_orbit(PENDULUM, [1, 0], period=7, hold=hold)
    assert orbit.level.number("H") == pytest.approx(orbit.energy, rel=1e-14)
    assert orbit.level.distance(orbit.start) < 1e-14
    assert f"H = {orbit.energy:.12g}" in repr(orbit)


@pytest.mark.parametrize(("system", "guess", "energy"), [(HENON, [0, 0, 0, 0.2], 0), (PENDULUM, [1, 0], -1)])
def test_an_equilibrium_is_no_orbit(system, guess, energy):
    with pytest.raises(lp.errors.OrbitError, match="must move"):
        lp.orbits.periodic_orbit(system, guess, period=6.3, energy=energy)


def test_a_steady_precession_is_no_relative_orbit():
    """With l3 = W cos(theta) + 1/W the Lagrange top turns about the vertical with W and does nothing else."""
    top, s, c = lp.catalog.system("lagrange"), np.sin(1), np.cos(1)
    with pytest.raises(lp.errors.OrbitError, match="only turns"):
        lp.orbits.periodic_orbit(top, [s, 0, c + 1, s, 0, c], period=3, momenta=["l3"])


@pytest.mark.parametrize("period", [1e6, 1e40])
def test_the_time_limit_ends_long_orbits(period):
    began = time.process_time()
    with pytest.raises(lp.errors.TimeLimitError, match="following orbits was under way"):
        lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=period, time_limit=0.3)
    assert time.process_time() - began < 3


@pytest.mark.thorough
def test_orbits_of_a_level_are_found_and_are_those_of_another_integrator():
    found = lp.orbits.periodic_orbits(TWISTED, LEVEL, energy="1/2", n_starts=40)
    assert len(found) >= 6
    assert max(one.residual for one in found) <= 1e-12
    assert max(one.pair_defect for one in found) < 1e-10
    for one in found[:3]:
        run = solve_ivp(
            lambda _, x: TWISTED.vector_field(x), (0, one.period), one.start, method="DOP853", rtol=1e-13, atol=1e-14
        )
        largest = np.abs(one.multipliers).max()
        assert np.abs(run.y[:, -1] - one.start).max() < 1e-10 * (1 + largest)
    table = found.to_dataframe()
    assert list(table.columns[:5]) == ["energy", "C1", "C2", "C3", "period"]
    np.testing.assert_allclose(table[["energy", "C1", "C2", "C3"]], [[0.5, 1, 0.5, 1]] * len(found), rtol=1e-13)


def test_loops_of_an_orbit_that_is_known_are_not_described_again(monkeypatch):
    """Most guesses of a level lead to a few orbits, or run through them several times."""
    described, own = [], Problem.described

    def counted(self, loops, row=0):
        described.append(loops.time[row])
        return own(self, loops, row)

    monkeypatch.setattr(Problem, "described", counted)
    found = lp.orbits.periodic_orbits(HENON, {}, energy="1/8", n_starts=50)
    assert len(found) == 4
    assert len(described) == len(found)


REFUSED = (
    ({"guess": [1, 0]}, lp.errors.ParameterError, "period: wanted the time after which the orbit closes"),
    ({"guess": [0, 0], "period": 6}, lp.errors.ParameterError, "at rest"),
    ({"guess": [1, 0], "period": 0}, lp.errors.ParameterError, "period"),
    ({"guess": [1, 0], "period": 3}, lp.errors.OrbitError, "an orbit must close"),
    ({"guess": [1, 0], "period": 7, "hold": "time"}, lp.errors.ParameterError, "hold"),
    ({"guess": [1, 0], "period": 7, "hold": "period", "energy": 0}, lp.errors.ParameterError, "no energy"),
    ({"guess": [1, 0], "period": 7, "energy": -3}, lp.errors.LiePoissonError, "energ"),
    ({"guess": [1, 0], "period": 7, "momenta": ["p1"]}, lp.errors.ParameterError, "momenta"),
    ({"guess": [[1, 0], [2, 0]], "period": 7}, lp.errors.ParameterError, "one state"),
    ({"guess": [1, 0, 0], "period": 7}, lp.errors.LiePoissonError, "component"),
    ({"guess": [1, 0], "period": 1e-300}, lp.errors.ParameterError, "period 1e-300 too short"),
    ({"guess": [1, 0], "period": 7, "energy": 1e300}, lp.errors.LeafError, r"H = 1e\+300 was found"),
    ({"guess": [1, 0], "period": 7, "symmetry": "x"}, lp.errors.ParameterError, "symmetry: wanted one of discrete"),
    ({"guess": [1, 0], "period": 7, "symmetry": lp.systems.discrete_symmetries(HENON)[0]},
     lp.errors.ParameterError, "symmetry: wanted one of .* got one of 'henon-heiles'"),
)  # fmt: skip


@pytest.mark.parametrize(
    ("momenta", "words"),
    [
        ({"l3": np.nan}, "l3: wanted a finite number"),
        ({"l3": np.inf}, "l3: wanted a finite number"),
        ({"l3": True}, "l3: wanted a finite number"),
        ({"l3": None}, "l3: wanted a finite number"),
        (True, "sequence of integrals"),
        ("l3", "sequence of integrals"),
        (["l3", "l3"], "each once; l3"),
        (["l3", "2*l3"], r"each once; 2\*l3"),
        (["C1"], "C1 is a Casimir"),
        (["l3", "C2"], "C2 is a Casimir"),
        (["1"], "1 is a Casimir"),
        (["H"], "that of H is not"),
        (["l1"], "l1 is not constant"),
    ],
)
def test_momenta_that_are_refused(momenta, words):
    top = lp.catalog.system("lagrange")
    start = lp.sample_states(top, 1, seed=3)[0]
    energy = float(top.functions.energy(start))
    for call in (
        lambda: lp.orbits.periodic_orbit(top, start, period=3, momenta=momenta),
        lambda: lp.orbits.periodic_orbits(top, lp.Leaf.through(top, start), energy, momenta=momenta, n_starts=2),
    ):
        with pytest.raises(lp.errors.ParameterError, match=words):
            call()


@pytest.mark.parametrize(("given", "kind", "words"), REFUSED)
def test_what_is_refused(given, kind, words):
    with pytest.raises(kind, match=words):
        lp.orbits.periodic_orbit(PENDULUM, **given)


def test_an_equilibrium_is_sent_to_families():
    rest = lp.phase_space.equilibrium(SADDLE, [np.pi, 0, 0, 0])
    with pytest.raises(lp.errors.ParameterError, match="orbit_family"):
        lp.orbits.periodic_orbit(SADDLE, rest, period=6)


def test_a_search_needs_the_values_of_momenta():
    """Random states have all values."""
    top = lp.catalog.system("lagrange")
    with pytest.raises(lp.errors.ParameterError, match=r"write for example momenta=\{'l3': 1.5\}"):
        lp.orbits.periodic_orbits(top, {"C1": 1, "C2": 1}, 2, momenta=["l3"], n_starts=4)


def test_orbits_that_turn_faster_and_faster_do_not_take_the_time_of_a_search():
    """Most orbits of this cubic and quartic potential escape, with |x| up to 1e13 and as many turns."""
    winding = lp.System(
        lp.canonical(2), "p1*q2 + p2^2/2 + q2^2/4 - q1^2/2 + q1^4/4 + q2^3/5 + q1*q2*p2^2/20", name="winding"
    )
    found = lp.orbits.periodic_orbits(winding, {}, "1/10", n_starts=60, time_limit=60)
    assert not found.is_cut_short
    assert [round(one.period, 6) for one in found[:2]] == [5.293076, 6.813525]
    origin = lp.phase_space.equilibrium(winding, [0, 0, 0, 0])
    connections = lp.orbits.connecting_orbits(origin, n_starts=60, time_limit=60)
    assert not connections.is_cut_short
    assert len(connections) >= 4
