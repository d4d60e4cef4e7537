"""Is a certificate about this system? Its equations are compared with those that the system has."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import chain, repeat
from typing import Any, cast

from liepoisson.errors import CertificateError, ExpressionError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.inputs.refusals import shown
from liepoisson.proofs.polynomial_field import PolynomialField, rational_terms

_LEFT_SIDE = re.compile(r"^\s*(?:d\s*)?([A-Za-z]\w*?)\s*(?:'|/\s*dt|_dot|\.)?\s*=")


def compare_equations(equations: object, field: PolynomialField) -> str:
    """Compare the equations in a certificate with those of a system; a sentence that says what was found.

    The proof is about the system's own equations. Those of the certificate are compared with them where they are
    formulas in the grammar of system files, given by the names of the coordinates, as a list or as lines.

    Raises:
        CertificateError: they are formulas, and another system's, or one is missing.
    """
    formulas = _right_sides(equations, field.names)
    if formulas is None:
        return "The equations in the file are not written in this package's grammar and were not compared."
    from sympy import Symbol

    variables = [Symbol(name) for name in field.names]
    for name, text, rate in zip(field.names, formulas, field.rates, strict=True):
        try:
            given = rational_terms(
                read_expression(text.replace("**", "^"), Scope(symbols=field.names)), variables, f"the rate of {name}"
            )
        except ExpressionError:
            return "The equations in the file are not written in this package's grammar and were not compared."
        if given != rate:
            raise CertificateError(
                f"the certificate is about another system: its rate of {name} is {shown(text)}, that of this system "
                f"{shown(field.equations[field.names.index(name)].partition('=')[2].strip())}"
            )
    return "The equations in the file are those of the system."


def _right_sides(equations: object, names: Sequence[str]) -> list[str] | None:
    """The formulas in the order of the coordinates, or None where they are in another form.

    Raises:
        CertificateError: a coordinate has none, or another number of them is listed.
    """
    is_list = isinstance(equations, list)
    if isinstance(equations, str):
        equations = [line for line in re.split(r"[\n;]", equations) if line.strip()]
    if isinstance(equations, Mapping):
        given = cast("Mapping[Any, Any]", equations)
        named = {_name(key, names): value for key, value in given.items()}
    elif isinstance(equations, list):
        lines = cast("list[Any]", equations)
        if not all(isinstance(line, str) for line in lines):
            return None
        sides = [cast("str", line).rpartition("=") for line in lines]
        if not any(head for head, _, _ in sides) and is_list and len(lines) != len(names):
            raise CertificateError(
                f"the certificate is refused: wanted an equation for each of {', '.join(names)}; got {len(lines)}"
            )
        heads = [_LEFT_SIDE.match(f"{head}=") if head else None for head, _, _ in sides]
        named = {
            (_name(head[1], names) if head else name): side[2]
            for head, side, name in zip(heads, sides, chain(names, repeat("")), strict=False)
        }
    else:
        return None
    if (missing := [name for name in names if name not in named]) and len(missing) < len(names):
        raise CertificateError(f"the certificate is refused: its equations lack the rate of {missing[0]}")
    if missing or set(named) != set(names) or not all(isinstance(f, str) for f in named.values()):
        return None
    return [named[name] for name in names]


def _name(text: object, names: Sequence[str]) -> str:
    """A coordinate from the left side of an equation, such as dl1/dt, l1' or l1."""
    plain = re.sub(r"(?:'|/\s*dt|_dot)$", "", str(text).strip())
    return plain if plain in names else plain.removeprefix("d")
