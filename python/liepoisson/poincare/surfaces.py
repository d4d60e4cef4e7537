r"""States on a surface of section, of one leaf and one energy.

A section of an energy surface on a leaf of dimension 2d has dimension 2d - 2.  Its states fulfil the equations of the
leaf, $H = E$ and $s = 0$, and are found by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import as_count, as_number, as_phase_points
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import BLOCK, checkpoint
from liepoisson.inputs.given import by_name, named
from liepoisson.inputs.refusals import check_choice, check_kind
from liepoisson.leaf._checks import as_energy
from liepoisson.leaf.leaf_in_units import unit_length
from liepoisson.leaf.leaf_projection import CONVERGED, Equations, solve
from liepoisson.leaf.leaf_search import check_energy_in_reach
from liepoisson.leaf.starts import read_state
from liepoisson.poincare.section_arguments import as_formula, check_that_it_varies
from liepoisson.portable import linear
from liepoisson.streams import Purpose, generator, seeds

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.leaf.leaf import Leaf
    from liepoisson.leaf.leaf_in_units import LeafInUnits

_ROUNDS, _VAIN = 24, 3
"""Rounds of guesses in all, and those after which the surface counts as out of reach if no guess converged."""
_GUESSES = 64
"""Guesses of a round at least; one round for each start if more are wanted."""
_PER_START, _MOST_GUESSES = 32, 20_000
"""Guesses of which spread states are chosen: for each start that is wanted, and in all."""
_FREQUENT = 1e-3
"""Independent samples of a top are cheap if at least this fraction of proposals is accepted."""
_TRY = "Try another energy or surface, or give a start."


def as_leaf(leaf: Any) -> Leaf:
    """A leaf.

    Raises:
        ParameterError: it is none.
    """
    from liepoisson.leaf.leaf import Leaf

    return check_kind(leaf, Leaf, "leaf", "a Leaf", "try Leaf.through(system, state)")


def _solved(equations: Equations, guesses: Array) -> tuple[Array, Array]:
    """What `solve` finds, a block after the other.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    found, residual = np.empty_like(guesses), np.empty(len(guesses))
    for first in range(0, len(guesses), BLOCK):
        checkpoint("looking for states on a section")
        block = slice(first, first + BLOCK)
        found[block], residual[block] = solve(equations, guesses[block])
    return found, residual


@explains_its_arguments
def section_starts(
    leaf: Leaf,
    surface: str | Expr,
    *,
    energy: float,
    n_starts: int,
    seed: int = 0,
    direction: int = 0,
    spread: bool = False,
) -> Array:
    """Random states on a leaf, an energy surface and a surface of section.

    Guesses are moved onto the section by Newton steps of minimum norm.  For a top whose energy surface can be sampled
    independently they are samples of it, with the Liouville measure; else normally distributed states of the size of
    `leaf.state`, as a Markov chain would take seconds.  The starts have no measure of their own: the first are what
    Newton's method makes of the Liouville measure, the second what it makes of a normal distribution.  Neither is the
    one that the map of first return preserves, so that averages over starts mean nothing; their orbits do.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("kovalevskaya"), {"C1": 0, "C2": 1})
        >>> starts = lp.sections.section_starts(leaf, "l3", energy=1, n_starts=5, direction=1)
        >>> lp.section(leaf.system, starts, surface="l3", t_end=100, direction=1, start_side=-1, n_crossings=10)
        <Section l3 = 0 of kovalevskaya: 50 crossings of 5 trajectories>

    Args:
        leaf: The leaf.
        surface: The function that is zero on the section.
        energy: The energy.
        n_starts: How many states.
        seed: Draws them.
        direction: +1 or -1: only states where the orbit passes the surface in this direction; 0: all.
        spread: Whether to choose states far from each other, for a figure of the whole section: of 32 n normally
            distributed guesses (20 000 at most) those that converge, and of these the first, then always the one that
            is farthest from all before.

    Returns:
        States, shape (n, N).

    Raises:
        LeafError: the leaf does not reach this energy, or too few guesses converged, of at most 24 rounds of
            max(n, 64); the message says which share did.
        ParameterError: the energy is no finite number, the surface is a constant of motion, the direction is none, or n
            or seed is no whole number.
    """
    from liepoisson.leaf.leaf import are_on

    n_starts, seed = as_count(n_starts, "n_starts"), as_count(seed, "seed")
    check_choice(direction, "direction", (-1, 0, 1))
    check_that_it_varies(as_leaf(leaf).system, as_formula(surface, "surface"))
    leaf, energy = _in_motion(leaf, energy)
    view = leaf.in_units(energy)
    if spread:
        guesses = _many_guesses(view, n_starts, seed)
        found = _crossed(view, surface, energy, guesses, direction)
        found = found[are_on(leaf, found * view.units, energy)]
        if len(found) >= n_starts:
            return _farthest(found, n_starts) * view.units
        if not len(found):
            check_energy_in_reach(leaf, energy)
            raise LeafError(
                f"orbits of this leaf and energy must cross {surface} = 0; none of {len(guesses)} random states "
                f"could be moved to a crossing. {_TRY}"
            )
    equations = view.constraints(energy, surface)
    draw, size = _guesses_for(leaf, view, energy), max(n_starts, _GUESSES)
    found, converged, drawn = np.empty((0, leaf.system.bracket.dimension)), 0, 0
    for attempt in range(_ROUNDS):
        states, residual = _solved(equations, draw(seeds(seed, Purpose.SECTION, attempt), size))
        states = states[residual <= CONVERGED]
        states = states[are_on(leaf, states * view.units, energy)]
        converged, drawn = converged + len(states), drawn + size
        if direction:
            states = states[direction * _rates(view, surface, states) > 0]
        found = np.concatenate([found, states])
        if len(found) >= n_starts:
            return found[:n_starts] * view.units
        if attempt + 1 >= _VAIN and not converged:
            break
    passing = f", {len(found)} of them where the orbit passes in direction {direction:+d}" if direction else ""
    if not converged:
        check_energy_in_reach(leaf, energy)
    raise LeafError(
        f"{n_starts} states with {surface} = 0 and energy {energy + leaf.still_energy:.6g} were wanted on {leaf!r}; "
        f"Newton's method converged from {converged} of {drawn} guesses, {100 * converged / drawn:.2g} %{passing}. "
        f"{_TRY}"
    )


def _in_motion(leaf: Leaf, energy: float) -> tuple[Leaf, float]:
    """A leaf and an energy without what in H is a function of the Casimirs."""
    value = as_energy(energy)
    return as_leaf(leaf).moving, leaf.moving_energy(value)


def _rates(leaf: LeafInUnits, surface: str | Expr, states: Array) -> Array:
    """The rates of the surface function, of states in units."""
    slope = leaf.source.functions.of(surface)
    x = states * leaf.units
    return linear.einsum("...i,...i->...", slope.gradient(x), leaf.source.vector_field(x))


def _many_guesses(leaf: LeafInUnits, n: int, seed: int) -> Array:
    """Normally distributed states of the size of the leaf's own."""
    from liepoisson.numeric.sampling import sample_states

    size = np.abs(leaf.state).max() or 1.0
    return size * sample_states(leaf.source, min(_PER_START * n, _MOST_GUESSES), seed=seed, ensemble="gaussian")


@np.errstate(all="ignore")  # a surface may not exist everywhere, as that of a square root
def _crossed(leaf: LeafInUnits, surface: str | Expr, energy: float, guesses: Array, direction: int) -> Array:
    """The guesses that converge to states where the orbit passes the surface, in the wanted direction."""
    x, residual = solve(leaf.constraints(energy, surface), guesses)
    rate = _rates(leaf, surface, x)
    return x[(residual <= CONVERGED) & ((direction * rate > 0) if direction else (rate != 0))]


def _farthest(x: Array, n: int) -> Array:
    """The first state, then n - 1 times the one that is farthest from all that are taken."""
    taken, distance = [0], linear.norm(x - x[0], axis=1)
    for _ in range(n - 1):
        taken.append(int(np.argmax(distance)))
        distance = np.minimum(distance, linear.norm(x - x[taken[-1]], axis=1))
    return x[taken]


def _guesses_for(leaf: Leaf, view: LeafInUnits, energy: float) -> Callable[[np.random.SeedSequence, int], Array]:
    """How to draw guesses: from the energy surface where that is cheap, else anywhere."""
    from liepoisson.leaf.leaf_sampling import acceptance

    try:
        is_cheap = acceptance(leaf, energy=energy) >= _FREQUENT
    except LeafError:  # not the leaf of a top
        is_cheap = False
    if is_cheap:
        return lambda stream, n: (
            leaf.sample(n, seed=int(stream.generate_state(1, np.uint64)[0]), energy=energy) / view.units
        )
    n_components = len(view.state)
    size = (float(linear.norm(view.state)) + unit_length(leaf.system.bracket)) / np.sqrt(n_components) or 1.0
    return lambda stream, n: size * generator(stream).standard_normal((n, n_components))


@explains_its_arguments
def section_state(
    leaf: Leaf,
    surface: str | Expr,
    energy: float,
    coordinates: Mapping[str, float],
    *,
    guess: ArrayLike | Mapping[str, Any] | None = None,
) -> Array:
    """The state of a section with given values of some coordinates.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("henon-heiles"), {})
        >>> state = lp.sections.section_state(leaf, "x", 0.125, {"y": 0, "p_y": 0})
        >>> round(float(state[2]), 9)  # p_x, from H = 1/8
        0.5

    Args:
        leaf: The leaf.
        surface: The function that is zero on the section.
        energy: The energy.
        coordinates: Values of functions of the state, such as `{"l3": 0.2, "dot(l, beta)": 0.1}`; as many as the
            section has dimensions determine the state up to finitely many, fewer leave the rest near the guess.
        guess: Where Newton's method starts, shape (N,), or some components by name; it decides between several
            solutions.  By default a state of the leaf, then random ones (the same in every call).

    Returns:
        The state, shape (N,).

    Raises:
        LeafError: no such state was found.
        ParameterError: the energy or a coordinate is no finite number, or the surface is a constant of motion.
    """
    from liepoisson.leaf.leaf import are_on

    check_that_it_varies(as_leaf(leaf).system, as_formula(surface, "surface"))
    leaf, energy = _in_motion(leaf, energy)
    view = leaf.in_units(energy)
    functions, equations = view.system.functions, view.constraints(energy, surface)
    given = by_name(coordinates, "coordinates", "values of functions of the state", '{"l3": 0.2}')
    values = {name: as_number(value, f"coordinates {name}", "a finite number") for name, value in given.items()}
    for name, value in values.items():
        if not np.isfinite(value):
            raise ParameterError(f"coordinates must be finite; got {name} = {value}.")
        equations = equations.with_function(functions.of(name), value)
    guesses = _guesses(view, guess)
    states, residual = solve(equations, guesses.copy())
    good = np.flatnonzero((residual <= CONVERGED) & are_on(leaf, states * view.units, energy))
    if not good.size:
        check_energy_in_reach(leaf, energy)
        raise LeafError(
            f"a state with {_shown(values)}, {surface} = 0 and energy {energy + leaf.still_energy:.6g} was wanted on "
            f"{leaf!r}; the least residual reached from {len(guesses)} {'guess' if len(guesses) == 1 else 'guesses'} "
            f"is {np.nanmin(residual):.1e}. Try other values, or a guess near the state."
        )
    return states[good[0]] * view.units


def _guesses(leaf: LeafInUnits, guess: ArrayLike | Mapping[str, Any] | None) -> Array:
    if guess is not None and named(guess, "guess") is not None:
        return read_state(leaf.source, guess, "guess")[None] / leaf.units
    if guess is not None:
        near, bracket = cast("ArrayLike", guess), leaf.system.bracket
        return np.atleast_2d(as_phase_points(near, bracket.coordinate_names_in_order, bracket.field_names)) / leaf.units
    n = len(leaf.state)
    size = max(1.0, float(np.abs(leaf.state).max()))
    random = generator(np.random.SeedSequence(int(Purpose.SECTION))).standard_normal((_GUESSES, n))
    return np.concatenate([leaf.state[None], size * random])


def _shown(coordinates: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in coordinates.items()) or "no coordinate given"
