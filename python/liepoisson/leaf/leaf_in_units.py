"""A leaf in coordinates of order one: the states divided by a unit for each field, and all functions of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import LeafError
from liepoisson.inputs.arrays import Array
from liepoisson.leaf.field_units import unit_groups, unit_length
from liepoisson.leaf.leaf_projection import Equations
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.portable import linear

if TYPE_CHECKING:
    from flint import arb
    from sympy import Expr, Symbol

    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket


class FunctionInUnits(PhaseFunction):
    r"""The function $y\mapsto f(uy)$ with $uy = (u_1y_1,\ldots,u_Ny_N)$.

    Args:
        function: f.
        units: u, shape (N,).
    """

    def __init__(self, function: PhaseFunction, units: Array) -> None:
        self._function, self._units = function, units

    @property
    def is_polynomial(self) -> bool:
        """Whether f is a polynomial."""
        return self._function.is_polynomial

    @property
    def n_coordinates(self) -> int:
        """Number of components of a state."""
        return self._function.n_coordinates

    @property
    def variables(self) -> tuple[Symbol, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Those of f itself."""
        return self._function.variables

    @property
    def expression(self) -> Expr:  # pyright: ignore[reportIncompatibleVariableOverride]
        """That of f itself."""
        return self._function.expression

    @property
    def polynomial(self) -> RationalPolynomial | None:
        """That of f itself."""
        return self._function.polynomial

    def __call__(self, states: ArrayLike) -> Array:
        """Values, shape (...), at y of shape (..., N)."""
        return self._function(np.asarray(states) * self._units)

    def gradient(self, states: ArrayLike) -> Array:
        """Derivatives with respect to y, shape (..., N)."""
        return self._function.gradient(np.asarray(states) * self._units) * self._units

    def gradient_in_balls(self, state: Sequence[arb]) -> list[arb]:
        """Balls that contain the derivatives with respect to y."""
        units = [*map(float, self._units)]
        slopes = self._function.gradient_in_balls([u * y for u, y in zip(units, state, strict=True)])
        return [u * slope for u, slope in zip(units, slopes, strict=True)]

    def value_in_balls(self, state: Sequence[arb]) -> arb:
        """A ball that contains the value."""
        return self._function.value_in_balls([float(u) * y for u, y in zip(self._units, state, strict=True)])

    def hessian(self, states: ArrayLike) -> Array:
        """Second derivatives with respect to y, shape (..., N, N)."""
        return self._function.hessian(np.asarray(states) * self._units) * np.outer(self._units, self._units)


@dataclass(frozen=True)
class FunctionsInUnits:
    """The functions on phase space of a system, as functions of y."""

    system: System
    units: Array

    @cached_property
    def energy(self) -> PhaseFunction:
        """The Hamiltonian."""
        return self.of(self.system.functions.energy)

    def of(self, function: str | Expr | PhaseFunction) -> PhaseFunction:
        """Any function on phase space."""
        return in_units(self.system.functions.of(function), self.units)

    def poisson_tensor(self, states: Array) -> Array:
        r"""The brackets $\{y_i, y_j\}$, shape (..., N, N)."""
        return self.system.functions.poisson_tensor(states * self.units) / np.outer(self.units, self.units)


@dataclass(frozen=True)
class SystemInUnits:
    """What the numerical searches ask of a system, with its functions of y.

    Attributes:
        bracket: That of the system itself.
        functions: The functions of y.
    """

    bracket: Bracket
    functions: FunctionsInUnits


@dataclass(frozen=True)
class LeafInUnits:
    """A leaf with its states divided by units.

    Attributes:
        itself: What the leaf is called in messages.
        source: The system.
        rank: The dimension of the leaf.
        own_state: The state of the leaf, not divided.
        equations_for: The equations of the leaf, of an energy surface on it and of a surface f = 0, not divided.
        units: A positive number for each coordinate, shape (N,); those of one field are equal.
    """

    itself: str
    source: System
    rank: int
    own_state: Array
    equations_for: Callable[[float | None, str | Expr | PhaseFunction | None], Equations]
    units: Array

    @cached_property
    def system(self) -> SystemInUnits:
        """The system in these units."""
        return SystemInUnits(self.source.bracket, FunctionsInUnits(self.source, self.units))

    @cached_property
    def state(self) -> Array:
        """The leaf's own state."""
        return self.own_state / self.units

    @cached_property
    def equations(self) -> Equations:
        """The equations of the leaf."""
        return self.constraints(None)

    def constraints(self, energy: float | None, surface: str | Expr | PhaseFunction | None = None) -> Equations:
        """The equations of the leaf, and those of the energy surface and of a surface f = 0."""
        return equations_in_units(self.equations_for(energy, surface), self.units, self.source.bracket)

    def tangent_basis(self, y: Array) -> Array:
        """Orthonormal bases of the tangent spaces of the leaf, as columns, shape (..., N, rank)."""
        tensor = self.system.functions.poisson_tensor(y)
        if not np.isfinite(tensor).all():
            raise LeafError(
                "the states of this leaf have components beyond the range of numbers, or of very different sizes; "
                "give the Casimirs in other units."
            )
        vectors, sizes, _ = linear.svd(tensor)
        if self.rank and not np.all(sizes[..., self.rank - 1] > 0):
            raise LeafError(f"J must have rank {self.rank} on this leaf; it is lower at one of the states.")
        return vectors[..., : self.rank]

    def __repr__(self) -> str:
        return self.itself


def in_units(function: PhaseFunction, units: Array) -> PhaseFunction:
    """A function of y; the function itself where all units are 1."""
    return function if (units == 1.0).all() else FunctionInUnits(function, units)


def equations_in_units(equations: Equations, units: Array, bracket: Bracket) -> Equations:
    """The same equations for y; they themselves where all units are 1, so that the fields are of one order."""
    if (units == 1.0).all():
        return equations
    rows = linear.qr((equations.pinned * units).T)[0].T
    functions = tuple(in_units(function, units) for function in equations.functions)
    groups, unit = unit_groups(bracket), unit_length(bracket)
    return replace(equations, pinned=rows, functions=functions, groups=groups, unit=unit)
