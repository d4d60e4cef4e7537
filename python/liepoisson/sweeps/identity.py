"""What a function or a system of a sweep is, as a digest that changes when the numbers that it gives can change."""

from __future__ import annotations

import builtins
import hashlib
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any, cast

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.noise.noisy_system import NoisySystem

_PLAIN = (type(None), bool, int, float, complex, str, bytes, Fraction, type(Ellipsis), np.generic)


def digest_of(value: Any) -> str:
    """Digest of a function: its code, constants, defaults, closure, and what it uses of its own module.

    What comes from another package is taken by its name.  The code is that of the interpreter at hand, so that another
    version of Python gives another digest.
    """
    return hashlib.sha256(repr(_state(value, ())).encode()).hexdigest()[:16]


def system_tables(system: Any) -> Any:
    """The tables of a system given as a file; any other system as it is."""
    if not isinstance(system, (str, Path)) or not is_system_file(str(system)):
        return system
    from liepoisson.formula.toml_text import read_toml

    return read_toml(Path(system)).tables


def is_system_file(text: str) -> bool:
    """Whether a text is the path of a system file, not a name of the catalog."""
    return text.endswith(".toml") or "/" in text or "\\" in text


def _state(value: Any, above: tuple[int, ...]) -> Any:
    """Nested tuples that stand for a value, the same in every process; `above` holds what is being described."""
    if isinstance(value, _PLAIN):
        return type(value).__name__, repr(value)
    if id(value) in above:
        return "again", len(above) - above.index(id(value))
    inside = (*above, id(value))
    is_container = isinstance(value, (list, tuple, set, frozenset, Mapping, np.ndarray))
    return _state_of_container(value, inside) if is_container else _state_of_code(value, inside)


def _state_of_container(value: Any, inside: tuple[int, ...]) -> Any:
    if isinstance(value, Mapping):
        items = cast("Mapping[Any, Any]", value).items()
        return "mapping", *sorted(repr((_state(key, inside), _state(item, inside))) for key, item in items)
    if isinstance(value, np.ndarray):
        array = cast("np.ndarray[Any, Any]", value)
        content = _state(array.tolist(), inside) if array.dtype.hasobject else hashlib.sha256(array.tobytes()).digest()
        return "array", str(array.dtype), array.shape, content
    if isinstance(value, (list, tuple)):
        return type(value).__name__, *(_state(item, inside) for item in cast("list[Any]", value))
    return "set", *sorted(repr(_state(item, inside)) for item in cast("set[Any]", value))


def _state_of_code(value: Any, inside: tuple[int, ...]) -> Any:
    if isinstance(value, CodeType):
        names = value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars
        shape = value.co_argcount, value.co_posonlyargcount, value.co_kwonlyargcount, value.co_flags
        return "code", value.co_code, names, shape, *(_state(constant, inside) for constant in value.co_consts)
    if isinstance(value, partial):
        made = cast("partial[Any]", value)
        return "partial", *(_state(part, inside) for part in (made.func, made.args, made.keywords))
    if isinstance(value, MethodType):
        return "method", _state(value.__self__, inside), _state(value.__func__, inside)
    if isinstance(value, FunctionType):
        return _state_of_function(value, inside)
    return _state_of_named(value)


def _state_of_named(value: Any) -> Any:
    if isinstance(value, ModuleType):
        return "module", value.__name__
    if isinstance(value, (EquationsOfMotion, NoisySystem)):
        return "system", *system_record(value).items()
    if isinstance(value, (type, BuiltinFunctionType, np.ufunc)) and _package(value) not in ("", "__main__"):
        return "name", _package(value), getattr(value, "__qualname__", value.__name__)
    raise ParameterError(f"it depends on {type(value).__name__!r} {getattr(value, '__name__', '')}".rstrip())


def _state_of_function(function: FunctionType, inside: tuple[int, ...]) -> Any:
    if _package(function) == "liepoisson":
        return "name", function.__module__, function.__qualname__
    cells = [_cell(cell) for cell in function.__closure__ or ()]
    own = (function.__code__, function.__defaults__, function.__kwdefaults__, cells)
    used = {name: function.__globals__[name] for name in sorted(_names(function.__code__) & {*function.__globals__})}
    outside = {name: item for name, item in used.items() if not _is_foreign(item, function)}
    named = [(name, _package(item), getattr(item, "__qualname__", "")) for name, item in used.items()
             if name not in outside]  # fmt: skip
    return "function", *(_state(part, inside) for part in own), tuple(named), _state(outside, inside)


def _cell(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not set yet
        return ("no value",)


def _names(code: CodeType) -> set[str]:
    """The names that code and the functions inside it look up."""
    inner = [constant for constant in code.co_consts if isinstance(constant, CodeType)]
    return set(code.co_names).union(*(_names(part) for part in inner))


def _is_foreign(item: Any, function: FunctionType) -> bool:
    """Whether something with a name of its own comes from another package."""
    has_name = isinstance(item, (type, FunctionType, BuiltinFunctionType, np.ufunc))
    return has_name and _package(item) not in ("", _package(function))


def _package(item: Any) -> str:
    module = getattr(item, "__module__", None) or ("numpy" if isinstance(item, np.ufunc) else "")
    return str(module or (builtins.__name__ if isinstance(item, BuiltinFunctionType) else "")).partition(".")[0]


def system_record(system: Any) -> dict[str, str]:
    """A system as texts that differ where its equations can differ.

    What an expression prints would not do: `pi*l1` is a multiple of l1, or its product with another symbol.
    """
    from sympy import srepr

    from liepoisson.algebra.exact_numbers import to_sympy

    if isinstance(system, NoisySystem):
        noise = {"noises": repr(system.noises), "inverse temperature": srepr(to_sympy(system.inverse_temperature))}
        return system_record(system.system) | noise
    if not hasattr(system, "bracket"):
        return {"equations": repr({str(name): srepr(rate) for name, rate in system.equations.items()})}
    terms = system.bracket.terms()
    entries = [(i, j, m, srepr(to_sympy(c))) for i, j, m, c in terms if m is not None]
    coordinates = ", ".join(map(str, system.bracket.variables))
    record = {"bracket": repr(entries), "coordinates": coordinates, "hamiltonian": srepr(system.hamiltonian)}
    if constant := [(i, j, srepr(to_sympy(c))) for i, j, m, c in terms if m is None]:
        record["constant part of the bracket"] = repr(constant)
    return record


def function_record(function: Callable[..., Any]) -> dict[str, Any]:
    """A function as plain data: its name and digest, or why it has none."""
    name = f"{getattr(function, '__module__', '')}:{getattr(function, '__qualname__', type(function).__name__)}"
    try:
        return {"function": name, "digest": digest_of(function)}
    except ParameterError as error:
        return {"function": name, "unknown": str(error)}
