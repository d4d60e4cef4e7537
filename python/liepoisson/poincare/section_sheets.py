r"""Axes on which a section of dimension 2 is a graph, and the sheets of one that is not."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array
from liepoisson.inputs.names import ANGLE
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

DIRECTION = "direction"
"""In place of the name of a function: the sheets are those of the two directions in which orbits cross."""
_ROUND_OFF = 1e-9
"""Relative size of a bracket, and of a difference of energies, below which it would show nothing but errors."""
_IN_A_CELL = 4
"""Points in a cell of the plane on the average: neighbours that are compared."""
_NEWTON = 4
"""Steps of Newton's method after that of Runge and Kutta: each doubles the digits, of which it gives four."""
_NAME = re.compile(r"[A-Za-z_]\w*")
_FEW, _MANY = 2000, 10_000
"""States at which axes are looked for, and by which those that are found are judged."""


@dataclass(frozen=True)
class SectionAxes:
    """What a figure of a section has along its axes.

    Attributes:
        x: The function across.
        y: The function up.
        sheets: A function whose two signs tell two sheets apart, each of which is a graph over x and y, or `DIRECTION`;
            "" where the section itself is one, or nothing is known.
        is_graph: Whether the section is a graph over x and y, as far as its states tell.
    """

    x: str
    y: str
    sheets: str = ""
    is_graph: bool = False

    @property
    def by_direction(self) -> bool:
        """Whether the sheets are those of crossings in one direction and in the other."""
        return self.sheets == DIRECTION


class SectionPlane:
    """States on a section of dimension 2, with the brackets that tell whether two functions are coordinates there.

    Args:
        system: A system whose parameters are all numbers, on leaves of dimension 4.
        states: States of the section, shape (state, component).
        surface: The function that is zero on the section.
    """

    def __init__(self, system: System, states: Array, surface: Any) -> None:
        self.system, self.states = system, states
        self.surface = system.functions.of(surface)
        self.energy = system.moving.functions.energy
        self._tensor = system.functions.poisson_tensor(states)
        self._flows = [self._flow(function) for function in (self.energy, self.surface)]
        self._known: dict[Any, tuple[Array, Array]] = {}

    def areas(self, x: Any, y: Any) -> tuple[Array, Array]:
        r"""The form $\{s, H\}\{x, y\} + \{x, H\}\{y, s\} + \{x, s\}\{H, y\}$ at the states; the size of its terms."""
        (dx, along_x), (dy, _) = self._slope(x), self._slope(y)
        (dh, along_h), (ds, _) = self._flows
        terms = np.array(
            [
                _dot(ds, along_h) * _dot(dx, self._along(y)),
                _dot(dx, along_h) * _dot(dy, self._flows[1][1]),
                -_dot(ds, along_x) * _dot(dh, self._along(y)),
            ]
        )
        return terms.sum(axis=0), np.abs(terms).sum(axis=0)

    def signs(self, x: Any, y: Any) -> NDArray[np.int64]:
        """The signs of the form; 0 where it is not more than round-off, or has no value."""
        area, size = self.areas(x, y)
        return (np.sign(area) * (np.abs(area) > _ROUND_OFF * size)).astype(np.int64)

    def meets_itself(self, x: Any, y: Any) -> bool:
        """Whether the states lie on sheets above each other, each with x and y for its coordinates.

        From one of two states that are neighbours in the plane the section is followed to the place of the other: on
        one sheet that leads to the other state.
        """
        across, up = self.system.functions.of(x), self.system.functions.of(y)
        first, second = _neighbours(np.stack([across(self.states), up(self.states)], axis=-1))
        start, end = self.states[first], self.states[second]
        same = self._on_one_level(start, end)
        start, end = start[same], end[same]
        wanted = [f(end) for f in (self.energy, self.surface, across, up)]
        functions = (self.energy, self.surface, across, up)

        def step(x: Array) -> Array:
            return _towards(self.system, functions, x, [w - f(x) for w, f in zip(wanted, functions, strict=True)])

        way = [w - f(start) for w, f in zip(wanted, functions, strict=True)]
        k1 = _towards(self.system, functions, start, way)
        k2 = _towards(self.system, functions, start + k1 / 2, way)
        k3 = _towards(self.system, functions, start + k2 / 2, way)
        reached = start + (k1 + 2 * k2 + 2 * k3 + _towards(self.system, functions, start + k3, way)) / 6
        correction = reached
        for _ in range(_NEWTON):
            correction = step(reached)
            reached = reached + correction
        size = np.abs(start).max(axis=-1) + np.abs(end).max(axis=-1)
        converged = np.abs(correction).max(axis=-1) < _ROUND_OFF * size
        keeps = self._form(functions, reached) * self._form(functions, start) > 0
        keeps &= self._rate(reached) * self._rate(start) > 0
        apart, were = _length(reached - end), _length(start - end)
        return bool((converged & keeps & (2 * apart > were) & (were > _ROUND_OFF * size)).any())

    def is_graph(self, x: Any, y: Any) -> bool:
        """Whether x and y are coordinates at all states and no two states lie above each other."""
        signs = self.signs(x, y)
        return bool(abs(signs.sum()) == len(signs) and not self.meets_itself(x, y))

    def side(self, sheets: str) -> Array:
        """Values at the states whose signs tell sheets apart."""
        return self._rate(self.states) if sheets == DIRECTION else self.system.functions.of(sheets)(self.states)

    def _rate(self, x: Array) -> Array:
        return _dot(self.surface.gradient(x), self.system.vector_field(x))

    def _form(self, functions: Sequence[PhaseFunction], x: Array) -> Array:
        return _pfaffian(_brackets(self.system, functions, x)[1])

    def _on_one_level(self, start: Array, end: Array) -> NDArray[np.bool_]:
        same = np.ones(len(start), dtype=bool)
        for function in (self.energy, *self.system.functions.casimirs.values()):
            one, other = function(start), function(end)
            same &= np.abs(one - other) <= _ROUND_OFF * np.maximum(1.0, np.abs(one))
        return same

    def _flow(self, function: PhaseFunction) -> tuple[Array, Array]:
        slope = function.gradient(self.states)
        return slope, linear.einsum("nij,nj->ni", self._tensor, slope)

    def _slope(self, function: Any) -> tuple[Array, Array]:
        if function not in self._known:
            self._known[function] = self._flow(self.system.functions.of(function))
        return self._known[function]

    def _along(self, function: Any) -> Array:
        return self._slope(function)[1]


@np.errstate(all="ignore")
def section_axes(system: System, states: Array, surface: Any, default: tuple[str, str]) -> SectionAxes:
    """Axes on which a section of dimension 2 is a graph; else those on which each of two sheets is; else the default.

    Angles of two components of a vector with the momentum about the third axis come first, and the default, also where
    each direction of crossing is a sheet; then other components and angles.

    Args:
        system: A system whose parameters are all numbers, on leaves of dimension 4.
        states: States of the section, shape (crossing, component).
        surface: The function that is zero on the section.
        default: The axes where there are no better ones.
    """
    states = states[np.isfinite(states).all(axis=-1)]
    if len(states) < 2:
        return SectionAxes(*default)
    few, whole = (SectionPlane(system, states[:: -(-len(states) // n)], surface) for n in (_FEW, _MANY))
    first, others = (_that_act_first(system, pairs) for pairs in _pairs(system, default))
    for pairs, splitters in ((first, [DIRECTION]), (others, []), ([*first, *others], _splitters(system))):
        for x, y in pairs:
            if few.is_graph(x, y) and whole.is_graph(x, y):
                return SectionAxes(x, y, is_graph=True)
        for x, y in pairs:
            if (sheets := _sheets(few, x, y, splitters)) and _sheets(whole, x, y, splitters) == sheets:
                return SectionAxes(x, y, sheets)
    return SectionAxes(*default)


def _sheets(plane: SectionPlane, x: str, y: str, splitters: Sequence[str]) -> str:
    """A function whose signs are those of two sheets that are graphs over x and y; "" where there is none."""
    signs = plane.signs(x, y)
    if not signs.all() or abs(signs.sum()) == len(signs):
        return ""
    for name in splitters:
        side = np.sign(plane.side(name)) * signs
        if abs(side.max() - side.min()) < 2:
            halves = (SectionPlane(plane.system, plane.states[signs == s], plane.surface) for s in (1, -1))
            return "" if any(half.meets_itself(x, y) for half in halves) else name
    return ""


def _vectors(system: System) -> list[list[str]]:
    """The names of the components of each vector; of coordinates and momenta none."""
    names, size = list(system.component_names), system.vector_length
    if system.bracket.has_scalar_fields:
        return []
    return [names[k : k + size] for k in range(0, len(names), size)]


def _pairs(system: System, default: tuple[str, str]) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Pairs of functions: those that a figure has if it can, angles with their momenta and the default; the others."""
    vectors, names = _vectors(system), list(system.component_names)
    turns = [(0, 1, 2), (1, 2, 0), (2, 0, 1)] if system.vector_length == 3 else []
    conjugate = [(f"{ANGLE}({v[j]}, {v[i]})", vectors[0][k]) for v in vectors[:0:-1] for i, j, k in turns]
    angles = [f"{ANGLE}({b}, {a})" for v in vectors for a, b in combinations(v, 2)]
    first = list(dict.fromkeys([*conjugate, default]))
    others = [(a, b) for b, a in combinations(names, 2)]
    others += [(angle, name) for angle in angles for name in names] + list(combinations(angles, 2))
    return first, [pair for pair in others if pair not in first]


def idle_components(system: System) -> frozenset[str]:
    """Components that act on nothing: neither the energy contains them, nor the rate of a component that acts.

    Such is the second field of a top that has no charge: it turns with the body, and the body does not feel it.
    """
    names, rates = system.component_names, system.polynomial_rates
    if rates is not None and (energy := system.polynomial_hamiltonian) is not None:
        occurring = [{names[k] for k in rate.coordinates} for rate in rates]
        acting, new = set[str](), {names[k] for k in energy.coordinates}
    else:
        occurring = [set(map(str, rate.free_symbols)) & set(names) for rate in system.equations.values()]
        acting, new = set[str](), set(map(str, system.hamiltonian.free_symbols)) & set(names)
    while new:
        acting |= new
        new = set[str]().union(*(occurring[names.index(name)] for name in new)) - acting
    return frozenset(names) - acting


def _that_act_first(system: System, pairs: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Pairs of functions, those of idle components after all others."""
    idle = idle_components(system)
    return sorted(pairs, key=lambda pair: any(set(_NAME.findall(function)) & idle for function in pair))


def _splitters(system: System) -> list[str]:
    """What may tell sheets apart: the direction, signs of components, and of momenta of the polar angles of vectors."""
    vectors = _vectors(system)
    turns = [(0, 1), (1, 2), (2, 0)] if system.vector_length == 3 else []
    momenta = [f"{v[j]}*{vectors[0][i]} - {v[i]}*{vectors[0][j]}" for v in vectors[1:] for i, j in turns]
    return [DIRECTION, *system.component_names, *momenta]


def _neighbours(places: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of points in one cell of a plane: the first there with each other one."""
    low, width = places.min(axis=0), np.ptp(places, axis=0)
    if not (np.isfinite(places).all() and (width > 0).all()):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    n = max(1, int(np.sqrt(len(places) / _IN_A_CELL)))
    column, row = np.minimum((places - low) / width * n, n - 1).astype(np.int64).T
    cell = column * n + row
    order = np.argsort(cell, kind="stable")
    first = order[np.searchsorted(cell[order], cell[order])]
    return first[first != order], order[first != order]


def _towards(system: System, functions: Sequence[PhaseFunction], x: Array, way: Sequence[Array]) -> Array:
    r"""The vector along the leaf that changes four functions by given amounts, in first order.

    It is $\sum_a c_a J\nabla f_a$ with $\sum_a \{f_b, f_a\} c_a$ given, an antisymmetric system of four equations.
    """
    flows, b = _brackets(system, functions, x)
    (b01, b02, b03, b12, b13, b23), (w0, w1, w2, w3) = b, way
    area = _pfaffian(b)
    coefficients = (
        -b23 * w1 + b13 * w2 - b12 * w3,
        b23 * w0 - b03 * w2 + b02 * w3,
        -b13 * w0 + b03 * w1 - b01 * w3,
        b12 * w0 - b02 * w1 + b01 * w2,
    )
    return sum((c / area)[:, None] * flow for c, flow in zip(coefficients, flows, strict=True))  # pyright: ignore[reportReturnType]


def _brackets(system: System, functions: Sequence[PhaseFunction], x: Array) -> tuple[list[Array], list[Array]]:
    tensor = system.functions.poisson_tensor(x)
    slopes = [f.gradient(x) for f in functions]
    flows = [linear.einsum("nij,nj->ni", tensor, slope) for slope in slopes]
    return flows, [_dot(slopes[a], flows[b]) for a, b in combinations(range(4), 2)]


def _pfaffian(b: Sequence[Array]) -> Array:
    b01, b02, b03, b12, b13, b23 = b
    return b01 * b23 - b02 * b13 + b03 * b12


def _dot(first: Array, second: Array) -> Array:
    return linear.einsum("ni,ni->n", first, second)


def _length(x: Array) -> Array:
    return np.sqrt(_dot(x, x))
