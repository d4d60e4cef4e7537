"""What the study found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from liepoisson.studies.twisted_top.measurements import RunResult
from liepoisson.studies.twisted_top.runs import Settings


@dataclass(frozen=True)
class StudyResult:
    """What the study found.

    Attributes:
        settings: The options it ran with.
        out: The output folder.
        results: Every run, reduced, by name.
        measurements: The numbers, in the schema of `measurements`.
        claims: The table of claims, in the schema of `claims`.
        seconds: Wall time of this invocation.
    """

    settings: Settings
    out: Path
    results: dict[str, RunResult]
    measurements: dict[str, Any]
    claims: dict[str, Any]
    seconds: float
