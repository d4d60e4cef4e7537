"""The steps of a check, one by one: what was stated, what was computed, and whether the one bears out the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

StepKind: TypeAlias = Literal[
    "note", "identity", "value", "counterexample", "rank", "search", "enclosure", "measurement"
]

# How the kinds are named where a verdict says what it rests on, singular and plural, the most telling first.
_NAMES: dict[StepKind, tuple[str, str]] = {
    "counterexample": ("counter-example", "counter-examples"),
    "rank": ("rank certificate", "rank certificates"),
    "search": ("exhaustive search", "exhaustive searches"),
    "enclosure": ("check in rigorous arithmetic", "checks in rigorous arithmetic"),
    "identity": ("identity", "identities"),
    "value": ("exact value", "exact values"),
    "measurement": ("measurement", "measurements"),
}


@dataclass(frozen=True)
class Step:
    """One step of a proof.

    Attributes:
        kind: What sort of fact it is; a note states none.
        text: The fact, with its reason.
        succeeded: Whether the computation bears it out; None for a note.
        remark: What came out instead, where it does not.
        computed: What the computation gave, line by line: formulas, points, ranks, sizes.
        table: Rows of a table, the first one the heading; empty if there is none.
        components: How many expressions were compared.
        decisive: Whether the verdict turns on it.
    """

    kind: StepKind
    text: str
    succeeded: bool | None = None
    remark: str = ""
    computed: tuple[str, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()
    components: int = 1
    decisive: bool = False

    @property
    def line(self) -> str:
        """The fact with its mark, in one line."""
        if self.succeeded is None:
            return f"  {self.text}"
        remark = f" — {self.remark}" if self.remark else ""
        return f"{'✓' if self.succeeded else '✗'} {self.text}{remark}"

    @property
    def lines(self) -> list[str]:
        """The whole step as plain text."""
        widths = [max(len(cell) for cell in column) for column in zip(*self.table, strict=True)]
        rows = ["  ".join(cell.rjust(n) for cell, n in zip(row, widths, strict=True)) for row in self.table]
        return [self.line, *(f"    {text}" for text in (*self.computed, *rows))]

    def to_json(self) -> dict[str, Any]:
        """The step as plain data."""
        return {
            "kind": self.kind,
            "text": self.text,
            "succeeded": self.succeeded,
            "remark": self.remark,
            "computed": list(self.computed),
            "table": [list(row) for row in self.table],
            "components": self.components,
            "decisive": self.decisive,
        }


def certificate(steps: tuple[Step, ...]) -> str:
    """The steps as text, one fact per line with ✓ or ✗, and indented below it what was computed."""
    return "\n".join(line for step in steps for line in step.lines)


def summary_of(steps: tuple[Step, ...]) -> str:
    """What a proof consists of, for example "1 counter-example, 3 identities"."""
    counts = [sum(step.kind == kind for step in steps) for kind in _NAMES]
    return ", ".join(f"{n} {words[n > 1]}" for words, n in zip(_NAMES.values(), counts, strict=True) if n)
