"""The argument SYSTEM of the commands: a name of the catalog or the path of a system file, with values by --set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from liepoisson.errors import ExpressionError, ParameterError, did_you_mean

if TYPE_CHECKING:
    from liepoisson.damping.damped_system import DampedSystem
    from liepoisson.formula.parameters import Value
    from liepoisson.model.system import System
    from liepoisson.model.system_file import EquationsFile, SystemFile
    from liepoisson.model.vector_field import VectorField
    from liepoisson.noise.noisy_system import NoisySystem

F = TypeVar("F", bound="EquationsFile")
_MOST_SHOWN = 60


def read_system(argument: str, settings: Sequence[str] = ()) -> System:
    """The system that a command is about: the argument SYSTEM with "name=value" for parameters, vectors with commas."""
    return with_settings(read_file(argument), settings).system()


def read_whole_system(argument: str, settings: Sequence[str] = ()) -> System | DampedSystem | NoisySystem:
    """The same, with the damping or the noise of its file."""
    from liepoisson.model.vector_field_file import VectorFieldFile

    file: Any = _read_any_file(argument, noise=True)
    if isinstance(file, VectorFieldFile):
        file = read_file(argument)  # which refuses it with the line of its equations
    return with_settings(file, settings).system()


def read_numeric_system(argument: str, settings: Sequence[str]) -> System:
    """The system of a command that computes with numbers; its name says which parameters were set.

    Integrals that are not constant with what was set are left out.
    """
    return _with_numbers(read_file(argument), settings).system()


def read_numeric_equations(argument: str, settings: Sequence[str]) -> System | VectorField:
    """The same, or the vector field of a file with equations."""
    return _with_numbers(_read_any_file(argument), settings).system()


def read_shaken_equations(argument: str, settings: Sequence[str]) -> System | VectorField | NoisySystem:
    """The same, or a system with noise, of a command that follows noise."""
    return _with_numbers(_read_any_file(argument, noise=True), settings).system()


def read_equations(argument: str, settings: Sequence[str] = (), free: Sequence[str] = ()) -> System | VectorField:
    """The system, or the vector field of a file with equations; parameters that are free have no values."""
    return with_symbols(_read_any_file(argument), settings, free).system()


def _with_numbers(file: F, settings: Sequence[str]) -> F:
    """The file with what was set, which its name says; refused where a parameter has no number."""
    file = with_settings(file, settings)
    from liepoisson.algebra.exact_numbers import as_float, is_zero
    from liepoisson.formula.parameters import flattened
    from liepoisson.inputs.names import MAX_TITLE

    if file.symbols:
        from liepoisson.formula.scope import read_declaration

        name, shape = read_declaration(file.symbols[0])
        value = ",".join("1" * shape[0]) if shape else "1"
        raise ParameterError(
            f"{file.name} must have numbers for all parameters; got none for {', '.join(file.symbols)}. "
            f"Give them, for example --set {name}={value}."
        )
    for name, value in flattened(file.parameters).items():
        if as_float(value, name) == 0.0 and not is_zero(value):
            raise ParameterError(
                f"{name} must be zero or at least 4.9e-324, to fit into a double; got a smaller number. "
                "Set it to 0, or rescale the system."
            )
    if settings:
        file = file.with_constant_integrals()
    name = file.name + setting_words(settings)
    fits = name.isprintable() and len(name) <= MAX_TITLE  # else it is called as in its file
    return _replaced(file, name=name if fits else file.name)


def _is_path(argument: str) -> bool:
    return argument.endswith(".toml") or "/" in argument or "\\" in argument or Path(argument).is_file()


def read_file(argument: str) -> SystemFile:
    """The system file that an argument names: a path if it looks like one or exists, else a name of the catalog."""
    from liepoisson.catalog import entry
    from liepoisson.model.system_file_reader import read_system_file

    return read_system_file(argument) if _is_path(argument) else entry(argument)


def _read_any_file(argument: str, *, noise: bool = False) -> EquationsFile:
    """The same, or the file of a vector field, or where `noise` is wanted of a system with noise."""
    from liepoisson.formula.toml_text import read_toml
    from liepoisson.model.system_file_reader import read_equations

    return read_equations(read_toml(argument), noise=noise) if _is_path(argument) else read_file(argument)


def with_settings(file: F, settings: Sequence[str]) -> F:
    """The file, under its own name, with other values for some parameters, and values for symbols that had none."""
    title, given = file.name, set[str]()
    for setting in settings:
        name, value = _read_setting(setting, file)
        if name in given:
            raise ParameterError(f"--set must give each parameter once; {name} comes twice. Remove one.")
        given.add(name)
        if len(file.scope.shapes.get(name, ())) > 1:
            raise ParameterError(f"--set gives numbers and vectors; {name} is a matrix. Write it into a system file.")
        try:
            file = file.with_parameters({name: value})
        except ParameterError as error:
            raise ParameterError(f"--set {setting:.{_MOST_SHOWN}}: {error}") from error
    return _replaced(file, name=title) if settings else file


def with_symbols(file: F, settings: Sequence[str], names: Sequence[str]) -> F:
    """The file with values that were set, and symbols for other parameters that have one, vectors by components."""
    file = with_settings(file, settings)
    given = {setting.partition("=")[0].strip() for setting in settings}
    values, declared = dict(file.parameters), list(file.symbols)
    for name in names:
        if name in given:
            raise ParameterError(f"--set and --free exclude each other; {name} has both. Leave one of them out.")
        shape = file.scope.shapes.get(name, ())
        if name not in values or len(shape) > 1:
            known = [known for known in values if len(file.scope.shapes[known]) < 2]
            raise ParameterError(
                f"--free must name a parameter of {file.name!r} that has a value; got {name!r:.60}. "
                f"{did_you_mean(name, known)}Known: {', '.join(known) or 'none'}."
            )
        del values[name]
        declared.append(f"{name}[{shape[0]}]" if shape else name)
    return _replaced(file, parameters=values, symbols=tuple(declared)) if names else file


def _replaced(file: F, **changes: Any) -> F:
    return replace(cast("Any", file), **changes)


def setting_words(settings: Sequence[str]) -> str:
    """What follows the name of a system with other parameters, as it was typed: ", epsilon = 1/3, a = (1, 0, 0)"."""
    words: list[str] = []
    for setting in settings:
        name, _, text = (part.strip() for part in setting.partition("="))
        items = [item.strip() for item in text.removeprefix("[").removesuffix("]").split(",")]
        words.append(f", {name} = " + (f"({', '.join(items)})" if len(items) > 1 else items[0]))
    return "".join(words)


def _read_setting(setting: str, file: EquationsFile) -> tuple[str, Value]:
    from liepoisson.formula.expression import constant

    name, sign, text = (part.strip() for part in setting.partition("="))
    if not (name and sign and text):
        known = {key: shape for key, shape in file.scope.shapes.items() if key not in file.scope.scalars}
        meant = name if name in known else next(iter(known), "")
        hint = _example(meant, known[meant]) if meant else f"{file.name} has no parameters: leave it out."
        raise ParameterError(f"--set must be name=value; got {setting!r:.{_MOST_SHOWN}}. {hint}")
    is_vector = "," in text or text.startswith("[")
    items = text.removeprefix("[").removesuffix("]").split(",") if is_vector else [text]
    try:
        numbers = tuple(constant(item.strip()) for item in items)
    except ExpressionError as error:
        raise ParameterError(f"--set {setting:.{_MOST_SHOWN}}: {error.within_formula()}") from error
    return name, numbers if is_vector else numbers[0]


def _example(name: str, shape: tuple[int, ...]) -> str:
    if len(shape) > 1:
        return "Write the matrix into a system file."
    return f"Write for example --set {name}={','.join(['1'] * (shape[0] if shape else 1))}."
