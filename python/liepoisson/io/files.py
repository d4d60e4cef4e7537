"""Writing files whole or not at all, one process to a folder, with errors that say what to try.

A file is written under a name that ends in `.partial`, locked while its process lives, and then renamed.  What a
process that was killed has left is not locked any more: the next one that writes the same file removes it.
"""

from __future__ import annotations

import errno
import json
import os
import re
import stat
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from liepoisson.errors import OutputError

_ADVICE = {
    errno.ENOSPC: "Free some space, or choose another folder; what is finished is kept.",
    errno.EDQUOT: "Free some space, or choose another folder; what is finished is kept.",
    errno.EFBIG: "The file-size limit is too low (ulimit -f), or choose another folder; what is finished is kept.",
    errno.ENOTDIR: "A part of the path is a file; choose another folder.",
    errno.EEXIST: "There is a file where a folder is wanted; choose another folder.",
    errno.EACCES: "No permission to write there; choose another folder.",
    errno.ENAMETOOLONG: "Choose a shorter name; what is finished is kept.",
    errno.EROFS: "The file system is read-only; choose another folder.",
}

# How a file system without locks answers.
_NO_LOCKS = {errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS, errno.EINVAL}

# Windows does not, and has no locks of this kind.
_RENAMES_OPEN_FILES = os.name != "nt"


def read_text(path: str | Path, *, most: int) -> str:
    """The text of a regular file of at most so many bytes.

    Raises:
        OSError: there is none, or it is a device, a pipe or a folder.
        ValueError: it has more bytes, or is not in UTF-8.
    """
    path = Path(path)
    if not stat.S_ISREG(path.stat().st_mode):  # a device may have no end, and a pipe waits for its other end
        raise OSError(errno.EINVAL, "it is no regular file")
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"it has more than {most:,} bytes")
    return content.decode("utf-8")


@contextmanager
def writing(path: Path) -> Generator[None]:
    """Turn a failure of the file system inside the block into an `OutputError` that says what to try."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        advice = _ADVICE.get(error.errno or 0, "Choose another folder; what is finished is kept.")
        raise OutputError(f"could not write {path}: {error.strerror or error}. {advice}") from error


def write_atomically(path: Path, content: bytes | memoryview) -> None:
    """Write a file so that it is either whole or not there; a symbolic link stays, what it points to is written.

    Raises:
        OutputError: it could not be written, or there is something else than a regular file.
    """
    target = _target(path)
    with writing(path):
        target.parent.mkdir(parents=True, exist_ok=True)
        remove_partials(target.parent, re.compile(re.escape(target.name)))
        descriptor, partial = _open_partial(target)
        try:
            with os.fdopen(descriptor, "wb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
                if _RENAMES_OPEN_FILES:  # while it is locked
                    partial.replace(target)
            if not _RENAMES_OPEN_FILES:
                partial.replace(target)
        except BaseException:
            partial.unlink(missing_ok=True)
            raise


_PARTIAL = re.compile(r"(.+)\.[0-9]+-[0-9a-f]{8}\.partial", re.DOTALL)


def _open_partial(target: Path) -> tuple[int, Path]:
    """A new file beside the target, locked; no other process may write to its name, not even one on another machine."""
    while True:
        partial = target.with_name(f"{target.name}.{os.getpid()}-{os.urandom(4).hex()}.partial")
        descriptor = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
        try:
            _locked(descriptor)
            # Another process may have found it before the lock, and removed it.
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(descriptor), partial.stat()):
                    return descriptor, partial
        except BaseException:
            os.close(descriptor)
            partial.unlink(missing_ok=True)
            raise
        os.close(descriptor)


def remove_partials(folder: Path, names: re.Pattern[str]) -> None:
    """Remove what processes that were killed have left of files with such names, where files can be locked.

    A file that some process is still writing is locked and stays.
    """
    found: list[Path] = []
    with suppress(OSError):  # a folder may be written to, and not read
        found = list(folder.iterdir())
    for path in found:
        match = _PARTIAL.fullmatch(path.name)
        if match is None or names.fullmatch(match[1]) is None or path.is_symlink() or not path.is_file():
            continue
        with suppress(OSError):  # another process was quicker, or it is not ours to remove
            descriptor = os.open(path, os.O_RDONLY)
            try:
                if _locked(descriptor):
                    path.unlink()
            finally:
                os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Whether an open file is now locked by this process; not where another one holds it or there are no locks."""
    try:
        import fcntl
    except ImportError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if isinstance(error, BlockingIOError) or error.errno in _NO_LOCKS:
            return False
        raise
    return True


def _target(path: Path) -> Path:
    """The regular file that `path` stands for, which need not exist yet."""
    try:
        with writing(path):
            mode = path.stat().st_mode
    except ValueError as error:
        raise OutputError(f"could not write {str(path)!r}: not a file name ({error}). Choose another name.") from error
    except OutputError as error:
        if not isinstance(error.__cause__, FileNotFoundError):
            raise
    else:
        if stat.S_ISDIR(mode):
            raise OutputError(f"could not write {path}: wanted a file, got a folder. Add a file name.")
        if not stat.S_ISREG(mode):
            raise OutputError(
                f"could not write {path}: wanted a regular file, got a device, pipe or socket. Choose another name."
            )
    return Path(os.path.realpath(path))


@contextmanager
def exclusive(folder: Path) -> Generator[None]:
    """Make a folder if there is none, and keep other processes from working in it while the block runs.

    The lock is advisory, the file `.lock`; it ends with the process.  Where the system has no such locks there is none.

    Raises:
        OutputError: another process holds the folder, or it cannot be made.
    """
    try:
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
            lock = _lock(folder)
    except ValueError as error:
        raise OutputError(f"could not write {str(folder)!r}: not a name ({error}). Choose another folder.") from error
    try:
        yield
    finally:
        if lock is not None:
            with suppress(OSError):
                # While it is still locked; a file that says something is not ours.
                if os.fstat(lock).st_size == 0:
                    (folder / ".lock").unlink()
            os.close(lock)


def _lock(folder: Path) -> int | None:
    """A descriptor of the locked file `.lock`; None where files cannot be locked."""
    try:
        import fcntl
    except ImportError:
        return None
    path = folder / ".lock"
    while True:
        lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Its last holder may have removed it between the two calls: then another process may lock a new one.
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(lock), path.stat()):
                    return lock
        except BlockingIOError as error:
            os.close(lock)
            raise OutputError(
                f"another run is using {folder}: wait for it to end, or choose another folder."
            ) from error
        except OSError as error:
            os.close(lock)
            if error.errno in _NO_LOCKS:
                return None
            raise
        os.close(lock)


def write_json(path: Path, content: Mapping[str, object]) -> None:
    """Write plain data as indented JSON, atomically.

    Raises:
        OutputError: it could not be written.
    """
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    write_atomically(path, (text + "\n").encode())


def another_format(found: object, wanted: object, writer: object = None) -> str:
    """The sentence that refuses a file of another format, with the version that reads it.

    Args:
        found: The format that the file names.
        wanted: The one that this version reads.
        writer: The version of liepoisson that the file names; None where files of its kind name none.
    """
    from liepoisson._core import __version__ as version

    if writer is None:
        by = ""
    elif writer == version:  # a format changes between two released versions only
        by = f" (a state of {version} before its release)"
    else:
        by = f" ({writer!s:.60})"
    return (
        f"it has the format {found!s:.60}, and liepoisson {version} reads {wanted} alone; read it with the liepoisson "
        f"that wrote it{by}, or make it again"
    )
