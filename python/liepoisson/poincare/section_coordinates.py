"""Whether two functions are coordinates on a section of dimension 2, or fold it, and which two a figure shows.

The orbits of a section may lie on several levels of energy and Casimirs: curves of different levels cross.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ExpressionError, ParameterError
from liepoisson.formula.scalars import as_phase_points
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf_stratum import numeric_rank
from liepoisson.poincare.section_sheets import SectionAxes, SectionPlane, idle_components, section_axes
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System
    from liepoisson.poincare.section import Section

_SAMPLES = 10_000
"""States at which the functions are judged."""


def dimension_of_section(run: Section) -> int | None:
    """The dimension of a section, that of the leaf of its first crossing less 2; None if its record does not tell.

    It does not where no crossing was found, where only functions of the state were kept, or where the surface or the
    system is not known as formulas.
    """
    from liepoisson.model.system import System

    system = run.system
    if not isinstance(system, System) or not len(run.time) or run.coordinates != run.components:
        return None
    try:
        if system.functions.of(run.surface).is_constant:
            return None
    except (ExpressionError, ParameterError):
        return None
    return max(numeric_rank(system, run.state[0]) - 2, 0)


def figure_axes(run: Section) -> SectionAxes:
    """What a figure of a section has along its axes; the default where it has not dimension 2.

    Of kept functions they are the first and the last.
    """
    if run.coordinates != run.components:
        return SectionAxes(run.coordinates[0], run.coordinates[-1])
    x, y = component_axes(run)
    if dimension_of_section(run) != 2:
        return SectionAxes(x, y)
    return section_axes(as_system(run.system), run.state, run.surface, (x, y))


def component_axes(run: Section) -> tuple[str, str]:
    """Two components of the state that vary on a section, if possible such as act on the others."""
    from liepoisson.model.system import System

    idle = idle_components(run.system) if isinstance(run.system, System) else frozenset[str]()
    n = len(run.components) - (0 if getattr(run.system, "clock", None) is None else 2)  # without time and its momentum
    beside = np.concatenate([run.start, run.end_state])[:, :n]
    return default_axes(run.components[:n], run.state[:, :n], beside, idle, run.surface)


def fold(run: Section, x: Any, y: Any) -> bool:
    """`is_folded` of the states of a section."""
    return is_folded(as_system(run.system), run.state, run.surface, x, y)


@np.errstate(all="ignore")
@explains_its_arguments
def is_folded(system: System, states: ArrayLike, surface: str | Expr, x: str | Expr, y: str | Expr) -> bool:
    r"""Whether two functions are not coordinates all over a section of dimension 2, judged by states on it.

    They are near a state where $\{s, H\}\{x, y\} + \{x, H\}\{y, s\} + \{x, s\}\{H, y\} \ne 0$: up to the factor
    $\{s, H\}$ this is their Dirac bracket on the section.  Where its sign differs, different states may lie at one
    point of a figure with x and y for its axes.  They do, too, where the section covers a part of the plane twice with
    one sign: of two states that are neighbours in the plane, one does not lead to the other along the section.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.section(system, {"y": 0.1, "p_x": 0.3}, surface="x", t_end=500)
        >>> upwards = found.state[found.sign > 0]
        >>> [lp.sections.is_folded(system, states, "x", "y", "p_y") for states in (found.state, upwards)]
        [True, False]

    Args:
        system: A system whose parameters are all numbers, on leaves of dimension 4.
        states: States of the section, shape (crossing, component), as those that `section` finds.
        surface: The function that is zero on the section.
        x: The function along one axis.
        y: The function along the other.

    Raises:
        ShapeError: states of another number of components.
        ExpressionError: a formula cannot be read.
    """
    bracket_of = as_system(system).bracket
    some = np.atleast_2d(as_phase_points(states, bracket_of.coordinate_names_in_order, bracket_of.field_names))
    plane = SectionPlane(system, some[:: max(1, len(some) // _SAMPLES)], surface)
    across, up = (plane.system.functions.of(function) for function in (x, y))
    signs = plane.signs(across, up)
    return bool((signs > 0).any() and (signs < 0).any()) or plane.meets_itself(across, up)


SAME = 1e-9
"""Difference of two values, relative to the terms of the function, up to which they are one: starts of one level that
were found by Newton's method or written with ten digits agree to it."""


@dataclass(frozen=True)
class Levels:
    """Distinct values of the Hamiltonian and the Casimirs.

    Attributes:
        names: H, C1, C2, ...
        values: Those of each level, shape (level, function).
    """

    names: tuple[str, ...]
    values: Array

    def __len__(self) -> int:
        """How many levels there are."""
        return len(self.values)

    @property
    def warning(self) -> str:
        """What a section says of its orbits; "" where they share a level."""
        if len(self) < 2:
            return ""
        return f"the orbits lie on {len(self)} levels of {', '.join(self.names)}: curves of different levels cross"


def levels_of(run: Section, trajectories: NDArray[np.int64] | None = None) -> Levels | None:
    """The levels of the orbits that have crossings; None where the system is not known by formulas.

    Args:
        run: The section.
        trajectories: Only those of these orbits.
    """
    shown = np.unique(run.trajectory)
    return levels_through(run.system, run.start[shown if trajectories is None else np.intersect1d(shown, trajectories)])


@np.errstate(all="ignore")
def levels_through(system: object, states: Array) -> Levels | None:
    """The levels on which states lie; None where the system is not known by formulas."""
    from liepoisson.model.system import System

    if not isinstance(system, System):
        return None
    functions = {"H": system.functions.energy, **system.functions.casimirs}
    if system.clock is not None:  # H + p_t has any value, by that of p_t, which acts on nothing
        del functions["H"]
    if not len(states):
        return Levels(tuple(functions), np.empty((0, len(functions))))
    if not functions:
        return Levels((), np.empty((1, 0)))
    values = np.stack([f(states) for f in functions.values()], axis=-1)
    groups = np.stack([_groups(f, states) for f in functions.values()], axis=-1)
    _, first = np.unique(groups, axis=0, return_index=True)
    return Levels(tuple(functions), values[np.sort(first)])


def _groups(function: PhaseFunction, states: Array) -> NDArray[np.int64]:
    r"""Which values are one: neighbours that differ by at most `SAME` of $|f| + \sum|x_i\,\partial_i f|$.

    The sum is the size of the terms of f: a Casimir l.alpha = 0 has values of round-off.
    """
    values = function(states)
    size = np.abs(values) + np.abs(states * function.gradient(states)).sum(axis=-1)
    order = np.argsort(values, kind="stable")
    apart = ~(np.diff(values[order]) <= SAME * np.maximum(size[order][1:], size[order][:-1]))
    groups = np.empty(len(values), np.int64)
    groups[order] = np.concatenate([[0], np.cumsum(apart)])
    return groups


_ROUND_OFF, _NOTHING = 1e-9, 1e-14
"""Width of the values of a coordinate, relative to its size along the orbits, and of a figure across its longest
extent, that is round-off; width relative to the largest of all coordinates that is, too."""


def default_axes(
    components: Sequence[str],
    states: Array,
    beside: Array | None = None,
    idle: Collection[str] = (),
    surface: str | None = None,
) -> tuple[str, str]:
    """The first component across and the second up, in their order.

    Of several vectors the last component is across and the second up, as alpha3 and l2, of coordinates and momenta a
    coordinate and its momentum.

    Where one of both is constant on the section, or all points are on one line, the two before are taken, and so on: on
    the section y = 0 of a system in (x, y, p_x, p_y) not y and p_y, but x and p_x.

    Args:
        components: Names of the components.
        states: States of the crossings, shape (crossing, component).
        beside: States of the same orbits elsewhere, shape (state, component): they tell how large a coordinate is that
            vanishes on the section.
        idle: Names of components that are taken only where no two others will do.
        surface: The function that is zero on the section, as a text: of fewer than two crossings a component counts as
            constant if it is the only name in it.
    """
    n = len(components)
    finite = states[np.isfinite(states).all(axis=-1)]
    acting = [k for k in range(n) if components[k] not in idle]
    if _has_vectors(components) and not _is_canonical(components):
        pairs = _pairs(acting, len(acting) - 1, 1) + _pairs(range(n), n - 1, min(1, n - 1))
    else:
        found = _pairs(range(n), n // 2 - 1, n - 1) if _is_canonical(components) else combinations(range(n), 2)
        pairs = sorted(found, key=lambda pair: not {*pair} <= {*acting})
    if len(finite) > 1:
        others = finite if beside is None else np.concatenate([finite, beside[np.isfinite(beside).all(axis=-1)]])
        sizes = np.abs(others).max(axis=0)
        unit = np.where(sizes > 0, sizes, 1.0)
        centred = (finite - finite.mean(axis=0)) / unit
        width = np.ptp(finite, axis=0)
        varies = (width > _ROUND_OFF * sizes) & (width > _NOTHING * sizes.max())
        for across, up in pairs:
            if across != up and varies[across] and varies[up] and _fills_a_plane(centred[:, (across, up)]):
                return components[across], components[up]
    else:
        held = set[str]() if surface is None else _names_in(surface)
        for across, up in pairs:
            if across != up and not any(held == {components[k]} for k in (across, up)):
                return components[across], components[up]
    across, up = pairs[0] if pairs else (0, 0)
    return components[across], components[up]


def _names_in(surface: str) -> set[str]:
    """The names in a formula; none in what is no formula, as the rows of a file's function."""
    from liepoisson.formula.grammar import names_in, parse

    try:
        return {*names_in(parse(surface))}
    except ExpressionError:
        return set()


def _pairs(places: Sequence[int], last: int, second: int) -> list[tuple[int, int]]:
    """The last and the second of some places, then in turn those before both, then all others."""
    n = len(places)
    pairs = [(places[(last - back) % n], places[(second - back) % n]) for back in range(n)]
    return pairs + [(across, up) for across in reversed(places) for up in places if up < across]


def _fills_a_plane(points: Array) -> bool:
    """Whether points are on no line, each coordinate in units of its width."""
    longest, shortest = linear.svd(points / np.ptp(points, axis=0), compute_uv=False)
    return len(points) < 3 or bool(shortest > _ROUND_OFF * longest)


def _has_vectors(components: Sequence[str]) -> bool:
    """Whether there are at least two vectors among the names, such as l1, l2, l3 and alpha1, alpha2, alpha3."""
    stems = Counter(name.rstrip("0123456789") for name in components)
    return sum(count > 1 for count in stems.values()) > 1


def _is_canonical(components: Sequence[str]) -> bool:
    """Whether the second half of the names are those that momenta of the first half have: p_x of x, and p1 of q1."""
    half = len(components) // 2
    pairs = zip(components[:half], components[half:], strict=False)
    return len(components) == 2 * half and all(
        p == f"p_{q}" or (q.startswith("q") and p == f"p{q[1:]}") for q, p in pairs
    )
