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


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lp.integrate(TOP, X), "wanted times or t_end"),
        (lambda: lp.integrate(TOP, X, 10), r"write integrate\(system, starts, times=\.\.\.\)"),
        (lambda: lp.integrate(TOP, X, t=10), r"no argument 't'\. Write times or t_end\."),
        (lambda: lp.integrate(TOP, x0=X, t_end=1), r"no argument 'x0'\. Write starts\."),
        (lambda: lp.section(TOP, X, "l3", 100), r"write section\(system, starts, surface=\.\.\., t_end=\.\.\.\)"),
        (lambda: lp.section(TOP, X), "section must have surface and t_end; write section"),
        (lambda: lp.section(TOP, X, surfaces="l3", t_end=1), r"Did you mean surface\?"),
        (lambda: lp.lyapunov_exponent(TOP, X, t=100), r"Write t_end\."),
        (
            lambda: lp.lyapunov_spectrum(TOP, X),
            r"must have t_end; write lyapunov_spectrum\(system, starts, t_end=\.\.\.\)",
        ),
        (lambda: lp.sample_states(TOP, n=3), r"Write n_starts\."),
        (lambda: lp.Leaf(TOP), r"Leaf must have casimirs; write Leaf\(system, casimirs\)"),
        (lambda: lp.equilibria(TOP), "equilibria must have leaf"),
        (lambda: lp.Top(I=(1, 1, 1)), r"Top has no argument 'I'\. Write inertia\."),
        (lambda: lp.Top((1, 1, 1)), r"Top takes nothing by place, and got 1 values; write Top\(inertia=\.\.\.\)"),
        (lambda: lp.System(lp.so(3) @ lp.trivial(), hamiltonain="l3"), "Did you mean hamiltonian"),
        (lambda: lp.Taylor(toll=1e-9), "Taylor has no argument 'toll'. Did you mean tol"),
    ],
)
def test_a_wrong_call_says_how_it_is_written(call, words):
    with pytest.raises(ParameterError, match=words):
        call()


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


def test_a_sweep_has_a_bar(terminal):
    stream = terminal()
    lp.sweep(system="kovalevskaya", axes={"energy": [1, 2, 3]}, n_starts=2, t_end=5, points_per_piece=1)
    assert "sweep  33% [" in stream.getvalue()


def test_the_bar_says_what_is_left(terminal, monkeypatch):
    stream, now = terminal(), [0.0]
    monkeypatch.setattr(calls.clock, "monotonic", lambda: now[0])
    bar = calls.Bar("section")
    now[0] = 60.0
    bar.draw(0.25)
    assert stream.getvalue() == "\rsection  25% [=====               ] 3:00 left"


RUNS = {
    "integrate": lambda **more: lp.integrate(TOP, X, t_end=1, **more),
    "finite_time_exponents": lambda **more: lp.finite_time_exponents(TOP, X, t_end=1, **more),
    "section": lambda **more: lp.section(TOP, X, surface="l1", t_end=1, **more),
    "decide": lambda **more: lp.decide(TOP, X, t_end=20, **more),
    "sweep": lambda **more: lp.sweep(
        system="kovalevskaya",
        axes={"energy": [1, 2, 3]},
        refine={"levels": 2, "difference": 1e-9},
        n_starts=2,
        t_end=5,
        points_per_piece=1,
        threads=1,
        **more,
    ),
}


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_progress_is_a_fraction_that_rises_to_one(run):
    heard = []
    run(progress=heard.append)
    assert heard == sorted(heard)
    assert heard[0] >= 0
    assert heard[-1] == 1
    assert heard.count(1) == 1


def test_a_refined_sweep_tells_of_each_level():
    heard = []
    RUNS["sweep"](progress=heard.append)
    assert heard[:3] == pytest.approx([1 / 9, 2 / 9, 3 / 9])


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
@pytest.mark.parametrize("wrong", [True, False, 3, "bar"])
def test_progress_that_is_no_function_is_refused(run, wrong):
    with pytest.raises(lp.errors.ParameterError, match=r"progress: wanted a function of the fraction.*leave it out"):
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


PUBLIC = dict(public_callables())


@pytest.mark.parametrize("function", PUBLIC.values(), ids=PUBLIC)
def test_every_public_function_explains_its_arguments(function):
    with pytest.raises(ParameterError, match=r"no_such_argument|takes no argument"):
        function(no_such_argument=1)


BRACKET = lp.so(3) @ lp.semidirect(2)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: BRACKET("l1"), r"bracket must have g; write bracket\(f, g\)"),
        (lambda: BRACKET.rename(names=("m", "p")), "Bracket.rename has no argument 'names'"),
        (lambda: lp.LieAlgebra.from_brackets(3), r"must have brackets; write LieAlgebra\.from_brackets\(n, brackets\)"),
        (lambda: lp.Leaf.through(TOP), r"must have state; write Leaf\.through\(system, state\)"),
        (lambda: TOP.vector_field(X, 0.0), r"write Top\.vector_field|write System\.vector_field\(states\)"),
        (lambda: lp.trivial(3), r"trivial takes nothing by place"),
    ],
)
def test_methods_explain_their_arguments_too(call, words):
    with pytest.raises(ParameterError, match=words):
        call()


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


def test_what_does_not_fit_into_memory_is_refused_by_name(monkeypatch):
    """Whatever the function: NumPy's error becomes one of liepoisson."""
    from liepoisson.inputs.calls import explains_its_arguments

    @explains_its_arguments
    def takes_all(n):
        raise MemoryError(f"Unable to allocate {n} TiB for an array with shape (9,).")

    with pytest.raises(MemoryLimitError, match=r"takes_all: wanted what fits into memory; Unable to allocate 7 TiB"):
        takes_all(7)
