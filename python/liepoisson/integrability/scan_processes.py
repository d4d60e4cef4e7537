"""Points of a scan on all cores: processes of their own, which read points and write what was found.

They do not run the script of the user again, as those of `multiprocessing` would, and end when this process has ended:
nobody writes to them any more.

    python -m liepoisson.integrability.scan_processes
"""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import Deadline
from liepoisson.integrability.scan_points import PointResult, PointSearch

Piece: TypeAlias = "Mapping[int, Sequence[Fraction]]"
"""Some points: values of the parameters by the number of the point."""
Results: TypeAlias = "dict[int, PointResult]"


def results(
    search: PointSearch, pieces: Sequence[Piece], processes: int, deadline: Deadline
) -> Iterator[Results | None]:
    """What is found at the points of each piece, in the order in which they are done, until the deadline.

    None stands for a while in which nothing was done, so that Ctrl-C comes through.
    """
    if processes == 1:
        for piece in pieces:
            done: Results = {}
            for point, values in piece.items():
                if not deadline.lasts():
                    break
                with deadline.running(), suppress(TimeLimitError):
                    done[point] = search.at(values)
            yield done
        return
    workers = _Workers(search, pieces, processes)
    try:
        left = len(pieces)
        while left and deadline.lasts():
            found = workers.next()
            left -= found is not None
            yield found
    finally:
        workers.end()


class _Workers:
    """Processes, each with a thread that hands it pieces."""

    def __init__(self, search: PointSearch, pieces: Sequence[Piece], processes: int) -> None:
        self._waiting: queue.SimpleQueue[Piece] = queue.SimpleQueue()
        self._done: queue.SimpleQueue[Results | Exception] = queue.SimpleQueue()
        self._search, self._is_over = pickle.dumps(search), threading.Event()
        self._running: dict[int, subprocess.Popen[bytes]] = {}
        for piece in pieces:
            self._waiting.put(piece)
        self._threads = [threading.Thread(target=self._serve, args=(k,), daemon=True) for k in range(processes)]
        for thread in self._threads:
            thread.start()

    def next(self) -> Results | None:
        """What was found, or None after a while; an error in a process is raised here."""
        try:
            found = self._done.get(timeout=0.2)
        except queue.Empty:
            return None
        if isinstance(found, Exception):
            raise found
        return found

    def _serve(self, number: int) -> None:
        """Hand out pieces to one process; a new one where it has ended, as for want of memory."""
        while not self._is_over.is_set():
            try:
                piece = self._waiting.get_nowait()
            except queue.Empty:
                return
            try:
                process = self._running.get(number) or self._start(number)
                found: Results | Exception = _ask(process, piece)
            except (OSError, EOFError, pickle.UnpicklingError):
                if (ended := self._running.pop(number, None)) is not None:
                    _end(ended)
                found = dict.fromkeys(piece, PointResult("failed"))
            if not self._is_over.is_set():
                self._done.put(found)

    def _start(self, number: int) -> subprocess.Popen[bytes]:
        folder = str(Path(__file__).parents[2])
        paths = os.pathsep.join(filter(None, (folder, os.environ.get("PYTHONPATH", ""))))
        process = subprocess.Popen(
            [sys.executable, "-m", "liepoisson.integrability.scan_processes"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": paths},
            start_new_session=True,  # Ctrl-C is for this process, which ends the others
        )
        self._running[number] = process
        assert process.stdin is not None
        process.stdin.write(self._search)
        return process

    def end(self) -> None:
        """End all processes, at once."""
        self._is_over.set()
        for process in list(self._running.values()):
            process.kill()
        for thread in self._threads:
            thread.join(timeout=2.0)
        for process in self._running.values():
            _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):  # what it did not read is lost with it
                stream.close()


def _ask(process: subprocess.Popen[bytes], piece: Piece) -> Results | Exception:
    assert process.stdin is not None
    assert process.stdout is not None
    pickle.dump(dict(piece), process.stdin)
    process.stdin.flush()
    return pickle.load(process.stdout)


def serve(source: Any, sink: Any) -> None:
    """Read a search and pieces from a stream, and write what is found to another one, until the first one ends."""
    search: PointSearch = pickle.load(source)
    while True:
        try:
            piece: Piece = pickle.load(source)
        except EOFError:
            return
        found: Results | Exception
        try:
            found = {point: search.at(values) for point, values in piece.items()}
        except MemoryError:
            found = dict.fromkeys(piece, PointResult("failed"))
        except Exception as error:  # which the process that asks raises
            found = error
        pickle.dump(found, sink)
        sink.flush()


if __name__ == "__main__":
    try:
        serve(sys.stdin.buffer, sys.stdout.buffer)
    except BrokenPipeError:  # the process that asked was killed
        os._exit(1)
