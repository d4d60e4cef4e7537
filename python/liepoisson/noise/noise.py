r"""What shakes a system, read once: noise Hamiltonians with exact flows, and an inverse temperature.

A path of the noise of Stratonovich is a Hamiltonian $H + \sum_k\dot W_k(t)H_k$, so whatever the $H_k$ are the motion
stays on its leaf.  A method of splitting needs the flow of each $H_k$: it has that of a function of one linear form
(`liepoisson.compile.split_terms`), and of a sum of such functions whose forms commute.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np

from liepoisson import _core
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
from liepoisson.numeric.sampling import as_first
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import core_field, has_bracket
from liepoisson.streams import Purpose, seeds

Noises: TypeAlias = "str | Sequence[Any]"
"""One noise Hamiltonian, or several: texts, SymPy expressions, functions on phase space."""


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
                phase space, or moves nothing; an inverse temperature that is negative.
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
        given = _one_by_one(noises)
        texts = tuple(noise if isinstance(noise, str) else str(system.expression(noise)) for noise in given)
        pieces = tuple(_pieces(system, noise, text) for noise, text in zip(given, texts, strict=True))
        states = as_starts(system, starts, options.field(system).n_components)
        energy = system.pieces().pieces if beta else ()  # pyright: ignore[reportAttributeAccessIssue]
        first = as_first(options.first, len(states))
        return cls(texts, pieces, energy, beta, options, system, states, first)

    def core(self, *, n_before: int = 0, n_increments: int = 1) -> _core.Field:
        """The field that the core integrates, after so many steps."""
        key = seeds(self.options.seed, Purpose.NOISE).generate_state(2, np.uint32).tolist()
        return core_field(self.options.field(self.system)).with_noise(
            self.pieces, self.energy, self.inverse_temperature, key, self.first, n_before, n_increments
        )

    def given(self) -> dict[str, Any]:
        """The first fields of a `NoisyRun`."""
        options = self.options
        own = {"noises": self.texts, "inverse_temperature": self.inverse_temperature, "first": self.first}
        return options.given(self.system, self.start) | own | {"seed": options.seed}


def as_increments(value: Any) -> int:
    """A number of increments in each step."""
    return as_count(value, "increments", least=1, most=2**20)


def _one_by_one(noises: Any) -> tuple[Any, ...]:
    if isinstance(noises, Mapping):
        raise ParameterError(
            "noises: wanted functions on phase space, whose fields stay on the leaf; got values by name, as of a vector "
            'field, which may leave it; try noises=["l1/2"]'
        )
    given = tuple(noises) if isinstance(noises, (list, tuple)) else (noises,)
    if not given:
        raise ParameterError('noises: wanted at least one function on phase space; got none; try "l1/2", or integrate')
    for noise in given:
        if isinstance(noise, (Mapping, list, tuple, np.ndarray, int, float)):
            raise ParameterError(
                f"noises: wanted functions on phase space, whose fields stay on the leaf; got {shown(noise)}; give a "
                "text for each noise Hamiltonian"
            )
    return given


def _pieces(system: Any, noise: Any, text: str) -> tuple[Piece, ...]:
    try:
        pieces = commuting_pieces_of(system.bracket, system.expression(noise))
    except UnsupportedFieldError as error:
        raise UnsupportedFieldError(f"noises: {shown(text)} has no exact flow; {error}") from error
    if not pieces:
        raise ParameterError(
            f"noises: wanted functions that move something; got {shown(text)}, a function of Casimirs; leave it out"
        )
    return pieces
