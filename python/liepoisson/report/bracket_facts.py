"""What is reported about a bracket: its algebra, its extension, Jacobi, Casimirs, rank, leaves and symmetries.

Each topic computes its facts when it is made, tells them in lines, and as data for JSON.
"""

# ruff: noqa: D102 - lines() and record() are described once, in Topic

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any, final

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.errors import BracketError, LiePoissonError, ParameterError
from liepoisson.formula.styles import LATEX, Style
from liepoisson.report.lines import (
    Equation,
    Line,
    Name,
    Sign,
    Statement,
    Written,
    definition_lines,
    joined,
    record_of,
    record_of_formula,
    ring,
    shortened,
    unequal,
)
from liepoisson.report.printing import Formula
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Exact
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.classification import Classification
    from liepoisson.structure.lie_algebra import LieAlgebra


class Topic(ABC):
    """One part of a report.

    Attributes:
        key: Its name in JSON.
        title: Its heading.
    """

    key: str
    title: str

    @abstractmethod
    def lines(self) -> list[Line]:
        """The facts in words and formulas."""

    @abstractmethod
    def record(self) -> Any:
        """The facts as data that JSON can write."""


@final
class AlgebraFacts(Topic):
    """The Lie algebra: dimension, type, Killing form, series."""

    key, title = "algebra", "Lie algebra"

    def __init__(self, bracket: Bracket) -> None:
        algebra = bracket.algebra
        self.name = algebra.name
        self.dimension = algebra.dimension
        self.type = {
            "abelian": algebra.is_abelian,
            "semisimple": algebra.is_semisimple,
            "nilpotent": algebra.is_nilpotent,
            "solvable": algebra.is_solvable,
        }
        self.signature = _signature(algebra)
        self.derived = [ideal.dimension for ideal in algebra.derived_series()]
        self.centre = algebra.centre().dimension

    def lines(self) -> list[Line]:
        words = [kind for kind, holds in self.type.items() if holds] or ["neither semisimple nor solvable"]
        found: list[Line] = [(f"{self.name}, dimension {self.dimension}, {words[0]}",)]
        if self.signature is not None:
            plus, minus, zero = self.signature
            found.append((f"Killing form of signature ({plus}, {minus}, {zero}) (positive, negative, zero)",))
        if not self.type["semisimple"]:
            dimensions = ", ".join(map(str, self.derived))
            found.append((f"derived series of dimensions {dimensions}; centre of dimension {self.centre}",))
        return found

    def record(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "dimension": self.dimension,
            **self.type,
            "killing_signature": self.signature,
            "derived_series": self.derived,
            "centre_dimension": self.centre,
        }


@final
class ExtensionFacts(Topic):
    """The commutative algebra: its products and its normal form."""

    key, title = "extension", "Extension"

    def __init__(self, bracket: Bracket) -> None:
        self.extension = bracket.extension
        self.fields = tuple(bracket.fields)
        self.unit = self._unit_element()
        self.products = [
            (self.fields[mu], self.fields[nu], _combination(_dense(row, len(self.fields)), self.fields))
            for (mu, nu), row in self.extension.products.items()
        ]
        self.classification, self.obstacle = self._classified()

    def _unit_element(self) -> Formula | None:
        try:
            unit = self.extension.unit()
        except BracketError:  # not associative: the bracket fails, which is told there
            return None
        return None if unit is None else _combination(unit, self.fields)

    def _classified(self) -> tuple[Classification | None, str]:
        try:
            return self.extension.classify(), ""
        except LiePoissonError as refusal:  # symbolic parameters, or a dimension beyond the tables
            return None, str(refusal)

    def lines(self) -> list[Line]:
        n = len(self.fields)
        found: list[Line] = [(f"{self.extension.name}, {n} field{'s' if n > 1 else ''}: {', '.join(self.fields)}",)]
        if n == 1 and self.unit is not None:
            return found
        if self.unit is not None:
            found.append(("unit ", self.unit))
        shown = [p for p in self.products if self.unit is None or str(self.unit) not in (_e(p[0]), _e(p[1]))]
        for u, v, product in shown:
            found.append((Equation(_product(u, v), product),))
        if not shown:
            found.append(("all other products vanish" if self.unit is not None else "all products vanish",))
        found.append(self._normal_form() or (f"no normal form: {self.obstacle}",))
        return found

    def _normal_form(self) -> Line:
        """What `str(classification)` says, with formulas."""
        here = self.classification
        if here is None:
            return ()
        line: Line = (f"{here.extension.name} is ", ring(here.name))
        if here.conditions:
            line = (*line, " for ", *joined(unequal(Formula(condition)) for condition in here.conditions))
        if here.adjoined:
            line = (*line, f", by a change of basis over {here.field_extension}")
        for values, other in here.exceptional_cases:
            pieces: list[Written] = [_equality(names, value) for names, value in values]
            pieces += [unequal(Formula(condition)) for condition in other.conditions]
            line = (*line, "; ", *joined(pieces), ": ", ring(other.name))
        return line

    def record(self) -> dict[str, Any]:
        return {
            "name": self.extension.name,
            "fields": list(self.fields),
            "unit": None if self.unit is None else record_of(self.unit),
            "products": [{"left": u, "right": v, "product": record_of(product)} for u, v, product in self.products],
            "normal_form": None if self.classification is None else str(self.classification),
            "not_classified_because": self.obstacle or None,
        }


@final
class JacobiFacts(Topic):
    """The bracket and the proof that it is one."""

    key, title = "bracket", "Bracket"

    def __init__(self, bracket: Bracket) -> None:
        self.name = repr(bracket)
        self.coordinates = [str(variable) for variable in bracket.variables]
        self.constant = [
            (self.coordinates[i], self.coordinates[j], Formula(to_sympy(c))) for (i, j), c in bracket.constant.items()
        ]
        self.certificate = bracket.jacobi_certificate()

    def lines(self) -> list[Line]:
        names = self.coordinates
        shown = ", ".join(names) if len(names) <= 12 else f"{', '.join(names[:6])}, ..., {names[-1]}"
        lines: list[Line] = [(f"{self.name}, {len(names)} coordinates: {shown}",)]
        if self.constant:
            parts: list[Written] = [Equation(_braces(u, v), c) for u, v, c in self.constant]
            more = f", ... ({len(parts)} in all)" if len(parts) > _MOST_CONSTANTS else ""
            lines.append(("constant part ", *joined(parts[:_MOST_CONSTANTS]), *([more] if more else [])))
        return [*lines, (str(self.certificate),)]

    def record(self) -> dict[str, Any]:
        certificate = self.certificate
        return {
            "name": self.name,
            "coordinates": self.coordinates,
            **({"constant_part": [self._record(*entry) for entry in self.constant]} if self.constant else {}),
            "jacobi": {
                "proved": certificate.holds,
                "method": certificate.method,
                "n_triples": certificate.n_triples,
                "failures": [str(failure) for failure in certificate.failures],
            },
        }

    @staticmethod
    def _record(first: str, second: str, value: Formula) -> dict[str, Any]:
        return {"of": [first, second], "value": record_of(value)}


_MOST_CONSTANTS = 12
"""Entries of a constant part that are printed."""


@final
class CasimirFacts(Topic):
    """Generators of the Casimirs, verified, and whether they are all."""

    key, title = "casimirs", "Casimirs"

    def __init__(self, bracket: Bracket, notation: VectorNotation) -> None:
        self.report = bracket.casimir_report()
        self.notation = notation
        self.bracket = bracket

    @cached_property
    def formulas(self) -> list[tuple[str, Formula, Expr]]:
        """Name, formula and expression of each generator."""
        found = enumerate(self.report.generators, start=1)
        return [(f"C{k}", self.notation.formula(expression), expression) for k, expression in found]

    @cached_property
    def definitions(self) -> list[Equation]:
        """What the scalar products in the formulas are where they are not the usual ones."""
        special = [self.notation.formula(e) for case in self.report.exceptional for e in case.generators]
        return self.notation.definitions([*(formula for _, formula, _ in self.formulas), *special])

    def lines(self) -> list[Line]:
        report = self.report
        found: list[Line] = [(Equation(Name(name), formula),) for name, formula, _ in self.formulas]
        found += definition_lines(self.definitions)
        found += [(f"with {meaning}",) for meaning in self._meanings]
        if self.formulas:
            verified = "proved: J grad C = 0 for each" if report.verified else "NOT verified: J grad C is not zero"
            found.append((f"{verified} ({report.method})",))
        found.append((self._completeness(),))
        for case in report.exceptional:
            at = Statement.about(case.condition, self.bracket)
            formulas = joined(shortened(self.notation.formula(generator)) for generator in case.generators)
            found.append(("there are others for ", at, ": ", *formulas))
            if case.jumps:
                found.append((*joined(map(Name, case.jumps)), " jump at ", at, ": other functions than near by"))
        if report.examined and not report.exceptional:
            looked_at = joined(Statement.about(condition, self.bracket) for condition in report.examined)
            found.append(("no more for special values either; examined: ", *looked_at))
        if report.undecided:
            found.append((f"not decided: {'; '.join(report.undecided)}",))
        return found

    @property
    def _meanings(self) -> list[str]:
        """What the fields are as matrices, where traces occur: one sentence, or one for each summand of the algebra."""
        field, meanings = self.bracket.field_names[0], self.report.meanings
        numbers = [f" in tr{k}" if len(meanings) > 1 else "" for k in range(1, len(meanings) + 1)]
        others = " (the other fields likewise)" if len(self.bracket.field_names) > 1 else ""
        return [meaning.format(x=field) + n + others for meaning, n in zip(meanings, numbers, strict=True)]

    def _completeness(self) -> str:
        report = self.report
        if report.complete and not report.independent:
            return "none: J has full rank at generic points"
        if report.complete:
            return f"complete: {report.independent} independent, as many as the corank of J allows"
        return f"perhaps not all: {report.independent} independent, of at most {report.corank}; {report.limits}"

    def record(self) -> dict[str, Any]:
        report = self.report
        return {
            "generators": [{"name": n, **record_of_formula(f, e)} for n, f, e in self.formulas],
            "definitions": [record_of(definition) for definition in self.definitions],
            "matrices": self._meanings,
            "verified": report.verified,
            "complete": report.complete,
            "independent": report.independent,
            "corank": report.corank,
            "method": report.method,
            "limits": report.limits or None,
            "exceptional": [
                {
                    "condition": case.condition,
                    "generators": [record_of_formula(self.notation.formula(e), e) for e in case.generators],
                    "jumps": list(case.jumps),
                }
                for case in report.exceptional
            ],
            "examined": list(report.examined),
            "undecided": list(report.undecided),
        }


def _signature(algebra: LieAlgebra) -> tuple[int, int, int] | None:
    """Of the Killing form; None where parameters leave signs open."""
    try:
        return algebra.killing_signature()
    except ParameterError:
        return None


def _equality(names: Sequence[str], value: Expr) -> Written:
    """One or more symbols with one value: s = t = 0."""
    right: Written = Formula(value)
    for name in reversed(names):
        right = Equation(Name(name), right)
    return right


def _product(u: str, v: str) -> Sign:
    """The product of two basis elements of an extension, named by their fields."""
    return Sign(lambda style: " ".join(style.component(_e(field), "e", field) for field in (u, v)))


def _braces(u: str, v: str) -> Sign:
    """The bracket of two coordinates."""

    def write(style: Style) -> str:
        left, right = (r"\{", r"\}") if style is LATEX else ("{", "}")
        return f"{left}{Name(u).write(style)}, {Name(v).write(style)}{right}"

    return Sign(write)


def _e(field: str) -> str:
    return f"e_{field}"


def _combination(coefficients: Iterable[Exact], fields: tuple[str, ...]) -> Formula:
    from sympy import S, Symbol

    terms = zip(coefficients, fields, strict=True)
    expression = sum((to_sympy(c) * Symbol(_e(field)) for c, field in terms if not is_zero(c)), S.Zero)
    return Formula(expression, {}, {_e(field): ("e", field) for field in fields})


def _dense(row: dict[int, Exact], n: int) -> list[Exact]:
    zero = next(iter(row.values())) * 0
    return [row.get(k, zero) for k in range(n)]
