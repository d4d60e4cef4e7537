r"""Tops with rational parameters, recognised by their equations: what the algebra of equilibria starts from.

A heavy top in six components, $\ell$ and $\alpha$ with the bracket so(3) @ semidirect(2), is a top of which only the
leaves with $\beta = 0$ are there, and a free rigid body on so(3) is one with $\alpha = \beta = 0$.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from flint import fmpq

from liepoisson.algebra.ideals.certified_roots import rational
from liepoisson.equilibrium.heavy_equilibria import Vector
from liepoisson.model.top_parameters import recognised_top

if TYPE_CHECKING:
    from liepoisson.model.system import System


@dataclass(frozen=True)
class ExactTop:
    """The parameters of a top as rational numbers; in a system that was typed by hand, moments may be negative.

    A system of six components has b = 0 and epsilon = 0, one of three a = 0, too.
    """

    inertia: Vector
    a: Vector
    b: Vector
    epsilon: fmpq

    @property
    def is_definite(self) -> bool:
        """Whether the kinetic energy is, which means that all moments have the same sign."""
        return len({moment > 0 for moment in self.inertia}) == 1


def exact_top(system: System) -> ExactTop | None:
    """The top with the bracket and the equations of this system, or None: not a top, or a parameter is irrational."""
    found = system.top_parameters if system.bracket.dimension == 9 else recognised_top(system)
    if found is None or not found.has_bracket(system.bracket):
        return None
    numbers = (*found.inertia, *found.a, *found.b, found.epsilon)
    if not all(isinstance(value, Fraction) for value in numbers):
        return None
    exact = [rational(cast("Fraction", value)) for value in numbers]
    return ExactTop(exact[:3], exact[3:6], exact[6:9], exact[9])
