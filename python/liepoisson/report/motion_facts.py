"""What is reported about a motion: Hamiltonian, equations, and how it is integrated."""

# ruff: noqa: D102 - lines() and record() are described once, in Topic

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any, final

from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.formula.parameters import Value, flattened
from liepoisson.report.bracket_facts import Topic
from liepoisson.report.decimals import LONG_NUMBER, Decimal
from liepoisson.report.limits import too_large_formula
from liepoisson.report.lines import (
    Column,
    Equation,
    Line,
    Name,
    Rate,
    VectorName,
    Written,
    definition_lines,
    record_of,
    record_of_formula,
)
from liepoisson.report.printing import Form, Formula, Image
from liepoisson.report.vector_equations import VectorEquations, vector_equations
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System
    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.bracket import Bracket

MOST_EQUATIONS = 12
"""Further equations are left out in text and LaTeX; JSON has them all."""


@dataclass(frozen=True)
class NamedForm:
    """A system written with names for its parameters, and the values behind the names."""

    bracket: Bracket
    hamiltonian: Expr
    values: Mapping[str, Value]


def named_form(system: System) -> NamedForm:
    """The system as it was given, or, if its equations are those of a top, with the names I, a, b and epsilon."""
    top = system.top_parameters
    if top is not None:
        return _named_top(system, top)
    energy = system.symbolic_hamiltonian
    same = _equal_entries(system.values)
    return NamedForm(system.symbolic_bracket, energy.subs(_by_name(energy, same)) if same else energy, system.values)


def _equal_entries(values: Mapping[str, Value]) -> dict[Any, Any]:
    """Of symmetric matrices of parameters, the names of the entries below the diagonal and of those that equal them."""
    from sympy import Symbol

    same: dict[Any, Any] = {}
    for name, value in values.items():
        rows = [row for row in value if isinstance(row, tuple)] if isinstance(value, tuple) else []
        below = [(i, j) for i in range(len(rows)) for j in range(i)]
        square = bool(rows) and len(rows) == len(rows[0])
        if square and all(is_zero(to_sympy(rows[i][j]) - to_sympy(rows[j][i])) for i, j in below):
            places = product(range(len(rows)), repeat=2)
            names = dict(zip(places, flattened({name: value}), strict=True))
            same |= {Symbol(names[i, j]): Symbol(names[j, i]) for i, j in below}
    return same


def _named_top(system: System, top: TopParameters) -> NamedForm:
    """Zero vectors and a zero epsilon get no name, so that their terms do not appear."""
    from sympy import Matrix, Symbol

    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.extensions import leibniz
    from liepoisson.structure.lie_algebras import so

    given: dict[str, Value] = {"I": top.inertia, "a": top.a, "b": top.b, "epsilon": top.epsilon}
    vectors = {n: v for n, v in given.items() if isinstance(v, tuple) and not all(map(_vanishes, v))}
    zero = (to_sympy(top.epsilon) * 0,) * 3
    named: dict[str, Any] = {n: tuple(Symbol(f"{n}{i}") for i in (1, 2, 3)) for n in vectors}
    strength: Exact = top.epsilon if is_zero(top.epsilon) else Symbol("epsilon")
    symbolic = TopParameters(named["I"], named.get("a", zero), named.get("b", zero), strength)
    bracket = so(3) @ leibniz(3, strength)
    if tuple(bracket.fields) != tuple(system.bracket.fields):
        bracket = bracket.rename(*system.bracket.fields)
    energy = symbolic.hamiltonian(*(Matrix(column) for column in bracket.fields.values()))
    return NamedForm(bracket, energy, given)


def _vanishes(value: object) -> bool:
    """Whether an entry of a vector of parameters vanishes identically."""
    return not isinstance(value, tuple) and is_zero(value)  # pyright: ignore[reportArgumentType]


@final
class HamiltonianFacts(Topic):
    """The Hamiltonian with named parameters, and their values."""

    key, title = "hamiltonian", "Hamiltonian"

    def __init__(self, system: System, notation: VectorNotation, named: NamedForm) -> None:
        self.expression = system.hamiltonian
        self.values = dict(named.values)
        if too_large_formula(system.hamiltonian):
            self.formula, self.values = notation.components(system.hamiltonian), dict(system.values)
        elif self._names_the_given_one(named):
            same = named.bracket is system.bracket
            self.formula = (notation if same else VectorNotation(named.bracket)).formula(named.hamiltonian)
        else:  # the equations are those of a top, but H contains Casimirs besides
            self.formula = notation.formula(system.hamiltonian)
        self.definitions = notation.definitions([self.formula])
        self.symbols = sorted({*system.bracket.symbols, *_names(self.expression)} - {*map(str, system.variables)})
        self.matrices = {atom.matrix for atom in self.formula.atoms.values() if isinstance(atom, (Form, Image))}

    def _names_the_given_one(self, named: NamedForm) -> bool:
        from sympy import Symbol

        values = {Symbol(name): to_sympy(value) for name, value in flattened(self.values).items()}
        inserted = named.hamiltonian.subs(_by_name(named.hamiltonian, values), simultaneous=True)
        return is_zero(inserted - self.expression)

    def lines(self) -> list[Line]:
        found: list[Line] = [(Equation(Name("H"), self.formula),), *definition_lines(self.definitions)]
        found += [(Equation(Name(name), _value(value, name in self.matrices)),) for name, value in self._told()]
        if self.symbols:
            found.append((f"symbolic: {', '.join(self.symbols)}",))
        return found

    def _told(self) -> list[tuple[str, Value]]:
        """The parameters but for those that stand for themselves."""
        return [(name, value) for name, value in self.values.items() if not _stands_for_itself(name, value)]

    def record(self) -> dict[str, Any]:
        return {
            **record_of_formula(self.formula, self.expression),
            "definitions": [record_of(definition) for definition in self.definitions],
            "parameters": {name: _plain_value(value) for name, value in self.values.items()},
            "symbols": self.symbols,
        }


@final
class EquationFacts(Topic):
    """The equations of motion, in vector notation where the algebra has a cross product."""

    key, title = "equations", "Equations"

    def __init__(self, system: System, notation: VectorNotation, named: NamedForm) -> None:
        self.vector: VectorEquations | None = vector_equations(named.bracket, named.hamiltonian)
        self.components = [
            (str(variable), notation.components(value), value) for variable, value in system.equations.items()
        ]

    def equations(self) -> list[Equation]:
        """One equation per field, or per coordinate."""
        if self.vector is not None:
            return [Equation(Rate(VectorName(field)), formula) for field, formula in self.vector.rows]
        return [Equation(Rate(Formula(_symbol(name), {}, f.coordinates)), f) for name, f, _ in self.components]

    def definitions(self) -> list[Equation]:
        """What the vectors in these equations stand for."""
        if self.vector is None:
            return []
        given = [
            Equation(VectorName(name), Column(value) if isinstance(value, tuple) else value)
            for name, value in self.vector.definitions
        ]
        if self.vector.product is not None:
            given.append(Equation(_CrossProduct(), Column(self.vector.product)))
        return given

    def lines(self) -> list[Line]:
        equations = self.equations()
        found: list[Line] = [(equation,) for equation in equations[:MOST_EQUATIONS]]
        if len(equations) > MOST_EQUATIONS:
            found.append((f"... and {len(equations) - MOST_EQUATIONS} more; --format json prints all of them",))
        found += [("with ", definition) for definition in self.definitions()]
        return found

    def record(self) -> dict[str, Any]:
        return {
            "vector": None if self.vector is None else [record_of(equation) for equation in self.equations()],
            "definitions": [record_of(definition) for definition in self.definitions()],
            "components": {name: record_of_formula(formula, value) for name, formula, value in self.components},
        }


@final
class KernelFacts(Topic):
    """Which kernel of the numeric core would integrate the system."""

    key, title = "kernel", "Kernel"

    def __init__(self, system: System) -> None:
        self.missing = sorted({*system.bracket.symbols, *_names(system.hamiltonian)} - {*map(str, system.variables)})
        self.kind: str | None = None
        self.obstacle = f"needs values for {', '.join(self.missing)}" if self.missing else ""
        if not self.missing:
            try:
                self.kind = system.field().kind
            except (UnsupportedFieldError, ParameterError) as refusal:  # also a number that is no double
                self.obstacle = str(refusal)

    def lines(self) -> list[Line]:
        return [(self.kind or self.obstacle,)]

    def record(self) -> dict[str, Any]:
        return {"kind": self.kind, "missing_values": self.missing, "obstacle": self.obstacle or None}


class _CrossProduct:
    """The left side of the definition of u x v."""

    def write(self, style: Any) -> str:
        """The product of two vectors u and v."""
        return style.vector("u") + style.cross + style.vector("v")


def _symbol(name: str) -> Any:
    from sympy import Symbol

    return Symbol(name)


def _names(expression: Expr) -> set[str]:
    return {str(symbol) for symbol in expression.free_symbols}


def _by_name(expression: Expr, values: Mapping[Any, Expr]) -> dict[Any, Expr]:
    """Values for the symbols of an expression, by name: a symbol may have been made with assumptions."""
    named = {str(symbol): value for symbol, value in values.items()}
    return {symbol: named[str(symbol)] for symbol in expression.free_symbols if str(symbol) in named}


def _stands_for_itself(name: str, value: Value) -> bool:
    return all(str(entry) == key for key, entry in flattened({name: value}).items())


def _value(value: Value, diagonal: bool = False) -> Written:
    if not isinstance(value, tuple):
        return _decimal(value) or Formula(to_sympy(value))
    if isinstance(value[0], tuple):
        return _Matrix(tuple(tuple(_value(entry) for entry in row) for row in value if isinstance(row, tuple)))
    rows: list[Any] = [_value(entry) for entry in value]
    if not diagonal and all(map(_vanishes, value)):
        return rows[0]
    return _Diagonal(tuple(rows)) if diagonal else Column(tuple(rows))


def _decimal(value: Exact) -> Decimal | None:
    """A number of many digits as a decimal, if it is one."""
    return Decimal.of(value) if isinstance(value, Fraction) and len(str(value)) > LONG_NUMBER else None


@dataclass(frozen=True)
class _Diagonal:
    """A diagonal matrix by its entries."""

    entries: tuple[Written, ...]

    def write(self, style: Any) -> str:
        """As diag(...)."""
        return style.function("diag", ", ".join(entry.write(style) for entry in self.entries))


@dataclass(frozen=True)
class _Matrix:
    """A matrix by its rows."""

    rows: tuple[tuple[Written, ...], ...]

    def write(self, style: Any) -> str:
        """The rows, one after the other or below each other."""
        return style.matrix([[entry.write(style) for entry in row] for row in self.rows])


def _plain_value(value: Value) -> Any:
    return [_plain_value(entry) for entry in value] if isinstance(value, tuple) else str(value)
