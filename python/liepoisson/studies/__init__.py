"""Studies: a paper, computed again from its first equation to its last figure by one command."""

from __future__ import annotations

import difflib

from liepoisson.errors import UnknownNameError

STUDIES = ("twisted-top",)


def check_study(name: str) -> str:
    """The name itself, if there is such a study.

    Raises:
        UnknownNameError: there is none of this name.
    """
    if name in STUDIES:
        return name
    close = difflib.get_close_matches(name, STUDIES, n=1)
    hint = f"Did you mean {close[0]}?" if close else f"Try: liepoisson reproduce {STUDIES[0]}"
    raise UnknownNameError(f"there is no study {name!r}; known: {', '.join(STUDIES)}. {hint}")
