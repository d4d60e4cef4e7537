"""Studies: a paper, computed again from its first equation to its last figure by one command."""

from __future__ import annotations

from liepoisson.errors import UnknownNameError, did_you_mean

STUDIES = ("twisted-top",)


def check_study(name: str) -> str:
    """The name itself, if there is such a study.

    Raises:
        UnknownNameError: there is none of this name.
    """
    if name in STUDIES:
        return name
    hint = did_you_mean(name, STUDIES).strip() or f"Try: liepoisson reproduce {STUDIES[0]}"
    raise UnknownNameError(f"there is no study {name!r}; known: {', '.join(STUDIES)}. {hint}")
