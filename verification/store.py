"""Results that are kept: each piece of a long run in a file of its own, so that an interrupted audit goes on."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import liepoisson as lp

Piece = dict[str, NDArray[Any]]


def digest(settings: Mapping[str, Any]) -> str:
    """Twelve hexadecimal digits that change with any setting and with the version of liepoisson."""
    text = json.dumps({"liepoisson": lp.__version__, **settings}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


class Store:
    """A folder of pieces, one NPZ file each, named after what was computed and the digest of its settings.

    Args:
        folder: Where the files are; made when it is first needed.
        fresh: Compute again what is there already: for another build of the same version.
    """

    def __init__(self, folder: Path, *, fresh: bool = False) -> None:
        self.folder = folder
        self._fresh = fresh
        self._written: set[Path] = set()

    def piece(self, name: str, settings: Mapping[str, Any], compute: Callable[[], Mapping[str, Any]]) -> Piece:
        """The stored arrays of these settings; computed and stored if there are none.

        Raises:
            OSError: The file cannot be read or written.
        """
        path = self.folder / f"{name.replace(' ', '-')}-{digest(settings)}.npz"
        stale = self._fresh and path not in self._written
        if path.exists() and not stale:
            with np.load(path) as kept:
                return {key: kept[key] for key in kept.files}
        arrays = {key: np.asarray(value) for key, value in compute().items()}
        self._write(path, arrays)
        return arrays

    def _write(self, path: Path, arrays: Piece) -> None:
        """All or nothing: the file gets its name when it is complete."""
        self.folder.mkdir(parents=True, exist_ok=True)
        partial = path.with_suffix(f".{os.getpid()}.partial")
        with partial.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)
        os.replace(partial, path)
        self._written.add(path)
