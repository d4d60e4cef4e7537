"""What the state of a page can have, and what makes a value one that the page can be told."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from liepoisson.errors import ParameterError, ShapeError, UnknownNameError, did_you_mean
from liepoisson.formula.numbers import as_array
from liepoisson.inputs.given import by_name, listed, named
from liepoisson.laboratory.pages import LARGEST, exact_text
from liepoisson.laboratory.presets import presets
from liepoisson.laboratory.tops import PARAMETERS

State = dict[str, Any]
"""Parts of a state by name; texts, numbers, tuples of them, and the parameters of a top by name."""

COMPONENTS = tuple(f"{vector}{k}" for vector in ("l", "alpha", "beta") for k in (1, 2, 3))
"""Of a top."""

THEMES = ("auto", "light", "dark", "projector")
VIEWS_OF_TOPS = ("space", "body", "momentum", "rod")
VIEWS_OF_SYSTEMS = ("vectors", "picture", "projection", "series")
SPEEDS = (1 / 16, 16)
TOLERANCES = (1e-16, 1e-3)
MOST_SERIES = 8
MOST_IN_VECTORS = 27
LONGEST_MESSAGE = 1000
HORIZON = 1e4
"""As the page has them (`state/laboratory.ts`, `systems/state.ts`, `notebook/protocol.ts`); the last in its units of
time."""


@dataclass(frozen=True)
class Parts:
    """What the states of one page can have.

    Attributes:
        components: Names of the components of the system.
        surfaces: Names of what can be a surface of section.
        views: Names of its views.
        horizon: The last time of the page.
        is_top: Whether it is the page of tops.
    """

    components: tuple[str, ...]
    surfaces: tuple[str, ...]
    views: tuple[str, ...]
    horizon: float
    is_top: bool

    def checked(self, state: Any) -> State:
        """Parts of a state, each as the page can be told it.

        Raises:
            UnknownNameError: a part, component, surface, view or theme is not one of this page.
            ParameterError, ShapeError: a value cannot be.
        """
        state = by_name(state, "state", "parts", "{'time': 5}")
        checks = _checks(self)
        for name in state:
            if name not in checks:
                hint = did_you_mean(str(name), checks)
                raise UnknownNameError(f"a state has no part {name!r:.40}. {hint}It has {', '.join(checks)}.")
        return {name: check(state[name]) for name, check in checks.items() if name in state}


def parts_of(record: Mapping[str, Any] | None) -> Parts:
    """Of the page that carries this description of a system; of that of tops where there is none."""
    if record is None:
        return Parts(COMPONENTS, COMPONENTS, VIEWS_OF_TOPS, HORIZON, is_top=True)
    components = tuple(record["components"])
    listed = tuple(record["surfaces"]["names"]) if record["surfaces"] else ()
    horizon = HORIZON * float(record["unit"])
    return Parts(components, (*components, *listed), _views(record), horizon, is_top=False)


def _views(record: Mapping[str, Any]) -> tuple[str, ...]:
    """The views that a system has, as `viewsOf` of the page says it (`systems/state.ts`)."""
    n = len(record["components"])
    has = {
        "vectors": record["vector_length"] == 3 and n % 3 == 0 and n <= MOST_IN_VECTORS,
        "picture": record["picture"] is not None,
        "projection": n > 1,
        "series": True,
    }
    return tuple(view for view in VIEWS_OF_SYSTEMS if has[view])


def _checks(page: Parts) -> dict[str, Callable[[Any], Any]]:
    """For each part of a state, what makes it a value that can be written."""

    def several(what: str, least: int, most: int) -> Callable[[Any], tuple[str, ...]]:
        def check(names: Any) -> tuple[str, ...]:
            given = [names] if isinstance(names, str) else listed(names, what)
            if given is None or not least <= len(given) <= most:
                count = str(least) if least == most else f"{least} to {most}"
                raise ParameterError(f"{what} must be {count} components; got {names!r:.80}.")
            return tuple(_one_of(what, page.components)(name) for name in given)

        return check

    def start(values: Any) -> tuple[float, ...]:
        state = as_array(values, "start", page.components)
        if state.shape != (len(page.components),):
            raise ShapeError(f"start must have {len(page.components)} components; got shape {state.shape}.")
        if not np.isfinite(state).all() or np.abs(state).max() > LARGEST:
            raise ParameterError(f"start must have numbers up to {LARGEST:g}, as the page shows them.")
        return tuple(float(value) + 0.0 for value in state)

    def direction(sign: Any) -> int:
        if isinstance(sign, bool) or not isinstance(sign, int | float | np.number) or sign not in (-1, 0, 1):
            raise ParameterError(f"direction must be -1, 0 or 1; got {sign!r:.40}.")
        return int(sign)

    keys = [preset["key"] for preset in presets()]
    of_tops: dict[str, Callable[[Any], Any]] = {
        "preset": lambda key: None if key is None else _one_of("preset", keys)(key),
        "parameters": _parameters,
    }
    shared: dict[str, Callable[[Any], Any]] = {
        "start": start,
        "surface": _one_of("surface", page.surfaces),
        "direction": direction,
        "axes": several("axes", 2, 2),
        "tol": _within("tol", *TOLERANCES),
        "view": _one_of("view", page.views),
        "theme": _one_of("theme", THEMES),
        "time": _within("time", 0, page.horizon),
        "speed": _within("speed", *SPEEDS),
    }
    if not page.is_top:
        return shared | {"projection": several("projection", 2, 3), "series": several("series", 0, MOST_SERIES)}
    return of_tops | shared | {"shadow": _yes_or_no}


def _yes_or_no(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ParameterError(f"shadow must be True or False; got {value!r:.40}.")
    return bool(value)


def _parameters(given: Any) -> dict[str, str]:
    """Exact texts of parameters of a top, by name or all ten."""
    values = named(given, "parameters")
    if values is None:
        if (several := listed(given, "parameters")) is None:
            raise ParameterError(f"parameters must be values by name, such as {{'epsilon': '1/3'}}; got {given!r:.80}.")
        if len(several) != len(PARAMETERS):
            raise ShapeError(f"parameters must be {len(PARAMETERS)}, {', '.join(PARAMETERS)}; got {len(several)}.")
        values = dict(zip(PARAMETERS, several, strict=True))
    found: dict[str, str] = {}
    for name, value in values.items():
        text = _exact(value)
        if text is None:
            raise ParameterError(f"{_one_of('parameters', PARAMETERS)(name)} must be a number; got {value!r:.40}.")
        if name in PARAMETERS[:3] and Fraction(text) < Fraction(1, 100):
            raise ParameterError(f"{name} is a moment of inertia, at least 0.01; got {value!r:.40}.")
        found[_one_of("parameters", PARAMETERS)(name)] = text
    return found


def _exact(value: Any) -> str | None:
    """A fraction in lowest terms, or None: the page takes up to 60 characters."""
    text = str(value).strip()
    if len(text) > 60 or not re.fullmatch(r"[+-]?\d+(\.\d*)?(e[+-]?\d{1,2})?|[+-]?\d+/\d*[1-9]\d*", text):
        return None
    return exact_text(Fraction(text))


def _one_of(what: str, known: Sequence[str]) -> Callable[[Any], str]:
    def check(name: Any) -> str:
        if not isinstance(name, str) or name not in known:
            listed = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
            raise UnknownNameError(
                f"{what}: there is no {name!r:.60}. {did_you_mean(str(name), known)}Known: {listed}."
            )
        return str(name)

    return check


def _within(what: str, least: float, most: float) -> Callable[[Any], float]:
    def check(value: Any) -> float:
        given = as_array(value, what)
        number = float(given) if given.ndim == 0 else np.nan
        if not least <= number <= most:
            raise ParameterError(f"{what} must be a number from {least:g} to {most:g}; got {value!r:.40}.")
        return number + 0.0

    return check
