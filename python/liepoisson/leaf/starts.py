"""Where orbits begin: a state that is given, or a guess moved onto a leaf and an energy, or a random state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import LeafError, ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_number, as_seed
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.given import is_data_set, is_named, named
from liepoisson.leaf._checks import as_energy, as_system, by_name, example_of_values
from liepoisson.leaf.leaf import Leaf
from liepoisson.leaf.leaf_in_units import unit_groups
from liepoisson.leaf.leaf_projection import Equations
from liepoisson.numeric.starts import states_by_name
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

MATCH = 1e-10
"""Relative violation of a leaf or an energy below which a given start counts as lying there.

Round-off of decimal numbers with twelve digits stays below it.
"""
_GUESSES = 8
"""Random guesses that are tried before a leaf or an energy is given up."""


@explains_its_methods
@dataclass(frozen=True, repr=False, eq=False)
class Start(ReadOnlyArrays):
    """A state with its leaf and energy, and how it was found.

    Example:
        >>> top = lp.Top.kovalevskaya()
        >>> start = lp.phase_space.find_start(top, start={"l": (1, 0, 1), "alpha3": 1})
        >>> start.energy, start.leaf.casimirs["l.alpha"], start.origin
        (0.75, 1.0, 'as given')

    Attributes:
        state: Shape (component,).
        leaf: The symplectic leaf through it.
        energy: Value of the Hamiltonian there.
        origin: How it was found, in words.
    """

    state: Array
    leaf: Leaf
    energy: float
    origin: str

    def __repr__(self) -> str:
        return f"<Start, {self.origin}: H = {self.energy:.6g} on {self.leaf!r}>"


@explains_its_arguments
def find_start(
    system: System,
    *,
    start: ArrayLike | Mapping[str, Any] | None = None,
    guess: ArrayLike | Mapping[str, Any] | None = None,
    leaf: Leaf | Mapping[str, float | str] | None = None,
    energy: float | str | None = None,
    seed: int = 0,
) -> Start:
    r"""A state on a leaf and at an energy: one that is given, or moved there, or random.

    A given `start` is never moved: it must lie on the leaf and at the energy asked for.  A `guess` is moved there by
    Newton steps of minimum norm.  Without both, the guess is trajectory 0 of `sample_states(system, ..., seed=seed)`,
    or the first trajectory that can be moved.

    Example:
        >>> start = lp.phase_space.find_start(lp.Top.kovalevskaya(), leaf={"C1": 1, "C2": 0}, energy=1)
        >>> round(start.energy, 12)
        1.0

    Args:
        system: A system whose parameters are all numbers.
        start: The state: all components, or some vectors and components by name, the others being zero, as in
            `{"l": (1, 0, 0), "beta3": "1/3"}`.
        guess: A state near the one that is wanted, likewise.
        leaf: A leaf, or values of Casimirs by name or formula, `{"C1": 1}` or `{"l.alpha": 0.2}`; those that are not
            named keep the values of the guess.
        energy: Value of the Hamiltonian; by default that of the start or, on another leaf, any.
        seed: Draws the random state.

    Returns:
        The state with its leaf and energy.

    Raises:
        ParameterError: arguments that contradict each other or cannot be read.
        ShapeError: a state has not as many numbers as the system has components.
        LeafError: no real state has these Casimirs and this energy, or the given start does not.
    """
    return find(system, start=start, guess=guess, leaf=leaf, energy=energy, seed=seed)


@np.errstate(all="ignore")  # a start that is too large for doubles ends with its outcome
def find(
    system: System,
    *,
    start: ArrayLike | Mapping[str, Any] | None,
    guess: ArrayLike | Mapping[str, Any] | None,
    leaf: Leaf | Mapping[str, float | str] | None,
    energy: float | str | None,
    seed: int,
    prefix: str = "",
) -> Start:
    """`find_start`, with "--" before the names of the arguments in messages where they are options."""
    as_system(system)
    seed = as_seed(seed)
    wanted = leaf if isinstance(leaf, Leaf) else _read_values(system, leaf, prefix) if leaf is not None else None
    value = None if energy is None else as_energy(energy, f"{prefix}energy")
    if start is not None and guess is not None:
        raise ParameterError(
            f"{prefix}start and {prefix}guess exclude each other: a start stays where it is, a guess is moved."
        )
    if guess is not None and not wanted and value is None:
        raise ParameterError(
            f"{prefix}guess must come with {prefix}leaf or {prefix}energy, onto which it is moved. Or write "
            f"{prefix}start."
        )
    try:
        if start is not None:
            return _given(system, read_state(system, start, f"{prefix}start"), wanted, value, prefix)
        if guess is not None:
            x = read_state(system, guess, f"{prefix}guess")
            return _moved(_leaf(system, x, wanted), x, value, "the guess")
        return _random(system, wanted, value, seed)
    except LeafError as error:  # advice of `Leaf`
        words = f"{prefix}start STATE, without {prefix}leaf" if prefix else "find_start(system, start=state)"
        raise LeafError(str(error).replace("Leaf.through(system, state)", words)) from error


def _read_values(system: System, leaf: Mapping[str, float | str], prefix: str) -> dict[str, float]:
    if (given := named(leaf, f"{prefix}leaf")) is None:
        example = example_of_values(f"{prefix}leaf", tuple(system.functions.casimirs))
        raise ParameterError(f"{prefix}leaf must be a Leaf or values of Casimirs; got {leaf!r:.60}. {example}")
    casimirs = by_name(system, given, f"{prefix}leaf")
    values = {name: as_number(value, f"{prefix}leaf {name}", "a finite number") for name, value in casimirs.items()}
    if not np.isfinite(list(values.values())).all():
        raise ParameterError(f"{prefix}leaf must have finite numbers; got {values}.")
    return values


def _given(system: System, x: Array, wanted: Leaf | Mapping[str, float] | None, energy: float | None, p: str) -> Start:
    aims = {} if isinstance(wanted, Leaf) or wanted is None else wanted
    asked = {name: (aim, system.functions.casimirs[name]) for name, aim in aims.items()}
    if energy is not None:
        asked["H"] = (energy, system.functions.energy)
    wrong = [
        f"{name} = {float(f(x)):.12g} instead of {aim:.12g}"
        for name, (aim, f) in asked.items()
        if not _violation(system, f, aim, x) <= MATCH
    ]
    if isinstance(wanted, Leaf) and not wanted.residual(x) <= MATCH:
        wrong.insert(0, f"a relative residual of {float(wanted.residual(x)):.1e} on {wanted!r}")
    if wrong:
        raise LeafError(
            f"{p}start must lie on the leaf and at the energy asked for; it has {', '.join(wrong)}. "
            f"Write {p}guess instead of {p}start to have it moved there."
        )
    return _start_at(system, x, "as given")


def _violation(system: System, function: PhaseFunction, value: float, x: Array) -> float:
    """How far a function is from a value, relative to the sizes of the fields and its slopes."""
    groups, none = unit_groups(system.bracket), np.zeros((0, len(x)))
    return float(Equations(none, (function,), np.array([value]), np.eye(1), groups).residual(x))


def _random(system: System, wanted: Leaf | Mapping[str, float] | None, energy: float | None, seed: int) -> Start:
    """On the leaf of trajectory 0 of unit vectors, with the wanted values; from the first one that can be moved."""
    from liepoisson.numeric.sampling import sample_states

    members = sample_states(system, _GUESSES, seed=seed)
    if not wanted and energy is None:
        return _start_at(system, members[0], f"trajectory 0 of unit-vectors, seed {seed}")
    leaf, failure = _leaf(system, members[0], wanted), None
    # In units in which states of the leaf are of order one, and of their length if that leads nowhere.
    view = leaf.in_units(energy)
    length = float(linear.norm(view.state)) / float(linear.norm(members[0])) or 1.0
    for k, size in ((k, size) for size in (1.0, length) for k in range(_GUESSES)):
        try:
            guess = members[k] * view.units * size
            return _moved(leaf, guess, energy, f"member {k} of unit-vectors, seed {seed}")
        except LeafError as error:
            failure = failure or error
    assert failure is not None
    raise failure


def _start_at(system: System, x: Array, origin: str) -> Start:
    return Start(x, Leaf.through(system, x), float(system.functions.energy(x)), origin)


def _leaf(system: System, x: Array, wanted: Leaf | Mapping[str, float] | None) -> Leaf:
    """The leaf of x, with other values for some Casimirs."""
    if isinstance(wanted, Leaf):
        return wanted
    if not wanted:
        return Leaf.through(system, x)
    own = {name: float(casimir(x)) for name, casimir in system.functions.casimirs.items()}
    return Leaf(system, own | dict(wanted))


def _moved(leaf: Leaf, x: Array, energy: float | None, guess: str) -> Start:
    reached = leaf.project(x, energy=energy)
    origin = f"{guess}, moved by {linear.norm(reached - x):.3g}"
    return Start(reached, leaf, float(leaf.system.functions.energy(reached)), origin)


def read_state(system: System, given: ArrayLike | Mapping[str, Any], what: str = "start") -> Array:
    """A state from all its components, or from vectors and components by name.

    Raises:
        ParameterError: a name is none of them, or a component is given twice.
        ShapeError: a vector or the state has another number of components.
    """
    names = system.component_names
    example = f"{what} {names[0]}=1" if what.startswith("--") else f'{what}={{"{names[0]}": 1}}'
    if (values := named(given, what)) is None:
        x = as_array(cast("Any", given), what, names)
        if x.shape != (len(names),):
            raise ShapeError(
                f"{what} must have {len(names)} numbers ({_listed(names)}); got "
                f"{len(x) if x.ndim == 1 else f'shape {x.shape}'}. Or give some by name: {example}."
            )
        return _finite(x, what)
    return _finite(
        states_by_name(system, values, what, one=True, whole=not is_named(given) or is_data_set(given)), what
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names if len(names) <= 9 else (*names[:6], "...", *names[-3:]))


def _finite(values: Array, what: str) -> Array:
    if not np.isfinite(values).all():
        raise ParameterError(f"{what} must have finite numbers; got {values}.")
    return values
