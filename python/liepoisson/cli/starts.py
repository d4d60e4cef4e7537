"""Where the orbits of a command begin: a state that is given, or a guess moved onto a leaf and an energy."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.cli.options import Where
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_double
from liepoisson.inputs.refusals import NO_BRACKET

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.leaf.starts import Start
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField

_MOST_SHOWN = 60
_MOST_STARTS = 2**31
_COMMAS = re.compile(r",(?![^(]*\))")
"""Those that separate assignments, and not the arguments of a function."""
_BEFORE_A_NAME = re.compile(r",(?=[^,=]+=)")
"""Those that separate assignments, and not the components of a vector."""


@dataclass(frozen=True)
class PlainStart:
    """A start of a vector field: it lies on no leaf and has no energy."""

    state: Array  # shape (component,)
    origin: str  # how it was found, in words


def start_of(system: System | VectorField, where: Where, seed: int = 0) -> Start | PlainStart:
    """The start that the options ask for, of a system with its leaf."""
    from liepoisson.model.vector_field import VectorField

    return _plain_start(system, where, seed) if isinstance(system, VectorField) else find_start(system, where, seed)


def _plain_start(field: VectorField, where: Where, seed: int) -> PlainStart:
    from liepoisson.numeric.sampling import sample_states
    from liepoisson.numeric.starts import as_starts

    for option, given in (("guess", where.guess), ("leaf", where.leaf), ("energy", where.energy)):
        if given:
            raise ParameterError(f"--{option} is for systems with a bracket; {NO_BRACKET}. Give the state by --start.")
    given: Any = state_of(where.start or (), "--start", field.component_names[0])
    if given is None:
        return PlainStart(sample_states(field, 1, seed=seed)[0], f"trajectory 0 of unit-vectors, seed {seed}")
    if isinstance(given, dict):
        given = {name: value[0] if len(value) == 1 else value for name, value in given.items()}
    return PlainStart(as_starts(field, given, len(field.component_names))[0], "as given")


def find_start(system: System, where: Where, seed: int = 0) -> Start:
    """The start that the options ask for, as `liepoisson.phase_space.find_start` finds it."""
    from liepoisson.leaf.starts import find

    component = system.component_names[0]
    return find(
        system,
        start=state_of(where.start or (), "--start", component),
        guess=state_of(where.guess or (), "--guess", component),
        leaf=assignments(split_at_commas(where.leaf), "--leaf", "--leaf C1=1,C2=0", "Casimir") if where.leaf else None,
        energy=where.energy,
        seed=seed,
        prefix="--",
    )


def seed_of_start(where: Where, seed: int | None) -> int:
    """The seed of a command that draws nothing but its start; refused beside a start that is given."""
    if seed is not None and where.start:
        raise ParameterError("--seed and --start exclude each other: nothing is drawn at random. Leave --seed out.")
    return 0 if seed is None else seed


@dataclass(frozen=True)
class Starts:
    """Where the orbits of a command begin."""

    states: Array  # shape (trajectory, component)
    words: str  # what they are: "64 random starts (unit-vectors, seed 0)"
    begin: Start | PlainStart | None  # whose leaf and energy they share; None if they are spread over phase space

    def lines(self, system: System | VectorField) -> list[str]:
        """What the commands print about them before the run."""
        if self.begin is None:
            return []
        return (start_lines if len(self.states) == 1 else leaf_lines)(system, self.begin)


def find_starts(
    system: System | VectorField,
    where: Where,
    *,
    starts: int | None,
    default: int,
    ensemble: str | None = None,
    seed: int = 0,
) -> Starts:
    """One orbit with --start; with --guess, --leaf or --energy random starts there; else those of an ensemble."""
    if starts is not None and where.start:
        raise ParameterError("--starts and --start exclude each other: with --start there is one orbit. Or --guess.")
    n = default if starts is None else starts
    if not 1 <= n <= _MOST_STARTS:
        raise ParameterError(f"--starts must be from 1 to {_MOST_STARTS}; got {n}. Try {default}.")
    if not where.is_given:
        from liepoisson.numeric.sampling import sample_states

        drawn = ensemble or "unit-vectors"
        states = sample_states(system, n, seed=seed, ensemble=drawn)
        return Starts(states, f"{n} random start{'s' if n > 1 else ''} ({drawn}, seed {seed})", None)
    if ensemble is not None:
        if where.start:
            raise ParameterError("--ensemble and --start exclude each other: nothing is drawn. Leave --ensemble out.")
        option = "--leaf" if where.leaf else "--guess" if where.guess else "--energy"
        raise ParameterError(
            f"--ensemble and {option} exclude each other: on a leaf states follow the Liouville measure. Leave one out."
        )
    begin = start_of(system, where, seed)
    if where.start or isinstance(begin, PlainStart):
        return Starts(begin.state[None], "one orbit", begin)
    level = (
        begin.energy if where.energy is None else as_double(where.energy, "--energy")
    )  # the former has a round-off of its own
    states = begin.leaf.sample(n, seed=seed, energy=level)
    return Starts(states, f"{n} random start{'s' if n > 1 else ''} on one leaf and energy (seed {seed})", begin)


def state_of(words: Sequence[str], option: str, component: str) -> list[str] | dict[str, list[str]] | None:
    """All components, or fields and components by name, as texts."""
    if not words:
        return None
    if len(words) == 1 and "=" not in words[0]:
        return _items(words[0])
    each = [one for word in words for one in _BEFORE_A_NAME.split(word)]
    named = assignments(each, option, f"{option} {component}=1", "component")
    return {name: _items(text) for name, text in named.items()}


def split_at_commas(texts: Sequence[str]) -> list[str]:
    """The words of an option that may come several times and takes several words, as in --leaf C1=1,C2=0."""
    return _COMMAS.split(",".join(texts))


def assignments(words: Sequence[str], option: str, example: str, noun: str) -> dict[str, str]:
    """Texts of the form name=value."""
    found: dict[str, str] = {}
    for word in words:
        name, sign, value = (part.strip() for part in word.rpartition("="))
        if not (name and sign and value):
            raise ParameterError(
                f"{option} must be name=value; got {word!r:.{_MOST_SHOWN}}. Write for example {example}."
            )
        if name in found:
            raise ParameterError(f"{option} must give each {noun} once; {name} comes twice. Remove one.")
        found[name] = value
    return found


def _items(text: str) -> list[str]:
    return [item.strip() for item in text.split(",")]


def start_lines(system: System | VectorField, start: Start | PlainStart) -> list[str]:
    """What the commands print about a start: components, leaf, energy, and for a top bounds on its vectors."""
    sizes = dict.fromkeys(system.parts_of_state, 1)
    own: Any = getattr(system, "undamped", None) if isinstance(start, PlainStart) else start.leaf.system
    if own is not None:
        bracket = own.bracket
        sizes = {name: len(components) for name, components in bracket.vectors.items()}
        sizes |= dict.fromkeys(bracket.scalars, 1)  # which come after the vectors
    width = max(8, *map(len, sizes))
    lines = [f"{'start':<{width}} {start.origin}"]
    vectors = np.split(start.state, np.cumsum([*sizes.values()]))
    for name, vector in zip(sizes, vectors, strict=False):
        lines.append(f"  {name:<{width - 2}} {', '.join(f'{value:.9g}' for value in vector)}")
    return [*lines, *leaf_lines(system, start)]


@np.errstate(all="ignore")
def leaf_lines(system: System | VectorField, start: Start | PlainStart) -> list[str]:
    """The leaf, the energy, and for a top the bounds that follow from them; of a vector field nothing."""
    if isinstance(start, PlainStart):
        return []
    system, leaf = start.leaf.system, start.leaf
    values = ", ".join(f"{name} = {value:.9g}" for name, value in leaf.casimirs.items())
    lines = [f"leaf     dimension {leaf.rank}, {leaf.stratum}" + (f": {values}" if values else "")]
    lines += [f"         {leaf.caution}"] if leaf.caution else []
    lines.append(f"energy   H = {start.energy:.9g}")
    if system.top_parameters is not None and np.isfinite(start.energy):
        from liepoisson.leaf.orbit_bounds import bounds

        try:
            limits = bounds(system, start.state)
        except ParameterError:  # squares of the start are too large for doubles
            return lines
        sizes = (f"|{name}| <= {getattr(limits, name):.6g}" for name in ("l", "alpha", "beta", "omega"))
        lines.append(f"bounds   {', '.join(sizes)}")
    return lines
