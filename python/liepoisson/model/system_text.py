"""Systems written as system files: the exact text from which `read_system` gives the same system back.

The text is read again and compared before it is returned, so that what cannot be written is refused, not altered.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.errors import LiePoissonError, SystemFileError
from liepoisson.formula.scope import Scope
from liepoisson.formula.toml_text import parse_toml
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.names import MOMENTUM_OF_TIME
from liepoisson.inputs.refusals import shown
from liepoisson.io.files import write_atomically
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.model.system import System
from liepoisson.model.system_file_reader import parse_system_file, read_equations
from liepoisson.model.vector_field import VectorField
from liepoisson.structure.canonical_bracket import canonical
from liepoisson.structure.suspension import Suspension
from liepoisson.structure.tensor_bracket import PoissonTensor

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie_algebra import LieAlgebra


class WrittenSystem(Protocol):
    """What a layer above writes as a system file."""

    def file_text(self) -> str:
        """The text of the file."""
        ...


_LARGEST = 40
"""Dimension up to which an algebra without a name is written by its structure constants, all of them."""


def system_text(system: System) -> str:
    """The text of a system file: bracket, parameters, Hamiltonian, integrals; all numbers exact.

    A Hamiltonian that was given as a text is written as it was, with its parameters; another one is written out, with
    its parameters inserted.

    Raises:
        SystemFileError: the system cannot be written: it has a function that the grammar does not have, or an algebra
            without a name in more than 40 dimensions.
    """
    text = toml_text(system_tables(system))
    _check(text, system, symbolic=system.as_given.hamiltonian is not None)
    return text


def system_tables(system: System) -> dict[str, Any]:
    """The tables of a system file, before it is tried whether they give the same system.

    Raises:
        SystemFileError: an algebra without a name has more than 40 dimensions.
    """
    given = system.as_given
    symbolic = given.hamiltonian is not None
    bracket = system.symbolic_bracket if symbolic else system.bracket
    period = bracket.period
    if isinstance(bracket, Suspension):
        bracket = bracket.base
    values = system.values if symbolic else {}
    tables: dict[str, Any] = {"name": system.name}
    if system.source:
        tables["source"] = system.source
    angles = {"angles": list(bracket.angles)} if bracket.angles else {}
    tables["bracket"] = {**_bracket_table(system, bracket), **angles}
    tables["parameters"] = {name: value_text(value) for name, value in values.items()}
    if symbols := _symbols(system, bracket, given.symbols if symbolic else ()):
        tables["parameters"]["symbols"] = symbols
    tables["hamiltonian"] = {"expression": given.hamiltonian or formula_text(_without_momentum(system))}
    if period is not None:
        tables["hamiltonian"]["period"] = formula_text(period)
    tables["integrals"] = _integrals(system, symbolic=symbolic)
    if isinstance(system, CanonicalSystem) and system.quadratures:
        tables["quadratures"] = {name: formula_text(rate) for name, rate in system.quadratures.items()}
    return {name: table for name, table in tables.items() if table}


def read_system_text(text: str, kind: str = "System") -> System:
    """The system that `system_text` has written; `kind` is the name of its class.

    Raises:
        SystemFileError: the text describes no system; the message names the key and the line.
    """
    file = parse_system_file(text, "the system of the file")
    return file.canonical_system() if kind == CanonicalSystem.__name__ else file.system()


def vector_field_text(field: VectorField) -> str:
    """The text of a file from which `read_system` gives the same vector field; all numbers exact.

    Formulas that were given as texts are written as they were.

    Raises:
        SystemFileError: it has a function that the grammar does not have.
    """
    given = field.as_given
    tables: dict[str, Any] = {"name": field.name} | ({"source": field.source} if field.source else {})
    tables |= {"angles": list(field.angles)} if field.angles else {}
    tables["equations"], tables["integrals"] = (
        {name: f if isinstance(f, str) else formula_text(f) for name, f in formulas.items()}
        for formulas in (given.equations, given.integrals)
    )
    tables["parameters"] = {name: value_text(value) for name, value in field.values.items()}
    if given.symbols:
        tables["parameters"]["symbols"] = list(given.symbols)
    text = toml_text(tables)
    try:
        found = read_vector_field_text(text)
        same = found.as_given == given or (
            _are_same(*({str(x): f for x, f in one.equations.items()} for one in (found, field)))
            and _are_same(found.integrals, field.integrals)
            and found.periods == field.periods
        )
    except LiePoissonError as error:
        raise SystemFileError(f"the vector field {field.name!r} cannot be written as a file ({error})") from error
    if not same or found.parameters != field.parameters:
        raise SystemFileError(
            f"the vector field {field.name!r} cannot be written as a file: what is read back is not the same. Give its "
            "equations as texts."
        )
    return text


def read_vector_field_text(text: str) -> VectorField:
    """The vector field that `vector_field_text` has written.

    Raises:
        SystemFileError: the text describes none; the message names the key and the line.
    """
    found = read_equations(parse_toml(text, "the vector field of the file"))
    return cast("VectorField", found.system())


@explains_its_arguments
def write_system(system: System | VectorField | WrittenSystem, path: str | Path) -> Path:
    """Writes a system file, whole or not at all; `read_system` gives the same system back.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> top = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon="1/3", name="weakly twisted top")
        >>> file = lp.systems.write_system(top, Path(mkdtemp()) / "top.toml")
        >>> lp.read_system(file)
        <System 'weakly twisted top' on so(3) ⊗ Leibniz(3, epsilon = 1/3)>

    Args:
        system: The system, the vector field, or the system with noise.
        path: A name that ends in .toml.

    Raises:
        SystemFileError: as for `system_text`, or the name does not end in .toml.
        OutputError: the file cannot be written.
    """
    if not isinstance(system, System) and not hasattr(type(system), "file_text"):
        raise SystemFileError(f"wanted a system such as Top.kovalevskaya(); got {shown(system)}")
    if not isinstance(path, (str, Path)):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise SystemFileError(f"wanted the name of a file; got {shown(path)}. Write for example top.toml.")
    path = Path(path)
    if path.suffix != ".toml":
        raise SystemFileError(f"wanted a name that ends in .toml; got {path}. Write for example top.toml.")
    text = system_text(system) if isinstance(system, System) else system.file_text()
    write_atomically(path, text.encode())
    return path


def _check(text: str, system: System, *, symbolic: bool) -> None:
    """Reads the text and compares the equations, term by term."""
    try:
        found = read_system_text(text, type(system).__name__)
        same = (
            found.component_names == system.component_names
            and (_are_of_one_field(found, system) or _are_same(_terms(found), _terms(system)))
            and found.periods == system.periods
            and _are_equal(found.hamiltonian, system.hamiltonian)
            and _are_same(found.integrals, system.integrals)
            and _are_same(_pairs(found.partial_integrals), _pairs(system.partial_integrals))
            and _are_same(getattr(found, "quadratures", {}), getattr(system, "quadratures", {}))
            and (not symbolic or found.parameters == system.parameters)
        )
    except LiePoissonError as error:
        raise SystemFileError(f"the system {system.name!r} cannot be written as a system file ({error})") from error
    if not same:
        raise SystemFileError(
            f"the system {system.name!r} cannot be written as a system file: what is read back is not the same. Give "
            f"the {'entries of the bracket' if symbolic else 'Hamiltonian'} as {'texts' if symbolic else 'a text'}."
        )


def _without_momentum(system: System) -> Any:
    """The Hamiltonian without the momentum of time, which is written nowhere."""
    from sympy import Symbol

    return system.hamiltonian if system.clock is None else system.hamiltonian - Symbol(MOMENTUM_OF_TIME)


def _are_same(found: Mapping[str, Any], wanted: Mapping[str, Any]) -> bool:
    return found.keys() == wanted.keys() and all(_are_equal(found[name], wanted[name]) for name in wanted)


def _pairs(partial: Mapping[str, tuple[Any, Any]]) -> dict[str, Any]:
    return {f"{name} {k}": one for name, both in partial.items() for k, one in enumerate(both)}


def _are_equal(found: Any, wanted: Any) -> bool:
    """Whether two expressions are the same, if need be once they have one denominator and are multiplied out."""
    from sympy import expand, fraction, together

    if found == wanted or expand(found - wanted) == 0:
        return True
    numerator: Any = fraction(together(found - wanted))[0]
    return expand(numerator) == 0


def _terms(system: System) -> dict[str, Any]:
    """The terms of the bracket by their places."""
    return {f"{i} {j} {m}": to_sympy(c) for i, j, m, c in system.bracket.terms()}


def _are_of_one_field(found: System, system: System) -> bool:
    """Whether both brackets were made of the same magnetic field, so that their entries are the same functions."""
    fields = [getattr(one.bracket, "origin", None) for one in (found, system)]
    return fields[0] is not None and fields[0] == fields[1]


def _bracket_table(system: System, bracket: Bracket) -> dict[str, Any]:
    if isinstance(system, CanonicalSystem):
        return {"canonical": list(system.coordinates), "momenta": list(system.momenta)}
    if canonical := _canonical(bracket):
        return canonical
    if isinstance(bracket, PoissonTensor):
        return _tensor(bracket)
    table = {**_algebra(bracket.algebra), **_extension(bracket.extension), "variables": list(bracket.field_names)}
    if bracket.constant:
        names, rows = bracket.coordinate_names_in_order, dict[str, dict[str, str]]()
        for (i, j), value in bracket.constant.items():
            rows.setdefault(names[i], {})[names[j]] = formula_text(to_sympy(value))
        table["constant"] = rows
    if bracket.given_casimirs:
        table["casimirs"] = [formula_text(casimir) for casimir in bracket.given_casimirs]
    return table


def _tensor(bracket: PoissonTensor) -> dict[str, Any]:
    """The table of a bracket that is given by formulas, or by a magnetic field."""
    names = bracket.coordinate_names_in_order
    table: dict[str, Any] = {"variables": list(names)}
    if field := bracket.origin:
        table[field.kind] = [formula_text(one) for one in field.components]
        table |= {"charge": formula_text(field.charge), "mass": formula_text(field.mass)}
    else:
        table["tensor"] = rows = dict[str, dict[str, str]]()
        for (i, j), entry in bracket.formulas.entries.items():
            rows.setdefault(names[i], {})[names[j]] = formula_text(entry)
    casimirs = [formula_text(casimir) for casimir in bracket.given_casimirs]
    return table | ({"casimirs": casimirs} if casimirs else {})


def _canonical(bracket: Bracket) -> dict[str, Any] | None:
    """The table of a canonical bracket; None for another one."""
    names, n = bracket.coordinate_names_in_order, bracket.dimension // 2
    if not bracket.has_algebra or not bracket.has_scalar_fields or bracket.entries() or bracket.dimension % 2:
        return None
    found = canonical(names=names[:n], momenta=names[n:])
    return {"canonical": list(names[:n]), "momenta": list(names[n:])} if found.constant == bracket.constant else None


def _algebra(algebra: LieAlgebra) -> dict[str, Any]:
    try:
        named = read_algebra(algebra.name, sorted(algebra.symbols))
        if named.brackets == algebra.brackets and named.basis_names == algebra.basis_names:
            return {"algebra": algebra.name}
    except LiePoissonError:
        pass  # a name of the user's own
    if algebra.dimension > _LARGEST:
        raise SystemFileError(
            f"the algebra {algebra.name!r} cannot be written: it has no name of the catalog of algebras, and its "
            f"dimension {algebra.dimension} is above {_LARGEST}"
        )
    return {
        "structure_constants": value_text(algebra.structure_constants),
        "basis_names": list(algebra.basis_names),
    }


def _extension(extension: Extension) -> dict[str, Any]:
    # as it is printed, "Leibniz(3, epsilon = 1)", and as it is written, "leibniz(3, 1)"
    call = extension.name.replace("Leibniz", "leibniz").replace("epsilon = ", "")
    call = "trivial()" if call == "trivial" else call
    try:
        if read_extension(call, sorted(extension.symbols)).products == extension.products:
            return {"extension": call}
    except LiePoissonError:
        pass  # a name of the user's own
    return {"W": value_text(extension.tensor)}


def _symbols(system: System, bracket: Bracket, declared: Sequence[str]) -> list[str]:
    """Parameters without a value, as a file declares them."""
    symbols = bracket.symbols | {str(symbol) for symbol in system.hamiltonian.free_symbols - set(system.variables)}
    declared = [name for name in declared if name not in system.component_names]
    scope = Scope(parameters=system.values, symbols=declared)
    return [*declared, *sorted(symbols - set(scope.shapes) - set(scope.components))]


def _integrals(system: System, *, symbolic: bool) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, text in system.as_given.integrals.items():
        found[name] = text if symbolic and isinstance(text, str) else formula_text(system.integrals[name])
    for name, both in system.as_given.partial_integrals.items():
        kept = symbolic and all(isinstance(text, str) for text in both)
        function, vanishing = both if kept else map(formula_text, system.partial_integrals[name])
        found[name] = {"expression": function, "on": f"{vanishing} = 0"}
    return found


def formula_text(expression: Any) -> str:
    """An expression in the grammar of formulas; whether it is, the caller finds out by reading it."""
    from sympy import E, Function

    # SymPy prints the number e as E, which in formulas is the name of something else
    number = expression.replace(E, Function("exp")(1, evaluate=False)) if expression.has(E) else expression
    return str(number).replace("**", "^")


def value_text(value: Any) -> Any:
    """A number, a vector or a matrix, as texts that are read exactly."""
    return [value_text(item) for item in value] if isinstance(value, Sequence) else formula_text(to_sympy(value))


def toml_text(tables: Mapping[str, Any]) -> str:
    """Tables as the text of a TOML file; those that are empty are left out."""
    tables = {name: table for name, table in tables.items() if table}
    plain = [f"{_key(name)} = {_literal(value)}" for name, value in tables.items() if not isinstance(value, dict)]
    blocks = ["\n".join(plain)]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines = [f"{_key(key)} = {_literal(value)}" for key, value in table.items()]
            blocks.append("\n".join([f"[{_key(name)}]", *lines]))
    return "\n\n".join(blocks) + "\n"


def _key(name: str) -> str:
    return name if name.isidentifier() and name.isascii() else json.dumps(name)


def _literal(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_literal(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_literal, value)) + "]"
    # JSON writes characters beyond 16 bits as two halves, which TOML does not read; so they stay as they are
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
