"""Studies: a paper, computed again from its first equation to its last figure by one command.

They import public names only, as a user would.
"""

from __future__ import annotations

import difflib

import liepoisson as lp

STUDIES = ("twisted-top",)


def check_study(name: str) -> str:
    """The name itself, if there is such a study."""
    if name in STUDIES:
        return name
    near = difflib.get_close_matches(name, STUDIES, n=1)
    hint = f"Did you mean {near[0]}?" if near else f"Try: liepoisson reproduce {STUDIES[0]}"
    raise lp.errors.UnknownNameError(f"there is no study {name!r}; known: {', '.join(STUDIES)}. {hint}")
