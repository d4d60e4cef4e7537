"""How fast is liepoisson against the tools that Python users have, at equal accuracy?  `python benchmarks/run.py`.

Rules and meaning are in docs/benchmarks.md.  Run it with the Python that has liepoisson; heyoka and the other tools get
environments of their own.  Nothing else should be computing meanwhile.  Results: benchmarks/results/tables/, or quick/.
`python benchmarks/report.py` then puts the tables into the docs.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import bench
import dispatch
import environment
import kernels
import measure
import output
import peers
import problem
import reference
import report
from bench import RESULTS, Bench
from measure import Row

ROUNDS, QUICK_ROUNDS, PEER_ROUNDS = 12, 3, 3
"""Processes of each contender; the other tools, which are slower by far, need no fine distinction."""


class Run:
    """One run of the benchmark: what each row's name stands for."""

    def __init__(self, facts: dict[str, Any], rounds: int) -> None:
        x0, tangents = bench.prepare(RESULTS / "problem.npy")
        exact, facts["reference_error"] = reference.cached_flow(x0, tangents, problem.T_ACCURACY, RESULTS)
        available, widest = facts["liepoisson"]["available"], facts["liepoisson"]["kernel"]
        self.simds = [widest] + (["avx2"] if "avx2" in available and widest != "avx2" else [])
        self.bench = Bench(RESULTS / "problem.npy", exact, avx2=len(self.simds) > 1)
        self.rounds = rounds
        self.peers = cache(lambda: peers.Peers(self.bench, environment.ensure_peers()))
        self.rows: dict[str, Callable[[], dict[str, Any]]] = {
            "1e-13": lambda: self._time(self.bench.ensemble(1e-13)),
            "1e-8": lambda: self._time(self.bench.ensemble(1e-8)),
            "1e-4": lambda: self._time(self.bench.ensemble(1e-4)),
            "single-precision": lambda: self._time(self.bench.single_precision()),
            "single-tolerance": lambda: self._time(self.bench.single(None)),
            "single-level": lambda: self._time(self.bench.single(bench.SINGLE_LEVEL)),
            "dense": lambda: self._time(output.dense(RESULTS / "problem.npy")),
            "grid": lambda: self._time(output.grid(RESULTS / "problem.npy")),
            "sections-1e-15": lambda: self._time(output.sections(RESULTS / "problem.npy", 1e-15)),
            "sections-1e-9": lambda: self._time(output.sections(RESULTS / "problem.npy", 1e-9)),
            "sweep": lambda: self._time(output.sweep(RESULTS / "problem.npy")),
            "cold-20": lambda: self._time(self.bench.cold(problem.T_ACCURACY)),
            "cold-200": lambda: self._time(self.bench.cold(problem.T_END)),
            "kernels": lambda: kernels.run(self.bench, self.simds, self.rounds),
            "dispatch": lambda: dispatch.run(widest, self.rounds),
            "peers-1e-13": lambda: self._peers(1e-13),
            "peers-1e-8": lambda: self._peers(1e-8),
            "peers-1e-4": lambda: self._peers(1e-4),
        }

    def _time(self, row: Row, rounds: int | None = None) -> dict[str, Any]:
        rounds = rounds or self.rounds
        if row.wall:  # once without the clock: fills file caches, Python's and heyoka's
            measure.run_row(row, 1)
        return report.record(row, measure.run_row(row, rounds), rounds)

    def _peers(self, level: float) -> dict[str, Any]:
        return self._time(self.peers().row(level), min(self.rounds, PEER_ROUNDS))


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options that all benchmarks have."""
    parser.add_argument("--quick", action="store_true", help=f"{QUICK_ROUNDS} processes a contender, not {ROUNDS}")
    parser.add_argument("--rounds", type=int, help=f"processes a contender, by default {ROUNDS}")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")


def facts(core: int | None) -> dict[str, Any]:
    """The facts of this run, with the peer at hand, and this process and all that it starts on one core."""
    RESULTS.mkdir(exist_ok=True)
    environment.ensure_peer()
    return environment.facts(environment.pin(core))


def start(arguments: argparse.Namespace) -> tuple[dict[str, Any], int, Path]:
    """The facts of this run, its rounds, and where its tables go: those of a quick look never to the docs."""
    found = facts(arguments.core)
    rounds = arguments.rounds or (QUICK_ROUNDS if arguments.quick else ROUNDS)
    return found, rounds, report.TABLES if rounds >= ROUNDS else report.QUICK


def main() -> None:
    """Measure, print tables, and write their data."""
    parser = argparse.ArgumentParser(description="liepoisson against other tools at equal accuracy, on one core")
    add_options(parser)
    parser.add_argument("--only", nargs="+", metavar="ROW", help="only these rows; an unknown one lists them")
    arguments = parser.parse_args()
    known, rounds, folder = start(arguments)
    run = Run(known, rounds)
    wanted = arguments.only or list(run.rows)
    unknown = [name for name in wanted if name not in run.rows]
    if unknown:
        parser.error(f"--only: wanted rows out of {', '.join(run.rows)}; got {', '.join(unknown)}")
    print(report.environment_text(known), flush=True)
    for name in wanted:
        data = run.rows[name]()
        report.save(folder, name, data, known)
        print("\n" + report.render(data), flush=True)
    print("\n" + report.summary({name: data for name, data in report.load(folder).items() if name in wanted}, known))


if __name__ == "__main__":
    main()
