"""How near are the kernels to what a core can do?  Operations a second of each, beside the peak of multiply-adds.

Operations are counted from the formulas of a step, a fused multiply-add as two, and times the accepted steps of the
run: what idle lanes, refused steps and the controls of a step do is not counted as work, though its time is.
"""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import asdict
from typing import Any

import calibrate
import measure
import problem
from bench import Bench
from families import DOUBLE, SINGLE, TAYLOR, Family
from measure import Contender, Row

REPEATS = 5
PEAK_RUNS = 3
"""Before the kernels run and again afterwards; the best counts, since another user of the machine only slows it."""

RATES = 2 * (15 + 30) + 28
"""State and one tangent vector of the top: l2 omega3 and cyclically, alpha x omega and beta x omega are 15 multiply-
adds, their derivative 30; omega and the factor of l x omega take 6 multiplications for each of the two, the constants
a and epsilon a, with one component each, 2 multiply-adds."""


def taylor_operations(order: int) -> int:
    """One step of order N: 45 products of N (N + 1) / 2 pairs of coefficients, and 18 sums by Horner's rule.

    Each coefficient besides takes the linear terms of the rates and a division by its number for 18 components.
    """
    return 90 * order * (order + 1) // 2 + order * (28 + 18 + 36)


def runge_kutta_operations() -> int:
    """One step of order 8: 12 rates; 50 summands in 11 stages and 8 at the end, and 12 sums, for 18 components."""
    return 12 * RATES + 2 * 18 * (50 + 8 + 12)


def splitting_operations(order: int, single: bool) -> int:
    """One step: shears by the potential between turns by the kinetic energy of a top with two equal moments.

    A shear is 12 multiply-adds and 4 factors.  A turn about l takes 8 operations for the angle, 24 for its functions,
    30 for the matrix, 36 to apply it, and 93 for the tangent vector; one about the axis 29 for its functions, 24 to
    apply it, 37 for the tangent vector.  Single precision has 8 less in each of the two sets of functions.
    """
    shear, turns = 28, 191 + 90 - (16 if single else 0)
    stages = {4: 6, 6: 10, 8: 17}[order]
    return stages * (turns + shear) + shear


def operations(family: Family, order: int) -> int:
    """Operations of one step of a method."""
    if family.method == "Taylor":
        return taylor_operations(order)
    if family.method == "RungeKutta":
        return runge_kutta_operations()
    return splitting_operations(family.options["order"], family.precision == "single")


def _family(families: list[Family], method: str, order: int | None = None) -> Family:
    """The one with fixed steps, and with that order if it has one."""
    return next(
        one for one in families if one.method == method and one.varied == "step" and one.options.get("order") == order
    )


KERNELS = [
    (TAYLOR, 1e-13),
    (_family(DOUBLE, "RungeKutta"), 1e-8),
    (_family(DOUBLE, "Splitting", 4), 1e-4),
    (_family(SINGLE, "RungeKutta"), 1e-4),
    (_family(SINGLE, "Splitting", 4), 1e-4),
]


def build_peak() -> None:
    """Compile `examples/peak.rs`, before processes are timed."""
    subprocess.run([*_cargo("build"), "--quiet"], cwd=measure.ROOT, check=True)


def _cargo(verb: str) -> list[str]:
    return ["cargo", verb, "--release", "--locked", "-p", "liepoisson-core", "--example", "peak"]


def peaks() -> dict[str, float]:
    """GFLOP/s of multiply-adds on registers, by instruction set and type of number, as "avx512 f64"."""
    environment = {key: value for key, value in os.environ.items() if key != "LIEPOISSON_SIMD"}
    command = [*_cargo("run"), "--quiet"]
    process = subprocess.run(command, cwd=measure.ROOT, env=environment, capture_output=True, text=True, check=True)
    found = re.findall(r"^(\w+ f\d+) ([\d.]+) GFLOP/s$", process.stdout, flags=re.MULTILINE)
    return {name: float(value) for name, value in found}


def run(bench: Bench, simds: list[str], rounds: int) -> dict[str, Any]:
    """Peaks and kernels, as plain data for `report`."""
    build_peak()
    request: dict[str, Any] = {"task": "ensemble", "t_end": problem.T_END, "repeats": REPEATS}
    contenders: list[Contender] = []
    counts: dict[str, int] = {}
    for family, level in KERNELS:
        chosen = calibrate.loosest(bench.ours(family), level, level)
        for simd in simds:
            name = f"{family.name} at {problem.shown(level)}, {simd}"
            contenders.append(bench.contender(name, "liepoisson", request, chosen, simd=simd, kind=family.precision))
            counts[name] = operations(family, chosen[0].order)
    before = [peaks() for _ in range(PEAK_RUNS)]
    row = Row("Operations a second", contenders, problem.N_STARTS * problem.T_END)
    measured = measure.run_row(row, rounds)
    after = [peaks() for _ in range(PEAK_RUNS)]
    best = {name: max(one[name] for one in (*before, *after)) for name in before[0]}
    return {
        "kind": "kernels",
        "title": row.title,
        "peaks": best,
        "operations": counts,
        "measured": [asdict(one) for one in measured],
        "rounds": rounds,
    }


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: a line for each kernel."""
    table = [["kernel", "setting", "ns per step and lane", "GFLOP/s", "peak", "fraction of the peak"]]
    for one in data["measured"]:
        contender, best = one["contender"], min(one["seconds"])
        n_steps = one["answers"][0]["n_steps"]
        rate = data["operations"][contender["name"]] * n_steps / best / 1e9
        number = "f32" if contender["kind"] == "single" else "f64"
        peak = data["peaks"][f"{contender['simd']} {number}"]
        table.append(
            [
                contender["name"],
                measure.choice(contender["setting"]["request"]),
                f"{best / n_steps * 1e9:.1f}",
                f"{rate:.1f}",
                f"{peak:.1f} ({contender['simd']} {number})",
                f"{100 * rate / peak:.0f}%",
            ]
        )
    return table
