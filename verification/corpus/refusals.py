"""Every refusal that the tests provoke, recorded while they run.

    python -m pytest -n auto -m "not slow" -p verification.corpus.refusals --refusals FOLDER/refusals.json [TESTS]

An error of the package counts where a test expects it in `pytest.raises`, a warning in `pytest.warns`; of a command
that ends with an exit code, what it has printed on standard error.  The file has each type with its messages, sorted
and each once, so that tests may move; `compare.py` compares it with those of the other parts.  Beside it,
FOLDER/refusals.txt says which test met which message first.  The same tests must be chosen for both corpora.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from verification.corpus.answer import lines, masked
from verification.corpus.record import written

Met = tuple[str, str, str]
"""Type, message, and the test."""

PACKAGE = "liepoisson"
met: set[Met] = set()
running = ["none"]
"""The test that is running."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """The file."""
    parser.addoption("--refusals", metavar="FILE", help="where the refusals that tests meet are recorded")


def pytest_configure(config: pytest.Config) -> None:
    """Listen where tests expect errors and warnings."""
    if config.getoption("refusals"):
        listen(type(pytest.raises(LookupError)), note_error)
        listen(type(pytest.deprecated_call()), note_warnings)


def listen(kind: type[Any], note: Any) -> None:
    """Take note of what leaves a context before the context sees it."""
    leave = kind.__exit__

    def noting(self: Any, *error: Any) -> Any:
        note(self, error[1])
        return leave(self, *error)

    kind.__exit__ = noting


def note_error(_: Any, error: BaseException | None) -> None:
    """An error of the package, or one that it raises of another type, or the end of a command."""
    if isinstance(error, SystemExit):
        printed = getattr(sys.stderr, "getvalue", str)()
        if error.code and printed:
            add(f"exit code {error.code}", printed)
    elif error is not None and is_ours(error):
        add(type(error).__name__, str(error))


def note_warnings(context: Any, _: BaseException | None) -> None:
    """Warnings of the package."""
    for one in context.list:
        if one.category.__module__.startswith(PACKAGE):
            add(one.category.__name__, str(one.message))


def is_ours(error: BaseException) -> bool:
    """Whether the package made the error, by its class or by the place where it was raised."""
    if type(error).__module__.startswith(PACKAGE):
        return True
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return trace is not None and PACKAGE in Path(trace.tb_frame.f_code.co_filename).parts


def add(kind: str, message: str) -> None:
    """One more."""
    met.add((kind, masked(message), running[0]))


def pytest_runtest_logstart(nodeid: str) -> None:
    """Remember which test runs."""
    running[0] = nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """What a worker of pytest-xdist has met."""
    met.update(map(tuple, getattr(node, "workeroutput", {}).get("refusals", ())))


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the file; a worker hands over what it has met."""
    output = getattr(session.config, "workeroutput", None)
    file = session.config.getoption("refusals")
    if output is not None:
        output["refusals"] = sorted(met)
    elif file:
        write(met, Path(file))


def write(found: Iterable[Met], file: Path) -> None:
    """Messages by type, and beside them the first test of each."""
    first: dict[tuple[str, str], str] = {}
    for kind, message, test in sorted(found):
        first.setdefault((kind, message), test)
    record: dict[str, dict[str, Any]] = {}
    for kind, message in first:
        record.setdefault(kind, {})[message.replace("\n", " | ")] = lines(message)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(written(record), encoding="utf-8")
    rows = [f"{kind}: {message!r}\n    {test}\n" for (kind, message), test in first.items()]
    file.with_suffix(".txt").write_text("".join(rows), encoding="utf-8")
