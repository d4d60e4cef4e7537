"""Systems with noise, and their files: a system file with a table [noise].

The format is described in `liepoisson.model.system_file`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from liepoisson.algebra.exact_numbers import Exact, as_float
from liepoisson.errors import ExpressionError, LiePoissonError, ParameterError, SystemFileError
from liepoisson.formula.expression import read_formula
from liepoisson.formula.parameters import GivenValue, read_parameter
from liepoisson.formula.scalars import as_positive
from liepoisson.formula.toml_text import parse_toml, read_toml
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.refusals import not_a_whole_system
from liepoisson.model.system import System
from liepoisson.model.system_file import ExtendedFile
from liepoisson.model.system_file_reader import read_noisy_tables
from liepoisson.model.system_text import formula_text, system_tables, toml_text, value_text
from liepoisson.noise.noise import Noises, as_noises, pieces_of_noise


@explains_its_methods
class NoisySystem:
    r"""A system and what shakes it, $dx = \{x,H\}\,dt + \sum_k\{x,H_k\}\circ dW_k$, as one file describes them.

    `read_noisy_system` makes it, or this constructor; `lp.systems.write_system` writes it. The functions of
    `lp.stochastic` take its parts.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> noisy = lp.stochastic.NoisySystem(body, ["l1/2", "l2/2"], inverse_temperature="1/3")
        >>> noisy
        <NoisySystem 'Euler top on so(3)': noises l1/2, l2/2, inverse temperature 1/3>
        >>> run = lp.stochastic.noisy_orbits(noisy.system, [1, 0, 0], **noisy.noise, t_end=1, method=lp.Splitting(0.1))
        >>> run.noises
        ('l1/2', 'l2/2')

    Args:
        system: The system, with numbers for all parameters.
        noises: The noise Hamiltonians, as for `noisy_orbits`; the values of the parameters of the system are put in.
        inverse_temperature: That of the damping, at least 0; a number, read exactly.

    Attributes:
        name: How it is called: like the system.
        system: The system without noise.
        noises: The noise Hamiltonians, as texts.
        inverse_temperature: The exact number.

    Raises:
        ParameterError, UnsupportedFieldError, ExpressionError: as for `noisy_orbits`.
    """

    @explains_its_arguments
    def __init__(self, system: System, noises: Noises, inverse_temperature: GivenValue = 0) -> None:
        if not isinstance(system, System):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise not_a_whole_system(system)
        texts: list[str] = []
        for noise in as_noises(noises):
            expression = system.expression(noise)
            texts.append(formula_text(expression))
            pieces_of_noise(system, expression, texts[-1])
        self.name: str = system.name
        self.system: System = system
        self.noises: tuple[str, ...] = tuple(texts)
        self.inverse_temperature: Exact = _not_negative(inverse_temperature)

    @property
    def noise(self) -> dict[str, Any]:
        """The arguments `noises` and `inverse_temperature` of the functions of `lp.stochastic`."""
        temperature = as_float(self.inverse_temperature, "inverse_temperature")
        return {"noises": list(self.noises), "inverse_temperature": temperature}

    def file_text(self) -> str:
        """The text of a file from which `read_noisy_system` gives the same; all numbers exact.

        Raises:
            SystemFileError: the system or a noise Hamiltonian has a function that the grammar does not have.
        """
        tables = system_tables(self.system)
        tables["noise"] = {"noises": list(self.noises), "inverse_temperature": value_text(self.inverse_temperature)}
        text = toml_text(tables)
        found: NoisySystem = read_noisy_tables(parse_toml(text, "the system of the file")).system()
        same = found.system.text == self.system.text
        if not same or (found.noises, found.inverse_temperature) != (self.noises, self.inverse_temperature):
            raise SystemFileError(
                f"the system with noise {self.name!r} cannot be written as a file: what is read back is not the same. "
                "Give the Hamiltonian and the noises as texts."
            )
        return text

    def __repr__(self) -> str:
        damped = f", inverse temperature {self.inverse_temperature}" if self.inverse_temperature else ""
        return f"<NoisySystem {self.name!r}: noises {', '.join(self.noises) or 'none'}{damped}>"


@explains_its_arguments
def read_noisy_system(path: str | Path) -> NoisySystem:
    """The system with noise that a file with a table [noise] describes.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> spin = lp.System(lp.so(3) @ lp.trivial(), "l3", name="spin")
        >>> file = lp.systems.write_system(lp.stochastic.NoisySystem(spin, "l1/2"), Path(mkdtemp()) / "spin.toml")
        >>> lp.stochastic.read_noisy_system(file)
        <NoisySystem 'spin': noises l1/2>

    Args:
        path: A TOML file in UTF-8, at most 1 MB, in the format of `liepoisson.model.system_file`.

    Raises:
        MissingFileError: there is no such file.
        SystemFileError: it describes no system with noise, or the noise has no exact flow; the message names the key,
            and the line where it can be found.
    """
    return read_noisy_tables(read_toml(path)).system()


@explains_its_methods
@dataclass(frozen=True, kw_only=True)
class NoisyFile(ExtendedFile):
    """What the file of a system with noise says.

    Attributes:
        noises: The formulas of the noise Hamiltonians.
        inverse_temperature: A number, or a formula of parameters.
    """

    noises: tuple[str, ...]
    inverse_temperature: Exact | str = Fraction(0)

    def system(self) -> NoisySystem:
        """The system with its noise.

        Raises:
            SystemFileError: a formula has no meaning, or noise has no exact flow; the message names the key.
        """
        if self.symbols:
            raise self.error(
                ("parameters", "symbols"),
                f"noise needs numbers for all parameters; got none for {', '.join(self.symbols)}. Give values.",
            )
        system = self.system_file().system()
        noises = [self._read(("noise", "noises", k), text, system) for k, text in enumerate(self.noises)]
        temperature = self._read(("noise", "inverse_temperature"), str(self.inverse_temperature), None)
        return NoisySystem(system, noises, temperature)

    def _read(self, keys: tuple[Any, ...], text: str, system: System | None) -> Any:
        """A formula with the values of the parameters: noise of a system, or a number >= 0."""
        try:
            value = read_formula(text, self.scope).value
            if system is None:
                return _not_negative(value)
            pieces_of_noise(system, value, text)
        except ExpressionError as error:
            raise self.error(keys, error.within_formula()) from error
        except LiePoissonError as error:
            raise self.error(keys, str(error).removeprefix(f"{keys[1]}: ")) from error
        return value


def _not_negative(value: Any) -> Exact:
    found = read_parameter(value, "inverse_temperature")
    if getattr(found, "free_symbols", None):
        raise ParameterError(f"inverse_temperature: wanted a number >= 0; got {found}; try 1")
    number = as_float(found, "inverse_temperature")
    as_positive(number, "inverse_temperature", "a number >= 0", example=1, zero=True)
    return found
