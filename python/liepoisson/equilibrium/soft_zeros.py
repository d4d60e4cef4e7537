r"""Whether the end of a search is on its way to a critical point, or on a tail along which H only decays.

Newton's method comes to rest where the slope of H is below round-off. Near a critical point of high order that is far
off, some tenths for a slope of the order of $d^{19}$ at the distance d. And it comes to rest where there is no critical
point at all, on the tails of $e^q$, $\tanh(q + q^3)$ or $e^{-\cosh q}$, where the slope is zero in doubles only.

Both look alike in doubles, and are told apart by analysis with more digits. The second variation is soft along
directions V at the state x. For each s the other unknowns are found from the equations that are not soft (Lyapunov and
Schmidt), so that H on the leaf becomes a function h(s) of few variables, with the slope $g = \nabla h$. The critical
points are the zeros of g, and Newton's displacement $n(s) = (\partial g)^{-1}g$ is zero there, too. For a zero of order
m along a direction $g\sim d^m$ and $n\sim d/m$: of whatever order, it is a *simple* zero of n with the derivative 1/m.
Newton's method for n, instead of g, converges to it quadratically, and shows the order. On a tail
$n = 1/(\ln|g|)'$ tends to zero without having one: for $e^q$ its derivative is 0, for $e^{-q^4}$ it is $3/(4q^4)$, and
the steps do not become shorter.

Derivatives are differences, of numbers with 300 digits, in which the slope of a tail is not zero.

References: [golubitsky1985], for the reduction; [schroeder1870], for Newton's method for n.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, arb_mat

from liepoisson.algebra.ideals.certified_roots import precision
from liepoisson.algebra.rational_polynomials import powers_of
from liepoisson.equilibrium.critical_points import HamiltonianFields, residuals
from liepoisson.equilibrium.second_variation import curvatures, soft_directions
from liepoisson.equilibrium.symmetry_orbit import free_motions
from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits
    from liepoisson.model.phase_functions import PhaseFunction

_SUSPECT = 1e-3
"""Directions that are softer than this, relative to the largest curvature, are looked at with more digits."""
_FLAT, _SETTLED = 1e-11, 1e-2
"""Directions that are softer than this are flat to round-off; how far a critical point that was found for sure may be
from where it was found."""
_LED_ON_BY_DOUBLES = 6
"""Degree of polynomials whose critical points are of orders that the search needs no more digits for."""
BITS = 1060
_OUTER, _INNER = arb(2) ** -100, arb(2) ** -200
"""Steps of the differences of n and of g, relative to the length of the state."""
_SOLVED = arb(2) ** -930
"""What the equations that are not soft are solved to, relative."""
_VISIBLE = arb(2) ** 320
"""A slope is known well enough for second differences if it is larger than its error by this factor."""
_NEARBY = tuple(sign * share for share in (1e-6, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.1) for sign in (1, -1))
"""Where the slope is looked at, relative to the length of the state, if it is not seen at the state itself. The first
is for a state that is a critical point, from which others that are not far would be found instead."""
_BISECTIONS, _JUST_SEEN = 10, arb(10) ** -90
"""Halvings of the way from where no slope is seen to where one is, and what is left of the slope at the end of it,
relative: a slope is seen from 1e-184 on, and that of a tail like $e^{-e^q}$ grows by a few powers of ten meanwhile."""
_STEPS, _CHORDS, _REFRESHED = 14, 200, 4
_GAINED = 1e-9
"""What a chord leaves of the error, at most, or else the linear equations are taken anew, where the chords have led: on
a curved valley those of a place beside it gain a few digits each time, and 280 are wanted."""
_CONVERGED, _CLOSE, _BACK, _FAR = 1e-10, 1e-6, 1e-8, 2.0
"""Steps of Newton's method for n, relative to the length of the state: the last one, one after which a slope that is
not seen any more counts as zero, one back from which such a zero must be found again, and one that leads away."""
_SHORTER = 0.7
"""What each step is to the one before, at most, but for one."""
_DEPENDENT = 1e-13
"""Slopes of Casimirs and integrals depend on each other where a combination of them is smaller than this."""
_AT_REST, _NEAR_REST, _FACTORS = 1e-11, 1e-3, (2.0, 4.0, 8.0, 0.5, 0.25)
"""Residual of a state at which a motion is at rest, how far from it states are led to it, and other starts on the line
from it, by which factor they are farther."""
_DESCENTS, _HALVINGS, _DESCENDED = 300, 6, 1e-16
"""Newton's method for g: steps, halvings of one that does not lead down, and the last one, relative."""
_WATCHED, _FASTER = 12, 0.95
"""Over how many steps these become shorter, by which factor each."""
_LEAST = 1e-3
"""The derivative of n along a direction is 1/m for a zero of order m; orders up to the inverse of this are believed."""
WHOLE = 0.05
"""How far an order may be from a whole number."""
_ROUND_OFF, _FEW, _SURELY_WHOLE = 1e-14, 10, 0.01
"""A zero of low order that is one to round-off in the numbers of the problem, such as the values of the Casimirs."""


def may_mislead(energy: PhaseFunction) -> bool:
    """Whether H may be flat without a critical point, or have one of so high an order that doubles do not lead to it.

    A polynomial decays nowhere.
    """
    if energy.polynomial is None:
        return not energy.is_polynomial or _degree_of(energy) > _LED_ON_BY_DOUBLES
    degree = max((sum(powers) for powers, _ in powers_of(energy.polynomial, energy.n_coordinates)), default=0)
    return degree > _LED_ON_BY_DOUBLES


def _degree_of(energy: PhaseFunction) -> int:
    """The degree of a polynomial that is known as an expression: of a sum of traces, of the longest one."""
    from sympy import Poly, preorder_traversal

    from liepoisson.structure.trace import Trace

    traces = [node for node in preorder_traversal(energy.expression) if isinstance(node, Trace)]
    if traces:
        return max(len(trace.word) for trace in traces)
    degree: Any = Poly(energy.expression, *energy.variables).total_degree()
    return int(degree)


@np.errstate(all="ignore")  # functions need not be defined where they are tried
def zero_near(
    leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array, within: float = _SUSPECT
) -> SoftZero | None:
    """The critical point to which Newton's method was on its way, or None if there is none.

    The state itself is returned where no direction is soft, and where H is flat along those that are, as on a family of
    critical points.

    Args:
        leaf: The leaf.
        fields: Those of H and of integrals.
        values: The values of the integrals.
        state: Where the method came to rest, shape (N,).
        within: Directions softer than this, relative to the largest curvature, are looked at; 1 for all of them, where
            the method did not come to rest in the stiff ones.
    """
    with precision(BITS):
        slope = reduced_slope(leaf, fields, values, state, within)
        if slope is None:
            return SoftZero(state)
        origin = [arb(0)] * slope.soft.shape[1]
        here = slope.at(origin)
        if here is not None and here.is_seen:
            zero = _first_zero(slope, [origin, *_from_rest(slope, len(origin))], origin)
            return _descended(slope, origin) if zero is None and len(origin) > 1 else zero
        starts = _where_seen(slope, len(origin))
        return SoftZero(state) if starts is None else _first_zero(slope, starts, origin)


def _first_zero(slope: ReducedSlope, starts: list[list[arb]], origin: list[arb]) -> SoftZero | None:
    """The zero to which the first start leads that leads to one; last, where there may be a family, across it."""
    for is_across in (False, True)[: slope.soft.shape[1]]:
        for s in starts:
            zero = _zero(slope, s, is_own=s is origin, is_across=is_across)
            if zero is not None:
                return zero
    return None


def reduced_slope(
    leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array, within: float = _SUSPECT
) -> ReducedSlope | None:
    """The slope along the soft directions at a state, None if there is none or the other equations are not regular."""
    slope, phases = _slope_at(leaf, fields, values, state, within)
    if slope is None or not phases:
        return slope
    # near a state at which the motions are at rest, directions are as good as the state is
    there = slope.at([arb(0)] * slope.soft.shape[1])
    if there is None:
        return slope
    better, _ = _slope_at(leaf, fields, values, slope.state_of([arb(0)] * slope.soft.shape[1], there), within)
    slope = better or slope
    slope.rest = _rest_near(leaf, fields, values, slope.origin)
    return slope


def _rest_near(leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array) -> Array | None:
    """A relative equilibrium near a state, at which a motion that carries the state is at rest; None if there is none.

    Round this place the equations for the other unknowns are not regular, and all ends of Newton's method look like
    small circles.
    """
    near = _NEAR_REST * (float(linear.norm(state)) + fields.unit)
    for motion in free_motions(leaf, fields, state):
        rest = motion.rest_near(state)
        if linear.norm(rest - state) <= near and residuals(leaf, fields, rest[None], values)[0] <= _AT_REST:
            return rest
    return None


def _slope_at(
    leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array, within: float
) -> tuple[ReducedSlope | None, int]:
    """The slope along the soft directions at a state, and the number of motions of integrals that carry it away."""
    soft = soft_directions(leaf, fields, state, within)
    if not soft.shape[1]:
        return None, 0
    phases = [motion.velocity(state) for motion in free_motions(leaf, fields, state)]
    basis = linear.qr(np.array(phases).reshape(-1, len(state)).T)[0]
    return ReducedSlope.at_state(leaf, fields, values, state, (soft, basis)), len(phases)


def settled(leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array) -> SoftZero:
    """The critical point itself where one was found for sure, but not to round-off, as where two are just meeting.

    The state is returned where no direction is soft, or those that are soft are flat to round-off.

    Args:
        leaf: The leaf.
        fields: Those of H and of integrals.
        values: The values of the integrals.
        state: Where Newton's method came to rest, shape (N,).
    """
    sizes = curvatures(leaf, fields, state)
    soft = sizes <= _SUSPECT
    if not (soft & (sizes > _FLAT)).any() and not (soft.any() and _rest_near(leaf, fields, values, state) is not None):
        return SoftZero(state)
    zero = zero_near(leaf, fields, values, state)
    near = _SETTLED * (float(linear.norm(state)) + fields.unit)
    return zero if zero is not None and linear.norm(zero.state - state) <= near else SoftZero(state)


@dataclass(frozen=True)
class SoftZero:
    """A critical point with soft directions.

    Attributes:
        state: The state, shape (N,).
        is_flat: Whether it is known to be of an order above one along all of these, so that the second variation is
            zero there.
        is_isolated: Whether it is known to be no state of a family of critical points, but for those to which the
            motions of the integrals carry it.
    """

    state: Array
    is_flat: bool = False
    is_isolated: bool = False


@dataclass(frozen=True)
class Slope:
    """The slope g at one s, bounds on its errors, and the other unknowns there."""

    value: list[arb]
    error: arb
    unknowns: list[arb]

    @property
    def is_seen(self) -> bool:
        """Whether the slope is known well enough to be differentiated."""
        size = max((abs(v) for v in self.value), key=lambda v: v.mid())
        return bool(size.lower() > _VISIBLE * self.error)


@dataclass
class ReducedSlope:
    r"""The slope of H on the leaf as a function of few coordinates s, with $y = x + Vs + Wv$.

    The unknowns v and the multipliers $\lambda$ solve $W^t(\nabla H - \lambda\nabla C) = 0$ and C(y) = c.
    """

    fields: HamiltonianFields
    pinned: Array
    functions: tuple[Any, ...]
    values: Array
    mixing: Array
    origin: Array
    soft: Array
    others: Array
    length: float
    start: list[arb]
    inverse: arb_mat = field(default_factory=lambda: arb_mat(0, 0))
    curvature: float = 0.0
    scale: float = 0.0
    rest: Array | None = None

    @classmethod
    def at_state(
        cls, leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array, directions: tuple[Array, Array]
    ) -> ReducedSlope | None:
        """The one at a state, with the soft directions and those of symmetries, along which nothing changes."""
        equations = leaf.equations
        m, n = equations.mixing.shape
        mixing = np.eye(m + len(values), n + len(values))
        mixing[:m, :n], mixing[m:, n:] = equations.mixing, np.eye(len(values))
        mixing[m:, :n] = 0.0
        functions = (*equations.functions, *fields.functions[1:])
        fixed = np.concatenate(directions, axis=1)
        others = linear.svd(fixed)[0][:, fixed.shape[1] :]
        length = float(linear.norm(state)) + fields.unit
        goals = np.append(equations.values, values)
        slope = cls(fields, equations.pinned, functions, goals, mixing, state, directions[0], others, length, [])
        if functions:
            rows = linear.matmul(mixing, np.array([f.gradient(state) for f in functions]).reshape(-1, len(state)))
            lengths = linear.norm(rows, axis=1)
            if not (np.isfinite(lengths).all() and lengths.all()):
                return None
            # where the motion of an integral is nearly at rest, the slopes depend on each other but for a small part
            turned, sizes, _ = linear.svd(rows / lengths[:, None], full_matrices=False)
            if not sizes[-1] > _DEPENDENT:
                return None
            slope = replace(slope, mixing=linear.matmul((turned / sizes).T, (mixing / lengths[:, None])))
        return slope if slope._refreshed(state) else None

    def zero(self, s: Sequence[arb], shares: Array) -> SoftZero | None:
        """The critical point that belongs to s, in doubles."""
        solved = self.at(list(s))
        if solved is None:
            return None
        state = self.state_of(s, solved)
        return SoftZero(state, is_flat=bool(shares.max() < 1 - WHOLE), is_isolated=len(s) == 1)

    def state_of(self, s: Sequence[arb], solved: Slope) -> Array:
        """The state at s, where the other unknowns were found, in doubles."""
        return np.array([float(y.mid()) for y in self._state(s, solved.unknowns)])

    def is_at_rest(self, s: Sequence[arb], unknowns: Sequence[arb]) -> bool:
        """Whether s leads to the state near here at which a motion of integrals is at rest."""
        if self.rest is None:
            return False
        y = np.array([float(y.mid()) for y in self._state(s, unknowns)])
        return bool(linear.norm(y - self.rest) <= _CLOSE * self.length)

    def at(self, s: Sequence[arb], unknowns: list[arb] | None = None) -> Slope | None:
        """The slope at s, None where the other unknowns were not found."""
        unknowns = self.start if unknowns is None else unknowns
        last, refreshed, renewed = None, 0, 0
        for _ in range(_CHORDS):
            value, rest = self._equations(s, unknowns)
            if not all(v.is_finite() for v in (*value, *rest)):
                return None
            change = [v for (v,) in (self.inverse * _column(rest)).tolist()] if rest else []
            unknowns = [(a - b).mid() for a, b in zip(unknowns, change, strict=True)]
            moved, turned = self._sizes(change)
            size = moved / self.length + turned / self.scale
            if size <= _SOLVED:
                error = self.curvature * moved + turned
                for v in value:
                    error += v.rad()
                return Slope([v.mid() for v in value], error.upper(), unknowns)
            if last is not None and not size < last / 4:
                refreshed += 1
                y = np.array([float(y.mid()) for y in self._state(s, unknowns)])
                if refreshed > _REFRESHED or not self._refreshed(y):
                    return None
                size = None
            elif last is not None and renewed < _REFRESHED and not size < _GAINED * last:
                renewed += 1
                self._refreshed(np.array([float(y.mid()) for y in self._state(s, unknowns)]))
            last = size
        return None

    def _state(self, s: Sequence[arb], unknowns: Sequence[arb]) -> list[arb]:
        moved = self._frame * _column([*s, *unknowns[: self.others.shape[1]]])
        return [float(x) + v for x, (v,) in zip(self.origin, moved.tolist(), strict=True)]

    @cached_property
    def _frame(self) -> arb_mat:
        return _matrix(np.concatenate([self.soft, self.others], axis=1))

    @cached_property
    def _transposed(self) -> arb_mat:
        return _matrix(np.concatenate([self.soft, self.others], axis=1).T)

    def _equations(self, s: Sequence[arb], unknowns: Sequence[arb]) -> tuple[list[arb], list[arb]]:
        """The slopes along the soft directions, and what is to be zero."""
        k, n = self.soft.shape[1], self.others.shape[1]
        y, multipliers = self._state(s, unknowns), unknowns[n:]
        left = self.fields.functions[0].gradient_in_balls(y)
        constraints: list[arb] = []
        if multipliers:
            rows = [[arb(float(v)) for v in row] for row in self.pinned]
            constraints = [_product(row, y) for row in rows]
            slopes = [f.gradient_in_balls(y) for f in self.functions]
            gaps = [f.value_in_balls(y) - float(c) for f, c in zip(self.functions, self.values, strict=True)]
            for weights in ([*map(arb, row)] for row in self.mixing.tolist()):
                rows.append([_product(weights, column) for column in zip(*slopes, strict=True)])
                constraints.append(_product(weights, gaps))
            for multiplier, row in zip(multipliers, rows, strict=True):
                left = [a - multiplier * b for a, b in zip(left, row, strict=True)]
        along = [v for (v,) in (self._transposed * _column(left)).tolist()]
        return along[:k], [*along[k:], *constraints]

    def _sizes(self, change: Sequence[arb]) -> tuple[arb, arb]:
        """The largest change of the state and of the multipliers."""
        n = self.others.shape[1]
        return _largest(change[:n]), _largest(change[n:])

    def _refreshed(self, y: Array) -> bool:
        """Take the linear equations at a state for those that follow, if they are regular."""
        energy = self.fields.functions[0]
        gradient, curvature = energy.gradient(y), energy.hessian(y)
        rows = self.pinned
        if self.functions:
            rows = np.concatenate([rows, linear.matmul(self.mixing, np.array([f.gradient(y) for f in self.functions]))])
        if not all(np.isfinite(v).all() for v in (gradient, curvature, rows)):
            return False
        multipliers = linear.lstsq(rows.T, gradient)[0] if len(rows) else np.zeros(0)
        weights = linear.matmul(multipliers[len(self.pinned) :], self.mixing)
        for weight, function in zip(weights, self.functions, strict=True):
            curvature = curvature - weight * function.hessian(y)
        if not np.isfinite(curvature).all():
            return False
        w = self.others
        zero = np.zeros((len(rows), len(rows)))
        matrix = np.block(
            [
                [linear.matmul(linear.matmul(w.T, curvature), w), linear.matmul(-w.T, rows.T)],
                [linear.matmul(rows, w), zero],
            ]
        )
        size = float(np.abs(curvature).max(initial=0.0))
        # near a state that the motion of an integral leaves at rest, the slope of this integral is small
        heights = linear.norm(rows, axis=1)
        heights = (size * self.length or 1.0) / np.where(heights > 0, heights, 1.0)
        units = np.append(np.full(w.shape[1], self.length), heights)
        if len(matrix):
            balanced = matrix * units
            lengths = np.abs(balanced).max(axis=1)
            balanced_rows = balanced / lengths[:, None]
            if not np.isfinite(balanced_rows).all() or not linear.cond(balanced_rows) < 1e12:
                return False
            inverse = units[:, None] * linear.inv(balanced_rows) / lengths
            self.inverse = _matrix(inverse)
        if not self.start:
            self.start = [arb(0)] * w.shape[1] + [arb(v) for v in multipliers.tolist()]
        self.curvature, self.scale = size, size * self.length or 1.0
        return True


def _where_seen(slope: ReducedSlope, k: int) -> list[list[arb]] | None:
    """Where the slope is seen near the state, at most one place on each side; None if H is flat all around."""
    found: dict[tuple[int, bool], list[arb] | None] = {}
    hidden: dict[tuple[int, bool], list[arb]] = {}
    for share in _NEARBY:
        for i in range(k):
            side, s = (i, share > 0), [arb(0)] * k
            s[i] = arb(share * slope.length)
            if side in found:
                continue
            there = slope.at(s)
            if there is not None and there.is_seen:
                found[side] = s if _comes_into_sight(slope, hidden.get(side, [arb(0)] * k), s) else None
            elif there is not None:
                hidden[side] = s
    return [s for s in found.values() if s is not None] or None


def _from_rest(slope: ReducedSlope, k: int) -> list[list[arb]]:
    """Where else Newton's method starts near a state of rest, between which and a small circle ends may lie."""
    if slope.rest is None or k != 1:
        return []
    distance = float(linear.matmul(slope.soft[:, 0], (slope.origin - slope.rest)))
    return [[arb(distance * (factor - 1))] for factor in _FACTORS]


def _comes_into_sight(slope: ReducedSlope, hidden: list[arb], seen: list[arb]) -> bool:
    """Whether the slope grows from what is not seen at the first place to what is seen at the second, without a jump.

    An analytic function that is zero on an interval is zero as far as it can be continued. So it jumps where the line
    leaves a family of critical points, such as a circle that it is tangent to, and what is found there is another
    branch of the equations that are not soft. On a tail, and beside a zero of high order, it does not.
    """
    last = slope.at(seen)
    for _ in range(_BISECTIONS):
        middle = [((a + b) / 2).mid() for a, b in zip(hidden, seen, strict=True)]
        there = slope.at(middle)
        if there is not None and there.is_seen:
            seen, last = middle, there
        else:
            hidden = middle
    return last is not None and bool(_largest(last.value) <= _JUST_SEEN * slope.curvature * slope.length)


def _zero(slope: ReducedSlope, s: list[arb], *, is_own: bool, is_across: bool = False) -> SoftZero | None:
    """A zero of the slope, by Newton's method for n from s; `is_own`: s is where the search came to rest.

    With `is_across` all steps are along g, as across a family.
    """
    last, slow, rounded, shares = None, 0, None, np.zeros(0)
    came_from: list[arb] = []
    if is_own and (fold := fold_to_round_off(slope, s)) is not None:
        return slope.zero(fold, np.array([0.5]))
    for number in range(_STEPS):
        there = slope.at(s)
        if there is None:
            break
        if not there.is_seen:
            if last is not None and (last <= _CLOSE or _is_found_again(slope, s, came_from)):
                return slope.zero(s, shares)
            break
        found = newton_step(slope, s, there, is_across=is_across)
        if found is None:
            break
        step, shares = found
        size = float(_largest(step)) / slope.length
        if not size <= _FAR or not may_be_orders(shares):
            break
        came_from = step
        s = [(a - b).mid() for a, b in zip(s, step, strict=True)]
        if is_one_over_whole(shares, WHOLE) and slope.is_at_rest(s, there.unknowns):
            return SoftZero(slope.rest) if slope.rest is not None else None
        if size <= _CONVERGED and is_one_over_whole(shares, WHOLE) and (last is None or size <= _SHORTER * last):
            fold = fold_to_round_off(slope, s)
            return slope.zero(s, shares) if fold is None else slope.zero(fold, np.array([0.5]))
        if number == 0 and is_own and _is_zero_to_round_off(slope, s, shares):
            rounded = slope.zero(s, shares)
        slow += last is not None and size > _SHORTER * last
        if slow > 1:
            break
        last = size
    return rounded


def _descended(slope: ReducedSlope, s: list[arb]) -> SoftZero | None:
    r"""A zero of the slope along several directions of different orders, by Newton's method for g itself.

    Where the slope is $(4u^3 + v^2, 2uv)$, n is no smooth function at the zero. The steps for g become shorter there by
    a factor of about $1 - 1/m$ each, which on a tail tends to one.
    """
    k, here = len(s), slope.at(s)
    if here is None:
        return None
    basis = [[arb(int(i == j)) for i in range(k)] for j in range(k)]
    sizes: list[float] = []
    way = 0.0
    while len(sizes) < _DESCENTS:
        step = _displacement(slope, s, basis)
        if step is None or not all(v.is_finite() for v in step):
            return None
        for _ in range(_HALVINGS):
            there = slope.at([(a - b).mid() for a, b in zip(s, step, strict=True)], here.unknowns)
            if there is not None and _largest(there.value) < _largest(here.value):
                break
            step = [v / 2 for v in step]
        else:
            return None
        s, here = [(a - b).mid() for a, b in zip(s, step, strict=True)], there
        sizes.append(float(_largest(step)) / slope.length)
        way += sizes[-1]
        if sizes[-1] <= _DESCENDED:
            return SoftZero(slope.state_of(s, here))
        if way > _FAR or (len(sizes) > _WATCHED and not sizes[-1] <= _FASTER**_WATCHED * sizes[-1 - _WATCHED]):
            return None
    return None


def _is_found_again(slope: ReducedSlope, s: list[arb], came_from: list[arb]) -> bool:
    """Whether s, where no slope is seen, is a zero: from a place beside it Newton's step leads back, as on no tail.

    A slope that is linear leads to its zero in one step, however long, and leaves nothing there.
    """
    size = _largest(came_from)
    if not size > 0:
        return False
    back = [(_BACK * slope.length * v / size).mid() for v in came_from]
    beside = [(a + b).mid() for a, b in zip(s, back, strict=True)]
    there = slope.at(beside)
    found = newton_step(slope, beside, there) if there is not None and there.is_seen else None
    if found is None:
        return False
    step, shares = found
    left = _largest([a - b for a, b in zip(step, back, strict=True)])
    return bool(left <= WHOLE * _BACK * slope.length) and may_be_orders(shares) and is_one_over_whole(shares, WHOLE)


def may_be_orders(shares: Array) -> bool:
    """Whether the derivatives of n may be the 1/m of zeros of orders m >= 1, or 0 along a family."""
    least = _LEAST if len(shares) == 1 else -WHOLE
    return bool((shares >= least).all() and shares.max() >= _LEAST and shares.max() <= 1 + WHOLE)


def is_one_over_whole(shares: Array, within: float) -> bool:
    """The same where there is one direction; with several, zeros that are not homogeneous have other derivatives."""
    return len(shares) > 1 or bool(abs(1 / shares[0] - round(1 / shares[0])) <= within)


def _is_zero_to_round_off(slope: ReducedSlope, s: list[arb], shares: Array) -> bool:
    """Whether s is a zero of low order for values that differ from those that are kept by round-off."""
    if len(shares) > 1 or shares[0] < 1 / _FEW or not is_one_over_whole(shares, _SURELY_WHOLE):
        return False
    here = slope.at(s)
    if here is None:
        return False
    change = arb(0)
    for k in range(len(slope.values)):
        values = slope.values.copy()
        values[k] *= 1 + _ROUND_OFF
        there = replace(slope, values=values).at(s, here.unknowns)
        if there is not None:
            change += _largest([a - b for a, b in zip(there.value, here.value, strict=True)])
    return bool(_largest(here.value) <= change)


def fold_to_round_off(slope: ReducedSlope, s: list[arb]) -> list[arb] | None:
    r"""The place near s where two zeros meet, if round-off in the values that are kept can make them meet there.

    Between two simple zeros $|g|$ is largest at the distance $g'/g''$; if they have just vanished it is smallest there.
    """
    if len(s) > 1 or not slope.functions or slope.rest is not None:
        return None
    h, size = _INNER * slope.length, slope.curvature * slope.length
    beside = [slope.at(_moved(s, k * h, [arb(1)])) for k in (-1, 0, 1)]
    left, here, right = ([there.value[0] for there in beside if there is not None] + [arb(0)] * 3)[:3]
    first, second = (right - left) / (2 * h), (right - 2 * here + left) / (h * h)
    if None in beside or not abs(second) * slope.length**2 >= _SUSPECT * size:
        return None
    way = (-first / second).mid()
    if not abs(way) <= _CLOSE * slope.length:
        return None
    fold = [v.mid() for v in _moved(s, way, [arb(1)])]
    there = slope.at(fold)
    return fold if there is not None and _largest(there.value) <= _ROUND_OFF * size else None


def newton_step(
    slope: ReducedSlope, s: list[arb], there: Slope, *, is_across: bool = False
) -> tuple[list[arb], Array] | None:
    r"""Newton's step $(\partial n)^{-1}n$ for the displacement n, and the eigenvalues of its derivative.

    Where $\partial g$ is singular, as across a family, the step is along g; with `is_across` it is in any case.
    """
    k = len(s)
    bases = [[[arb(int(i == j)) for i in range(k)] for j in range(k)]]
    if k > 1:
        size = sum((v * v for v in there.value), arb(0)).sqrt()
        bases.append([[(v / size).mid() for v in there.value]])
    for basis in bases[1:] if is_across else bases:
        here = _displacement(slope, s, basis)
        if here is None:
            continue
        h = _OUTER * slope.length
        beside = [_displacement(slope, _moved(s, h, direction), basis) for direction in basis]
        columns = [[(b - a) / h for a, b in zip(here, other, strict=True)] for other in beside if other is not None]
        if len(columns) < len(basis):
            continue
        matrix = arb_mat([list(row) for row in zip(*columns, strict=True)])
        try:
            along = [v for (v,) in matrix.solve(_column(here)).tolist()]
        except ZeroDivisionError:
            continue
        shares = np.array([[float(v.mid()) for v in row] for row in matrix.tolist()])
        if not np.isfinite(shares).all() or not all(v.is_finite() for v in along):
            continue
        step = [arb(0)] * k
        for length, direction in zip(along, basis, strict=True):
            step = _moved(step, length, direction)
        return [v.mid() for v in step], linear.eigvals(shares).real
    return None


def _displacement(slope: ReducedSlope, s: list[arb], basis: list[list[arb]]) -> list[arb] | None:
    r"""Newton's displacement $(\partial g)^{-1}g$ in the span of some directions."""
    here = slope.at(s)
    if here is None:
        return None
    h = _INNER * slope.length
    beside = [slope.at(_moved(s, h, direction), here.unknowns) for direction in basis]
    if any(other is None for other in beside):
        return None
    along = [_product(direction, here.value) for direction in basis]
    columns = [
        [(_product(direction, other.value) - a) / h for direction, a in zip(basis, along, strict=True)]
        for other in beside
        if other is not None
    ]
    try:
        solved = arb_mat([list(row) for row in zip(*columns, strict=True)]).solve(_column(along))
    except ZeroDivisionError:
        return None
    return [v.mid() for (v,) in solved.tolist()]


def _moved(s: Sequence[arb], length: arb, direction: Sequence[arb]) -> list[arb]:
    return [a + length * b for a, b in zip(s, direction, strict=True)]


def _product(a: Sequence[arb], b: Sequence[arb]) -> arb:
    return sum((u * v for u, v in zip(a, b, strict=True)), arb(0))


def _largest(values: Sequence[arb]) -> arb:
    largest = arb(0)
    for v in values:
        size = v.abs_upper()
        largest = size if size > largest else largest
    return largest


def _column(values: Sequence[arb]) -> arb_mat:
    return arb_mat([[v] for v in values])


def _matrix(values: Array) -> arb_mat:
    return arb_mat([[arb(v) for v in row] for row in values.tolist()])
