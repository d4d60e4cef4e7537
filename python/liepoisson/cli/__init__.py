"""The command line: results on standard output, progress and errors on standard error, and an exit code.

Done: 0.  A claim about a system is false: 1.  Refused or failed: 2.  Ctrl-C: 130.  The output is read no more: 141.
"""

from liepoisson.cli.main import main

__all__ = ["main"]
