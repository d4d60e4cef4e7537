"""Families of periodic orbits in files: what is read back is the family, which can be drawn and goes on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.arrays import Array
from liepoisson.io.result import Result, labelled, names_along, recorded
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.discrete_symmetries import DiscreteSymmetry, discrete_symmetries
from liepoisson.model.free_parameter import FreeParameter
from liepoisson.orbits.closed_orbits import PeriodicOrbit
from liepoisson.orbits.level import level_of
from liepoisson.orbits.orbit_families import FamilyPoint, OrbitFamily, value_of

if TYPE_CHECKING:
    from liepoisson.model.system import System

_PLAIN = ("time", "n_segments", "residual", "is_isolated", "pair_defect", "trivial_defect")
"""Attributes of an orbit that are numbers."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SavedFamily(Result):
    """A family as a dataset and a file.

    Attributes:
        system: The system of the first orbit.
        variable: What varies.
        end: Why the family ends.
        value: The value of what varies, shape (orbit,).
        period: The periods, shape (orbit,).
        start: A state of each orbit, shape (orbit, component).
        orbits: Everything about the orbits, as plain data.
        points: The same of bifurcations.
    """

    kind = "orbit family"
    rows = ("orbit",)

    components: tuple[str, ...] = names_along("component")
    system: Any
    variable: str
    end: str
    value: Array = labelled("orbit", long_name="value of what varies")
    period: Array = labelled("orbit", long_name="period")
    start: Array = labelled("orbit", "component", long_name="a state of the orbit")
    orbits: list[Any] = recorded(list, list)
    points: list[Any] = recorded(list, list)

    def arguments(self) -> dict[str, Any]:
        """What a run is repeated with: none, as a family depends on where it began."""
        return {}

    @classmethod
    def of(cls, family: OrbitFamily) -> SavedFamily:
        """The family as it is written."""
        own = ({"kind": p.kind, "after": p.after, "is_located": p.is_located} for p in family.points)
        points = [
            {**one, "tangent": point.tangent.tolist(), "orbit": _record(point.orbit, family.along)}
            for one, point in zip(own, family.points, strict=True)
        ]
        return cls(
            components=family.system.component_names, system=family.system, variable=family.along, end=family.end,
            value=family.value, period=family.period, start=np.array([one.start for one in family]),
            orbits=[_record(one, family.along) for one in family], points=points,
        )  # fmt: skip

    def family(self) -> OrbitFamily:
        """The family that was written."""
        symmetries: Sequence[DiscreteSymmetry] = ()
        if any(one["symmetry"] for one in self.orbits):
            symmetries = tuple(discrete_symmetries(self.system))
        found = tuple(_orbit(one, self.system, self.variable, symmetries) for one in self.orbits)
        points = tuple(
            FamilyPoint(
                one["kind"], _orbit(one["orbit"], self.system, self.variable, symmetries), one["after"],
                one["is_located"], np.array(one["tangent"], dtype=np.float64),
            )
            for one in self.points
        )  # fmt: skip
        return OrbitFamily(self.variable, found, points, self.end)


def _record(orbit: PeriodicOrbit, along: str) -> dict[str, Any]:
    """An orbit as plain data; JSON keeps each double."""
    symmetry = orbit.symmetry
    return {
        "value": value_of(orbit, along),
        "level": {name: str(value) for name, value in orbit.level.values.items()},
        "units": orbit.level.units.tolist(),
        "start": orbit.start.tolist(),
        "symmetry": None if symmetry is None else [list(symmetry.permutation), list(symmetry.signs)],
        "momenta": dict(orbit.momenta),
        "angles": orbit.angles.tolist(),
        "multipliers": [[float(m.real), float(m.imag)] for m in orbit.multipliers],
        **{name: getattr(orbit, name) for name in _PLAIN},
    }


def _orbit(
    record: Mapping[str, Any], system: System, along: str, symmetries: Sequence[DiscreteSymmetry]
) -> PeriodicOrbit:
    """The orbit that was written."""
    if along not in ("energy", *system.functions.casimirs):
        system = FreeParameter(system, along).at(record["value"])
    start = np.array(record["start"], dtype=np.float64)
    level = level_of(system, Leaf.through(system, start), float(system.functions.energy(start)))
    values = {name: read_parameter(text, name) for name, text in record["level"].items()}
    pair = record["symmetry"]
    symmetry = next((one for one in symmetries if pair and [list(one.permutation), list(one.signs)] == pair), None)
    return PeriodicOrbit(
        level=replace(level, values=values, units=np.array(record["units"], dtype=np.float64)),
        start=start,
        symmetry=symmetry,
        momenta=record["momenta"],
        angles=np.array(record["angles"], dtype=np.float64),
        multipliers=np.array([complex(*one) for one in record["multipliers"]], dtype=np.complex128),
        **{name: record[name] for name in _PLAIN},
    )
