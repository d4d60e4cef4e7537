"""The results of a sweep in a Zarr folder, piece by piece, so that an interrupted sweep goes on from what it has.

    FILE.zarr/            attributes: the spec, its fingerprint, the version
      level0/             the grid; level1, level2, ... what refinement adds
        point             coordinates, (point, axis)
        value, outcome    (point, member), a chunk for each piece
        seconds           (piece,), the time that each took

A piece counts as done when the chunks of its values and of its outcomes are both there and whole: each ends in a
checksum, CRC-32C, and no point of it failed.  A file is written under another name and renamed, the outcomes last.
"""

from __future__ import annotations

import json
import shutil
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.arrays import Array
from liepoisson.errors import DamagedFileError, OutputError
from liepoisson.files import writing
from liepoisson.sweeps.errors import OtherSweepError
from liepoisson.sweeps.tasks import FAILED, NOT_COMPUTED, PieceResult

if TYPE_CHECKING:
    from liepoisson.sweeps.spec import SweepSpec

_MARK = "liepoisson sweep"


@dataclass
class Level:
    """The arrays of one level, in memory, and how they are cut.

    Attributes:
        points: Coordinates, shape (point, axis).
        size: Points of a piece.
        value: Shape (point, member); NaN where nothing is known.
        outcome: Codes of `OUTCOMES`, shape (point, member).
        seconds: Time of each piece; NaN where it is not known.
        done: Which pieces are there.
        method: How orbits were integrated, in words.
    """

    points: Array
    size: int
    value: Array
    outcome: NDArray[np.int8]
    seconds: Array
    done: NDArray[np.bool_]
    method: str = ""

    @classmethod
    def empty(cls, points: Array, size: int, n: int) -> Level:
        """A level of which nothing is computed yet."""
        pieces = -(-len(points) // size)
        shape = (len(points), n)
        blank = np.full(shape, NOT_COMPUTED, np.int8)
        return cls(points, size, np.full(shape, np.nan), blank, np.full(pieces, np.nan), np.zeros(pieces, bool))

    def rows(self, piece: int) -> slice:
        """The points of a piece."""
        return slice(piece * self.size, min((piece + 1) * self.size, len(self.points)))

    def keep(self, result: PieceResult) -> None:
        """Take over what a piece gave."""
        rows = self.rows(result.index)
        self.value[rows], self.outcome[rows] = result.value, result.outcome
        self.seconds[result.index], self.done[result.index] = result.seconds, True
        self.method = result.method or self.method


class SweepStore:
    """The folder of a sweep.

    Args:
        path: The folder; made if there is none.
        spec: What is computed.
        fresh: Remove what is there.

    Raises:
        OtherSweepError: the folder holds another sweep, or numbers of another version.
        OutputError: there is something else, or it can not be written.
        DamagedFileError: its description can not be read.
    """

    def __init__(self, path: Path, spec: SweepSpec, *, fresh: bool = False) -> None:
        self.path = path
        self._spec = spec
        self.damaged = 0
        self._open_arrays: dict[int, dict[str, Any]] = {}
        if path.exists() and not path.is_dir():
            raise OutputError(f"{path} must be a folder; it is a file. Choose another name for the store.")
        if (path / "zarr.json").exists():
            self._open(fresh)
        elif path.is_dir() and any(p.name != ".lock" for p in path.iterdir()):
            raise OutputError(f"{path} is not empty and holds no sweep. Choose another name for the store.")
        if not (path / "zarr.json").exists():
            self._create()

    def _open(self, fresh: bool) -> None:
        """Compare with what is there; remove it where it shall be."""
        attributes = read_attributes(self.path)
        if fresh:
            with writing(self.path):
                for entry in self.path.iterdir():
                    if entry.name != ".lock":
                        shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
        elif attributes["fingerprint"] != self._spec.fingerprint():
            raise OtherSweepError(
                f"{self.path} holds another sweep: {_difference(attributes['spec'], self._spec.record())}. Use the "
                "same spec and version to go on with it, choose another store, or discard it with fresh (--fresh)."
            )

    def _create(self) -> None:
        import zarr

        attributes = {
            "kind": _MARK,
            "spec": self._spec.record(),
            "fingerprint": self._spec.fingerprint(),
            "version": __version__,
            "held": self._spec.held(),
        }
        with _zarr(self.path):
            zarr.create_group(store=str(self.path), attributes=attributes, overwrite=False)

    def level(self, number: int, points: Array, size: int, n: int) -> Level:
        """A level with all of its pieces that are stored and whole; its arrays are made if there are none."""
        import zarr

        folder = self.path / f"level{number}"
        if not (folder / "seconds" / "zarr.json").exists():
            with _zarr(self.path):
                self._create_level(folder, points, size, n)
        try:
            arrays: Any = zarr.open_group(store=str(folder), mode="r", use_consolidated=False)
            stored, size = np.asarray(arrays["point"]), int(arrays["value"].chunks[0])
            if arrays["value"].shape != (len(points), n) or arrays["outcome"].chunks != arrays["value"].chunks:
                raise ValueError("its arrays have other shapes")
        except Exception as error:  # which one depends on which bytes are hit
            raise DamagedFileError(f"{folder} can not be read ({error}). Start over with fresh (--fresh).") from error
        if not np.array_equal(stored, points):
            raise DamagedFileError(f"{folder} has other points than its spec says. Start over with fresh (--fresh).")
        level = Level.empty(points, size, n)
        level.method = str(arrays.attrs.get("method", ""))
        for piece in range(len(level.done)):
            self._read_piece(folder, arrays, level, piece)
        return level

    def _create_level(self, folder: Path, points: Array, size: int, n: int) -> None:
        import zarr
        from zarr.codecs import Crc32cCodec, ZstdCodec

        group = zarr.open_group(store=str(folder), mode="a", attributes={"axes": [a.name for a in self._spec.axes]})
        pieces = -(-len(points) // size)
        # One file for each chunk, in one folder; a chunk of one value, too: its file says that the piece is done.
        common: dict[str, Any] = {
            "compressors": (ZstdCodec(level=3), Crc32cCodec()),
            "chunk_key_encoding": {"name": "v2", "separator": "."},
            "config": {"write_empty_chunks": True},
            "overwrite": True,
        }
        shapes = {
            "point": (points.shape, points.shape, "float64", np.nan, ("point", "axis")),
            "value": ((len(points), n), (size, n), "float64", np.nan, ("point", "member")),
            "outcome": ((len(points), n), (size, n), "int8", NOT_COMPUTED, ("point", "member")),
            "seconds": ((pieces,), (pieces,), "float64", np.nan, ("piece",)),
        }
        for name, (shape, chunks, dtype, fill, dims) in shapes.items():
            array = group.create_array(
                name, shape=shape, chunks=chunks, dtype=dtype, fill_value=fill, dimension_names=dims, **common
            )
            if name == "point":
                array[:] = points
        zarr.consolidate_metadata(str(self.path))

    def _read_piece(self, folder: Path, arrays: Any, level: Level, piece: int) -> None:
        names = [folder / name / f"{piece}.0" for name in ("value", "outcome")]
        if not all(name.exists() for name in names):
            return
        rows = level.rows(piece)
        try:
            value, outcome = np.asarray(arrays["value"][rows]), np.asarray(arrays["outcome"][rows])
        except Exception:  # which one depends on which bytes are hit
            self.damaged += 1
            return
        # A point that failed is tried again, with its piece.
        level.value[rows], level.outcome[rows], level.done[piece] = value, outcome, not (outcome == FAILED).any()

    def save(self, number: int, level: Level, result: PieceResult) -> None:
        """Store a piece.

        Raises:
            OutputError: it could not be written; what is stored stays.
        """
        rows = level.rows(result.index)
        with _zarr(self.path):
            arrays = self._arrays(number)
            for name, values in (("value", result.value), ("outcome", result.outcome)):
                arrays[name][rows] = values

    def _arrays(self, number: int) -> dict[str, Any]:
        """The arrays of a level for writing, opened once."""
        import zarr

        if number not in self._open_arrays:
            group: Any = zarr.open_group(store=str(self.path / f"level{number}"), mode="r+", use_consolidated=False)
            written = {name: group[name].with_config({"write_empty_chunks": True}) for name in ("value", "outcome")}
            self._open_arrays[number] = {**written, "seconds": group["seconds"]}
        return self._open_arrays[number]

    def save_facts(self, number: int, level: Level) -> None:
        """Store the time that each piece took, where it is known, and the method."""
        import zarr

        with _zarr(self.path):
            seconds = self._arrays(number)["seconds"]
            seconds[:] = np.where(np.isfinite(level.seconds), level.seconds, np.asarray(seconds[:]))
            group = zarr.open_group(store=str(self.path / f"level{number}"), mode="r+", use_consolidated=False)
            group.attrs["method"] = level.method


def read_attributes(path: Path) -> dict[str, Any]:
    """What a store says of itself.

    Raises:
        DamagedFileError: it is no store of a sweep, or can not be read.
    """
    try:
        attributes = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
        if attributes["kind"] != _MARK or not isinstance(attributes["fingerprint"], str):
            raise ValueError("it says something else")
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise DamagedFileError(
            f"{path} is no sweep that can be read ({error}). Remove the folder, or choose another store."
        ) from error
    return attributes


def _difference(stored: dict[str, Any], wanted: dict[str, Any]) -> str:
    names = [name for name in wanted if stored.get(name) != json.loads(json.dumps(wanted[name]))]
    shown = [f"{name} {stored.get(name)!s:.80} instead of {wanted[name]!s:.80}" for name in names]
    return "; ".join(shown) or "its description was altered"


@contextmanager
def _zarr(path: Path) -> Generator[None]:
    """Failures of the file system as an `OutputError`; no remark that consolidated metadata are an extension."""
    with writing(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
