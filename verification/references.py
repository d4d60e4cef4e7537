"""Exact end points of the audit's ensembles, computed once in 32 digits and kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import liepoisson as lp
from problems import TOPS, Array, first_tangents, starts
from reference import as_two_doubles, flow
from store import Store

DIGITS = 32
"""A chaotic orbit loses about two of them until t = 20."""

_STORE = Store(Path(__file__).parent.parent / "results" / "audit" / "references")


def exact_flow(top: str, n: int, time: float) -> tuple[Array, Array]:
    """State and tangent vector of the first n members at one time, as sums of two doubles, shape (n, 18) each."""
    ends = [_member(top, k, time) for k in range(n)]
    return np.stack([high for high, _ in ends]), np.stack([low for _, low in ends])


def _member(top: str, k: int, time: float) -> tuple[Array, Array]:
    kept = _STORE.piece(
        f"{top}-{k}", {"top": top, "member": k, "t": time, "digits": DIGITS}, lambda: _compute(top, k, time)
    )
    return kept["high"], kept["low"]


def _compute(top: str, k: int, time: float) -> dict[str, Array]:
    field = TOPS[top].field()
    assert isinstance(field, lp.fields.TopField)
    start = [*starts(top, k + 1)[k].tolist(), *first_tangents(k + 1)[k].tolist()]
    high, low = as_two_doubles(flow(field, start, [time], digits=DIGITS))
    return {"high": high[0], "low": low[0]}
