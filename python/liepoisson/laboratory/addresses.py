"""The state of a page as its address has it after the #, and as plain values of Python.

The page reads and writes addresses (`state/url.ts` and `systems/url.ts`) and has the last word: what it refuses it
answers with the address of the state that it keeps. Here names and numbers are checked as far as a mistake can be told
at once, and nothing is made up: a part that an address leaves to the page is missing in the state.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl, urlencode

from liepoisson.errors import ParameterError
from liepoisson.laboratory.pages import shortest
from liepoisson.laboratory.presets import presets
from liepoisson.laboratory.states import Parts, State
from liepoisson.laboratory.tops import PARAMETERS

_LONGEST = 16_000
"""Characters of an address, as the page has it (`systems/url.ts`)."""

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?|[+-]?\d+/\d+")


@dataclass(frozen=True)
class Addresses:
    """Reads and writes the addresses of one page.

    Attributes:
        parts: What its states can have.
        system: The short hash of the system that it carries; "" for the page of tops.
    """

    parts: Parts
    system: str = ""

    def read(self, address: str) -> State:
        """The state of an address: what it says, and no more.

        Raises:
            ParameterError: it is no address of this page.
        """
        parts = _parts(address)
        if parts.pop("v", "") != "1" or parts.pop("system", "") != self.system:
            raise ParameterError(f"address must be one of the page that is shown; got {address!r:.80}. Copy it again.")
        readers = _reading(self)
        if unknown := sorted(set(parts) - set(readers)):
            raise ParameterError(f"address has an unknown part, {unknown[0]!r:.40}; it has {', '.join(readers)}.")
        state: State = {}
        for name in sorted(parts, key=lambda name: name != "preset"):
            try:
                state |= readers[name](parts[name])
            except (ValueError, ArithmeticError, LookupError) as error:
                raise ParameterError(f"address: {name} cannot be {parts[name]!r:.80}: {error}") from error
        if {"top", "start"} & set(parts) and not self.system:
            state["preset"] = None  # as the page says it
        return self.parts.checked(state)

    def write(self, state: Mapping[str, Any]) -> str:
        """The address of a checked state."""
        query = {"v": "1"} | ({"system": self.system} if self.system else {})
        return urlencode(query | (_system_parts(self, state) if self.system else _top_parts(state)), safe=",/")

    def changed(self, state: State, changes: Mapping[str, Any]) -> State:
        """The state with some of its parts changed; another orbit begins at time 0.

        Raises:
            UnknownNameError: a part, component, surface, view or theme is not one of this page.
            ParameterError, ShapeError: a value cannot be.
        """
        found = self.parts.checked(changes)
        if "parameters" in found:
            found |= _completed(state.get("parameters", {}), found.pop("parameters"))
        if found.get("preset"):
            found = {**_begun(found["preset"]), **found}
        same = all(found[part] == state.get(part) for part in ("start", "parameters") if part in found)
        if not same:
            found = {"time": 0.0, **({} if self.system else {"preset": None}), **found}
        changed = {**state, **found}
        if "direction" in changed and "surface" not in changed:
            raise ParameterError(
                "direction is that in which orbits cross a surface, which must be named with it; got it alone. Write "
                f"{{'surface': {self.parts.surfaces[0]!r}, 'direction': -1}}."
            )
        return changed


def _completed(known: Mapping[str, str], changes: Mapping[str, str]) -> State:
    """All parameters of a top after a change of some; none where nothing is said of them."""
    texts = {**known, **changes}
    if texts and len(texts) < len(PARAMETERS):
        raise ParameterError(
            f"parameters must be all of {', '.join(PARAMETERS)}, as the page has not yet said its own; "
            f"got {', '.join(texts)}."
        )
    return {"parameters": {name: texts[name] for name in PARAMETERS}} if texts else {}


def _parts(address: str) -> dict[str, str]:
    """The parts of an address by name, as texts."""
    if len(address) > _LONGEST:
        raise ParameterError(f"address must have at most {_LONGEST} characters; got {len(address)}.")
    pairs = parse_qsl(address.removeprefix("#"), keep_blank_values=True)
    parts = dict(pairs)
    if len(parts) < len(pairs):
        twice = next(name for name, _ in pairs if [other for other, _ in pairs].count(name) > 1)
        raise ParameterError(f"address has {twice!r:.40} twice. Copy it again.")
    return parts


def _reading(page: Addresses) -> dict[str, Callable[[str], State]]:
    """For each part of an address, what it says of the state."""

    def numbers(text: str) -> list[float]:
        return [_number(one) for one in text.split(",")]

    def component(text: str) -> str:
        return page.parts.components[_place(text)] if page.system else text

    def section(text: str) -> State:
        surface, direction = text.rsplit(",", 1)
        return {
            "surface": page.parts.surfaces[_place(surface)] if page.system else surface,
            "direction": int(direction),
        }

    shared: dict[str, Callable[[str], State]] = {
        "start": lambda text: {"start": numbers(text)},
        "section": section,
        "axes": lambda text: {"axes": [component(one) for one in text.split(",")]},
        "theme": lambda text: {"theme": text},
        "t": lambda text: {"time": _number(text)},
        "speed": lambda text: {"speed": _number(text)},
    }
    if page.system:
        return shared | {
            "view": lambda text: {"view": text},
            "space": lambda text: {"projection": [component(one) for one in text.split(",") if one != "0"]},
            "series": lambda text: {"series": [component(one) for one in text.split(",") if one]},
            "tol": lambda text: {"tol": _number(text)},
        }
    return shared | {
        "preset": _preset,
        "top": lambda text: {"parameters": dict(zip(PARAMETERS, text.split(","), strict=True))},
        "method": lambda text: {"tol": _number(text.removeprefix("taylor,"))},
        "frame": lambda text: {"view": text},
        "shadow": lambda text: {"shadow": text == "1"},
    }


def _top_parts(state: Mapping[str, Any]) -> dict[str, str]:
    parts = _shared_parts(state, lambda name: name, lambda name: name)
    if state.get("preset"):
        parts = {"preset": state["preset"], **{name: text for name, text in parts.items() if name != "start"}}
    elif "parameters" in state:
        parts = {"top": ",".join(state["parameters"].values()), **parts}
    own = {
        "method": "tol" in state and f"taylor,{shortest(state['tol'])}",
        "frame": state.get("view"),
        "shadow": "shadow" in state and str(int(state["shadow"])),
    }
    return parts | {name: str(text) for name, text in own.items() if text}


def _system_parts(page: Addresses, state: Mapping[str, Any]) -> dict[str, str]:
    def component(name: str) -> str:
        return str(page.parts.components.index(name) + 1)

    parts = _shared_parts(state, component, lambda name: str(page.parts.surfaces.index(name) + 1))
    if "view" in state:
        parts["view"] = state["view"]
    if "projection" in state:
        parts["space"] = ",".join([*map(component, state["projection"]), "0"][:3])
    if "series" in state:
        parts["series"] = ",".join(map(component, state["series"]))
    if "tol" in state:
        parts["tol"] = shortest(state["tol"])
    return parts


def _shared_parts(
    state: Mapping[str, Any], component: Callable[[str], str], surface: Callable[[str], str]
) -> dict[str, str]:
    parts: dict[str, str] = {}
    if "start" in state:
        parts["start"] = ",".join(map(shortest, state["start"]))
    if "surface" in state:
        parts["section"] = f"{surface(state['surface'])},{state.get('direction', 1)}"
    if "axes" in state:
        parts["axes"] = ",".join(map(component, state["axes"]))
    if "theme" in state:
        parts["theme"] = state["theme"]
    return parts | {key: shortest(state[name]) for key, name in (("t", "time"), ("speed", "speed")) if name in state}


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
