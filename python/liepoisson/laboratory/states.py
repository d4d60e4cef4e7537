"""The state of a page: what it can have, as plain values of Python, and as its address has it after the #.

The page reads and writes addresses (`state/url.ts` and `systems/url.ts`) and has the last word: what it refuses it
answers with the address of the state that it keeps. Here names and numbers are checked as far as a mistake can be told
at once, and nothing is made up: a part that an address leaves to the page is missing in the state.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self, TypeAlias

import numpy as np

from liepoisson.errors import ParameterError, ShapeError, UnknownNameError, did_you_mean
from liepoisson.formula.scalars import as_array, as_count
from liepoisson.inputs.given import by_name, listed, named
from liepoisson.inputs.refusals import check_choice
from liepoisson.laboratory.drafts import Draft, is_typed, joined, number_text, parts_of, rest_of
from liepoisson.laboratory.pages import checked_start, exact_text, shortest
from liepoisson.laboratory.tops import PARAMETERS, presets

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
FANS, MOST_ADDED = (10, 40), 40
MOST_IN_VECTORS = 27
LONGEST_MESSAGE = 1000
HORIZON = 1e4
"""As the page has them (`state/everyday.ts`, `state/laboratory.ts`, `systems/state.ts`, `notebook/protocol.ts`); the
last in its units of time."""

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?|[+-]?\d+/\d+")


@dataclass(frozen=True)
class Addresses:
    """The states that one page can have, and their addresses, read and written."""

    components: tuple[str, ...]  # names of the components of the system
    surfaces: tuple[str, ...]  # names of what can be a surface of section
    views: tuple[str, ...]  # names of its views
    horizon: float  # the last time of the page
    system: str = ""  # the short hash of the system that it carries or that is typed; "" for the page of tops
    draft: Draft | None = None  # what is typed

    @classmethod
    def of(cls, record: Mapping[str, Any] | None) -> Addresses:
        """Those of the page that carries this description of a system; of that of tops where there is none."""
        if record is None:
            return cls(COMPONENTS, COMPONENTS, VIEWS_OF_TOPS, HORIZON)
        components = tuple(record["components"])
        surfaces = tuple(one["name"] for one in record["surfaces"])
        horizon = HORIZON * float(record["unit"])
        return cls(components, surfaces, _views(record), horizon, str(record["id"]))

    @classmethod
    def of_draft(cls, draft: Draft) -> Self:
        """Those of the page on which this system is typed.

        Raises:
            LiePoissonError: what was typed describes no system.
        """
        components = draft.system.component_names
        seen = {
            "components": components,
            "clock": None,
            "turns": [True if name in draft.system.periods else None for name in components],
            "vector_length": draft.vector_length,
            "picture": None,
        }
        return cls(components, components, _views(seen), HORIZON * draft.unit, draft.checksum, draft)

    def opened(self, address: str) -> Addresses:
        """Those of the page that this address opens: another one where it is of another system that is typed.

        Raises:
            LiePoissonError: what was typed describes no system.
        """
        if not is_typed(address):
            return self
        draft = Draft.read(address)
        return self if draft == self.draft else Addresses.of_draft(draft)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the numbers that the page has sliders for."""
        if self.draft is not None:
            return tuple(self.draft.numbers)
        return () if self.system else PARAMETERS

    def checked(self, state: Any) -> State:
        """Parts of a state, each as the page can be told it."""
        state = by_name(state, "state", "parts", "{'time': 5}")
        checks = _checks(self)
        for name in state:
            if name not in checks:
                hint = did_you_mean(str(name), checks)
                raise UnknownNameError(f"a state has no part {name!r:.40}. {hint}It has {', '.join(checks)}.")
        return {name: check(state[name]) for name, check in checks.items() if name in state}

    def read(self, address: str) -> State:
        """The state of an address: what it says, and no more."""
        parts = parts_of(address)
        state: State = {}
        if self.draft is not None and is_typed(address):
            parts, state = rest_of(address), _said_by(self.draft, self.components)
        elif parts.pop("v", "") != "1" or self.draft is not None or parts.pop("system", "") != self.system:
            raise ParameterError(f"address must be one of the page that is shown; got {address!r:.80}. Copy it again.")
        codecs = _codecs(self)
        if unknown := sorted(set(parts) - set(codecs)):
            raise ParameterError(f"address has an unknown part, {unknown[0]!r:.40}; it has {', '.join(codecs)}.")
        for name in sorted(parts, key=lambda name: name != "preset"):
            try:
                state |= codecs[name][0](parts[name])
            except (ValueError, ArithmeticError, LookupError) as error:
                raise ParameterError(f"address: {name} cannot be {parts[name]!r:.80}: {error}") from error
        if {"top", "start"} & set(parts) and not self.system:
            state["preset"] = None  # as the page says it
        return self.checked(state)

    def write(self, state: Mapping[str, Any]) -> str:
        """The address of a checked state."""
        typed = self.draft and self.draft.with_numbers(state.get("parameters", {}))
        query = typed.written() if typed else {}
        query |= {"v": "1"} | ({"system": typed.checksum if typed else self.system} if self.system else {})
        # a preset has parameters and a start of its own
        left_out = ("top", "start") if state.get("preset") else ()
        written = {name: write(dict(state)) for name, (_, write) in _codecs(self).items() if name not in left_out}
        return joined(query | {name: text for name, text in written.items() if text is not None})

    def changed(self, state: State, changes: Mapping[str, Any]) -> State:
        """The state with some of its parts changed; another orbit begins at time 0."""
        found = self.checked(changes)
        if "parameters" in found:
            found |= _completed(self.parameters, {**state.get("parameters", {}), **found.pop("parameters")})
        if found.get("preset"):
            found = {**_begun(found["preset"]), **found}
        same = all(found[part] == state.get(part) for part in ("start", "parameters") if part in found)
        if not same:
            found = {"time": 0.0, **({} if self.system else {"preset": None}), **found}
        changed = {**state, **found}
        if "direction" in changed and "surface" not in changed:
            raise ParameterError(
                "direction is that in which orbits cross a surface, which must be named with it; got it alone. Write "
                f"{{'surface': {self.surfaces[0]!r}, 'direction': -1}}."
            )
        return changed


def _views(record: Mapping[str, Any]) -> tuple[str, ...]:
    """The views that a system has, as `viewsOf` of the page says it (`systems/state.ts`)."""
    n, clock = len(record["components"]), record["clock"]
    own = n if clock is None else clock  # without time and its momentum
    has_circles = any(turn is not None for turn in record["turns"][:own])
    has = {
        "vectors": record["vector_length"] == 3 and own % 3 == 0 and own <= MOST_IN_VECTORS and not has_circles,
        "picture": record["picture"] is not None,
        "projection": n > 1,
        "series": True,
    }
    return tuple(view for view in VIEWS_OF_SYSTEMS if has[view])


def _checks(page: Addresses) -> dict[str, Callable[[Any], Any]]:
    """For each part of a state, what makes it a value that can be written."""

    def several(what: str, least: int, most: int) -> Callable[[Any], tuple[str, ...]]:
        def check(names: Any) -> tuple[str, ...]:
            given = [names] if isinstance(names, str) else listed(names, what)
            if given is None or not least <= len(given) <= most:
                count = str(least) if least == most else f"{least} to {most}"
                raise ParameterError(f"{what} must be {count} components; got {names!r:.80}.")
            return tuple(_one_of(what, page.components)(name) for name in given)

        return check

    def direction(sign: Any) -> int:
        check_choice(sign, "direction", (-1, 0, 1))
        return int(sign)

    keys = [preset["key"] for preset in presets()]
    parameters: dict[str, Callable[[Any], Any]] = {"parameters": lambda given: _parameters(page, given)}
    of_tops: dict[str, Callable[[Any], Any]] = {
        "preset": lambda key: None if key is None else _one_of("preset", keys)(key),
        **parameters,
    }
    shared: dict[str, Callable[[Any], Any]] = {
        "start": lambda values: tuple(float(value) + 0.0 for value in checked_start(values, page.components)),
        "surface": _one_of("surface", page.surfaces),
        "direction": direction,
        "axes": several("axes", 2, 2),
        "tol": _within("tol", *TOLERANCES),
        "view": _one_of("view", page.views),
        "fan": _fan,
        "orbits": _points,
        "theme": _one_of("theme", THEMES),
        "time": _within("time", 0, page.horizon),
        "speed": _within("speed", *SPEEDS),
    }
    if page.system:
        of_systems: dict[str, Callable[[Any], Any]] = {
            "projection": several("projection", 2, 3),
            "series": several("series", 0, MOST_SERIES),
        }
        return (parameters if page.parameters else {}) | shared | of_systems
    return of_tops | shared | {"shadow": _yes_or_no}


def _fan(count: Any) -> int:
    """Orbits that fill a section; 0 where it has that of the motion alone."""
    found = as_count(count, "fan", most=FANS[1], hint="try 20")
    if 0 < found < FANS[0]:
        raise ParameterError(f"fan: wanted 0, or {FANS[0]} to {FANS[1]} orbits; got {found}; try 20")
    return found


def _points(points: Any) -> tuple[tuple[float, float], ...]:
    """Points of the section through which orbits go."""
    given = as_array(points, "orbits")
    if given.size and given.shape[1:] != (2,):
        raise ShapeError(f"orbits: wanted points with two numbers each; got an array of shape {given.shape}")
    if len(given) > MOST_ADDED or not np.isfinite(given).all():
        raise ParameterError(f"orbits: wanted at most {MOST_ADDED} points of finite numbers; got {len(given)} points")
    return tuple((float(x), float(y)) for x, y in given.reshape(-1, 2))


def _yes_or_no(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ParameterError(f"shadow must be True or False; got {value!r:.40}.")
    return bool(value)


def _parameters(page: Addresses, given: Any) -> dict[str, str]:
    """Exact texts of parameters, by name or all of them."""
    known = page.parameters
    values = named(given, "parameters")
    if values is None:
        if (several := listed(given, "parameters")) is None:
            raise ParameterError(
                f"parameters must be values by name, such as {{'{known[-1]}': '1/3'}}; got {given!r:.80}."
            )
        if len(several) != len(known):
            raise ShapeError(f"parameters must be {len(known)}, {', '.join(known)}; got {len(several)}.")
        values = dict(zip(known, several, strict=True))
    found: dict[str, str] = {}
    for name, value in values.items():
        text = _exact(value) if page.draft is None else number_text(str(value))
        if text is None:
            raise ParameterError(f"{_one_of('parameters', known)(name)} must be a number; got {value!r:.40}.")
        if known == PARAMETERS and name in PARAMETERS[:3] and Fraction(text) < Fraction(1, 100):
            raise ParameterError(f"{name} is a moment of inertia, at least 0.01; got {value!r:.40}.")
        found[_one_of("parameters", known)(name)] = text
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


def _completed(names: Sequence[str], texts: Mapping[str, str]) -> State:
    """All parameters after a change of some; none where nothing is said of them."""
    if texts and len(texts) < len(names):
        raise ParameterError(
            f"parameters must be all of {', '.join(names)}, as the page has not yet said its own; "
            f"got {', '.join(texts)}."
        )
    return {"parameters": {name: texts[name] for name in names}} if texts else {}


def _said_by(draft: Draft, components: Sequence[str]) -> State:
    """What a typed system says of the state of its page by itself."""
    start = {"start": [_number(text) for text in draft.start]} if len(draft.start) == len(components) else {}
    return {**start, **({"parameters": draft.numbers} if draft.numbers else {})}


Codec: TypeAlias = "tuple[Callable[[str], State], Callable[[State], str | None]]"
"""What a part of an address says of a state, and how it is written; None where the state says nothing of it."""


def _same(name: str, read: Callable[[str], Any] = str, write: Callable[[Any], str] = str) -> Codec:
    """A part of an address that stands for one part of the state."""
    return lambda text: {name: read(text)}, lambda state: None if state.get(name) is None else write(state[name])


def _codecs(page: Addresses) -> dict[str, Codec]:
    """How each part of an address is read and written, in the order in which they are written."""
    components, surfaces = page.components, page.surfaces

    def placed(names: Sequence[str]) -> tuple[Callable[[str], str], Callable[[str], str]]:
        """Names as the page of a system has them, by their places from 1; that of tops by themselves."""
        if not page.system:
            return str, str
        return lambda text: names[_place(text)], lambda name: str(names.index(name) + 1)

    def several(name: str, least: int = 0) -> Codec:
        """Components; 0 stands for none, where there must be several."""
        read, write = placed(components)
        return _same(
            name,
            lambda text: [read(one) for one in text.split(",") if one and not (least and one == "0")],
            lambda found: ",".join([*map(write, found), *["0"] * least][: max(least, len(found))]),
        )

    def section(text: str) -> State:
        surface, direction = text.rsplit(",", 1)
        return {"surface": placed(surfaces)[0](surface), "direction": int(direction)}

    def written_section(state: State) -> str | None:
        return f"{placed(surfaces)[1](state['surface'])},{state.get('direction', 1)}" if "surface" in state else None

    shared: dict[str, Codec] = {
        "start": _same("start", lambda text: [_number(one) for one in text.split(",")], _joined),
        "section": (section, written_section),
        "axes": several("axes"),
        "theme": _same("theme"),
        "t": _same("time", _number, shortest),
        "speed": _same("speed", _number, shortest),
    }
    section_of_many = {"fan": _same("fan", int, str), "orbits": _same("orbits", _pairs, _in_a_row)}
    if page.system:
        own = {
            "view": _same("view"),
            "space": several("projection", 3),
            "series": several("series"),
        }
        return shared | own | section_of_many | {"tol": _same("tol", _number, shortest)}
    parameters = _same(
        "parameters",
        lambda text: dict(zip(PARAMETERS, text.split(","), strict=True)),
        lambda texts: ",".join(texts.values()),
    )
    return {
        "preset": (_preset, lambda state: state.get("preset")),
        "top": parameters,
        **shared,
        **section_of_many,
        "method": _same("tol", lambda text: _number(text.removeprefix("taylor,")), lambda v: f"taylor,{shortest(v)}"),
        "frame": _same("view"),
        "shadow": _same("shadow", lambda text: text == "1", lambda shown: str(int(shown))),
    }


def _pairs(text: str) -> list[tuple[float, float]]:
    """Points whose numbers stand one after the other."""
    values = [_number(one) for one in text.split(",")]
    if len(values) % 2:
        raise ValueError("numbers come in pairs")
    return list(zip(values[::2], values[1::2], strict=True))


def _in_a_row(points: Sequence[Sequence[float]]) -> str:
    return ",".join(shortest(number) for point in points for number in point)


def _joined(values: Sequence[float]) -> str:
    return ",".join(map(shortest, values))


def _preset(key: str) -> State:
    """A preset with what its start and its parameters are."""
    found = next((preset for preset in presets() if preset["key"] == key), None)
    if found is None:
        raise LookupError("there is no such preset")
    texts = dict(zip(PARAMETERS, found["parameters"], strict=True))
    return {"preset": key, "parameters": texts, "start": tuple(map(_number, found["start"]))}


def _begun(key: str) -> State:
    """A preset as the page begins it, with surface and axes."""
    found = next(preset for preset in presets() if preset["key"] == key)
    return {**_preset(key), "surface": found["surface"], "direction": 1, "axes": tuple(found["axes"]), "time": 0.0}


def _number(text: str) -> float:
    """As the page reads it: a fraction is divided in doubles."""
    if len(text) > 64 or _NUMBER.fullmatch(text) is None:
        raise ValueError("it is not a number")
    above, _, below = text.partition("/")
    return float(above) / float(below) if below else float(above)


def _place(text: str) -> int:
    """A number that counts from 1, as one that counts from 0."""
    if not re.fullmatch(r"[1-9]\d{0,5}", text):
        raise ValueError("it is not a number from 1 on")
    return int(text) - 1
