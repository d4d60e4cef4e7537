"""What each method keeps, in one table: its order, the drift of energy and Casimirs, its defect, what a digit costs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import contenders
import drift
import figures
import poisson_defect
import work_precision
from problems import NONLINEAR

NEEDED = ("orders", "drift", "poisson-defect", "work-precision")
"""The questions whose results the table is made of."""
METHODS = (*contenders.WITH_STEPS, contenders.ADAPTIVE, contenders.TAYLOR, contenders.MIXED)


def table(results: dict[str, Any]) -> str:
    """A line for each method, of the first top."""
    result = {name: results[name]["result"] for name in NEEDED}
    levels = [level for level in result["work-precision"]["levels"] if level in (1e-4, 1e-8)]
    header = ["method", "order", "drift of H", "drift of a Casimir", "Poisson defect"]
    lines = [[*header, *(f"ns at {level:.0e}" for level in levels)], ["---"] * (len(header) + len(levels))]
    for contender in METHODS:
        lines.append(
            [
                contender.name,
                _order(result["orders"], contender.name),
                *_drift(result["drift"], contender.name),
                _defect(result["poisson-defect"], contender.name),
                *(_cost(result["work-precision"], contender.name, level) for level in levels),
            ]
        )
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _first(entries: Iterable[dict[str, Any]], name: str) -> dict[str, Any] | None:
    """The entry of a method for the first top, or of all tops together."""
    return next(
        (one for one in entries if one["method"] == name and one.get("top", NONLINEAR[0]) == NONLINEAR[0]), None
    )


def _order(result: dict[str, Any], name: str) -> str:
    curve = _first(result["curves"], name)
    return f"{curve['measured']['value']:.1f}" if curve else ""


def _drift(result: dict[str, Any], name: str) -> list[str]:
    curve = _first(result["curves"], name)
    return ["", ""] if curve is None else [drift.worst(curve, names) for names in (("H",), ("C1", "C2", "C3"))]


def _defect(result: dict[str, Any], name: str) -> str:
    curve = _first(result["curves"], name)
    if curve is None:
        return ""
    part = curve.get("one") or curve["many"]
    return figures.scientific(part["median"][poisson_defect.shown(curve)])


def _cost(result: dict[str, Any], name: str, level: float) -> str:
    points = [one for one in result["points"] if one["method"] == name and one["top"] == NONLINEAR[0]]
    return work_precision.cheapest(points, level)
