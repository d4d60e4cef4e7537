"""How long does each side take?  Fresh processes of all contenders, in turn, on the one core this process is pinned to.

Machines that are shared change speed by tens of per cent within seconds, and heyoka itself differs between processes
with where its buffers happen to lie.  So contenders take turns, each time in a new process, and three ratios are made:
of the best times, of the medians, and the median of the ratios of neighbours in time, which is the steadiest.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
PEERS_VENV = ROOT / "target" / "benchmark-peers"
PEERS = ("scipy", "numbalsoda", "diffrax", "jitcode", "pynamicalsys")
"""Sides that share an environment of their own."""
PYTHON = {
    "heyoka": HERE / ".venv" / "bin" / "python",
    "liepoisson": Path(sys.executable),
    **dict.fromkeys(PEERS, PEERS_VENV / "bin" / "python"),
}


@dataclass(frozen=True)
class Contender:
    """One side with one setting.

    Attributes:
        name: What the table calls it.
        side: "heyoka", "liepoisson" or one of the peers.
        request: What its worker is asked.
        setting: Its choice and errors, for the table.
        simd: Kernel that liepoisson is told to use; by default the widest.
        kind: What it competes as, one of `comparison.KINDS`; empty for one that is there for comparison.
        work: Trajectories times time of its run, if it is not that of its row.
    """

    name: str
    side: str
    request: dict[str, Any]
    setting: dict[str, Any] = field(default_factory=dict)
    simd: str | None = None
    kind: str = ""
    work: float | None = None


def choice(request: dict[str, Any]) -> str:
    """The number that was chosen: a tolerance or a step."""
    arguments = request.get("method", request)
    return f"tol {arguments['tol']:.1e}" if "tol" in arguments else f"step {arguments['step']:.3g}"


@dataclass(frozen=True)
class Row:
    """One question of the benchmark and those who answer it."""

    title: str
    contenders: list[Contender]
    work: float
    """Trajectories times time of one run, for the rate."""
    wall: bool = False
    """Time the whole process, from its start to its end, and not the run alone."""
    absent: dict[str, str] = field(default_factory=dict)
    """Who does not take part, and why."""


@dataclass(frozen=True)
class Measured:
    """One contender's times, in seconds, one per process, in the order in which the processes ran; and its answers."""

    contender: Contender
    seconds: list[float]
    answers: list[dict[str, Any]]


def call(
    side: str, request: dict[str, Any], simd: str | None = None, limit: float | None = None
) -> tuple[dict[str, Any], float]:
    """Ask a worker in a fresh process; its answer, and the seconds from starting it to its end.

    Raises:
        RuntimeError: The worker failed; the message is what it wrote.
        subprocess.TimeoutExpired: It was not done after `limit` seconds, and was stopped.
    """
    environment = {key: value for key, value in os.environ.items() if key != "LIEPOISSON_SIMD"}
    if simd is not None:
        environment["LIEPOISSON_SIMD"] = simd
    environment |= request.get("environment", {})
    worker = f"general_{side}_worker.py" if "system" in request else f"{side}_worker.py"
    command = [str(PYTHON[side]), str(HERE / worker), json.dumps(request)]
    begin = time.perf_counter()
    process = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=limit)
    wall = time.perf_counter() - begin
    if process.returncode != 0:
        raise RuntimeError(f"{side} worker failed on {_shortened(request)}:\n{process.stderr}")
    return json.loads(process.stdout.splitlines()[-1]), wall


def _shortened(request: dict[str, Any]) -> dict[str, Any]:
    """The request without its long lists."""
    return {name: value for name, value in request.items() if not isinstance(value, list)}


def run_row(row: Row, rounds: int) -> list[Measured]:
    """Let all contenders of a row take turns, `rounds` times; each round begins with another one."""
    measured = [Measured(contender, [], []) for contender in row.contenders]
    for first in range(rounds):
        for k in range(len(measured)):
            one = measured[(first + k) % len(measured)]
            answer, wall = call(one.contender.side, one.contender.request, one.contender.simd)
            kernel = answer.get("kernel", "").removesuffix(", compiled")
            if one.contender.simd not in (None, kernel):
                raise RuntimeError(f"asked for {one.contender.simd}, ran {kernel}")
            one.seconds.append(wall if row.wall else min(answer["seconds"]))
            one.answers.append(answer)
    return measured


def timed(call: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """The last result, and the least process time."""
    times: list[float] = []
    result = None
    for _ in range(repeats):
        began = time.process_time()
        result = call()
        times.append(time.process_time() - began)
    return result, min(times)
