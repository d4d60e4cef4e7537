"""The reader of the table [bracket] of a system file: an algebra, formulas, a magnetic field, or canonical pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import exact
from liepoisson.formula.parameters import Value
from liepoisson.formula.scope import Scope
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.model.value_reader import ValueReader

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie_algebra import LieAlgebra

BRACKET_KEYS = (
    *("algebra", "structure_constants", "matrices", "basis_names", "extension", "W", "variables", "constant"),
    *("canonical", "momenta", "tensor", "magnetic", "guiding_centre", "charge", "mass", "casimirs", "angles"),
)


class BracketReader(ValueReader):
    """Turns the table of a bracket into the bracket."""

    def bracket(self, table: dict[str, Any], parameters: Mapping[str, Value], symbols: tuple[str, ...]) -> Bracket:
        """The bracket of a table, with its angles."""
        self.check_keys(("bracket",), table, BRACKET_KEYS)
        found = self.bracket_without_angles(table, parameters, symbols)
        if "angles" not in table:
            return found
        angles = self.texts(("bracket", "angles"), table["angles"])
        return self.guarded(("bracket", "angles"), lambda: found.with_angles(angles))

    def bracket_without_angles(
        self, table: dict[str, Any], parameters: Mapping[str, Value], symbols: tuple[str, ...]
    ) -> Bracket:
        """The bracket of a table by the key that says how it is given."""
        declared = [*_declarations(parameters), *symbols]
        self.guarded(("parameters",), lambda: Scope(symbols=declared))
        if "canonical" in table:
            return self.canonical(table)
        of_algebra = self.one_of(table, ("algebra", "structure_constants", "matrices"))
        if kind := self.one_of(table, ("magnetic", "guiding_centre")):
            return self.magnetic(kind, table, declared)
        if other := next((key for key in ("charge", "mass") if key in table), None):
            message = "only a bracket with the key magnetic or guiding_centre has one. Remove the key."
            raise self.toml.error(("bracket", other), message)
        if "tensor" in table or ("casimirs" in table and of_algebra is None):
            return self.tensor(table, declared)
        algebra = self.algebra(table, declared)
        extension = self.extension(table, declared)
        if "variables" in table:
            names = self.texts(("bracket", "variables"), table["variables"])
            if len(names) != extension.dimension:
                got = f"{len(names)} for an extension of dimension {extension.dimension}"
                raise self.toml.error(("bracket", "variables"), f"wanted one name per field; got {got}. Correct one.")
            extension = self.guarded(("bracket", "variables"), lambda: extension.rename(*names))
        named = next((key for key in ("variables", "basis_names") if key in table), None)
        found = self.guarded(("bracket", named) if named else ("bracket",), lambda: algebra @ extension)
        found = self.with_constant(found, table["constant"], declared) if "constant" in table else found
        if "casimirs" not in table:
            return found
        keys = ("bracket", "casimirs")
        casimirs = self.texts(keys, table["casimirs"])
        own = sorted(found.symbols)
        more = [one for one in declared if one.partition("[")[0].strip() not in own]
        return self.guarded(keys, lambda: found.with_casimirs(casimirs, symbols=more))

    def with_constant(self, bracket: Bracket, given: object, symbols: Sequence[str]) -> Bracket:
        """The bracket with the constant part of a table: constant.l1.l2 = "k" adds k to {l1, l2}."""
        keys, scope = ("bracket", "constant"), Scope(symbols=symbols)
        entries: dict[tuple[str | int, str | int], Any] = {}
        for first, row in self.table(keys, given).items():
            for second, value in self.table((*keys, first), row).items():
                entries[first, second] = self.coefficient((*keys, first, second), value, scope)
        return self.guarded(keys, lambda: bracket.with_constant(entries))

    def tensor(self, table: dict[str, Any], symbols: Sequence[str]) -> Bracket:
        """The bracket of a Poisson tensor that is given by formulas: tensor.x.y = "x*y" is {x, y} = x y."""
        from liepoisson.structure.tensor_bracket import PoissonTensor

        if other := next((key for key in table if key not in ("variables", "tensor", "casimirs", "angles")), None):
            message = "a Poisson tensor is given by variables, tensor, casimirs and angles alone. Remove the key."
            raise self.toml.error(("bracket", other), message)
        if missing := next((key for key in ("variables", "tensor") if key not in table), None):
            raise self.toml.error(("bracket",), f"wanted the key {missing} of a Poisson tensor. Write it.")
        names = self.texts(("bracket", "variables"), table["variables"])
        entries: dict[tuple[str | int, str | int], Any] = {}
        for first, row in self.table(("bracket", "tensor"), table["tensor"]).items():
            for second, entry in self.table(("bracket", "tensor", first), row).items():
                keys = ("bracket", "tensor", first, second)
                function = entry if isinstance(entry, str) else self.number(keys, entry)
                given: dict[tuple[str | int, str | int], Any] = {(first, second): function}
                self.guarded(keys, partial(PoissonTensor, names, given, symbols=symbols, check=False))
                entries |= given
        found = self.guarded(("bracket", "tensor"), lambda: PoissonTensor(names, entries, symbols=symbols))
        return self.with_casimirs(found, table, symbols)

    def magnetic(self, kind: str, table: dict[str, Any], symbols: Sequence[str]) -> Bracket:
        """The bracket of a charge in a magnetic field, or of its guiding centre; its tensor follows from the field."""
        from liepoisson.structure.magnetic_brackets import guiding_centre, magnetic

        known = (kind, "variables", "charge", "mass", "casimirs", "angles")
        if other := next((key for key in table if key not in known), None):
            message = f"a bracket with the key {kind} is given by {', '.join(known)} alone. Remove one of the two keys."
            raise self.toml.error(("bracket", other), message)
        make, keys = (magnetic if kind == "magnetic" else guiding_centre), ("bracket", kind)
        given: dict[str, Any] = {
            key: self.entries(("bracket", key), table[key]) for key in ("charge", "mass") if key in table
        }
        if "variables" in table:
            given["variables"] = self.texts(("bracket", "variables"), table["variables"])
        field: Any = self.entries(keys, table[kind])
        return self.with_casimirs(self.guarded(keys, lambda: make(field, symbols=symbols, **given)), table, symbols)

    def with_casimirs(self, bracket: Bracket, table: dict[str, Any], symbols: Sequence[str]) -> Bracket:
        """The bracket with the Casimirs of a table, which are checked."""
        keys = ("bracket", "casimirs")
        casimirs = self.texts(keys, table.get("casimirs", []))
        return self.guarded(keys, lambda: bracket.with_casimirs(casimirs, symbols=symbols))

    def canonical(self, table: dict[str, Any]) -> Bracket:
        """The canonical bracket of a number of degrees of freedom, or of coordinates by name."""
        from liepoisson.structure.canonical_bracket import canonical

        if other := next((key for key in table if key not in ("canonical", "momenta", "angles")), None):
            message = "a canonical bracket is given by canonical, momenta and angles alone. Remove the key."
            raise self.toml.error(("bracket", other), message)
        keys, given = ("bracket", "canonical"), table["canonical"]
        if not isinstance(given, list):
            number = self.number(keys, given)
            size: Any = int(number) if isinstance(number, Fraction) and number.denominator == 1 else number
            return self.guarded(keys, lambda: canonical(size))
        names = self.texts(keys, given)
        momenta = self.texts(("bracket", "momenta"), table["momenta"]) if "momenta" in table else None
        return self.guarded(keys, lambda: canonical(names=names, momenta=momenta))

    def algebra(self, table: dict[str, Any], symbols: Sequence[str]) -> LieAlgebra:
        """The Lie algebra by its name, its structure constants or matrices that span it."""
        from liepoisson.structure.lie_algebra import LieAlgebra

        key = self.one_of(table, ("algebra", "structure_constants", "matrices"))
        if key is None:
            known = "algebra, structure_constants or matrices"
            raise self.toml.error(
                ("bracket",), f'wanted one of {known}; got none. Write for example algebra = "so(3)".'
            )
        keys, given = ("bracket", key), table[key]
        if key == "algebra":
            if "basis_names" in table:
                message = "a named algebra has names for its basis already. Remove basis_names."
                raise self.toml.error(("bracket", "basis_names"), message)
            return self.guarded(keys, lambda: read_algebra(self.text(keys, given), symbols))
        names = self.texts(("bracket", "basis_names"), table["basis_names"]) if "basis_names" in table else None
        entries = self.array(keys, given, symbols, depth=3)
        if key == "structure_constants":
            return self.guarded(keys, lambda: LieAlgebra(entries, basis_names=names))
        matrices = [[[exact(entry) for entry in row] for row in matrix] for matrix in entries]
        return self.guarded(keys, lambda: LieAlgebra.from_matrices(matrices, basis_names=names))

    def extension(self, table: dict[str, Any], symbols: Sequence[str]) -> Extension:
        """The extension by its name or its products; one field without either."""
        from liepoisson.structure.extension import Extension

        key = self.one_of(table, ("extension", "W"))
        if key == "W":
            entries: Any = self.array(("bracket", "W"), table["W"], symbols, depth=3)
            return self.guarded(("bracket", "W"), lambda: Extension(entries))
        keys = ("bracket", "extension")
        text = self.text(keys, table["extension"]) if key else "trivial()"
        return self.guarded(keys, lambda: read_extension(text, symbols))

    def one_of(self, table: Mapping[str, object], keys: Sequence[str]) -> str | None:
        """The key that is there of those that exclude each other; None if there is none."""
        present = [key for key in keys if key in table]
        if len(present) > 1:
            raise self.toml.error(("bracket", present[1]), f"{' and '.join(present)} exclude each other. Remove one.")
        return present[0] if present else None


def _declarations(values: Mapping[str, Value]) -> list[str]:
    """The parameters as symbols are declared, with their shapes."""
    found: list[str] = []
    for name, value in values.items():
        shape = ()
        if isinstance(value, tuple):
            shape = (len(value), len(value[0])) if isinstance(value[0], tuple) else (len(value),)
        found.append(f"{name}[{','.join(map(str, shape))}]" if shape else name)
    return found
