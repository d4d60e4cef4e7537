"""Files of vector fields: equations of motion in TOML, in the place of a bracket and a Hamiltonian.

The format is described in `liepoisson.model.system_file`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, cast

from liepoisson.errors import ExpressionError, LiePoissonError
from liepoisson.formula.parameters import Value
from liepoisson.formula.scope import Scope
from liepoisson.formula.toml_text import TomlText
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.system_file import EquationsFile
from liepoisson.model.vector_field import VectorField


@explains_its_methods
@dataclass(frozen=True)
class VectorFieldFile(EquationsFile):
    """What the file of a vector field says.

    Attributes:
        name: How the vector field is called.
        equations: The rates by the names of the coordinates, in the order of the state.
        parameters: Values by name: exact numbers, vectors, matrices.
        symbols: Parameters without value, as declared: "epsilon", "a[3]".
        angles: Names of coordinates that are angles.
        integrals: Formulas that are claimed to be constant, by name.
        source: Where the vector field is described, or None.
        path: The file, as messages call it.
        toml: Its text, in which messages find the line of a key; None if there is no such text.
    """

    name: str
    equations: Mapping[str, str]
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    symbols: tuple[str, ...] = ()
    angles: tuple[str, ...] = ()
    integrals: Mapping[str, str] = field(default_factory=dict[str, str], hash=False)
    source: str | None = None
    path: str = "file of a vector field"
    toml: TomlText | None = field(default=None, repr=False, compare=False)

    @cached_property
    def scope(self) -> Scope:
        """The names that the formulas of the file may use."""
        names = tuple(self.equations)
        return Scope(parameters=cast("Any", self.parameters), symbols=(*names, *self.symbols), scalars=names)

    def with_constant_integrals(self) -> VectorFieldFile:
        """The file without those of its integrals that are not found constant, as with other values of parameters."""
        if not self.integrals:
            return self
        found = replace(self, integrals={}).system()
        return replace(self, integrals={name: f for name, f in self.integrals.items() if found.is_constant(f)})

    def system(self) -> VectorField:
        """The vector field, ready to be searched or integrated.

        Raises:
            SystemFileError: a formula has no meaning, or a parameter does not occur; the message names the file.
        """
        try:
            return VectorField(
                self.equations,
                cast("Any", self.parameters),
                name=self.name,
                symbols=self.symbols,
                angles=self.angles,
                integrals=self.integrals,
                source=self.source,
            )
        except ExpressionError as error:
            raise self.error(("equations",), error.within_formula()) from error
        except LiePoissonError as error:
            raise self.error(("equations",), str(error)) from error
