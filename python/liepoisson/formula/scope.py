"""The names that a formula may use: coordinates, parameters with their values, symbols without."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from liepoisson.errors import ParameterError, did_you_mean
from liepoisson.formula.parameters import GivenValue, Kept, Shape, component_name, read_kept_values
from liepoisson.inputs.names import CONSTANTS, check_name, check_not_reserved

_DECLARATION = re.compile(r"([A-Za-z_][A-Za-z_0-9]{0,99})(?:\[ *([1-9][0-9]{0,2}) *(?:, *([1-9][0-9]{0,2}) *)?\])?")


@dataclass(frozen=True)
class Scope:
    """The names that a formula may use.

    Attributes:
        fields: The names of the components of each field: {"l": ("1", "2", "3")} for l1, l2, l3.
        parameters: Values by name: a scalar, a vector (a sequence) or a matrix (a sequence of rows).
        symbols: Parameters without a value, as they are declared: "epsilon", "a[3]" for a vector, "A[3,3]".
        scalars: Those of the symbols that are coordinates, each a field of one component: "theta", "p_theta".
        remark: What is said of the fields where a name is like none that is known.
        shapes: Shapes of the parameters and symbols, by name.
        components: Components by their short form, with their owner and their indices: l1 is ("l", (1,)).

    Raises:
        ParameterError: a name is reserved, not an identifier, or stands for two things; a value is not exact.
    """

    fields: Mapping[str, Sequence[str]] = field(default_factory=dict[str, Sequence[str]])
    parameters: Mapping[str, GivenValue] = field(default_factory=dict[str, GivenValue])
    symbols: Sequence[str] = ()
    scalars: Sequence[str] = ()
    remark: str = ""
    shapes: Mapping[str, Shape] = field(init=False, repr=False)
    components: Mapping[str, tuple[str, Shape]] = field(init=False, repr=False)
    values: Mapping[str, Kept] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        values = read_kept_values(self.parameters)
        shapes = {name: shape_of(value) for name, value in values.items()}
        for name, shape in map(read_declaration, self.symbols):
            if name in shapes:
                raise ParameterError(f"a name must stand for one thing; {name!r} is given twice. Remove one.")
            shapes[name] = shape
        for name in (*self.fields, *shapes):
            _check_name(name, twice=name in self.fields and name in shapes)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "components", _components(self.fields, shapes))
        for name in self.components:
            check_not_reserved(name, "a name of a component")

    def owner(self, name: str) -> str | None:
        """The field, parameter or symbol to which a name belongs, itself or as a component; None if unknown."""
        if name in self.fields or name in self.shapes:
            return name
        return self.components[name][0] if name in self.components else None

    def coordinates(self) -> set[str]:
        """The names of all coordinates."""
        vectors = {f"{name}{component}" for name, components in self.fields.items() for component in components}
        return vectors | set(self.scalars)

    def numbers(self) -> set[str]:
        """The names of all scalars: coordinates, parameters and symbols, and the components of vectors and matrices."""
        return {name for name, shape in self.shapes.items() if not shape} | set(self.components)

    def suggestion(self, name: str) -> str:
        """The end of a message about an unknown name: the nearest known ones, and all of them."""
        known = [*self.fields, *self.shapes]
        counted = self._counted(name)
        hint = self._beyond(name) or (
            f"Did you mean {counted}? " if counted else did_you_mean(name, [*known, *self.components])
        )
        listed = [*known, *CONSTANTS]
        shown = ", ".join(listed[:40]) + (", ..." if len(listed) > 40 else "")
        remark = f". {self.remark}" if self.remark and not hint else ""
        return f"{hint}Known {'are' if len(listed) > 1 else 'is'} {shown}{self._components_in_words()}{remark}"

    def _counted(self, name: str) -> str:
        """The component that a field with a number stands for where components have names: lr for l1 on se(2)."""
        field, number = re.fullmatch(r"(.*?)([0-9]*)", name, re.DOTALL).groups()  # pyright: ignore[reportOptionalMemberAccess]  # always matches
        components = self.fields.get(field, ())
        index = int(number[:3]) if number else 0
        return f"{field}{components[index - 1]}" if 0 < index <= len(components) else ""

    def _beyond(self, name: str) -> str:
        """How many components a vector has of which a later one is meant: l4 for l1, l2, l3."""
        vector, number = name.rstrip("0123456789"), name[len(name.rstrip("0123456789")) :]
        shape = (len(self.fields[vector]),) if vector in self.fields else self.shapes.get(vector, ())
        return (
            f"{vector} has {shape[0]} components. "
            if number and len(shape) == 1 and not 1 <= int(number[:3]) <= shape[0]
            else ""
        )

    def _components_in_words(self) -> str:
        """How the components of the fields are called: "; components lr1, lr2, lr3, ..., lt3"."""
        names = [f"{name}{component}" for name, components in self.fields.items() for component in components]
        few = names if len(names) <= 6 else [*names[:3], "...", *names[-3:]]
        return f"; components {', '.join(few)}" if names else ""


def read_declaration(text: str) -> tuple[str, Shape]:
    """The name and the shape of a symbol that is declared as "epsilon", "a[3]" or "A[3,3]".

    Raises:
        ParameterError: not such a declaration.
    """
    match = _DECLARATION.fullmatch(text.strip()) if isinstance(text, str) else None  # pyright: ignore[reportUnnecessaryIsInstance]
    if match is None:
        raise ParameterError(
            f"a symbol must be declared by its name, a vector with its length; got {text!r:.60}. "
            'Write for example "epsilon" or "a[3]".'
        )
    return match[1], tuple(int(n) for n in match.groups()[1:] if n)


def _components(fields: Mapping[str, Sequence[str]], shapes: Mapping[str, Shape]) -> dict[str, tuple[str, Shape]]:
    listed = [(f"{name}{c}", name, (i,)) for name, cs in fields.items() for i, c in enumerate(cs, start=1)]
    for name, shape in shapes.items():
        indices = product(*(range(1, n + 1) for n in shape)) if shape else ()
        listed += [(component_name(name, index, shape), name, index) for index in indices]
    components: dict[str, tuple[str, Shape]] = {}
    for short, owner, index in listed:
        if short in components or short in shapes:
            other = components[short][0] if short in components else short
            raise ParameterError(
                f"a name must stand for one thing; {short} is a component of {owner} and belongs to {other}, too. "
                "Rename one of them."
            )
        components[short] = (owner, index)
    return components


def shape_of(value: Kept) -> Shape:
    """The shape of a value: () of a number, (n,) of a vector, (m, n) of a matrix."""
    if not isinstance(value, tuple):
        return ()
    return (len(value), len(value[0])) if isinstance(value[0], tuple) else (len(value),)


def _check_name(name: str, *, twice: bool) -> None:
    check_name(name)
    if twice:
        raise ParameterError(f"a name must stand for one thing; {name} is a field and a parameter. Rename one of them.")
