"""The command line: results on standard output, progress and errors on standard error, and an exit code.

Done: 0.  A claim about a system is false: 1.  Refused or failed: 2.  Ctrl-C: 130.  The output is read no more: 141.
"""

TYPE_CHECKING = False  # `typing` takes 2 ms to import, in which Ctrl-C would end in a traceback
if TYPE_CHECKING:
    from liepoisson.cli.main import main

__all__ = ["main"]


def __getattr__(name: str) -> object:
    """The function `main`; imported late, as `python -m liepoisson.cli.main` must find its module not yet imported.

    Ctrl-C while it is imported ends the process as `exit.py` does, which is not there yet.
    """
    if name != "main":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from liepoisson.cli.main import main as function
    except KeyboardInterrupt:
        import os

        os.write(2, b"interrupted.\n")
        os._exit(130)

    globals()[name] = function  # in place of the module of this name
    return function
