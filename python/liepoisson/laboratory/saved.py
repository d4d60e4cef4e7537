"""Saved results that a page carries: an orbit or a section, with what the page needs to compute it again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.laboratory.description import record_of_functions
from liepoisson.numeric.integrate import Orbit
from liepoisson.numeric.methods import Taylor
from liepoisson.numeric.systems import as_field
from liepoisson.poincare.section import Section

MOST_NUMBERS = 8_000
"""Of the states that a page carries; of more, every second, third, ... is kept."""
MOST_STEPS = 200_000
"""Of a run that a page repeats while somebody waits."""

_LONGEST_FORMULA = 30
"""Of a surface that is called by its formula."""


@dataclass(frozen=True)
class SavedResult:
    """What the page is told of a result."""

    # as JSON can write it: `kind`, "orbit" or "section"; `words`, what it is, for people; `shown_only`, why the page
    # does not compute it again, or None; `tol` of its method; `starts`; `times` and `states` of the orbit or of the
    # crossings; the `trajectory` of each crossing; `functions`, the surface and what is kept, as data, None for an
    # orbit; `direction`, `n_crossings` and `t_end`, as the section was asked for; `has_states`, whether states are
    # states of the system, and not functions of them; `coordinates`, the names of their components
    record: dict[str, Any]
    start: Array  # where the page begins
    surface: str = ""  # the surface as it was written, if it is short


def saved_of(system: Any, result: Any, trajectory: int = 0) -> SavedResult:
    """A result as a page carries it, which begins with one of its trajectories."""
    if not isinstance(result, (Orbit, Section)):
        kind = getattr(result, "kind", type(result).__name__)
        raise ParameterError(
            f"a page can carry an orbit or a section; got a result of the kind {kind!r:.40}, which has no states to "
            "draw. Write one with `liepoisson orbit --out orbit.nc`."
        )
    if as_field(system) != result.field:
        raise ParameterError(
            f"the result must be one of {system.name!r:.60}; it has another vector field, that of "
            f"{result.system.name!r:.60}. Leave the system out: the page then shows that of the result."
        )
    chosen = checked_trajectory(trajectory, len(result.start))
    return _orbit(result, chosen) if isinstance(result, Orbit) else _section(result, chosen)


def checked_trajectory(trajectory: Any, n: int) -> int:
    """Which of n orbits."""
    if isinstance(trajectory, bool) or not isinstance(trajectory, int | np.integer) or not 0 <= trajectory < n:
        raise ParameterError(
            f"trajectory must be a whole number from 0 to {n - 1}, as there {'are' if n > 1 else 'is'} {n}; "
            f"got {trajectory!r:.40}."
        )
    return int(trajectory)


def _shown_only(result: Orbit | Section) -> str | None:
    method = result.method
    if not isinstance(method, Taylor):
        return f"the page computes with Taylor series, and the file was made by the method {method.name!r:.40}"
    if method.precision != "double":
        return "the page computes in double precision, and the file has mixed precision"
    if result.n_steps.sum() > MOST_STEPS:
        return f"it took {int(result.n_steps.sum())} steps, more than a page repeats while somebody waits"
    if not np.isfinite(result.end_time).all() or (result.outcome != "finished").any():
        return "not all of its orbits came to their end"
    return None


def _orbit(orbit: Orbit, chosen: int) -> SavedResult:
    states = orbit.state[chosen]
    good = np.isfinite(states).all(axis=1)
    times, states = orbit.time[good], states[good]
    every = max(1, -(-states.size // MOST_NUMBERS))
    shown_only = _shown_only(orbit)
    if shown_only is None and float(orbit.time[0]) != orbit.start_time:
        shown_only = "its first times are missing"
    n = len(orbit.state)
    which = "the first" if chosen == 0 else f"number {chosen + 1}"
    among = f"{which} of {n} orbits, " if n > 1 else "an orbit, "
    kept = f", of which {len(times[::every])} are here" if every > 1 else ""
    words = f"Saved: {among}{len(times)} times from t = {times[0]:g} to t = {times[-1]:g}{kept}"
    start = np.asarray(orbit.start[chosen])
    record = {
        "kind": "orbit",
        "words": words,
        "shown_only": shown_only,
        "tol": _tol(orbit.method),
        "starts": [start.tolist()],
        "times": times[::every].tolist(),
        "states": states[::every].tolist(),
        "trajectory": [],
        "functions": None,
        "direction": 1,
        "n_crossings": 0,
        "t_end": float(times[-1]),
        "has_states": True,
        "coordinates": list(orbit.components),
    }
    return SavedResult(record, start)


def _section(section: Section, first: int) -> SavedResult:
    counts = np.bincount(section.crossing_trajectory, minlength=len(section.start)) * section.state.shape[1]
    members = max(1, int(np.searchsorted(np.cumsum(counts), MOST_NUMBERS, side="right")))
    chosen = section.crossing_trajectory < members
    n = len(section.start)
    kept = f", of which those of {members} are here" if members < n else ""
    surface = str(section.surface)
    of = f" of {surface} = 0" if len(surface) <= _LONGEST_FORMULA else ""
    words = f"Saved: {section.time.size} crossings{of}, of {n} orbit{'s' * (n > 1)}{kept}"
    shown_only = _shown_only(section)
    if shown_only is None and (section.start_side[:members] != 0).any():
        shown_only = "it goes on from an earlier section"
    if shown_only is None and not np.isfinite(section.t_end):
        shown_only = "it has no end of time"
    record = {
        "kind": "section",
        "words": words,
        "shown_only": shown_only,
        "tol": _tol(section.method),
        "starts": section.start[:members].tolist(),
        "times": section.time[chosen].tolist(),
        "states": section.state[chosen].tolist(),
        "trajectory": section.crossing_trajectory[chosen].tolist(),
        "functions": record_of_functions(section.tape),
        "direction": int(section.direction),
        "n_crossings": int(section.n_crossings or 0),
        "t_end": float(section.t_end) if np.isfinite(section.t_end) else 0.0,
        "has_states": tuple(section.coordinates) == tuple(section.components),
        "coordinates": list(section.coordinates),
    }
    return SavedResult(record, np.asarray(section.start[first]), surface if of else "saved surface")


def _tol(method: Any) -> float:
    return float(method.tol) if isinstance(method, Taylor) else 1e-15
