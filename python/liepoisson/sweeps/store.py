"""The results of a sweep in a Zarr folder, piece by piece, so that an interrupted sweep goes on from what it has.

    FILE.zarr/            attributes: the spec, its fingerprint, the version
      level0/             the grid; level1, level2, ... what refinement adds
        point             coordinates, (point, axis)
        value, outcome    (point, member), a chunk for each piece; with noise also error
        seconds           (piece,), the time that each took

A piece counts as done when the chunks of its values and of its outcomes are all there, whole and in their place, and
no point of it failed.  A chunk is a Zstandard frame, a skippable frame (RFC 8878, 3.1.2) with a digest of its place
(the sweep, the level, the array, the piece), which other readers pass over, and the checksum CRC-32C of both.  A file
is written under another name and renamed, the outcomes last.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import struct
import warnings
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.errors import DamagedFileError, LiePoissonError, OutputError
from liepoisson.inputs.arrays import Array
from liepoisson.io.files import another_format, writing
from liepoisson.sweeps.tasks import FAILED, NOT_COMPUTED, PieceResult

if TYPE_CHECKING:
    from liepoisson.sweeps.spec import SweepSpec

_MARK = "liepoisson sweep"
_FORMAT = 2
"""Of the folder; 2: the chunks name their places."""
_SKIPPABLE = 0x184D2A5C
"""One of the sixteen magic numbers of skippable frames."""
_ZSTD_LEVEL = 3
_LEVEL = re.compile("level[0-9]+")
_PARTIAL = re.compile(r"[0-9.]+\.[0-9]+\.partial")


class OtherSweepError(LiePoissonError):
    """A store holds the numbers of another sweep, or of another version of liepoisson."""


@dataclass
class Level:
    """The arrays of one level, in memory, and how they are cut."""

    points: Array  # coordinates, shape (point, axis)
    size: int  # points of a piece
    value: Array  # shape (point, member); NaN where nothing is known
    outcome: NDArray[np.int8]  # codes of `OUTCOMES`, shape (point, member)
    seconds: Array  # time of each piece; NaN where it is not known
    done: NDArray[np.bool_]  # which pieces are there
    error: Array | None = None  # standard error over time of each value, shape (point, member), where they have one
    method: str = ""  # how orbits were integrated, in words

    @classmethod
    def empty(cls, points: Array, size: int, n: int, *, errors: bool = False) -> Level:
        """A level of which nothing is computed yet."""
        pieces = -(-len(points) // size)
        shape = (len(points), n)
        blank = np.full(shape, NOT_COMPUTED, np.int8)
        error = np.full(shape, np.nan) if errors else None
        return cls(points, size, np.full(shape, np.nan), blank, np.full(pieces, np.nan), np.zeros(pieces, bool), error)

    def rows(self, piece: int) -> slice:
        """The points of a piece."""
        return slice(piece * self.size, min((piece + 1) * self.size, len(self.points)))

    def keep(self, result: PieceResult) -> None:
        """Take over what a piece gave."""
        rows = self.rows(result.index)
        self.value[rows], self.outcome[rows] = result.value, result.outcome
        if self.error is not None and result.error is not None:
            self.error[rows] = result.error
        self.seconds[result.index], self.done[result.index] = result.seconds, True
        self.method = result.method or self.method


class SweepStore:
    """The folder of a sweep, made if there is none; `fresh` discards what it holds."""

    def __init__(self, path: Path, spec: SweepSpec, *, fresh: bool = False) -> None:
        self.path = path
        self.spec = spec
        self._fingerprint = spec.fingerprint()
        self.damaged = 0
        self._is_read_only = False
        if path.exists() and not path.is_dir():
            raise OutputError(f"{path} must be a folder; it is a file. Choose another name for the store.")
        if (path / "zarr.json").exists():
            self._open(fresh)
        elif path.is_dir() and any(p.name != ".lock" for p in path.iterdir()):
            raise OutputError(f"{path} is not empty and holds no sweep. Choose another name for the store.")
        if not (path / "zarr.json").exists():
            self._create()

    @classmethod
    def as_found(cls, path: Path) -> SweepStore:
        """The store in a folder as it is, to be read only."""
        from liepoisson.sweeps.spec import SweepSpec

        attributes = read_attributes(path)
        if attributes.get("format") != _FORMAT:
            raise OtherSweepError(f"{path} holds a sweep: {_another_format(attributes)}.")
        digest = hashlib.sha256(json.dumps(attributes.get("spec"), sort_keys=True).encode()).hexdigest()
        if digest != attributes.get("fingerprint"):
            raise DamagedFileError(f"{path}: its description was changed after the sweep was made. Make it again.")
        store = cls.__new__(cls)
        store.path, store.damaged, store._is_read_only = path, 0, True
        try:
            store.spec = SweepSpec.of_record(attributes["spec"], attributes.get("description"))
        except LiePoissonError:
            raise
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise DamagedFileError(f"{path}: its description cannot be read ({error!r:.100})") from error
        store._fingerprint = attributes["fingerprint"]
        return store

    def _open(self, fresh: bool) -> None:
        """Compare with what is there; remove it where it shall be."""
        attributes = read_attributes(self.path)
        if fresh:
            with writing(self.path):
                for entry in self.path.iterdir():
                    if _LEVEL.fullmatch(entry.name) and entry.is_dir():
                        shutil.rmtree(entry)
                # Last: until then the folder is known as that of a sweep.
                (self.path / "zarr.json").unlink()
        elif attributes.get("format") != _FORMAT:
            raise OtherSweepError(
                f"{self.path} holds a sweep: {_another_format(attributes)}. Choose another store for a new one, or "
                "discard it with fresh (--fresh)."
            )
        elif attributes.get("fingerprint") != self._fingerprint:
            raise OtherSweepError(
                f"{self.path} holds another sweep: {_difference(attributes['spec'], self.spec.record())}. Use the "
                "same spec and version to go on with it, choose another store, or discard it with fresh (--fresh)."
            )

    def _create(self) -> None:
        import zarr

        attributes = {
            "kind": _MARK,
            "format": _FORMAT,
            "spec": self.spec.record(),
            "fingerprint": self._fingerprint,
            "version": __version__,
            "held": self.spec.held(),
            "description": self.spec.description(),
        }
        with _zarr(self.path):
            zarr.create_group(store=str(self.path), attributes=attributes, overwrite=False)

    def level(self, number: int, points: Array, size: int, n: int, *, errors: bool = False) -> Level:
        """A level with all of its pieces that are stored, whole and in their place; `errors`: of values with errors.

        Arrays that are not there are made, except where the store is only read.
        """
        import zarr

        folder = self.path / f"level{number}"
        try:
            size = _stored_size(folder, size)
            if not self._is_read_only:
                self._make_ready(folder, points, size, n, errors=errors)
            arrays: Any = zarr.open_group(store=str(folder), mode="r", use_consolidated=False)
            _check_arrays(arrays, _layouts(len(points), len(self.spec.axes), n, size, errors=errors))
            stored = np.asarray(arrays["point"])
        except OutputError:
            raise
        except Exception as error:  # which one depends on which bytes are hit
            raise DamagedFileError(f"{folder} cannot be read ({error}). {self._advice}") from error
        if not np.array_equal(stored, points):
            raise DamagedFileError(f"{folder} has other points than its spec says. {self._advice}")
        level = Level.empty(points, size, n, errors=errors)
        level.method = str(arrays.attrs.get("method", ""))
        for piece in range(len(level.done)):
            self._read_piece(folder, arrays, level, piece)
        return level

    @property
    def _advice(self) -> str:
        """What to try with a store that is damaged; who only reads it shall not discard it."""
        return "Copy it again from where it was made." if self._is_read_only else "Start over with fresh (--fresh)."

    def _make_ready(self, folder: Path, points: Array, size: int, n: int, *, errors: bool) -> None:
        """Make the arrays that are not there, and remove what a process that was killed has left."""
        with _zarr(self.path):
            self._create_level(folder, points, _layouts(len(points), points.shape[1], n, size, errors=errors))
            for partial in folder.glob("*/*.partial"):  # this process has the lock
                if _PARTIAL.fullmatch(partial.name):
                    partial.unlink(missing_ok=True)

    def _create_level(self, folder: Path, points: Array, layouts: Mapping[str, Any]) -> None:
        """Make what is not there: all of a new level, or what was removed from it."""
        import zarr

        absent = [name for name in layouts if not (folder / name / "zarr.json").exists()]
        has_points = (folder / "point" / "0.0").exists()
        if not absent and has_points and (folder / "zarr.json").exists():
            return
        attributes: dict[str, Any] = {"axes": [axis.name for axis in self.spec.axes]}
        group: Any = zarr.open_group(store=str(folder), mode="a", attributes=attributes, use_consolidated=False)
        for name in absent:
            group.create_array(name, **layouts[name])
        if not has_points:
            group["point"][:] = points
        zarr.consolidate_metadata(str(self.path))

    def _read_piece(self, folder: Path, arrays: Any, level: Level, piece: int) -> None:
        arrays_of_level = _stored(level)
        files = [folder / name / f"{piece}.0" for name in arrays_of_level]
        if not all(file.exists() for file in files):
            return
        rows = level.rows(piece)
        try:
            for file in files:
                mark = self._mark_of(file, level.size)
                if file.read_bytes()[-4 - len(mark) : -4] != mark:
                    raise ValueError("it belongs to another place")
            # These reads check the sums, and with them the marks.
            found = {name: np.asarray(arrays[name][rows]) for name in arrays_of_level}
        except Exception:  # which one depends on which bytes are hit
            self.damaged += 1
            return
        # A point that failed is tried again, with its piece.
        for name, array in arrays_of_level.items():
            array[rows] = found[name]
        level.done[piece] = not (found["outcome"] == FAILED).any()

    def save(self, number: int, level: Level, result: PieceResult) -> None:
        """Store a piece."""
        rows = level.rows(result.index)
        n_filled = level.size - (rows.stop - rows.start)
        with writing(self.path):
            for name, values in _stored(result).items():
                dtype, fill = np.dtype(_DTYPES[name]).newbyteorder("<"), NOT_COMPUTED if name == "outcome" else np.nan
                chunk = np.pad(values.astype(dtype), ((0, n_filled), (0, 0)), constant_values=fill)
                file = self.path / f"level{number}" / name / f"{result.index}.0"
                _replace(file, _encoded(chunk.tobytes(), self._mark_of(file, level.size)))

    def _mark_of(self, file: Path, size: int) -> bytes:
        """The skippable frame of a chunk: a digest of the sweep and of the place in it."""
        place = f"{self._fingerprint} {file.parent.parent.name} {file.parent.name} {file.name} {size}"
        digest = hashlib.sha256(place.encode()).digest()[:16]
        return struct.pack("<II", _SKIPPABLE, len(digest)) + digest

    def save_facts(self, number: int, level: Level) -> None:
        """Store the time that each piece took, where it is known, and the method."""
        import zarr

        with _zarr(self.path):
            group: Any = zarr.open_group(store=str(self.path / f"level{number}"), mode="r+", use_consolidated=False)
            seconds = group["seconds"]
            try:
                stored = np.asarray(seconds[:])
            except Exception:  # which one depends on which bytes are hit; times are no reason to refuse a sweep
                stored = np.full(len(level.seconds), np.nan)
            seconds[:] = np.where(np.isfinite(level.seconds), level.seconds, stored)
            group.attrs["method"] = level.method


def _another_format(attributes: Mapping[str, Any]) -> str:
    """What is said of a store in another format; the first one named none."""
    return another_format(attributes.get("format", 1), _FORMAT, attributes.get("version"))


def read_attributes(path: Path) -> dict[str, Any]:
    """What a store says of itself."""
    try:
        attributes = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
        if attributes["kind"] != _MARK or not isinstance(attributes["fingerprint"], str):
            raise ValueError("it says something else")
    except FileNotFoundError as error:
        raise DamagedFileError(
            f"{path}: wanted the folder of a sweep, which has a file zarr.json; got a folder without one. Look at the "
            "name; for a result that was saved, give the name of its file"
        ) from error
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise DamagedFileError(
            f"{path}: wanted the folder of a sweep; its description zarr.json cannot be read as that of one "
            f"({error!s:.200}). Look at the name, or choose another store; fresh (--fresh) does not help: it "
            "discards only what its description says to be a sweep."
        ) from error
    return attributes


_DTYPES = {"point": "float64", "value": "float64", "error": "float64", "outcome": "int8", "seconds": "float64"}


def _stored(of: Level | PieceResult) -> dict[str, NDArray[Any]]:
    """The arrays of which each piece has a chunk; the outcomes, which are written last, are the last."""
    errors: dict[str, NDArray[Any]] = {} if of.error is None else {"error": of.error}
    return {"value": of.value, **errors, "outcome": of.outcome}


def _layouts(n_points: int, n_axes: int, n: int, size: int, *, errors: bool) -> dict[str, dict[str, Any]]:
    """The arrays of a level, as Zarr makes them."""
    from zarr.codecs import Crc32cCodec, ZstdCodec

    pieces = -(-n_points // size)
    shapes: dict[str, Any] = {
        "point": ((n_points, n_axes), (n_points, n_axes), np.nan, ("point", "axis")),
        "value": ((n_points, n), (size, n), np.nan, ("point", "member")),
        **({"error": ((n_points, n), (size, n), np.nan, ("point", "member"))} if errors else {}),
        "outcome": ((n_points, n), (size, n), NOT_COMPUTED, ("point", "member")),
        "seconds": ((pieces,), (pieces,), np.nan, ("piece",)),
    }
    return {
        name: {
            "shape": shape,
            "chunks": chunks,
            "dtype": _DTYPES[name],
            "fill_value": fill,
            "dimension_names": dims,
            "compressors": (ZstdCodec(level=_ZSTD_LEVEL), Crc32cCodec()),
            # One file for each chunk, in one folder.
            "chunk_key_encoding": {"name": "v2", "separator": "."},
        }
        for name, (shape, chunks, fill, dims) in shapes.items()
    }


def _stored_size(folder: Path, size: int) -> int:
    """Points of a piece where some are stored; `size` where none are."""
    import zarr

    for name in ("value", "outcome"):
        if (folder / name / "zarr.json").exists():
            stored = int(cast("Any", zarr.open_array(store=str(folder / name), mode="r")).chunks[0])
            if stored < 1:
                raise ValueError(f"{name} has pieces of {stored} points")
            return stored
    return size


def _check_arrays(arrays: Any, layouts: dict[str, dict[str, Any]]) -> None:
    """Refuse arrays that are not as they are made here: of other shapes, other types, or encoded in another way."""
    import zarr
    from zarr.storage import MemoryStore

    wanted: Any = zarr.create_group(store=MemoryStore())
    for name, layout in layouts.items():
        right, found = (array.metadata.to_dict() for array in (wanted.create_array(name, **layout), arrays[name]))
        for key in ("data_type", "shape", "chunk_grid", "chunk_key_encoding", "codecs"):
            if right[key] != found[key]:
                raise ValueError(f"the {key} of {name} is {found[key]!s:.80} instead of {right[key]!s:.80}")


def _encoded(content: bytes, mark: bytes) -> bytes:
    """The file of a chunk: what Zarr's codecs zstd and crc32c read, with a mark in a frame that zstd skips."""
    import google_crc32c
    from numcodecs import Zstd

    body = bytes(Zstd(level=_ZSTD_LEVEL).encode(content)) + mark
    return body + struct.pack("<I", google_crc32c.value(body))


def _replace(file: Path, content: bytes) -> None:
    """Write a file so that it is whole or not there; no wait for the disk, as a checksum tells what a crash left."""
    partial = file.with_name(f"{file.name}.{os.getpid()}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(file)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def _difference(stored: dict[str, Any], wanted: dict[str, Any]) -> str:
    plain = json.loads(json.dumps(wanted))
    found = [
        _first_difference(name, stored.get(name), plain[name]) for name in plain if stored.get(name) != plain[name]
    ]
    return "; ".join(found) or "its description was altered"


def _first_difference(name: str, stored: Any, wanted: Any) -> str:
    """Where two values differ, in words; of lists and tables the first place."""
    if isinstance(stored, list) and isinstance(wanted, list):
        if len(stored) != len(wanted):
            return f"{name} with {len(stored)} items instead of {len(wanted)}"
        k = next(k for k, item in enumerate(stored) if item != wanted[k])
        return _first_difference(f"{name}[{k}]", stored[k], wanted[k])
    if isinstance(stored, dict) and isinstance(wanted, dict):
        key = next(key for key in {**stored, **wanted} if stored.get(key) != wanted.get(key))
        return _first_difference(f"{name}.{key}", stored.get(key), wanted.get(key))
    return f"{name} {stored!s:.80} instead of {wanted!s:.80}"


@contextmanager
def _zarr(path: Path) -> Generator[None]:
    """Failures of the file system as an `OutputError`; no remark that consolidated metadata are an extension."""
    with writing(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
