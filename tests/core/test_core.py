"""The compiled core against hostile arguments: a call ends with a result, or an exception that says what was wrong."""

import dataclasses
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from liepoisson import _core
from liepoisson.errors import MemoryLimitError, ParameterError, ShapeError, UnknownNameError, UnsupportedFieldError
from liepoisson.numeric.methods import METHODS

TOP = _core.Field.top((2, 2, 1), (-1, 0, 0), (0, 0, 0), 1)
OSCILLATOR = _core.Field.quadratic(2, [], [(0, 1, 1.0), (1, 0, -1.0)], [])
TAYLOR = _core.Method("taylor", {"tol": 1e-12, "max_steps": 1000})
SPLITTING = _core.Method("splitting", {"order": 2, "step": 1e-300, "max_steps": 2**63})
"""Its steps never end."""
STATE = np.linspace(0.1, 0.9, 9)
AXIS = np.eye(9)[0]
TIMES = np.array([0.0, 1.0])
PLANE = (9, [], [2])
MATRIX = (np.array([0, 2, 3], np.uint64), np.array([0, 1, 1], np.uint32), np.array([1, 2, 3], np.uint64), 3)


def method(kind):
    """How the core makes a method from values of its options, and such values."""
    names = [option.name for option in dataclasses.fields(kind)]
    given = dataclasses.asdict(kind(**{"step": 0.1} if "step" in names else {}))
    return lambda *values: _core.Method(kind.name, dict(zip(names, values, strict=True))), tuple(given.values())


GOOD = {
    "top": (_core.Field.top, ((2, 2, 1), (-1, 0, 0), (0, 0, 0), 1)),
    "quadratic": (_core.Field.quadratic, (3, [(0, 1.0)], [(0, 1, 1.0)], [(0, 1, 2, 1.0)])),
    "tape": (_core.Field.tape, (1, [("sin", (0,), ())], [1])),
    "pieces": (_core.Field.pieces, (2, [([(0, 1.0)], [1.0], [(0, 1, 1.0)])])),
    **{name: method(kind) for name, kind in METHODS.items()},
    "orbits": (_core.orbits, (TOP, TAYLOR, STATE, STATE, 1, TIMES, 1, 0.2, True, False, None)),
    "one orbit": (_core.orbits, (TOP, TAYLOR, STATE, STATE[:0], 0, TIMES, 1, 0.2, False, True, None)),
    "growth": (_core.growth, (TOP, TAYLOR, STATE, STATE, TIMES, 1, 0.2, None)),
    "carry_frames": (
        _core.carry_frames,
        (TOP, TAYLOR, STATE, AXIS, 1, np.ones(9), np.zeros(1), 0.5, 3, 3, True, 1, 0.2, None),
    ),
    "sections": (_core.sections, (TOP, TAYLOR, PLANE, False, STATE, TIMES, 0, None, [], 1, 0.2, None)),
    "modular_null_space": (_core.modular_null_space, (*MATRIX, 101, None, 0.2, None)),
}
HOSTILE = [
    -1, 0, 7, 127, 128, 2**31, 2**62, 2**63, 2**64, 10**400, -1.5, 5e-324, 1e308, np.nan, np.inf, -np.inf,
    None, True, "x", b"\xff", (), [], [[]], {}, object(), lambda _: 1 / 0,
    (np.nan, 0, 0), [(2**62, 1.0)], [(0, 2**62, 1.0)], [(0, 0, 2**62, 1.0)], [(0, 1, 2, np.nan)], [(-1, 1.0)],
    [("sin", (2**62,), ())], [("sin", (), ())], [("power", (0,), (np.nan,))], [("no such", (), ())], [2**62],
    (2**62, [], [0]), (9, [], []), (9, [], [9]), (9, [("power", (0,), (1e308,))], [9]), (0, [], [0]),
    np.zeros(0), np.zeros(8), np.zeros(9), np.full(9, np.nan), np.full(9, 1e308), np.array([1.0, 0.0, 1.0]),
    np.zeros((3, 3)), np.zeros(18)[::2], np.zeros(9, np.float32),
    np.array([np.nan, 1.0]), np.array([0.0, np.inf]), np.array([0.0, 0.0]),
    np.array([0, 3, 3], np.uint64), np.array([2**64 - 1] * 3, np.uint64), np.array([0, 2, 2**31], np.uint32),
    TOP, OSCILLATOR, TAYLOR, SPLITTING,
]  # fmt: skip


@pytest.mark.parametrize("name", GOOD)
def test_a_good_call_has_a_result(name):
    function, arguments = GOOD[name]
    assert function(*arguments) is not None


@pytest.mark.parametrize("name", GOOD)
def test_no_argument_brings_the_core_to_a_panic(name):
    """A panic would be a `BaseException`, or a `CoreError`, and an abort the end of these tests."""
    function, arguments = GOOD[name]
    refused = 0
    for place in range(len(arguments)):
        for value in HOSTILE:
            try:
                function(*arguments[:place], value, *arguments[place + 1 :])
            except (ParameterError, ShapeError, MemoryLimitError, UnknownNameError, UnsupportedFieldError):
                refused += 1
            except (TypeError, ValueError, OverflowError):
                refused += 1  # what is no number of that kind is refused where it is read
            except ZeroDivisionError:
                pass  # of `progress`
    assert refused > 10 * len(arguments)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: _core.Field.quadratic(2**31, [], [], []), ParameterError, "1048576 components; got 2147483648"),
        (lambda: _core.Field.quadratic(2**62, [], [], []), ParameterError, "at most 1048576 components"),
        (lambda: _core.Field.tape(2**62, [], []), ParameterError, "at most 1048576 components"),
        (lambda: _core.Field.pieces(2**62, []), ParameterError, "at most 1048576 components"),
        (lambda: _core.Field.quadratic(0, [], [], []), ParameterError, "one component or more; got none"),
        (lambda: run(tangents=STATE, n_tangents=1, components=True), ParameterError, "no tangent vectors"),
        (lambda: run(field=OSCILLATOR, states=STATE[:2], components=True), ParameterError, "wanted a top, Taylor"),
        (lambda: run(states=STATE[:8]), ShapeError, "states: wanted 9 numbers; got 8"),
        (lambda: run(n_tangents=2**62), ShapeError, "tangents: wanted"),
        (lambda: run(time_limit=np.nan), ParameterError, "time_limit: wanted a positive number of seconds; got NaN"),
        (lambda: run(time_limit=-1.0), ParameterError, "time_limit: wanted a positive number of seconds; got -1"),
        (lambda: cross(direction=5), ParameterError, "direction: wanted -1, 0 or 1; got 5"),
        (lambda: cross(n_crossings=0), ParameterError, "n_crossings: wanted one or more; got 0"),
        (lambda: run(field=OSCILLATOR, method=SPLITTING), UnsupportedFieldError, "method:"),
        (lambda: _core.Field.top((2, 0, 1), (0, 0, 0), (0, 0, 0), 1), ParameterError, "three positive finite moments"),
        (lambda: _core.Field.top((2, 2, 1), (0, 0, 0), (0, 0, 0), np.nan), ParameterError, "epsilon: wanted a finite"),
        (lambda: _core.Field.tape(1, [("gamma", (0,), ())], [1]), UnknownNameError, "wanted linear, product"),
        (lambda: _core.Field.tape(1, [("sin", (), ())], [1]), ShapeError, "instruction sin: wanted 1 registers"),
        (lambda: _core.Field.tape(1, [("sin", (1,), ())], [1]), ParameterError, "wanted registers below 1; got 1"),
        (lambda: _core.Field.tape(1, [("power", (0,), (np.inf,))], [1]), ParameterError, "wanted finite numbers"),
        (lambda: _core.Field.tape(2, [], [0]), ShapeError, "outputs: wanted 2"),
        (lambda: _core.Field.tape(1, [], [1]), ParameterError, "output 0: wanted a register below 1"),
        (lambda: _core.Method("taylor", {"tol": 1.0}), ParameterError, "tol: wanted a number"),
        (lambda: _core.Method("splitting", {"order": 3, "step": 0.1}), ParameterError, "wanted 2, 4, 6 or 8; got 3"),
        (lambda: _core.Method("gauss", {"order": 3, "step": 0.1}), ParameterError, "wanted 2, 4, 6 or 8; got 3"),
        (lambda: _core.Method("gauss", {"max_steps": 9}), ParameterError, "step: wanted a positive number; got none"),
        (lambda: _core.Method("taylor", {"order": 2.5}), ParameterError, "order: wanted a whole number from 0; got"),
        (lambda: _core.Method("taylor", {"tol": "x"}), ParameterError, "tol: wanted a number; got something else"),
        (lambda: _core.Method("euler", {}), UnknownNameError, "method: wanted taylor, runge-kutta, splitting"),
        (lambda: run(method=_core.Method("lagrange-map", {"step": 0.1})), ParameterError, "wanted a top with I1 = I2"),
    ],
)  # fmt: skip
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error) as refusal:
        call()
    assert words in str(refusal.value)


def run(*, field=TOP, method=TAYLOR, states=STATE, tangents=STATE[:0], n_tangents=0, time_limit=5.0, components=False):
    return _core.orbits(field, method, states, tangents, n_tangents, TIMES, 1, time_limit, False, components, None)


def cross(*, direction=0, n_crossings=None):
    return _core.sections(TOP, TAYLOR, PLANE, False, STATE, TIMES, direction, n_crossings, [], 1, 5.0, None)


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform != "linux", reason="limits the memory of a process")
def test_what_does_not_fit_into_memory_is_refused_and_the_process_goes_on():
    """With half a GiB more than is used: too many times, too large a field, too many threads for it."""
    script = textwrap.dedent("""
        import resource
        from pathlib import Path
        import numpy as np
        from liepoisson import _core
        from liepoisson.errors import LiePoissonError, MemoryLimitError

        top = _core.Field.top((2, 2, 1), (-1, 0, 0), (0, 0, 0), 1)
        taylor = _core.Method("taylor", {"tol": 1e-12, "max_steps": 1000})
        n = 2**20  # its series needs 0.7 GB in one lane
        large = _core.Field.quadratic(n, [], [(0, 1, 1.0)], [])
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + (512 << 20), used + (512 << 20)))
        none = np.zeros(0)
        calls = [
            lambda: _core.orbits(top, taylor, np.ones(180), none, 0, np.arange(3e6), 1, 9.0, False, False, None),
            lambda: _core.growth(top, taylor, np.ones(900), np.ones(900), np.arange(3e6), 1, 9.0, None),
            lambda: _core.orbits(large, taylor, np.ones(4 * n), none, 0, np.arange(2.0), 4, 9.0, False, False, None),
        ]
        for call in calls:
            try:
                call()
            except MemoryLimitError as refusal:
                assert isinstance(refusal, MemoryError) and isinstance(refusal, LiePoissonError)
                print("refused:", refusal)
        orbit = _core.orbits(top, taylor, np.ones(9), none, 0, np.arange(2.0), 1, 9.0, False, False, None)
        print("outcome", orbit["outcome"][0])
    """)
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    lines = ended.stdout.splitlines()
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert [line.split(":")[0] for line in lines[:-1]] == ["refused"] * 3
    assert lines[-1] == "outcome 0"
