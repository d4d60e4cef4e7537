r"""How far a top can get from the origin: bounds of $|\ell|, |\alpha|, |\beta|, |\omega|$ by energy and Casimirs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import as_array, as_number
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import named
from liepoisson.inputs.refusals import check_kind, shown
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.portable import elementary, linear
from liepoisson.structure.casimir_part import difference, normal_form

if TYPE_CHECKING:
    from liepoisson.compile.field import TopField
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System
    from liepoisson.model.top_parameters import TopParameters

_LEAST, _LARGEST = 1e-140, 1e150
"""Vectors of a state that do not vanish have lengths between these: then their squares are normal doubles."""

_ROUND_OFF = 1e-14
"""Round-off of the sums, relative to their terms: where the inequality has one solution only, it must not be lost."""

_BISECTIONS = 200

_OUTWARD = 1 + 1e-12
"""Bounds are rounded outward by this factor, far more than the round-off of the few operations that give them."""


@dataclass(frozen=True)
class Bounds:
    r"""The largest lengths on the states of one energy on one leaf; they hold for all times.

    Example:
        >>> top = lp.Top.heavy(inertia=(1, 2, 3), a=(0, 0, 1))
        >>> found = lp.phase_space.bounds(top, leaf={"C1": 1, "C2": 0, "C3": 0}, energy=0)
        >>> round(found.l**2, 9), round(found.omega**2, 9)  # from at most 1 of kinetic energy
        (6.0, 2.0)

    Attributes:
        l: A bound of $|\ell|$.
        alpha: A bound of $|\alpha|$.
        beta: A bound of $|\beta|$, which is constant.
        omega: A bound of the angular velocity $|\omega|$.
    """

    l: float
    alpha: float
    beta: float
    omega: float


@explains_its_arguments
def bounds(
    system: System,
    state: ArrayLike | None = None,
    *,
    leaf: Leaf | Mapping[str, float] | None = None,
    energy: float | None = None,
) -> Bounds:
    r"""Bounds that hold along every orbit of a top with these Casimirs and this energy.

    From $|\alpha|^2 = C_1 - 2\epsilon\,\ell\cdot\beta$ and $w = |\beta| = \sqrt{C_3}$,

    $$\frac{|\ell|^2}{2 I_{max}} \le E + |b|\,w + |a|\,\rho(|\ell|),\qquad
      \rho(r) = \sqrt{\max(C_1 + 2|\epsilon|\,w\,r, 0)} ,$$

    whose largest solution $|\ell|$ bounds it; the kinetic energy left over, $2(E + |b| w + |a|\rho)$, bounds
    $\omega\cdot I\omega \ge I_{min}|\omega|^2$.  Nothing like it holds for the energy alone, without Casimirs.

    Example:
        >>> top, start = lp.Top.twisted_kovalevskaya(), [1, 0, 1, 0, 0, 1, 0, 0, 1]
        >>> bounds = lp.phase_space.bounds(top, start)
        >>> spin = np.linalg.norm(lp.integrate(top, start, t_end=1000).state[0, :, :3], axis=1)
        >>> round(bounds.l, 4), round(float(spin.max()), 4)
        (4.039, 3.77)

    Args:
        system: A top: the equations decide, however the system was made.
        state: One state, shape (9,), whose leaf and energy are meant; then give nothing else.
        leaf: A leaf, also one of lower rank, which has other Casimirs than C1, C2, C3; or the values of C1, C2, C3 of
            the bracket of the top.
        energy: The energy, with `leaf`.

    Returns:
        The bounds, rounded outward.

    Raises:
        LeafError: the inequality has no solution: the energy is below the least possible one, or the values of the
            Casimirs belong to no state.
        ParameterError: the system is not a top, the arguments do not say which leaf and energy are meant, or squares
            of the numbers are too large or too small for doubles.
        ShapeError: `state` is not one state.
    """
    parameters = as_system(system).top_parameters
    if parameters is None:
        raise ParameterError(
            f"bounds are known for tops; {system.name!r} has other equations. Look at leaf.energy_range()."
        )
    field = parameters.field()
    if state is not None:
        if leaf is not None or energy is not None:
            raise ParameterError("give a state, or a leaf and an energy; not both.")
        return _bounds_of_state(system, state, field)
    if energy is None or leaf is None:
        raise ParameterError("which leaf and energy is meant must be said; give a state, or both leaf= and energy=.")
    if (casimirs := named(leaf, "leaf")) is None:
        first, w = _of_leaf(cast("Leaf", leaf), field)
        values = [float(f(cast("Leaf", leaf).state)) for f in system.functions.casimirs.values()]
        return _bounds(field, first, w, _energy_of_top(system, parameters, values, as_energy(energy)))
    if not parameters.has_bracket(system.bracket):
        raise ParameterError(
            "leaf: values of Casimirs are those of |alpha|^2 + 2 epsilon l.beta, alpha.beta and |beta|^2; "
            f"{system.name!r} has the equations of a top, but the bracket {system.bracket}. Give a Leaf, or a state."
        )
    first, w = _given(casimirs, field)
    values = [as_number(casimirs[name], name, "a finite number") for name in ("C1", "C2", "C3")]
    return _bounds(field, first, w, _energy_of_top(system, parameters, values, as_energy(energy)))


def _energy_of_top(system: System, top: TopParameters, casimirs: Sequence[float], energy: float) -> float:
    """The energy of the top where H, which may have a function of the Casimirs besides, has this value."""
    from sympy import expand

    more = expand(system.hamiltonian - top.hamiltonian(*system.bracket.fields.values()))
    if more == 0:
        return energy
    left, part = normal_form(system.bracket, more)
    if left != 0:
        raise ParameterError(
            f"energy: wanted a system whose H is the energy of the top and a polynomial in the Casimirs; "
            f"{system.name!r} has {system.hamiltonian}. Give a state."
        )
    return float(cast("Any", difference(Fraction(energy), part.value(list(map(Fraction, casimirs))))))


@np.errstate(over="ignore", invalid="ignore")
def _bounds_of_state(top: System, state: ArrayLike, field: TopField) -> Bounds:
    """The bounds by C1, |beta| and the energy of a state, also where the leaf has other Casimirs."""
    from liepoisson.leaf.leaf import Leaf

    leaf: Leaf = Leaf.through(top, as_array(state, "state", top.component_names))
    first, w = _constants(leaf, field)
    l, alpha, beta = leaf.state.reshape(3, 3)
    inertia, a, b = (np.array(v) for v in (field.inertia, field.a, field.b))
    energy = float(np.sum(l**2 / inertia) / 2 + linear.matmul(a, alpha) + linear.matmul(b, beta))
    # Outward by the round-off of the sums, so that the state itself is never outside.
    energy += _ROUND_OFF * float(
        np.sum(l**2 / inertia) + linear.matmul(np.abs(a), np.abs(alpha)) + linear.matmul(np.abs(b), np.abs(beta))
    )
    found = _bounds(field, first, w, energy)
    own = [_length(v) * _OUTWARD for v in (l, alpha, l / inertia)]
    return replace(found, l=max(found.l, own[0]), alpha=max(found.alpha, own[1]), omega=max(found.omega, own[2]))


def _constants(leaf: Leaf, field: TopField) -> tuple[float, float]:
    """C1 and |beta| of the leaf's own state, which are constant on leaves of any rank, rounded outward."""
    l, alpha, beta = leaf.state.reshape(3, 3)
    for length in map(_length, (l, alpha, beta)):
        if length and not _LEAST <= length <= _LARGEST:
            raise ParameterError(
                f"l, alpha and beta must vanish or have lengths from {_LEAST:g} to {_LARGEST:g}, for their squares to "
                f"be doubles; got {length:g}. Choose other units."
            )
    size = float(linear.matmul(alpha, alpha) + linear.matmul(2 * abs(field.epsilon) * np.abs(l), np.abs(beta)))
    first = float(linear.matmul(alpha, alpha) + linear.matmul(2 * field.epsilon * l, beta)) + _ROUND_OFF * size
    return first, _length(beta) * _OUTWARD


@np.errstate(over="ignore", invalid="ignore")
def _of_leaf(leaf: Leaf, field: TopField) -> tuple[float, float]:
    """C1 and |beta| of a leaf that a caller gives."""
    from liepoisson.leaf.leaf import Leaf

    check_kind(leaf, Leaf, "leaf", "a Leaf", "try Leaf.through(top, state)")
    parameters = leaf.system.top_parameters
    if parameters is None or parameters.field().epsilon != field.epsilon:
        raise ParameterError(
            f"leaf: wanted a leaf of a top with epsilon = {field.epsilon:g}; got {leaf!r}; try Leaf.through(top, state)"
        )
    return _constants(leaf, field)


def _length(v: Array | tuple[float, float, float]) -> float:
    """A length whose squares may vanish."""
    return float(elementary.hypot(elementary.hypot(v[0], v[1]), v[2]))


def _given(casimirs: Mapping[str, float], field: TopField) -> tuple[float, float]:
    if set(casimirs) != {"C1", "C2", "C3"}:
        raise ParameterError(
            f'leaf must be a Leaf or {{"C1": ..., "C2": ..., "C3": ...}}; got {shown(casimirs)}. For a leaf with other '
            "Casimirs give Leaf.through(top, state)."
        )
    c1, c2, c3 = (as_number(casimirs[name], name, "a finite number") for name in ("C1", "C2", "C3"))
    if not np.isfinite([c1, c2, c3]).all():
        raise ParameterError(f"the values of leaf must be finite; got {dict(casimirs)}.")
    if c3 < 0:
        raise LeafError(f"C3 = |beta|^2 must be >= 0; got {c3:g}.")
    if (field.epsilon == 0 or c3 == 0) and (c1 < 0 or c2 * c2 > c1 * c3 * _OUTWARD):
        raise LeafError(
            f"C1 = |alpha|^2 must be >= 0 and C2^2 <= C1 C3 where epsilon or beta is 0; got C1 = {c1:g}, "
            f"C2 = {c2:g}, C3 = {c3:g}."
        )
    return c1, float(np.sqrt(c3)) * _OUTWARD


@np.errstate(over="ignore", invalid="ignore")
def _bounds(top: TopField, c1: float, w: float, energy: float) -> Bounds:
    """The bounds; every l^2 is a product, which overflows to infinity where a power of a float raises an error."""
    size_a, size_b = (_length(v) for v in (top.a, top.b))
    growth = 2 * abs(top.epsilon) * w

    def rho(l: float) -> float:
        return float(np.sqrt(max(c1 + growth * l, 0.0)))

    def kinetic(l: float) -> float:
        return energy + size_b * w + size_a * rho(l)

    def excess(l: float) -> float:
        square = l / (2 * max(top.inertia)) * l
        slack = _ROUND_OFF * (square + abs(energy) + size_b * w + size_a * rho(l))
        return square - kinetic(l) - slack

    largest = _largest_root(excess, *_where_convex(max(top.inertia), size_a, growth, c1=c1, rest=energy + size_b * w))
    if largest is None:
        raise LeafError(
            f"no state of the leaf with C1 = {c1:g}, |beta| = {w:g} has an energy as low as {energy:g}: |l|^2/(2 Imax) "
            "<= E + |b||beta| + |a||alpha| has no solution. leaf.energy_range() gives the lowest one."
        )
    l = largest * _OUTWARD
    omega = float(np.sqrt(max(2 * kinetic(l), 0.0) / min(top.inertia)))
    found = Bounds(l=l, alpha=rho(l) * _OUTWARD, beta=w, omega=min(omega, l / min(top.inertia)) * _OUTWARD)
    if not np.isfinite([found.l, found.alpha, found.beta, found.omega]).all():
        raise ParameterError(
            f"the bounds must be doubles; with C1 = {c1:g}, |beta| = {w:g} and energy {energy:g} they overflow. "
            "Choose units in which these are smaller."
        )
    return found


def _where_convex(moment: float, size_a: float, growth: float, *, c1: float, rest: float) -> tuple[float, float, float]:
    r"""The least |l|, where the excess is smallest, and a point beyond its last zero.

    The excess $l^2/2I - r - |a|\sqrt{c + g l}$, a square minus a concave function, is convex for $c + g l\ge0$.  Its
    derivative vanishes where $l\sqrt{c + g l} = I|a|g/2$, whose left side grows with l.  At a zero
    $l^2/2I \le (r_+ + |a|\sqrt{c_+}) + |a|\sqrt{g l}$, at most twice the larger term.
    """
    # Where C1 < 0 the state needs |l| >= -C1/(2 |epsilon| w) to be real at all.
    least = -c1 / growth if c1 < 0 and growth > 0 else 0.0
    constant = max(rest, 0.0) + size_a * float(np.sqrt(max(c1, 0.0)))
    cubic = elementary.cbrt(4 * moment * size_a * np.sqrt(growth))
    high = 2 * max(least, 2 * float(np.sqrt(moment) * np.sqrt(constant)), float(cubic * cubic), 1e-150)
    wanted = moment * size_a * growth / 2
    lowest = _last(lambda l: l * np.sqrt(max(c1 + growth * l, 0.0)) <= wanted, least, high) if wanted > 0 else least
    return least, lowest, high


def _largest_root(excess: Callable[[float], float], least: float, lowest: float, high: float) -> float | None:
    """The largest l <= high with excess(l) <= 0, from above; None if there is none.

    Args:
        excess: A convex function.
        least: The left end of its domain.
        lowest: Where it is smallest.
        high: A point beyond its last zero.
    """
    start = min((lowest, least), key=excess)
    return _last(lambda l: excess(l) <= 0, start, high) if excess(start) <= 0 else None


def _last(holds: Callable[[float], bool], low: float, high: float) -> float:
    """The upper end, from above, of the interval from low where a condition holds, by bisection."""
    for _ in range(_BISECTIONS):
        middle = low + (high - low) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return high
