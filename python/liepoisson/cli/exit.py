"""How the command ends, whatever happens: the one place that turns errors into a sentence and an exit code.

`LIEPOISSON_TRACEBACK=1` shows where an error comes from that is none of the expected ones.
"""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, Self

from liepoisson.errors import LiePoissonError

REFUSED, INTERRUPTED, BROKEN_PIPE, TERMINATED = 2, 130, 141, 143
"""Exit codes: refused, failed, or its output was closed, with one sentence on standard error; ended by Ctrl-C; as
nobody reads the output any more (by SIGPIPE); and by SIGTERM, where a command has something to close."""

TRACEBACK = "LIEPOISSON_TRACEBACK"
UNEXPECTED = "this is a mistake in liepoisson"
"""Said of errors that no command expects."""

_LONGEST = 4000
"""Characters of a message that are printed; no name that a user chose makes it longer."""


class InterruptedCommandError(Exception):
    """Ctrl-C where no command says what became of its work."""


class TerminatedError(BaseException):
    """SIGTERM, where a command has something to close; like Ctrl-C it is no `Exception`, which some would keep."""


@contextmanager
def ends_on_sigterm() -> Generator[None]:
    """Raises `TerminatedError` on SIGTERM, which otherwise ends the process at once and leaves its children alone."""

    def end_here(*_: object) -> None:
        raise TerminatedError

    if threading.current_thread() is not threading.main_thread():
        yield  # signals reach the main thread alone
        return
    before = signal.signal(signal.SIGTERM, end_here)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class NobodyReadsError(Exception):
    """A pipe that is read no more."""


class _ControlC:
    """Raises `KeyboardInterrupt`, and once more where the first one may be lost.

    Python drops an exception in a destructor or in a callback of a weak reference, of which importing a module runs
    many: a command interrupted there would go on.  So one that comes during an import is repeated until the command
    ends, and that the first was dropped is not reported.
    """

    PAUSE = 0.5

    def __init__(self) -> None:
        self.is_over = False

    def __enter__(self) -> Self:
        """Take the place of Python's own handler; where another one is set, or none, it stays."""
        self._before = signal.getsignal(signal.SIGINT), sys.unraisablehook
        if self._before[0] is signal.default_int_handler:
            signal.signal(signal.SIGINT, self)
            sys.unraisablehook = self._report
        return self

    def __exit__(self, *_: object) -> None:
        """Put back what was there: a process may go on, as that of a test."""
        self.is_over = True
        handler, sys.unraisablehook = self._before
        if handler is signal.default_int_handler:
            signal.signal(signal.SIGINT, handler)

    def _report(self, dropped: Any) -> None:
        if dropped.exc_type is not KeyboardInterrupt:
            self._before[1](dropped)

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.is_over:
            return
        if _is_importing(frame):
            again = threading.Timer(self.PAUSE, self._again)
            again.daemon = True
            again.start()
        raise KeyboardInterrupt

    def _again(self) -> None:
        if self.is_over:
            return
        if hasattr(signal, "pthread_kill"):  # to the main thread, so that what it waits for is interrupted, too
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        else:
            signal.raise_signal(signal.SIGINT)


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def end(command: Callable[[], object]) -> None:
    """Run a command and leave the process with its exit code."""
    with _ControlC() as control_c:
        try:
            _open_what_is_closed()
            _write_any_text()
            code = _exit_code(command)
            sys.stdout.flush()
            if code == 0 and isinstance(sys.stdout, _ClosedOutput) and sys.stdout.has_lost_text:
                raise OSError(errno.EBADF, "standard output is closed")
        except BaseException as error:
            control_c.is_over = True
            code = _report(error)
    _leave_quietly(code)


def _exit_code(command: Callable[[], object]) -> int:
    """The code with which a command itself leaves, or 0."""
    try:
        command()
    except SystemExit as end_of_command:
        code = end_of_command.code
        if isinstance(code, str):
            print(code, file=sys.stderr)
            return 1
        return code or 0
    return 0


def _report(error: BaseException) -> int:
    """Say in one sentence what went wrong; the exit code."""
    if _is_interruption(error):
        _say("interrupted.")
        return INTERRUPTED
    if isinstance(error, (NobodyReadsError, BrokenPipeError)):
        return BROKEN_PIPE
    if os.environ.get(TRACEBACK) and not isinstance(error, LiePoissonError):
        import traceback

        with suppress(OSError):
            traceback.print_exception(error)
    _say(f"liepoisson: {sentence(error)}")
    return REFUSED


def sentence(error: BaseException) -> str:
    """What an error says to a user."""
    if isinstance(error, LiePoissonError):
        return _clipped(str(error))
    if isinstance(error, MemoryError):
        said = str(error).removesuffix(".")
        return _clipped(f"not enough memory{f' ({said})' if said else ''}. Ask for less at a time.")
    if isinstance(error, RecursionError):
        return "something in the input is nested too deeply. Simplify it."
    if isinstance(error, OSError):
        what = error.strerror or str(error) or type(error).__name__
        named = isinstance(error.filename, (str, bytes))
        doing = f"could not use {os.fsdecode(error.filename)!r:.120}" if named else "the output could not be written"
        return _clipped(f"{doing}: {what}.")
    said = " ".join(str(error).split())
    return _clipped(
        f"{type(error).__name__}: {said or 'no reason given'}; {UNEXPECTED}: please report it, with what "
        f"{TRACEBACK}=1 prints."
    )


def _is_interruption(error: BaseException | None) -> bool:
    """Whether Ctrl-C is the cause: while a class is made, Python 3.11 turns it into a RuntimeError."""
    while error is not None and not isinstance(error, (InterruptedCommandError, KeyboardInterrupt)):
        error = error.__cause__
    return error is not None


def _clipped(text: str) -> str:
    shown = text if len(text) <= _LONGEST else f"{text[: _LONGEST - 4]} ..."
    return "".join(c if c in "\n\t" or c.isprintable() else ascii(c)[1:-1] for c in shown)


def _say(line: str) -> None:
    """Print on standard error, if anybody listens."""
    with suppress(OSError, ValueError):
        print(line, file=sys.stderr, flush=True)


def _open_what_is_closed() -> None:
    """Take the numbers of closed standard streams, so that no file gets them that the command opens later."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest free number
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  # until the process ends
    if sys.stdout is None:
        sys.stdout = _ClosedOutput()


class _ClosedOutput(io.StringIO):
    """Standard output that was closed before the command began."""

    has_lost_text = False

    def write(self, text: str) -> int:
        """Drop the text, and remember that there was some: the command writes its files all the same."""
        self.has_lost_text = True
        return len(text)


def _write_any_text() -> None:
    """Replace what a terminal or a file cannot encode, such as the bytes of a file name that are no text."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")


def _leave_quietly(code: int) -> None:
    """Exit, without another attempt to write what could not be written."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    sys.exit(code)
