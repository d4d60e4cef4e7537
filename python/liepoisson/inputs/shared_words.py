"""Arguments that many functions share, and attributes that many results share: said here once.

`shows_progress` and `explains_its_arguments` put the sentences about arguments into the docstrings of functions, and
`Result` those about attributes into the docstrings of results, so that `help(lp.integrate)` is complete.  A docstring
that says an argument itself keeps what it says.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

ARGUMENTS = {
    "system": "The system.",
    "starts": (
        "States at time 0, shape (component,) or (trajectory, component), dimensionless; a row that is not finite "
        'beside good ones ends at once, with the outcome "not finite".'
    ),
    "seed": "Draws the tangent vectors.",
    "first": (
        "Number of the first trajectory, so that an ensemble can be computed in pieces: trajectory k has the same "
        "random numbers in whichever piece it is."
    ),
    "method": 'How; by default `Taylor(tol=1e-13)`; "auto" is the cheaper one of `Taylor` and `RungeKutta`.',
    "threads": ("By default all processors that the process may use.  Results do not depend on it, bit for bit."),
    "time_limit": (
        'Seconds that the run may take; trajectories that are not done by then have the outcome "time limit".  What '
        "is done is kept."
    ),
    "arithmetic": '"intervals" of doubles, in the compiled core, or "balls" of any precision, by Arb.',
    "precision": "Bits of the balls, 53 to 10,000.",
    "ax": "Axes to draw into, by default those of a new figure.",
    "progress": "Called with the fraction that is done; by default a bar in a notebook and on a terminal.",
}
"""What functions say about arguments that they do not describe themselves."""

ATTRIBUTES = {
    "system": "The system, as it was given.",
    "components": "Names of the components of the state.",
    "field": "Its vector field.",
    "method": "How it was integrated.",
    "seed": "Seed of the tangent vectors.",
    "first": "Number of the first trajectory.",
    "start": "States at the first time, shape (trajectory, component).",
    "outcome": "How each trajectory ended, shape (trajectory,).",
    "end_time": "Time that each trajectory reached, shape (trajectory,).",
    "n_steps": "Accepted steps of each trajectory.",
    "end_state": "Last good state of each trajectory, shape (trajectory, component).",
    "order": "Order of the method.",
    "kernel": "The instruction set that was used, and whether code was compiled for it; all give the same bits.",
    "time_limit": "Seconds that the run was allowed to take.",
}
"""What results say about attributes that they do not describe themselves."""

_WIDTH = 120
_ENTRY = re.compile(r"(\w+(?:, \w+)*): ")
"""What begins an entry: a name, or several that are described together."""


def completed(doc: str | None, section: str, names: Iterable[str], said: Mapping[str, str]) -> str | None:
    """A docstring with an entry for each of the names that is described in it or among what is said.

    Args:
        doc: The docstring; one without the section is returned as it is.
        section: "Args" or "Attributes".
        names: In their order: an entry that is added stands behind that of the name before it.
        said: What is said of a name that has no entry.
    """
    lines = (doc or "").split("\n")
    head = next((k for k, line in enumerate(lines) if line.strip() == f"{section}:"), None)
    if head is None:
        return doc
    margin = " " * (_indent(lines[head]) + 4)
    end = next((k for k in range(head + 1, len(lines)) if lines[k].strip() and _indent(lines[k]) < len(margin)), None)
    body = lines[head + 1 : end]
    while body and not body[-1].strip():
        body.pop()
    rest = lines[head + 1 + len(body) :]
    entries: list[tuple[list[str], list[str]]] = []  # names, and lines
    for line in body:
        found = _ENTRY.match(line.strip()) if _indent(line) == len(margin) else None
        if found or not entries:
            entries.append((found[1].split(", ") if found else [], []))
        entries[-1][1].append(line)
    place = 0
    for name in names:
        own = next((k for k, (described, _) in enumerate(entries) if name in described), None)
        if own is not None:
            place = own + 1
        elif name in said:
            entries.insert(place, ([name], _wrapped(f"{name}: {said[name]}", margin)))
            place += 1
    return "\n".join([*lines[: head + 1], *(line for _, text in entries for line in text), *rest])


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def _wrapped(text: str, margin: str) -> list[str]:
    from textwrap import wrap

    return wrap(text, _WIDTH, initial_indent=margin, subsequent_indent=f"{margin}    ", break_on_hyphens=False)
