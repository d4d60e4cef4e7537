r"""The coordinates of a bracket: their names, fields, angles and time, and what callers give in terms of them."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar, cast

from liepoisson.algebra.exact_numbers import as_expression, symbols_of
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import Column, Parameter, read_parameter
from liepoisson.inputs.given import listed
from liepoisson.structure.given_functions import check_distinct

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.algebra.exact_numbers import Exact

C = TypeVar("C", bound="Coordinates")


class Coordinates(ABC):
    """The coordinates of a bracket, some of which are components of vectors."""

    angles: tuple[str, ...] = ()
    """Names of the coordinates that are angles: states that differ by a turn of one are the same."""

    clock: ClassVar[str | None] = None
    """Name of the coordinate that is time; of a `Suspension`."""

    period: Expr | None = None
    """The period of time there, if there is one."""

    coefficients: frozenset[str] = frozenset()
    """Names that are like coordinates and stand for coefficients in the functions of a system."""

    @cached_property
    @abstractmethod
    def coordinate_names_in_order(self) -> tuple[str, ...]:
        """Names of the coordinates, field by field."""

    @property
    @abstractmethod
    def dimension(self) -> int:
        """Number N of coordinates."""

    @property
    @abstractmethod
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields."""

    @property
    @abstractmethod
    def field_lengths(self) -> tuple[int, ...]:
        """Number of components of each field."""

    @property
    @abstractmethod
    def has_scalar_fields(self) -> bool:
        """Whether each field is one coordinate with its own name, as theta and p_theta of a canonical bracket."""

    @property
    @abstractmethod
    def vectors(self) -> Mapping[str, Sequence[str]]:
        """The fields that are vectors, with the names of their components: {"l": ("1", "2", "3")} for l1, l2, l3."""

    @property
    @abstractmethod
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic."""

    @property
    def coordinate_names(self) -> set[str]:
        """Names of the coordinates, as a set."""
        return set(self.coordinate_names_in_order)

    def check_parameter_names(self, names: set[str]) -> None:
        """Refuse parameters that are named like a coordinate: a derivative would take one for the other.

        Raises:
            BracketError: there is such a name; the message lists them.
        """
        check_distinct(self.coordinate_names, names)

    def check_without_time(self, what: str) -> None:
        """Refuse a bracket with a clock, which another one that is made of it would not have.

        Raises:
            BracketError: a coordinate is time.
        """
        if self.clock is not None:
            raise BracketError(
                f"{what} has no time; got {self!r}, whose {self.clock} and period would be coordinates like any other. "
                f"Take it of bracket.base, which is without time, and write {self.clock} into the Hamiltonian then; "
                f'or make time a coordinate by hand, product(bracket.base, lp.canonical(names=["{self.clock}"])).'
            )

    @property
    def periods(self) -> dict[str, Expr]:
        r"""The periods of the coordinates that are points of circles, by name: $2\pi$ of an angle, that of time."""
        from liepoisson.structure.circles import turn

        found = dict.fromkeys(self.angles, turn()) if self.angles else {}
        return found if self.period is None or self.clock is None else {**found, self.clock: self.period}

    @property
    def scalars(self) -> tuple[str, ...]:
        """The coordinates that belong to no vector."""
        inside = {f"{field}{component}" for field, components in self.vectors.items() for component in components}
        return tuple(name for name in self.coordinate_names_in_order if name not in inside)

    @cached_property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates, field by field: l1, l2, l3, alpha1, ..., beta3 for so(3) and three fields."""
        from sympy import Symbol

        return tuple(Symbol(name) for name in self.coordinate_names_in_order)

    @property
    def angle_variables(self) -> tuple[Symbol, ...]:
        """The coordinates that are angles."""
        return tuple(x for x in self.variables if str(x) in self.angles) if self.angles else ()

    @property
    def fields(self) -> dict[str, Column]:
        """The coordinates as one column vector per field, by name."""
        from sympy import Matrix

        n = self.field_lengths[0]
        blocks = (self.variables[i : i + n] for i in range(0, self.dimension, n))
        return {name: Matrix(block) for name, block in zip(self.field_names, blocks, strict=True)}

    def in_own_variables(self, expression: Expr) -> Expr:
        """The expression in `variables`: for SymPy, a symbol l1 that was made with assumptions is another one."""
        own = {str(variable): variable for variable in self.variables}
        foreign = {
            s: own[str(s)] for s in expression.free_symbols if s.is_Symbol and str(s) in own and s != own[str(s)]
        }
        return cast("Expr", expression.xreplace(foreign)) if foreign else expression

    def _read_components(self, point: Sequence[Parameter]) -> list[Exact]:
        items = listed(point, "point", self.coordinate_names_in_order)
        if items is None or len(items) != self.dimension:
            got = f"{len(items)} numbers" if items is not None else repr(point)
            raise ShapeError(f"point must be {self.dimension} numbers, one per coordinate; got {got}.")
        return [read_parameter(item, f"point[{k}]") for k, item in enumerate(items)]

    def _read_point(self, point: Sequence[Parameter]) -> list[Exact]:
        values = self._read_components(point)
        if free := {name for value in values for name in symbols_of(value)}:
            raise ParameterError(f"point must consist of numbers; got the symbols {sorted(free)}. Give them values.")
        return values


def read_function(bracket: Coordinates, given: object, what: str) -> Expr:
    """A function of the coordinates that a caller gives, in `variables`.

    Other symbols are coefficients, except what has the name of a coordinate and is none: it would be a constant.  Of a
    function without any coordinate that holds for names in other letters, too, such as L1 for l1.

    Raises:
        ParameterError: it is no expression, or has a part that is like a coordinate and none.
    """
    from sympy import Indexed, Symbol
    from sympy.core.function import AppliedUndef

    expression = bracket.in_own_variables(as_expression(given, what))
    others = expression.atoms(Symbol, Indexed, AppliedUndef).difference(bracket.variables)
    is_constant = not expression.free_symbols & {*bracket.variables}
    for part in sorted(others, key=lambda part: (-len(str(part)), str(part))):  # l[1] before its parts
        name = _name_of(part)
        alike = [known for known in bracket.coordinate_names_in_order if _plain(known) == _plain(name)]
        own = next((known for known in alike if is_constant or _letters(known) == _letters(name)), None)
        if own is None and name in bracket.field_names:
            own = f"the field {name}"
        if own is None or (str(part) in bracket.symbols | bracket.coefficients):
            continue
        raise ParameterError(
            f"{what}: wanted the coordinates {', '.join(bracket.field_names)} as in bracket.variables, and "
            f"coefficients; got {part} ({type(part).__name__}), which is like {own} and none of them. Correct it, "
            "or rename it if it is a coefficient."
        )
    return expression


def with_coefficients(bracket: C, names: Iterable[str]) -> C:
    """The same bracket, of whose functions these names are coefficients, however like coordinates they are."""
    like = frozenset(names) - bracket.coefficients
    if not {*map(_plain, like)} & {*map(_plain, bracket.coordinate_names_in_order), *map(_plain, bracket.field_names)}:
        return bracket
    made = copy(bracket)
    made.coefficients = bracket.coefficients | like
    return made


def _name_of(part: Any) -> str:
    """The name of a symbol, of an entry l[1] or of a function l1(t)."""
    from sympy.core.function import AppliedUndef

    return part.func.__name__ if isinstance(part, AppliedUndef) else str(getattr(part, "name", part))


def _letters(name: str) -> str:
    """A name without underscores and brackets, so that l[1] and l_1 are like l1."""
    return re.sub(r"[\W_]", "", name)


def _plain(name: str) -> str:
    """The same in small letters, so that L1 is like l1, too."""
    return _letters(name).casefold()
