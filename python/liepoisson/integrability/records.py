"""Searches and reports as plain data that JSON can write, expressions in the grammar of system files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from liepoisson.exact.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.integrability.polynomial_integrals import FirstIntegrals
    from liepoisson.integrability.report import IntegrabilityReport


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
        "proof": {
            "monomials": found.n_monomials,
            "blocks": found.n_blocks,
            "integrals": found.n_integrals,
            "prime": found.prime,
        },
    }


def report_record(report: IntegrabilityReport) -> dict[str, Any]:
    """The verdict with all that it rests on."""
    closed = report.closed
    return {
        "system": report.system.name,
        "verdict": report.verdict,
        "rank": report.rank,
        "integrals": named(report.integrals),
        "commuting": list(report.commuting),
        "closed": closed
        and {
            "names": list(closed.names),
            "corank": closed.corank,
            "brackets": [[*pair, Formula(value).plain] for pair, value in closed.brackets.items()],
        },
        "searched_degree": report.searched_degree,
        "searches": [search_record(search) for search in report.searches],
        "not_tried": list(report.not_tried),
        "certificate": report.certificate,
        "notes": list(report.notes),
    }


def named(functions: Mapping[str, Expr]) -> list[dict[str, str]]:
    """Names and expressions."""
    return [{"name": name, "expression": Formula(f).plain} for name, f in functions.items()]
