"""What is reported about a motion: Hamiltonian, equations, and how it is integrated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.formula.parameters import Value, flattened
from liepoisson.report.lines import (
    Equation,
    Line,
    Name,
    Sign,
    Written,
    column,
    definition_lines,
    rate,
    record_of,
    record_of_formula,
    vector_name,
)
from liepoisson.report.printing import LONG_NUMBER, Decimal, Form, Formula, Image
from liepoisson.report.topics import Topic, too_large
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


class Motion:
    """A system with names for its parameters: its Hamiltonian, and its equations where they are not too large."""

    def __init__(self, system: System, notation: VectorNotation) -> None:
        self.system = system
        self.notation = notation
        self.named = named_form(system)

    @cached_property
    def hamiltonian(self) -> Formula:
        """The Hamiltonian with named parameters."""
        given, named = self.system.hamiltonian, self.named
        if too_large("hamiltonian", self.system):
            return self.notation.components(given)
        if self._names_the_given_one():
            notation = self.notation if named.bracket is self.system.bracket else VectorNotation(named.bracket)
            return notation.formula(named.hamiltonian)
        return self.notation.formula(given)  # the equations are those of a top, but H contains Casimirs besides

    def _names_the_given_one(self) -> bool:
        from sympy import Symbol

        values = {Symbol(name): to_sympy(value) for name, value in flattened(dict(self.named.values)).items()}
        inserted = self.named.hamiltonian.subs(_by_name(self.named.hamiltonian, values), simultaneous=True)
        return is_zero(inserted - self.system.hamiltonian)

    def hamiltonian_topic(self) -> Topic:
        """The Hamiltonian, and the values of its parameters."""
        formula, expression = self.hamiltonian, self.system.hamiltonian
        values = dict(self.system.values if too_large("hamiltonian", self.system) else self.named.values)
        definitions = self.notation.definitions([formula])
        symbols = _free_names(self.system)
        matrices = {atom.matrix for atom in formula.atoms.values() if isinstance(atom, (Form, Image))}
        told = [(name, value) for name, value in values.items() if not _stands_for_itself(name, value)]
        lines: list[Line] = [(Equation(Name("H"), formula),), *definition_lines(definitions)]
        lines += [(Equation(Name(name), _value(value, name in matrices)),) for name, value in told]
        if symbols:
            lines.append((f"symbolic: {', '.join(symbols)}",))
        return Topic(
            "hamiltonian",
            lines,
            lambda: {
                **record_of_formula(formula, expression),
                "definitions": [record_of(definition) for definition in definitions],
                "parameters": {name: _plain_value(value) for name, value in values.items()},
                "symbols": symbols,
            },
        )

    @cached_property
    def vector(self) -> VectorEquations | None:
        """The equations in vector notation, where the algebra has a cross product."""
        return vector_equations(self.named.bracket, self.named.hamiltonian)

    @cached_property
    def components(self) -> list[tuple[str, Formula, Expr]]:
        """The equations in components: coordinate, formula, expression."""
        return [(str(x), self.notation.components(value), value) for x, value in self.system.equations.items()]

    def equations(self) -> list[Equation]:
        """One equation per field, or per coordinate."""
        if self.vector is not None:
            return [Equation(rate(vector_name(field)), formula) for field, formula in self.vector.rows]
        return [Equation(rate(Formula(_symbol(name), {}, f.coordinates)), f) for name, f, _ in self.components]

    def definitions(self) -> list[Equation]:
        """What the vectors in these equations stand for."""
        if self.vector is None:
            return []
        given = [
            Equation(vector_name(name), column(value) if isinstance(value, tuple) else value)
            for name, value in self.vector.definitions
        ]
        if self.vector.product is not None:
            given.append(Equation(_CROSS_PRODUCT, column(self.vector.product)))
        return given

    def equation_topic(self) -> Topic:
        """The equations of motion."""
        equations, definitions, components = self.equations(), self.definitions(), self.components
        is_vector = self.vector is not None
        lines: list[Line] = [(equation,) for equation in equations[:MOST_EQUATIONS]]
        if len(equations) > MOST_EQUATIONS:
            lines.append((f"... and {len(equations) - MOST_EQUATIONS} more; --format json prints all of them",))
        lines += [("with ", definition) for definition in definitions]
        return Topic(
            "equations",
            lines,
            lambda: {
                "vector": [record_of(equation) for equation in equations] if is_vector else None,
                "definitions": [record_of(definition) for definition in definitions],
                "components": {name: record_of_formula(formula, value) for name, formula, value in components},
            },
        )


def kernel_topic(system: System) -> Topic:
    """Which kernel of the numeric core would integrate the system."""
    missing, kind = _free_names(system), None
    obstacle = f"needs values for {', '.join(missing)}" if missing else ""
    if not missing:
        try:
            kind = system.field().kind
        except (UnsupportedFieldError, ParameterError) as refusal:  # also a number that is no double
            obstacle = str(refusal)
    record = {"kind": kind, "missing_values": missing, "obstacle": obstacle or None}
    return Topic("kernel", [(kind or obstacle,)], lambda: record)


def _free_names(system: System) -> list[str]:
    """Parameters without a value."""
    names = {*system.bracket.symbols, *map(str, system.hamiltonian.free_symbols)}
    return sorted(names - {*map(str, system.variables)})


_CROSS_PRODUCT = Sign(lambda style: style.vector("u") + style.cross + style.vector("v"))
"""The left side of the definition of u x v."""


def _symbol(name: str) -> Any:
    from sympy import Symbol

    return Symbol(name)


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
        return _matrix([[_value(entry) for entry in row] for row in value if isinstance(row, tuple)])
    rows: list[Any] = [_value(entry) for entry in value]
    if not diagonal and all(map(_vanishes, value)):
        return rows[0]
    return _diagonal(rows) if diagonal else column(rows)


def _decimal(value: Exact) -> Decimal | None:
    """A number of many digits as a decimal, if it is one."""
    return Decimal.of(value) if isinstance(value, Fraction) and len(str(value)) > LONG_NUMBER else None


def _diagonal(entries: Sequence[Written]) -> Sign:
    """A diagonal matrix by its entries."""
    return Sign(lambda style: style.function("diag", ", ".join(entry.write(style) for entry in entries)))


def _matrix(rows: Sequence[Sequence[Written]]) -> Sign:
    """A matrix by its rows."""
    return Sign(lambda style: style.matrix([[entry.write(style) for entry in row] for row in rows]))


def _plain_value(value: Value) -> Any:
    return [_plain_value(entry) for entry in value] if isinstance(value, tuple) else str(value)
