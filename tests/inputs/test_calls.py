"""Wrong calls are explained, and runs draw a bar where somebody watches."""

import inspect
import io
import threading
from types import ModuleType

import pytest

import liepoisson as lp
from liepoisson.errors import MemoryLimitError, ParameterError
from liepoisson.inputs import calls

TOP = lp.Top.kovalevskaya()
X = lp.sample_states(TOP, 2, seed=1)


def test_a_type_error_from_inside_is_not_hidden():
    @calls.explains_its_arguments
    def inner():
        return "a" + 1

    with pytest.raises(TypeError, match="can only concatenate"):
        inner()


def test_signatures_are_those_of_the_functions():
    assert list(inspect.signature(lp.integrate).parameters)[:4] == ["system", "starts", "times", "t_end"]
    assert list(inspect.signature(lp.Top).parameters) == ["inertia", "a", "b", "epsilon", "name"]


class Terminal(io.StringIO):
    def isatty(self):
        return True


@calls.shows_progress
def run(*, progress=None):
    """A run of one part."""
    for done in (0.5, 1.0):
        if progress is not None:
            progress(done)
    return progress


@calls.shows_progress
def whole(*, progress=None):
    """A run that begins with another one, of which nothing is shown."""
    assert run() is None
    return run(progress=progress)


@pytest.fixture
def terminal(monkeypatch):
    """Makes standard error a terminal, with bars from the first moment on."""
    monkeypatch.delenv(calls.OFF, raising=False)
    monkeypatch.setattr(calls, "FIRST", 0.0)
    monkeypatch.setattr(calls, "NEXT", 0.0)

    def made():  # not before the test is called, as pytest captures each phase anew
        stream = Terminal()
        monkeypatch.setattr("sys.stderr", stream)
        return stream

    return made


def test_a_bar_is_drawn_on_a_terminal_and_erased(terminal):
    stream = terminal()
    whole()
    shown = stream.getvalue()
    assert "whole  50% [==========          ]" in shown
    assert "whole 100% [====================]" in shown
    assert "run" not in shown  # one bar, that of the whole
    assert shown.endswith(" \r")


def test_every_run_of_some_length_has_a_bar(terminal):
    stream = terminal()
    lp.finite_time_exponents(TOP, X, t_end=1e7, time_limit=1.5)
    assert "finite_time_exponents" in stream.getvalue()


def test_nothing_is_drawn_where_nobody_watches(terminal, monkeypatch):
    stream, heard = terminal(), []
    whole(progress=heard.append)
    thread = threading.Thread(target=whole)
    thread.start()
    thread.join()
    monkeypatch.setenv(calls.OFF, "0")
    whole()
    assert (stream.getvalue(), heard) == ("", [0.5, 1.0])
    monkeypatch.delenv(calls.OFF)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    assert not calls.is_watched()


def test_the_bar_says_what_is_left(terminal, monkeypatch):
    stream, now = terminal(), [0.0]
    monkeypatch.setattr(calls.clock, "monotonic", lambda: now[0])
    bar = calls.Bar("section")
    now[0] = 60.0
    bar.draw(0.25)
    assert stream.getvalue() == "\rsection  25% [=====               ] 3:00 left"


SWEEP = {"system": "kovalevskaya", "axes": {"energy": [1, 2, 3]}, "n_starts": 2, "points_per_piece": 1, "threads": 1}
RUNS = {
    "integrate": lambda **more: lp.integrate(TOP, X, t_end=1, **more),
    "finite_time_exponents": lambda **more: lp.finite_time_exponents(TOP, X, t_end=1, **more),
    "section": lambda **more: lp.section(TOP, X, surface="l1", t_end=1, **more),
    "decide": lambda **more: lp.decide(TOP, X, t_end=20, **more),
    "sweep": lambda **more: lp.sweep(**SWEEP, refine={"levels": 2, "difference": 1e-9}, t_end=5, **more),
}


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_progress_is_a_fraction_that_rises_to_one(run):
    heard = []
    run(progress=heard.append)
    assert heard == sorted(heard)
    assert heard[0] >= 0
    assert heard[-1] == 1
    assert heard.count(1) == 1
    for wrong in (True, "bar"):
        with pytest.raises(ParameterError, match=r"progress: wanted a function of the fraction.*leave it out"):
            run(progress=wrong)


def public_callables():
    """Functions and classes for users, by name; results are made by functions, and records by their class."""
    chapters = {name: module for name in lp.__all__ if isinstance(module := getattr(lp, name), ModuleType)}
    for chapter, module in {"": lp, **chapters}.items():
        for name in module.__all__:
            value = getattr(module, name)
            if isinstance(value, ModuleType) or not callable(value) or chapter in {"errors", "results"}:
                continue
            if not (isinstance(value, type) and issubclass(value, (tuple, lp.results.Result))):
                yield f"{chapter}.{name}".lstrip("."), value


def test_every_public_function_explains_its_arguments():
    for name, function in public_callables():
        with pytest.raises(ParameterError, match=r"no_such_argument|takes no argument"):
            pytest.fail(f"{name} returned {function(no_such_argument=1)}")


def test_a_warning_points_to_the_line_of_the_user():
    with pytest.warns(lp.errors.SurfaceWarning) as caught:
        lp.section(TOP, [0, 0, 1, 0, 0, 0, 0, 0, 0], surface="l1", t_end=10)
    assert {one.filename for one in caught} == {__file__}


def test_what_no_function_takes_is_named_also_inside_a_list():
    top = lp.Top.kovalevskaya()
    for given in ([["l1"]], [[["l1"]]], ["l1"]):
        with pytest.raises(ParameterError, match="function"):
            top.function_tape(given)
    for given in ([["x"]], ["x"], None):
        with pytest.raises(ParameterError, match="v must be a number"):
            lp.charts.LeafConstants(epsilon=1, v=given, w=1, eta=1)
    assert str(lp.charts.LeafConstants(epsilon=1, v="1/2", w=2, eta="k").casimirs) == "(k + 1/4, 1, 4)"


def test_what_does_not_fit_into_memory_is_refused_by_name():
    """Whatever the function: NumPy's error becomes one of liepoisson."""

    @calls.explains_its_arguments
    def takes_all(n):
        raise MemoryError(f"Unable to allocate {n} TiB for an array with shape (9,).")

    with pytest.raises(MemoryLimitError, match=r"takes_all: wanted what fits into memory; Unable to allocate 7 TiB"):
        takes_all(7)
