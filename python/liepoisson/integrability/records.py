"""Searches as plain data that JSON can write, expressions in the grammar of system files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.integrability.polynomial_integrals import FirstIntegrals


def search_record(found: FirstIntegrals) -> dict[str, Any]:
    """What a search found and proves."""
    size = {"degree": found.degree} if found.weight is None else {"weight": found.weight, "weights": found.weights}
    return {
        "system": found.system.name,
        **size,
        "functions": [Formula(f).plain for f in found.functions],
        "on": [Formula(f).plain for f in found.on],
        "generic_parameters": list(found.parameters),
        "known": named(found.known),
        "found": [
            {
                "name": f.name,
                "expression": Formula(f.expression).plain,
                "degree": f.degree,
                "independent": f.is_independent,
            }
            for f in found.found
        ],
        "complete": found.complete,
        "modulo_ideal": found.modulo_ideal,
        "notes": list(found.notes),
        "proof": {
            "monomials": found.n_monomials,
            "blocks": found.n_blocks,
            "integrals": found.n_integrals,
            "prime": found.prime,
        },
    }


def named(functions: Mapping[str, Expr]) -> list[dict[str, str]]:
    """Names and expressions."""
    return [{"name": name, "expression": Formula(f).plain} for name, f in functions.items()]
