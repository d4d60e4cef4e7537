"""Fields without a kernel of their own against heyoka.py, at equal accuracy: `python benchmarks/general.py [--quick]`.

The rules are those of `run.py` (docs/benchmarks.md): fresh processes in turn on one core, all in double precision, each
side at the loosest tolerance whose measured errors of state and tangent vector meet the level.  Quadratic systems run
as quadratic fields, also the twisted top, whose own kernel is not used here; the others as tapes.  The reference is
heyoka in 80-bit arithmetic at a tolerance of 1e-19: another precision than either side's, and other code than ours.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

import calibrate
import environment
import general_problems
import measure
import problem
import report
from calibrate import Setting
from general_problems import PROBLEMS, Problem
from measure import Contender, Row

if TYPE_CHECKING:
    from reference import Extended

ROUNDS, QUICK_ROUNDS = 12, 3
REPEATS = 3
LEVELS = (1e-13, 1e-8)
REFERENCE_TOLERANCES = (1e-18, 1e-19)
"""heyoka in 80-bit arithmetic; the difference between the two is the error that is stated for the reference."""
ORDERS = range(8, 21)
TOLERANCES = [10.0 ** (-k / 4) for k in range(20, 64)]
HEYOKA_FLAGS: dict[str, dict[str, Any]] = {
    "heyoka": {},
    "heyoka, compact_mode": {"compact_mode": True},
}
BATCHES = (4, 8)


class Bench:
    """One system: its starts, its reference, and what each side needs for each level."""

    def __init__(self, one: Problem, avx2: bool) -> None:
        self.one = one
        self.file = measure.HERE / "results" / f"general-{one.n}.npy"
        np.save(self.file, general_problems.starts(one))
        self.common: dict[str, Any] = {"problem": str(self.file), "system": one.name}
        other, self.exact = map(self._reference, REFERENCE_TOLERANCES)
        self.reference_error = float(np.median(problem.relative_error(other, self.exact)))
        self.simds: tuple[str | None, ...] = (None, "avx2") if avx2 else (None,)
        self.peers = {name: self._with_batch(flags) for name, flags in HEYOKA_FLAGS.items()}
        self.scans = {
            # compact_mode compiles 60 times faster for 48 equations, and changes no more than roundings
            "heyoka": self._scan("heyoka", self.peers["heyoka, compact_mode"] | {"orders": list(ORDERS)}),
            "liepoisson": self._scan("liepoisson", {"tols": TOLERANCES}),
        }

    def _reference(self, tol: float) -> Extended:
        out = measure.HERE / "results" / "general-reference.npy"
        measure.call(
            "heyoka", self.common | {"task": "reference", "t_end": self.one.t_accuracy, "tol": tol, "out": str(out)}
        )
        found = np.load(out)
        out.unlink()
        return found

    def _with_batch(self, flags: dict[str, Any]) -> dict[str, Any]:
        """The flags with the batch size that is fastest with them here."""
        request = self.common | {"task": "ensemble", "t_end": self.one.t_accuracy, "tol": 1e-13, "repeats": 2}
        contenders = [Contender(str(batch), "heyoka", request | {"flags": flags, "batch": batch}) for batch in BATCHES]
        fastest = min(measure.run_row(Row("batch", contenders, 1.0), 2), key=lambda found: min(found.seconds))
        return {"flags": flags, "batch": int(fastest.contender.name)}

    def _scan(self, side: str, request: dict[str, Any]) -> list[Setting]:
        out = measure.HERE / "results" / "general-scan.npy"
        asked = self.common | request | {"task": "scan", "t_end": self.one.t_accuracy, "out": str(out)}
        answer, _ = measure.call(side, asked)
        n, found = self.one.n, np.load(out)
        out.unlink()
        return [
            Setting(
                **setting,
                state=float(np.median(problem.relative_error(end[:, :n], self.exact[:, :n]))),
                tangent=float(np.median(problem.relative_error(end[:, n:], self.exact[:, n:]))),
            )
            for setting, end in zip(answer["settings"], found, strict=True)
        ]

    def row(self, level: float) -> Row:
        """All contenders at one level of accuracy."""
        request = self.common | {"task": "ensemble", "t_end": self.one.t_end, "repeats": REPEATS}
        contenders: list[Contender] = []
        for side, variants in (("heyoka", self.peers), ("liepoisson", {simd: {} for simd in self.simds})):
            setting, meets = calibrate.loosest(self.scans[side], level, level)
            for name, extra in variants.items():
                shown = name if side == "heyoka" else f"liepoisson {name or ''}".strip()
                simd = None if side == "heyoka" else name
                chosen = asdict(setting) | {"meets": meets}
                contenders.append(Contender(shown, side, request | extra | {"tol": setting.tol}, chosen, simd))
        kind = "quadratic field" if self.one.quadratic else "tape"
        title = (
            f"{self.one.name} as a {kind} at {level:.0e}: {general_problems.N_STARTS} starts, t = 0..{self.one.t_end:g}"
        )
        return Row(title, contenders, general_problems.N_STARTS * self.one.t_end)

    def cold(self, level: float) -> Row:
        """From starting Python to the mean exponent of the twisted top; heyoka as in `run.py`."""
        import general_liepoisson_worker

        request: dict[str, Any] = {"problem": str(self.file), "t_end": problem.T_ACCURACY}
        peer, ours = (calibrate.loosest(self.scans[side], level, level) for side in ("heyoka", "liepoisson"))
        field = asdict(general_liepoisson_worker.field_of(self.one))
        heyoka = request | {"task": "cold", "tol": peer[0].tol, "batch": self.peers["heyoka"]["batch"]}
        plain = request | {"task": "cold", "tol": ours[0].tol, "system": self.one.name, "field": json.dumps(field)}
        contenders = [
            Contender("heyoka", "heyoka", heyoka, asdict(peer[0]) | {"meets": peer[1]}),
            Contender("liepoisson, field as data", "liepoisson", plain, asdict(ours[0]) | {"meets": ours[1]}),
            Contender(
                "liepoisson, Hamiltonian as text",
                "liepoisson",
                plain | {"task": "cold_text"},
                asdict(ours[0]) | {"meets": ours[1]},
            ),
        ]
        title = f"Cold start, {self.one.name} as a quadratic field: new Python process to 512 exponents at t = 20"
        return Row(title, contenders, general_problems.N_STARTS * problem.T_ACCURACY, wall=True)


def main() -> None:
    """Measure, print tables, and write results/general.json or results/general-quick.json."""
    parser = argparse.ArgumentParser(description="fields without a kernel of their own, against heyoka.py")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK_ROUNDS} processes a contender, not {ROUNDS}")
    parser.add_argument("--rounds", type=int, help="processes a contender")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    parser.add_argument("--system", action="append", choices=list(PROBLEMS), help="only this one (may be repeated)")
    arguments = parser.parse_args()
    rounds = arguments.rounds or (QUICK_ROUNDS if arguments.quick else ROUNDS)
    (measure.HERE / "results").mkdir(exist_ok=True)
    environment.ensure_peer()
    facts = environment.facts(environment.pin(arguments.core))
    ours = facts["liepoisson"]
    avx2 = "avx2" in ours["available"] and ours["kernel"] != "avx2"
    records: list[dict[str, Any]] = []
    for name in arguments.system or PROBLEMS:
        bench = Bench(PROBLEMS[name], avx2)
        described = report.environment_text(facts | {"reference_error": bench.reference_error, "batch": bench.peers})
        print(described, flush=True)
        rows = [bench.row(level) for level in LEVELS]
        rows += [bench.cold(LEVELS[0])] if name == "twisted top" else []
        for row in rows:
            measured = measure.run_row(row, rounds)
            print("\n" + report.table(row, measured), flush=True)
            records.append(report.record(row, measured))
    path = measure.HERE / "results" / ("general-quick.json" if arguments.quick else "general.json")
    path.write_text(json.dumps({"facts": facts, "rows": records}, indent=1))


if __name__ == "__main__":
    main()
