"""The reader of system files: from TOML tables to systems and vector fields.

The format is described in `liepoisson.model.system_file`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.facades import function_of
from liepoisson.formula.expression import check_names
from liepoisson.formula.grammar import parse
from liepoisson.formula.scope import read_declaration
from liepoisson.formula.toml_text import TomlText, parse_toml, read_toml
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.names import MAX_TITLE, check_name
from liepoisson.model.bracket_reader import BRACKET_KEYS, BracketReader
from liepoisson.model.hamiltonian import RESERVED_NAME
from liepoisson.model.system_file import EquationsFile, Integral, Reference, SystemFile

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField
    from liepoisson.model.vector_field_file import VectorFieldFile
    from liepoisson.structure.bracket import Bracket

_KEYS: dict[str, tuple[str, ...]] = {
    table: tuple(keys.split())
    for table, keys in {
        "": "name source description symbols bracket parameters hamiltonian integrals quadratures reference",
        "hamiltonian": "expression period",
        "integral": "expression on source",
        "reference": "state quantity value tolerance source",
        "damping": "kind rate entropy metric forms matrix",
        "noise": "noises inverse_temperature",
        "vector field": "name source description angles equations parameters integrals",
    }.items()
} | {"bracket": BRACKET_KEYS}

_NO_NOISE = {"noise": "Noise moves a state along the leaves of a bracket, and a vector field has none: remove it."}


@explains_its_arguments
def read_system(path: str | Path) -> System | VectorField:
    """The system or vector field that a file describes (`liepoisson.model.system_file` has the format).

    Example:
        >>> system = lp.read_system(lp.catalog.path("kovalevskaya"))
        >>> system.name, str(system.hamiltonian)
        ('kovalevskaya', '-alpha1 + l1**2/4 + l2**2/4 + l3**2/2')

    Args:
        path: A TOML file in UTF-8, at most 1 MB.

    Raises:
        SystemFileError: as in `read_system_file`, or a formula has no meaning; the message names the key and the line.
    """
    return read_equations(read_toml(path)).system()


@explains_its_arguments
def read_system_file(path: str | Path) -> SystemFile:
    """What a system file says, with its references and its claims.

    Example:
        >>> file = lp.systems.read_system_file(lp.catalog.path("twisted-kovalevskaya"))
        >>> file.hamiltonian, file.bracket
        ('dot(l, inv(I)*l)/2 + dot(a, alpha)', so(3) ⊗ Leibniz(3, epsilon))

    Args:
        path: A TOML file in UTF-8, at most 1 MB.

    Raises:
        MissingFileError: there is no such file.
        SystemFileError: it is not TOML, or it does not describe a system; the message names the
            key, and the line where it can be found.
    """
    return read_tables(read_toml(path))


def parse_system_file(text: str, path: str = "system file") -> SystemFile:
    """Read the text of a system file; `path` is how messages call it.

    Raises:
        SystemFileError: as in `read_system_file`.
    """
    return read_tables(parse_toml(text, path))


def read_tables(toml: TomlText) -> SystemFile:
    """What the tables of a system file say.

    Raises:
        SystemFileError: they do not describe a system; the message names the key, and the line where it can be found.
    """
    return _Reader(toml).file()


def read_noisy_tables(toml: TomlText) -> Any:
    """What the tables of a file say that describes a system with noise.

    Raises:
        SystemFileError: they describe none; the message names the key, and the line where it can be found.
    """
    return _Reader(toml).noisy()


def read_equations(toml: TomlText, *, noise: bool = False) -> EquationsFile:
    """What the tables of a file say, whether it describes a system, a damped one or a vector field.

    Where `noise` is wanted, it may also be a system with noise.

    Raises:
        SystemFileError: they describe none; the message names the key, and the line where it can be found.
    """
    if noise and "noise" in toml.tables:
        return read_noisy_tables(toml)
    if "equations" in toml.tables:
        return _Reader(toml).vector_field()
    return _Reader(toml).damped() if "damping" in toml.tables else read_tables(toml)


class _Reader(BracketReader):
    """Turns the tables of a file into its meaning; every method says which key is wrong."""

    def file(self) -> SystemFile:
        self.refuse_noise()
        if "damping" in self.toml.tables:
            raise self.toml.error(
                ("damping",),
                "wanted a system without damping. lp.read_system reads a damped one, and so do the commands that ask "
                "for equations alone (docs/damping.md). Remove the table for the system without damping.",
            )
        file, unused = self.undamped()
        self.refuse_unused(file, unused)
        return file

    def damped(self) -> EquationsFile:
        """A system file with a table [damping], in which parameters may occur, too."""
        self.refuse_noise()
        table = self.table(("damping",), self.toml.tables["damping"])
        self.check_keys(("damping",), table, _KEYS["damping"])
        kinds = ("double bracket", "metriplectic")
        if table.get("kind") not in kinds:
            message = f'wanted one of {", ".join(kinds)}. Write kind = "{kinds[0]}".'
            raise self.toml.error(("damping", "kind"), message)
        if foreign := [key for key in ("entropy", "forms", "matrix") if key in table and table["kind"] == kinds[0]]:
            raise self.toml.error(("damping", foreign[0]), "a double bracket has none. Remove the key.")
        if table["kind"] == kinds[1] and "entropy" not in table:
            raise self.toml.error(("damping",), 'wanted the key entropy. Write for example entropy = "C1".')
        file, unused = self.undamped()
        damping: dict[str, Any] = {key: self.entries(("damping", key), value) for key, value in table.items()}
        words = [
            key
            for key, value in damping.items()
            if key == "kind" or value == "killing" or (key == "entropy" and RESERVED_NAME.fullmatch(str(value)))
        ]
        formulas = {("damping", key): _texts(value) for key, value in damping.items() if key not in words}
        own = self.own_part(file, unused, formulas)
        return function_of("_Reader.damped")(own, damping, file.parameters, file.symbols)

    def noisy(self) -> EquationsFile:
        """A system file with a table [noise], in which parameters may occur, too."""
        tables = self.toml.tables
        if "noise" not in tables:
            raise self.toml.error(
                (),
                "wanted the table [noise]; got a file without noise, which lp.read_system reads. Write for example "
                'noises = ["l1/2"] below [noise].',
            )
        if "damping" in tables:
            message = "noise has its own damping, by inverse_temperature. Remove the table."
            raise self.toml.error(("damping",), message)
        table = self.table(("noise",), tables["noise"])
        self.check_keys(("noise",), table, _KEYS["noise"])
        if "noises" not in table:
            raise self.toml.error(("noise",), 'wanted the key noises. Write for example noises = ["l1/2"].')
        noises, keys = table["noises"], ("noise", "noises")
        texts = tuple(self.texts(keys, noises)) if isinstance(noises, list) else (self.text(keys, noises),)
        given = self.entries(keys := ("noise", "inverse_temperature"), table.get("inverse_temperature", 0))
        if isinstance(given, tuple):
            raise self.toml.error(keys, "wanted one number or formula; got a list. Correct it.")
        file, unused = self.undamped()
        formulas: dict[tuple[str | int, ...], list[str]] = {("noise", "noises", k): [t] for k, t in enumerate(texts)}
        own = self.own_part(file, unused, formulas | {keys: _texts(given)})
        return function_of("_Reader.noisy")(
            name=file.name,
            bare=own,
            noises=texts,
            inverse_temperature=given,
            parameters=file.parameters,
            symbols=file.symbols,
            integrals=file.integrals,
            path=file.path,
            toml=file.toml,
        )

    def refuse_noise(self) -> None:
        """Refuses a table [noise]."""
        if "noise" in self.toml.tables:
            raise self.toml.error(
                ("noise",),
                "wanted a system without noise. lp.stochastic.read_noisy_system reads one with noise, and so do the "
                "commands that follow noise (docs/noise.md); all others need equations of motion, and a path of noise "
                "has none. Remove the table for the system without noise.",
            )

    def own_part(self, file: SystemFile, unused: Sequence[str], formulas: Mapping[Any, Sequence[str]]) -> SystemFile:
        """The file without parameters that occur in these formulas of a further table alone; names are checked."""
        scope = self.guarded(("parameters",), lambda: file.scope)
        used = set[str]()
        for keys, texts in formulas.items():
            for text in texts:
                used |= self.guarded(keys, lambda text=text: check_names(parse(text), text, scope))
        self.refuse_unused(file, [name for name in unused if name not in used])
        return replace(
            file,
            parameters={name: value for name, value in file.parameters.items() if name not in unused},
            symbols=tuple(text for text in file.symbols if read_declaration(text)[0] not in unused),
        )

    def undamped(self) -> tuple[SystemFile, list[str]]:
        """The file apart from [damping] and [noise], and the parameters that do not occur in it."""
        tables = {name: table for name, table in self.toml.tables.items() if name not in ("damping", "noise")}
        below = {key: f"Write it below [{table}]." for table in ("bracket", "hamiltonian") for key in _KEYS[table]}
        if "equations" in tables:
            raise self.toml.error(
                ("equations",),
                "wanted a bracket and a Hamiltonian; got equations. A vector field has no bracket: lp.read_system "
                "reads it, and so do the commands that ask for equations alone (docs/vector-fields.md).",
            )
        self.check_keys((), tables, _KEYS[""], {**below, "equations": "A vector field has them, and no bracket."})
        for key in ("bracket", "hamiltonian"):
            self.table((key,), tables.get(key))
        given = self.table(("parameters",), tables.get("parameters", {}))
        for name in given:
            self.guarded(("parameters", name), partial(check_name, name, "the name of a parameter"))
        parameters = {key: self.value(("parameters", key), item) for key, item in given.items() if key != "symbols"}
        symbols = self.symbols(tables, given)
        bracket = self.bracket(tables["bracket"], parameters, symbols)
        file = SystemFile(
            name=self.name(tables.get("name", Path(self.toml.path).stem)),
            bracket=bracket,
            hamiltonian=self.hamiltonian(tables["hamiltonian"]),
            period=self.period(tables["hamiltonian"]),
            parameters=parameters,
            symbols=symbols,
            integrals=self.integrals(self.table(("integrals",), tables.get("integrals", {}))),
            references=self.references(tables.get("reference", []), bracket),
            quadratures=self.quadratures(tables, symbols),
            source=self.optional_text(("source",), tables),
            description=self.optional_text(("description",), tables),
            path=self.toml.path,
            toml=self.toml,
        )
        return file, self.unused(file)

    def vector_field(self) -> VectorFieldFile:
        from liepoisson.model.vector_field_file import VectorFieldFile

        tables = self.toml.tables
        self.check_keys(
            (), tables, _KEYS["vector field"], {"bracket": "A vector field has none: remove it.", **_NO_NOISE}
        )
        given = self.table(("parameters",), tables.get("parameters", {}))
        read: dict[str, dict[str, str]] = {}
        for key in ("equations", "integrals"):
            table = self.table((key,), tables.get(key, {}))
            read[key] = {name: self.text((key, name), formula) for name, formula in table.items()}
        return VectorFieldFile(
            name=self.name(tables.get("name", Path(self.toml.path).stem)),
            equations=read["equations"],
            parameters={name: self.value(("parameters", name), v) for name, v in given.items() if name != "symbols"},
            symbols=self.symbols({}, given),
            angles=tuple(self.texts(("angles",), tables.get("angles", []))),
            integrals=read["integrals"],
            source=self.optional_text(("source",), tables),
            path=self.toml.path,
            toml=self.toml,
        )

    def name(self, given: object) -> str:
        """How the system is called: one line, of which every character can be written to files and terminals."""
        words = " ".join(self.text(("name",), given).split())
        if len(words) > MAX_TITLE:
            message = f"wanted at most {MAX_TITLE} characters; got {len(words)}. Put more into description."
            raise self.toml.error(("name",), message)
        return "".join(c if c.isprintable() else "\ufffd" for c in words)

    def hamiltonian(self, table: dict[str, Any]) -> str:
        self.check_keys(("hamiltonian",), table, _KEYS["hamiltonian"])
        if "expression" not in table:
            message = 'wanted the key expression. Write for example expression = "dot(l, l)/2".'
            raise self.toml.error(("hamiltonian",), message)
        return self.text(("hamiltonian", "expression"), table["expression"])

    def period(self, table: dict[str, Any]) -> str | None:
        """The formula of the period in time, if there is one; a number may stand without quotes."""
        if "period" not in table:
            return None
        keys, given = ("hamiltonian", "period"), table["period"]
        return self.text(keys, given) if isinstance(given, str) else str(self.number(keys, given))

    def integrals(self, table: dict[str, Any]) -> dict[str, Integral]:
        found: dict[str, Integral] = {}
        for name, given in table.items():
            keys = ("integrals", name)
            if RESERVED_NAME.fullmatch(name):
                message = f"an integral must not be named H, C1, C2, ...; got {name}. Choose another name."
                raise self.toml.error(keys, message)
            if isinstance(given, str):
                found[name] = Integral(self.text(keys, given))
                continue
            inner = self.table(keys, given)
            self.check_keys(keys, inner, _KEYS["integral"])
            if "expression" not in inner:
                raise self.toml.error(keys, 'wanted the key expression. Write expression = "...".')
            on = self.optional_text((*keys, "on"), inner)
            if on is not None and on.count("=") > 1:
                raise self.toml.error(keys, f'on must be one equation; got {on!r:.60}. Write on = "dot(l, alpha) = 0".')
            expression = self.text((*keys, "expression"), inner["expression"])
            found[name] = Integral(expression, on, self.optional_text((*keys, "source"), inner))
        return found

    def quadratures(self, tables: dict[str, Any], symbols: tuple[str, ...]) -> dict[str, str]:
        """Rates by the names of components that follow the motion; only beside a canonical bracket without symbols."""
        given = self.table(("quadratures",), tables.get("quadratures", {}))
        if given and ("canonical" not in tables["bracket"] or symbols):
            message = "wanted a canonical bracket and values for all parameters beside them. Remove the table."
            raise self.toml.error(("quadratures",), message)
        for name in given:
            self.guarded(("quadratures", name), partial(check_name, name, "the name of a component"))
        return {name: self.text(("quadratures", name), rate) for name, rate in given.items()}

    def references(self, given: object, bracket: Bracket) -> tuple[Reference, ...]:
        if not isinstance(given, list):
            raise self.toml.error(("reference",), "wanted tables [[reference]]. Write the name in double brackets.")
        return tuple(self.reference(k, item, bracket) for k, item in enumerate(cast("list[object]", given)))

    def reference(self, k: int, given: object, bracket: Bracket) -> Reference:
        keys = ("reference", k)
        table = self.table(keys, given)
        self.check_keys(keys, table, _KEYS["reference"])
        for key in ("quantity", "value"):
            if key not in table:
                raise self.toml.error(keys, f"wanted the key {key}. Write one.")
        value = self.value((*keys, "value"), table["value"])
        if isinstance(value, tuple) and any(isinstance(item, tuple) for item in value):
            raise self.toml.error((*keys, "value"), "wanted a number or a list of numbers; got a matrix. Flatten it.")
        tolerance = table.get("tolerance")
        return Reference(
            quantity=self.text((*keys, "quantity"), table["quantity"]),
            value=cast("Exact | tuple[Exact, ...]", value),
            state=self.state((*keys, "state"), table["state"], bracket) if "state" in table else None,
            tolerance=None if tolerance is None else self.number((*keys, "tolerance"), tolerance),
            source=self.optional_text((*keys, "source"), table),
        )

    def state(self, keys: tuple[str | int, ...], given: object, bracket: Bracket) -> tuple[Exact, ...]:
        fields, n = bracket.field_names, bracket.field_lengths[0]
        if isinstance(given, dict):
            table = cast("dict[str, object]", given)
            if bracket.has_scalar_fields:  # theta = 1 as well as theta = [1]
                table = {key: item if isinstance(item, list) else [item] for key, item in table.items()}
            self.check_keys(keys, table, fields)
            if missing := [name for name in fields if name not in table]:
                raise self.toml.error(keys, f"wanted a vector for each field; {missing[0]} has none. Add it.")
            vectors = [self.array((*keys, name), table[name], None, depth=1) for name in fields]
            wrong = next((name for name, vector in zip(fields, vectors, strict=True) if len(vector) != n), None)
            if wrong:
                raise self.toml.error((*keys, wrong), f"wanted {n} components; got {len(cast('Any', table[wrong]))}.")
            return tuple(entry for vector in vectors for entry in vector)
        entries = self.array(keys, given, None, depth=1)
        if len(entries) != bracket.dimension:
            raise self.toml.error(keys, f"wanted {bracket.dimension} components; got {len(entries)}. Give all of them.")
        return tuple(entries)

    def symbols(self, tables: dict[str, Any], parameters: dict[str, Any]) -> tuple[str, ...]:
        places: list[tuple[tuple[str, ...], object]] = [
            (("symbols",), tables.get("symbols", [])),
            (("parameters", "symbols"), parameters.get("symbols", [])),
        ]
        found: list[str] = []
        for keys, given in places:
            for text in self.texts(keys, given):
                self.guarded(keys, lambda text=text: read_declaration(text))
                found.append(text.strip())
        return tuple(found)

    def unused(self, file: SystemFile) -> list[str]:
        """Refuse unknown names, and find unused parameters; what needs SymPy is checked when the system is made."""
        self.guarded(("hamiltonian", "expression" if file.period is None else "period"), lambda: file.whole_bracket)
        scope = self.guarded(("parameters",), lambda: file.scope)
        used = {scope.owner(name) for name in file.bracket.symbols}
        for keys, text in file.formulas.items():
            names = self.guarded(keys, lambda text=text: check_names(parse(text), text, scope))
            used |= names if keys[0] == "hamiltonian" else set()
        declared = (read_declaration(text)[0] for text in file.symbols)
        return [name for name in (*file.parameters, *declared) if name not in used]

    def refuse_unused(self, file: SystemFile, names: Sequence[str]) -> None:
        for name in names:
            place = ("parameters", name) if name in file.parameters else ("parameters", "symbols")
            message = f"{name} occurs neither in the bracket nor in the Hamiltonian. Use it or remove it."
            raise self.toml.error(place, message)


def _texts(given: Any) -> list[str]:
    """The formulas in nested tuples."""
    if isinstance(given, tuple):
        return [text for item in cast("tuple[Any, ...]", given) for text in _texts(item)]
    return [given] if isinstance(given, str) else []
