"""What came out?  Tables in Markdown for people, the same in JSON for programs."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from measure import Measured, Row, ratios

COLUMNS = (
    "contender",
    "tol",
    "order",
    "state error",
    "tangent error",
    "exponent error",
    "best",
    "median",
    "rate at best",
)


def environment_text(facts: dict[str, Any]) -> str:
    """The facts that go with the numbers."""
    processor, ours, peer = facts["processor"], facts["liepoisson"], facts["heyoka"]
    busy = " (SOMETHING ELSE IS COMPUTING: do not trust the times)" if facts["load_at_start"] > 0.7 else ""
    return (
        f"Processor: {processor['model name']}, {processor['vendor_id']} family {processor['cpu family']} model "
        f"{processor['model']} ({' '.join(processor['flags'])}), core {facts['pinned_to']} of {facts['cores']}; "
        f"{facts['system']}; Python {facts['python']}.\n"
        f"liepoisson {ours['liepoisson']}, kernel {ours['kernel']} of {', '.join(ours['available'])}, "
        f"numpy {ours['numpy']}; heyoka.py {peer['heyoka']}, batch {facts['batch']} (recommended "
        f"{peer['recommended_batch']}), numpy {peer['numpy']}.\n"
        f"Load at the start {facts['load_at_start']:.2f}{busy}. "
        f"Reference: good to {facts['reference_error']:.0e} (median)."
    )


def _duration(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def _error(setting: dict[str, Any], name: str) -> str:
    value = setting.get(name, 0.0)
    return f"{value:.1e}" if value else ""


def _cells(row: Row, one: Measured, peers: list[Measured]) -> list[str]:
    best, setting = min(one.seconds), one.contender.setting
    versus = (" / ".join(f"{ratio:.2f}" for ratio in ratios(peer, one)) for peer in peers)
    return [
        one.contender.name + ("" if setting["meets"] else " (LEVEL NOT MET)"),
        f"{setting['tol']:.1e}",
        str(setting["order"]),
        *(_error(setting, name) for name in ("state", "tangent", "exponent")),
        _duration(best),
        _duration(float(np.median(one.seconds))),
        "" if row.wall else f"{row.work / best / 1e6:.3f}M",
        *("" if one in peers else text for text in versus),
    ]


def _peers(measured: list[Measured]) -> list[Measured]:
    return [one for one in measured if one.contender.side == "heyoka"]


def table(row: Row, measured: list[Measured]) -> str:
    """One row of the benchmark: a line for each contender, a column of ratios (best, median, rounds) per peer."""
    peers = _peers(measured)
    columns = [*COLUMNS, *(f"against {peer.contender.name}" for peer in peers)]
    lines = [columns, ["---"] * len(columns), *(_cells(row, one, peers) for one in measured)]
    drifts = [f"{one.contender.name} {one.answers[-1]['drift']:.1e}" for one in measured if "drift" in one.answers[-1]]
    tail = f"\nLargest change of H, C1, C2, C3 at the end, median over starts: {'; '.join(drifts)}.\n" if drifts else ""
    return f"### {row.title}\n\n" + "".join(f"| {' | '.join(line)} |\n" for line in lines) + tail


def record(row: Row, measured: list[Measured]) -> dict[str, Any]:
    """All that was measured for a row, as plain data, with the ratios by name."""
    versus = {
        f"{one.contender.name} against {peer.contender.name}": dict(
            zip(("best", "median", "rounds"), ratios(peer, one), strict=True)
        )
        for one in measured
        for peer in _peers(measured)
        if one.contender.side != peer.contender.side
    }
    return {
        "title": row.title,
        "work": row.work,
        "wall": row.wall,
        "ratios": versus,
        "measured": [asdict(one) for one in measured],
    }
