"""How much faster is mixed precision than in another build, at equal errors?  `python benchmarks/against.py FOLDER`.

FOLDER is the folder `python` of another checkout with its core in it, for example of the commit before a change.  Both
builds run the ensemble of `run.py` by turns on one core, each with the loosest tolerance whose median error of the
exponents at t = 20 is at most a level, then with the one whose error of the states is; see docs/benchmarks.md.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import bench
import calibrate
import environment
import families
import measure
import problem
import reference
from calibrate import Setting

ROUNDS, REPEATS = 6, 3
LEVELS = {"exponent": (2e-7, 1e-6, 5e-6, 1e-5), "state": (1e-13, 1e-8, 2e-7, 1e-6)}


@contextmanager
def build(folder: Path) -> Generator[None]:
    """Workers that start inside of the block take liepoisson from this folder."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = str(folder)
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def loosest(settings: list[Setting], error: str, level: float) -> Setting | None:
    """The first setting, from loose to tight, with an error of this kind at most the level."""
    return next((setting for setting in settings if getattr(setting, error) <= level), None)


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description="mixed precision beside another build, at equal errors")
    parser.add_argument("folder", type=Path, help="the folder `python` of the other checkout, with its core")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    if not list(arguments.folder.glob("liepoisson/_core*.so")):
        parser.error(f"wanted a folder with liepoisson and its compiled core; got {arguments.folder}; build it there")
    environment.pin(arguments.core)
    environment.quiet_load()
    x0, tangents = bench.prepare(bench.RESULTS / "problem.npy")
    exact, _ = reference.cached_flow(x0, tangents, problem.T_ACCURACY, bench.RESULTS)
    folders = {"other": arguments.folder.resolve(), "this": measure.ROOT / "python"}
    common = {"problem": str(bench.RESULTS / "problem.npy")}
    methods = {"methods": families.MIXED.requests(), "single": False}
    scans: dict[str, list[Setting]] = {}
    for side, folder in folders.items():
        with build(folder):
            scans[side] = calibrate.scan("liepoisson", common | methods, exact, bench.RESULTS)
    print("| level | build | setting | state error | exponent error | rate at best | best / median / rounds |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for error, levels in LEVELS.items():
        for level in levels:
            found = {side: loosest(scan, error, level) for side, scan in scans.items()}
            chosen = {side: setting for side, setting in found.items() if setting is not None}
            if len(chosen) == len(folders):
                _print_row(f"{error} {problem.shown(level)}", chosen, folders, common)


def _print_row(title: str, chosen: dict[str, Setting], folders: dict[str, Path], common: dict[str, str]) -> None:
    seconds: dict[str, list[float]] = {side: [] for side in folders}
    for turn in range(ROUNDS):
        for side in sorted(folders, reverse=bool(turn % 2)):
            asked = common | {"task": "ensemble", "t_end": problem.T_END, "repeats": REPEATS} | chosen[side].request
            with build(folders[side]):
                seconds[side].append(min(measure.call("liepoisson", asked)[0]["seconds"]))
    other, this = (np.array(seconds[side]) for side in ("other", "this"))
    ratios = (other.min() / this.min(), np.median(other) / np.median(this), np.median(other / this))
    for side, setting in chosen.items():
        rate = problem.N_STARTS * problem.T_END / min(seconds[side]) / 1e6
        gain = " / ".join(f"{ratio:.2f}" for ratio in ratios) if side == "this" else ""
        print(
            f"| {title} | {side} | {measure.choice(setting.request)} | {setting.state:.1e} | {setting.exponent:.1e} | "
            f"{rate:.3f}M | {gain} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
