"""Descriptions of systems for the laboratory, and pictures of their states: plain data, as JSON can write them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

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
    """A system, or what else has a `name` and a `field()`, as plain data that JSON can write exactly.

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


N_POINTS = 96
"""Points of a picture along each axis."""


def picture_of(system: Any) -> dict[str, Any] | None:
    r"""The vorticity of a truncation of the ideal fluid to su(N), a field on the plane; None for what has no picture.

    It is the sum of coefficient times component times across(x) times up(y); `across` and `up` are functions that are
    tabulated here, so that who draws the picture needs no formula.

    It is what `catalog.vorticity` adds up, $\omega(x) = -2\,\mathrm{Re}\sum_n w_n e^{in\cdot x}$ over one wave vector n
    of each pair, with cosines and sines of the two angles taken apart.

    Returns:
        - `name`;
        - `across`, `up`: tables of functions at the points of the columns and of the rows;
        - `terms`: component, number of the function of the columns, that of the rows, coefficient.
    """
    n = _truncation(system)
    if n is None:
        return None
    from liepoisson.structure.lie.sine_algebra import sine_modes

    at = 2 * math.pi * np.arange(N_POINTS) / N_POINTS
    waves = [np.cos(k * at) for k in range(n // 2 + 1)] + [np.sin(k * at) for k in range(1, n // 2 + 1)]
    terms: list[list[float]] = []

    def add(component: int, across: tuple[str, int], up: tuple[str, int], coefficient: int) -> None:
        places: list[int] = []
        for kind, k in (across, up):
            if kind == "sin" and k == 0:
                return
            places.append(abs(k) if kind == "cos" else n // 2 + abs(k))
            coefficient *= -1 if kind == "sin" and k < 0 else 1
        terms.append([component, *places, coefficient])

    for mode, (n1, n2) in enumerate(sine_modes(n)):
        real, imaginary = 2 * mode, 2 * mode + 1
        add(real, ("cos", n1), ("cos", n2), -2)
        add(real, ("sin", n1), ("sin", n2), 2)
        add(imaginary, ("sin", n1), ("cos", n2), 2)
        add(imaginary, ("cos", n1), ("sin", n2), 2)
    table = [[round(float(value), 12) for value in wave] for wave in waves]
    return {"name": "Vorticity", "across": table, "up": table, "terms": terms}


def _truncation(system: Any) -> int | None:
    """N of `catalog.zeitlin(N)`: the sine algebra, and one field on it."""
    bracket = getattr(system, "bracket", None)
    name = str(getattr(getattr(bracket, "algebra", None), "name", ""))
    if not (name.startswith("sine(") and name.endswith(")") and name[5:-1].isdecimal()):
        return None
    n = int(name[5:-1])
    return n if len(getattr(system, "component_names", ())) == n * n - 1 else None
