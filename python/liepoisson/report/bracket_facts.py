"""What is reported about a bracket: its algebra, its extension, and the proof that it is one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.errors import BracketError, LiePoissonError, ParameterError
from liepoisson.formula.styles import LATEX, Style
from liepoisson.report.lines import (
    Equation,
    Line,
    Name,
    Sign,
    Written,
    joined,
    record_of,
    ring,
    unequal,
)
from liepoisson.report.printing import Formula
from liepoisson.report.topics import Topic

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Exact
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.certificates import JacobiCertificate
    from liepoisson.structure.classification import Classification
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie_algebra import LieAlgebra

_MOST_CONSTANTS = 12
"""Entries of a constant part, or of a tensor, that are printed."""


def algebra_topic(bracket: Bracket) -> Topic:
    """The Lie algebra: dimension, type, Killing form, series."""
    algebra = bracket.algebra
    kinds = {
        "abelian": algebra.is_abelian,
        "semisimple": algebra.is_semisimple,
        "nilpotent": algebra.is_nilpotent,
        "solvable": algebra.is_solvable,
    }
    signature, centre = _signature(algebra), algebra.centre().dimension
    derived = [ideal.dimension for ideal in algebra.derived_series()]
    words = [kind for kind, holds in kinds.items() if holds] or ["neither semisimple nor solvable"]
    lines: list[Line] = [(f"{algebra.name}, dimension {algebra.dimension}, {words[0]}",)]
    if signature is not None:
        plus, minus, zero = signature
        lines.append((f"Killing form of signature ({plus}, {minus}, {zero}) (positive, negative, zero)",))
    if not kinds["semisimple"]:
        dimensions = ", ".join(map(str, derived))
        lines.append((f"derived series of dimensions {dimensions}; centre of dimension {centre}",))
    return Topic(
        "algebra",
        lines,
        lambda: {
            "name": algebra.name,
            "dimension": algebra.dimension,
            **kinds,
            "killing_signature": signature,
            "derived_series": derived,
            "centre_dimension": centre,
        },
    )


def extension_topic(bracket: Bracket) -> Topic:
    """The commutative algebra: its products and its normal form."""
    extension, fields = bracket.extension, tuple(bracket.fields)
    unit, n = _unit_element(extension, fields), len(fields)
    products = [
        (fields[mu], fields[nu], _combination(_dense(row, n), fields)) for (mu, nu), row in extension.products.items()
    ]
    classification, obstacle = _classified(extension)
    lines: list[Line] = [(f"{extension.name}, {n} field{'s' if n > 1 else ''}: {', '.join(fields)}",)]
    if unit is not None and n > 1:
        lines.append(("unit ", unit))
    if unit is None or n > 1:
        shown = [p for p in products if unit is None or str(unit) not in (_e(p[0]), _e(p[1]))]
        lines += [(Equation(_product(u, v), product),) for u, v, product in shown]
        if not shown:
            lines.append(("all other products vanish" if unit is not None else "all products vanish",))
        lines.append(_normal_form(classification) or (f"no normal form: {obstacle}",))
    return Topic(
        "extension",
        lines,
        lambda: {
            "name": extension.name,
            "fields": list(fields),
            "unit": None if unit is None else record_of(unit),
            "products": [{"left": u, "right": v, "product": record_of(product)} for u, v, product in products],
            "normal_form": None if classification is None else str(classification),
            "not_classified_because": obstacle or None,
        },
    )


def jacobi_topic(bracket: Bracket, certificate: JacobiCertificate) -> Topic:
    """The bracket, with its constant part or, if it is not linear, its entries; and the proof that it is one."""
    names = [str(variable) for variable in bracket.variables]
    known = {(i, j): c for i, j, m, c in bracket.terms() if m is None}
    constant = [(names[i], names[j], Formula(to_sympy(c))) for (i, j), c in known.items()]
    title = "constant part" if bracket.is_linear else "entries"
    shown = ", ".join(names) if len(names) <= 12 else f"{', '.join(names[:6])}, ..., {names[-1]}"
    lines: list[Line] = [(f"{bracket!r}, {len(names)} coordinates: {shown}",)]
    if constant:
        parts: list[Written] = [Equation(_braces(u, v), c) for u, v, c in constant]
        more = f", ... ({len(parts)} in all)" if len(parts) > _MOST_CONSTANTS else ""
        lines.append((f"{title} ", *joined(parts[:_MOST_CONSTANTS]), *([more] if more else [])))
    circles = {name: Formula(period) for name, period in bracket.periods.items()}
    for name, period in circles.items():
        lines.append((f"{name} is a point of a circle, modulo ", period))
    lines.append((str(certificate),))

    def record() -> dict[str, Any]:
        part = [{"of": [u, v], "value": record_of(value)} for u, v, value in constant]
        return {
            "name": repr(bracket),
            "coordinates": names,
            **({title.replace(" ", "_"): part} if part else {}),
            **({"periods": {name: record_of(period) for name, period in circles.items()}} if circles else {}),
            "jacobi": {
                "proved": certificate.proved,
                "method": certificate.method,
                "n_triples": certificate.n_triples,
                "failures": [str(failure) for failure in certificate.failures],
            },
        }

    return Topic("bracket", lines, record)


def _signature(algebra: LieAlgebra) -> tuple[int, int, int] | None:
    """Of the Killing form; None where parameters leave signs open."""
    try:
        return algebra.killing_signature()
    except ParameterError:
        return None


def _unit_element(extension: Extension, fields: tuple[str, ...]) -> Formula | None:
    try:
        unit = extension.unit()
    except BracketError:  # not associative: the bracket fails, which is told there
        return None
    return None if unit is None else _combination(unit, fields)


def _classified(extension: Extension) -> tuple[Classification | None, str]:
    try:
        return extension.classify(), ""
    except LiePoissonError as refusal:  # symbolic parameters, or a dimension beyond the tables
        return None, str(refusal)


def _normal_form(here: Classification | None) -> Line:
    """What `str(classification)` says, with formulas."""
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
