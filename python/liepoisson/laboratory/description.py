"""Descriptions of systems for the laboratory: the data that the compiled core takes, as JSON can write it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from liepoisson.compile.field import TapeFunction, record_of
from liepoisson.errors import LiePoissonError
from liepoisson.numeric.systems import (
    as_field,
    component_names,
    has_functions,
    has_pieces,
    known_constants,
    reads_formulas,
    vector_length,
)

VERSION = 1
"""Of the format, which the page looks at."""


def description_of(system: Any) -> dict[str, Any]:
    """A system as plain data: `json.dumps(..., allow_nan=False)` writes every number so that it is read back exactly.

    Args:
        system: What is integrated: a `System`, or anything with a `name` and a `field()`.

    Returns:
        - `version`: of this format;
        - `name`, `components` (their names), `vector_length` (components of each vector of the state);
        - `field`: as `field.record_of` makes it;
        - `pieces`: the Hamiltonian in pieces, for splitting, or None;
        - `invariants`: `names` and `functions`, a tape with one output for each, or None.  The Hamiltonian is first.
    """
    field = as_field(system)
    n = field.n_components
    return {
        "version": VERSION,
        "name": str(system.name),
        "components": list(component_names(system, n)),
        "vector_length": vector_length(system, n),
        "field": record_of(field),
        "pieces": _pieces(system),
        "invariants": _invariants(system),
    }


def record_of_functions(tape: TapeFunction) -> dict[str, Any]:
    """Functions on phase space as plain data."""
    return asdict(tape)


def _pieces(system: Any) -> dict[str, Any] | None:
    """None where a Hamiltonian has no pieces with known flows."""
    if not has_pieces(system):
        return None
    try:
        return record_of(system.pieces())
    except LiePoissonError:
        return None


def _invariants(system: Any) -> dict[str, Any] | None:
    """Those that the core can evaluate; None if there are none."""
    known: Mapping[str, Any] = known_constants(system) if has_functions(system) else {}
    if not reads_formulas(system):
        return None
    smooth: dict[str, Any] = {}
    for name, function in known.items():
        try:
            system.function_tape(function)
        except LiePoissonError:
            continue
        smooth[name] = function
    if not smooth:
        return None
    return {"names": list(smooth), "functions": record_of_functions(system.function_tape(*smooth.values()))}
