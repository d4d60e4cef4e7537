"""The integration of one run, piece by piece, so that an interrupted study goes on from what is finished.

Each finished piece is one file `pieces/<run>/<first>-<last>.nc`.  When all pieces of a run are there they are joined
into `data/<run>.nc` and removed.  All these files can be read by `liepoisson.load`; `data/manifest.json` has for each
of them a fingerprint of everything that determines its numbers, a checksum, and the seconds that the integration took.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import secrets
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

import liepoisson as lp
from liepoisson.studies.twisted_top.runs import Run, Settings, plan

_PIECE = re.compile(r"\d{6,}-\d{6,}\.nc")
# What a growth has for each trajectory; the rest is the same for the whole run.
_MEMBER_ARRAYS = ("exponent", "outcome", "end_time", "n_steps", "start", "start_tangent", "end_state")
# What an interrupted write leaves behind.
_PARTIAL = re.compile(r"(\.[0-9]+-[0-9a-f]+)?\.partial")


class Progress(Protocol):
    """Hears how far the study is: what it is doing, and trajectories x time done and to do in this process."""

    def __call__(self, activity: str, done: float, total: float) -> None: ...  # noqa: D102


class Tracker:
    """Adds up the work of all runs for a progress bar."""

    def __init__(self, stores: Sequence[RunStore], progress: Progress | None) -> None:
        self._progress = progress
        self._total = sum(count * store.run.end_time for store in stores for _, count in store.missing_pieces())
        self._done = 0.0

    def piece(self, run: Run, count: int) -> Callable[[float], None]:
        """A listener for the fraction done of a piece with `count` trajectories."""
        before, work = self._done, count * run.end_time

        def listen(fraction: float) -> None:
            self._done = before + fraction * work
            self.tell(run.name)

        return listen

    def tell(self, activity: str) -> None:
        """Report an activity, with the work done so far."""
        if self._progress is not None:
            self._progress(activity, self._done, self._total)


def fingerprint(run: Run) -> dict[str, object]:
    """Everything that determines the numbers of a run, as plain data; not the number of trajectories."""
    return {
        "run": run.name,
        "inertia": [str(moment) for moment in run.inertia],
        "epsilon": run.epsilon,
        "ensemble": run.ensemble,
        "seed": run.seed,
        "tolerance": run.tolerance,
        "end_time": run.end_time,
        "times": hashlib.sha256(run.time.tobytes()).hexdigest()[:16],
        "version": lp.__version__,
    }


class RunStore:
    """The files of one run in the output folder `out`."""

    def __init__(self, out: Path, run: Run) -> None:
        self.run = run
        self.folder = out / "pieces" / run.name
        self.data = out / "data" / f"{run.name}.nc"
        self._manifest = out / "data" / "manifest.json"

    def piece_path(self, first: int, count: int) -> Path:
        """File of the piece with trajectories first .. first + count - 1."""
        return self.folder / f"{first:06d}-{first + count - 1:06d}.nc"

    def missing_pieces(self) -> list[tuple[int, int]]:
        """(first, count) of the pieces that are not stored yet; none when the whole run is there."""
        if self.is_complete():
            return []
        own = {self.piece_path(first, count) for first, count in self.run.pieces()}
        stored = self.folder.iterdir() if self.folder.is_dir() else ()
        for foreign in sorted(path for path in stored if _PIECE.fullmatch(path.name) and path not in own):
            if self.is_stored(foreign):  # finished work of another study, which must not be lost here
                raise lp.errors.ParameterError(
                    f"{foreign} holds work of a study with another number of trajectories "
                    f"than {self.run.members}. "
                    "Use the same options to go on with it, choose another folder (out), or discard it (fresh)."
                )
        return [piece for piece in self.run.pieces() if not self.is_stored(self.piece_path(*piece))]

    def is_complete(self) -> bool:
        """Whether the joined data of the whole run are stored."""
        return self.is_stored(self.data)

    def is_stored(self, path: Path) -> bool:
        """Whether a file of this run is there and recorded."""
        record = self._records().get(self._key(path))
        if not path.exists():
            return False
        if record is None:  # it was written last before a run was killed, or the manifest is gone
            self._check_unrecorded(path)
            return False
        _check_fingerprint(path, record["fingerprint"], self._fingerprint(path))
        return True

    def _check_unrecorded(self, path: Path) -> None:
        """Refuse to write over the work of a study with other options; what cannot be read is no work."""
        try:
            stored = lp.load(path)
        except (lp.errors.LiePoissonError, OSError):
            return
        wanted = {"seed": self.run.seed, "tolerance": self.run.tolerance, "end_time": self.run.end_time}
        if isinstance(stored, lp.results.FiniteTimeExponents):
            own = (stored.seed, getattr(stored.method, "tol", None), float(stored.time[-1]))
            _check_fingerprint(path, dict(zip(wanted, own, strict=True)), wanted)

    def save(self, path: Path, growth: lp.results.FiniteTimeExponents, seconds: float) -> None:
        """Store a piece, or the whole run, of which the pieces are then removed."""
        growth.save(path)
        record = {"fingerprint": self._fingerprint(path), "sha256": _digest(path), "seconds": seconds}
        records = {**self._records(), self._key(path): record}
        if path == self.data:
            records = {name: kept for name, kept in records.items() if not name.startswith(f"{self.run.name}/")}
        write_json(self._manifest, records)
        if path == self.data:
            with suppress(OSError):
                _remove(self.folder, _PIECE)
                # Gone with the last run; pieces of other runs keep it.
                self.folder.parent.rmdir()

    def load(self, path: Path) -> tuple[lp.results.FiniteTimeExponents, float]:
        """A stored piece, or the whole run, and the seconds that its integration took, checked."""
        record = self._records()[self._key(path)]
        try:
            digest = _digest(path)
        except OSError as error:
            raise _damaged(path, f"it cannot be read ({error})") from error
        if digest != record["sha256"]:
            raise _damaged(path, "its checksum does not match the one in manifest.json")
        return lp.load(path), float(record["seconds"])

    def _key(self, path: Path) -> str:
        return self.run.name if path == self.data else f"{self.run.name}/{path.stem}"

    def _fingerprint(self, path: Path) -> dict[str, object]:
        whole = {"members": self.run.members} if path == self.data else {}
        return {**fingerprint(self.run), **whole}

    def _records(self) -> dict[str, Any]:
        if not self._manifest.exists():
            return {}
        try:
            records = json.loads(self._manifest.read_text(encoding="utf-8"))
            if not (isinstance(records, dict) and all(map(_is_record, records.values()))):
                raise ValueError("it has another form than liepoisson writes")
        # Text that is no JSON; too deeply nested, it fails with a RecursionError.
        except (OSError, ValueError, RecursionError) as error:
            # Without it no finished run is known to be sound.
            raise _damaged(self._manifest, f"it cannot be read ({error})", "every finished run is") from error
        return records


def complete(store: RunStore, threads: int | None, tracker: Tracker) -> tuple[lp.results.FiniteTimeExponents, float]:
    """All trajectories of a run, read if they are stored, else integrated and stored; and the seconds that it took."""
    if store.is_complete():
        return store.load(store.data)
    for first, count in store.missing_pieces():
        integrate_piece(store, first, count, threads, tracker)
    pieces = [store.load(store.piece_path(first, count)) for first, count in store.run.pieces()]
    growth, seconds = _joined([growth for growth, _ in pieces]), sum(seconds for _, seconds in pieces)
    store.save(store.data, growth, seconds)
    return growth, seconds


def integrate_piece(store: RunStore, first: int, count: int, threads: int | None, tracker: Tracker) -> None:
    """Integrate some trajectories of a run and store them."""
    run, top = store.run, store.run.top()
    listen = tracker.piece(run, count)
    started = time.perf_counter()
    growth = lp.finite_time_exponents(
        top,
        lp.sample_states(top, count, seed=run.seed, ensemble=run.ensemble, first=first),
        times=run.time,
        seed=run.seed,
        first=first,
        method=lp.Taylor(tol=run.tolerance),
        threads=threads,
        time_limit=math.inf,  # what is stored must not depend on how quick the machine is
        progress=listen,
    )
    store.save(store.piece_path(first, count), growth, time.perf_counter() - started)
    listen(1.0)


def _joined(pieces: Sequence[lp.results.FiniteTimeExponents]) -> lp.results.FiniteTimeExponents:
    """The pieces of a run, one after the other, as one result."""
    rows = {name: np.concatenate([getattr(piece, name) for piece in pieces]) for name in _MEMBER_ARRAYS}
    return replace(pieces[0], **rows)


@contextmanager
def alone_in(out: Path) -> Generator[None]:
    """Make a folder if there is none, and keep other studies from working in it, of this process too.

    The lock is advisory, on the file `.lock`, which stays; it ends with the process.  Where the system has no such
    locks there is none.

    Raises:
        OutputError: another study holds the folder, or it cannot be made.
    """
    with _writing(out):
        out.mkdir(parents=True, exist_ok=True)
        lock = (out / ".lock").open("ab")
    with lock:
        _hold(lock.fileno(), out)
        yield


def _hold(descriptor: int, out: Path) -> None:
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise lp.errors.OutputError(
            f"another run is using {out}: wait for it to end, or choose another folder."
        ) from error
    except OSError:  # a file system without locks
        return


@contextmanager
def _writing(path: Path) -> Generator[None]:
    """Around what writes, and nothing else: a failure there is an `OutputError`."""
    try:
        yield
    except OSError as error:
        raise lp.errors.OutputError(
            f"could not write {path}: {error.strerror or error}. If no space is left, free some, else choose another "
            "folder; what is finished is kept."
        ) from error


def write_json(path: Path, content: Mapping[str, object]) -> None:
    """Write plain data as indented JSON."""
    write_text(path, json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def write_text(path: Path, text: str) -> None:
    """Write a file so that it is either whole or as it was.

    Raises:
        OutputError: it could not be written.
    """
    with _writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path = path.resolve()  # a link stays one
        partial = path.with_name(f"{path.name}.{os.getpid()}-{secrets.token_hex(4)}.partial")
        try:
            with partial.open("x", encoding="utf-8") as file:  # never what a link of this name leads to
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)


def discard(out: Path) -> None:
    """Remove the stored work of a study, and nothing else in its folder; emptied subfolders go too."""
    for run in plan(Settings()):
        _remove(out / "pieces" / run.name, _PIECE)
        _remove(out / "data", re.compile(re.escape(run.name) + r"\.nc"))
    _remove(out / "data", re.compile(r"manifest\.json"))
    with suppress(OSError):
        (out / "pieces").rmdir()


def _remove(folder: Path, pattern: re.Pattern[str]) -> None:
    """Remove the files of a folder whose whole name fits, with what is left of unfinished ones; then it, if empty."""
    if not folder.is_dir():
        return
    for path in list(folder.iterdir()):
        match = pattern.match(path.name)
        rest = path.name[match.end() :] if match else None
        if rest is not None and (not rest or _PARTIAL.fullmatch(rest)) and (path.is_file() or path.is_symlink()):
            path.unlink()
    with suppress(OSError):
        # Files of others keep it.
        folder.rmdir()


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _is_record(value: Any) -> bool:
    """Whether a value read from JSON says what determined some numbers, their checksum, and the time they took."""
    if not isinstance(value, dict):
        return False
    stored, digest, seconds = (value.get(name) for name in ("fingerprint", "sha256", "seconds"))
    is_time = isinstance(seconds, (int, float)) and 0 <= seconds < 1e15
    return isinstance(stored, dict) and isinstance(digest, str) and is_time


def _damaged(path: Path, reason: str, computed_anew: str = "only its part is") -> lp.errors.DamagedFileError:
    return lp.errors.DamagedFileError(
        f"{path} is damaged: {reason}. Remove this file and run the same command again ({computed_anew} computed "
        "anew), or start over (fresh=True, --fresh)."
    )


def _check_fingerprint(path: Path, stored: Mapping[str, object], wanted: Mapping[str, object]) -> None:
    if stored == wanted:
        return
    differences = [
        f"{key} {stored.get(key)} instead of {wanted[key]}" for key in wanted if stored.get(key) != wanted[key]
    ]
    raise lp.errors.ParameterError(
        f"{path} holds work of a study with other options: {', '.join(differences)}. Use the same options to go on "
        "with it, choose another folder (out), or discard it (fresh=True, --fresh)."
    )
