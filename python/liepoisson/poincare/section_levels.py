"""The levels of energy and Casimirs on which the orbits of a section lie: curves of different levels cross."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.poincare.section import Section

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


@np.errstate(all="ignore")
def levels_of(run: Section, trajectories: NDArray[np.int64] | None = None) -> Levels | None:
    """The levels of the orbits that have crossings; None where the system is not known by formulas.

    Args:
        run: The section.
        trajectories: Only those of these orbits.
    """
    from liepoisson.model.system import System

    if not isinstance(run.system, System):
        return None
    shown = np.unique(run.trajectory)
    states = run.start[shown if trajectories is None else np.intersect1d(shown, trajectories)]
    functions = {"H": run.system.functions.energy, **run.system.functions.casimirs}
    if not len(states):
        return Levels(tuple(functions), np.empty((0, len(functions))))
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
