"""What functions for users have around them: errors of arguments that say what to write, and a bar where one is seen.

A wrong call would end in a bare TypeError; here it becomes a `ParameterError` with the right word.  A run without
`progress` draws a bar on standard error in a notebook and on a terminal, if it takes more than a second; in a script
whose standard error is no terminal nothing is printed.  `LIEPOISSON_PROGRESS=0` turns the bar off.
"""

from __future__ import annotations

import inspect
import os
import sys
import threading
import time as clock
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from functools import wraps
from types import FunctionType
from typing import Any, Literal, ParamSpec, TypeVar, get_origin

from liepoisson.errors import ExpressionError, LiePoissonError, MemoryLimitError, ParameterError, did_you_mean
from liepoisson.inputs.given import is_several
from liepoisson.inputs.refusals import not_a_whole_system, shown
from liepoisson.inputs.shared_words import ARGUMENTS, completed

P = ParamSpec("P")
R = TypeVar("R")
C = TypeVar("C", bound=type)

OFF = "LIEPOISSON_PROGRESS"
"""Environment variable that turns bars off if it is 0, as the command line does, which has its own."""

FIRST, NEXT = 1.0, 0.2
"""Seconds before a bar is drawn, and between two drawings."""

_WORDS = {
    "starts": {"x0", "y0", "x", "initial", "initial_state", "initial_states"},
    "times": {"t", "ts", "t_eval"},
    "t_end": {"t", "T", "t_span", "tmax", "t_max", "tf", "time", "end_time"},
    "n_starts": {"n", "size", "count", "n_orbits"},
    "method": {"tol", "rtol", "atol", "step", "dt", "order", "solver"},
    "inertia": {"I", "moments"},
    "seed": {"rng", "random_state"},
    "threads": {"n_threads", "n_jobs", "workers"},
    "time_limit": {"timeout"},
    "energy": {"E", "H"},
    "epsilon": {"eps"},
}
"""What other packages call an argument, under our word for it."""

_WRITTEN = {
    **dict.fromkeys(("tol", "rtol", "atol"), "method=liepoisson.Taylor(tol={})"),
    **dict.fromkeys(("step", "dt"), "method=liepoisson.Splitting(step={})"),
    "order": "method=liepoisson.Taylor(order={})",
}
"""How an option of a method is written where a function takes the method."""

_ELSEWHERE = {("sample_states", name): "leaf.sample(n, energy=...)" for name in ("leaf", "energy", "casimirs")}
"""What does what an argument asks for that a function has not."""

_FLAG = "True or False"

_BOUND = {"self", "cls"}
"""Parameters that Python fills in where a method is called."""

_OURS = {"liepoisson", "contextlib", "numpy"}
"""Packages whose frames are between a call and what it does: this one, and decorators that are in use here."""

_inside: ContextVar[bool] = ContextVar("inside a run", default=False)


def explains_its_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """A function, or the `__init__` of a class, whose wrong calls are explained."""
    code = inspect.unwrap(function).__code__  # as `inspect.signature` says, at less cost
    by_place = code.co_varnames[: code.co_argcount]
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    single = _single_arguments(function)
    function.__doc__ = completed(function.__doc__, "Args", names, ARGUMENTS)

    @wraps(function)
    def called(*args: P.args, **options: P.kwargs) -> R:
        for name, value in (*zip(by_place, args, strict=False), *options.items()):
            flag = single.get(name) == _FLAG and isinstance(value, str)
            if flag or (single.get(name) and (isinstance(value, (bytes, bytearray)) or is_several(value))):
                raise ParameterError(f"{name}: wanted {single[name]}; got {shown(value)}; give one value")
        try:
            return function(*args, **options)
        except ExpressionError as error:  # it says what is wrong and where; the frames of the parser say nothing more
            raise error.with_traceback(None) from None
        except MemoryError as error:
            if isinstance(error, LiePoissonError):
                raise
            said = str(error).removesuffix(".") or "there is no memory left"
            raise MemoryLimitError(
                f"{function.__qualname__}: wanted what fits into memory; {said}; ask for less at once"
            ) from error
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:  # from inside the function
                raise
            raise ParameterError(_explanation(function, args, options, error)) from None
        except AttributeError as error:
            if (name := _argument_that_is(error.obj, function, args, options)) is None:
                raise
            if name == "system":
                raise not_a_whole_system(error.obj) from error
            raise ParameterError(
                f"{name}: got {shown(error.obj)}, which has no {error.name!r}; {function.__qualname__} wants "
                "another kind of thing: see its docstring"
            ) from error

    return called


def _single_arguments(function: Callable[..., Any]) -> dict[str, str]:
    """What an argument must be, where it is a flag, a text or one of some texts."""
    found: dict[str, str] = {}
    scope = getattr(function, "__globals__", {})
    for name, kinds in function.__annotations__.items():
        kind = str(kinds).removesuffix(" | None")
        if kind == "bool":
            found[name] = _FLAG
        elif kind == "str" or kind.startswith("Literal[") or get_origin(scope.get(kind)) is Literal:
            found[name] = "a text"
    return found


def _argument_that_is(value: Any, function: Callable[..., Any], args: Any, options: dict[str, Any]) -> str | None:
    """The name of the argument that is this very object or has it in a list; None if there is none, as for `self`."""
    given = inspect.signature(function).bind(*args, **options).arguments
    return next((name for name, one in given.items() if name not in _BOUND and _holds(one, value)), None)


def _holds(given: Any, value: Any, depth: int = 4) -> bool:
    """Whether something is an object, or a list with it, or a list of lists."""
    if given is value:
        return True
    inner = given.values() if isinstance(given, dict) else given if isinstance(given, (list, tuple)) else ()
    return depth > 0 and any(_holds(one, value, depth - 1) for one in inner)


def explains_its_methods(cls: C) -> C:
    """A class, such as a dataclass, that explains how it is made and how its methods are called."""
    for name, found in list(vars(cls).items()):
        if name.startswith("_") and name not in {"__init__", "__call__"}:
            continue
        if isinstance(found, FunctionType) and not hasattr(found, "__wrapped__"):
            setattr(cls, name, explains_its_arguments(found))
        elif isinstance(found, classmethod):
            function: Any = found.__func__  # pyright: ignore[reportUnknownMemberType]  # of a type not known here
            setattr(cls, name, classmethod(explains_its_arguments(function)))
    return cls


def shows_progress(function: Callable[P, R]) -> Callable[P, R]:
    """A function that takes `progress`: without it, a bar where somebody watches; and wrong calls are explained."""
    explained = explains_its_arguments(function)

    @wraps(function)
    def run(*args: P.args, **options: P.kwargs) -> R:
        if _inside.get():
            return explained(*args, **options)
        token = _inside.set(True)
        bar: Bar | None = None
        told: Told | None = None
        try:
            if (listener := options.get("progress")) is not None:
                told = Told(as_listener(listener))
            elif is_watched():
                bar = Bar(function.__name__)
            if (listen := bar.draw if bar else told) is not None:
                options["progress"] = listen
            found = explained(*args, **options)
            if told is not None:
                told.ends()
            return found
        finally:
            _inside.reset(token)
            if bar is not None:
                bar.erase()

    return run


def level_of_the_caller() -> int:
    """The `stacklevel` of a warning that points to the first line outside the package."""
    frame, level = sys._getframe(1), 1  # pyright: ignore[reportPrivateUsage]  # the documented way to walk the stack
    while frame.f_back is not None and str(frame.f_globals.get("__name__")).partition(".")[0] in _OURS:
        frame, level = frame.f_back, level + 1
    return level


def as_listener(progress: Any) -> Callable[[float], Any]:
    """A function that takes the fraction of a run that is done.

    Raises:
        ParameterError: It is no function.
    """
    if not callable(progress):
        raise ParameterError(
            f"progress: wanted a function of the fraction that is done; got {shown(progress)}; leave it out for "
            f"a bar in a notebook and on a terminal ({OFF}=0 turns it off), or try progress=print"
        )
    return progress


class Told:
    """What a listener hears of a run: fractions from 0 to 1 that never fall, and 1 when the run has ended."""

    def __init__(self, listener: Callable[[float], Any]) -> None:
        self._listener = listener
        self._last = 0.0

    def __call__(self, fraction: float) -> None:
        """Tell that this part is done."""
        self._last = min(max(float(fraction), self._last), 1.0)
        self._listener(self._last)

    def ends(self) -> None:
        """Tell that all is done, unless that was said."""
        if self._last < 1.0:
            self(1.0)


def is_watched() -> bool:
    """Whether a bar would be seen: by the main thread of a process that was not made by another, and not turned off."""
    if os.environ.get(OFF) == "0" or threading.current_thread() is not threading.main_thread():
        return False
    processes = sys.modules.get("multiprocessing.process")
    if processes is not None and processes.parent_process() is not None:
        return False
    if "ipykernel" in sys.modules and "IPython" in sys.modules:
        shell: Any = sys.modules["IPython"].get_ipython()
        if shell is not None and hasattr(shell, "kernel"):
            return True
    return sys.stderr is not None and sys.stderr.isatty()  # pyright: ignore[reportUnnecessaryComparison]


class Bar:
    """One line on standard error, written again and again: "section  42% [========            ] 1:37 left"."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._began = clock.monotonic()
        self._due = self._began + FIRST
        self._width = 0

    def draw(self, fraction: float) -> None:
        """Show what is done, unless it was shown just now."""
        now = clock.monotonic()
        if now < self._due:
            return
        self._due = now + NEXT
        share = min(max(float(fraction), 0.0), 1.0)
        done = round(20 * share)
        left = f" {_minutes((now - self._began) * (1 - share) / share)} left" if share > 0 else ""
        self._write(f"{self.name} {share:4.0%} [{'=' * done}{' ' * (20 - done)}]{left}")

    def erase(self) -> None:
        """Leave an empty line behind."""
        if self._width:
            self._write("", end="\r")

    def _write(self, text: str, end: str = "") -> None:
        with suppress(OSError, ValueError):  # closed, or nobody reads it
            sys.stderr.write(f"\r{text:<{self._width}}{end}")
            sys.stderr.flush()
        self._width = len(text)


def _minutes(seconds: float) -> str:
    whole = round(seconds)
    if whole < 3600:
        return f"{whole // 60}:{whole % 60:02}"
    return f"{whole // 3600}:{whole % 3600 // 60:02}:{whole % 60:02}"


def _explanation(function: Callable[..., Any], args: tuple[Any, ...], options: dict[str, Any], error: TypeError) -> str:
    """What was wrong with a call, and how it is written."""
    signature = inspect.signature(function)
    known = {name: p for name, p in signature.parameters.items() if name not in _BOUND}
    name = function.__qualname__.removesuffix(".__init__")
    if name.endswith(".__call__"):  # written with the object, as in bracket(f, g)
        name = type(args[0]).__name__.lower()
    unknown = next((given for given in options if given not in known), None)
    if unknown is not None:
        right = [word for word, others in _WORDS.items() if unknown in others and word in known]
        written = (
            [_WRITTEN[unknown].format(shown(options[unknown]))]
            if right == ["method"] and unknown in _WRITTEN
            else right
        )
        written = [_ELSEWHERE[name, unknown]] if (name, unknown) in _ELSEWHERE else written
        near = f"Write {' or '.join(written)}." if written else did_you_mean(unknown, known).strip()
        return f"{name} has no argument {unknown!r}. {near or 'Leave it out.'} It has {', '.join(known)}."
    by_place = [p for p, value in known.items() if value.kind in (value.POSITIONAL_ONLY, value.POSITIONAL_OR_KEYWORD)]
    if (n := len(args) - len(_BOUND & set(signature.parameters))) > len(by_place):
        named = [p for p in known if p not in by_place][: n - len(by_place)]
        call = ", ".join([*by_place, *(f"{p}=..." for p in named)])
        return f"{name} takes {', '.join(by_place) or 'nothing'} by place, and got {n} values; write {name}({call})."
    missing = [p for p, value in known.items() if value.default is value.empty and value.kind < value.VAR_KEYWORD]
    missing = [p for p in missing if p not in options and p not in by_place[:n]]
    if missing:
        call = ", ".join(p if p in by_place else f"{p}=..." for p, v in known.items() if v.default is v.empty)
        return f"{name} must have {' and '.join(missing)}; write {name}({call})."
    return f"{str(error).removeprefix(f'{function.__qualname__}() ')}: {name}({', '.join(known)})."
