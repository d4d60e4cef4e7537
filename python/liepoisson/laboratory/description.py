"""What the page is told, as plain data that JSON can write: systems, pictures of their states, and saved results."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from liepoisson.compile.field import record_of
from liepoisson.errors import LiePoissonError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.names import MOMENTUM_OF_TIME
from liepoisson.numeric.integrate import Orbit
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.systems import (
    as_field,
    component_names,
    has_functions,
    has_pieces,
    known_constants,
    periods_of_components,
    reads_formulas,
    vector_length,
)
from liepoisson.poincare.section import Section

VERSION = 2
"""Of the format, which the page looks at."""

MOST_NUMBERS = 8_000
"""Of the states of a result that a page carries; of more, every second, third, ... is kept."""
MOST_STEPS = 200_000
"""Of a run that a page repeats while somebody waits."""

_LONGEST_FORMULA = 30
"""Of a surface that is called by its formula."""


def description_of(system: Any) -> dict[str, Any]:
    r"""A system, or what else has a `name` and a `field()`, as plain data that JSON can write exactly.

    - `version`: of this format;
    - `name`, `components` (their names), `vector_length` (components of each vector of the state);
    - `turns`: for each component that is a point of a circle the turn within which it is drawn, beginning and end: from
      $-\pi$ to $\pi$, of time from 0 to the period; None for the others;
    - `clock`: the number of the component that is time, which its momentum follows, or None;
    - `field`: as `field.record_of` makes it;
    - `pieces`: the Hamiltonian in pieces, for splitting, or None;
    - `invariants`: `names` and `functions`, a tape with one output for each, or None.  The Hamiltonian is first; of one
      that depends on time $H + p_t$, by this name.
    """
    field = as_field(system)
    n = field.n_components
    names = component_names(system, n)
    clock = clock_of(system)
    return {
        "version": VERSION,
        "name": str(system.name),
        "components": list(names),
        "vector_length": vector_length(system, n),
        "turns": [
            _turn(period, name == clock) for name, period in zip(names, periods_of_components(system, n), strict=True)
        ],
        "clock": None if clock is None else names.index(clock),
        "field": record_of(field),
        "pieces": _pieces(system),
        "invariants": _invariants(system),
    }


def clock_of(system: Any) -> str | None:
    """The name of the component that is time, of a Hamiltonian that depends on it."""
    return getattr(system, "clock", None)


def _turn(period: float, is_time: bool) -> list[float] | None:
    if math.isinf(period):
        return None
    return [0.0, float(period)] if is_time else [-float(period) / 2, float(period) / 2]


def _pieces(system: Any) -> dict[str, Any] | None:
    """None where a Hamiltonian has no pieces with known flows."""
    if not has_pieces(system):
        return None
    try:
        return record_of(system.pieces())
    except LiePoissonError:
        return None


def _invariants(system: Any) -> dict[str, Any] | None:
    """Those that the core can evaluate; None if there are none."""
    known: Mapping[str, Any] = known_constants(system) if has_functions(system) else {}
    if not reads_formulas(system):
        return None
    smooth: dict[str, Any] = {}
    for name, function in known.items():
        try:
            system.function_tape(function)
        except LiePoissonError:
            continue
        smooth[name if name != "H" or clock_of(system) is None else f"H + {MOMENTUM_OF_TIME}"] = function
    if not smooth:
        return None
    return {"names": list(smooth), "functions": asdict(system.function_tape(*smooth.values()))}


N_POINTS = 96
"""Points of a picture along each axis."""


def picture_of(system: Any) -> dict[str, Any] | None:
    r"""The vorticity of a truncation of the ideal fluid to su(N), a field on the plane; None for what has no picture.

    It is the sum of coefficient times component times across(x) times up(y); `across` and `up` are functions that are
    tabulated here, so that who draws the picture needs no formula.

    It is what `catalog.vorticity` adds up, $\omega(x) = -2\,\mathrm{Re}\sum_n w_n e^{in\cdot x}$ over one wave vector n
    of each pair, with cosines and sines of the two angles taken apart.

    Returns:
        - `name`;
        - `across`, `up`: tables of functions at the points of the columns and of the rows;
        - `terms`: component, number of the function of the columns, that of the rows, coefficient.
    """
    n = _truncation(system)
    if n is None:
        return None
    from liepoisson.structure.lie.sine_algebra import sine_modes

    at = 2 * math.pi * np.arange(N_POINTS) / N_POINTS
    waves = [np.cos(k * at) for k in range(n // 2 + 1)] + [np.sin(k * at) for k in range(1, n // 2 + 1)]
    terms: list[list[float]] = []

    def add(component: int, across: tuple[str, int], up: tuple[str, int], coefficient: int) -> None:
        places: list[int] = []
        for kind, k in (across, up):
            if kind == "sin" and k == 0:
                return
            places.append(abs(k) if kind == "cos" else n // 2 + abs(k))
            coefficient *= -1 if kind == "sin" and k < 0 else 1
        terms.append([component, *places, coefficient])

    for mode, (n1, n2) in enumerate(sine_modes(n)):
        real, imaginary = 2 * mode, 2 * mode + 1
        add(real, ("cos", n1), ("cos", n2), -2)
        add(real, ("sin", n1), ("sin", n2), 2)
        add(imaginary, ("sin", n1), ("cos", n2), 2)
        add(imaginary, ("cos", n1), ("sin", n2), 2)
    table = [[round(float(value), 12) for value in wave] for wave in waves]
    return {"name": "Vorticity", "across": table, "up": table, "terms": terms}


def _truncation(system: Any) -> int | None:
    """N of `catalog.zeitlin(N)`: the sine algebra, and one field on it."""
    from liepoisson.structure.tensor_bracket import PoissonTensor

    bracket = getattr(system, "bracket", None)
    if isinstance(bracket, PoissonTensor):
        return None
    name = str(getattr(getattr(bracket, "algebra", None), "name", ""))
    if not (name.startswith("sine(") and name.endswith(")") and name[5:-1].isdecimal()):
        return None
    n = int(name[5:-1])
    return n if len(getattr(system, "component_names", ())) == n * n - 1 else None


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
    chosen = as_count(trajectory, "trajectory", most=len(result.start) - 1)
    return _orbit(result, chosen) if isinstance(result, Orbit) else _section(result, chosen)


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
        **_common(orbit, words, shown_only),
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
        **_common(section, words, shown_only),
        "starts": section.start[:members].tolist(),
        "times": section.time[chosen].tolist(),
        "states": section.state[chosen].tolist(),
        "trajectory": section.crossing_trajectory[chosen].tolist(),
        "functions": asdict(section.tape),
        "direction": int(section.direction),
        "n_crossings": int(section.n_crossings or 0),
        "t_end": float(section.t_end) if np.isfinite(section.t_end) else 0.0,
        "has_states": tuple(section.coordinates) == tuple(section.components),
        "coordinates": list(section.coordinates),
    }
    return SavedResult(record, np.asarray(section.start[first]), surface if of else "saved surface")


def _common(result: Orbit | Section, words: str, shown_only: str | None) -> dict[str, Any]:
    tol = float(result.method.tol) if isinstance(result.method, Taylor) else 1e-15
    return {"kind": result.kind, "words": words, "shown_only": shown_only, "tol": tol}
