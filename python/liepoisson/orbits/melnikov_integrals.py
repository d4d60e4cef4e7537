r"""Melnikov's integrals along orbits that are homoclinic to an equilibrium of an integrable system.

Let K be constant along the orbits of H, and $x(t)$ homoclinic to an equilibrium $x_*$ at which K's own flow rests.  Of
$H + \delta H_1$ the orbits of the unstable and the stable manifold that pass near $x(0)$ have values of K that differ
by $\delta M_K + O(\delta^2)$,

$$ M_K = \int_{-\infty}^{\infty} \{K, H_1\}(x(t))\,dt . $$

The integrand is analytic and falls off exponentially, so the trapezoidal rule converges exponentially in the step.  The
orbit is followed from its middle both ways, until it is so near to $x_*$ that round-off would take it away; what is
left is that of the linearised flow, $-\nabla\{K, H_1\}\cdot A^{-1}\xi$ with the stable part $\xi$ of the distance.

References: [melnikov1963]; [holmes1983], for tops.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import shown
from liepoisson.io.tables import Tabular
from liepoisson.leaf._checks import are_equal, as_system
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.methods import Taylor
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.orbits.closing import exponential
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

_PER_UNIT = 16
"""Times in 1/rho, the shortest time scale of the linearised flow: the rule's error is below round-off from 8 on."""
_NEAR = 1e-7
"""How near to the equilibrium the orbit is cut, relative to its distance in the middle: what is left is linear up to
the square of this, and round-off, which has grown to 1e-9 by then, is taken away by the same linear equations."""
_SAFETY = 4.0
"""An orbit is followed for so much longer than ln(1/_NEAR), in units of the slowest rate."""
_HYPERBOLIC, _RESTS = 1e-6, 1e-9
"""Relative sizes below which a real part, or a vector field at the equilibrium, is zero."""


@dataclass(frozen=True, eq=False)
class Melnikov(ReadOnlyArrays, Tabular):
    r"""Melnikov's integrals of some homoclinic orbits.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3")
        >>> upright = lp.phase_space.equilibrium(top, [0, 0, 0, 0, 0, 1])
        >>> middle = [2, 0, 0, 0, 0, -1]
        >>> found = lp.orbits.melnikov(top, middle, "l1*l2", origin=upright, integrals=["l3"])
        >>> found.integrals, round(float(found.value[0, 0]), 9), bool(found.error[0, 0] < 1e-10)
        (('l3',), 8.0, True)

    Attributes:
        integrals: The names of K.
        start: The middles of the orbits, shape (orbit, component).
        value: $M_K$, shape (orbit, integral).
        error: How far the values are from those with twice the step and with orbits cut ten times earlier, shape
            (orbit, integral).
    """

    integrals: tuple[str, ...]
    start: Array
    value: Array
    error: Array

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its number, the values and their errors."""
        rows = {"orbit": np.arange(len(self.value))}
        for k, name in enumerate(self.integrals):
            rows |= {f"M_{name}": self.value[:, k], f"error_{name}": self.error[:, k]}
        return rows

    def __repr__(self) -> str:
        largest = ", ".join(
            f"|M_{k}| <= {v:.6g}" for k, v in zip(self.integrals, np.abs(self.value).max(axis=0), strict=True)
        )
        return f"<Melnikov: {len(self.value)} orbits, {largest}, errors up to {self.error.max(initial=0.0):.1e}>"


@shows_progress
def melnikov(
    system: System,
    starts: StartsLike,
    perturbation: str | PhaseFunction,
    *,
    origin: Equilibrium,
    integrals: Sequence[str | PhaseFunction],
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
        starts: The middles of homoclinic orbits, shape (component,) or (orbit, component).
        perturbation: $H_1$.
        origin: The equilibrium from which the orbits come, and to which they go.
        integrals: K, one or several.

    Returns:
        The values, with errors.

    Raises:
        OrbitError: an orbit does not come from the equilibrium, or does not go back to it.
        ParameterError: an integral is not constant along orbits or does not rest at the equilibrium, or the equilibrium
            is not hyperbolic.
        TimeLimitError: the time limit has passed.
    """
    run = RunOptions.read(Taylor(tol=1e-15), threads, time_limit, progress)
    system = as_system(system)
    states = np.atleast_2d(given_starts(system, starts))
    functions = _integrals(system, integrals)
    change = system.functions.of(perturbation)
    brackets = [system.functions.of(system.bracket(one.expression, change.expression)) for one in functions.values()]
    _require_rest(system, functions, origin)
    with run.deadline.running():
        rule = _Rule.of(system, origin, brackets)
        both = [rule.half(states, way, run) for way in (1, -1)]
    at_middle = np.stack([f(states) for f in brackets], axis=1) * rule.step
    value = both[0].value + both[1].value + at_middle
    error = sum((one.error for one in both), np.finfo(float).eps * np.abs(value))
    coarse = both[0].coarse + both[1].coarse + 2 * at_middle
    return Melnikov(tuple(functions), states, value, np.maximum(error, np.abs(coarse - value)))


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
    fields = HamiltonianFields(system, list(functions.values())).fields(limit.state)
    scale = np.abs(system.functions.jacobian(limit.state)).max() or 1.0
    for k, name in enumerate(functions):
        if np.abs(fields[:, k]).max() > _RESTS * scale * (np.abs(limit.state).max() or 1.0):
            raise ParameterError(f"integrals: wanted some whose flows rest at the equilibrium; that of {name} does not")


@dataclass(frozen=True)
class _Half:
    """One half of the integrals, without the middle: values, those with twice the step, errors; shape (orbit, K)."""

    value: Array
    coarse: Array
    error: Array


@dataclass(frozen=True)
class _Rule:
    """The trapezoidal rule on the whole line, with the part near the equilibrium from the linearised flow.

    Attributes:
        system: The system.
        limit: The equilibrium.
        brackets: The integrands.
        step: Between the times.
        slowest: The smallest real part of the eigenvalues that have one.
        growth: The linearised flow on the space of these eigenvalues, shape (k, k).
        inward: Takes a distance from the equilibrium to its coordinates in this space, shape (k, N).
        outward: The derivatives of the integrands along these coordinates, shape (K, k).
    """

    system: System
    limit: Array
    brackets: Sequence[PhaseFunction]
    step: float
    slowest: float
    growth: Array
    inward: Array
    outward: Array

    @classmethod
    def of(cls, system: System, limit: Equilibrium, brackets: Sequence[PhaseFunction]) -> _Rule:
        """The rule for an equilibrium.

        Raises:
            ParameterError: no eigenvalue has a real part.
        """
        matrix = system.functions.jacobian(limit.state)
        values, right = _growing(matrix)
        if not right.shape[1]:
            raise ParameterError("origin: wanted an equilibrium with a growing direction; it has only oscillations")
        _, left = _growing(matrix.T)
        inward = linear.solve(linear.matmul(left.T, right), left.T)
        growth = linear.matmul(linear.matmul(inward, matrix), right)
        gradients = np.stack([f.gradient(limit.state) for f in brackets])
        size = np.abs(linear.eigvals(matrix)).max()
        return cls(
            system, limit.state, brackets, 1 / (_PER_UNIT * size), np.abs(values.real).min(), growth, inward,
            linear.matmul(gradients, right),
        )  # fmt: skip

    def half(self, states: Array, way: int, run: RunOptions) -> _Half:
        """The integrals over the times after 0 (way = 1), or before (-1).

        Raises:
            OrbitError: an orbit does not come near the equilibrium.
            TimeLimitError: the deadline has passed.
        """
        n_times = int(np.ceil((_SAFETY - elementary.log(_NEAR)) / (self.slowest * self.step)))
        times = way * self.step * np.arange(n_times + 1)
        path = integrate(
            self.system, states, times=times, method=run.method, kernel="lanes", threads=run.threads,
            time_limit=run.left,
        ).state  # fmt: skip
        checkpoint("Melnikov's integrals")
        distance = linear.norm(path - self.limit, axis=2)
        values = np.stack([f(path) for f in self.brackets], axis=2)
        rows = []
        for k in range(len(states)):
            reached = [np.nonzero(distance[k] < near * distance[k, 0])[0] for near in (_NEAR, 10 * _NEAR)]
            if not reached[0].size:
                raise OrbitError(
                    f"starts: wanted states on orbits that go to the equilibrium both ways; orbit {k} comes no nearer "
                    f"than {np.nanmin(distance[k]):.2g} at t {'>' if way > 0 else '<'} 0"
                )
            ends = [int(one[0]) for one in reached]
            at = ends[0] - ends[0] % 2  # an even number of steps, as for twice the step
            sums = self._sum(path[k], values[k], at, way, 1)
            rows.append(
                (
                    sums,
                    self._sum(path[k], values[k], at, way, 2),
                    np.abs(sums - self._sum(path[k], values[k], ends[1], way, 1)),
                )
            )
        return _Half(*(np.array(column) for column in zip(*rows, strict=True)))

    def _sum(self, path: Array, values: Array, end: int, way: int, stride: int) -> Array:
        r"""$h\sum_{k\ge1}f(x_k)$, from `end` on by the linearised flow.

        With $E = e^{Bh}$ for its matrix B, the rest is $\nabla f\cdot E(1 - E)^{-1}\xi$.  Along growing directions
        $\xi$ is round-off, and the same expression takes away what it has added before.
        """
        step = stride * self.step
        matrix = exponential(way * step * self.growth)
        near = linear.matmul(self.inward, path[end] - self.limit)
        rest = linear.matmul(self.outward, linear.matmul(matrix, linear.solve(np.eye(len(matrix)) - matrix, near)))
        return step * (values[stride : end + 1 : stride].sum(axis=0) + rest)


def _growing(matrix: Array) -> tuple[NDArray[np.complex128], Array]:
    """The eigenvalues that have a real part, and an orthonormal basis of their space, shape (N, k)."""
    found = linear.eig(matrix)
    values, vectors = found[0].astype(np.complex128), found[1].astype(np.complex128)
    chosen = np.abs(values.real) > _HYPERBOLIC * np.abs(values).max(initial=0.0)
    some, k = vectors[:, chosen], int(chosen.sum())
    basis = linear.svd(np.hstack([some.real, some.imag]))[0][:, :k] if k else np.zeros((len(matrix), 0))
    return values[chosen], basis
