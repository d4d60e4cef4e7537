"""NetCDF files with a checksum, read only after it and the file's structure were verified.

A file is plain NetCDF-4 (HDF5), followed by one line with the SHA-256 digest of all bytes before it; HDF5 does not look
at what follows its own end.  So every change of a file is found before HDF5 reads any of it.

A checksum tells of damage, not of malice: whoever writes a file can write its checksum.  HDF5 files can name other
files to be read in their place, and declare sizes that they do not have.  Hence only what liepoisson writes is read:
variables of numbers and texts, stored in the file itself, uncompressed, not larger than the file.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from liepoisson.errors import DamagedFileError, OutputError

if TYPE_CHECKING:
    import h5py
    from xarray import Dataset

T = TypeVar("T")

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_SEAL = b"\nliepoisson sha256 "
_SEAL_LENGTH = len(_SEAL) + 64 + 1

_PLAIN = "fiuS"
"""Kinds of numbers, and of texts of one length."""
_DIMENSION_ONLY = b"This is a netCDF dimension but not a netCDF variable"
# References from variables to their dimensions and back.  NetCDF-4 has them by these names; they stay inside the file.
_OF_DIMENSIONS = ("DIMENSION_LIST", "REFERENCE_LIST")
_STARTING, _READING, _LEAST_SPEED = 60.0, 5.0, 5e6
"""Seconds for a process to start, to read a small file, and bytes a second of a large one.

Measured on one core: 0.7 seconds, 2 milliseconds, 1e9 bytes a second.
"""
_TEXT_RECORD = 16
"""Bytes of a text in a variable: its length (4), and where it is (12)."""


def netcdf(dataset: Dataset) -> memoryview:
    """The content of a NetCDF file, with its checksum.

    Made in memory, once: HDF5 does not survive a disk that fills up under a file that it has open.

    Raises:
        OutputError: NetCDF cannot hold it, for example a name with a NUL character.
    """
    # no numbers that stand for missing ones: NaN is NaN
    encoding: Any = {name: {"_FillValue": None} for name in dataset.variables}
    try:
        content = io.BytesIO()
        _uninterrupted(lambda: dataset.to_netcdf(content, engine="h5netcdf", encoding=encoding))
    except (TypeError, ValueError, KeyError, OSError, RuntimeError) as error:
        raise OutputError(
            f"could not be written as NetCDF ({error!s:.200}); look at the names of the system and its components"
        ) from error
    digest = hashlib.sha256(content.getbuffer()).hexdigest()
    content.seek(0, io.SEEK_END)
    content.write(_SEAL + digest.encode() + b"\n")
    return content.getbuffer()


def read_netcdf(path: Path, *, verify: bool = True, trial: Trial | None = None) -> Dataset:
    """The dataset of a file, in memory.

    Args:
        path: The file.
        verify: Whether its checksum must be there and right.
        trial: Where a file is tried whose checksum is not; by default a process of its own, started for it.

    Raises:
        DamagedFileError: it cannot be read, was changed, or has a structure that liepoisson does not write.
    """
    try:
        with path.open("rb") as file:
            content = file.read(len(_SIGNATURE))
            if content != _SIGNATURE:  # before the rest, which may be large
                raise DamagedFileError(f"{path}: wanted NetCDF-4 (HDF5); got another kind of file; look at the name")
            content += file.read()
    except DamagedFileError:
        raise
    except OSError as error:
        raise DamagedFileError(f"{path}: cannot be read ({error!s:.200}); make it again") from error
    if verify:
        _verify(path, content)
    elif sys.platform != "emscripten":  # a page in a browser has one process
        with contextlib.nullcontext(trial) if trial else Trial() as where:
            where.read(path, content)
    return _read(path, content)


def _read(path: Path, content: bytes) -> Dataset:
    import xarray as xr

    def load() -> Dataset:
        _check_structure(path, content)
        # units and fill values of other programs are not interpreted: numbers are as they are stored
        with xr.open_dataset(io.BytesIO(content), engine="h5netcdf", decode_times=False) as file:
            return file.load()

    try:
        return _uninterrupted(load)
    except DamagedFileError:
        raise
    except Exception as error:  # whatever HDF5 and its wrappers raise on a damaged or foreign file
        raise DamagedFileError(f"{path}: cannot be read as NetCDF ({error!s:.200}); make it again") from error


def _uninterrupted(work: Callable[[], T]) -> T:
    """What a function returns that uses HDF5; Ctrl-C is heard when it is done.

    In a thread of its own, since signals come to the main thread only: an exception inside of xarray leaves its locks
    taken, so that every later file of the process waits for ever; one inside of h5py is lost, or becomes an OSError.
    """
    if sys.platform == "emscripten":  # it has no threads
        return work()
    with ThreadPoolExecutor(1) as worker:
        return worker.submit(work).result()


class Trial:
    """A process in which files without a checksum are read first, and which can be ended.

    On some damaged files HDF5 never returns, and holds the interpreter meanwhile, so that neither Ctrl-C nor a limit of
    time helps.  What was read there once can be read here.
    """

    def __init__(self) -> None:
        begin = f"import sys; sys.path[:] = {sys.path!r}; from liepoisson.io.netcdf import serve_trials; serve_trials()"
        self._process = subprocess.Popen(
            [sys.executable, "-c", begin], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )
        self._said: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def read(self, path: Path, content: bytes) -> None:
        """Returns if the file can be read.

        Raises:
            DamagedFileError: it cannot, or reading it did not end.
        """
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.write(len(content).to_bytes(8, "little") + content)
            self._process.stdin.flush()
        if self._answer(_STARTING) != b"begins":
            raise DamagedFileError(f"{path}: could not be tried in another process ({sys.executable}); try verify=True")
        if self._answer(_READING + len(content) / _LEAST_SPEED) != b"ended":
            raise DamagedFileError(f"{path}: is damaged so that HDF5 does not come to an end with it; make it again")

    def _answer(self, limit: float) -> bytes:
        """What the process says; nothing if it does not, or has ended.  Ctrl-C is seen between short waits."""
        end = time.monotonic() + limit
        while time.monotonic() < end:
            with contextlib.suppress(queue.Empty):
                return self._said.get(timeout=0.05)
        return b""

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._said.put(line.strip())
        self._said.put(b"")

    def __enter__(self) -> Trial:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        self._listener.join()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with contextlib.suppress(BrokenPipeError):
                pipe.close()


def serve_trials() -> None:
    """Reads what comes, until nothing comes; a file that is refused is one that ends."""
    with contextlib.suppress(Exception):
        import h5netcdf  # noqa: F401  # pyright: ignore[reportMissingTypeStubs, reportUnusedImport]
        import xarray  # noqa: F401  # pyright: ignore[reportUnusedImport]
    receive, tell = sys.stdin.buffer, sys.stdout.buffer
    while size := receive.read(8):
        content = receive.read(int.from_bytes(size, "little"))
        tell.write(b"begins\n")
        tell.flush()
        with contextlib.suppress(DamagedFileError):
            _read(Path("tried"), content)
        tell.write(b"ended\n")
        tell.flush()


def _verify(path: Path, content: bytes) -> None:
    """Compares the checksum."""
    end = content[-_SEAL_LENGTH:]
    if not (end.startswith(_SEAL) and end.endswith(b"\n")):
        raise DamagedFileError(
            f"{path}: wanted a checksum of liepoisson at its end; got none: it may be truncated, or another program "
            "(or an older liepoisson) wrote or changed it. Make it again; if you changed it on purpose, read it with "
            "load(path, verify=False)"
        )
    found = hashlib.sha256(memoryview(content)[:-_SEAL_LENGTH]).hexdigest().encode()
    if found != end[len(_SEAL) : -1]:
        raise DamagedFileError(
            f"{path}: its checksum does not match its contents: it was damaged or changed after liepoisson wrote it. "
            "Make it again; if you changed it on purpose, read it with load(path, verify=False)"
        )


def _check_structure(path: Path, content: bytes) -> None:
    """Refuses what liepoisson does not write, before anything of it is read."""
    import h5py

    with h5py.File(io.BytesIO(content), "r") as file:
        total = _check_attributes(path, "the file", file)
        for name in map(str, file):
            if not isinstance(file.get(name, getlink=True), h5py.HardLink):
                raise _foreign(path, name, "a link to something else")
            if file.get(name, getclass=True) is not h5py.Dataset:
                raise _foreign(path, name, "no variable")
            variable = file[name]
            assert isinstance(variable, h5py.Dataset)
            total += _check_attributes(path, name, variable) + _size(path, name, variable, content)
            if total > len(content):
                raise _foreign(path, name, "larger than the file")


def _size(path: Path, name: str, variable: h5py.Dataset, content: bytes) -> int:
    """Bytes that reading a variable takes; it must be stored in the file, uncompressed."""
    import h5py

    how, kind = variable.id.get_create_plist(), variable.dtype
    if how.get_layout() == h5py.h5d.VIRTUAL or how.get_external_count():
        raise _foreign(path, name, "kept in another file")
    if how.get_nfilters():
        raise _foreign(path, name, "compressed")
    is_text = kind.kind == "O" and h5py.check_string_dtype(kind) is not None
    if not is_text and (kind.kind not in _PLAIN or h5py.check_enum_dtype(kind) is not None):
        raise _foreign(path, name, f"of type {kind}")
    n = int(variable.id.get_space().get_simple_extent_npoints())
    stored = int(variable.id.get_storage_size())
    if n == 0 or (stored == 0 and _is_dimension_only(variable)):  # nothing to read
        return 0
    wanted = n * (_TEXT_RECORD if is_text else kind.itemsize)
    if stored < wanted:
        raise _foreign(path, name, "larger than what is stored of it")
    return wanted + (_text_size(path, name, variable, content, n) if is_text else 0)


def _is_dimension_only(variable: h5py.Dataset) -> bool:
    """Whether it stands for a dimension without values, which is not read."""
    name = variable.attrs.get("NAME")
    return isinstance(name, bytes) and name.startswith(_DIMENSION_ONLY)


def _text_size(path: Path, name: str, variable: h5py.Dataset, content: bytes, n: int) -> int:
    """Bytes of all texts of a variable, from their records: two texts may claim the same place."""
    start = variable.id.get_offset()
    if start is None or start + n * _TEXT_RECORD > len(content):  # in chunks
        raise _foreign(path, name, "a variable of texts in pieces")
    records = np.frombuffer(content, dtype="<u4", count=4 * n, offset=start)
    return int(records[::4].sum(dtype=np.uint64))


def _check_attributes(path: Path, name: str, owner: h5py.File | h5py.Dataset) -> int:
    """Refuses attributes that are neither numbers nor one text; the bytes of the others."""
    import h5py

    total = 0
    for key in owner.attrs:
        attribute: Any = owner.attrs.get_id(key)
        kind, n = attribute.dtype, int(np.prod(attribute.shape, dtype=np.float64))
        stored = int(attribute.get_storage_size())
        if key in _OF_DIMENSIONS:
            continue
        if kind.kind == "O" and h5py.check_string_dtype(kind) is not None and n == 1:
            continue
        if kind.kind not in _PLAIN or n * kind.itemsize > stored:
            raise _foreign(path, name, f"one with an attribute {key!r:.60} that is neither numbers nor a text")
        total += stored
    return total


def _foreign(path: Path, name: str, what: str) -> DamagedFileError:
    return DamagedFileError(
        f"{path}: wanted variables of numbers and texts, stored in the file itself; {name!r:.60} is {what}. liepoisson "
        "did not write it; if you trust it, open it with xarray.open_dataset"
    )
