"""Writing files whole or not at all, with errors that say what to try."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path

from liepoisson.errors import OutputError

_ADVICE = {
    errno.ENOSPC: "Free some space, or choose another folder; what is finished is kept.",
    errno.EDQUOT: "Free some space, or choose another folder; what is finished is kept.",
    errno.EFBIG: "The file-size limit is too low (ulimit -f), or choose another folder; what is finished is kept.",
    errno.ENOTDIR: "A part of the path is a file; choose another folder.",
    errno.EEXIST: "There is a file where a folder is wanted; choose another folder.",
    errno.EACCES: "No permission to write there; choose another folder.",
    errno.EROFS: "The file system is read-only; choose another folder.",
}


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
    """Write a file so that it is either whole or not there.

    Raises:
        OutputError: it could not be written.
    """
    partial = path.with_name(path.name + ".partial")
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with partial.open("wb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            partial.replace(path)
        except BaseException:
            partial.unlink(missing_ok=True)
            raise


def write_json(path: Path, content: Mapping[str, object]) -> None:
    """Write plain data as indented JSON, atomically.

    Raises:
        OutputError: it could not be written.
    """
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    write_atomically(path, (text + "\n").encode())
