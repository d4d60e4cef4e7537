"""How fast is liepoisson against heyoka.py, at equal accuracy?  `python benchmarks/run.py`, or `--quick` for a look.

Rules and meaning are in docs/benchmarks.md.  Run it with the Python that has liepoisson; heyoka gets an environment of
its own in benchmarks/.venv.  Nothing else should be computing meanwhile.  Results: benchmarks/results/.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import calibrate
import environment
import measure
import problem
import reference
import report
from calibrate import Setting
from measure import Contender, Row

ROUNDS, QUICK_ROUNDS = 12, 3
REPEATS = 5
ENSEMBLE_LEVELS = (1e-13, 1e-8)
SINGLE_LEVEL = 1e-14
"""Round-off: on both sides errors stop falling just below it."""
SINGLE_TOLERANCE = 1e-15
"""What a user types who wants round-off, on either side."""
BATCHES = (4, 8)
FAST_MATH: dict[str, Any] = {"flags": {"fast_math": True}}
"""Not heyoka's default, and it lets the compiler reorder roundings; faster on some machines, so it takes part."""
RESULTS = measure.HERE / "results"


def prepare(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Write starts and first tangent vectors for both sides; the latter are those that liepoisson itself draws."""
    from liepoisson.numeric.sampling import sample_tangents

    x0, tangents = problem.starts(), sample_tangents(9, problem.N_STARTS, seed=problem.SEED)
    np.save(path, np.concatenate([x0, tangents], axis=1))
    return x0, tangents


class Bench:
    """The contenders of every row, with the tolerances that their measured errors allow."""

    def __init__(self, problem_file: Path, exact: reference.Extended, batches: tuple[int, ...], avx2: bool) -> None:
        self.exact = exact
        self.common: dict[str, Any] = {"problem": str(problem_file)}
        self.simds: tuple[str | None, ...] = (None, "avx2") if avx2 else (None,)
        self.batch = self._fastest_batch(batches)
        self.scans = {
            (side, single): calibrate.scan(side, self._scan_request(side, single), exact, RESULTS)
            for side in ("heyoka", "liepoisson")
            for single in (False, True)
        }

    def _fastest_batch(self, batches: tuple[int, ...]) -> int:
        """heyoka's batch size, by measurement on this machine, at an order near that of the tightest level."""
        request = {"task": "ensemble", "t_end": problem.T_ACCURACY, "tol": 1e-12, "repeats": REPEATS} | self.common
        contenders = [Contender(str(batch), "heyoka", request | {"batch": batch}) for batch in batches]
        measured = measure.run_row(Row("batch", contenders, 1.0), QUICK_ROUNDS)
        return int(min(measured, key=lambda one: min(one.seconds)).contender.name)

    def _scan_request(self, side: str, single: bool) -> dict[str, Any]:
        choice: dict[str, Any] = (
            {"orders": list(calibrate.HEYOKA_ORDERS), "batch": self.batch}
            if side == "heyoka"
            else {"tols": [tol for tol in calibrate.LIEPOISSON_TOLERANCES if not single or tol < 1e-11]}
        )
        return self.common | choice | {"single": single}

    def _contender(
        self, name: str, side: str, request: dict[str, Any], chosen: tuple[Setting, bool], simd: str | None = None
    ) -> Contender:
        setting, meets = chosen
        request = self.common | request | {"tol": setting.tol} | ({"batch": self.batch} if side == "heyoka" else {})
        return Contender(name, side, request, asdict(setting) | {"meets": meets}, simd)

    def _loosest(self, side: str, single: bool, level: float) -> tuple[Setting, bool]:
        return calibrate.loosest(self.scans[side, single], level, level)

    def _ours(self, request: dict[str, Any], chosen: tuple[Setting, bool], suffix: str = "") -> list[Contender]:
        """liepoisson with its widest kernel, and with the AVX2 one where that is another."""
        return [
            self._contender("liepoisson" + (f" {simd}" if simd else "") + suffix, "liepoisson", request, chosen, simd)
            for simd in self.simds
        ]

    def ensemble(self, level: float) -> Row:
        """Exponents of the whole ensemble at one level of accuracy."""
        request = {"task": "ensemble", "t_end": problem.T_END, "repeats": REPEATS}
        peer = self._loosest("heyoka", False, level)
        fast = self._scan_request("heyoka", False) | FAST_MATH | {"orders": [peer[0].order]}
        reordered = calibrate.loosest(calibrate.scan("heyoka", fast, self.exact, RESULTS), level, level)
        strict = calibrate.loosest(self.scans["liepoisson", False], peer[0].state, peer[0].tangent)
        return Row(
            f"Ensemble exponent at {level:.0e}: {problem.N_STARTS} starts, t = 0..{problem.T_END:g}",
            [
                self._contender("heyoka", "heyoka", request, peer),
                self._contender("heyoka, fast_math", "heyoka", request | FAST_MATH, reordered),
                *self._ours(request, self._loosest("liepoisson", False, level)),
                *self._ours(request, strict, ", both errors at most heyoka's")[:1],
            ],
            problem.N_STARTS * problem.T_END,
        )

    def single(self, level: float | None) -> Row:
        """One trajectory at round-off: each side's fastest that meets the level, or the tolerance that users type."""
        request = {"task": "single", "t_end": problem.T_SINGLE, "repeats": REPEATS}
        if level is None:
            chosen = {side: (self._nearest(side, SINGLE_TOLERANCE), True) for side in ("heyoka", "liepoisson")}
            what = f"tol = {SINGLE_TOLERANCE:g} on both sides"
        else:
            chosen = {side: self._loosest(side, True, level) for side in ("heyoka", "liepoisson")}
            what = f"errors at most {level:g}"
        return Row(
            f"Single trajectory at round-off, {what}: state only, t = 0..{problem.T_SINGLE:g}",
            [
                self._contender("heyoka", "heyoka", request, chosen["heyoka"]),
                # the kernel for one trajectory is the same on every processor with AVX2
                *self._ours(request, chosen["liepoisson"])[:1],
            ],
            problem.T_SINGLE,
        )

    def _nearest(self, side: str, tol: float) -> Setting:
        return min(self.scans[side, True], key=lambda setting: abs(np.log(setting.tol / tol)))

    def cold(self, t_end: float) -> Row:
        """From starting Python to the mean exponent of the ensemble at the tightest level."""
        request = {"task": "cold", "t_end": t_end}
        peer = self._loosest("heyoka", False, ENSEMBLE_LEVELS[0])
        ours = self._loosest("liepoisson", False, ENSEMBLE_LEVELS[0])
        variants = {
            "heyoka, default flags": {},
            "heyoka, opt_level=0 (compiles faster)": {"flags": {"opt_level": 0}},
            "heyoka, code already in its disk cache": {"diskcache": str(RESULTS / "heyoka-cache")},
        }
        return Row(
            f"Cold start: new Python process to {problem.N_STARTS} exponents at t = {t_end:g}, 1e-13 level",
            [
                *(self._contender(name, "heyoka", request | extra, peer) for name, extra in variants.items()),
                *self._ours(request, ours)[:1],
            ],
            problem.N_STARTS * t_end,
            wall=True,
        )

    def rows(self) -> list[Row]:
        """All questions."""
        return [
            *(self.ensemble(level) for level in ENSEMBLE_LEVELS),
            self.single(None),
            self.single(SINGLE_LEVEL),
            *(self.cold(t_end) for t_end in (problem.T_ACCURACY, problem.T_END)),
        ]


def main() -> None:
    """Measure, print tables, and write results/full.json or results/quick.json."""
    parser = argparse.ArgumentParser(description="liepoisson against heyoka.py at equal accuracy, on one core")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK_ROUNDS} processes a contender, not {ROUNDS}")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    name, rounds = ("quick", QUICK_ROUNDS) if arguments.quick else ("full", ROUNDS)
    RESULTS.mkdir(exist_ok=True)
    environment.ensure_peer()
    facts = environment.facts(environment.pin(arguments.core))
    x0, tangents = prepare(RESULTS / "problem.npy")
    exact, facts["reference_error"] = reference.cached_flow(x0, tangents, problem.T_ACCURACY, RESULTS)
    batches = tuple({*BATCHES, facts["heyoka"]["recommended_batch"]})
    ours = facts["liepoisson"]
    bench = Bench(RESULTS / "problem.npy", exact, batches, "avx2" in ours["available"] and ours["kernel"] != "avx2")
    facts["batch"] = bench.batch
    print(report.environment_text(facts), flush=True)
    records: list[dict[str, Any]] = []
    for row in bench.rows():
        if row.wall:  # once without the clock: fills file caches, Python's and heyoka's
            measure.run_row(row, 1)
        measured = measure.run_row(row, rounds)
        print("\n" + report.table(row, measured), flush=True)
        records.append(report.record(row, measured))
    scans = {
        side + (" single" if single else ""): [asdict(setting) for setting in scan]
        for (side, single), scan in bench.scans.items()
    }
    (RESULTS / f"{name}.json").write_text(json.dumps({"facts": facts, "scans": scans, "rows": records}, indent=1))


if __name__ == "__main__":
    main()
