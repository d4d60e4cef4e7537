r"""Melnikov's integrals along orbits that are homoclinic to an equilibrium of an integrable system.

Let K be constant along the orbits of H, and $x(t)$ homoclinic to an equilibrium $x_*$ at which K's own flow rests.  Of
$H + \delta H_1$ the orbits of the unstable and the stable manifold that pass near $x(0)$ have values of K that differ
by $\delta M_K + O(\delta^2)$,

$$ M_K = \int_{-\infty}^{\infty} \{K, H_1\}(x(t))\,dt . $$

The integrand is analytic and falls off exponentially, so the trapezoidal rule converges exponentially in the step.  The
orbit is computed both ways from the given state, on the stable and on the unstable manifold, until it is so near to
$x_*$ that the linearised flow does the rest, $-\nabla\{K, H_1\}\cdot A^{-1}\xi$ with the stable part $\xi$ of the
distance.

References: [melnikov1963]; [holmes1983], for tops; [palmer1984].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import Array, check_memory
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import shown
from liepoisson.io.tables import vector_columns
from liepoisson.leaf._checks import are_equal, as_system
from liepoisson.model.system_text import formula_text
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_states, given_starts
from liepoisson.numeric.systems import HasField, component_names
from liepoisson.orbits.closing import exponential
from liepoisson.orbits.saved_orbits import SavedOrbits
from liepoisson.orbits.stable_manifolds import NEAR, UNDER_WAY, AsymptoticOrbits, StableManifold
from liepoisson.orbits.variations import Variations, Work, common_variation
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

_PER_UNIT = 16
"""Times in 1/rho, the shortest time scale of the linearised flow: the rule's error is below round-off from 8 on."""
_RESTS = 1e-9
"""Relative size below which a vector field at the equilibrium is zero."""
_BYTES = 2**26
"""About the memory for orbits that are computed together."""


@dataclass(frozen=True, eq=False)
class Melnikov(SavedOrbits):
    r"""Melnikov's integrals of some homoclinic orbits.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
        >>> upright = lp.phase_space.equilibrium(top, [0, 0, 0, 0, 0, 1])
        >>> middle = [2, 0, 0, 0, 0, -1]
        >>> found = lp.orbits.melnikov(top, middle, "l1*l2", origin=upright, integrals=["l3"])
        >>> found.integrals, round(float(found.value[0, 0]), 9), bool(found.error[0, 0] < 1e-10)
        (('l3',), 8.0, True)

    Attributes:
        origin: The equilibrium.
        perturbation: $H_1$, as a formula.
        integrals: The names of K; "adjoint" where none was given.
        start: The middles of the orbits, shape (orbit, component).
        value: $M_K$, shape (orbit, integral).
        error: How far the values are from those with twice the step and with orbits cut ten times earlier, and what
            the values change, in first order, with round-off along the orbits and with the distance of the start from
            the manifolds; shape (orbit, integral).
    """

    kind = "melnikov integrals"
    made_by = "lp.orbits.melnikov"

    origin: Equilibrium
    perturbation: str
    integrals: tuple[str, ...]
    start: Array
    value: Array
    error: Array

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system with H."""
        return self.origin.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its number, the values, their errors, and its start."""
        rows = {"orbit": np.arange(len(self.value))}
        for k, name in enumerate(self.integrals):
            rows |= {f"M_{name}": self.value[:, k], f"error_{name}": self.error[:, k]}
        return rows | vector_columns("start", self.start, self.system.component_names)

    def __repr__(self) -> str:
        largest = ", ".join(
            f"|M_{k}| <= {v:.6g}"
            for k, v in zip(self.integrals, np.abs(self.value).max(axis=0, initial=0.0), strict=True)
        )
        return f"<Melnikov: {len(self.value)} orbits, {largest}, errors up to {self.error.max(initial=0.0):.1e}>"


@shows_progress
def melnikov(
    system: System,
    starts: StartsLike,
    perturbation: str | PhaseFunction,
    *,
    origin: Equilibrium,
    integrals: Sequence[str | PhaseFunction] | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Melnikov:
    r"""$M_K = \int\{K, H_1\}\,dt$ along orbits homoclinic to an equilibrium: where manifolds of $H + \delta H_1$ split.

    Simple zeros, along a family of homoclinic orbits, are transversal homoclinic orbits of the perturbed system if the
    equilibrium is hyperbolic on its leaf and there are as many integrals as the manifolds have dimensions less one.
    With elliptic directions they prove nothing by themselves: the equilibrium's homoclinic orbits break in general, and
    those of the periodic orbits around it are what to look at.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
        >>> upright = lp.phase_space.equilibrium(top, [0, 0, 0, 0, 0, 1])
        >>> found = lp.orbits.melnikov(
        ...     top, [2**0.5, 2**0.5, 0, 0, 0, -1], "(l1^2 - l2^2)/2", origin=upright, integrals=["l3"]
        ... )
        >>> round(float(found.value[0, 0]), 9)  # -8 sin(2 psi) at psi = pi/4
        -8.0

    Args:
        system: The system with H, which has the integrals.
        starts: States on homoclinic orbits, near their middles, shape (component,) or (orbit, component).  How far
            they are off, at most 1.5e-8 of the orbit's size, is part of the error.
        perturbation: $H_1$.
        origin: The equilibrium from which the orbits come, and to which they go.
        integrals: K, one or several.  None where there is none that is known, for manifolds of dimension two that are
            tangent along the orbits, as they are where one exists: $\nabla K$ is then replaced by the bounded solution
            $\psi$ of the adjoint equation [palmer1984] for which $J\psi$ is, at the start, a unit vector orthogonal to
            the flow.  The flow and $J\psi$ have the same orientation on the stable manifold for all orbits.

    Returns:
        The values, with errors.

    Raises:
        OrbitError: an orbit does not come from the equilibrium, or does not go back to it, or a start is at rest, or,
            without integrals, the manifolds are not tangent along an orbit, which then persists.
        ParameterError: an integral is not constant along orbits or does not rest at the equilibrium, the equilibrium
            is not hyperbolic, or $\{K, H_1\}$ is not smooth there or is no number along an orbit.
        MemoryLimitError: one orbit does not fit into memory, as near equilibria whose rates are almost zero.
        TimeLimitError: the time limit has passed.
    """
    run = RunOptions.read(Taylor(tol=1e-15), threads, time_limit, progress)
    system = as_system(system)
    states = as_states(given_starts(system, starts), len(system.component_names), names=system.component_names)
    functions = {} if integrals is None else _integrals(system, integrals)
    change = system.functions.of(perturbation)
    _require_rest(system, functions, origin)
    limit, matrix = origin.state, system.functions.jacobian(origin.state)
    with run.deadline.running(), np.errstate(all="ignore"):
        manifolds = [StableManifold.of(system, limit, matrix, way) for way in (1, -1)]
        if integrals is None:
            limit, matrix = np.concatenate([limit, 0 * limit]), np.kron(np.eye(2), matrix).astype(np.float64)
            lifted = [StableManifold.of(Variations(system), limit, matrix, way) for way in (1, -1)]
            halves = [_Half.of(one, {"adjoint": Work(change)}) for one in lifted]
        else:
            brackets = {
                name: system.functions.of(system.bracket(one.expression, change.expression))
                for name, one in functions.items()
            }
            halves = [_Half.of(one, brackets) for one in manifolds]
        names = tuple(halves[0].brackets)
        value, error = np.zeros((2, len(states), len(names)))
        together = min(one.together for one in halves)
        for first in range(0, len(states), together):
            some = slice(first, first + together)
            begin = states[some]
            if integrals is None:
                begin = np.concatenate([begin, common_variation(system, manifolds, begin, first, run)], axis=1)
            value[some], error[some] = _sums(halves, begin, first, run)
            run.tell(min(first + together, len(states)) / len(states))
    return Melnikov(origin, formula_text(change.expression), names, states, value, error)


def _sums(halves: Sequence[_Half], states: Array, first: int, run: RunOptions) -> tuple[Array, Array]:
    """The integrals along some orbits, of which the first has this number, and their errors, shape (orbit, K)."""
    fine, coarse, error = (sum(parts) for parts in zip(*(one.sums(states, first, run) for one in halves), strict=True))
    middle = halves[0].integrands(states[:, None], np.zeros(1), first)[:, 0] * halves[0].step
    value = fine + middle
    return value, np.maximum(error, np.abs(coarse + 2 * middle - value))


def _integrals(system: System, given: Any) -> dict[str, PhaseFunction]:
    """The integrals by name.

    Raises:
        ParameterError: one of them is not constant along orbits.
    """
    chosen = sequence(given, "integrals", "integrals", '["l3"]')
    functions = {one if isinstance(one, str) else str(one.expression): system.functions.of(one) for one in chosen}
    for name, function in functions.items():
        if not system.is_constant(function.expression):
            raise ParameterError(f"integrals: wanted constants of motion; {name} is none of {system.name!r}")
    if not functions:
        raise ParameterError('integrals: wanted at least one; got none; write integrals=["l3"]')
    return functions


def _require_rest(system: System, functions: Mapping[str, PhaseFunction], limit: object) -> None:
    """The flows of the integrals rest at the equilibrium: else the integrand does not vanish there.

    Raises:
        ParameterError: one does not, or the limit is no equilibrium of the system.
    """
    if not isinstance(limit, Equilibrium) or limit.omega or not are_equal(limit.system, system):
        raise ParameterError(f"origin: wanted an equilibrium of {shown(system)}; got {shown(limit)}")
    fields = HamiltonianFields(system, [system.functions.energy, *functions.values()]).fields(limit.state)
    scale = np.abs(system.functions.jacobian(limit.state)).max() or 1.0
    for k, name in enumerate(functions, start=1):
        if np.abs(fields[:, k]).max() > _RESTS * scale * (np.abs(limit.state).max() or 1.0):
            raise ParameterError(f"integrals: wanted some whose flows rest at the equilibrium; that of {name} does not")


@dataclass(frozen=True)
class _Half:
    r"""The trapezoidal rule over the times after 0, or before, without the middle.

    Attributes:
        manifold: Of the orbits that go to the equilibrium then.
        brackets: The integrands by the names of K: $\{K, H_1\}$, or the work.
        slopes: Their gradients at the equilibrium, shape (K, N).
    """

    manifold: StableManifold
    brackets: Mapping[str, PhaseFunction] | Mapping[str, Work]
    slopes: Array

    @classmethod
    def of(cls, manifold: StableManifold, brackets: Mapping[str, PhaseFunction] | Mapping[str, Work]) -> _Half:
        """One half of all orbits to an equilibrium.

        Raises:
            ParameterError: an integrand has no derivative at the equilibrium.
            MemoryLimitError: an orbit has too many segments.
        """
        check_memory(manifold.n_segments * cls._bytes(len(manifold.limit)), "origin")
        slopes = np.stack([f.gradient(manifold.limit) for f in brackets.values()])
        for name, slope in zip(brackets, slopes, strict=True):
            if not np.isfinite(slope).all():
                raise ParameterError(
                    f"perturbation: wanted a function that is smooth at the equilibrium; the integrand of M for {name} "
                    f"has no derivative there, at {_named(manifold.system, manifold.limit)}"
                )
        return cls(manifold, brackets, slopes)

    @staticmethod
    def _bytes(n: int) -> int:
        """Of one segment: its states and products of them, and the derivatives at its end, with copies."""
        return 8 * (2 * n * (_PER_UNIT + 1) + 5 * n * n)

    @property
    def step(self) -> float:
        """Between the times of the rule."""
        return self.manifold.segment / _PER_UNIT

    @property
    def together(self) -> int:
        """How many orbits are computed at once."""
        return max(1, _BYTES // (self.manifold.n_segments * self._bytes(len(self.manifold.limit))))

    def sums(self, starts: Array, first: int, run: RunOptions) -> tuple[Array, Array, Array]:
        """The sums over the times of this half, those with twice the step, and errors; shape (orbit, K) each.

        Raises:
            OrbitError: an orbit does not go to the equilibrium.
            ParameterError: an integrand is no finite number somewhere.
            TimeLimitError: the deadline has passed.
        """
        manifold, n, N = self.manifold, *starts.shape
        orbits = manifold.orbits(starts, first, run)
        last = _PER_UNIT * manifold.n_segments
        path, _ = manifold.flow(orbits.node[:, :-1].reshape(-1, N), np.arange(_PER_UNIT + 1) / _PER_UNIT, run)
        times = manifold.way * self.step * np.arange(1.0, last + 1)
        values = self.integrands(path[:, 1:].reshape(n, last, N), times, first)
        fine, coarse = (
            stride * self.step * (values[:, stride - 1 :: stride].sum(axis=1) + self._rest(orbits.node[:, -1], stride))
            for stride in (1, 2)
        )
        distance = linear.norm(orbits.node - manifold.limit, axis=2)
        early = (distance < 10 * NEAR * distance.max(axis=1, keepdims=True)).argmax(axis=1)
        counted = np.arange(last) < _PER_UNIT * early[:, None]
        cut = np.where(counted[..., None], values, 0.0).sum(axis=1)
        cut = self.step * (cut + self._rest(orbits.node[np.arange(n), early], 1))
        return fine, coarse, np.abs(fine - cut) + self._moved(orbits)

    def integrands(self, states: Array, times: Array, first: int) -> Array:
        """The integrands at states, shape (orbit, time, K).

        Raises:
            ParameterError: one is no finite number.
        """
        values = np.stack([f(states) for f in self.brackets.values()], axis=2)
        if not np.isfinite(values).all():
            k, i, j = (int(place[0]) for place in np.nonzero(~np.isfinite(values)))
            raise ParameterError(
                f"perturbation: wanted a function that is smooth along the orbits; the integrand of M for "
                f"{list(self.brackets)[j]} is no finite number at {_named(self.manifold.system, states[k, i])}, on "
                f"orbit {first + k} at t = {times[i]:.4g}"
            )
        return values

    def _rest(self, ends: Array, stride: int) -> Array:
        r"""$\sum_{k\ge1}f(x_k)$ beyond states near the equilibrium, by the linearised flow, shape (orbit, K).

        With $E = e^{Bh}$ for its matrix B it is $\nabla f\cdot E(1 - E)^{-1}\xi$.
        """
        manifold = self.manifold
        matrix = exponential(stride * self.step * manifold.rates)
        total = linear.matmul(matrix, linear.inv(np.eye(len(matrix)) - matrix))
        along = linear.matmul(linear.matmul(linear.matmul(self.slopes, manifold.stable), total), manifold.inward)
        return linear.matmul(ends - manifold.limit, along.T)

    def _moved(self, orbits: AsymptoticOrbits) -> Array:
        r"""What round-off of all segments and the distance of the start from the manifold do, first order, (orbit, K).

        A gap after node i moves the nodes after it within the manifold, and those before it across: the derivatives of
        the sum by the first are carried back from the end, those by the second from the start, $w_{i+1} = q_{i+1} +
        R_i^{-1}w_i$ with the derivatives q by moves across (see `StableManifold`).
        """
        manifold, m = self.manifold, self.manifold.n_segments
        past = linear.solve(manifold.rates.T, linear.matmul(self.slopes, manifold.stable).T)
        slope = np.broadcast_to(-linear.matmul(past.T, manifold.inward), (len(orbits.node), *self.slopes.shape))
        gradients = np.stack([f.gradient(orbits.node) for f in self.brackets.values()], axis=2)
        along, across = [slope], list[Array]()
        for i in range(m - 1, -1, -1):
            checkpoint(UNDER_WAY)
            normal = orbits.conormal[:, i]
            slope = linear.matmul(along[-1], orbits.slope[:, i]) + manifold.segment * gradients[:, i]
            across.append(linear.matmul(slope, normal))
            along.append(slope - linear.matmul(across[-1], np.swapaxes(normal, 1, 2)))
        eps, size = float(np.finfo(float).eps), linear.norm(orbits.node, axis=2)
        total = linear.norm(along[m], axis=2) * (eps * size[:, 0] + orbits.off)[:, None]
        total += linear.norm(along[0], axis=2) * orbits.aside[:, None]
        weight = np.zeros(across[0].shape)
        for i in range(m):
            checkpoint(UNDER_WAY)
            weight = np.swapaxes(weight + across[m - 1 - i], 1, 2)
            weight = np.swapaxes(linear.solve(orbits.triangle[:, i], weight), 1, 2)
            gap = eps * np.maximum(size[:, i], size[:, i + 1])[:, None]
            total += gap * (linear.norm(along[m - 1 - i], axis=2) + linear.norm(weight, axis=2))
        return total


def _named(system: HasField, state: Array) -> str:
    """A state in words."""
    names = component_names(system, len(state))
    return ", ".join(f"{name} = {x:.4g}" for name, x in zip(names, state.tolist(), strict=True))
