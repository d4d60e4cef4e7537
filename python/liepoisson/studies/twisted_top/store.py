"""Where finished work is kept, so that an interrupted study goes on from what it has.

A run is computed in pieces; each finished piece is one file `pieces/<run>/<first>-<last>.npz`, written under another
name and then renamed, with a fingerprint of everything that determines its numbers and a checksum of them.  When all
pieces of a run are there they are joined into `data/<run>.nc` (readable by `liepoisson.load`), recorded in
`data/manifest.json`, and the pieces are removed.
"""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import re
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.errors import DamagedFileError, ParameterError
from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents
from liepoisson.io.files import remove_partials, write_atomically, write_json, writing
from liepoisson.studies.twisted_top.runs import Run, Settings, plan

if TYPE_CHECKING:
    pass

AnyArray: TypeAlias = NDArray[Any]

# What a growth says of the whole ensemble; the rest of it is one array each with a row per member.
_OF_THE_WHOLE = {"system", "components", "field", "method", "seed", "first", "time", "order", "kernel", "time_limit"}
_PIECE = re.compile(r"\d{6,}-\d{6,}\.npz")
_MANIFEST = re.compile(r"manifest\.json")
# How text that is no JSON fails; too deeply nested, with a RecursionError.
_UNREADABLE = (OSError, ValueError, RecursionError)
# What else a study writes.
_RESULTS = re.compile(r"(measurements|claims)\.json|report\.html")
_DATA = re.compile(r"[^/]+\.nc|manifest\.json")
# What an interrupted write leaves behind.
_PARTIAL = re.compile(r"(\.[0-9]+-[0-9a-f]+)?\.partial")
MEMBER_ARRAYS = tuple(
    field.name for field in dataclasses.fields(FiniteTimeExponents) if field.name not in _OF_THE_WHOLE
)


def fingerprint(run: Run) -> dict[str, object]:
    """Everything that determines the numbers of a run, as plain data; not the number of members."""
    return {
        "run": run.name,
        "inertia": [str(moment) for moment in run.inertia],
        "epsilon": run.epsilon,
        "ensemble": run.ensemble,
        "seed": run.seed,
        "tolerance": run.tolerance,
        "end_time": run.end_time,
        "times": hashlib.sha256(run.time.tobytes()).hexdigest()[:16],
        "version": __version__,
    }


class RunStore:
    """The files of one run in the output folder `out`."""

    def __init__(self, out: Path, run: Run) -> None:
        self.run = run
        self.folder = out / "pieces" / run.name
        self.data = out / "data" / f"{run.name}.nc"
        self._manifest = out / "data" / "manifest.json"

    def piece_path(self, first: int, count: int) -> Path:
        """File of the piece with members first .. first + count - 1."""
        return self.folder / f"{first:06d}-{first + count - 1:06d}.npz"

    def missing_pieces(self) -> list[tuple[int, int]]:
        """(first, count) of the pieces that have no file yet; none when the whole run is there.

        Raises:
            DamagedFileError: a stored file cannot be read.
            ParameterError: a stored file belongs to a study with other options.
        """
        if self.is_complete():
            return []
        self._refuse_foreign_pieces()
        missing: list[tuple[int, int]] = []
        for first, count in self.run.pieces():
            path = self.piece_path(first, count)
            if path.exists():
                # Before anything new is computed and stored beside it.
                self._read_piece(path, ())
            else:
                missing.append((first, count))
        return missing

    def _refuse_foreign_pieces(self) -> None:
        """Pieces that this run does not have belong to another study, whose finished work must not be lost here."""
        own = {self.piece_path(first, count) for first, count in self.run.pieces()}
        stored = self.folder.iterdir() if self.folder.is_dir() else ()
        foreign = sorted(path for path in stored if _PIECE.fullmatch(path.name) and path not in own)
        if foreign:
            self._read_piece(foreign[0], ())
            raise ParameterError(
                f"{foreign[0]} holds work of a study with another number of members than {self.run.members}. Use the "
                "same options to go on with it, choose another folder with --out, or discard it with --fresh."
            )

    def save_piece(self, growth: FiniteTimeExponents, seconds: float) -> None:
        """Store the curves of some members.

        Raises:
            OutputError: the file could not be written.
        """
        arrays = {name: np.asarray(getattr(growth, name)) for name in MEMBER_ARRAYS}
        facts = {
            "fingerprint": fingerprint(self.run),
            "sha256": _digest(arrays),
            "seconds": seconds,
            "order": growth.order,
            "kernel": growth.kernel,
        }
        content = io.BytesIO()
        np.savez(content, allow_pickle=False, facts=np.array(json.dumps(facts)), **arrays)
        write_atomically(self.piece_path(growth.first, len(growth.exponent)), content.getvalue())

    def load_piece(self, first: int, count: int) -> tuple[dict[str, AnyArray], dict[str, Any]]:
        """The arrays of a stored piece and the facts about it, checked.

        Raises:
            DamagedFileError: the file is truncated or altered.
            ParameterError: it belongs to a study with other options.
        """
        path = self.piece_path(first, count)
        arrays, facts = self._read_piece(path, MEMBER_ARRAYS)
        if facts["sha256"] != _digest(arrays) or len(arrays["exponent"]) != count:
            raise _damaged(path, "its checksum does not match its numbers")
        return arrays, facts

    def _read_piece(self, path: Path, names: Sequence[str]) -> tuple[dict[str, AnyArray], dict[str, Any]]:
        """The arrays called `names` in a piece and the facts about it, which must be those of this run."""
        try:
            # Opened here: numpy would leave a damaged archive open.
            with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
                facts: dict[str, Any] = json.loads(str(archive["facts"]))
                arrays: dict[str, AnyArray] = {name: archive[name] for name in names}
            if not (_is_record(facts) and isinstance(facts["order"], int) and isinstance(facts["kernel"], str)):
                raise ValueError("what it says of itself has another form than liepoisson writes")
        # A damaged archive may fail in any of these ways, depending on which bytes were hit.
        except (*_UNREADABLE, KeyError, EOFError, TypeError, zipfile.BadZipFile, NotImplementedError) as error:
            raise _damaged(path, f"it cannot be read ({error})") from error
        _check_fingerprint(path, facts["fingerprint"], fingerprint(self.run))
        return arrays, facts

    def is_complete(self) -> bool:
        """Whether the joined data of the whole run are stored.

        Raises:
            DamagedFileError: the manifest cannot be read.
            ParameterError: they belong to a study with other options.
        """
        record = self._read_manifest().get(self.run.name)
        if record is None or not self.data.exists():
            return False
        wanted = {**fingerprint(self.run), "members": self.run.members}
        _check_fingerprint(self.data, record["fingerprint"], wanted)
        return True

    def save_whole(self, growth: FiniteTimeExponents, seconds: float) -> None:
        """Write the joined run as NetCDF, record it, and remove its pieces.

        Raises:
            OutputError: a file could not be written.
        """
        from liepoisson.io.netcdf import netcdf

        content = netcdf(growth.dataset)
        write_atomically(self.data, content)
        record = {
            "fingerprint": {**fingerprint(self.run), "members": self.run.members},
            "sha256": hashlib.sha256(content).hexdigest(),
            "seconds": seconds,
        }
        write_json(self._manifest, {**self._read_manifest(), self.run.name: record})
        with suppress(OSError):
            _remove(self.folder, _PIECE)
            # Gone with the last run; pieces of other runs keep it.
            self.folder.parent.rmdir()

    def load_whole(self) -> tuple[FiniteTimeExponents, float]:
        """The joined run and the seconds that its integration took, checked.

        Raises:
            DamagedFileError: the file was altered.
        """
        from liepoisson.saved.rerun import load

        record = self._read_manifest()[self.run.name]
        try:
            digest = _file_digest(self.data)
        except OSError as error:
            raise _damaged(self.data, f"it cannot be read ({error})") from error
        if digest != record["sha256"]:
            raise _damaged(self.data, "its checksum does not match the one in manifest.json")
        return load(self.data), float(record["seconds"])

    def _read_manifest(self) -> dict[str, Any]:
        if not self._manifest.exists():
            return {}
        try:
            records = json.loads(self._manifest.read_text(encoding="utf-8"))
            if not (isinstance(records, dict) and all(map(_is_record, records.values()))):
                raise ValueError("it has another form than liepoisson writes")
        except _UNREADABLE as error:
            # Without it no finished run is known to be sound.
            raise _damaged(self._manifest, f"it cannot be read ({error})", "every finished run is") from error
        return records


def discard(out: Path) -> None:
    """Remove the stored work of a study, and nothing else in its folder; emptied subfolders go too.

    Raises:
        OutputError: it could not be removed.
    """
    with writing(out):
        names = [run.name for run in plan(Settings())]
        for name in names:
            _remove(out / "pieces" / name, _PIECE)
            _remove(out / "data", re.compile(re.escape(name) + r"\.nc"))
        _remove(out / "data", _MANIFEST)
        with suppress(OSError):
            (out / "pieces").rmdir()


def remove_unfinished(out: Path) -> None:
    """Remove what a run that was killed has left of files that it was writing; files of others stay."""
    if out.is_dir():
        remove_partials(out, _RESULTS)
        remove_partials(out / "data", _DATA)
        for run in plan(Settings()):
            remove_partials(out / "pieces" / run.name, _PIECE)


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


def _digest(arrays: Mapping[str, AnyArray]) -> str:
    total = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def _file_digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _is_record(value: Any) -> bool:
    """Whether a value read from JSON says what determined some numbers, their checksum, and the time they took."""
    if not isinstance(value, dict):
        return False
    stored, digest, seconds = value.get("fingerprint"), value.get("sha256"), value.get("seconds")
    is_time = isinstance(seconds, (int, float)) and 0 <= seconds < 1e15
    return isinstance(stored, dict) and isinstance(digest, str) and is_time


def _damaged(path: Path, reason: str, computed_anew: str = "only its part is") -> DamagedFileError:
    return DamagedFileError(
        f"{path} is damaged: {reason}. Remove this file and run the same command again ({computed_anew} computed "
        "anew), or start over with --fresh."
    )


def _check_fingerprint(path: Path, stored: Mapping[str, object], wanted: Mapping[str, object]) -> None:
    if stored == wanted:
        return
    differences = [
        f"{key} {stored.get(key)} instead of {wanted[key]}" for key in wanted if stored.get(key) != wanted[key]
    ]
    raise ParameterError(
        f"{path} holds work of a study with other options: {', '.join(differences)}. Use the same options to go on "
        "with it, choose another folder with --out, or discard it with --fresh."
    )
