"""Enclosures of the compiled core: what they contain, what they refuse, and hostile arguments."""

import math
import threading
import time

import numpy as np
import pytest

from liepoisson import _core
from liepoisson.errors import EnclosureError, ParameterError, ShapeError

LORENZ = [
    [("-10", (1, 0, 0)), ("10", (0, 1, 0))],
    [("28", (1, 0, 0)), ("-1", (0, 1, 0)), ("-1", (1, 0, 1))],
    [("-8/3", (0, 0, 1)), ("1", (1, 1, 0))],
]
"""Not a Lie-Poisson system."""
OSCILLATOR = [[("1", (0, 1))], [("-1", (1, 0))]]
ENERGY = [[("1/2", (2, 0)), ("1/2", (0, 2))]]
HOW = (20, 0.05, 1e-17, 10_000)
UNIT = np.eye(3).ravel()
START = np.array([1.0, 2.0, 20.0])
NARROW = np.full(3, 1e-6)
PLANE = [("1", (0, 0, 1)), ("-27", (0, 0, 0))]
ON_ORBIT = np.array([-13.7636106821342, -19.5787519424518, 27.0])
PERIOD = 1.558652210716175
"""The shortest periodic orbit: D. Viswanath, Physica D 190 (2004) 115."""

SHORT = 0.05
"""Seconds, the limit of calls with hostile arguments."""
GOOD = {
    "flow": (_core.enclose_flow, (LORENZ, START, UNIT, -NARROW, NARROW, 0.1, HOW, True, SHORT, None)),
    "section map": (
        _core.enclose_section_map,
        (LORENZ, PLANE, ON_ORBIT, UNIT, -NARROW, NARROW, PERIOD, HOW, SHORT, None),
    ),
    "periodic orbit": (
        _core.enclose_periodic_orbit,
        (LORENZ, [], None, None, ON_ORBIT, np.array([PERIOD]), 1e-3, HOW, SHORT, None),
    ),
    "equilibria": (_core.enclose_equilibria, (LORENZ, np.full(3, -50.0), np.full(3, 50.0), 1000, SHORT, None)),
    "covering": (
        _core.check_covering_relations,
        (
            *(OSCILLATOR, ENERGY, ["1/2"], [1, -1], [[1, -1]], 1, ["a"], np.zeros(2), np.eye(2).ravel()),
            *([(0, 0, 1.0, True)], ("0", 20, 0.1, 1e-3, 0.1, 0.3, None), SHORT, None),
        ),
    ),
}
HOSTILE = [
    -1, 0, 7, 2**31, 2**62, 2**64, -1.5, 5e-324, 1e308, np.nan, np.inf, None, True, "x", b"\xff", (), [], [[]], {},
    object(), [("1", (1, 0, 0))], [[("1/0", (1, 0, 0))]] * 3, [[("1", (2**62, 0, 0))]] * 3, [[("1", (1, 0))]] * 3,
    [[("9" * 50, (1, 0, 0))]] * 3, [[("1", (20, 20, 20))]] * 3, ["1"], ["x"], [1], [1, 1, 1], [-1, -1, -1], [[1]],
    np.zeros(0), np.zeros(3), np.full(3, np.nan), np.full(3, 1e308), np.full(9, np.inf), np.zeros(9), np.zeros((3, 3)),
    (0, 0.1, None, 10), (20, -1.0, None, 10), (20, 0.1, 0.0, 10), (20, 1e-300, None, 10), (64, 1e300, 1e-300, 10),
    ("1", 20, 0.1, 1e-3, 0.1, 0.3, None), ("0", 65, 0.1, 1e-3, 0.1, 0.3, None), ("x", 20, 0.1, 1e-3, 0.1, 0.3, "0"),
    [(0, 5, 1.0, True)], [(0, 0, np.nan, False)], [(5, 0, -1.0, True)], ["a", "b"],
]  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("name", GOOD)
def test_no_argument_brings_the_core_to_a_panic(name):
    function, arguments = GOOD[name]
    refused = 0
    for place in range(len(arguments)):
        for value in HOSTILE:
            try:
                function(*arguments[:place], value, *arguments[place + 1 :])
            except (ParameterError, ShapeError, EnclosureError, TypeError, ValueError, OverflowError):
                refused += 1
    assert refused > 10 * len(arguments)


def test_a_box_of_lorenz_is_carried_along():
    found = _core.enclose_flow(LORENZ, START, UNIT, -NARROW, NARROW, 1.0, HOW, True, 60.0, None)
    # power series of order 40 with 40 digits (mpmath)
    exact = np.array([-2.0498968837314884, -3.7058556901418383, 10.764499883240427])
    assert np.all(found["lower"] < exact)
    assert np.all(exact < found["upper"])
    assert np.all(found["upper"] - found["lower"] < 3e-5)
    # the trace of the derivative of the field is -41/3
    lower, upper = (found[f"derivative_{side}"].reshape(3, 3) for side in ("lower", "upper"))
    assert np.all(lower <= upper)
    assert np.linalg.det((lower + upper) / 2) == pytest.approx(math.exp(-41 / 3), rel=1e-2)
    steps, boxes = found["n_steps"], found["tube_lower"].reshape(-1, 3)
    assert len(boxes) == len(found["tube_start"]) == steps
    assert found["tube_end"][-1] >= 1.0
    assert np.all(found["tube_end"][:-1] >= found["tube_start"][1:])


def test_the_shortest_periodic_orbit_of_lorenz_exists():
    found = _core.enclose_periodic_orbit(LORENZ, [], None, None, ON_ORBIT, np.array([PERIOD]), 1e-3, HOW, 60.0, None)
    low, high = found["period"]
    assert low < PERIOD < high
    assert high - low < 1e-11
    assert found["multipliers_alone"].all()
    assert found["multipliers_real_lower"][0] < 4.7129472734 < found["multipliers_real_upper"][0]
    assert found["multipliers_imaginary_lower"][0] == found["multipliers_imaginary_upper"][0] == 0


def test_the_equilibria_of_lorenz_are_three():
    found = _core.enclose_equilibria(LORENZ, np.full(3, -50.0), np.full(3, 50.0), 1000, 60.0, None)
    assert found["undecided_lower"].size == 0
    lower, upper = (found[side].reshape(-1, 3) for side in ("lower", "upper"))
    exact = [[0, 0, 0], [math.sqrt(72), math.sqrt(72), 27], [-math.sqrt(72), -math.sqrt(72), 27]]
    for point in exact:
        inside = np.all((lower - 1e-15 <= point) & (point <= upper + 1e-15), axis=1)
        assert inside.sum() == 1
    origin = int(np.argmin(np.abs(lower).sum(axis=1)))
    real = found["eigenvalues_real_lower"].reshape(-1, 3)[origin]
    assert np.sort(real) == pytest.approx(sorted([-8 / 3, (-11 - math.sqrt(1201)) / 2, (-11 + math.sqrt(1201)) / 2]))


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: flow(field=[[("0.1.2", (1,))]]), ParameterError, "wanted a fraction such as -1/3"),
        (lambda: flow(field=[[("1", (1, 0))]]), ShapeError, "wanted 1 exponents in each term"),
        (lambda: flow(field=[]), ParameterError, "from 1 to 256 components"),
        (lambda: flow(lower=NARROW, upper=-NARROW), ParameterError, "lower bounds that are not above the upper ones"),
        (lambda: flow(how=(1, 0.1, None, 9)), ParameterError, "order: wanted from 2 to 64; got 1"),
        (lambda: flow(how=(20, 0.1, None, 1)), EnclosureError, "no steps left"),
        (
            lambda: flow(lower=-np.full(3, 5.0), upper=np.full(3, 5.0), time=5.0),
            EnclosureError,
            "no enclosure of a step",
        ),
        (lambda: flow(time=math.inf), ParameterError, "time: wanted finite numbers"),
        (lambda: orbit(constants=[PLANE]), ParameterError, "constant along orbits, exactly"),
        (lambda: orbit(symmetry=[-1, 1, 1]), ParameterError, "symmetry: wanted signs that map orbits to orbits"),
        (lambda: orbit(times=np.array([1.3])), EnclosureError, "no"),
    ],
)
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error) as refusal:
        call()
    assert words in str(refusal.value)


def flow(*, field=LORENZ, lower=-NARROW, upper=NARROW, time=1.0, how=HOW):
    return _core.enclose_flow(field, START, UNIT, lower, upper, time, how, False, 60.0, None)


def orbit(*, constants=(), symmetry=None, times=np.array([PERIOD])):  # noqa: B008 - it is not changed
    return _core.enclose_periodic_orbit(LORENZ, list(constants), None, symmetry, ON_ORBIT, times, 1e-3, HOW, 60.0, None)


def test_ctrl_c_and_time_limits_end_a_long_flight():
    circle = (OSCILLATOR, np.array([1.0, 0.0]), np.eye(2).ravel(), np.zeros(2), np.zeros(2), 1e9)
    started = time.perf_counter()
    with pytest.raises(EnclosureError, match="time limit has passed"):
        _core.enclose_flow(*circle, (20, 1e-3, None, 2**40), False, 0.2, None)

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _core.enclose_flow(*circle, (20, 1e-3, None, 2**40), False, math.inf, stop)
    assert time.perf_counter() - started < 20
    assert threading.active_count() < 50
