"""What runs on a worker of Dask: a function that travels by value, as the worker may have no such module."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from types import FunctionType
from typing import Any, cast

import cloudpickle

from liepoisson.sweeps.tasks import Piece


def _run(payload: bytes, version: str) -> tuple[str, Any, str]:
    """("done", result, address) or ("refused", reason, address); imports everything itself, as it travels alone."""
    import pickle

    from distributed import get_worker

    address = get_worker().address
    try:
        from liepoisson import __version__ as found
    except ImportError as error:
        return "refused", f"liepoisson {version} is wanted; it cannot be imported ({error})", address
    if found != version:
        return "refused", f"liepoisson {version} is wanted; found {found}", address
    from liepoisson.sweeps.tasks import run_piece

    return "done", run_piece(pickle.loads(payload)), address


def portable() -> Callable[[bytes, str], tuple[str, Any, str]]:
    """`_run` as a function of no module, so that its code is sent and not its name."""
    alone = FunctionType(_run.__code__, {"__name__": "__main__", "__builtins__": __builtins__}, "run_piece_of_sweep")
    alone.__module__ = "__main__"
    return cast("Callable[[bytes, str], tuple[str, Any, str]]", alone)


def packed(piece: Piece) -> bytes:
    """A piece as bytes; functions of the user's own script travel by value."""
    return cloudpickle.dumps(piece, protocol=pickle.HIGHEST_PROTOCOL)
