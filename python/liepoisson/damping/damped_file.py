"""Files of damped systems: a system file with a table [damping].

The format is described in `liepoisson.model.system_file`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, cast

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.damping.damped_system import DampedSystem, Damping
from liepoisson.errors import ExpressionError, LiePoissonError, SystemFileError
from liepoisson.formula.parameters import Value, read_parameter
from liepoisson.formula.scope import read_declaration
from liepoisson.formula.toml_text import parse_toml
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.hamiltonian import is_expression
from liepoisson.model.system_file import ExtendedFile, SystemFile
from liepoisson.model.system_file_reader import read_equations
from liepoisson.model.system_text import formula_text, system_tables, toml_text, value_text


@explains_its_methods
@dataclass(frozen=True, kw_only=True)
class DampedFile(ExtendedFile):
    """What the file of a damped system says.

    Attributes:
        damping: The damping, in texts and exact numbers.
    """

    damping: Damping

    def system(self) -> DampedSystem:
        """The damped system, ready to be integrated.

        Raises:
            SystemFileError: a formula has no meaning, or the damping is none; the message names the file.
        """
        own = self.system_file()
        further: Any = {name: value for name, value in self.parameters.items() if name not in own.parameters}
        symbols = [text for text in self.symbols if text not in own.symbols]
        try:
            return DampedSystem(own.system(), self.damping, further, symbols=symbols, name=self.name)
        except SystemFileError:
            raise
        except ExpressionError as error:
            raise self.error(("damping",), error.within_formula()) from error
        except LiePoissonError as error:
            raise self.error(("damping",), str(error)) from error


def damped_file(
    undamped: SystemFile, damping: Mapping[str, Any], parameters: Mapping[str, Value], symbols: Sequence[str]
) -> DampedFile:
    """The file of a system with the values of its table [damping]."""
    return DampedFile(
        name=undamped.name,
        bare=undamped,
        damping=Damping(**damping),
        parameters=parameters,
        symbols=tuple(symbols),
        integrals=undamped.integrals,
        path=undamped.path,
        toml=undamped.toml,
    )


def damped_text(system: DampedSystem) -> str:
    """The text of a file from which `read_system` gives the same damped system; all numbers exact.

    Raises:
        SystemFileError: the system or the damping has a function that the grammar does not have.
    """
    tables = system_tables(system.undamped)
    tables["name"] = system.name
    further = {name: value_text(value) for name, value in system.values.items() if system.is_of_damping(name)}
    tables["parameters"] = further | tables.get("parameters", {})
    own = tables["parameters"].get("symbols", [])
    declared = {text: read_declaration(text)[0] for text in system.as_given.symbols}
    symbols = [text for text, name in declared.items() if text not in own and system.is_of_damping(name)]
    if own or symbols:
        tables["parameters"]["symbols"] = [*own, *symbols]
    given = {one.name: getattr(system.damping, one.name) for one in fields(Damping)}
    tables["damping"] = {name: _plain(value, name) for name, value in given.items() if value is not None}
    text = toml_text(tables)
    try:
        found: Any = read_equations(parse_toml(text, "the damped system of the file")).system()
        pairs = zip(found.equations.values(), system.equations.values(), strict=True)
        same = found.parameters == system.parameters and all(a == b or is_zero(a - b) for a, b in pairs)
        same = same and (found.entropy == system.entropy or is_zero(found.entropy - system.entropy))
    except LiePoissonError as error:
        raise SystemFileError(f"the damped system {system.name!r} cannot be written as a file ({error})") from error
    if not same:
        raise SystemFileError(
            f"the damped system {system.name!r} cannot be written as a file: what is read back is not the same. Give "
            "the Hamiltonian and the damping as texts."
        )
    return text


def _plain(value: Any, name: str) -> Any:
    """A number or a formula as a text, a vector or a matrix as lists of such."""
    if isinstance(value, str):
        return value
    if is_expression(value):
        return formula_text(value)
    items = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(items, Sequence):
        return [_plain(item, name) for item in cast("Sequence[Any]", items)]
    return formula_text(to_sympy(read_parameter(items, name)))
