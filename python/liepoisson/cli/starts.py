"""Where the commands `orbit` and `section` begin: a state that is given, or a guess moved onto a leaf and an energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liepoisson.cli.systems import read_file, setting_words, with_settings
from liepoisson.errors import ExpressionError, LeafError, ParameterError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from liepoisson.exact.system import System
    from liepoisson.phase_space.leaf import Leaf

    FloatArray: TypeAlias = NDArray[np.float64]

START_HELP = "Where the orbit begins: all numbers, or by name, --start l=1,0,0 --start beta3=1; the others are 0."
GUESS_HELP = "Like --start, but it is moved onto --leaf and --energy.  [default: member 0 of the seed]"
LEAF_HELP = "Values of Casimirs, as in --leaf C1=1.2,C2=0 or --leaf C1=1.2 --leaf C2=0; the others keep theirs."
ENERGY_HELP = "Value of the Hamiltonian."
SEED_HELP = "Seed of what is drawn at random."

MATCH = 1e-10
"""Relative violation of a leaf or an energy below which a given start counts as lying there.

Round-off of decimal numbers with twelve digits stays below it.
"""
_GUESSES = 8
"""Random guesses that are tried before a leaf or an energy is given up."""
_MOST_SHOWN = 60


@dataclass(frozen=True)
class Start:
    """A state with its leaf and energy, and how it was found.

    Attributes:
        state: Shape (component,).
        leaf: The symplectic leaf through it.
        energy: Value of the Hamiltonian there.
        origin: How it was found, in words.
    """

    state: FloatArray
    leaf: Leaf
    energy: float
    origin: str


def read_numeric_system(argument: str, settings: Sequence[str]) -> System:
    """The system of a command that computes with numbers; its name says which parameters were set.

    Raises:
        ParameterError: a parameter has no value (the message names all of them), or one that no double is near.
    """
    file = with_settings(read_file(argument), settings)
    from liepoisson.exact.parameters import as_float, is_zero
    from liepoisson.exact.values import flattened

    if file.symbols:
        from liepoisson.exact.formula.scope import read_declaration

        name, shape = read_declaration(file.symbols[0])
        value = ",".join("1" * shape[0]) if shape else "1"
        raise ParameterError(
            f"{file.name} must have numbers for all parameters; {', '.join(file.symbols)} have none. "
            f"Give them, for example --set {name}={value}."
        )
    for name, value in flattened(file.parameters).items():
        if as_float(value, name) == 0.0 and not is_zero(value):
            raise ParameterError(
                f"{name} must be zero or at least 4.9e-324, to fit into a double; got a smaller number. "
                "Set it to 0, or rescale the system."
            )
    return replace(file, name=file.name + setting_words(settings)).system()


@np.errstate(all="ignore")  # a start that is too large for doubles ends with its outcome
def find_start(
    system: System,
    *,
    start: Sequence[str] = (),
    guess: Sequence[str] = (),
    leaf: Sequence[str] = (),
    energy: float | None = None,
    seed: int = 0,
) -> Start:
    """The start that the options ask for.

    A given start must lie on the leaf and at the energy asked for; a guess is moved there.

    Raises:
        ParameterError: options that contradict each other or cannot be read.
        LeafError: no real state has these Casimirs and this energy, or the given start does not.
    """
    wanted = read_leaf(system, leaf) if leaf else {}
    if start and guess:
        raise ParameterError("--start and --guess exclude each other: a start stays where it is, a guess is moved.")
    if guess and not wanted and energy is None:
        raise ParameterError("--guess must come with --leaf or --energy, onto which it is moved. Or write --start.")
    if start:
        return _given(system, read_state(system, start, "--start"), wanted, energy)
    if guess:
        x = read_state(system, guess, "--guess")
        return _moved(_leaf(system, x, wanted), x, energy, "the guess")
    return _random(system, wanted, energy, seed)


def _given(system: System, x: FloatArray, wanted: dict[str, float], energy: float | None) -> Start:
    values = {name: float(casimir(x)) for name, casimir in system.functions.casimirs.items()}
    wrong = [
        f"{name} = {got:.12g} instead of {aim:.12g}"
        for name, aim, got in (
            *((name, aim, values[name]) for name, aim in wanted.items()),
            *((("H", energy, float(system.functions.energy(x))),) if energy is not None else ()),
        )
        if abs(got - aim) > MATCH * max(1.0, abs(aim))
    ]
    if wrong:
        raise LeafError(
            f"--start must lie on the leaf and at the energy asked for; it has {', '.join(wrong)}. "
            "Write --guess instead of --start to have it moved there."
        )
    return _start_at(system, x, "as given")


def _random(system: System, wanted: dict[str, float], energy: float | None, seed: int) -> Start:
    """On the leaf of member 0 of unit vectors, with the wanted values; reached from the first member that can be."""
    from liepoisson.numeric.sampling import sample_states

    members = sample_states(system, _GUESSES, seed=seed)
    if not wanted and energy is None:
        return _start_at(system, members[0], f"member 0 of unit-vectors, seed {seed}")
    leaf, failure = _leaf(system, members[0], wanted), None
    for k, x in enumerate(members):
        try:
            return _moved(leaf, x, energy, f"member {k} of unit-vectors, seed {seed}")
        except LeafError as error:
            failure = failure or error
    assert failure is not None
    raise failure


def _start_at(system: System, x: FloatArray, origin: str) -> Start:
    from liepoisson.phase_space.leaf import Leaf

    return Start(x, Leaf.through(system, x), float(system.functions.energy(x)), origin)


def _leaf(system: System, x: FloatArray, wanted: dict[str, float]) -> Leaf:
    """The leaf of x, with other values for some Casimirs."""
    from liepoisson.phase_space.leaf import Leaf

    if not wanted:
        return Leaf.through(system, x)
    try:
        return Leaf(system, {name: float(casimir(x)) for name, casimir in system.functions.casimirs.items()} | wanted)
    except LeafError as error:  # its advice is a call in Python
        raise LeafError(str(error).replace("Leaf.through(system, state)", "--start STATE, without --leaf")) from error


def _moved(leaf: Leaf, x: FloatArray, energy: float | None, guess: str) -> Start:
    reached = leaf.project(x, energy=energy)
    origin = f"{guess}, moved by {np.linalg.norm(reached - x):.3g}"
    return Start(reached, leaf, float(leaf.system.functions.energy(reached)), origin)


def read_state(system: System, words: Sequence[str], option: str) -> FloatArray:
    """A state from the values of an option: all components, or fields and components by name.

    Raises:
        ParameterError: a word is none of these, or a component is given twice.
    """
    names, fields = system.component_names, system.bracket.field_names
    example = f"{option} {names[0]}=1"
    if len(words) == 1 and "=" not in words[0]:
        numbers = _numbers(words[0], option)
        if len(numbers) != len(names):
            raise ParameterError(
                f"{option} must have {len(names)} numbers ({', '.join(fields)}); got {len(numbers)}. "
                f"Or give some by name: {example}."
            )
        return np.array(numbers)
    size = system.bracket.algebra.dimension
    places = {field: range(k * size, (k + 1) * size) for k, field in enumerate(fields)}
    places |= {name: range(k, k + 1) for k, name in enumerate(names)}
    x = np.full(len(names), np.nan)
    for name, text in (_assignment(word, option, example) for word in words):
        if name not in places:
            known = ", ".join((*fields, *names))
            raise ParameterError(f"{option} must name a field or a component; got {name!r:.60}. Known: {known}.")
        numbers, place = _numbers(text, option), list(places[name])
        if len(numbers) != len(place):
            raise ParameterError(f"{option} {name} must have {len(place)} numbers; got {len(numbers)}.")
        if not np.isnan(x[place]).all():
            raise ParameterError(f"{option} must give each component once; {name} comes twice. Remove one.")
        x[place] = numbers
    return np.nan_to_num(x)


def read_leaf(system: System, words: Sequence[str]) -> dict[str, float]:
    """Values of Casimirs from those of the option --leaf.

    Raises:
        ParameterError: it is not of the form C1=1.2,C2=0, or a name is not a Casimir.
    """
    known = tuple(system.functions.casimirs)
    example = ",".join(f"{name}={value}" for name, value in zip(known, ("1", *("0" * 20)), strict=False))
    values: dict[str, float] = {}
    for word in ",".join(words).split(","):
        name, value = _assignment(word, "--leaf", f"--leaf {example}")
        if name not in known:
            raise ParameterError(
                f"--leaf must name Casimirs of {system.name}; got {name!r:.60}. Known: {', '.join(known) or 'none'}."
            )
        if name in values:
            raise ParameterError(f"--leaf must give each Casimir once; {name} comes twice. Remove one.")
        (values[name],) = _numbers(value, "--leaf")
    return values


def _assignment(word: str, option: str, example: str) -> tuple[str, str]:
    name, sign, value = (part.strip() for part in word.partition("="))
    if not (name and sign and value):
        raise ParameterError(f"{option} must be name=value; got {word!r:.{_MOST_SHOWN}}. Write for example {example}.")
    return name, value


def _numbers(text: str, option: str) -> list[float]:
    """Numbers such as -1, 1/3, sqrt(2)/2, separated by commas."""
    import math

    from liepoisson.exact.expression import evaluate
    from liepoisson.exact.formula.grammar import parse
    from liepoisson.exact.formula.scope import Scope
    from liepoisson.exact.parameters import as_float

    try:
        items = [item.strip() for item in text.split(",")]
        numbers = [as_float(evaluate(parse(item), item, Scope()), option) for item in items]
    except ExpressionError as error:
        raise ParameterError(f"{option} {text:.{_MOST_SHOWN}}: {error.within_formula()}") from error
    if not all(map(math.isfinite, numbers)):
        raise ParameterError(f"{option} must have finite numbers; got {text:.{_MOST_SHOWN}}.")
    return numbers


def start_lines(system: System, start: Start) -> list[str]:
    """What the commands print about a start: components, leaf, energy, and for a top bounds on its vectors."""
    names, size = system.bracket.field_names, system.bracket.algebra.dimension
    width = max(8, *map(len, names))
    lines = [f"{'start':<{width}} {start.origin}"]
    for k, name in enumerate(names):
        vector = start.state[k * size : (k + 1) * size]
        lines.append(f"  {name:<{width - 2}} {', '.join(f'{value:.9g}' for value in vector)}")
    return [*lines, *leaf_lines(system, start)]


@np.errstate(all="ignore")
def leaf_lines(system: System, start: Start) -> list[str]:
    """The leaf, the energy, and for a top the bounds that follow from them."""
    leaf = start.leaf
    values = ", ".join(f"{name} = {value:.9g}" for name, value in leaf.casimirs.items())
    lines = [f"leaf     dimension {leaf.rank}, {leaf.stratum}" + (f": {values}" if values else "")]
    lines += [f"         {leaf.caution}"] if leaf.caution else []
    lines.append(f"energy   H = {start.energy:.9g}")
    if system.top_parameters is not None and np.isfinite(start.energy):
        from liepoisson.phase_space.orbit_bounds import bounds

        try:
            limits = bounds(system, start.state)
        except ParameterError:  # squares of the start are too large for doubles
            return lines
        sizes = (f"|{name}| <= {getattr(limits, name):.6g}" for name in ("l", "alpha", "beta", "omega"))
        lines.append(f"bounds   {', '.join(sizes)}")
    return lines
