"""The certificate of a chain of covering relations: a small file of exact numbers, about which nothing is trusted.

JSON: doubles as C99 hexadecimal strings, rational constants as strings.

- `system`: `name`, and `equations` as text;
- `level`: the values of H and of the Casimirs;
- `level_radius`: by how much they may differ on other levels for which the same is claimed; 3/100000000 if it is not
  there;
- `symmetry`: the signs of a map that keeps the equations, R;
- `sets`: for each a `name`, its `center` and its `frame`, whose columns are k unstable directions, the flow, k stable
  directions, and the gradients of H and the Casimirs;
- `edges`: for each the sets `from` and `to`, the `time`, and whether R follows (`symmetry`).

The graph of a certificate are two loops through one set, a short one along gamma and a long one, the excursion.  A
checker reports how far each condition of the theorem holds (`Margins`).
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from liepoisson.errors import DamagedFileError, EnclosureError, MissingFileError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import shown
from liepoisson.io.files import another_format, read_text

FORMAT = "liepoisson certificate of covering relations/1"

LEVEL_RADIUS = Fraction(3, 10**8)
"""Radius of the ball of levels of a certificate that does not name one."""
_KEYS = ("format", "system", "level", "level_radius", "symmetry", "sets", "edges")
_MOST_BYTES = 20_000_000
_MOST_SETS = 2_000
_MOST_DIGITS, _MOST_DIGITS_OF_EXPONENT = 200, 4
_MOST_OF_FRACTION = 2**127 - 1
"""Largest numerator and denominator, as the checker in intervals has them."""
_SMALLEST_RADIUS = Fraction(1, 10**37)
"""Half of it, rounded down to a power of two, still has such a denominator."""
_EXPONENTS = {"e": re.compile(r"[eE][+-]?([\d_]+)\s*$"), "p": re.compile(r"[pP][+-]?([\d_]+)\s*$")}
"""Of decimal and of hexadecimal numbers."""


@dataclass(frozen=True)
class CoveringSet:
    """A set { c + B (q_u, 0, q_s, w) : |q_u| <= 1, |q_s| <= 1 } on a level, with w fixed by the constants of motion."""

    name: str
    center: tuple[float, ...]
    frame: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Edge:
    """The claim that one set covers another after a time, perhaps followed by the symmetry; sets by their numbers."""

    source: int
    target: int
    time: float
    symmetry: bool


@dataclass(frozen=True)
class CoveringCertificate:
    """What a certificate says."""

    name: str
    equations: Any
    level: Mapping[str, Fraction]
    symmetry: tuple[int, ...]
    sets: tuple[CoveringSet, ...]
    edges: tuple[Edge, ...]
    level_radius: Fraction = LEVEL_RADIUS


@explains_its_arguments
def load_covering_certificate(path: str | Path) -> CoveringCertificate:
    """Read a certificate. Only its form is looked at here.

    Example:
        >>> from importlib.resources import files
        >>> shipped = files("liepoisson.proofs") / "twisted_kovalevskaya.json"
        >>> certificate = lp.proofs.load_covering_certificate(shipped)
        >>> len(certificate.sets), len(certificate.edges), str(certificate.level["H"])
        (27, 28, '1/2')

    Raises:
        MissingFileError: there is no such file.
        DamagedFileError: it has another format; the message says where.
    """
    path = Path(path)
    try:
        data = json.loads(read_text(path, most=_MOST_BYTES), object_pairs_hook=_without_repetition)
        return read_certificate(data)
    except FileNotFoundError as error:
        raise MissingFileError(f"{path}: wanted a certificate; there is no such file; look at the name") from error
    except (OSError, ValueError, RecursionError) as error:
        raise DamagedFileError(
            f"{path}: wanted a certificate of covering relations; got a file that is none: {error!s:.200}. The format "
            "is described in docs/proof.md"
        ) from error


class _FormatError(ValueError):
    """What is wrong with the form of a certificate."""


def read_certificate(data: object) -> CoveringCertificate:
    """A certificate from the data of its file.

    Raises:
        ValueError: the data have another form.
    """
    record = _mapping(data, "the file")
    _check_keys(record, _KEYS, "the file")
    if (named := record.get("format", FORMAT)) != FORMAT:  # the first files name none
        raise _FormatError(another_format(named, FORMAT))
    system = _mapping(_entry(record, "system", "the file"), "system")
    _check_keys(system, ("name", "equations"), "system")
    level = _mapping(_entry(record, "level", "the file"), "level")
    signs = _sequence(_entry(record, "symmetry", "the file"), "symmetry")
    if any(type(s) is not int or s not in (1, -1) for s in signs):
        raise _FormatError("symmetry: wanted signs, 1 or -1")
    n = len(signs)
    sets = tuple(
        _set(entry, n, f"set {k}") for k, entry in enumerate(_sequence(_entry(record, "sets", "the file"), "sets"))
    )
    numbers = {s.name: k for k, s in enumerate(sets)}
    if len(numbers) != len(sets):
        raise _FormatError("sets: two have one name")
    if not 1 <= len(sets) <= _MOST_SETS:
        raise _FormatError(f"sets: wanted from 1 to {_MOST_SETS}; got {len(sets)}")
    edges = _sequence(_entry(record, "edges", "the file"), "edges")
    return CoveringCertificate(
        name=_text(_entry(system, "name", "system"), "the name of the system"),
        equations=_entry(system, "equations", "system"),
        level={_text(k, "a name in level"): _rational(v, f"level {k}") for k, v in level.items()},
        symmetry=tuple(cast("list[int]", signs)),
        sets=sets,
        edges=tuple(_edge(entry, numbers, f"edge {k}") for k, entry in enumerate(edges)),
        level_radius=_radius(record.get("level_radius", str(LEVEL_RADIUS))),
    )


def _radius(value: object) -> Fraction:
    found = _rational(value, "level_radius")
    if not found >= _SMALLEST_RADIUS:
        raise _FormatError(f"level_radius: wanted a positive number, at least 1e-37; got {shown(value)}")
    return found


def _set(data: object, n: int, where: str) -> CoveringSet:
    record = _mapping(data, where)
    _check_keys(record, ("name", "center", "frame"), where)
    center = _numbers(_entry(record, "center", where), n, f"{where}, center")
    rows = _sequence(_entry(record, "frame", where), f"{where}, frame")
    if len(rows) != n:
        raise _FormatError(f"{where}, frame: wanted {n} rows; got {len(rows)}")
    frame = tuple(_numbers(row, n, f"{where}, row {k} of the frame") for k, row in enumerate(rows))
    return CoveringSet(_text(_entry(record, "name", where), f"{where}, name"), center, frame)


def _edge(data: object, numbers: Mapping[str, int], where: str) -> Edge:
    record = _mapping(data, where)
    _check_keys(record, ("from", "to", "time", "symmetry"), where)
    ends = [_text(_entry(record, end, where), f"{where}, {end}") for end in ("from", "to")]
    for end in ends:
        if end not in numbers:
            raise _FormatError(f"{where}: there is no set {shown(end)}")
    symmetry = _entry(record, "symmetry", where)
    if type(symmetry) is not bool:
        raise _FormatError(f"{where}, symmetry: wanted true or false; got {shown(symmetry)}")
    time = _double(_entry(record, "time", where), f"{where}, time")
    if not time > 0:
        raise _FormatError(f"{where}, time: wanted a positive number; got {time}")
    return Edge(numbers[ends[0]], numbers[ends[1]], time, symmetry)


def _numbers(data: object, n: int, where: str) -> tuple[float, ...]:
    values = _sequence(data, where)
    if len(values) != n:
        raise _FormatError(f"{where}: wanted {n} numbers; got {len(values)}")
    return tuple(_double(v, where) for v in values)


def _double(value: object, where: str) -> float:
    """A double from its hexadecimal form, without rounding."""
    text = _text(value, where)
    _check_length(text, where)
    try:
        found = float.fromhex(text)
    except (ValueError, OverflowError) as error:
        raise _FormatError(f"{where}: wanted a double in hexadecimal; got {shown(text)}") from error
    if not math.isfinite(found) or "0x" not in text.lower():
        raise _FormatError(f"{where}: wanted a finite double in hexadecimal, such as 0x1.8p+0; got {shown(text)}")
    if _exactly(text) != Fraction(found):
        raise _FormatError(f"{where}: {shown(text)} has more digits than a double")
    return found


def _exactly(text: str) -> Fraction:
    """The value of a hexadecimal number, of which `float.fromhex` has accepted the form."""
    mantissa, _, exponent = text.strip().lower().replace("0x", "").partition("p")
    negative = mantissa.startswith("-")
    whole, _, part = mantissa.lstrip("+-").partition(".")
    value = Fraction(int(whole + part or "0", 16), 16 ** len(part)) * Fraction(2) ** int(exponent or 0)
    return -value if negative else value


def _rational(value: object, where: str) -> Fraction:
    text = _text(value, where)
    _check_length(text, where)
    try:
        found = Fraction(text)
    except (ValueError, ZeroDivisionError) as error:
        raise _FormatError(f"{where}: wanted a rational number as text, such as 1/2; got {shown(text)}") from error
    if max(abs(found.numerator), found.denominator) > _MOST_OF_FRACTION:
        raise _FormatError(
            f"{where}: wanted a fraction of two whole numbers of at most 38 digits, below 2**127; got {shown(text)}"
        )
    return found


def _check_length(text: str, where: str) -> None:
    """Refuse a number that is too long, or whose exponent is: its exact value would fill the memory."""
    exponent = _EXPONENTS["p" if "0x" in text.lower() else "e"].search(text)
    if len(text) > _MOST_DIGITS or (exponent and len(exponent[1]) > _MOST_DIGITS_OF_EXPONENT):
        raise _FormatError(
            f"{where}: wanted a number of at most {_MOST_DIGITS} characters, {_MOST_DIGITS_OF_EXPONENT} of them in its "
            f"exponent; got {shown(text)}"
        )


def _text(value: object, where: str) -> str:
    if not isinstance(value, str):
        raise _FormatError(f"{where}: wanted a text; got {shown(value)}")
    return value


def _mapping(value: object, where: str) -> Mapping[Any, Any]:
    if not isinstance(value, dict):
        raise _FormatError(f"{where}: wanted an object with named entries; got {shown(value)}")
    return cast("Mapping[Any, Any]", value)


def _sequence(value: object, where: str) -> Sequence[Any]:
    if not isinstance(value, list):
        raise _FormatError(f"{where}: wanted a list; got {shown(value)}")
    return cast("Sequence[Any]", value)


def _check_keys(record: Mapping[Any, Any], known: Sequence[str], where: str) -> None:
    """Refuse entries that mean nothing: one that is misspelt would be left out of what is proved."""
    if unknown := [key for key in record if key not in known]:
        raise _FormatError(
            f"{where}: wanted the entries {', '.join(known)}; got {', '.join(map(shown, unknown))} among them"
        )


def _entry(record: Mapping[Any, Any], key: str, where: str) -> Any:
    if key not in record:
        raise _FormatError(f"{where}: {key} is missing")
    return record[key]


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of a file; of a name that comes twice, other readers might take the other value."""
    found = dict(pairs)
    if len(found) != len(pairs):
        raise _FormatError("a name occurs twice in one object")
    return found


@dataclass(frozen=True)
class ChainGraph:
    """Two loops through one set, as numbers of edges in their order.

    Attributes:
        start: Number of the set in which the loops meet, p_a.
        other: Number of the other set of the short loop, p_b.
        short: Edges of the short loop, p_a -> p_b -> p_a.
        long: Edges of the excursion, p_a -> q_1 -> ... -> p_a.
        middle: Number of the set half-way along the excursion.
        middle_edge: Place in `long` of the edge that ends in the middle set.
    """

    start: int
    other: int
    short: tuple[int, ...]
    long: tuple[int, ...]
    middle: int
    middle_edge: int


def chain_graph(n_sets: int, edges: Sequence[tuple[int, int, bool]]) -> ChainGraph:
    """The loops of a list of edges, each (from, to, symmetry).

    Raises:
        EnclosureError: the edges are not two loops through one set, of which one has two edges and each carries the
            symmetry an odd number of times.
    """
    leaving: dict[int, list[int]] = {k: [] for k in range(n_sets)}
    arriving = dict.fromkeys(range(n_sets), 0)
    for number, (source, target, _) in enumerate(edges):
        leaving[source].append(number)
        arriving[target] += 1
    branching = [k for k in range(n_sets) if len(leaving[k]) == 2 and arriving[k] == 2]
    if len(branching) != 1 or any(
        len(leaving[k]) != 1 or arriving[k] != 1 for k in range(n_sets) if k not in branching
    ):
        raise EnclosureError(
            "the graph: wanted two loops that meet in one set and pass once through each other set; got another graph"
        )
    start = branching[0]
    loops: list[tuple[int, ...]] = []
    for first in leaving[start]:
        loop, place = [first], edges[first][1]
        while place != start:
            loop.append(leaving[place][0])
            place = edges[loop[-1]][1]
        loops.append(tuple(loop))
    loops.sort(key=len)
    short, long = loops
    if sum(map(len, loops)) != len(edges) or len(short) != 2 or len(long) < 4:
        raise EnclosureError("the graph: wanted a loop of two edges and one of four or more through one set")
    for loop, what in ((short, "short"), (long, "long")):
        if sum(edges[e][2] for e in loop) % 2 != 1:
            raise EnclosureError(f"the graph: the {what} loop must carry the symmetry an odd number of times")
    middle_edge = (len(long) - 1) // 2
    return ChainGraph(start, edges[short[0]][1], short, long, edges[long[middle_edge]][1], middle_edge)


@dataclass(frozen=True)
class Rotation:
    """The rotation number theta/pi of the multipliers of the periodic orbit on one level, between two bounds.

    Attributes:
        energy: The energy, as text.
        lower: Bound from below.
        upper: Bound from above.
    """

    energy: str
    lower: float
    upper: float


@dataclass(frozen=True)
class Margins:
    """The conditions of a certificate that one arithmetic has verified, rounded to the safe side for printing.

    All numbers hold for every level in the ball |H - H_0|, |C_k - C_k0| <= `level_radius`.

    Attributes:
        arithmetic: Which arithmetic it was.
        n_unstable: Number of unstable multipliers of the periodic orbit, k; as many are stable.
        n_edges: Number of covering relations.
        n_steps: Number of rigorous steps of integration.
        level_radius: Radius of the ball of levels.
        expansion: The least |q_u| of images of |q_u| = 1, over all edges; above 1.
        contraction: The largest |q_s| of images; below 1.
        cone: The least margin of the cone conditions; positive.
        reversers: The changes of signs that map the periodic orbit to itself, run backward.
        symmetric_q: The largest |q_u| and |q_s| of images of the small sets under the reversers; below 1.
        apart_from_orbit: Least distance, in the largest component, of the middle set to the orbits near gamma.
        apart_from_excursion: Least distance to the excursion at other times.
        apart_from_image: Least distance to the image of the excursion under the symmetry.
        loop_times: Upper bounds of the flight times of the two loops.
        entropy: Lower bound of the topological entropy of the flow on the invariant set, in E/R and in E.
        discriminant: Upper bound of T^2/4 - S + 2 of the characteristic polynomial of gamma; negative. None where it is
            not proved to be, and for one unstable multiplier.
        rotations: Rotation numbers on two levels, which differ; None where that is not proved.
        undecided: What was not proved of the multipliers; empty where nothing is missing.
        seconds: Time of the check.
    """

    arithmetic: str
    n_unstable: int
    n_edges: int
    n_steps: int
    level_radius: str
    expansion: float
    contraction: float
    cone: float
    reversers: tuple[tuple[int, ...], ...]
    symmetric_q: float
    apart_from_orbit: float
    apart_from_excursion: float
    apart_from_image: float
    loop_times: tuple[float, float]
    entropy: float
    discriminant: float | None
    rotations: tuple[Rotation, Rotation] | None
    undecided: str
    seconds: float

    @property
    def excludes_integrals(self) -> bool:
        """Whether the theorem on further analytic constants of motion applies.

        One unstable multiplier asks for nothing beyond the transversal homoclinic orbit, two for a rotation number that
        is irrational on almost all levels.
        """
        return self.n_unstable == 1 or self.rotations is not None
