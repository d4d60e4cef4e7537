"""Surfaces of section for the command `section`: their directions, and a default one."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.cli.starts import Start
    from liepoisson.exact.system import System


class Direction(StrEnum):
    """Which crossings count: the function increases, decreases, or either."""

    UP = "up"
    DOWN = "down"
    BOTH = "both"

    @property
    def sign(self) -> int:
        """The direction as `lp.section` takes it."""
        return {"up": 1, "down": -1, "both": 0}[self.value]


@dataclass(frozen=True)
class Surface:
    """A surface of section.

    Attributes:
        function: What is zero there, as text.
        reason: Why it was taken, in words.
    """

    function: str
    reason: str


@np.errstate(all="ignore")
def default_surface(system: System, start: Start) -> Surface:
    r"""A surface that recurrent orbits meet again and again: where the rate of a bounded function vanishes.

    For a top with two fields that function is $\ell\cdot\beta$.  Otherwise, or where its rate vanishes on the whole
    leaf, it is a coordinate: the last of each vector in turn, then the others.
    """
    from liepoisson.phase_space.surfaces import good_surface

    top = system.top_parameters
    if top is not None and any(float(a) for a in top.field().a) and start.leaf.is_regular and top.field().epsilon:
        return Surface(_written(system.expression(good_surface(system))), "the rate of -dot(l, beta)")
    names, size = system.component_names, system.vector_length
    order = sorted(range(len(names)), key=lambda k: (size - 1 - k % size, k))
    # A leaf of lower rank may make a rate zero that is not zero elsewhere: compare with the rates at moved states.
    nearby = start.leaf.project(start.state + 0.1 * np.random.default_rng(0).standard_normal((8, len(names))))
    rates = np.abs(system.vector_field(nearby)).max(axis=0)
    for k in order:
        if rates[k] > 1e-9 * max(1.0, rates.max()):
            return Surface(_written(list(system.equations.values())[k]), f"the rate of {names[k]}")
    raise ParameterError(f"{system.name} must move on this leaf; every state is an equilibrium. Try another --leaf.")


def _written(expression: Expr) -> str:
    """An expression as a formula that our grammar reads."""
    return str(expression).replace("**", "^")
