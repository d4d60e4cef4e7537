r"""The points of a sweep: places on a lattice, the cells that refinement halves, and what is prescribed at each point.

With L levels of refinement, the values of an axis lie at multiples of $2^L$; a cell of level k has sides of $2^{L-k}$.
What parameters, energy and Casimirs are at a point say axes and formulas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liepoisson.errors import ExpressionError, ParameterError
from liepoisson.formula.parameters import Shape, component_name
from liepoisson.inputs.arrays import Array
from liepoisson.portable import elementary
from liepoisson.sweeps.spec import CASIMIR, COMPONENT

if TYPE_CHECKING:
    from liepoisson.sweeps.family import Family
    from liepoisson.sweeps.spec import SweepSpec, Value

Place: TypeAlias = tuple[int, ...]
"""A point of the lattice, a whole number for each axis."""


@dataclass(frozen=True)
class Cell:
    """A cell by its lowest corner and its side."""

    corner: Place  # the lowest corner
    side: int  # length of its sides, a power of two

    def corners(self) -> list[Place]:
        """All corners, two or four."""
        return self._grid((0, self.side))

    def halves(self) -> list[Cell]:
        """The two or four cells of half the side."""
        return [Cell(corner, self.side // 2) for corner in self._grid((0, self.side // 2))]

    def new_places(self) -> list[Place]:
        """What halving adds: the middle, and in two dimensions those of the four sides."""
        return [p for p in self._grid((0, self.side // 2, self.side)) if p not in self.corners()]

    def _grid(self, steps: Sequence[int]) -> list[Place]:
        return [
            tuple(c + s for c, s in zip(self.corner, shift, strict=True))
            for shift in product(steps, repeat=len(self.corner))
        ]


class Lattice:
    """The lattice of a sweep."""

    def __init__(self, spec: SweepSpec) -> None:
        self.levels = spec.refine.levels if spec.refine else 0
        self.unit = 2**self.levels
        self._spec = spec
        self.shape = tuple((n - 1) * self.unit + 1 for n in spec.shape)

    def grid(self) -> list[Place]:
        """The points of level 0, the last axis fastest."""
        return list(product(*(range(0, n, self.unit) for n in self.shape)))

    def cells(self) -> list[Cell]:
        """The cells of level 0; none along an axis of one value."""
        corners = product(*(range(0, n - 1, self.unit) for n in self.shape))
        return [Cell(corner, self.unit) for corner in corners]

    def coordinates(self, places: Sequence[Place]) -> Array:
        """Values of the axes, linear between the given ones, shape (point, axis)."""
        positions = np.array(places, np.float64).reshape(len(places), len(self.shape)) / self.unit
        columns = [
            elementary.interp(positions[:, k], np.arange(len(axis.values)), axis.values)
            for k, axis in enumerate(self._spec.axes)
        ]
        return np.stack(columns, axis=-1)


def split(cells: Sequence[Cell], statistic: Mapping[Place, float], difference: float) -> tuple[list[Cell], list[Place]]:
    """The halves of the cells whose corners differ by more than this, and the points that they need, in order."""
    halves: list[Cell] = []
    places: set[Place] = set()
    for cell in cells:
        values = np.array([statistic[corner] for corner in cell.corners()])
        values = values[np.isfinite(values)]
        if values.size > 1 and np.ptp(values) > difference:
            halves += cell.halves()
            places.update(place for place in cell.new_places() if place not in statistic)
    return halves, sorted(places)


@dataclass(frozen=True)
class Targets:
    """What is prescribed at each of some points."""

    parameters: Mapping[str, Array]  # values of parameters by name, shape (point,) or (point, component)
    energy: Array | None  # shape (point,), or None where it is free
    casimirs: Mapping[str, Array]  # shape (point,) each

    def __len__(self) -> int:
        """How many points: each axis sets something."""
        arrays = (*self.parameters.values(), *self.casimirs.values(), self.energy)
        return len(next(array for array in arrays if array is not None))

    def values(self, point: int) -> dict[str, Any]:
        """The parameters of one point: numbers, and tuples of them."""
        rows = {name: array[point] for name, array in self.parameters.items()}
        return {name: tuple(row.tolist()) if np.ndim(row) else float(row) for name, row in rows.items()}

    def rows(self, rows: slice | list[int]) -> Targets:
        """Those of some of the points."""
        return Targets(
            {name: values[rows] for name, values in self.parameters.items()},
            None if self.energy is None else self.energy[rows],
            {name: values[rows] for name, values in self.casimirs.items()},
        )


def evaluate_targets(spec: SweepSpec, family: Family, points: Array) -> Targets:
    """The prescribed values at points of shape (point, axis).

    An axis that is named like a parameter, a component of one, the energy or a Casimir sets it, whether or not formulas
    use it, too.
    """
    columns = {axis.name: points[:, k] for k, axis in enumerate(spec.axes)}
    used: set[str] = set()
    parameters = {name: _values(value, columns, name, used) for name, value in spec.parameters.items()}
    casimirs = {name: _values(value, columns, name, used) for name, value in spec.starts.casimirs.items()}
    energy = None if spec.starts.energy is None else _values(spec.starts.energy, columns, "energy", used)
    for name, values in columns.items():
        owner = _owner(name, family)
        if (name == "energy" or CASIMIR.fullmatch(name)) and (name in family.shapes or owner is not None):
            what = "the energy" if name == "energy" else "a Casimir"
            raise ParameterError(
                f"axis {name}: a name must stand for one thing; it is {what} of the starts, and a parameter of "
                f"{family.name}. Give the axis another name, and use it in a formula for one of them."
            )
        if name in family.shapes:
            _refuse_twice(name, name in parameters, "the parameter")
            parameters[name] = values
        elif owner is not None:
            _set_component(parameters, family, owner, name, values)
        elif name == "energy":
            _refuse_twice(name, energy is not None, "the energy of the starts")
            energy = values
        elif CASIMIR.fullmatch(name):
            _refuse_twice(name, name in casimirs, "this Casimir of the starts")
            casimirs[name] = values
        else:
            continue
        used.add(name)
    _refuse_unused(columns, used, family)
    family.check(parameters)
    _refuse_nonfinite({**parameters, **casimirs, **({} if energy is None else {"energy": energy})})
    return Targets(parameters, energy, casimirs)


def _values(value: Value, columns: Mapping[str, Array], name: str, used: set[str]) -> Array:
    """A value or a list of them at all points, shape (point,) or (point, component)."""
    n = len(next(iter(columns.values())))
    if isinstance(value, Sequence) and not isinstance(value, str):
        return np.stack([_values(item, columns, f"{name}{k + 1}", used) for k, item in enumerate(value)], axis=-1)
    if isinstance(value, str):
        return _formula(value, columns, name, used)
    return np.full(n, float(value))


def _formula(text: str, columns: Mapping[str, Array], name: str, used: set[str]) -> Array:
    from sympy import Symbol

    from liepoisson.compile.symbols import numpy_function
    from liepoisson.formula.expression import read_expression
    from liepoisson.formula.scope import Scope

    try:
        expression = read_expression(text, Scope(symbols=tuple(columns)))
    except ExpressionError as error:
        raise ParameterError(f"{name}: {error.within_formula()}") from error
    used.update(str(symbol) for symbol in expression.free_symbols)
    function = numpy_function([Symbol(axis) for axis in columns], [expression])
    with np.errstate(all="ignore"):
        values = np.asarray(function(*columns.values())[0], np.float64)
    return np.array(np.broadcast_to(values, len(next(iter(columns.values())))))


def _owner(name: str, family: Family) -> tuple[str, int] | None:
    """The vector parameter of which a name is a component, and which: a2 is ("a", 1)."""
    found = COMPONENT.fullmatch(name)
    if found is None:
        return None
    shape, index = family.shapes.get(found[1]), int(found[2]) - 1
    return (found[1], index) if shape is not None and len(shape) == 1 and index < shape[0] else None


def _set_component(
    parameters: dict[str, Array], family: Family, owner: tuple[str, int], name: str, values: Array
) -> None:
    vector, index = owner
    if vector not in parameters:
        default = family.defaults.get(vector)
        if default is None:
            raise ParameterError(f"axis {name}: {vector} has no value for its other components. Give {vector} one.")
        parameters[vector] = np.tile(np.array([float(v) for v in default]), (len(values), 1))
    if parameters[vector].ndim != 2 or parameters[vector].shape[1] <= index:
        raise ParameterError(f"axis {name}: {vector} must have {index + 1} components or more. Give a list.")
    parameters[vector] = parameters[vector].copy()
    parameters[vector][:, index] = values


def _refuse_twice(name: str, given: bool, what: str) -> None:
    if given:
        raise ParameterError(f"axis {name}: {what} has another value or formula, too. Remove one of them.")


def _refuse_unused(columns: Mapping[str, Array], used: set[str], family: Family) -> None:
    for name in columns:
        if name not in used:
            if name == "H":
                raise ParameterError("axis H: nothing depends on it. Call it energy if it is the energy of the starts.")
            known = [entry for parameter, shape in family.shapes.items() for entry in _entries(parameter, shape)]
            raise ParameterError(
                f"axis {name}: nothing depends on it. Name it like one of "
                f"{', '.join((*known, 'energy', 'C1, C2, ...'))}{_formula_with(name, family.shapes)}."
            )


def _entries(parameter: str, shape: Shape) -> list[str]:
    """What an axis may be called to stand for a parameter or its entries."""
    return [component_name(parameter, index, shape) for index in product(*(range(1, n + 1) for n in shape))]


def _formula_with(axis: str, shapes: Mapping[str, Shape]) -> str:
    """How a parameter is given by a formula in an axis; nothing where there is none but matrices."""
    few = [(name, shape) for name, shape in sorted(shapes.items(), key=lambda one: len(one[1])) if len(shape) < 2]
    if not few:
        return ""
    name, shape = few[0]
    given = ", ".join([f'"1 + {axis}^2"'] * (shape[0] if shape else 1))
    return f", or use it in a formula, such as {name} = {f'[{given}]' if shape else given}"


def _refuse_nonfinite(values: Mapping[str, Array]) -> None:
    for name, array in values.items():
        bad = ~np.isfinite(array.reshape(len(array), -1)).all(axis=1)
        if bad.any():
            raise ParameterError(f"{name}: its formula is not a finite number at point {int(np.argmax(bad))}.")
