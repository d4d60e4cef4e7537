"""How near are the kernels to what a core can do?  Operations a second of each, beside the peak of multiply-adds.

Operations are counted from the formulas of a step, a fused multiply-add as two, and times the accepted steps of the
run: what idle lanes, refused steps and the controls of a step do is not counted as work, though its time is.
"""

from __future__ import annotations

import math
import os
import re
import subprocess
from dataclasses import asdict
from typing import Any

import calibrate
import measure
import problem
from bench import Bench
from calibrate import Setting
from families import DOUBLE, MIXED, SINGLE, TAYLOR, Family
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


def mixed_taylor_operations(order: int, tol: float) -> dict[str, int]:
    """One step in mixed precision: low orders of the state in double, the others and the tangent vector in single.

    Products of state or tangent vector alone are 15 or 30 of the 45 of `taylor_operations`; terms linear in the
    coefficients, divisions and sums are 41 operations for each order of either.  The orders are those of
    `MixedTaylor`; conversions between the precisions are not counted.
    """
    single = max(2.0**-24, tol)
    low = min(max(1, math.ceil((1 + 22 * math.log(2) / math.log(tol)) * order)), order - 1)
    tangent = min(max(2, math.ceil(math.log(single) / math.log(tol) * order)), order)
    pairs = {n: n * (n + 1) // 2 for n in (low, order, tangent)}
    return {
        "f64": 30 * pairs[low] + 41 * low,
        "f32": 30 * (pairs[order] - pairs[low]) + 41 * (order - low) + 60 * pairs[tangent] + 41 * tangent,
    }


def operations(family: Family, setting: Setting) -> dict[str, int]:
    """Operations of one step of a method, by type of number."""
    if family.precision == "mixed":
        return mixed_taylor_operations(setting.order, setting.request["method"]["tol"])
    if family.method == "Taylor":
        count = taylor_operations(setting.order)
    elif family.method == "RungeKutta":
        count = runge_kutta_operations()
    else:
        count = splitting_operations(family.options["order"], family.precision == "single")
    return {"f32" if family.precision == "single" else "f64": count}


def _family(families: list[Family], method: str, order: int | None = None) -> Family:
    """The one with fixed steps, and with that order if it has one."""
    return next(
        one for one in families if one.method == method and one.varied == "step" and one.options.get("order") == order
    )


KERNELS = [
    (TAYLOR, 1e-13),
    (MIXED, 1e-13),
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
    counts: dict[str, dict[str, int]] = {}
    for family, level in KERNELS:
        chosen = calibrate.loosest(bench.ours(family), level, level, family.judged_by_tangent)
        for simd in simds:
            name = f"{family.name} at {problem.shown(level)}, {simd}"
            contenders.append(bench.contender(name, "liepoisson", request, chosen, simd=simd, kind=family.precision))
            counts[name] = operations(family, chosen[0])
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


def reached(data: dict[str, Any]) -> list[dict[str, Any]]:
    """What each kernel reaches: time of a step, operations a second, and its part of the peak.

    In mixed precision the peak is the rate of a core that does each operation at the peak of its precision.
    """
    found: list[dict[str, Any]] = []
    for one in data["measured"]:
        contender, best = one["contender"], min(one["seconds"])
        name, simd = contender["name"], contender["simd"]
        n_steps = one["answers"][0]["n_steps"]
        by_number = data["operations"][name]
        shortest = sum(count / data["peaks"][f"{simd} {number}"] for number, count in by_number.items())
        rate = sum(by_number.values()) * n_steps / best / 1e9
        peak = sum(by_number.values()) / shortest
        found.append(
            {
                "kernel": name.removesuffix(f", {simd}"),
                "simd": simd,
                "setting": measure.choice(contender["setting"]["request"]),
                "numbers": " and ".join(by_number),
                "nanoseconds": best / n_steps * 1e9,
                "gflops": rate,
                "peak": peak,
                "fraction": rate / peak,
            }
        )
    return found


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: a line for each kernel."""
    table = [["kernel", "setting", "ns per step and lane", "GFLOP/s", "peak", "fraction of the peak"]]
    for one in reached(data):
        table.append(
            [
                f"{one['kernel']}, {one['simd']}",
                one["setting"],
                f"{one['nanoseconds']:.1f}",
                f"{one['gflops']:.1f}",
                f"{one['peak']:.1f} ({one['simd']} {one['numbers']})",
                f"{100 * one['fraction']:.0f}%",
            ]
        )
    return table
