"""Fields without a kernel of their own against heyoka.py, at equal accuracy: `python benchmarks/general.py [--quick]`.

The rules are those of `run.py` (docs/benchmarks.md): fresh processes in turn on one core, all in double precision, each
side at the loosest tolerance whose measured errors of state and tangent vector meet the level.  Quadratic systems run
as quadratic fields, also the twisted top, whose own kernel is not used here; the others as tapes.  The reference is
heyoka in 80-bit arithmetic at a tolerance of 1e-19: another precision than either side's, and other code than ours.
"""

from __future__ import annotations

import argparse
import json
import re
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

import calibrate
import general_problems
import measure
import problem
import report
import run
from calibrate import Setting
from general_problems import PROBLEMS, Problem
from measure import Contender, Row

if TYPE_CHECKING:
    from reference import Extended

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
CACHE = {"diskcache": str(measure.HERE / "results" / "heyoka-cache-general")}
"""Where heyoka keeps compiled code between the processes of a row, in which compiling does not count: that of the 48
equations of su(5) takes minutes."""


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
        request = self.common | {"task": "ensemble", "t_end": self.one.t_accuracy, "tol": 1e-13, "repeats": 2} | CACHE
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
        peer, ours = (calibrate.loosest(self.scans[side], level, level) for side in ("heyoka", "liepoisson"))
        theirs, mine = (asdict(setting) | {"meets": meets} for setting, meets in (peer, ours))
        contenders = [
            Contender(name, "heyoka", request | CACHE | extra | peer[0].request, theirs)
            for name, extra in self.peers.items()
        ]
        contenders += [
            Contender("liepoisson" + (f" {simd}" if simd else ""), "liepoisson", request | ours[0].request, mine, simd)
            for simd in self.simds
        ]
        kind = "quadratic field" if self.one.quadratic else "tape"
        size = f"{general_problems.N_STARTS} starts, t = 0..{self.one.t_end:g}"
        title = f"{self.one.name} as a {kind} at {problem.shown(level)}: {size}"
        return Row(title, contenders, general_problems.N_STARTS * self.one.t_end)

    def cold(self, level: float) -> Row:
        """From starting Python to the mean exponent of the twisted top; heyoka as in `run.py`."""
        import general_liepoisson_worker

        request: dict[str, Any] = {"problem": str(self.file), "t_end": problem.T_ACCURACY}
        peer, ours = (calibrate.loosest(self.scans[side], level, level) for side in ("heyoka", "liepoisson"))
        field = asdict(general_liepoisson_worker.field_of(self.one))
        heyoka = request | {"task": "cold", **peer[0].request, "batch": self.peers["heyoka"]["batch"]}
        plain = request | {"task": "cold", **ours[0].request, "system": self.one.name, "field": json.dumps(field)}
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


def file_name(name: str, what: str) -> str:
    """The name of a table: `general-twisted-top-1e-13`."""
    words = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
    return f"general-{words}-{what}"


def main() -> None:
    """Measure, print tables, and write their data."""
    parser = argparse.ArgumentParser(description="fields without a kernel of their own, against heyoka.py")
    run.add_options(parser)
    parser.add_argument("--system", action="append", choices=list(PROBLEMS), help="only this one (may be repeated)")
    arguments = parser.parse_args()
    facts, rounds, folder = run.start(arguments)
    ours = facts["liepoisson"]
    avx2 = "avx2" in ours["available"] and ours["kernel"] != "avx2"
    for name in arguments.system or PROBLEMS:
        bench = Bench(PROBLEMS[name], avx2)
        known = facts | {"reference_error": bench.reference_error, "batch": bench.peers}
        print(report.environment_text(known), flush=True)
        rows = {problem.shown(level): bench.row(level) for level in LEVELS}
        if name == "twisted top":
            rows["cold"] = bench.cold(LEVELS[0])
        for what, row in rows.items():
            data = report.record(row, measure.run_row(row, rounds), rounds)
            report.save(folder, file_name(name, what), data, known)
            print("\n" + report.render(data), flush=True)


if __name__ == "__main__":
    main()
