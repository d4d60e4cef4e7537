r"""The regions of a bifurcation diagram in the plane, and the number of tori over each, by a count.

Values of random states are joined to their neighbours where the straight line between them crosses no critical curve:
the parts that are joined are regions.  Over each the fibres have as many tori, counted at the value that is furthest
from the curves, unless it is as near to one as this bends between its points.  A region that no random state has its
values in is not found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OrbitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline
from liepoisson.inputs.refusals import check_kind, counted
from liepoisson.io.display import Found
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import linear
from liepoisson.streams import Purpose, stream
from liepoisson.tori.diagrams import Diagram, apart, are_on
from liepoisson.tori.fibres import Fibre, fibre
from liepoisson.tori.momentum_maps import moved_onto, unit_equations

if TYPE_CHECKING:
    from liepoisson.model.system import System

_NEIGHBOURS = 12
"""Each value is joined to so many of the nearest ones; values of one region that are not are two regions."""
_WALL = 0.02
"""Over values nearer than this to a curve, relative to the figure, flows may close too late to be counted."""


@dataclass(frozen=True, eq=False)
class Region(ReadOnlyArrays):
    """A region of a diagram.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> lp.tori.regions(lp.tori.diagram(leaf, energy_max=2), n_states=20)[0].fibre
        <Fibre of 'spherical-pendulum': 1 torus by 20 states; one with less than 14% of them may be missed>

    Attributes:
        values: Values of random states in it, of the integrals of the plane, shape (m, 2).
        fibre: The fibre of the value that is furthest from the curves; None if all are too near to them.
    """

    values: Array
    fibre: Fibre | None

    def __repr__(self) -> str:
        if self.fibre is None:
            return f"<Region of {len(self.values)} values, all near to critical ones>"
        at = ", ".join(f"{value:.6g}" for value in self.fibre.value)
        return f"<Region around ({at}): {counted(self.fibre.n_tori, 'torus', 'tori')}>"


@dataclass(frozen=True, eq=False, repr=False)
class Regions(Found[Region], SavedWhole):
    """The regions of a diagram, those with most values first.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.regions(lp.tori.diagram(leaf, energy_max=2), n_values=100, n_states=20)
        >>> found.columns()["n_tori"].tolist()
        [1]

    Attributes:
        diagram: The diagram.
        found: The regions.
    """

    kind = "regions of a diagram"
    made_by = "lp.tori.regions"
    row = "region"
    titles = ("around", "tori", "a torus may be missed with", "values")

    diagram: Diagram
    found: tuple[Region, ...]

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.diagram.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each region a value in it, its number of tori (-1: not counted), and more.

        These are the share of states that a torus may have and be missed, and how many values were found.
        """
        names = self.diagram.momentum.names
        none = np.full(len(names), np.nan)
        values = np.array([none if one.fibre is None else one.fibre.value for one in self.found])
        rows: dict[str, NDArray[Any]] = dict(zip(names, values.reshape(-1, len(names)).T, strict=True))
        rows["n_tori"] = np.array([-1 if one.fibre is None else one.fibre.n_tori for one in self.found], dtype=np.intp)
        rows["missed"] = np.array([np.nan if one.fibre is None else one.fibre.missed for one in self.found])
        return rows | {"n_values": np.array([len(one.values) for one in self.found], dtype=np.intp)}

    def _head(self) -> str:
        names = ", ".join(self.diagram.momentum.names)
        return f"{counted(len(self), 'region')} of ({names}) of {self.system.name!r}, met by values of random states:"

    def _row(self, one: Region, /) -> tuple[str, ...]:
        if one.fibre is None:
            return "too near to critical values", "not counted", "", str(len(one.values))
        at = ", ".join(f"{value:.6g}" for value in one.fibre.value)
        return at, str(one.fibre.n_tori), f"{100 * one.fibre.missed:.2g}% of the states", str(len(one.values))


@explains_its_arguments
def regions(
    found: Diagram,
    *,
    n_values: int = 600,
    n_states: int = 200,
    spread: float = 1.0,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Regions:
    r"""The regions of a diagram and the number of tori over each.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> lp.tori.regions(lp.tori.diagram(leaf, energy_max=2), n_states=20)[0].fibre.n_tori
        1

    Args:
        found: What `diagram` returned.
        n_values: Number of random states whose values are looked at.
        n_states: Random states of each fibre that is counted, see `fibre`.
        spread: Standard deviation of the random states, in units of the leaf.

    Raises:
        ParameterError: it is no diagram.
        OrbitError: the flows over a region do not close: its fibres are not compact.
        TimeLimitError: the time is over.
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(found, Diagram, "found", "what diagram returns", "call it first")
    m, width = as_count(n_values, "n_values", least=1), as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        units = found.leaf.in_units().units
        rough = width * stream(as_seed(seed), Purpose.FIBRES).standard_normal((m, len(units))) * units
        names, held = found.momentum.names, found.at
        functions = ((found.momentum.integrals[name], value) for name, value in held.items())
        states = moved_onto(*unit_equations(found.leaf, functions), rough)
        full = found.momentum(states[np.isfinite(states).all(axis=1)])
        full = full[full[:, names.index("H")] <= (np.inf if "H" in held else found.energy_max)]
        values = full[:, [names.index(name) for name in found.names]]
        size = np.ptp(values, axis=0) if len(values) else np.ones(2)
        size = np.where(size > 0, size, 1.0)
        curves = [family.values / size for family in found.families]
        rest = found.rest_values / size
        begins = np.concatenate([np.zeros((0, 2)), *(curve[:-1] for curve in curves), rest])
        ends = np.concatenate([np.zeros((0, 2)), *(curve[1:] for curve in curves), rest])
        labels = _joined(values / size, begins, ends)
        result = list[Region]()
        for label in np.unique(labels):
            inside = values[labels == label]
            its_values = full[labels == label]
            distance = apart(inside[:, None] / size, begins, ends).min(axis=1, initial=np.inf)
            best, counted = int(distance.argmax()), None
            if not any(are_on(inside[[best]] / size, curve)[0] for curve in curves):
                try:
                    counted = fibre(
                        found.leaf,
                        its_values[best],
                        momentum=found.momentum,
                        n_states=n_states,
                        spread=spread,
                        seed=seed,
                        time_limit=max(deadline.left, 1e-3),
                    )
                except OrbitError:
                    if distance[best] > _WALL:
                        raise
            result.append(Region(inside, counted))
    return Regions(found, tuple(sorted(result, key=lambda region: -len(region.values))))


def _joined(values: Array, begins: Array, ends: Array) -> NDArray[np.intp]:
    """The number of the part of each value, of those that are joined."""
    m = len(values)
    labels = np.arange(m)
    if m < 2:
        return labels
    distance = linear.norm(values[:, None] - values[None], axis=2)
    nearest = np.argsort(distance, axis=1, kind="stable")[:, 1 : _NEIGHBOURS + 1]
    for k in range(m):
        for j in nearest[k]:
            if labels[k] != labels[j] and not _crosses(values[k], values[j], begins, ends):
                labels[labels == labels[j]] = labels[k]
    return labels


def _crosses(here: Array, there: Array, begins: Array, ends: Array) -> bool:
    """Whether the line from here to there crosses a segment."""

    def side(a: Array, b: Array, c: Array) -> Array:
        return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])

    across = side(here, there, begins) * side(here, there, ends) <= 0
    return bool((across & (side(begins, ends, here) * side(begins, ends, there) <= 0)).any())
