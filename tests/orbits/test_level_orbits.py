"""Many guesses at once: the orbits of single calls, whatever the others are; what becomes of bad ones; refusals."""

from functools import cache

import numpy as np
import pytest

import liepoisson as lp

HENON = lp.catalog.system("henon-heiles")
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
WELL = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 + q1^4/4")
ROOT = lp.System(lp.canonical(1), "p1^2/2 + q1 + 1/(4*sqrt(q1))")
OSCILLATORS = lp.System(lp.canonical(2), "(p1^2 + p2^2 + q1^2 + q2^2)/2")
TURN = np.kron(np.eye(2), [[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])
"""A third of a turn, which maps Hénon and Heiles's system to itself."""
LEVEL = {"leaf": {}, "energy": "1/8"}


def from_guesses(system, energy, guesses, periods, leaf=None, **options):
    return lp.orbits.periodic_orbits(system, leaf or {}, energy, guesses=guesses, periods=periods, **options)


@cache
def hundred():
    """Guesses of four digits along four orbits and what they become by thirds of a turn, and their periods."""
    draw = np.random.default_rng(5)
    states, periods = [], []
    for orbit in lp.orbits.periodic_orbits(HENON, **LEVEL, n_starts=50):
        for x in orbit.states(26)[1:]:
            turned = np.linalg.matrix_power(TURN, draw.integers(3)) @ x
            states.append([float(f"{v:.4g}") for v in turned])
            periods.append(float(f"{draw.integers(1, 3) * orbit.period:.4g}"))
    return np.array(states), np.array(periods)


@cache
def led():
    return from_guesses(HENON, "1/8", *hundred())


def distance(orbit, state):
    """How far a state is from an orbit, by its nearest of many states."""
    for _ in range(3):
        times = np.linspace(0, orbit[1], 201)
        run = lp.integrate(HENON, orbit[0], times=times).state[0]
        k = int(np.argmin(np.abs(run - state).max(axis=1)))
        orbit = run[max(0, k - 1)], 2 * times[1]
    return np.abs(run - state).max(axis=1).min()


def test_both_wells_have_their_own_orbit():
    """They are images of one another, with the same period; a search lists one of them."""
    found = from_guesses(WELL, "-1/8", [[1.3, 0], [-1.3, 0], [0.6, 0.1], [-1, 0.3]], 5)
    assert found.orbit.tolist() == [0, 1, 0, 1] or found.orbit.tolist() == [1, 0, 1, 0]
    assert [np.sign(found[k].start[0]) for k in found.orbit] == [1, -1, 1, -1]
    assert found[0].period == pytest.approx(found[1].period, rel=1e-13)
    assert len(lp.orbits.periodic_orbits(WELL, {}, "-1/8", n_starts=20)) == 1


def single(guess, energy, **options):
    try:
        return lp.orbits.periodic_orbit(HENON, guess, energy=energy, **options)
    except lp.errors.OrbitError:
        return None


@pytest.mark.thorough
@pytest.mark.parametrize("every", [5, pytest.param(1, marks=pytest.mark.slow)])
def test_a_hundred_guesses_lead_to_the_orbits_of_single_calls(every):
    """Of every fifth one it is seen that it is on its own orbit and on no other one."""
    states, periods = hundred()
    assert len(states) == 100
    found = led()
    wanted = [single(state, "1/8", period=period) for state, period in zip(states, periods, strict=True)]
    assert [one == "closed" for one in found.outcome] == [one is not None for one in wanted]
    assert sum(one is None for one in wanted) == 3  # of twice the period, near to where it doubles
    for k, one in enumerate(wanted):
        if one is not None:
            assert found[found.orbit[k]].period == pytest.approx(one.period, rel=1e-11)
    for number, orbit in enumerate(found):
        some = wanted[::every]
        near = [one is not None and distance((orbit.start, orbit.period), one.start) < 1e-5 for one in some]
        np.testing.assert_array_equal(near, found.orbit[::every] == number)
        first = wanted[first_of(found)[number]]
        np.testing.assert_array_equal(first.start, orbit.start)
        np.testing.assert_array_equal(first.multipliers, orbit.multipliers)


def first_of(found):
    """The guesses that come first in their own order among those of one orbit."""
    states, periods = hundred()
    order = np.lexsort((*states.T[::-1], periods))
    return [order[np.argmax(found.orbit[order] == k)] for k in range(len(found))]


@pytest.mark.thorough
def test_the_order_of_guesses_does_not_matter():
    states, periods = hundred()
    order = np.random.default_rng(1).permutation(100)
    other = from_guesses(HENON, "1/8", states[order], periods[order], threads=1)
    np.testing.assert_array_equal(other.orbit, led().orbit[order])
    for one, same in zip(led(), other, strict=True):
        np.testing.assert_array_equal(one.start, same.start)
        np.testing.assert_array_equal(one.multipliers, same.multipliers)


@pytest.mark.thorough
@pytest.mark.parametrize("n", [1, 7, 40])
def test_some_guesses_lead_where_they_do_among_all(n):
    some = np.random.default_rng(n).permutation(100)[:n]
    found = from_guesses(HENON, "1/8", *(one[some] for one in hundred()))
    np.testing.assert_array_equal(found.outcome, led().outcome[some])
    for k, mine in enumerate(found.orbit):
        whole = led()[led().orbit[some[k]]]
        assert found[mine].period == pytest.approx(whole.period, rel=1e-12)
        assert distance((whole.start, whole.period), found[mine].start) < 1e-5


def test_each_is_made_of_as_many_segments_as_it_needs():
    """Neighbours of the orbit above a saddle grow 536 times, those of a small oscillation not at all."""
    saddle = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10")
    states, periods = [[3.1, 0, 0, 0.4], [0.01, 2, 0, 0.3]], [6.3, 6.3]
    found = from_guesses(saddle, "1.1", states, periods)
    for k, state in enumerate(states):
        one = lp.orbits.periodic_orbit(saddle, state, period=6.3, energy="1.1")
        assert found[found.orbit[k]].n_segments == one.n_segments == 2 - k
        np.testing.assert_array_equal(found[found.orbit[k]].start, one.start)


BAD = {
    "at rest": ([0, 0, 0, 0], 6.3),
    "not closed": ([3, 3, 3, 3], 50.0),  # it escapes
}


@pytest.mark.parametrize("outcome", BAD)
def test_a_guess_that_fails_does_not_stop_the_others(outcome):
    states, periods = (one[:3] for one in hundred())
    state, period = BAD[outcome]
    found = from_guesses(HENON, "1/8", [*states, state], [*periods, period])
    alone = from_guesses(HENON, "1/8", states, periods)
    assert found.outcome.tolist() == [*alone.outcome, outcome]
    assert found.orbit.tolist() == [*alone.orbit, -1]
    assert "found from 4 guesses, of which 3 lead to one" in repr(found)
    for one, other in zip(found, alone, strict=True):
        np.testing.assert_array_equal(one.start, other.start)


def test_states_without_a_value_of_the_hamiltonian_do_not_stop_the_others():
    found = from_guesses(ROOT, 2, [[-1, 0], [1, 1.2], [0.01, -5], [1.7, 0]], 4.0)
    assert found.outcome.tolist() == ["off the level", "closed", "off the level", "closed"]
    assert found.orbit.tolist() == [-1, 0, -1, 0]


def test_no_state_has_an_energy_below_the_least():
    found = from_guesses(PENDULUM, -3, [[1, 0], [0.5, 0.5]], 6.5)
    assert found.outcome.tolist() == ["off the level"] * 2
    assert (len(found), found.orbit.tolist()) == (0, [-1, -1])
    assert repr(found).startswith("No periodic orbits of")


def test_orbits_of_a_family_are_different_ones():
    """Each state of two equal oscillators is on a circle of its own."""
    states = np.random.default_rng(3).standard_normal((5, 4))
    half, quarter = -states[:2], np.roll(states[:2], 2, axis=1) * [1, 1, -1, -1]
    found = from_guesses(OSCILLATORS, 2, [*states, *half, *quarter], 6.28)
    assert found.orbit[5:].tolist() == [*found.orbit[:2], *found.orbit[:2]]
    assert sorted(found.orbit[:5]) == [*range(5)]
    assert not any(one.is_isolated for one in found)
    np.testing.assert_allclose([one.period for one in found], 2 * np.pi, rtol=1e-12)


def test_relative_orbits_that_are_turned_are_the_same():
    """About the axis of the Lagrange top, along which l3 is held."""
    top = lp.catalog.system("lagrange")
    start = lp.sample_states(top, 1, seed=3)[0]
    later = lp.integrate(top, start, times=[0, 1.3]).state[0, 1]
    c, s = np.cos(2), np.sin(2)
    turned = np.kron(np.eye(2), [[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ later
    leaf, energy = lp.Leaf.through(top, start), float(top.functions.energy(start))
    single = lp.orbits.periodic_orbit(top, start, period=3, momenta=["l3"])
    found = from_guesses(top, energy, [start, turned, later], [3, 3, 2 * single.period], leaf, momenta={"l3": start[2]})
    assert found.orbit.tolist() == [0, 0, 0]
    assert found[0].period == pytest.approx(single.period, rel=1e-12)


def test_orbits_that_were_found_lead_to_those_of_another_level():
    known = lp.orbits.symmetric_periodic_orbits(HENON, {}, "1/10", n_starts=20)
    found = lp.orbits.periodic_orbits(HENON, {}, "11/100", guesses=known)
    wanted = [single(one, "11/100") for one in known]
    assert sum(one is not None for one in wanted) >= 4
    assert [k >= 0 for k in found.orbit] == [one is not None for one in wanted]
    periods = [found[k].period for k in found.orbit if k >= 0]
    assert periods == pytest.approx([one.period for one in wanted if one is not None], rel=1e-12)
    again = lp.orbits.periodic_orbits(HENON, {}, "11/100", guesses=found)
    assert again.orbit.tolist() == [*range(len(found))]
    assert lp.orbits.periodic_orbits(HENON, {}, "11/100", guesses=found[0]).orbit.tolist() == [0]


def test_states_may_have_labels():
    states, periods = (one[:4] for one in hundred())
    names = HENON.component_names
    wanted = from_guesses(HENON, "1/8", states, periods)
    by_name = from_guesses(HENON, "1/8", dict(zip(names[::-1], states.T[::-1], strict=True)), periods)
    one = from_guesses(HENON, "1/8", states[0], periods[0])
    np.testing.assert_array_equal(by_name.orbit, wanted.orbit)
    assert one.orbit.tolist() == [0]


def test_the_time_limit_leaves_guesses_as_they_are():
    states, periods = hundred()
    found = from_guesses(HENON, "1/8", np.tile(states, (20, 1)), np.tile(periods, 20) * 50, time_limit=0.3)
    assert found.is_cut_short
    assert "time limit" in found.outcome
    assert (found.orbit[found.outcome == "time limit"] == -1).all()


def test_what_was_led_to_comes_back_from_a_file(tmp_path):
    states, periods = (one[:4] for one in hundred())
    found = from_guesses(HENON, "1/8", [*states, [0, 0, 0, 0]], [*periods, 6])
    again = lp.load(found.save(tmp_path / "found.nc"))
    assert repr(again) == repr(found)
    for name in ("orbit", "outcome"):
        mine, other = (getattr(one, name) for one in (found, again))
        assert mine.dtype == other.dtype
        np.testing.assert_array_equal(mine, other)
        assert not mine.flags.writeable


REST = lp.phase_space.equilibrium(PENDULUM, [0, 0])
REFUSED = (
    ({"guesses": [[1, 0, 0]], "periods": 6}, lp.errors.ShapeError, r"guesses must have shape \(2,\) or"),
    ({"guesses": np.zeros((2, 2, 2)), "periods": 6}, lp.errors.ShapeError, "guesses must have shape"),
    ({"guesses": np.zeros((0, 2)), "periods": 6}, lp.errors.ParameterError, "one state or more; got none"),
    ({"guesses": [], "periods": 6}, lp.errors.LiePoissonError, "guesses"),
    ({"guesses": [[1, 0]]}, lp.errors.ParameterError, "periods: wanted those of the guesses"),
    ({"periods": 6}, lp.errors.ParameterError, "got none of these"),
    ({"guesses": [[1, 0]], "periods": [6, 6]}, lp.errors.ShapeError, r"\(\) or \(1,\); got shape \(2,\)"),
    ({"guesses": [[1, 0], [0, 1]], "periods": [6, 0]}, lp.errors.ParameterError, "got 0.0 for guess 1"),
    ({"guesses": [[1, 0], [0, 1]], "periods": [-6, 6]}, lp.errors.ParameterError, "got -6.0 for guess 0"),
    ({"guesses": [[1, 0]], "periods": np.nan}, lp.errors.ParameterError, "got nan for guess 0"),
    ({"guesses": [[1, 0]], "periods": np.inf}, lp.errors.ParameterError, "got inf for guess 0"),
    ({"guesses": [[1, 0]], "periods": 1e-320}, lp.errors.ParameterError, "for guess 0"),
    ({"guesses": [[1, 0]], "periods": "x"}, lp.errors.LiePoissonError, "periods"),
    ({"guesses": [[1, 0]], "periods": True}, lp.errors.ParameterError, "periods"),
    ({"guesses": [[1, np.nan]], "periods": 6}, lp.errors.ParameterError, "guesses: wanted finite numbers"),
    ({"guesses": REST, "periods": 6}, lp.errors.ParameterError, "guesses: .* got an equilibrium.*orbit_family"),
    ({"guesses": [REST], "periods": 6}, lp.errors.ParameterError, "got an equilibrium"),
    ({"guesses": lp.equilibria(PENDULUM, {}), "periods": 6}, lp.errors.ParameterError, "got an equilibrium"),
    ({"guesses": [[1, 0]], "periods": 6, "n_starts": 5}, lp.errors.ParameterError, "those of a search"),
    ({"guesses": [[1, 0]], "periods": 6, "t_end": 5}, lp.errors.ParameterError, "those of a search"),
    ({"guesses": "x", "periods": 6}, lp.errors.LiePoissonError, "guesses"),
    ({"guesses": {"q9": 1}, "periods": 6}, lp.errors.ParameterError, "guesses must name"),
    ({"guesses": [[1, 0]], "periods": 6, "momenta": ["p1"]}, lp.errors.ParameterError, "momenta"),
)  # fmt: skip


@pytest.mark.parametrize(("given", "kind", "words"), REFUSED)
def test_what_is_refused(given, kind, words):
    with pytest.raises(kind, match=words):
        lp.orbits.periodic_orbits(PENDULUM, {}, 0, **given)
