r"""Critical points of a momentum map on a leaf, by Newton's method from random states; their rank and type.

A state x is critical where the fields are dependent, $\sum_k\lambda_kX_{F_k}(x) = 0$ with $|\lambda| = 1$.  With the
equations of the leaf these are solved for $(x, \lambda)$ by steps of least norm, as critical points come in families:
orbits of the flows, and more of them beside.  There the function $\sum_k\lambda_kF_k$ rests, and its linearised flow
on the leaf is symplectic.  With the rank r of the fields, $2r$ of its eigenvalues vanish; of the others [eliasson1990,
bolsinov2004]

- a pair $\pm i\nu$ is an *elliptic* direction,
- a pair $\pm\nu$ a *hyperbolic* one,
- four $\pm\mu\pm i\nu$ are *focus-focus*,

for a generic $\lambda$ among those with $\sum_k\lambda_kX_{F_k}(x) = 0$.  Where another one vanishes, or the linearised
flows are dependent, the point is *degenerate*.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline, checkpoint
from liepoisson.inputs.refusals import check_kind
from liepoisson.io.tables import beside, vector_columns
from liepoisson.leaf.leaf import Leaf
from liepoisson.leaf.leaf_projection import Equations
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import linear
from liepoisson.streams import Purpose, stream
from liepoisson.tori.momentum_maps import MomentumMap, momentum_map, moved_onto, on_leaf, unit_equations

if TYPE_CHECKING:
    from liepoisson.model.system import System

_STEPS, _LONGEST = 60, 0.5
"""Newton's steps, and the longest one in units of the leaf."""
_CONVERGED = 1e-12
"""Residual relative to the fields."""
_DEPENDENT = 1e-7
"""Fields of length 1 whose least singular value is below this are dependent: the square root of the residual."""
_KNOWN = 0.01
"""A square of a rate that one more step of Newton's method changes by more than this share is not known."""
_ROUND_OFF = 1e-13
"""Singular values of derivatives that are smaller, relative to the largest, are round-off."""
_ZERO = 1e-5
"""Eigenvalues that are smaller, relative to the largest, are zero: double ones are known to the root of round-off."""


@dataclass(frozen=True, eq=False)
class CriticalStates(SavedWhole):
    r"""Critical points of a momentum map.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.critical_states(leaf, n_starts=50)
        >>> sorted(set(zip(found.rank.tolist(), found.type.tolist())))
        [(1, 'elliptic')]

    Attributes:
        momentum: The momentum map.
        leaf: The leaf.
        states: Shape (point, N).
        values: Values of the integrals, shape (point, n).
        weights: $\lambda$, shape (point, n), for integrals divided by their units.
        rank: Number of independent flows, shape (point,).
        type: The type of each, such as "elliptic" or "elliptic, hyperbolic", shape (point,).
    """

    kind = "critical states"
    made_by = "lp.tori.critical_states"
    row = "point"

    momentum: MomentumMap
    leaf: Leaf
    states: Array
    values: Array
    weights: Array
    rank: NDArray[np.intp]
    type: NDArray[np.str_]

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.leaf.system

    def __len__(self) -> int:
        return len(self.states)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each point the integrals, rank, type and state."""
        rows = vector_columns("x", self.states, self.leaf.system.component_names) | {
            "rank": self.rank,
            "type": self.type,
        }
        return beside(rows, self.momentum.names, self.values)

    def __repr__(self) -> str:
        return f"<{len(self)} critical points of ({', '.join(self.momentum.names)}) on {self.leaf!r}>"


@explains_its_arguments
def critical_states(
    leaf: Leaf,
    *,
    momentum: MomentumMap | None = None,
    n_starts: int = 400,
    spread: float = 1.0,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> CriticalStates:
    r"""Critical points of the momentum map on a leaf, found from random states.

    Each start that converges gives one.  Isolated ones, of rank 0, are met only by chance: they are equilibria, see
    `lp.equilibria`.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("lagrange"), {"C1": 1, "C2": 1})
        >>> len(lp.tori.critical_states(leaf, n_starts=20).to_dataframe().columns)
        10

    Args:
        leaf: The leaf.
        momentum: The momentum map; by default that of the known integrals of the system.
        n_starts: Number of starts.
        spread: Standard deviation of the random states that are moved onto the leaf, in units of the leaf.
        seed: Draws the random states.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: the integrals are not as `momentum_map` wants them, or no random state comes to the leaf.
        LeafError: the equations of the leaf are not known.
        TimeLimitError: the time is over.

    References: [eliasson1990], [bolsinov2004].
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    momentum = momentum_of(leaf, momentum)
    n = as_count(n_starts, "n_starts", least=1)
    width = as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        search = Critical.on(leaf, momentum)
        x, weights = search.solved(*search.starts(n, width, as_seed(seed)))
        states = x * search.units
        return CriticalStates(momentum, leaf, states, momentum(states), weights, *search.kinds(x))


def momentum_of(leaf: Leaf, momentum: MomentumMap | None) -> MomentumMap:
    """The momentum map of the system of a leaf.

    Raises:
        ParameterError: the one given is of another system.
        LeafError: the leaf has not twice as many dimensions as there are integrals, or these commute on another one.
    """
    if momentum is None:
        momentum = momentum_map(leaf.system, leaf=leaf if leaf.is_regular else None)
    check_kind(momentum, MomentumMap, "momentum", "what momentum_map returns", "call it first")
    if momentum.system is not leaf.system and momentum.system != leaf.system:
        raise ParameterError(
            f"momentum: wanted that of the system of the leaf, {leaf.system.name!r}; got {momentum!r}. Make both of "
            "one system."
        )
    if leaf.rank != 2 * len(momentum.names):
        raise LeafError(
            f"leaf: wanted one of dimension {2 * len(momentum.names)}, as there are {len(momentum.names)} integrals; "
            f"got {leaf!r}. On it they are dependent everywhere, or more than it needs."
        )
    if momentum.leaf is not None and not (leaf.is_regular and leaf.casimirs == momentum.leaf.casimirs):
        raise LeafError(
            f"leaf: wanted {momentum.leaf!r}, on which alone the map ({', '.join(momentum.names)}) holds; got "
            f"{leaf.casimirs}. Make a map on this one: lp.tori.momentum_map(system, leaf=leaf)."
        )
    return momentum


def check_resolved(leaf: Leaf, momentum: MomentumMap) -> None:
    """That equations for values of the integrals can be solved to `_CONVERGED` beside constants that they have.

    Raises:
        ParameterError: an integral varies so little beside its size that round-off is more.
    """
    equations, units = unit_equations(leaf)
    rough = stream(0, Purpose.CRITICAL_POINTS).standard_normal((64, len(units))) * units
    states = moved_onto(equations, units, rough)
    values = momentum(states[np.isfinite(states).all(axis=1)])
    if not len(values):
        return
    for name, size, width in zip(momentum.names, np.abs(values).max(axis=0), np.ptp(values, axis=0), strict=True):
        if width > 0 and np.finfo(np.float64).eps * size > _CONVERGED * width:
            raise ParameterError(
                f"momentum: {name} is of the size {size:.1g} and varies by {width:.1g} on the leaf: doubles do not "
                "resolve its values. Leave constants and Casimirs out of it."
            )


@dataclass(frozen=True, eq=False)
class Critical:
    r"""The equations of critical points, in coordinates divided by units of the leaf.

    Attributes:
        momentum: The momentum map.
        leaf: The leaf.
        units: Units of the coordinates, shape (N,).
        equations: Those of the leaf, and of what is held.
        sizes: Typical lengths of the fields, shape (n,), by which they are divided.
    """

    momentum: MomentumMap
    leaf: Leaf
    units: Array
    equations: Equations
    sizes: Array

    @classmethod
    def on(cls, leaf: Leaf, momentum: MomentumMap, at: Mapping[str, float] | None = None) -> Critical:
        """The equations on a leaf; lengths of the fields are those at 64 random states.

        Args:
            at: Values that integrals keep.

        Raises:
            ParameterError: no random state was moved to these values.
        """
        held = at or {}
        equations, units = unit_equations(leaf, ((momentum.integrals[name], value) for name, value in held.items()))
        draft = cls(momentum, leaf, units, equations, np.ones(len(momentum.names)))
        states = draft.starts(64, 1.0, 0)[0]
        sizes = np.median(linear.norm(draft.fields(states), axis=1), axis=0)
        lengths = linear.norm(draft.fields(draft.moved(states)[0]), axis=1) if held else sizes[None]
        for name, value in held.items():
            # Where an integral rests, states are known to the root of round-off
            if (lengths[:, momentum.names.index(name)] <= _ZERO * sizes[momentum.names.index(name)]).all():
                what = "its flow rests at all states found" if len(lengths) else "no random state was moved to it"
                raise ParameterError(
                    f"at: wanted a value of {name} inside of its range on {leaf!r}; at {name} = {value:g} {what}. Take "
                    "another value."
                )
        return cls(momentum, leaf, units, equations, sizes)

    def fields(self, x: Array) -> Array:
        """The fields in units, shape (m, N, n)."""
        return self.momentum.fields(x * self.units) / self.units[:, None] / self.sizes

    def slopes(self, x: Array) -> Array:
        """Their derivatives, shape (..., N, N, n)."""
        return self.momentum.derivatives(x * self.units) / self.sizes * (self.units / self.units[:, None])[..., None]

    def starts(self, n: int, spread: float, seed: int) -> tuple[Array, Array]:
        """Random states on the leaf and weights that make the fields as dependent as they can be.

        Raises:
            ParameterError: none was found.
        """
        draw = stream(seed, Purpose.CRITICAL_POINTS)
        N = len(self.units)
        rough = spread * draw.standard_normal((n, N)) * self.units
        found = self._with_weights(on_leaf(self.leaf, rough) / self.units)
        self._check_some(found[0], n)
        return found

    def moved(self, x: Array) -> tuple[Array, Array]:
        """States near given ones at which what is held has its value, and weights as those of `starts`."""
        return self._with_weights(moved_onto(self.equations, self.units, x * self.units) / self.units)

    def starts_held(self, n: int, spread: float, seed: int) -> tuple[Array, Array]:
        """Those of `starts`, moved to where what is held has its value.

        Raises:
            ParameterError: none was found.
        """
        found = self.moved(self.starts(n, spread, seed)[0])
        self._check_some(found[0], n)
        return found

    def _check_some(self, x: Array, n: int) -> None:
        if not len(x):
            raise ParameterError(
                f"spread: wanted one with which random states come near to {self.leaf!r}, and to what is held; of {n} "
                "none did. Take one near to 1, or more n_starts."
            )

    def _with_weights(self, x: Array) -> tuple[Array, Array]:
        fields = self.fields(x)
        finite = np.isfinite(x).all(axis=1) & np.isfinite(fields).all(axis=(1, 2))
        return x[finite], linear.svd(fields[finite])[2][:, -1]

    def residual(self, x: Array, weights: Array) -> Array:
        """The equations, shape (m, N + equations + 1)."""
        combined = linear.einsum("mik,mk->mi", self.fields(x), weights)
        values, _ = self.equations.relative(x)
        return np.concatenate([combined, values, ((weights**2).sum(1, keepdims=True) - 1) / 2], axis=1)

    def jacobian(self, x: Array, weights: Array) -> Array:
        """Their derivatives along (x, lambda), shape (m, equation, N + n)."""
        across = linear.einsum("mijk,mk->mij", self.slopes(x), weights)
        fields = self.fields(x)
        _, rows = self.equations.relative(x)
        m, k, n = len(x), rows.shape[1], weights.shape[1]
        top = np.concatenate([across, fields], axis=2)
        middle = np.concatenate([rows, np.zeros((m, k, n))], axis=2)
        last = np.concatenate([np.zeros((m, 1, x.shape[1])), weights[:, None]], axis=2)
        return np.concatenate([top, middle, last], axis=1)

    def solved(self, x: Array, weights: Array, steps: int = _STEPS) -> tuple[Array, Array]:
        """What Newton's method makes of guesses: those that converge."""
        for _ in range(steps):
            checkpoint("looking for critical points")
            residual, matrix = self.residual(x, weights), self.jacobian(x, weights)
            good = np.isfinite(residual).all(axis=1) & np.isfinite(matrix).all(axis=(1, 2))
            x, weights, residual, matrix = x[good], weights[good], residual[good], matrix[good]
            if not len(x) or np.abs(residual).max() < _CONVERGED / 100:
                break
            step = _least_step(matrix, residual)
            x, weights = x + step[:, : x.shape[1]], weights + step[:, x.shape[1] :]
            weights /= linear.norm(weights, axis=1, keepdims=True)
        if not len(x):
            return x, weights
        converged = linear.norm(self.residual(x, weights), axis=1) < _CONVERGED
        return x[converged], weights[converged]

    def resting(self, x: Array) -> Array:
        """States at which all flows rest, found from guesses, each once."""
        for _ in range(_STEPS):
            checkpoint("looking for equilibria of all flows")
            fields = self.fields(x)
            slopes = self.slopes(x)
            values, rows = self.equations.relative(x)
            residual = np.concatenate([*np.moveaxis(fields, 2, 0), values], axis=1)
            matrix = np.concatenate([*np.moveaxis(slopes, 3, 0), rows], axis=1)
            good = np.isfinite(residual).all(axis=1) & np.isfinite(matrix).all(axis=(1, 2))
            x, residual, matrix = x[good], residual[good], matrix[good]
            if not len(x) or np.abs(residual).max() < _CONVERGED / 100:
                break
            x = x + _least_step(matrix, residual)
        rests = np.abs(self.fields(x)).max(axis=(1, 2), initial=0.0) < _CONVERGED
        found = list[Array]()
        for one in x[rests & (np.abs(self.equations.relative(x)[0]).max(axis=1, initial=0.0) < _CONVERGED)]:
            if all(linear.norm(one - other) > _DEPENDENT for other in found):
                found.append(one)
        return np.array(found).reshape(len(found), x.shape[1])

    def doubly_critical(self, x: Array) -> Array:
        """States of two less than the full rank, found from guesses: two combinations of the flows rest."""
        n, weights = len(self.units), linear.svd(self.fields(x))[2][:, -2:]
        for _ in range(_STEPS):
            checkpoint("looking for critical points")
            residual, matrix = self._paired(x, weights)
            good = np.isfinite(residual).all(axis=1) & np.isfinite(matrix).all(axis=(1, 2))
            x, weights, residual, matrix = x[good], weights[good], residual[good], matrix[good]
            if not len(x) or np.abs(residual).max() < _CONVERGED / 100:
                break
            step = _least_step(matrix, residual)
            x, weights = x + step[:, :n], weights + step[:, n:].reshape(weights.shape)
        return x[linear.norm(self._paired(x, weights)[0], axis=1) < _CONVERGED]

    def _paired(self, x: Array, weights: Array) -> tuple[Array, Array]:
        """The equations of two orthonormal combinations that rest, weights (m, 2, n), and their derivatives."""
        k, N, n = len(x), len(self.units), len(self.sizes)
        values, rows = self.equations.relative(x)
        fields, slopes = self.fields(x), self.slopes(x)
        products = linear.einsum("mak,mbk->mab", weights, weights) - np.eye(2)
        combined = linear.einsum("mik,mak->mai", fields, weights)
        residual = np.concatenate([combined.reshape(k, 2 * N), values, products.reshape(k, 4)], axis=1)
        matrix = np.zeros((*residual.shape, N + 2 * n))
        matrix[:, 2 * N : -4, :N] = rows
        for a in range(2):
            mine, equations = slice(N + a * n, N + (a + 1) * n), slice(a * N, (a + 1) * N)
            matrix[:, equations, :N] = linear.einsum("mijk,mk->mij", slopes, weights[:, a])
            matrix[:, equations, mine] = fields
            for b in range(2):  # the product of a and b, and that of b and a
                matrix[:, 2 * a + b - 4, mine] += weights[:, b]
                matrix[:, 2 * b + a - 4, mine] += weights[:, b]
        return residual, matrix

    def kinds(self, x: Array) -> tuple[NDArray[np.intp], NDArray[np.str_]]:
        """Ranks and types of critical points."""
        ranks, types = np.zeros(len(x), dtype=np.intp), list[str]()
        for k, one in enumerate(x):
            fields = self.fields(one[None])[0]
            sizes, null = linear.svd(fields)[1:]
            ranks[k] = int((sizes > _DEPENDENT).sum())
            corank = len(self.sizes) - int(ranks[k])
            types.append(self._type(one, null[ranks[k] :], corank) if corank else "regular")
        return ranks, np.array(types, dtype=np.str_)

    def _type(self, x: Array, null: Array, corank: int) -> str:
        rates = self._rates(x, null)
        largest = np.abs(rates).max()
        if not (np.abs(rates) > _ZERO * largest).all() or largest == 0:
            return "degenerate"
        again = self._again(x, null)
        if again is not None and (np.abs(np.abs(self._rates(*again)) ** 2 / np.abs(rates) ** 2 - 1) > _KNOWN).any():
            return "degenerate"
        if corank > 1:
            flows = np.array([self._linearised(x, one)[0].ravel() for one in null])
            sizes = linear.svd(flows, compute_uv=False)
            if sizes[-1] < _ZERO * sizes[0]:
                return "degenerate"
        real, imaginary = np.abs(rates.real) > _ZERO * np.abs(rates), np.abs(rates.imag) > _ZERO * np.abs(rates)
        counts = {
            "elliptic": int((imaginary & ~real).sum()) // 2,
            "hyperbolic": int((real & ~imaginary).sum()) // 2,
            "focus-focus": int((real & imaginary).sum()) // 4,
        }
        return ", ".join(name for name, count in counts.items() for _ in range(count)) or "degenerate"

    def _rates(self, x: Array, null: Array) -> Array:
        """The eigenvalues of a generic combination of those that rest, which are not zero, the largest first."""
        # Multiples of 1, sqrt(2), sqrt(3), ... have no relation
        weights = linear.matmul(np.sqrt(np.arange(1.0, len(null) + 1)), null)
        rates = linear.eigvals(self._linearised(x, weights)[0])
        return rates[np.argsort(-np.abs(rates), kind="stable")][: 2 * len(null)]

    def _again(self, x: Array, null: Array) -> tuple[Array, Array] | None:
        """Where one more step leads: at degenerate points Newton's method converges slowly, and rates change."""
        N = len(x)
        if len(null) == 1:
            step = _least_step(self.jacobian(x[None], null), self.residual(x[None], null), _ROUND_OFF)[0]
        elif len(null) == 2:
            residual, matrix = self._paired(x[None], null[None])
            step = _least_step(matrix, residual, _ROUND_OFF)[0]
        else:
            return None
        return x + step[:N], null + step[N:].reshape(null.shape)

    def _linearised(self, x: Array, weights: Array) -> tuple[Array, Array]:
        """The linearised flow of a combination that rests, in an orthonormal basis of the tangent space; the basis."""
        tangent = linear.qr(self.leaf.tangent_basis(x * self.units) / self.units[:, None]).Q
        slope = linear.matmul(self.slopes(x), weights)
        return linear.matmul(tangent.T, linear.matmul(slope, tangent)), tangent

    def leaving(self, x: Array) -> Array:
        r"""Unit vectors from a state of two less than the full rank, along the families of orbits that leave it.

        One for each elliptic plane and two for each hyperbolic one [eliasson1990], shape (family, N).
        """
        rests = np.eye(2) if len(self.sizes) == 2 else linear.svd(self.fields(x[None])[0])[2][-2:]
        matrix, tangent = self._linearised(x, linear.matmul(np.sqrt(np.arange(1.0, 3.0)), rests))
        rates, unit = linear.eigvals(matrix), np.eye(len(matrix))
        real, imaginary = (np.abs(part) > _ZERO * np.abs(rates).max() for part in (rates.real, rates.imag))

        def null(of: Array) -> Array:
            return linear.svd(of)[2][-1]

        found = [null(linear.matmul(matrix, matrix) + r**2 * unit) for r in rates.imag[~real & imaginary] if r > 0]
        for r in rates.real[real & ~imaginary]:
            if r > 0:
                out, back = null(matrix - r * unit), null(matrix + r * unit)
                found += [out + back, out - back]
        steps = np.array(found).reshape(len(found), len(unit))
        return linear.matmul(steps / linear.norm(steps, axis=1, keepdims=True), tangent.T)


def _least_step(matrix: Array, residual: Array, zero: float = 1e-9) -> Array:
    """Steps of least norm, no longer than they may be."""
    step = -linear.einsum("mij,mj->mi", linear.pinv(matrix, rcond=zero), residual)
    length = linear.norm(step, axis=1, keepdims=True)
    return step * np.minimum(1.0, _LONGEST / np.maximum(length, 1e-300))
