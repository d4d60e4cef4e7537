"""Systems that are typed into the page: what was typed, as the address has it, and the system file that it stands for.

The page reads and writes the same addresses (`systems/typing/draft.ts`).  What was typed becomes a system by the reader
of system files, and nothing of it is run as code.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Self, cast
from urllib.parse import parse_qsl, urlencode

import numpy as np

from liepoisson.errors import LiePoissonError, ParameterError, UnknownNameError, did_you_mean
from liepoisson.inputs.refusals import shown
from liepoisson.model.system import System
from liepoisson.model.system_text import read_system_text, system_tables, toml_text

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array

BRACKETS = (
    ("so3", "so(3), a rigid body", "so(3)", "trivial()", ("l",)),
    ("e3", "e(3), a heavy top", "so(3)", "semidirect(2)", ("l", "alpha")),
    ("charged", "so(3) with two vectors, a charged heavy top", "so(3)", "semidirect(3)", ("l", "alpha", "beta")),
    ("leibniz3", "Leibniz extension of order 3, a twisted top", "so(3)", "leibniz(3, epsilon)", ("l", "alpha", "beta")),
    ("leibniz4", "Leibniz extension of order 4", "so(3)", "leibniz(4, epsilon)", ("l", "alpha", "beta", "gamma")),
    (
        "leibniz5",
        "Leibniz extension of order 5",
        "so(3)",
        "leibniz(5, epsilon)",
        ("l", "alpha", "beta", "gamma", "delta"),
    ),
    ("so4", "so(4), a rigid body in four dimensions", "so(4)", "trivial()", ("M",)),
    ("so21", "so(2,1)", "so(2,1)", "trivial()", ("l",)),
    ("so21e", "so(2,1) with a vector", "so(2,1)", "semidirect(2)", ("l", "alpha")),
)
"""The brackets of the page's list: key, words, and what a system file has of it: algebra, extension, variables."""

EXAMPLES = {
    "henon-heiles": "Hénon–Heiles",
    "double-pendulum": "Double pendulum",
    "spring-pendulum": "Spring pendulum",
    "toda": "Toda, three particles",
    "free-rigid-body": "Free rigid body",
    "heavy-top": "Heavy top",
    "kovalevskaya": "Kovalevskaya's top",
    "charged-heavy-top": "Charged heavy top",
    "twisted-kovalevskaya": "Twisted Kovalevskaya top",
    "leibniz-top-4": "Top with four fields",
    "manakov-so4": "Rigid body in four dimensions",
    "so21-heavy-top": "Heavy top of so(2,1)",
    "lotka-volterra-3": "Three species",
    "sklyanin": "Sklyanin's bracket",
}
"""Systems of the catalog with which the page begins, the first where nobody chooses, and how it calls them."""

_ANGLES = {"double-pendulum": ("theta1", "theta2")}
"""Coordinates of examples that are drawn as angles, which the entry does not say."""

LONGEST = 16_000
"""Characters of an address, as the page has it (`systems/url.ts`)."""

_MOST = {
    "name": 80,
    "bracket": 20,
    "coordinates": 200,
    "momenta": 200,
    "angles": 200,
    "entries": 4_000,
    "hamiltonian": 4_000,
}
"""Characters of each text at most; these and the next as the page has them (`systems/typing/draft.ts`)."""
_MOST_PARAMETERS, _MOST_ENTRIES, _MOST_NUMBERS = 40, 20, 64
_UNITS = (1e-6, 1e6)
_VERSION = "1"
_PARTS = ("own", *_MOST, "parameters", "ranges", "from", "unit", "sum")

_NAME = re.compile(r"(?!__)[A-Za-z_][A-Za-z0-9_]{0,39}")
_LINE = re.compile(
    r"\s*[{[(]?\s*([A-Za-z_]\w*)\s*,\s*([A-Za-z_]\w*)\s*[}\])]?\s*=\s*(.+?)\s*", re.ASCII
)  # {x, y} = formula
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?|[+-]?\d{1,16}/\d{1,16}", re.ASCII)
_LARGEST_NUMBER, _LONGEST_NUMBER, _LARGEST_WHOLE = 1e6, 64, 2**53

Given = str | tuple[str, ...]
"""A parameter: the text of a number, or those of a vector."""


@dataclass(frozen=True)
class Draft:
    """What somebody has typed, as texts; equal where the page has the same in its fields."""

    bracket: str  # "canonical", "tensor", or one of the list
    hamiltonian: str
    name: str = ""
    coordinates: str = ""
    momenta: str = ""
    angles: str = ""
    entries: str = ""  # lines {x, y} = formula
    parameters: Mapping[str, Given] = field(default_factory=dict[str, Given], hash=False)
    ranges: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]], hash=False)  # of sliders
    start: tuple[str, ...] = ()
    unit: float = 1.0  # the time in which it moves
    given: Any = field(default=None, repr=False, compare=False)  # the system from which it was made

    @classmethod
    def of_system(cls, system: Any, start: Sequence[str], unit: float) -> Draft | None:
        """The draft from which the page makes this system; None where it cannot be typed there.

        Its bracket is canonical, one of the list, or a tensor that is given by formulas; its Hamiltonian is a text
        without time, and its parameters are rational numbers and vectors of them.
        """
        if not isinstance(system, System) or system.clock is not None or system.as_given.hamiltonian is None:
            return None
        try:
            tables = system_tables(system)
        except LiePoissonError:
            return None
        bracket = bracket_of(tables["bracket"])
        texts = {name: _read_only(value) for name, value in tables.get("parameters", {}).items()}
        if bracket is None or "quadratures" in tables or not all(map(_is_typed, texts.items())):
            return None
        hamiltonian = " ".join(system.as_given.hamiltonian.split())
        draft = cls(
            **bracket,
            hamiltonian=hamiltonian,
            name=str(system.name)[: _MOST["name"]],
            parameters=texts,
            start=tuple(start),
            unit=unit,
            given=system,
        )
        return draft if draft._fits() else None

    @classmethod
    def read(cls, address: str) -> Draft:
        """The draft of an address.

        Raises:
            ParameterError: it is none of a typed system, damaged, or one of its parts is too long.
            UnknownNameError: there is no such example.
        """
        parts = parts_of(address)
        if parts.get("own") != _VERSION:
            raise ParameterError(f"address must have own={_VERSION}, as those of typed systems; got {address!r:.80}.")
        if "bracket" not in parts and "sum" not in parts:
            return example(parts.get("example") or next(iter(EXAMPLES)))
        for name, most in _MOST.items():
            if len(parts.get(name, "")) > most:
                raise ParameterError(f"address: {name} must have at most {most} characters; got {len(parts[name])}.")
        draft = cls(
            **{name: parts.get(name, "") for name in _MOST},  # pyright: ignore[reportArgumentType]
            parameters={name: _given(name, text) for name, text in _pairs(parts, "parameters").items()},
            ranges={name: _range(name, text) for name, text in _pairs(parts, "ranges").items()},
            start=tuple(_number("from", text) for text in parts.get("from", "").split(",") if text),
            unit=_unit(parts.get("unit", "1")),
        )
        if not draft._fits():
            raise ParameterError(
                f"address must have a bracket of the page, and at most {_MOST_PARAMETERS} parameters, {_MOST_ENTRIES} "
                f"entries of one and {_MOST_NUMBERS} numbers of a start; got more, or bracket={draft.bracket!r}."
            )
        if parts.get("sum") != draft.checksum:
            raise ParameterError("address was damaged or cut: its checksum is wrong. Copy it again.")
        return draft

    def written(self) -> dict[str, str]:
        """The parts of the address."""
        texts = {name: getattr(self, name) for name in _MOST}
        given = [
            f"{name}:{one if isinstance(one, str) else ','.join(one) + ','}" for name, one in self.parameters.items()
        ]
        ranges = [f"{name}:{','.join(ends)}" for name, ends in self.ranges.items()]
        more = {"parameters": ";".join(given), "ranges": ";".join(ranges)}
        return {
            "own": _VERSION,
            **{name: text for name, text in (texts | more).items() if text},
            "from": ",".join(self.start),
            "unit": _decimal(self.unit),
            "sum": self.checksum,
        }

    @cached_property
    def checksum(self) -> str:
        """A short hash of all that was typed (FNV-1a, of the code units of its JSON), by which the page knows it."""
        parts = [[getattr(self, name) for name in _MOST], _items(self.parameters), _items(self.ranges), self.start]
        text = json.dumps(parts, ensure_ascii=False, separators=(",", ":")).removesuffix("]")
        units = f"{text},{_decimal(self.unit)}]".encode("utf-16-le", "surrogatepass")
        total = 0x811C9DC5
        for low, high in zip(units[::2], units[1::2], strict=True):
            total = (total ^ (low | high << 8)) * 0x01000193 & 0xFFFFFFFF
        return f"{total:08x}"

    @property
    def numbers(self) -> dict[str, str]:
        """Single numbers of the parameters by name, such as g and I1."""
        return {
            name: text
            for of, given in self.parameters.items()
            for name, text in ([(of, given)] if isinstance(given, str) else _entries(of, given))
        }

    def with_numbers(self, numbers: Mapping[str, str]) -> Self:
        """The draft with other values of its parameters."""
        values = {**self.numbers, **numbers}
        parameters: dict[str, Given] = {
            of: values[of] if isinstance(given, str) else tuple(values[name] for name, _ in _entries(of, given))
            for of, given in self.parameters.items()
        }
        return self if parameters == self.parameters else replace(self, parameters=parameters, given=None)

    @property
    def system(self) -> System:
        """The system, read from its file, or the one from which the draft was made.

        Raises:
            LiePoissonError: what was typed describes none.
        """
        return _system(self.file) if self.given is None else self.given

    @property
    def file(self) -> str:
        """The text of a system file, as the page offers it to save."""
        table = self._bracket_table()
        formulas = self.hamiltonian if self.bracket != "tensor" else f"{self.hamiltonian} {self.entries}"
        if "extension" in table:
            formulas = f"{formulas} {table['extension']}"
        named = set(re.findall(r"[A-Za-z_]\w*", formulas, re.ASCII))
        used = {
            of: _fraction(given) if isinstance(given, str) else [_fraction(one) for one in given]
            for of, given in self.parameters.items()
            # a parameter that formulas do not name is kept in the page for when they do again
            if of in named or (not isinstance(given, str) and any(name in named for name, _ in _entries(of, given)))
        }
        tables = {"name": self.name or "typed", "bracket": table, "parameters": used}
        return toml_text({**tables, "hamiltonian": {"expression": self.hamiltonian}})

    @property
    def vector_length(self) -> int:
        """Components of each vector that the page draws as an arrow; 1 where it has none."""
        has_vectors = self.bracket not in ("canonical", "tensor") or self._degrees is not None
        return self.system.vector_length if has_vectors else 1

    @property
    def _degrees(self) -> int | None:
        """The number that stands for q1, q2, ... and p1, p2, ...; None where coordinates are named."""
        names = _words(self.coordinates) if self.bracket == "canonical" else []
        return int(names[0]) if len(names) == 1 and re.fullmatch("[1-9]", names[0]) else None

    def _bracket_table(self) -> dict[str, Any]:
        for key, _, algebra, extension, variables in BRACKETS:
            if key == self.bracket:
                return {"algebra": algebra, "extension": extension, "variables": list(variables)}
        names, momenta, angles = (_words(text) for text in (self.coordinates, self.momenta, self.angles))
        turning = {"angles": angles} if angles else {}
        if self.bracket == "canonical":
            return {"canonical": self._degrees or names, **({"momenta": momenta} if momenta else {}), **turning}
        rows: dict[str, dict[str, str]] = {}
        for line in filter(str.strip, self.entries.split("\n")):
            if (found := _LINE.fullmatch(line)) is None:
                raise ParameterError(f"a line of the bracket is written {{x, y}} = formula; got {line!r:.60}.")
            first, second, formula = found.groups()
            rows.setdefault(first, {})[second] = formula
        return {"variables": names, "tensor": rows, **turning}

    def _fits(self) -> bool:
        """Whether the page takes it."""
        known = self.bracket in ("canonical", "tensor") or any(key == self.bracket for key, *_ in BRACKETS)
        entries = [len(given) for given in self.parameters.values() if not isinstance(given, str)]
        counts = (
            max(len(self.parameters), len(self.ranges)) <= _MOST_PARAMETERS,
            max(entries, default=0) <= _MOST_ENTRIES,
            len(self.start) <= _MOST_NUMBERS,
            all(len(getattr(self, name)) <= most for name, most in _MOST.items()),
        )
        return known and all(counts)


def is_typed(address: str) -> bool:
    """Whether an address is one of a system that is typed."""
    return re.search(r"(^#?|&)own=", address[:LONGEST]) is not None


def rest_of(address: str) -> dict[str, str]:
    """What an address of a typed system says of the state, and not of the system."""
    left_out = (*_PARTS, "example", "v", "system")
    return {name: text for name, text in parts_of(address).items() if name not in left_out}


def parts_of(address: str) -> dict[str, str]:
    """The parts of an address by name, as texts.

    Raises:
        ParameterError: it is too long, or has a part twice.
    """
    if len(address) > LONGEST:
        raise ParameterError(f"address must have at most {LONGEST} characters; got {len(address)}.")
    pairs = parse_qsl(address.removeprefix("#"), keep_blank_values=True)
    parts = dict(pairs)
    if len(parts) < len(pairs):
        twice = next(name for name, _ in pairs if [other for other, _ in pairs].count(name) > 1)
        raise ParameterError(f"address has {twice!r:.40} twice. Copy it again.")
    return parts


def joined(parts: Mapping[str, str]) -> str:
    """The address of these parts, with the signs of formulas as they are, where an address may have them."""
    return urlencode(parts, safe=",/:;^()" if "own" in parts else ",/")


def example(key: str) -> Draft:
    """A system of the catalog as the page begins with it.

    Raises:
        UnknownNameError: it is none of them.
    """
    if key not in EXAMPLES:
        raise UnknownNameError(
            f"there is no example {key!r:.60}. {did_you_mean(key, EXAMPLES)}Known: {', '.join(EXAMPLES)}."
        )
    from liepoisson import catalog
    from liepoisson.laboratory.pages import unit_of

    file, system = catalog.entry(key), catalog.system(key)
    bracket = bracket_of(cast("Any", file.toml).tables["bracket"])
    if bracket is None:
        raise AssertionError(f"{key}: the page has no such bracket")
    if key in _ANGLES:
        bracket["angles"] = ", ".join(_ANGLES[key])
    start = _start(file, system)
    return Draft(
        **bracket,
        hamiltonian=" ".join(file.hamiltonian.split()),
        name=EXAMPLES[key],
        parameters={name: _read_only(_texts(value)) for name, value in file.parameters.items()},
        start=tuple(_shortest(value) for value in start),
        unit=unit_of(system, start),
    )


def bracket_of(table: Mapping[str, Any]) -> dict[str, Any] | None:
    """What is chosen and typed for the bracket of a system file; None where the page has no such bracket."""
    angles = ", ".join(table.get("angles", ()))
    if "canonical" in table:
        given, momenta = table["canonical"], list(table.get("momenta", ()))
        names = [str(given)] if isinstance(given, int) else list(given)
        usual = momenta == [f"p_{name}" for name in names]
        written = {"coordinates": ", ".join(names), "momenta": "" if usual else ", ".join(momenta)}
        return {"bracket": "canonical", **written, "angles": angles}
    if "tensor" in table:
        rows = [(first, second, entry) for first, row in table["tensor"].items() for second, entry in row.items()]
        entries = "\n".join(f"{{{first}, {second}}} = {entry}" for first, second, entry in rows)
        # other brackets than canonical ones have no field for angles
        names = ", ".join(table["variables"])
        return None if angles else {"bracket": "tensor", "coordinates": names, "entries": entries}
    if angles or not set(table) <= {"algebra", "extension", "variables", "W", "constant", "casimirs"}:
        return None
    algebra, variables = table.get("algebra", ""), tuple(table.get("variables", ()))
    if "constant" in table:
        n = len(table["constant"])
        pairs = {f"q{k}": {f"p{k}": "1"} for k in range(1, n + 1)}
        is_canonical = algebra == f"abelian({n})" and variables == ("q", "p") and table["constant"] == pairs and n < 10
        return {"bracket": "canonical", "coordinates": str(n)} if is_canonical else None
    wanted = (algebra, table.get("extension", "trivial()" if "W" not in table else ""), variables)
    return next(({"bracket": key} for key, _, *found in BRACKETS if tuple(found) == wanted), None)


@lru_cache(maxsize=16)
def _system(file: str) -> System:
    return read_system_text(file)


def _start(file: Any, system: System) -> Array:
    """The first state among the reference values that is chaotic or else any; without one a random unit state."""
    states = [(one.quantity != "lyapunov", k, one.state) for k, one in enumerate(file.references) if one.state]
    if not states:
        from liepoisson.numeric.sampling import sample_states

        return sample_states(system, 1, seed=0)[0]
    return np.array([float(value) for value in min(states, key=lambda one: one[:2])[2]])


def _texts(value: Any) -> Any:
    return [_texts(one) for one in value] if isinstance(value, tuple) else str(value)


def _read_only(value: Any) -> Any:
    return tuple(_read_only(one) for one in value) if isinstance(value, list) else value


def _items(values: Mapping[str, Any]) -> list[Any]:
    return [[name, value] for name, value in values.items()]


def _entries(of: str, given: Sequence[str]) -> list[tuple[str, str]]:
    return [(f"{of}{k}", text) for k, text in enumerate(given, 1)]


def _words(text: str) -> list[str]:
    return [word for word in re.split(r"[\s,;]+", text) if word]


def _is_typed(parameter: tuple[str, Any]) -> bool:
    """Whether the page can have a parameter of a system file: a rational number, or a vector of them, with a value."""
    name, given = parameter
    texts = given if isinstance(given, tuple) else (given,)
    are_numbers = all(isinstance(text, str) and number_text(text) == text for text in texts)
    return _NAME.fullmatch(name) is not None and texts != () and are_numbers


def number_text(text: str) -> str | None:
    """A number as the page reads it, a decimal or a fraction of numbers that doubles hold; None for what is none."""
    found = text.strip().replace("−", "-")
    if len(found) > _LONGEST_NUMBER or _NUMBER.fullmatch(found) is None:
        return None
    above, _, below = found.partition("/")
    whole = [abs(int(part)) for part in (above, below)] if below else [1]
    return found if max(whole) < _LARGEST_WHOLE and whole[-1] and abs(Fraction(found)) <= _LARGEST_NUMBER else None


def _number(what: str, text: str) -> str:
    if (found := number_text(text)) is None:
        raise ParameterError(
            f"{what} must be a number up to {_LARGEST_NUMBER:g}, such as 2, 0.5 or 1/3; got {shown(text)}."
        )
    return found


def _given(name: str, text: str) -> Given:
    """The value of a parameter; that of a vector has a comma."""
    if "," not in text:
        return _number(name, text)
    return tuple(_number(name, one) for one in text.removesuffix(",").split(","))


def _range(name: str, text: str) -> tuple[str, ...]:
    ends = text.split(",")
    if len(ends) == 3:
        low, high, step = (Fraction(_number(name, one)) for one in ends)
        if low < high and step > 0:
            return tuple(ends)
    raise ParameterError(f"{name}: a slider goes from one number to a larger one, by steps above 0; got {text!r:.60}.")


def _unit(text: str) -> float:
    if _NUMBER.fullmatch(text) and "/" not in text and _UNITS[0] <= float(text) <= _UNITS[1]:
        return float(text)
    raise ParameterError(f"unit must be a time from {_UNITS[0]:g} to {_UNITS[1]:g}; got {text!r:.40}.")


def _pairs(parts: Mapping[str, str], what: str) -> dict[str, str]:
    """Names with what stands behind their colons."""
    found: dict[str, str] = {}
    for one in parts.get(what, "").split(";") if parts.get(what) else []:
        name, colon, text = one.partition(":")
        if not colon or _NAME.fullmatch(name) is None or name in found:
            raise ParameterError(f"{what} must be names, each once, with their numbers, as in g:1; got {one!r:.60}.")
        found[name] = text
    return found


def _fraction(text: str) -> str:
    """A number as a system file has it: without zeros in front, or digits left out."""
    return str(Fraction(text))


def _decimal(number: float) -> str:
    """A double from 1e-6 to 1e6 as JavaScript writes it."""
    return format(Decimal(repr(float(number))), "f").removesuffix(".0")


def _shortest(value: float) -> str:
    return repr(float(value) + 0.0).removesuffix(".0")
