"""States with given Casimirs, and the lowest and the highest energy on a leaf, from many random starts."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.algebra.rational_polynomials import powers_of
from liepoisson.errors import LeafError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.deadline import checkpoint
from liepoisson.leaf._checks import formulas
from liepoisson.leaf.leaf_in_units import LeafInUnits, equations_in_units, scaling, unit_length
from liepoisson.leaf.leaf_projection import CONVERGED, Equations, solve
from liepoisson.leaf.leaf_stratum import Place, place_of
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.portable import elementary, linear
from liepoisson.streams import Random, generator

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

_STARTS, _STEPS, _HALVINGS, _FAR_STEPS, _OUTWARD_STEPS = 64, 100, 30, 30, 4
_FAR = 1e4
"""A descent that comes this many times further from the origin than the leaf's own state is taken as unbounded."""

_DEEP = 1e9
"""So is one that comes this many times deeper than the median of |H| at its starts, as in a well like -1/r."""

_NEWTON = 8
"""Newton steps back onto the leaf after a step of a descent; one that needs more was too long, and is halved."""

_STRETCH = 3.0
"""A step of a descent is at most this many times as long as the state."""

_OF_SQUARES = 1e-9
"""Largest relative error of a Casimir that is a sum of squares."""

_ROUND_OFF = 1e-12
"""An energy that is out of reach by this fraction of the scale of energies is that of the extremum."""

_SECONDS = 5.0
"""Processor time for each end of the range."""


def _asked(system: System, place: Place, values: Array) -> str:
    """The values of Casimirs with the formulas of these, which take SymPy to write."""
    texts = dict(zip(system.functions.casimirs, formulas(system), strict=True))
    return ", ".join(f"{texts.get(name, name)} = {x:g}" for name, x in zip(place.casimirs, values, strict=True))


def find_state(system: System, place: Place, values: Array) -> Array:
    """A state of the open stratum with these values of the Casimirs, by Newton's method from random states.

    Raises:
        LeafError: none was found.
    """
    _refuse_impossible(system, place, values)
    equations = Equations(place.pinned, tuple(place.casimirs.values()), values, np.eye(len(values)))
    rng, units = generator(0), scaling(system, place.casimirs, values)
    n, size = system.bracket.dimension, max(1.0, float(np.abs(values).max(initial=0.0)) ** 0.5)
    size = 1.0 if (units != 1.0).any() else size
    starts = rng.standard_normal((_STARTS, n)) * elementary.geomspace(0.1, 10.0, _STARTS)[:, None] * size
    found, residual = solve(equations_in_units(equations, units, system.bracket), starts)
    found = found[residual <= CONVERGED] * units
    reached = found[_has_squares(system, place, values, found)]
    if not len(reached):
        reached = _states_of_top(system, values, rng)
    if not len(reached):
        raise LeafError(
            f"no state of {system.name!r} with {_asked(system, place, values)} was found: Newton's method from "
            f"{_STARTS} random states leaves a relative residual of {residual.min():.1e}. Values of a state: "
            "system.functions.casimirs."
        )
    for state in reached[np.argsort(linear.norm(reached / units, axis=-1))]:
        if place_of(system, state).is_open:
            return state
    raise LeafError(
        f"{_asked(system, place, values)} are attained only where, to the accuracy of doubles, the rank of J is lower "
        f"({place_of(system, reached[0]).stratum}), and do not determine a leaf there. Give a state: "
        "Leaf.through(system, state)."
    )


def _has_squares(system: System, place: Place, values: Array, states: Array) -> Any:
    """Which states have the wanted sums of squares: in these nothing cancels, so they are right to their own size."""
    right: Any = np.ones(len(states), dtype=bool)
    for function, value in zip(place.casimirs.values(), values, strict=True):
        if _is_sum_of_squares(function):
            right &= np.abs(function(states) - value) <= _OF_SQUARES * value
    return right


@np.errstate(all="ignore")  # what overflows is no state
def _states_of_top(system: System, values: Array, rng: Random) -> Array:
    r"""States of a top by the formulas of its leaves, shape (state, 9): none for other systems.

    With $\beta = wn$: $\alpha_\parallel = C_2/w$, and $\ell_\parallel = (C_1 - |\alpha|^2)/(2\epsilon w)$, or for
    $\epsilon = 0$ the length of $\alpha$ is given.  Newton's method from states of unit size does not reach values
    that are of other orders of magnitude.
    """
    top = system.top_parameters
    if top is None or not top.has_bracket(system.bracket):
        return np.zeros((0, 9))
    c1, c2, c3 = values
    axes = linear.qr(rng.standard_normal((3, 3)))[0]
    w, epsilon = float(np.sqrt(c3)), float(top.epsilon)
    along = c2 / w
    size = max(float(np.sqrt(abs(c1))), abs(along)) or w
    across = size if epsilon else float(np.sqrt(c1 - along**2))
    l = np.full(3, size)
    if epsilon:
        l[0] = (c1 - along**2 - across**2) / (2 * epsilon) / w
    state = np.concatenate(
        [linear.matmul(axes, l), linear.matmul(axes, [along, across, 0.0]), linear.matmul(axes, [w, 0.0, 0.0])]
    )
    return state[None] if np.isfinite(state).all() else np.zeros((0, 9))


def representative(leaf: Leaf) -> Leaf:
    """The leaf with a state that depends on the values of the Casimirs alone, where one can be found from them."""
    if not leaf.is_regular:
        return leaf
    try:
        found = type(leaf)(leaf.system, leaf.casimirs)
    except LeafError:
        return leaf
    found.still_energy = leaf.still_energy
    return found


def _refuse_impossible(system: System, place: Place, values: Array) -> None:
    """Refuse a negative sum of squares, and values that violate the inequality of Cauchy and Schwarz."""
    for (name, function), value in zip(place.casimirs.items(), values, strict=True):
        if value < 0 and _is_sum_of_squares(function):
            raise LeafError(
                f"{name} = {function.expression} is a sum of squares; {value:g} was asked for. Make it "
                "positive, or give a state: Leaf.through(system, state)."
            )
    top = system.top_parameters
    if top is None or not top.has_bracket(system.bracket):
        return
    if top.epsilon == 0:
        first, mixed, last = values
        if mixed**2 >= first * last:
            raise LeafError(
                f"C2^2 = (alpha.beta)^2 must be smaller than C1 C3 = |alpha|^2 |beta|^2 where alpha x beta != 0; got "
                f"{mixed**2:g} and {first * last:g}. For parallel vectors give a state: Leaf.through(system, state)."
            )
    elif values[2] == 0:
        raise LeafError(
            "C3 = |beta|^2 must be positive where beta != 0; got 0. The leaves with beta = 0 have other Casimirs: "
            "give a state, Leaf.through(system, state)."
        )


def _is_sum_of_squares(function: PhaseFunction) -> bool:
    if function.polynomial is not None:
        terms = powers_of(function.polynomial, function.n_coordinates)
        return all(c > 0 and all(power % 2 == 0 for power in powers) for powers, c in terms)
    from sympy import Poly

    expression: Any = function.expression
    variables = function.variables
    polynomial = Poly(expression, *variables) if expression.is_polynomial(*variables) else None
    if polynomial is None:
        return False
    return all(c.is_number and c > 0 and all(e % 2 == 0 for e in m) for m, c in polynomial.terms())


@np.errstate(all="ignore")  # H may overflow far out
def energy_range(leaf: Leaf) -> tuple[float, float]:
    """The lowest and the highest energy on a leaf, -inf and inf if it is unbounded."""
    view = leaf.in_units()
    if not leaf.rank:
        with np.errstate(all="ignore"):
            energy = float(leaf.system.functions.energy(leaf.state))
        if not np.isfinite(energy):
            raise LeafError(f"{leaf!r} is a point, and the energy is not defined at it: {energy}. Take another state.")
        return energy, energy
    lowest, highest = (sign * (-np.inf if _grows(view, sign) else _lowest(view, sign)) for sign in (1.0, -1.0))
    return float(lowest), float(highest)


def check_energy_in_reach(leaf: Leaf, energy: float, *, is_filled: bool = False) -> None:
    """Refuses an energy that no state of the leaf has; with `is_filled`, only one below all.

    Raises:
        LeafError: it is out of reach.
    """
    leaf, energy = leaf.moving, leaf.moving_energy(energy)
    lowest, highest = leaf.energy_range()
    slack = _ROUND_OFF * energy_scale(leaf.in_units(), lowest) if np.isfinite(lowest) else 0.0
    if energy < lowest - slack or (not is_filled and energy > highest + slack):
        lowest, highest, energy = (value + leaf.still_energy for value in (lowest, highest, energy))
        asked = f"{'at most ' if is_filled else ''}{energy:.6g}"
        raise LeafError(
            f"states on {leaf!r} were wanted. On this leaf the energy lies between {lowest:.6g} and {highest:.6g}; "
            f"{asked} was asked for."
        )


def energy_scale(leaf: LeafInUnits, energy: float = 0.0) -> float:
    r"""What differences of energies are compared with: $|E| + |y||\nabla H|$ at the leaf's own state.

    Where this vanishes, the second order takes its place.
    """
    y, function = leaf.state, leaf.system.functions.energy
    length = float(linear.norm(y)) + unit_length(leaf.system.bracket)
    scale = abs(energy) + length * float(linear.norm(function.gradient(y)))
    return scale or length**2 * float(linear.norm(function.hessian(y)))


def _grows(leaf: LeafInUnits, sign: float) -> bool:
    """Whether sign * H decreases tenfold and more, below zero, between states 1e2 and 1e4 times as far as its own.

    The farther ones come from the nearer ones in steps: few guesses so far out lead onto the leaf.
    """
    energy = leaf.system.functions.energy
    states = _spread(leaf, 1e2, 1e2, most_steps=_FAR_STEPS)
    near = float(np.nanmin(sign * energy(states), initial=np.inf))
    farther = elementary.power(1e2, 1 / _OUTWARD_STEPS)
    for _ in range(_OUTWARD_STEPS):
        states, residual = solve(leaf.equations, states * farther, most_steps=_FAR_STEPS)
        states = states[residual <= CONVERGED]
    return float(np.nanmin(sign * energy(states), initial=np.inf)) < 10 * near < 0


def _lowest(leaf: LeafInUnits, sign: float) -> float:
    """The minimum of sign * H, by Newton steps in tangent coordinates with the moduli of the eigenvalues."""
    x, lowest = _starts(leaf, sign)
    far = _FAR * (float(linear.norm(leaf.state)) + unit_length(leaf.system.bracket))
    deep = _DEEP * (float(np.median(np.abs(lowest))) or np.inf)
    active, start = np.arange(len(x)), time.process_time()
    for _ in range(_STEPS):
        checkpoint("the range of the energy")
        moved, reached = _descend(leaf, x[active], lowest[active], sign)
        gain = lowest[active] - reached
        x[active], lowest[active] = moved, reached
        if np.any(linear.norm(x, axis=-1) > far) or lowest.min() < -deep:
            return -np.inf
        active = active[gain > 1e-14 * np.abs(reached)]
        if not active.size or time.process_time() - start > _SECONDS:
            break
    return float(lowest.min())


@np.errstate(all="ignore")
def _starts(leaf: LeafInUnits, sign: float) -> tuple[Array, Array]:
    """States to descend from and their sign * H, where the energy is defined."""
    x = _spread(leaf, 0.1, 3.0)
    values = sign * leaf.system.functions.energy(x)
    defined = np.isfinite(values)
    if not defined.any():
        raise LeafError(f"the energy is not defined at any of {len(x)} states of {leaf!r}. Take another leaf.")
    return x[defined], values[defined]


def _spread(leaf: LeafInUnits, nearest: float, farthest: float, *, most_steps: int = 80) -> Array:
    """Random states on the leaf, at several distances from its own."""
    rng = generator(1)
    size = float(linear.norm(leaf.state)) + unit_length(leaf.system.bracket)
    noise = (
        rng.standard_normal((_STARTS, len(leaf.state)))
        * elementary.geomspace(nearest, farthest, _STARTS)[:, None]
        * size
    )
    found, residual = solve(leaf.equations, leaf.state + noise, most_steps=most_steps)
    return np.concatenate([leaf.state[None], found[residual <= CONVERGED]])


def _descend(leaf: LeafInUnits, x: Array, before: Array, sign: float) -> tuple[Array, Array]:
    """One damped Newton step of each state, projected back onto the leaf, and the energies after it."""
    energy = leaf.system.functions.energy
    basis, stays = _tangents(leaf, x)
    slope, curvature = reduced_derivatives(leaf, x, basis)
    values, vectors = linear.eigh(sign * curvature)
    moduli = np.maximum(np.abs(values), 1e-8 * np.abs(values).max(axis=-1, keepdims=True) + 1e-300)
    along = linear.einsum("...ji,...j->...i", vectors, sign * slope) / moduli
    step = -linear.einsum("...ij,...j->...i", linear.matmul(basis, vectors), along)
    step[stays] = 0.0
    length, size = (linear.norm(v, axis=-1, keepdims=True) for v in (step, x))
    size = size + unit_length(leaf.system.bracket)
    step *= np.minimum(1.0, _STRETCH * size / np.maximum(length, 1e-300))
    best, reached = x.copy(), before.copy()
    left = np.arange(len(x))
    for halvings in range(_HALVINGS):
        trial, residual = solve(leaf.equations, x[left] + step[left] * 0.5**halvings, most_steps=_NEWTON)
        energies = sign * energy(trial)
        good = (residual <= CONVERGED) & (energies < before[left])
        best[left[good]], reached[left[good]] = trial[good], energies[good]
        left = left[~good]
        if not left.size:
            break
    return best, reached


def _tangents(leaf: LeafInUnits, x: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Bases of the tangent spaces, and which states came to the edge of the leaf, where J has a lower rank."""
    vectors, sizes, _ = linear.svd(leaf.system.functions.poisson_tensor(x))
    return vectors[..., : leaf.rank], ~(sizes[..., leaf.rank - 1] > 0)


def reduced_derivatives(leaf: LeafInUnits, x: Array, basis: Array) -> tuple[Array, Array]:
    r"""Gradient $T^t\nabla H$ and second derivative $T^t(H'' - \lambda C'')T$ of H on the leaf in a tangent basis T.

    The multipliers $\lambda$ solve $\nabla H = \lambda\nabla C$ by least squares; linear equations do not curve.
    """
    energy, equations = leaf.system.functions.energy, leaf.equations
    gradient, hessian = energy.gradient(x), energy.hessian(x)
    rows = equations.rows(x)
    lengths = linear.norm(rows, axis=-1, keepdims=True)  # a Casimir is in units of its own, such as 1e-20
    unit_rows = np.divide(rows, lengths, out=np.zeros_like(rows), where=lengths > 0)
    weights = linear.einsum("...ij,...i->...j", linear.pinv(unit_rows), gradient)
    multipliers = np.divide(weights, lengths[..., 0], out=np.zeros_like(weights), where=lengths[..., 0] > 0)
    multipliers = multipliers[..., len(equations.pinned) :]
    weights = linear.matmul(multipliers, equations.mixing)
    for k, function in enumerate(equations.functions):
        hessian = hessian - weights[..., k, None, None] * function.hessian(x)
    transposed = np.swapaxes(basis, -1, -2)
    return linear.einsum("...ij,...j->...i", transposed, gradient), linear.matmul(
        linear.matmul(transposed, hessian), basis
    )
