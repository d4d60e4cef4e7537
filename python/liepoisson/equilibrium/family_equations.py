r"""The equations of a family of equilibria, and the functions along it that vanish where something changes.

With the functions $F_k$ whose values are held, the Casimirs and the integrals of a relative equilibrium,

$$ \nabla H(x) - \sum_k\lambda_k\nabla F_k(x) = 0, \qquad F_k(x) = c_k . $$

The unknowns are the state, the parameter behind it if one varies, and the $\lambda_k$.  One equation $F_k = c_k$ is
left out if a value varies.  Where symmetries carry equilibria there are more equations than are independent: with the
state held across their motions, steps of least squares converge quadratically.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import VANISHES
from liepoisson.equilibrium.linearisation import LinearFlow, leaf_tangent
from liepoisson.equilibrium.stability import Equilibrium, equilibrium
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import flattened
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.refusals import check_choice
from liepoisson.leaf._checks import are_equal
from liepoisson.model.free_parameter import FreeParameter, StateAndParameters, values_of
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.numeric.curves import HOLDS, Curve
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.system import System

SAME = 1e-6
"""Singular values of the equations below this, relative, are zero at a located point, and so are gradients."""
_MOST_STEPS, _RANK = 20, 1e-11
"""Steps of Newton's method, and singular values, relative, that it does not divide by."""
_SOLVED = float(np.finfo(float).max)
"""Places hold to `HOLDS` of the terms where the family is; the terms at a state near zero may all be smaller."""
_IS_REAL, _EQUAL = 1e-9, 1e-24
"""The square of a difference of squares of eigenvalues is real, or zero by a symmetry, below these, relative."""


@dataclass(frozen=True, eq=False)
class Place:
    """A solution, or a guess, and what steps from it are measured with.

    Attributes:
        unknowns: The state, the parameter if one varies, and the multipliers.
        units: Theirs.
        size: That of the second derivatives, with which the equations are compared.
        lengths: Those of the gradients of the held functions.
        carried: Orthonormal directions in which symmetries carry the state, shape (k, N).
        residual: The largest residual.
    """

    unknowns: Array
    units: Array
    size: float
    lengths: Array
    carried: Array
    residual: float


@dataclass(frozen=True, eq=False)
class FamilyEquations(Curve[Place]):
    """The equations, with all functions of z: the state, and the parameter behind it if one varies.

    Attributes:
        start: z where the family begins.
        rank: The dimension of leaves.
        energy: H.
        held: The Casimirs and the integrals of a relative equilibrium, by name.
        free: The one whose value varies; None where a parameter does.
        kept: The names of the integrals.
        symmetries: Integrals whose motions carry equilibria: those, or all that are known of the system.
        tensor: J, shape (N, N).
        system_at: The system at a value of the parameter.
        units: Natural sizes of z.
    """

    start: Array
    rank: int
    energy: PhaseFunction
    held: dict[str, PhaseFunction]
    free: str | None
    kept: tuple[str, ...]
    symmetries: tuple[PhaseFunction, ...]
    tensor: Callable[[Array], Array]
    system_at: Callable[[float], System]
    units: Array

    @property
    def n(self) -> int:
        """Number of components of the state."""
        return len(self.start) - (self.free is None)

    def parts(self, unknowns: Array) -> tuple[Array, Array]:
        """Split into z and the multipliers."""
        return unknowns[: len(self.start)], unknowns[len(self.start) :]

    def value(self, point: Place) -> float:
        """What varies."""
        z = self.parts(point.unknowns)[0]
        return float(z[-1] if self.free is None else self.held[self.free](z))

    def slope(self, point: Place) -> Array:
        """Its derivative by the unknowns, in units."""
        z, multipliers = self.parts(point.unknowns)
        own = np.eye(len(z))[-1] if self.free is None else self.held[self.free].gradient(z)
        return np.append(own * self.units, np.zeros(len(multipliers)))

    def equilibrium(self, place: Place) -> Equilibrium:
        """The equilibrium with its stability."""
        n = self.n
        state = place.unknowns[:n] / self.units[:n]
        state = np.where(np.abs(state) < np.finfo(float).eps * np.abs(state).max(initial=0.0), 0.0, state)
        system, state = self.system_at(self.value(place)), state * self.units[:n]
        return equilibrium(system, state, along=self.kept, tol=_SOLVED)

    def first(self) -> Place:
        """The start, with multipliers of least squares."""
        rows = self._gradients(self.start, *self.held.values())[:, : self.n]
        lengths = linear.norm(rows, axis=1)
        slope = self._gradients(self.start, self.energy)[0, : self.n]
        found = linear.lstsq((rows / lengths[:, None]).T, slope)[0] / lengths if len(rows) else np.zeros(0)
        return self.place(np.append(self.start, found))

    def place(self, unknowns: Array, residual: float = np.inf) -> Place:
        """A place with its units."""
        z, _ = self.parts(unknowns)
        size = self._curvature(unknowns)[1] or 1.0
        lengths = linear.norm(self._gradients(z, *self.held.values())[:, : self.n], axis=1)
        lengths = np.where(lengths > 0, lengths, 1.0)
        return Place(unknowns, np.append(self.units, size / lengths), size, lengths, self._carried(z), residual)

    def is_singular(self, place: Place) -> bool:
        """Whether the gradients of the held functions are dependent, relative to their lengths at the start."""
        at = [self._gradients(z, *self.held.values())[:, : self.n] for z in (self.start, self.parts(place.unknowns)[0])]
        lengths = linear.norm(at[0], axis=1, keepdims=True)
        scaled = at[1] / np.where(lengths > 0, lengths, 1.0)
        return bool(linear.svd(scaled, compute_uv=False).min(initial=1.0) < SAME)

    def _gradients(self, z: Array, *functions: PhaseFunction) -> Array:
        """Gradients in units, shape (function, len(z))."""
        return np.array([f.gradient(z) for f in functions]).reshape(-1, len(z)) * self.units

    def _curvature(self, unknowns: Array) -> tuple[Array, float]:
        """The second derivatives of H less those of the held functions, in units, and the size of these terms."""
        z, multipliers = self.parts(unknowns)
        factors = zip((1.0, *-multipliers), (self.energy, *self.held.values()), strict=True)
        terms = [factor * f.hessian(z) * np.outer(self.units, self.units) for factor, f in factors]
        return np.add.reduce(terms), sum(float(linear.norm(one)) for one in terms)

    def _poisson(self, z: Array) -> Array:
        """J at z, in units."""
        return self.tensor(z) / np.outer(self.units[: self.n], self.units[: self.n])

    def _carried(self, z: Array) -> Array:
        """Orthonormal directions in which the motions of integrals carry equilibria, shape (k, N).

        Where values are kept, those of the combinations that keep the values of all.
        """
        slopes, poisson = self._gradients(z, *self.symmetries)[:, : self.n], self._poisson(z)
        lengths, least = linear.norm(slopes, axis=1, keepdims=True), VANISHES * float(linear.norm(poisson))
        slopes = slopes / np.where(lengths > 0, lengths, 1.0)
        rates = linear.matmul(slopes, -poisson)
        if self.kept:
            _, sizes, rows = linear.svd(linear.matmul(rates, slopes.T))
            rates = linear.matmul(rows[sizes <= least], rates)
        if not len(rates):
            return np.zeros((0, self.n))
        _, sizes, rows = linear.svd(rates, full_matrices=False)
        return rows[sizes > least]

    def linearised(self, unknowns: Array, near: Place) -> tuple[Array, Array]:
        """The derivatives of the equations by all unknowns, in the units of a place near, and their values."""
        n, k, (z, multipliers) = self.n, len(self.held), self.parts(unknowns)
        gradients = self._gradients(z, *self.held.values())
        slope = self._gradients(z, self.energy)[0] - linear.matmul(multipliers, gradients)
        normals, carried = gradients / near.lengths[:, None], near.carried
        rows = [
            np.concatenate([self._curvature(unknowns)[0][:n] / near.size, -normals[:, :n].T], axis=1),
            np.concatenate([normals, np.zeros((k, k))], axis=1),
            np.concatenate([carried, np.zeros((len(carried), len(unknowns) - n))], axis=1),
        ]
        off = np.array([float(f(z) - f(self.start)) for f in self.held.values()]) / near.lengths
        across = linear.matmul(carried, ((unknowns - near.unknowns) / near.units)[:n])
        is_held = np.ones(n + k + len(carried), dtype=bool)
        if self.free is not None:
            is_held[n + tuple(self.held).index(self.free)] = False
        return np.concatenate(rows)[is_held], np.concatenate([slope[:n] / near.size, off, across])[is_held]

    @np.errstate(all="ignore")  # functions need not be defined where a step leads; it is not taken then
    def solved(self, guess: Array, near: Place, aim: Array | float) -> Place:
        """What Newton's method makes of a guess: across a direction, or where the free value is a wanted one.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        best, least, unknowns = guess, np.inf, guess
        for _ in range(_MOST_STEPS):
            checkpoint("Newton's method for a family of equilibria")
            rows, values = self.linearised(unknowns, near)
            if isinstance(aim, np.ndarray):
                row, value = aim, float(linear.matmul(aim, (unknowns - guess) / near.units))
            else:
                here = replace(near, unknowns=unknowns)
                slope = self.slope(here)
                length = float(linear.norm(slope)) or 1.0
                row, value = slope / length, (self.value(here) - aim) / length
            rows, values = np.concatenate([rows, row[None]]), np.append(values, value)
            size = float(np.abs(values).max())
            if not (np.isfinite(rows).all() and np.isfinite(size)) or (size >= least and size < HOLDS):
                break
            if size < least:
                best, least = unknowns, size
            unknowns = unknowns - linear.matmul(linear.pinv(rows, rcond=_RANK), values) * near.units
        return self.place(best, least)

    def null_space(self, point: Place, n: int = 1, /, *, least: int = 1) -> Array:
        """Orthonormal directions in which the equations hold to first order, the curve's among them, shape (k, ...)."""
        del n
        _, sizes, rows = linear.svd(self.linearised(point.unknowns, point)[0])
        return rows[min(int((sizes > SAME * sizes[0]).sum()), len(rows) - least) :] * point.units

    def _flows(self, place: Place) -> tuple[LinearFlow, LinearFlow]:
        """The linearised flow modulo symmetries, and with the second variation on the level of what is held.

        They differ where symmetries carry equilibria, and the values of their integrals are not held.
        """
        n, poisson = self.n, self._poisson(self.parts(place.unknowns)[0])
        basis = leaf_tangent(poisson, self.rank)
        form = linear.inv(linear.matmul(linear.matmul(basis.T, poisson), basis))
        hessian = linear.matmul(linear.matmul(basis.T, self._curvature(place.unknowns)[0][:n, :n]), basis)
        flow = LinearFlow((hessian + hessian.T) / 2, (form - form.T) / 2)
        carried = linear.matmul(basis.T, place.carried.T)
        if not carried.size:
            return flow, flow
        moved = flow.restricted(flow.slice_basis(carried))
        return moved, moved if self.kept else flow.restricted(linear.complement(linear.qr(carried).Q))

    def squares(self, place: Place) -> NDArray[np.complex128]:
        r"""The squares of the eigenvalues of the linearised flow, one of each pair $\pm\mu$."""
        flow = self._flows(place)[0]
        found: Any = linear.eigvals(linear.solve(flow.form, flow.hessian)) if flow.size else np.zeros(0)
        values: NDArray[np.complex128] = found.astype(np.complex128)
        real = np.sort(values.real[values.imag == 0])
        chosen = np.append(values[values.imag > 0], real[(len(real) + 1) // 2 :])
        return linear.times(chosen, chosen)

    def tests(self, point: Place, tangent: Array) -> dict[str, Array]:
        """Functions that pass zero where something changes, each in its order; none at a singular level."""
        if self.is_singular(point):
            return {}
        return {
            "fold": np.array([linear.matmul(self.slope(point), tangent)]),
            "branch": linear.eigvalsh(self._flows(point)[1].hessian),
            "collision": np.sort(_gaps(self.squares(point))),
        }


def _gaps(squares: NDArray[np.complex128]) -> Array:
    """The squares of the differences of two where they are real, else their sizes, which are not zero."""
    size = float(np.abs(squares).max(initial=0.0)) ** 2
    found: Any = np.array([linear.times(a - b, a - b) for a, b in combinations(squares, 2)])
    gaps: NDArray[np.complex128] = found.astype(np.complex128)
    found = np.where(np.abs(gaps.imag) <= _IS_REAL * size, gaps.real, np.abs(gaps))
    return np.where(np.abs(found) <= _EQUAL * size, size, found)


def value_of(one: Equilibrium, along: str) -> float:
    """What varies along a family, at an equilibrium of it."""
    if along in one.casimirs or along in one.omega:
        return float(one.system.functions.of(along)(one.state))
    return FreeParameter(one.system, along).value


def free_parameter(system: System, own: System, name: str, *others: str) -> FreeParameter | None:
    """The parameter that varies, from its value in the system of a start; None where one of the others does.

    Args:
        system: The system that a caller names.
        own: That of the start.
        name: What varies.
        others: What else it might be.

    Raises:
        ParameterError: it is none of these, or several, or the systems differ in more than the value of the parameter.
    """
    given = flattened(values_of(own))
    choices = (*others, *(key for key, value in given.items() if not getattr(value, "free_symbols", ())))
    if not choices:
        raise ParameterError(
            f"along: wanted what varies; {own.name} has no Casimir and no parameter, and the start no integral. Write "
            'System(bracket, hamiltonian, {"m": 1}), with m in the Hamiltonian'
        )
    check_choice(name, "along", choices, "a function whose value varies, or a parameter of the system")
    if name in given and name in {"H", *others}:
        raise ParameterError(
            f"along: wanted the name of one thing; {name} is a parameter of {own.name!r} and a function. Rename the "
            "parameter"
        )
    if name in others:
        return None
    variable = FreeParameter(own, name)
    is_there = name in flattened(values_of(system))
    if not are_equal(variable.symbolic, FreeParameter(system, name).symbolic if is_there else system):
        raise ParameterError(f"start: wanted one of {system.name!r}; got one of another system")
    return variable


def family_equations(system: System, start: Equilibrium, along: str) -> FamilyEquations:
    """The equations of the family of an equilibrium.

    Raises:
        ParameterError: it is no equilibrium of the system, or lies on a singular leaf; or nothing of it has this name.
    """
    own, kept = start.system, tuple(start.omega)
    casimirs = own.functions.casimirs
    variable = free_parameter(system, own, along, *casimirs, *kept)
    if variable is None and not are_equal(own, system):
        raise ParameterError(f"start: wanted one of {system.name!r}; got one of another system")
    if not start.leaf.is_regular or not start.leaf.rank:
        raise ParameterError(f"start: wanted an equilibrium on a regular leaf; got one on {start.leaf!r}")
    rank, units = start.leaf.rank, start.leaf.in_units().units
    names = kept or tuple(name for name in own.invariants if name != "H" and name not in casimirs)
    if variable is None:
        of, energy, tensor = own.functions.of, own.functions.energy, own.functions.poisson_tensor
        found = tuple(of(name if kept else own.invariants[name]) for name in names)
        held = casimirs | dict(zip(kept, found, strict=False))
        return FamilyEquations(start.state, rank, energy, held, along, kept, found, tensor, lambda _: own, units)
    space, known = StateAndParameters(variable.symbolic, variable.name), variable.symbolic.invariants
    found = tuple(space.function(name if kept else known[name]) for name in names if kept or name in known)
    held = space.functions()
    energy = held.pop("H")
    held |= dict(zip(kept, found, strict=False))
    z, scale = np.append(start.state, variable.value), np.append(units, abs(variable.value) or 1.0)
    return FamilyEquations(z, rank, energy, held, None, kept, found, space.poisson_tensor, variable.at, scale)
