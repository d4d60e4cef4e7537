"""The command line: results on standard output, progress and errors on standard error, and an exit code.

Done: 0.  A claim about a system is false: 1.  Refused or failed: 2.  Ctrl-C: 130.  The output is read no more: 141.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liepoisson.cli.main import main

__all__ = ["main"]


def __getattr__(name: str) -> Any:
    """The function `main`; imported late, as `python -m liepoisson.cli.main` must find its module not yet imported."""
    if name != "main":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from liepoisson.cli.main import main as function

    globals()[name] = function  # in place of the module of this name
    return function
