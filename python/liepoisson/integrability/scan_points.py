"""The search for integrals at points of a grid of parameters, on all cores.

A search is plain data. Where there are many points it is read by processes of their own, which read points and write
what was found. They do not run the script of the user again, as those of `multiprocessing` would, and end when this
process has ended: nobody writes to them any more.

The folder of a scan: one file of lines, the first of which says what is scanned; each other one has some points.

Each line begins with its checksum, those of points also with a digest of the first line: they name their scan.  A line
that is damaged or belongs to another scan, such as the last one of a process that was killed, is left out, and its
points are computed again.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias
from zlib import crc32

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.number_fields import as_fraction
from liepoisson.algebra.sparse_polynomials import Polynomial, value_at
from liepoisson.errors import DamagedFileError, OutputError, TimeLimitError
from liepoisson.inputs.deadline import Deadline
from liepoisson.integrability.checker import number
from liepoisson.integrability.derivation import Derivation, Exponents, Grading, Level, up_to_degree
from liepoisson.integrability.search import Generator, Search, tidied
from liepoisson.io.files import another_format, write_atomically, writing

if TYPE_CHECKING:
    from liepoisson.integrability.parameter_cases import Poly

OUTCOMES = ("finished", "not proved", "no system", "failed", "time limit")
"""What becomes of a point: counted and proved; counted, but there may be more; a denominator vanishes; its process
ended; not computed."""

Terms: TypeAlias = "tuple[tuple[Exponents, Fraction], ...]"
"""A polynomial in the parameters."""
Family: TypeAlias = "dict[Exponents, Terms]"
"""A polynomial in the coordinates whose coefficients are polynomials in the parameters."""


@dataclass(frozen=True)
class PointResult:
    """What was found at a point."""

    outcome: str  # one of `OUTCOMES`
    n_further: int = -1  # number of integrals that are functionally independent of the known ones and of each other
    found: tuple[Polynomial, ...] = ()  # all that are no polynomials in the known ones, lowest degree first


@dataclass(frozen=True)
class PointSearch:
    """A search whose coefficients are polynomials in the parameters."""

    n: int  # number of coordinates
    degree: int  # the largest degree of the integrals
    gradings: tuple[Grading, ...]  # the gradings for all values of the parameters
    components: tuple[Family, ...]  # the equations of motion, without denominators
    denominator: Terms  # what they were multiplied by
    zeros: tuple[Family, ...]  # the functions that vanish on the level
    basis: tuple[tuple[Exponents, Family], ...]  # a Gröbner basis of these, each with its leading monomial
    known: tuple[tuple[str, Family], ...]  # the integrals that are known, by name; remainders on the level

    def at(self, values: Sequence[Fraction]) -> PointResult:
        """Search at some values of the parameters."""
        if not value_at(self.denominator, values):
            return PointResult("no system")
        names: Any = tuple(range(self.n))  # of the coordinates, which nothing here prints
        derivation = Derivation(names, tuple(_at(part, values) for part in self.components), Coefficients())
        known = ((name, _at(function, values)) for name, function in self.known)
        search = Search(
            derivation,
            self.gradings,
            Level(tuple((lead, _at(generator, values)) for lead, generator in self.basis)),
            tuple(zero for part in self.zeros if (zero := _at(part, values))),
            [Generator(name, polynomial, is_new=False) for name, polynomial in known if any(map(any, polynomial))],
        )
        search.run(up_to_degree(self.n, self.degree))
        new = [g for g in search.generators if g.is_new]
        return PointResult(
            "finished" if search.complete else "not proved",
            sum(g.is_independent for g in new),
            tuple(tidied(g.polynomial) for g in new),
        )


def plain(polynomial: Poly) -> Terms:
    """The terms of a polynomial of flint."""
    return tuple((tuple(map(int, m)), as_fraction(c)) for m, c in polynomial.terms())


def plain_family(family: Mapping[Exponents, Poly]) -> Family:
    """A polynomial in the coordinates as plain data."""
    return {m: plain(c) for m, c in family.items()}


def _at(family: Family, values: Sequence[Fraction]) -> Polynomial:
    return {m: value for m, terms in family.items() if (value := value_at(terms, values))}


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
    workers, pool = _Workers(search), ThreadPoolExecutor(processes)
    try:
        waiting = {pool.submit(workers.found, piece) for piece in pieces}
        while waiting and deadline.lasts():
            ready, waiting = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
            for one in ready:
                yield one.result()
            if not ready:
                yield None
    finally:
        workers.end()
        pool.shutdown(cancel_futures=True)


class _Workers:
    """Processes, one for each thread that asks."""

    def __init__(self, search: PointSearch) -> None:
        self._search, self._lock, self._own = pickle.dumps(search), threading.Lock(), threading.local()
        self._running: list[subprocess.Popen[bytes]] = []
        self._is_over = False

    def found(self, piece: Piece) -> Results:
        """What the process of this thread finds; a new one begins where it has ended, as for want of memory.

        An error in the process is raised here.
        """
        try:
            if getattr(self._own, "process", None) is None:
                self._own.process = self._start()
            found = _ask(self._own.process, piece)
        except (OSError, EOFError, pickle.UnpicklingError):
            if (ended := self._own.__dict__.pop("process", None)) is not None:
                _end(ended)
            return dict.fromkeys(piece, PointResult("failed"))
        if isinstance(found, Exception):
            raise found
        return found

    def _start(self) -> subprocess.Popen[bytes]:
        folder = str(Path(__file__).parents[2])
        paths = os.pathsep.join(filter(None, (folder, os.environ.get("PYTHONPATH", ""))))
        with self._lock:
            if self._is_over:
                raise EOFError
            process = subprocess.Popen(
                [sys.executable, "-c", "from liepoisson.integrability.scan_points import serve_parent; serve_parent()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=os.environ | {"PYTHONPATH": paths},
                start_new_session=True,  # Ctrl-C is for this process, which ends the others
            )
            self._running.append(process)
        assert process.stdin is not None
        process.stdin.write(self._search)
        return process

    def end(self) -> None:
        """End all processes, at once."""
        with self._lock:
            self._is_over = True
            for process in self._running:
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


def serve_parent() -> None:
    """Serve the process that began this one, by its pipes."""
    try:
        serve(sys.stdin.buffer, sys.stdout.buffer)
    except BrokenPipeError:  # the process that asked was killed
        os._exit(1)


FORMAT = "liepoisson integral scan 2"
_FILE = "points.jsonl"


class ScanStore:
    """The points of a scan that are known."""

    def __init__(self, folder: Path, description: Mapping[str, Any], *, fresh: bool = False) -> None:
        self.path = folder / _FILE
        self.known: dict[int, PointResult] = {}
        head = json.loads(json.dumps({"format": FORMAT, **description}))
        self._scan = sha256(_line(head).encode()).hexdigest()[:16] + " "
        with writing(folder):
            is_there, is_used = self.path.exists(), any(p.name not in (".lock", _FILE) for p in folder.iterdir())
        if is_there and not fresh:
            self._read(head)
        elif is_used:
            raise OutputError(f"{folder} is not empty and holds no scan. Choose another name for the store.")
        else:
            write_atomically(self.path, _line(head).encode())

    def _read(self, head: Mapping[str, Any]) -> None:
        with writing(self.path):
            content = self.path.read_bytes()
        lines = content.decode("utf-8", "replace").split("\n")
        found = _content(lines[0])
        named = found.get("format") if isinstance(found, dict) else None
        if isinstance(named, str) and named != FORMAT and named.startswith(FORMAT.rstrip("0123456789")):
            raise OutputError(f"{self.path}: {another_format(named, FORMAT)}")
        if named != FORMAT:
            raise DamagedFileError(f"{self.path} holds no scan that can be read. Start over with fresh=True.")
        if found != head:
            names = [name for name in head if found.get(name) != head[name]]
            raise OutputError(
                f"{self.path} holds another scan: {', '.join(names) or 'its description'} differs. Choose another "
                "store, or discard it with fresh=True."
            )
        for line in lines[1:]:
            try:
                said = _content(line, self._scan) or {}
                self.known |= {int(point): _result(record) for point, record in said.items()}
            except (ArithmeticError, ValueError, TypeError, AttributeError):  # it had a right sum, and is none of ours
                continue
        if not content.endswith(b"\n"):
            with writing(self.path), self.path.open("ab") as stream:
                stream.write(b"\n")

    def keep(self, results: Mapping[int, PointResult]) -> None:
        """Add points; one whose process failed is tried again next time."""
        if records := {str(k): _record(r) for k, r in results.items() if r.outcome != "failed"}:
            with writing(self.path), self.path.open("a", encoding="utf-8") as stream:
                stream.write(_line(records, self._scan))
                stream.flush()
                os.fsync(stream.fileno())


def _line(content: Any, scan: str = "") -> str:
    text = scan + json.dumps(content, separators=(",", ":"))
    return f"{crc32(text.encode()):08x} {text}\n"


def _content(line: str, scan: str = "") -> Any:
    """What a line says, or None."""
    total, _, text = line.partition(" ")
    if total != f"{crc32(text.encode()):08x}" or not text.startswith(scan):
        return None
    try:
        return json.loads(text.removeprefix(scan))
    except (ValueError, RecursionError):
        return None


def _record(result: PointResult) -> list[Any]:
    found = [[[str(c), list(m)] for m, c in polynomial.items()] for polynomial in result.found]
    return [result.outcome, result.n_further, found]


def _result(record: list[Any]) -> PointResult:
    outcome, n_further, found = record
    if outcome not in OUTCOMES:
        raise ValueError("another outcome")
    polynomials = tuple({tuple(map(int, m)): number(c) for c, m in polynomial} for polynomial in found)
    return PointResult(outcome, int(n_further), polynomials)
