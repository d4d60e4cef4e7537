"""Enclosures of flows and section maps contain what other code computes with thirty digits, and closed solutions."""

import functools
import math
import random

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

import liepoisson as lp
from liepoisson import _core
from liepoisson.errors import EnclosureError, ExpressionError, ParameterError, ShapeError
from liepoisson.orbits.precise_flow import PreciseFlow, bits
from liepoisson.proofs.box import Box
from liepoisson.proofs.polynomial_field import field_of_formulas

DIGITS = 30
ARITHMETICS = ("intervals", "balls")
LORENZ = field_of_formulas({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"})
ROESSLER = field_of_formulas({"x": "-(y + z)", "y": "x + y/5", "z": "1/5 + z*(x - 57/10)"})
OSCILLATOR = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2", name="oscillator")


def fluid():
    """Zeitlin's truncation with nine modes; its common factor of the structure constants is taken into the time."""
    from sympy import pi, sqrt

    zeitlin = lp.catalog.system("zeitlin-3")
    return lp.System(zeitlin.bracket, zeitlin.hamiltonian * 8 * pi / (3 * sqrt(3)), name="fluid")


SYSTEMS = {
    "heavy top": lambda: (lp.catalog.system("heavy-top"), (0.3, -0.4, 1.0, 0.2, 0.5, -0.8), 1.5),
    "Henon-Heiles": lambda: (lp.catalog.system("henon-heiles"), (0.1, 0.2, 0.3, -0.1), 3.0),
    "fluid": lambda: (fluid(), (0.5, -0.25, 0.75, 1, -0.5, 0.125, 0.25, -1), 0.75),
}
WIDTH = 2.0**-17


def inside(box, values):
    """Whether numbers of thirty digits lie in a box, compared exactly."""
    with ctx.workprec(bits(DIGITS)):
        pairs = zip(box.lower.ravel().tolist(), values, box.upper.ravel().tolist(), strict=True)
        return all(bool(arb(a) <= v.mid()) and bool(v.mid() <= arb(b)) for a, v, b in pairs)


def precise(system, start, time):
    """The state and the derivative of the flow after a time."""
    n = len(start)
    with ctx.workprec(bits(DIGITS)):
        unit = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
        return PreciseFlow(system, DIGITS).end([arb(float(c)) for c in start], arb(time), unit)


@pytest.fixture(scope="module", params=SYSTEMS)
def flown(request):
    """A box, its image in both arithmetics, and the ends of orbits from its points."""
    system, center, time = SYSTEMS[request.param]()
    box = Box.around(center, WIDTH)
    rng = random.Random(request.param)
    corners = [[rng.choice((a, b, rng.uniform(a, b))) for a, b in zip(box.lower, box.upper, strict=True)] for _ in "ab"]
    ends = [precise(system, start, time) for start in corners]
    return [lp.proofs.enclose_flow(system, box, time=time, arithmetic=a) for a in ARITHMETICS], ends


def test_points_of_a_box_arrive_inside_of_its_image_and_so_do_derivatives(flown):
    found, ends = flown
    for one in found:
        assert all(inside(one.image, x) for x, _ in ends), one
        assert one.image.width.max() < 100 * WIDTH
        assert all(inside(one.derivative, v.entries()) for _, v in ends), one
        assert one.derivative.width.max() < 0.01
    # the control: half of the image does not contain all ends
    half = Box(found[0].image.midpoint, found[0].image.upper)
    assert not all(inside(half, x) for x, _ in ends)


def test_remainders_of_series_are_bounded():
    # few digits and a low order: steps are long, and what the series leave out is far above round-off
    for order in (2, 5):
        found = lp.proofs.enclose_flow(OSCILLATOR, [1, 0], time=2.5, arithmetic="balls", precision=53, order=order)
        with ctx.workprec(bits(DIGITS)):
            c, s = arb(2.5).cos(), arb(2.5).sin()
            assert inside(found.image, [c, -s])
            assert inside(found.derivative, [c, s, -s, c])
        assert found.image.width.max() > 1e-12


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_tubes_contain_the_orbit_and_cover_the_time(arithmetic):
    system, start, time = SYSTEMS["Henon-Heiles"]()
    found = lp.proofs.enclose_flow(system, start, time=time, step=0.25, arithmetic=arithmetic)
    begin, end = found.tube_times.lower[:, 0], found.tube_times.upper[:, 1]
    assert begin[0] <= 0
    assert end[-1] >= time
    assert np.all(end[:-1] >= begin[1:])
    for k in range(len(begin)):
        x, _ = precise(system, start, 0.5 * (begin[k] + end[k]))
        assert inside(found.tube[k], x)


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_points_of_a_box_cross_a_section_where_and_when_it_is_said(arithmetic):
    system = lp.catalog.system("henon-heiles")
    box = Box.around([0, 0.1, 0.3, 0.1], [0, WIDTH, WIDTH, WIDTH])
    found = lp.proofs.enclose_section_map(system, box, surface="x", direction=1, arithmetic=arithmetic)
    assert found.is_first
    assert found.image.width.max() < 10 * WIDTH
    time, x, slopes = crossing_of_a_point()
    assert arb(found.time[0]) < time < arb(found.time[1])
    assert inside(found.image, x)
    assert inside(found.derivative, slopes)
    assert arb(found.rate[0]) <= x[2].mid() <= arb(found.rate[1])


@functools.cache
def crossing_of_a_point():
    """Time, state and derivative of the section map at one point of the box above, by Newton's method for x = 0."""
    start = [0, 0.1 - 0.9 * WIDTH, 0.3 + 0.7 * WIDTH, 0.1 + 0.8 * WIDTH]
    with ctx.workprec(bits(DIGITS)):
        flow, n = PreciseFlow(lp.catalog.system("henon-heiles"), DIGITS), 4
        unit = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
        time = arb(6.418)
        for _ in range(4):
            x, v = flow.end([arb(c) for c in start], time, unit)
            time = (time - x[0] / x[2]).mid()
        rates = flow.rate(x)
        return time, x, [v[i, j] - rates[i] * v[0, j] / rates[0] for i in range(n) for j in range(n)]


def test_a_section_map_knows_whether_an_orbit_was_there_before():
    first = lp.proofs.enclose_section_map(OSCILLATOR, [1, 0], surface="q1", direction=1)
    later = lp.proofs.enclose_section_map(OSCILLATOR, [1, 0], surface="q1", direction=1, time=11.0)
    assert first.is_first
    assert not later.is_first
    with ctx.workprec(bits(DIGITS)):
        assert inside(Box(*first.time), [3 * arb.pi() / 2])
        assert inside(Box(*later.time), [7 * arb.pi() / 2])
    # the sense is that of the first crossing if none is asked for
    assert lp.proofs.enclose_section_map(OSCILLATOR, [1, 0], surface="q1").rate[1] < 0
    # orbits of a box on both sides of the section cross it at once
    box = Box.around([0, 1], [0.01, 0])
    assert not lp.proofs.enclose_section_map(OSCILLATOR, box, surface="q1", direction=1).is_first


def test_fields_that_are_not_hamiltonian_are_enclosed_too():
    found = lp.proofs.enclose_flow(LORENZ, [1, 2, 20], time=1.0)
    # power series of order 40 with 40 digits (mpmath)
    assert found.image.contains([-2.0498968837314884, -3.7058556901418383, 10.764499883240427])
    assert found.system == "a polynomial field"
    # CAPD's example: the Poincare map of Roessler's equations, printed with 17 digits
    start = [0.0, -8.3809417428298, 0.029590060630665]
    for arithmetic in ARITHMETICS:
        crossing = lp.proofs.enclose_section_map(ROESSLER, start, surface="x", direction=1, arithmetic=arithmetic)
        assert crossing.image[1:].overlaps(
            ([-8.3809417428304709, 0.029590060630664217], [-8.380941742829652, 0.029590060630669816])
        )
        assert crossing.time[0] < 5.8810884555539493
        assert crossing.time[1] > 5.8810884555538525
        middle = crossing.derivative[1:2, 1]
        assert middle.overlaps(([-2.4048455658571841], [-2.4048455658533383]))


HENON = lp.catalog.system("henon-heiles")
STATE = [0, 0.1, 0.3, 0.1]


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: flow(box=([0, 0, 0, 0.1], [1, 1, 1, 0])), ParameterError, "empty box"),
        (lambda: flow(box=[0, math.nan, 0, 0]), ParameterError, "finite numbers"),
        (lambda: flow(box=[0, 0, 0]), ShapeError, "4 components"),
        (lambda: flow(time=-1.0), ParameterError, "opposite Hamiltonian"),
        (lambda: flow(time=math.inf), ParameterError, "finite"),
        (lambda: flow(arithmetic="floats"), ParameterError, '"intervals" or "balls"'),
        (lambda: flow(order=1), ParameterError, "from 2 to 60"),
        (lambda: flow(step=0), ParameterError, "positive"),
        (lambda: flow(precision=10), ParameterError, "from 53"),
        (lambda: flow(box=Box.around(STATE, 1.0), time=20), EnclosureError, "smaller set"),
        (lambda: flow(box=Box.around(STATE, 1.0), time=20, arithmetic="balls"), EnclosureError, "smaller"),
        (lambda: flow(time=1e9, time_limit=0.05), EnclosureError, "time limit has passed"),
        (lambda: flow(time=1e9, time_limit=0.05, arithmetic="balls"), EnclosureError, "time limit"),
        (lambda: flow(system=lp.catalog.system("toda"), box=[0] * 6), ParameterError, "wanted a polynomial"),
        (lambda: flow(system=lp.catalog.system("zeitlin-3"), box=[0] * 8), ParameterError, "rational coefficients"),
        (
            lambda: flow(system=lp.catalog.system("twisted-top"), box=[0] * 9),
            ParameterError,
            "numbers for all parameters",
        ),
        (lambda: crossing(surface="x^2"), ParameterError, "degree one"),
        (lambda: crossing(surface="x*sqrt(2)"), ParameterError, "rational"),
        (lambda: crossing(surface="x +"), ExpressionError, "formula"),
        (lambda: crossing(direction=2), ParameterError, "direction"),
        (lambda: crossing(time=-1), ParameterError, "positive"),
        (lambda: crossing(time=6.418, direction=-1), EnclosureError, "direction=-1"),
        (lambda: crossing(time=0.8), EnclosureError, "crossing"),
        (lambda: crossing(time=0.8, arithmetic="balls"), EnclosureError, "crossing"),
        (lambda: crossing(box=Box.around(STATE, 0.2)), EnclosureError, "no "),
    ],
)
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error, match=words):
        call()


def flow(*, system=HENON, box=STATE, time=1.0, **more):
    return lp.proofs.enclose_flow(system, box, time=time, **more)


def crossing(*, box=STATE, surface="x", **more):
    return lp.proofs.enclose_section_map(HENON, box, surface=surface, **more)


def test_what_the_core_does_not_know_is_never_proved(monkeypatch):
    """NaN in place of a bound fails, wherever it comes from."""
    whole = _core.enclose_flow

    def unknown(*arguments):
        found = whole(*arguments)
        found["upper"][0] = math.nan
        return found

    monkeypatch.setattr(_core, "enclose_flow", unknown)
    with pytest.raises(ParameterError, match="finite"):
        flow()


def test_progress_and_interrupts_are_heard():
    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        flow(time=1e9, arithmetic="balls", progress=stop)
    heard = []
    flow(arithmetic="balls", progress=heard.append)
    assert heard == sorted(heard)
    assert heard[-1] == 1
