"""The command line: results on standard output, progress and errors on standard error, exit code 2 when refused."""

from liepoisson.cli.main import main

__all__ = ["main"]
