r"""What shakes a system, read once: noise Hamiltonians with exact flows, and an inverse temperature.

A path of the noise of Stratonovich is a Hamiltonian $H + \sum_k\dot W_k(t)H_k$, so whatever the $H_k$ are the motion
stays on its leaf.  A method of splitting needs the flow of each $H_k$: it has that of a function of one linear form
(`liepoisson.compile.split_terms`), and of a sum of such functions whose forms commute.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np

from liepoisson import _core
from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.compile.field import Piece
from liepoisson.compile.split_terms import commuting_pieces_of
from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.formula.scalars import as_count, as_positive
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import not_a_whole_system, shown
from liepoisson.io.result import recorded
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.run import Run
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import core_field, has_bracket
from liepoisson.streams import Purpose, seeds

Noises: TypeAlias = "str | Sequence[Any]"
"""One noise Hamiltonian, or several: texts, SymPy expressions, functions on phase space."""
_NUMBERS = 2**22
"""Numbers of the states that are in memory at once: 32 MiB."""
_MOST_TRAJECTORIES = 2**48
"""What a counter of the random numbers has room for beside the channel."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NoisyRun(Run):
    """A run of a system with noise: what shakes it, and the seed of the paths."""

    noises: tuple[str, ...] = recorded(list, tuple)
    inverse_temperature: float
    seed: int
    first: int

    def arguments(self) -> dict[str, Any]:
        """The starts, the method and the noise."""
        names = ("noises", "inverse_temperature", "seed", "first")
        return super().arguments() | {name: getattr(self, name) for name in names}


@dataclass(frozen=True)
class Noise:
    """Noise that the core takes, the starts and the options of a run.

    Attributes:
        texts: The noise Hamiltonians as texts.
        pieces: Those of each.
        energy: The pieces of the Hamiltonian, where it is damped.
        inverse_temperature: That of the law of Gibbs, or 0.
        options: How the run is made.
        system: What is shaken.
        start: States, shape (trajectory, component).
        first: Number of the first trajectory.
    """

    texts: tuple[str, ...]
    pieces: tuple[tuple[Piece, ...], ...]
    energy: tuple[Piece, ...]
    inverse_temperature: float
    options: RunOptions
    system: Any
    start: Array
    first: int

    @classmethod
    def read(
        cls, system: Any, starts: StartsLike, noises: Any, inverse_temperature: float, options: RunOptions
    ) -> Self:
        """What a caller gives, checked.

        Raises:
            ParameterError: a system without a bracket; a method other than splitting; noise that is no function on
                phase space, or one of Casimirs; an inverse temperature that is negative.
            UnsupportedFieldError: a bracket that is not linear in the state, or noise without an exact flow.
        """
        if not isinstance(options.method, Splitting) or options.method.precision != "double":
            raise ParameterError(
                f"method: wanted Splitting in double precision, whose steps noise can enter; got {options.method}; try "
                "Splitting(step=0.01)"
            )
        if not has_bracket(system):
            raise not_a_whole_system(system)
        beta = as_positive(inverse_temperature, "inverse_temperature", "a number >= 0", example=1, zero=True)
        given = as_noises(noises)
        texts = tuple(noise if isinstance(noise, str) else str(system.expression(noise)) for noise in given)
        pieces = tuple(pieces_of_noise(system, noise, text) for noise, text in zip(given, texts, strict=True))
        states = as_starts(system, starts, options.field(system).n_components)
        energy = system.pieces().pieces if beta else ()  # pyright: ignore[reportAttributeAccessIssue]
        first = as_count(options.first, "first", most=_MOST_TRAJECTORIES - len(states))
        return cls(texts, pieces, energy, beta, options, system, states, first)

    def orbits(
        self,
        times: Array,
        *,
        start: Array | None = None,
        tangents: Array | None = None,
        n_before: int = 0,
        n_increments: int = 1,
        done: float = 0.0,
        share: float = 1.0,
    ) -> Any:
        """Trajectories at times, or a part of them: what `_core.orbits` returns, the states in their shapes.

        Args:
            times: The times; the first is that of the starts.
            start: States after `n_before` steps, by default those of the beginning, shape (trajectory, component).
            tangents: A tangent vector of each, shape (trajectory, component).
            n_before: Steps that were taken before.
            n_increments: Increments of the path in each step.
            done: Fraction of the run that is done before.
            share: That of this part.
        """
        key = seeds(self.options.seed, Purpose.NOISE).generate_state(2, np.uint32).tolist()
        field = self._field.with_noise(
            self.pieces, self.energy, self.inverse_temperature, key, self.first, n_before, n_increments
        )
        states = self.start if start is None else start
        raw: Any = _core.orbits(
            field,
            self.options.method.core(),
            np.ascontiguousarray(states).ravel(),
            np.empty(0) if tangents is None else tangents.ravel(),
            0 if tangents is None else 1,
            times,
            self.options.threads,
            self.options.left,
            False,
            False,
            self.options.part(done, share).progress,
        )
        in_shape = {"state": (len(states), len(times), states.shape[-1]), "final_state": states.shape}
        return raw | {name: raw[name].reshape(shape) for name, shape in in_shape.items()}

    @cached_property
    def _field(self) -> Any:
        """The field without noise, for the core."""
        return core_field(self.options.field(self.system))

    def in_parts(
        self, start: Array, begin: float, interval: float, count: int, *, n_before: int = 0
    ) -> Iterator[tuple[int, Array, Any]]:
        """States after each of many equal intervals of time, as many at once as fit into memory.

        Args:
            start: States at the time `begin`, after `n_before` steps.
            begin: When they are.
            interval: The interval.
            count: How many.
            n_before: The steps.

        Returns:
            Of each part the number of its first interval, the times (time,) at the ends of its intervals, and what
            `orbits` returns.
        """
        per_part = max(1, _NUMBERS // max(1, start.size))
        for first in range(0, count, per_part):
            at = begin + interval * np.arange(first, min(first + per_part, count) + 1, dtype=np.float64)
            raw = self.orbits(at, start=start, n_before=n_before, done=first / count, share=(len(at) - 1) / count)
            start, n_before = raw["final_state"], n_before + steps_taken(raw)
            yield first, at[1:], raw

    def given(self) -> dict[str, Any]:
        """The first fields of a `NoisyRun`."""
        options = self.options
        own = {"noises": self.texts, "inverse_temperature": self.inverse_temperature, "first": self.first}
        return options.given(self.system, self.start) | own | {"seed": options.seed}


def steps_taken(raw: Any) -> int:
    """Steps of the trajectories that reached the end of a run of the core: all take the same."""
    return int(raw["n_steps"].max(initial=0))


def as_increments(value: Any) -> int:
    """A number of increments in each step."""
    return as_count(value, "increments", least=1, most=2**20)


def as_noises(noises: Any) -> tuple[Any, ...]:
    """Noise Hamiltonians one by one, each a text or a function on phase space."""
    if isinstance(noises, Mapping):
        raise ParameterError(
            "noises: wanted functions on phase space, whose fields stay on the leaf; got values by name, as of a "
            'vector field, which may leave it; try noises=["l1/2"]'
        )
    given = tuple(noises) if isinstance(noises, (list, tuple)) else (noises,)
    for noise in given:
        if isinstance(noise, (Mapping, list, tuple, np.ndarray, int, float)):
            raise ParameterError(
                f"noises: wanted functions on phase space, whose fields stay on the leaf; got {shown(noise)}; give a "
                "text for each noise Hamiltonian"
            )
    return given


def pieces_of_noise(system: Any, noise: Any, text: str) -> tuple[Piece, ...]:
    """The pieces of a noise Hamiltonian, which flow exactly; of 0 there are none.

    Raises:
        UnsupportedFieldError: it has no exact flow.
        ParameterError: it is a function of Casimirs, and not 0.
    """
    expression = system.expression(noise)
    try:
        pieces = commuting_pieces_of(system.bracket, expression)
    except UnsupportedFieldError as error:
        if system.bracket.is_casimir(expression, symbols=sorted(map(str, expression.free_symbols))):
            raise _moves_nothing(text) from error
        raise UnsupportedFieldError(f"noises: {shown(text)} has no exact flow; {error}") from error
    if not pieces and not is_zero(expression):
        raise _moves_nothing(text)
    return pieces


def _moves_nothing(text: str) -> ParameterError:
    return ParameterError(
        f"noises: wanted functions that move something, or 0; got {shown(text)}, a function of Casimirs; leave it out"
    )
