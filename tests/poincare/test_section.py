"""Sections: crossings lie on the surface and on the levels of the integrals; none is missed, none is counted twice."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import SurfaceWarning

KOVALEVSKAYA = lp.catalog.system("kovalevskaya")
TWISTED = lp.Top.twisted_kovalevskaya()
LEVEL = 1e-10
"""How far section points of an integrable top may be from the level of an integral: the acceptance of the feature."""

PRECESSION = 0.6
"""l3 (1/I3 - 1/I1) of the free symmetric body below, for l3 = 0.6."""
FREE = lp.Top(inertia=(1, 1, "1/2"), a=(0, 0, 0), name="free symmetric body")


def free_start(phase=0.3):
    """A start of l = (0.5 cos(Wt + phase), -0.5 sin(Wt + phase), 0.6), W = 0.6; alpha and beta are idle."""
    return np.array([0.5 * np.cos(phase), -0.5 * np.sin(phase), 0.6, 1, 0, 0, 0, 1, 0])


def test_crossings_of_the_free_symmetric_body_are_at_the_times_of_the_formula():
    found = lp.section(FREE, free_start(), surface="l1", t_end=100)
    # l1 = 0 where W t + 0.3 = pi/2 + k pi
    exact = (np.pi / 2 - 0.3 + np.pi * np.arange(len(found.time))) / PRECESSION
    np.testing.assert_allclose(found.time, exact, rtol=1e-13, atol=1e-13)
    assert len(found.time) == int((100 * PRECESSION + 0.3 - np.pi / 2) / np.pi) + 1
    assert list(found.sign[:4]) == [-1, 1, -1, 1]
    assert np.abs(found.state[:, 0]).max() < 1e-15


INTEGRABLE = {
    "kovalevskaya": (KOVALEVSKAYA, "l3", "K"),
    "lagrange": (lp.catalog.system("lagrange"), "l1", "l3"),
    "twisted-lagrange": (lp.catalog.system("twisted-lagrange"), "l1", "P"),
}


@pytest.mark.parametrize("name", INTEGRABLE)
def test_section_points_of_integrable_tops_lie_on_the_levels_of_their_integrals(name):
    system, surface, integral = INTEGRABLE[name]
    x0 = lp.sample_states(system, 6, seed=2)
    found = lp.section(system, x0, surface=surface, t_end=300)
    start, there = system.invariant_values(x0), system.invariant_values(found.state)
    assert len(found.time) > 300
    assert np.abs(system.functions.of(surface)(found.state)).max() < 1e-13
    for key, values in there.items():
        off = np.abs(values - start[key][found.trajectory]).max()
        assert off < LEVEL, f"{key} is off by {off:.1e}"
    assert integral in there


@pytest.mark.parametrize(
    ("inertia", "a", "integral", "surface"),
    [
        ((2, 2, "11/10"), (-1, 0, 0), "(l1**2/4 - l2**2/4 + alpha1)**2 + (l1*l2/2 + alpha2)**2", "l3"),
        ((1, "11/10", "1/2"), (0, 0, 1), "l3", "l1"),
    ],
)
def test_section_points_of_perturbed_tops_do_not(inertia, a, integral, surface):
    top = lp.Top(inertia=inertia, a=a)
    x0 = np.pad(lp.sample_states(KOVALEVSKAYA, 6, seed=2), ((0, 0), (0, 3)))
    found = lp.section(top, x0, surface=surface, t_end=300)
    function = top.functions.of(integral)
    off = np.abs(function(found.state) - function(x0)[found.trajectory])
    worst = np.array([off[found.trajectory == k].max() for k in np.flatnonzero(found.count)])
    assert len(worst) >= 4
    assert worst.min() > 1e-3, f"the integral of the integrable top changes by {worst}"


def test_signs_alternate_and_directions_divide_the_crossings():
    x0 = lp.sample_states(TWISTED, 5, seed=3)
    both, up, down = (lp.section(TWISTED, x0, surface="l3", t_end=100, direction=d) for d in (0, 1, -1))
    for k in range(5):
        signs = both.sign[both.trajectory == k]
        assert np.array_equal(signs[1:], -signs[:-1])
    assert np.array_equal(both.state[both.sign == 1], up.state)
    assert np.array_equal(both.state[both.sign == -1], down.state)


def test_backwards_the_same_crossings_come_in_the_other_direction():
    x0 = lp.sample_states(TWISTED, 1, seed=3)
    there = lp.section(TWISTED, x0, surface="l3", t_end=20)
    end = lp.integrate(TWISTED, x0, times=[0, 20]).state[0, -1]
    back = lp.section(TWISTED, end, surface="l3", t_end=-20)
    np.testing.assert_allclose(back.time[::-1] + 20, there.time, atol=1e-9)
    np.testing.assert_allclose(back.state[::-1], there.state, atol=1e-9)
    assert np.array_equal(back.sign[::-1], -there.sign)


def test_crossings_agree_with_dense_output():
    x0 = lp.sample_states(TWISTED, 2, seed=5)
    found = lp.section(TWISTED, x0, surface="dot(l, beta) - 1/10", t_end=50)
    orbit = lp.integrate(TWISTED, x0, times=[0, 50], dense=True)
    fine = np.linspace(0, 50, 20_001)
    values = TWISTED.functions.of("dot(l, beta) - 1/10")(orbit.at(fine))
    for k in range(2):
        assert found.count[k] == np.count_nonzero(np.diff(np.sign(values[k])))
        times = found.time[found.trajectory == k]
        np.testing.assert_allclose(orbit.at(times)[k], found.of(k), atol=1e-13)


def test_a_trajectory_ends_beside_the_last_crossing_that_is_wanted():
    x0 = lp.sample_states(TWISTED, 3, seed=1)
    for n in (1, 4):
        some = lp.section(TWISTED, x0, surface="l3", t_end=1e9, n_crossings=n)
        last = some.time[n - 1 :: n]
        assert (some.end_time >= last).all()
        np.testing.assert_allclose(some.end_time, last, rtol=0, atol=1e-12)
        assert np.array_equal(some.end_side, some.sign[n - 1 :: n])
        assert np.array_equal(np.sign(some.end_state[:, 2]), some.end_side)
        assert list(some.count) == [n] * 3
        assert np.array_equal(some.of(1), some.state[n : 2 * n])


def in_parts(system, start, whole, **options):
    """Times of the crossings in parts of so many, each of which goes on from the one before."""
    part = lp.section(system, start, t_end=whole.t_end, **options)
    times, begin = [], 0.0
    while True:
        times += list(begin + part.time)
        assert len(part.touch_time) == 0
        begin += part.end_time[0]
        if len(times) >= len(whole.time) or not len(part.time):
            return times
        part = part.go_on(t_end=whole.t_end - begin)


@pytest.mark.parametrize("n_crossings", [1, 3])
def test_going_on_after_a_number_of_crossings_finds_each_further_one_once(n_crossings):
    # two crossings within one step, and a hundred: the rest of the step must not be lost
    oscillator, start = lp.catalog.system("henon-heiles"), [0, 0.1, 0.5, 0.1]
    for system, begin, surface, t_end in (
        (oscillator, start, "x*y", 30),
        (KOVALEVSKAYA, lp.sample_states(KOVALEVSKAYA, 1, seed=1), "sin(400*l3)", 1.5),
    ):
        whole = lp.section(system, begin, surface=surface, t_end=t_end)
        times = in_parts(system, begin, whole, surface=surface, n_crossings=n_crossings)
        assert len(times) == len(whole.time) > 15
        np.testing.assert_allclose(times, whole.time, rtol=0, atol=1e-11)


def test_the_side_before_the_start_decides_whether_a_start_on_the_surface_crosses_it():
    oscillator = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2")
    starts = [[0, 1], [0, 1], [0, 1]]
    found = lp.section(oscillator, starts, surface="q1", t_end=1, start_side=[-1, 0, 1])
    assert list(found.trajectory) == [0]
    assert found.time == pytest.approx([0], abs=1e-14)
    assert list(found.end_side) == [1, 1, 1]


UNITS = (1e-3, 1e-14, 1e-34, 1e14)
"""Sizes of one component beside another of size one."""


@pytest.mark.parametrize(
    ("hamiltonian", "surface"),
    [
        ("p1^2/(2*{u}) + {u}*q1^2/2", "p1"),
        ("p1^2/(2*{u}) - {u}*cos(q1)", "p1^3 + p1*{u}^2"),
        ("p1^2/(2*{u}) - {u}*cos(q1)", "q1"),
    ],
)
def test_sections_do_not_depend_on_the_unit_of_one_component(hamiltonian, surface):
    def crossings(u):
        system = lp.System(lp.canonical(1), hamiltonian.format(u=repr(u)))
        found = lp.section(system, [1.0, 0.3 * u], surface=surface.format(u=repr(u)), t_end=60)
        assert (len(found.touch_time), found.seen_to[0]) == (0, 60)
        return found.time

    wanted = crossings(1.0)
    assert len(wanted) > 15
    for u in UNITS:
        np.testing.assert_allclose(crossings(u), wanted, rtol=0, atol=1e-12, err_msg=f"u = {u:g}")


def test_functions_are_kept_instead_of_states():
    x0 = lp.sample_states(TWISTED, 3, seed=1)
    whole = lp.section(TWISTED, x0, surface="l3", t_end=50)
    part = lp.section(TWISTED, x0, surface="l3", t_end=50, keep=("alpha1", "dot(l, beta)"))
    assert part.coordinates == ("alpha1", "dot(l, beta)")
    assert part.components == whole.components
    np.testing.assert_allclose(part.state[:, 0], whole.state[:, 3], atol=1e-15)
    np.testing.assert_allclose(part.state[:, 1], TWISTED.functions.of("dot(l, beta)")(whole.state), atol=1e-14)


def test_a_surface_may_be_text_expression_or_tape():
    x0, variables = lp.sample_states(TWISTED, 2, seed=1), TWISTED.variables
    text = lp.section(TWISTED, x0, surface="l3 - alpha2", t_end=30)
    expression = lp.section(TWISTED, x0, surface=variables[2] - variables[4], t_end=30)
    tape = lp.section(TWISTED, x0, surface=TWISTED.function_tape("l3 - alpha2", "l1"), t_end=30, keep=("first",))
    assert np.array_equal(text.state, expression.state)
    assert np.array_equal(text.time, tape.time)
    assert np.array_equal(text.state[:, 0], tape.state[:, 0])
    assert tape.coordinates == ("first",)
    assert text.surface == "l3 - alpha2"
    functions = TWISTED.functions
    function = lp.section(TWISTED, x0, surface=functions.of("l3 - alpha2"), t_end=30, keep=[functions.energy])
    assert np.array_equal(text.time, function.time)
    np.testing.assert_allclose(function.state[:, 0], functions.energy(text.state), atol=1e-14)


def test_a_surface_that_cannot_be_followed_is_not_said_to_be_missed():
    """sin(10^12 l1) vanishes all the time, closer together than round-off of the state lets anybody see."""
    with pytest.warns(SurfaceWarning, match="could not be followed in .*% of the time, where crossings are not found"):
        found = lp.section(FREE, free_start(), surface="sin(10^12*l1)", t_end=3)
    assert found.unresolved_share > 0.95
    assert found.seen_to[0] < 0.01
    assert 0 < found.unseen_steps[0] <= found.n_steps[0]
    assert found.undefined_time[0] == 0
