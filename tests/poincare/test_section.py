"""Sections: crossings lie on the surface and on the levels of the integrals; none is missed, none is counted twice."""

import warnings
from time import perf_counter

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.compile.field import TapeFunction, TopField
from liepoisson.compile.lowering import quadratic_of_equations, tape_of_equations
from liepoisson.errors import DamagedFileError, ExpressionError, ParameterError, ShapeError, SurfaceWarning

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


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-11])
def test_a_pair_of_close_crossings_in_one_step_is_not_missed(depth):
    """l1 exceeds its largest value less `depth` twice in each period, sqrt(2 depth/0.5) apart in phase."""
    found = lp.section(FREE, free_start(), surface=f"l1 - {0.5 - depth!r}", t_end=200)
    first = (np.arccos(1 - depth / 0.5) - 0.3) / PRECESSION
    periods = np.arange(1, 1 + int((200 * PRECESSION + 0.3) / (2 * np.pi)))
    wanted = (2 * np.pi * periods - 0.3) / PRECESSION
    half = first + 0.3 / PRECESSION
    exact = np.stack([wanted - half, wanted + half], axis=1).ravel()
    # a time is as uncertain as round-off over the slope at the surface
    np.testing.assert_allclose(found.time, exact, atol=1e-13 * 200 + 1e-15 / np.sqrt(depth))
    assert list(found.sign) == [1, -1] * len(periods)


def test_a_tangency_is_a_touch_and_not_decided():
    found = lp.section(FREE, free_start(), surface="l1 - 0.5", t_end=100)
    maxima = (2 * np.pi * np.arange(1, 1 + int((100 * PRECESSION + 0.3) / (2 * np.pi))) - 0.3) / PRECESSION
    decided = len(found.time)
    assert decided + len(found.touch_time) >= len(maxima), "each maximum is a touch, or a pair of crossings"
    for time in np.concatenate([found.time, found.touch_time]):
        assert np.abs(maxima - time).min() < 1e-6
    assert np.abs(found.touch_state[:, 0] - 0.5).max() < 1e-13


def test_an_orbit_far_from_the_surface_has_no_crossings_and_no_touches():
    found = lp.section(FREE, free_start(), surface="l1 - 0.51", t_end=100)
    assert found.state.shape == (0, 9)
    assert not len(found.touch_time)
    assert list(found.outcome) == ["finished"]
    assert list(found.count) == [0]


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
        ((2, 2, 1), (-1, 0, "-1/10"), "(l1**2/4 - l2**2/4 + alpha1)**2 + (l1*l2/2 + alpha2)**2", "l3"),
        ((1, "11/10", "1/2"), (0, 0, 1), "l3", "l1"),
        ((1, 1, "1/2"), ("1/10", 0, 1), "l3", "l1"),
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


def test_the_perturbed_controls_differ_in_the_parameter_alone():
    """With the parameters of the integrable top the control's own function is constant on the same starts."""
    top, x0 = (
        lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0)),
        np.pad(lp.sample_states(KOVALEVSKAYA, 6, seed=2), ((0, 0), (0, 3))),
    )
    found = lp.section(top, x0, surface="l3", t_end=300)
    function = top.functions.of("(l1**2/4 - l2**2/4 + alpha1)**2 + (l1*l2/2 + alpha2)**2")
    assert np.abs(function(found.state) - function(x0)[found.trajectory]).max() < LEVEL


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


def test_a_start_on_the_surface_is_not_counted():
    x0 = lp.sample_states(KOVALEVSKAYA, 4, seed=1)
    first = lp.section(KOVALEVSKAYA, x0, surface="l3", t_end=100)
    again = lp.section(KOVALEVSKAYA, first.of(0)[0], surface="l3", t_end=100 - first.time[0])
    assert len(again.time) == first.count[0] - 1
    np.testing.assert_allclose(again.time + first.time[0], first.time[1 : first.count[0]], atol=1e-10)


def test_a_trajectory_ends_after_the_number_of_crossings_that_is_wanted():
    x0 = lp.sample_states(TWISTED, 3, seed=1)
    some = lp.section(TWISTED, x0, surface="l3", t_end=1e9, n_crossings=7)
    assert list(some.count) == [7, 7, 7]
    assert list(some.outcome) == ["finished"] * 3
    assert some.end_time.max() < 1e3
    assert np.array_equal(some.of(1), some.state[7:14])


def test_a_trajectory_ends_beside_the_last_crossing_that_is_wanted():
    x0 = lp.sample_states(TWISTED, 3, seed=1)
    for n in (1, 4):
        some = lp.section(TWISTED, x0, surface="l3", t_end=1e9, n_crossings=n)
        last = some.time[n - 1 :: n]
        assert (some.end_time >= last).all()
        np.testing.assert_allclose(some.end_time, last, rtol=0, atol=1e-12)
        assert np.array_equal(some.end_side, some.sign[n - 1 :: n])
        assert np.array_equal(np.sign(some.end_state[:, 2]), some.end_side)


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


def test_a_crossing_at_the_end_of_a_run_is_counted_once_by_what_goes_on():
    oscillator = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2")
    for m in range(1, 13):
        for offset in (0, 1e-16, -1e-15, 1e-14, -1e-14, 1e-13, -1e-13, 1e-12, -1e-12):
            first = lp.section(oscillator, [0, 1], surface="q1", t_end=m * np.pi + offset)
            again = first.go_on(t_end=1)
            assert len(first.time) + len(again.time) == m, (m, offset)
            assert len(again.touch_time) == 0


def test_the_side_before_the_start_decides_whether_a_start_on_the_surface_crosses_it(tmp_path):
    oscillator = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2")
    starts = [[0, 1], [0, 1], [0, 1]]
    found = lp.section(oscillator, starts, surface="q1", t_end=1, start_side=[-1, 0, 1])
    assert list(found.trajectory) == [0]
    assert found.time == pytest.approx([0], abs=1e-14)
    assert list(found.end_side) == [1, 1, 1]
    again = lp.rerun(lp.load(found.save(tmp_path / "sides.nc")))
    assert np.array_equal(again.time, found.time)
    assert np.array_equal(again.start_side, [-1, 0, 1])
    with pytest.raises(ParameterError, match="start_side"):
        lp.section(oscillator, starts, surface="q1", t_end=1, start_side=2)
    with pytest.raises(ShapeError, match="start_side"):
        lp.section(oscillator, starts, surface="q1", t_end=1, start_side=[1, 1])


UNITS = (1.0, 1e-2, 1e-3, 1e-6, 1e-13, 1e-14, 1e-15, 1e-20, 1e-34, 1e-200, 1e14, 1e100)
"""Sizes of one component beside another of size one."""


@pytest.mark.parametrize("hamiltonian", ["p1^2/(2*{u}) + {u}*q1^2/2", "p1^2/(2*{u}) - {u}*cos(q1)"])
@pytest.mark.parametrize("surface", ["p1", "p1^3 + p1*{u}^2", "q1"])
def test_sections_do_not_depend_on_the_unit_of_one_component(hamiltonian, surface):
    def crossings(u):
        system = lp.System(lp.canonical(1), hamiltonian.format(u=repr(u)))
        found = lp.section(system, [1.0, 0.3 * u], surface=surface.format(u=repr(u)), t_end=60)
        assert (len(found.touch_time), found.seen_to[0]) == (0, 60)
        return found.time

    wanted = crossings(1.0)
    assert len(wanted) > 15
    for u in UNITS if surface != "p1^3 + p1*{u}^2" else [u for u in UNITS if 1e-90 < u < 1e90]:
        np.testing.assert_allclose(crossings(u), wanted, rtol=0, atol=1e-12, err_msg=f"u = {u:g}")


@pytest.mark.parametrize("u", [1e-3, 1e-14, 1e-20, 1e-34])
def test_sections_of_a_top_do_not_depend_on_the_unit_of_its_angular_momentum(u):
    def first(u):
        top = lp.Top.heavy(inertia=(2 * u, 1.5 * u, u), a=(0.6 * u, 0, 0.8 * u))
        start = (u, 2 * u, 0.5 * u, 0.6, 0, 0.8, 0, 0, 0)
        return lp.section(top, start, surface="l1", t_end=20), lp.sections.first_return(
            top, start, surface="l1", t_end=20
        )

    (found, image), (wanted, wanted_image) = first(u), first(1.0)
    np.testing.assert_allclose(found.time, wanted.time, rtol=0, atol=1e-11)
    assert float(image.time) == pytest.approx(float(wanted_image.time), abs=1e-11)
    assert float(image.time) == pytest.approx(11.75058, abs=1e-5)


@pytest.mark.parametrize("kind", ["quadratic", "tape"])
def test_round_off_of_large_terms_that_cancel_is_no_crossing(kind):
    # q'' = -q and u = 0.3 q stays so: z' = 0.3 q - u is zero but for the round-off of its terms, some 1e-17
    q, p, u, v, z = sp.symbols("q p u v z")
    make = quadratic_of_equations if kind == "quadratic" else tape_of_equations
    tenth = sp.Rational(3, 10)
    field = make((q, p, u, v, z), (p, -q, v, -u, tenth * q - u))
    surface = TapeFunction(5, (), (4,))
    with pytest.warns(SurfaceWarning, match="lies in the surface"):
        found = lp.section(field, [0.7, 0.4, 0.3 * 0.7, 0.3 * 0.4, 0], surface=surface, t_end=20)
    assert found.end_state[0, 4] != 0
    assert len(found.time) == 0


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


def test_the_bits_do_not_depend_on_the_number_of_threads():
    x0 = lp.sample_states(TWISTED, 33, seed=1)
    one, three = (lp.section(TWISTED, x0, surface="l3", t_end=30, threads=n) for n in (1, 3))
    assert np.array_equal(one.state, three.state)
    assert np.array_equal(one.time, three.time)


def test_errors_are_bounded_for_surfaces_that_are_no_polynomials_too():
    x0 = lp.sample_states(TWISTED, 2, seed=1)
    smooth = lp.section(TWISTED, x0, surface="sin(l3)", t_end=30)
    plain = lp.section(TWISTED, x0, surface="l3", t_end=30)
    assert (plain.unbounded_steps == 0).all()
    assert (smooth.unbounded_steps == 0).all()
    near = np.abs(smooth.state[:, 2]) < 1  # sin vanishes at other multiples of pi as well
    np.testing.assert_allclose(smooth.state[near], plain.state, atol=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("k", [1e3, 1e5, 1e7])
def test_surfaces_that_are_the_same_set_have_the_same_section_however_narrow_their_peak(k):
    # exp(-k (l3 - 3/10)^2) = 1/2 where k (l3 - 3/10)^2 = ln 2; the first is -1/2 to all digits on most of a step
    x0 = lp.sample_states(TWISTED, 8, seed=1)
    peak, pair = (
        lp.section(TWISTED, x0, surface=surface, t_end=100)
        for surface in (f"exp(-{k}*(l3-3/10)^2) - 1/2", f"{k}*(l3-3/10)^2 - {float(np.log(2))!r}")
    )
    assert peak.count.sum() > 400
    assert np.array_equal(peak.count, pair.count)
    np.testing.assert_allclose(peak.time, pair.time, atol=1e-9)
    assert (peak.unbounded_steps == 0).all()
    assert (peak.unseen_steps == 0).all()


def test_orbits_that_lie_in_the_surface_are_told():
    # beta = 0 stays, so a surface linear in beta holds the whole leaf of a heavy top
    heavy = lp.Top.heavy(inertia=(1.5, 1.2, 0.7), a=(0.6, 0, 0.8))
    x0 = [0.3, 0.2, 0.1, 1, 0, 0, 0, 0, 0]
    with pytest.warns(lp.errors.SurfaceWarning, match="the orbit lies in the surface .* try another"):
        found = lp.section(heavy, x0, surface=lp.sections.good_surface(heavy), t_end=30)
    assert found.count.sum() == 0


def test_a_row_that_is_not_finite_fails_alone():
    x0 = lp.sample_states(TWISTED, 3, seed=1)
    good = lp.section(TWISTED, x0, surface="l3", t_end=30)
    x0[1, 4] = np.nan
    found = lp.section(TWISTED, x0, surface="l3", t_end=30)
    assert list(found.outcome) == ["finished", "not finite", "finished"]
    assert found.count[1] == 0
    assert np.array_equal(found.of(2), good.of(2))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"surface": "l3 + nothing"}, ExpressionError, "nothing"),
        ({"surface": "l3", "direction": 2}, ParameterError, "direction"),
        ({"surface": "l3", "direction": True}, ParameterError, "direction"),
        ({"surface": "l3", "t_end": 0}, ParameterError, "t_end"),
        ({"surface": "l3", "t_end": np.inf}, ParameterError, "t_end"),
        ({"surface": "l3", "n_crossings": 0}, ParameterError, "n_crossings"),
        ({"surface": "l3", "keep": "l1"}, ParameterError, "keep"),
        ({"surface": "l3", "keep": ()}, ParameterError, "keep"),
        ({"surface": "l3", "method": lp.RungeKutta()}, ParameterError, "Taylor"),
        ({"surface": "l3", "method": lp.Taylor(precision="mixed")}, ParameterError, "double precision"),
        ({"surface": None}, ParameterError, "surface: wanted a function of the state; got None"),
        ({"surface": 3}, ParameterError, "surface: wanted a function of the state"),
        ({"surface": ["l1"]}, ParameterError, "surface: wanted a function of the state"),
        ({"surface": "0"}, ParameterError, "constant on each leaf"),
        ({"surface": "1"}, ParameterError, "constant on each leaf"),
        ({"surface": "dot(beta, beta) - 1"}, ParameterError, "its bracket with every component is zero"),
        ({"surface": "exp(dot(alpha, beta)) - 2"}, ParameterError, "its bracket with every component is zero"),
        ({"surface": "l3", "keep": [1]}, ParameterError, "keep: wanted a function"),
        ({"surface": "l3", "keep": 1}, ParameterError, "keep: wanted a sequence"),
        ({"surface": "l3", "direction": np.ones(2)}, ParameterError, "direction"),
        ({"surface": "l3", "direction": "up"}, ParameterError, "direction"),
        ({"surface": TapeFunction(3, (), (0,))}, ShapeError, "9 components"),
        ({"surface": TapeFunction(9, (), ())}, ParameterError, "one output"),
        ({"surface": TapeFunction(9, (), (0, 1)), "keep": ("a", "b")}, ParameterError, "1 further"),
    ],
)
def test_what_makes_no_sense_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        lp.section(TWISTED, lp.sample_states(TWISTED, 1, seed=1), **({"t_end": 1} | options))


def test_a_field_without_formulas_wants_a_tape():
    field = TopField((2, 2, 1), (-1, 0, 0), (0, 0, 0), 1.0)
    x0 = lp.sample_states(field, 2, seed=1)
    with pytest.raises(ParameterError, match="wanted a TapeFunction"):
        lp.section(field, x0, surface="l3", t_end=10)
    found = lp.section(field, x0, surface=TapeFunction(9, (), (2,)), t_end=30)
    assert np.array_equal(found.state, lp.section(TWISTED, x0, surface="l3", t_end=30).state)


@pytest.mark.thorough
@pytest.mark.parametrize("options", [{}, {"keep": ("alpha1", "dot(l, beta)")}, {"n_crossings": 4, "direction": -1}])
def test_a_section_is_labelled_and_repeats_from_its_file_alone(tmp_path, options):
    found = lp.section(TWISTED, lp.sample_states(TWISTED, 3, seed=1), surface="l3 - alpha2", t_end=30, **options)
    path = found.save(tmp_path / "section.nc")
    dataset, again = lp.load(path).dataset, lp.rerun(path, threads=1)
    for name in ("state", "time", "sign"):
        assert np.array_equal(dataset[name].to_numpy(), getattr(found, name))
        assert np.array_equal(getattr(again, name), getattr(found, name))
    assert np.array_equal(dataset["crossing_trajectory"], found.trajectory)
    assert tuple(map(str, dataset["coordinate" if "keep" in options else "component"].to_numpy())) == found.coordinates
    assert (again.coordinates, again.direction, again.n_crossings) == (
        found.coordinates,
        found.direction,
        found.n_crossings,
    )
    assert again.tape == found.tape


def test_an_altered_surface_is_not_rerun():
    dataset = lp.section(TWISTED, lp.sample_states(TWISTED, 1, seed=1), surface="l3", t_end=3).dataset
    dataset.attrs["tape"] = "{}"
    with pytest.raises(DamagedFileError, match="does not record a run"):
        lp.rerun(dataset)


def test_a_surface_that_cannot_be_followed_is_not_said_to_be_missed():
    """sin(10^12 l1) vanishes all the time, closer together than round-off of the state lets anybody see."""
    with pytest.warns(SurfaceWarning, match="could not be followed in .*% of the time, where crossings are not found"):
        found = lp.section(FREE, free_start(), surface="sin(10^12*l1)", t_end=3)
    assert found.unresolved_share > 0.95
    assert found.seen_to[0] < 0.01
    assert 0 < found.unseen_steps[0] <= found.n_steps[0]
    assert found.undefined_time[0] == 0
    assert "not followed in " in repr(found)


def test_a_surface_that_vanishes_below_the_smallest_numbers_is_not_one_in_which_orbits_lie():
    with pytest.warns(SurfaceWarning) as seen:
        lp.section(FREE, free_start(), surface=TapeFunction(9, (("power", (0,), (1e308,)),), (9,)), t_end=3)
    assert ["lie" in str(warning.message).split() for warning in seen] == [False]


@pytest.mark.parametrize(
    "surface",
    [
        TapeFunction(9, (("linear", (0,), (1e12, 0.0)), ("sin", (9,), ())), (10,)),
        TapeFunction(9, (("power", (0,), (1e308,)),), (9,)),
        TapeFunction(9, (("linear", (0,), (1e5, 0.0)), ("sin", (9,), ())), (10,)),
    ],
    ids=["fast", "huge power", "many crossings"],
)
def test_a_limit_of_time_holds_for_every_surface(surface):
    begin = perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SurfaceWarning)
        found = lp.section(FREE, free_start(), surface=surface, t_end=1e6, time_limit=0.3)
    # the whole run would take hours; the allowance is for a machine with other work
    assert perf_counter() - begin < 3
    assert list(found.outcome) == ["time limit"]
    assert 0 < found.end_time[0] < 1e6
    assert found.seen_to[0] <= found.end_time[0]
    assert (found.time <= found.end_time[0]).all()


def test_a_section_goes_on_from_where_it_ended():
    starts = lp.sample_states(TWISTED, 2, seed=1)
    first = lp.section(TWISTED, starts, surface="l3", t_end=20)
    whole = lp.section(TWISTED, starts, surface="l3", t_end=40)
    again = first.go_on(t_end=20)
    assert again.surface == "l3"
    for k in range(2):
        late = whole.of(k)[len(first.of(k)) :]
        assert np.abs(again.of(k) - late).max() < 1e-9
        assert len(late) > 3


@pytest.mark.parametrize("side", [1, -1])
def test_a_start_far_from_the_surface_crosses_nothing_whatever_side_is_given(side):
    oscillator = lp.System(lp.canonical(1), "(q1^2 + p1^2)/2")
    found = lp.section(oscillator, [1.0, 0.0], surface="q1", t_end=3 * np.pi, start_side=side)
    np.testing.assert_allclose(found.time, [np.pi / 2, 3 * np.pi / 2, 5 * np.pi / 2])


def test_going_on_with_another_surface_starts_on_no_side_of_it():
    oscillator = lp.System(lp.canonical(1), "(q1^2 + p1^2)/2")
    first = lp.section(oscillator, [1.0, 0.0], surface="q1", t_end=np.pi)
    further = first.go_on(t_end=2 * np.pi, surface="p1 - 1/2")
    assert np.array_equal(
        further.state, lp.section(oscillator, first.end_state, surface="p1 - 1/2", t_end=2 * np.pi).state
    )
    with pytest.raises(ParameterError, match="other arguments than starts"):
        first.go_on(t_end=1, starts=[1.0, 0.0])


@pytest.mark.parametrize("piece", [1, 2, 3, 100])
def test_points_out_of_order_are_found_wherever_they_are(monkeypatch, piece):
    """Points are looked at in pieces: two neighbours that change places are found in a piece and between two."""
    from liepoisson.poincare import section

    monkeypatch.setattr(section, "_PIECE", piece)
    trajectory, time = np.repeat([0, 1, 2], [4, 0, 5])[:8], np.array([1.0, 2, 2, 3, -0.5, -1, -2, -3])
    trajectory[4:] = [1, 1, 2, 2]
    assert section._is_in_order_of_travel(trajectory, time)
    assert section._is_in_order_of_travel(trajectory[:0], time[:0])
    for k in [0, 2, 4, 6]:  # neighbours of one trajectory at different times
        wrong = time.copy()
        wrong[[k, k + 1]] = wrong[[k + 1, k]]
        assert not section._is_in_order_of_travel(trajectory, wrong), k


@pytest.mark.thorough
def test_making_a_section_takes_little_memory_beside_its_arrays():
    import tracemalloc

    found = lp.section(TWISTED, lp.sample_states(TWISTED, 400, seed=1), surface="l3", t_end=1e5, n_crossings=500)
    arrays = {name: getattr(found, name) for name in ("crossing_trajectory", "time", "state", "sign")}
    size = sum(array.nbytes for array in arrays.values())
    tracemalloc.start()
    try:
        type(found).__post_init__(found)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(found.time) > 150_000
    assert peak < size / 10
