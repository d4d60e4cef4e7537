"""How much faster is one contender than another?  Ratios, the quickest of each kind, and how numbers are written."""

from __future__ import annotations

from typing import Any

import numpy as np

import environment

Record = dict[str, Any]
NOT_COMPILED = "not compiled"
KINDS = ("double", "mixed", "single", NOT_COMPILED)


def ratios(peer: Record, ours: Record) -> tuple[float, float, float]:
    """How many times faster than the peer: by best times, by medians, and the median over rounds."""
    theirs, mine = np.array(peer["seconds"]) / work_of(peer), np.array(ours["seconds"]) / work_of(ours)
    return (
        float(theirs.min() / mine.min()),
        float(np.median(theirs) / np.median(mine)),
        float(np.median(theirs / mine)),
    )


def work_of(one: Record, default: float = 1.0) -> float:
    """Trajectories times time of one run; if a row has one work for all, it does not matter in ratios."""
    return one["contender"]["work"] or default


def with_work(data: Record) -> list[Record]:
    """What was measured in a row, each with its own work."""
    return [one | {"contender": one["contender"] | {"work": work_of(one, data["work"])}} for one in data["measured"]]


def fastest(measured: list[Record]) -> Record | None:
    """The best rate among those that meet their level, if there are any."""
    meeting = [one for one in measured if one["contender"]["setting"]["meets"]]
    return min(meeting, key=lambda one: min(one["seconds"]) / work_of(one), default=None)


def of_kind(measured: list[Record], kind: str) -> list[Record]:
    """Those that compete as one kind, a precision or double precision without code that is compiled for a field."""
    return [one for one in measured if one["contender"]["kind"] == kind]


def of_side(measured: list[Record], side: str) -> list[Record]:
    """Those of one side."""
    return [one for one in measured if one["contender"]["side"] == side]


def duration(seconds: float) -> str:
    """Three digits with a unit."""
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def rate(units: float) -> str:
    """Trajectories times time a second."""
    return f"{units / 1e6:.3f}M" if units >= 1e5 else f"{units / 1e3:.3g}k"


def shown_errors(setting: Record, *names: str) -> str:
    """Errors of a setting, or nothing where none was measured."""
    values = [setting.get(name, 0.0) for name in names]
    return " / ".join(f"{value:.1e}" for value in values) if any(values) else ""


def shown_ratios(values: tuple[float, ...] | list[float]) -> str:
    """Ratios with two digits after the point, large ones without."""
    return " / ".join(f"{ratio:.2f}" if ratio < 100 else f"{ratio:.0f}" for ratio in values)


def markdown(table: list[list[str]]) -> str:
    """A table's lines, the first of them its header."""
    return "".join(f"| {' | '.join(line)} |\n" for line in [table[0], ["---"] * len(table[0]), *table[1:]])


def processor_name(processor: Record) -> str:
    """A processor as its maker numbers it: clouds hide the name under which it is sold."""
    return f"{processor['vendor_id']} family {processor['cpu family']} model {processor['model']}"


def environment_text(facts: Record) -> str:
    """The facts that go with the numbers."""
    processor, ours, peer = facts["processor"], facts["liepoisson"], facts["heyoka"]
    busy = (
        " (SOMETHING ELSE WAS COMPUTING: do not trust the times)" if facts["load_at_start"] > environment.QUIET else ""
    )
    return (
        f"Processor: {processor['model name']}, {processor_name(processor)} ({' '.join(processor['flags'])}), "
        f"core {facts['pinned_to']} of {facts['cores']}; {facts['system']}; Python {facts['python']}.\n"
        f"liepoisson {ours['liepoisson']}, kernel {ours['kernel']} of {', '.join(ours['available'])}, "
        f"numpy {ours['numpy']}; heyoka.py {peer['heyoka']} (recommended batch {peer['recommended_batch']}), "
        f"numpy {peer['numpy']}.\n"
        f"Load at the start {facts['load_at_start']:.2f}{busy}."
        + (f" Reference: good to {facts['reference_error']:.0e} (median)." if "reference_error" in facts else "")
    )
