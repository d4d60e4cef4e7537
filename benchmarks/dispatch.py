"""What does choosing the kernel at run time cost?  `python benchmarks/dispatch.py [--rounds N]`

The same example, `rate`, built as users get it, for any processor with the kernels chosen when it starts, and built for
this processor (`-C target-cpu=native`, in a target directory of its own).  Both run in turn; rates are compared.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

import environment
import measure

ROUNDS = 12
MOST_LOSS = 0.05
"""What run-time dispatch may cost."""
TARGETS = {"chosen at run time": Path("target") / "dispatch", "native": Path("target") / "native"}
LEVELS = ("tol=1e-13", "tol=1e-8")


def build() -> None:
    """Compile both; neither with flags that the caller's environment has."""
    for name, target in TARGETS.items():
        flags = {"RUSTFLAGS": "-C target-cpu=native" if name == "native" else ""}
        command = ["cargo", "build", "--release", "--locked", "--quiet", "-p", "liepoisson-core", "--example", "rate"]
        settings = os.environ | flags | {"CARGO_TARGET_DIR": str(target)}
        subprocess.run(command, cwd=measure.ROOT, env=settings, check=True)


def rate(name: str, options: list[str], simd: str) -> float:
    """Millions of trajectories times time a second."""
    program = measure.ROOT / TARGETS[name] / "release" / "examples" / "rate"
    settings = os.environ | {"LIEPOISSON_SIMD": simd}
    process = subprocess.run([str(program), *options], env=settings, capture_output=True, text=True, check=True)
    found = re.search(r"([\d.]+)e6 units/s", process.stdout)
    if found is None:
        raise RuntimeError(f"examples/rate no longer says its rate as '...e6 units/s':\n{process.stdout}")
    return float(found[1])


def run(simd: str, rounds: int) -> dict[str, Any]:
    """Rates of both builds at each level, as plain data for `report`."""
    build()
    rates: dict[str, dict[str, list[float]]] = {level: {name: [] for name in TARGETS} for level in LEVELS}
    for first in range(rounds):
        for level in LEVELS:
            for name in list(TARGETS)[:: 1 if first % 2 == 0 else -1]:
                rates[level][name].append(rate(name, [level], simd))
    return {
        "kind": "dispatch",
        "title": "Kernels chosen at run time against a build for this processor",
        "simd": simd,
        "rates": rates,
        "rounds": rounds,
    }


def loss(rates: dict[str, list[float]]) -> float:
    """What the choice at run time costs, as a fraction: the median over rounds of the loss of neighbours in time."""
    portable, native = (np.array(rates[name]) for name in TARGETS)
    return float(np.median(1.0 - portable / native))


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: a line for each level."""
    table = [["examples/rate", "kernel", *(f"{name}, median" for name in TARGETS), "loss"]]
    for level, rates in data["rates"].items():
        lost = loss(rates)
        medians = [f"{np.median(rates[name]):.3f}M" for name in TARGETS]
        verdict = "" if lost <= MOST_LOSS else f" (MORE THAN {100 * MOST_LOSS:.0f}%)"
        table.append([level, data["simd"], *medians, f"{100 * lost:+.1f}%{verdict}"])
    return table


def main() -> None:
    """Measure and print; fails if the loss is too large."""
    parser = argparse.ArgumentParser(description="the kernels chosen at run time against a native build")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"runs of each build, by default {ROUNDS}")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    environment.pin(arguments.core)
    simd = measure.call("liepoisson", {"task": "versions"})[0]["kernel"]
    data = run(simd, arguments.rounds)
    for line in lines(data):
        print("  ".join(line))
    if max(loss(rates) for rates in data["rates"].values()) > MOST_LOSS:
        raise SystemExit(f"run-time dispatch costs more than {100 * MOST_LOSS:.0f}%")


if __name__ == "__main__":
    main()
