"""The widget of a notebook: the page of the laboratory in a frame, with its state as traits."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.resources import files
from typing import Any, cast

import anywidget
import traitlets

from liepoisson.errors import LiePoissonError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.laboratory.drafts import Draft
from liepoisson.laboratory.pages import Page, as_data, page_of
from liepoisson.laboratory.states import LONGEST_MESSAGE, Addresses, State
from liepoisson.model.tops import Top

_PLACE = 'const PAGE = "";'
"""In the script of the widget; the page of the wheel is put there."""

_FROM_PAGE = ("address", "playing", "message")
"""What the page says; everything else goes to it only."""

checked_height = partial(as_count, name="height", least=100, most=4000, hint="these are pixels")
"""Pixels that a cell can have."""


@cache
def script() -> str:
    """The script of the widget with the built page in it, as a text that is no markup."""
    folder = files("liepoisson.laboratory").joinpath("page")
    text = folder.joinpath("widget.js").read_text(encoding="utf-8")
    if text.count(_PLACE) != 1:
        raise AssertionError("the script of the widget has another form; make page builds it")
    page = folder.joinpath("index.html").read_text(encoding="utf-8")
    return text.replace(_PLACE, f"const PAGE = {as_data(page)};")


@dataclass(frozen=True)
class Opening:
    """What a frame is opened with."""

    addresses: Addresses
    begun: State  # the state in which it begins
    system: Any
    surfaces: Sequence[Any] = ()
    carried: str = ""  # the description of the system of its page, as it is told it

    @classmethod
    def of_address(cls, address: str) -> Opening:
        """Of the page on which a system is typed, as this address has it."""
        draft = Draft.read(address)
        addresses = Addresses.of_draft(draft)
        return cls(addresses, addresses.read(address), draft.system)

    @classmethod
    def of_page(cls, page: Page, system: Any, surfaces: Sequence[Any] = ()) -> Opening:
        """Of a page; a system with parameters that can be typed there is, so that it has sliders."""
        record = page.record
        addresses = Addresses.of(record)
        if record is None:
            return cls(addresses, addresses.read(page.address), system, surfaces)
        # an iterator, whose values are read once, is one of surfaces
        has_surfaces = not isinstance(surfaces, Sequence) or len(surfaces) > 0  # pyright: ignore[reportUnnecessaryIsInstance]
        if not has_surfaces and record["saved"] is None and record["picture"] is None:
            draft = Draft.of_system(system, record["start"], record["unit"])
            if draft is not None and draft.parameters:
                addresses = Addresses.of_draft(draft)
                # the surface of the page if it is a component
                names = record["components"][record["surface"] :][:1]
                begins = {"surface": names[0], "direction": 1} if names else {}
                return cls(addresses, addresses.read(addresses.write(addresses.checked(begins))), system)
        begins = {"start": [float(text) for text in record["start"]]}
        begun = addresses.read(addresses.write(addresses.checked(begins)))
        carried = json.dumps(record, allow_nan=False, separators=(",", ":"))
        return cls(addresses, begun, system, surfaces, carried)


class View(anywidget.AnyWidget):
    """The laboratory in a cell of a notebook, made by `view`.

    What is done in the page arrives in the traits, and a trait that is set is shown at once. `observe` tells of
    changes: `widget.observe(f, names="start")` calls `f` when somebody has clicked on a crossing. While the motion
    plays, its time is not sent along: `time` is where it was last stopped or set.

    Attributes:
        state: All that the page shows, by name. Assigning a dict changes the parts that it names and no others.
        start: The start of the orbit, a tuple of floats.
        time: The time of the cursor.
        playing: Whether the motion plays.
        height: Pixels of the frame.
        address: The state as the address of the page has it after the #; that of a system that is typed opens this.
        message: What the page says, such as why a state was refused, or what is wrong in a formula that is typed, where
            the last system stays; "" where there is nothing.
        system: What is shown, such as the system that was typed; no trait, but it can be set to another system.
    """

    _esm = traitlets.Unicode().tag(sync=True)
    _carried = traitlets.Unicode().tag(sync=True)
    _options = traitlets.Unicode().tag(sync=True)
    address = traitlets.Unicode().tag(sync=True)
    playing = traitlets.Bool(True).tag(sync=True)
    message = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int().tag(sync=True)
    state = traitlets.Any()
    start = traitlets.Any()
    time = traitlets.Any(0.0)

    def __init__(
        self,
        opening: Opening,
        *,
        state: Mapping[str, Any],
        playing: bool,
        height: int,
        panels: str,
    ) -> None:
        self._opening, self._addresses = opening, opening.addresses
        self._known = self._addresses.changed(opening.begun, state)
        super().__init__(
            _esm=script(),
            _carried=opening.carried,
            _options="" if panels == "all" else "embed=1",
            playing=playing,
            height=height,
        )
        self.address = self._addresses.write(self._known)

    @property
    def system(self) -> Any:
        """What is shown: the system that was typed, a top with the parameters of now, or the system that was given."""
        if (draft := self._addresses.draft) is not None:
            return draft.system
        texts = list(self._known.get("parameters", {}).values())
        if not texts or self._addresses.system:
            return self._opening.system
        inertia, a, b = (tuple(texts[k : k + 3]) for k in (0, 3, 6))
        return Top(inertia=cast("Any", inertia), a=cast("Any", a), b=cast("Any", b), epsilon=texts[9])

    @system.setter
    def system(self, system: Any) -> None:
        """Shows another system, from the start of now where its components have the same names.

        Then surface, axes and view stay, too, if it has the same ones; theme, speed and tolerance stay always.
        """
        names = getattr(system, "component_names", None)
        if isinstance(system, type) or names is None or not callable(getattr(system, "field", None)):
            raise ParameterError(
                f"system must be a system or a top; got {type(system).__name__!r:.40}. Show results by lp.view."
            )
        before, known = self._addresses, self._known
        same = tuple(map(str, names)) == before.components
        surfaces = self._opening.surfaces if same else ()
        page = page_of(system, start=known.get("start") if same else None, surfaces=surfaces)
        opening = Opening.of_page(page, system, surfaces)
        addresses = opening.addresses
        kept = ["theme", "speed", "tol"]
        if (addresses.surfaces, addresses.views) == (before.surfaces, before.views) and same:
            kept += ["surface", "direction", "axes", "view", "projection", "series", "shadow"]
        known = addresses.changed(opening.begun, {name: known[name] for name in kept if name in known})
        self._opening, self._addresses = opening, addresses
        with self.hold_sync():
            self.message = ""
            self._carried = opening.carried
            self.address = addresses.write(known)

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """What comes from the page, whole or not at all: what cannot be is answered with a message and the state."""
        said = {name: sync_data[name] for name in _FROM_PAGE if name in sync_data}
        try:
            for name, value in said.items():
                if not isinstance(value, bool if name == "playing" else str):
                    raise ParameterError(f"{name} cannot be {value!r:.80}.")
            self._read(said.get("address", self.address))
        except LiePoissonError as error:
            self.message = _shortened(f"Python cannot take this state from the page, and keeps its own: {error}")
            self.send_state([*_FROM_PAGE])
            return
        if "message" in said:
            said["message"] = _shortened(said["message"])
        super().set_state(said)

    def _read(self, address: str) -> tuple[Addresses, State]:
        """The page that an address opens, which is another one where another system is typed, and its state."""
        addresses = self._addresses.opened(address)
        return addresses, addresses.read(address)

    @traitlets.validate("address")
    def _valid_address(self, proposal: dict[str, Any]) -> str:
        self._read(proposal["value"])
        return proposal["value"]

    @traitlets.validate("message")
    def _valid_message(self, proposal: dict[str, Any]) -> str:
        return _shortened(proposal["value"])

    @traitlets.validate("state")
    def _valid_state(self, proposal: dict[str, Any]) -> State:
        changed = self._addresses.changed(self._known, proposal["value"])
        self._addresses.opened(self._addresses.write(changed))  # with these parameters it is a system, too
        return changed

    @traitlets.validate("start")
    def _valid_start(self, proposal: dict[str, Any]) -> Any:
        return self._addresses.checked({"start": proposal["value"]})["start"]

    @traitlets.validate("time")
    def _valid_time(self, proposal: dict[str, Any]) -> Any:
        return self._addresses.checked({"time": proposal["value"]})["time"]

    @traitlets.validate("height")
    def _valid_height(self, proposal: dict[str, Any]) -> int:
        return checked_height(proposal["value"])

    @traitlets.observe("address")
    def _address_changed(self, change: dict[str, Any]) -> None:
        self._addresses, self._known = self._read(str(change["new"]))
        self.set_trait("time", self._known.get("time", 0.0))
        self.set_trait("state", dict(self._known))
        self.set_trait("start", self._known.get("start"))

    @traitlets.observe("state", "start", "time")
    def _part_changed(self, change: dict[str, Any]) -> None:
        new = change["new"]
        wanted = new if change["name"] == "state" else {change["name"]: new}
        if any(self._known.get(name) != value for name, value in wanted.items()):
            self.message = ""
            self.address = self._addresses.write(self._addresses.changed(self._known, wanted))


def _shortened(message: str) -> str:
    return message if len(message) <= LONGEST_MESSAGE else f"{message[: LONGEST_MESSAGE - 1]}…"
