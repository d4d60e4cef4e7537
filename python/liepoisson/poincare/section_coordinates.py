"""Whether two functions are coordinates on a section of dimension 2, or fold it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ExpressionError, ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf_stratum import numeric_rank
from liepoisson.model.phase_functions import as_phase_points
from liepoisson.poincare.section_axes import default_axes
from liepoisson.poincare.section_sheets import SectionAxes, SectionPlane, idle_components, section_axes

if TYPE_CHECKING:
    from sympy import Expr

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
    return default_axes(run.components, run.state, np.concatenate([run.start, run.end_state]), idle)


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
