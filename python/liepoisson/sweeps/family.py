"""Systems as functions of their parameters, and tops among them as plain numbers."""

from __future__ import annotations

import inspect
import pickle
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from liepoisson.compile.field import Field, TopField
from liepoisson.errors import InertiaWarning, ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import shown
from liepoisson.noise.noisy_system import NoisySystem
from liepoisson.numeric.systems import HasField
from liepoisson.sweeps.identity import is_system_file

if TYPE_CHECKING:
    from liepoisson.model.system_file import EquationsFile

Shape: TypeAlias = tuple[int, ...]
_SYMPY = RLock()
"""SymPy's caches, and the list of warning filters, are not made for several threads."""


@dataclass(frozen=True)
class NumericTop:
    """A top as plain numbers: what integration needs, without the exact algebra."""

    name: str  # how it is called
    top: TopField  # its parameters
    vector_length: int = 3

    def field(self) -> Field:
        """The vector field as plain data."""
        return self.top


class Family(ABC):
    """The systems that a sweep runs through."""

    name: str  # how they are called
    shapes: Mapping[str, Shape]  # shapes of the parameters that can be set, by name
    defaults: Mapping[str, Any]  # values of those that need not be

    @property
    def bracket_parameters(self) -> set[str]:
        """Parameters that the bracket is known to depend on."""
        return set()

    def check(self, parameters: Mapping[str, Array]) -> None:
        """Refuse unknown names, missing values and wrong shapes."""
        for name, values in parameters.items():
            if name not in self.shapes:
                known = ", ".join(self.shapes) or "none"
                raise ParameterError(f"{self.name} has no parameter {name!r} that can be set; known: {known}.")
            wanted, got = self.shapes[name], values.shape[1:]
            if wanted is not _ANY and wanted != got:
                raise ParameterError(f"{name} must have the shape {wanted}; got {got}. Give a list of its components.")
        missing = [name for name in self.shapes if name not in parameters and name not in self.defaults]
        if missing:
            raise ParameterError(
                f"{self.name} must have numbers for all parameters; got none for {', '.join(missing)}. Give them in "
                "parameters, or as axes."
            )

    @abstractmethod
    def system(self, values: Mapping[str, Any]) -> Any:
        """The system with these values (numbers, tuples of them)."""

    def has_noise(self, values: Mapping[str, Any]) -> bool:
        """Whether the system with these values is one with noise."""
        return isinstance(self.system(values), NoisySystem)

    def top(self, values: Mapping[str, Any]) -> TopField | None:
        """The system as a top, if it is one and this can be told without building it."""
        return None

    def numeric(self, values: Mapping[str, Any]) -> HasField:
        """What integration needs of the system."""
        top = self.top(values)
        return self.system(values) if top is None else NumericTop(self.name, top)


def quiet(system: Any) -> Any:
    """The system without noise."""
    return system.system if isinstance(system, NoisySystem) else system


_ANY: Shape = (-1,)


class FileFamily(Family):
    """A system file whose parameters and symbols have values that vary."""

    def __init__(self, tables: Mapping[str, Any], path: str) -> None:
        self._tables = dict(tables)
        self._path = path
        self.name = self._file.name
        scope = self._file.scope
        self.shapes = {name: shape for name, shape in scope.shapes.items() if name not in scope.scalars}
        self.defaults = self._file.parameters

    def __reduce__(self) -> tuple[Callable[..., FileFamily], tuple[bytes, str]]:
        """Pickled are the tables; a process that unpickles them for every piece reads and compiles them once."""
        return _unpickled, (pickle.dumps(self._tables), self._path)

    @cached_property
    def _file(self) -> EquationsFile:
        from liepoisson.formula.toml_text import TomlText
        from liepoisson.model.system_file_reader import read_equations

        return read_equations(TomlText(self._path, "", self._tables), noise=True)

    def has_noise(self, values: Mapping[str, Any]) -> bool:
        """Whether the file has a table [noise]."""
        return "noise" in self._tables

    @property
    def bracket_parameters(self) -> set[str]:
        """Those that it contains, or components of which it contains."""
        bracket = getattr(getattr(self._file, "bare", self._file), "bracket", None)
        owners = {self._file.scope.owner(symbol) for symbol in bracket.symbols} if bracket else set[str]()
        return {name for name in self.shapes if name in owners}

    def system(self, values: Mapping[str, Any]) -> Any:
        """The system with these values, as a Top where it is one."""
        top = self.top(values)
        if top is not None:
            return _top_of(top, self.name)
        with _SYMPY, warnings.catch_warnings():
            warnings.simplefilter("ignore", InertiaWarning)
            exact = {name: _exact(value) for name, value in values.items()}
            parameters = {**self._file.parameters, **exact}
            file: Any = self._file
            return replace(file, parameters=parameters, symbols=(), integrals={}).system()

    def top(self, values: Mapping[str, Any]) -> TopField | None:
        """The parameters of the top, from formulas in those of the file."""
        formulas = self._top_formulas
        if formulas is None:
            return None
        names = [name for name in self.shapes if name not in values]
        known = {**{name: self.defaults[name] for name in names}, **values}
        given = [float(x) for name in self.shapes for x in np.ravel(np.array(known[name], object))]
        numbers = np.array(formulas(*given), np.float64)
        if not np.isfinite(numbers).all() or not (numbers[:3] > 0).all():
            raise ParameterError(f"{self.name} must have finite parameters and positive moments; got {dict(values)}.")
        inertia, a, b = (cast("Any", tuple(numbers[k : k + 3].tolist())) for k in (0, 3, 6))
        return TopField(inertia=inertia, a=a, b=b, epsilon=float(numbers[9]))

    @cached_property
    def _top_formulas(self) -> Callable[..., Any] | None:
        """Inertia, a, b and epsilon as functions of all components of all parameters; None if it is no top."""
        from sympy import Symbol

        from liepoisson.algebra.exact_numbers import to_sympy
        from liepoisson.compile.symbols import numpy_function
        from liepoisson.formula.parameters import component_name
        from liepoisson.model.system_file import SystemFile

        if not isinstance(self._file, SystemFile):
            return None
        with _SYMPY:
            declared = tuple(f"{n}[{','.join(map(str, s))}]" if s else n for n, s in self.shapes.items())
            system = replace(self._file, parameters={}, symbols=declared, integrals={}).system()
            top = system.top_parameters
            if top is None or not _is_written_as_top(system, top):
                return None
            names = [
                component_name(n, tuple(k + 1 for k in index), s)
                for n, s in self.shapes.items()
                for index in np.ndindex(s)
            ]
            values = [to_sympy(v) for v in (*top.inertia, *top.a, *top.b, top.epsilon)]
            return numpy_function([Symbol(name) for name in names], values)


@lru_cache(maxsize=16)
def _unpickled(tables: bytes, path: str) -> FileFamily:
    return FileFamily(pickle.loads(tables), path)


class FunctionFamily(Family):
    """A Python function from parameters, by keyword, to a system."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.name = getattr(function, "__qualname__", "system")
        try:
            known = inspect.signature(function).parameters
        except ValueError as error:
            raise ParameterError(
                f"system: wanted a function with named parameters; got {self.name} ({error})."
            ) from error
        self.shapes = dict.fromkeys(known, _ANY)
        self.defaults = {name: p.default for name, p in known.items() if p.default is not inspect.Parameter.empty}

    def system(self, values: Mapping[str, Any]) -> Any:
        """What the function returns."""
        with _SYMPY, warnings.catch_warnings():
            warnings.simplefilter("ignore", InertiaWarning)
            return self.function(**values)


class OneSystem(Family):
    """A system without parameters to set."""

    def __init__(self, system: HasField | NoisySystem) -> None:
        self._system = system
        self.name = system.name
        self.shapes, self.defaults = {}, {}

    def system(self, values: Mapping[str, Any]) -> Any:
        """The system."""
        return self._system


def as_family(system: Any) -> Family:
    """The family that a sweep's `system` stands for."""
    if isinstance(system, Family):
        return system
    if isinstance(system, Mapping):
        if unknown := [key for key in cast("Mapping[Any, Any]", system) if not isinstance(key, str)]:
            raise ParameterError(f"system: wanted tables by name; got the key {shown(unknown[0])}. Write texts.")
        return FileFamily(cast("Mapping[str, Any]", system), "the system of the sweep")
    if isinstance(system, (str, Path)):
        from liepoisson import catalog
        from liepoisson.formula.toml_text import read_toml

        text = str(system)
        path = Path(text) if is_system_file(text) else catalog.path(text)
        return FileFamily(read_toml(path).tables, text)
    if isinstance(system, NoisySystem) or callable(getattr(system, "field", None)):
        return OneSystem(system)
    if callable(system):
        return FunctionFamily(system)
    raise ParameterError(f"system: wanted a name, a file, a system or a function of parameters; got {shown(system)}.")


def _is_written_as_top(system: Any, top: Any) -> bool:
    """Whether bracket and Hamiltonian are those of the top, not only the equations."""
    from sympy import expand

    fields = tuple(system.bracket.fields.values())
    return top.has_bracket(system.bracket) and expand(system.hamiltonian - top.hamiltonian(*fields)) == 0


@lru_cache(maxsize=256)
def _top_of(top: TopField, name: str) -> Any:
    from liepoisson.model.tops import Top

    with _SYMPY, warnings.catch_warnings():
        warnings.simplefilter("ignore", InertiaWarning)
        return Top(inertia=top.inertia, a=top.a, b=top.b, epsilon=top.epsilon, name=name)


def _exact(value: Any) -> Any:
    return tuple(Fraction(v) for v in value) if isinstance(value, tuple) else Fraction(value)
