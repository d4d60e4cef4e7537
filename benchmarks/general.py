"""Systems that users type against heyoka.py at its best, at equal errors: `python benchmarks/general.py --avx2`.

Ten systems (`general_problems.py`), 512 orbits with a tangent vector each and one orbit of the state alone, at 1e-13
and at 1e-8.  heyoka runs at the lowest order whose median errors of state and tangent vector are at most the level (its
steps hardly depend on the order), with what is fastest there of `fast_math`, `compact_mode` and batches; liepoisson
with the faster of `Taylor` and `RungeKutta`, at the loosest tolerance whose errors are at most heyoka's, and once more
without compiled code (LIEPOISSON_JIT=0).  The reference is heyoka in 80-bit arithmetic at a tolerance of 1e-19.  Times
are seconds of the processor in fresh processes, in turn on one core.  What heyoka is best with is searched once for
each row, and kept in results/search/.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import time
from dataclasses import asdict
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import bench
import calibrate
import families
import general_problems
import measure
import problem
import report
import run
from calibrate import Setting
from comparison import NOT_COMPILED
from families import Family
from general_problems import PROBLEMS, ROWS
from measure import Contender, Row

if TYPE_CHECKING:
    from reference import Extended

REPEATS, LOOK_ROUNDS = 3, 3
ORDERS = range(8, 21)
REFERENCE_TOLERANCES = (1e-18, 1e-19)
"""heyoka in 80-bit arithmetic; the difference between the two is the error that is stated for the reference."""
FLAGS: list[dict[str, Any]] = [
    {"fast_math": fast, "compact_mode": compact} for fast, compact in product((False, True), repeat=2)
]
BATCHES = {True: (4, 8), False: (1,)}
"""Of many orbits, and of one."""
FAMILIES = [families.TAYLOR, Family("RungeKutta", "RungeKutta", "tol")]
ROUND_OFF = 2.0**-50
"""Eight units of round-off: errors below it count as equal."""
SEARCHES = measure.HERE / "results" / "search"
QUICK_STARTS = 64
DURATION = "All rows take about an hour, some 45 minutes where heyoka's search is kept; --quick takes half of it."


class Bench:
    """One system: its starts, its reference, and what each side needs for each row."""

    def __init__(self, system: str, n_starts: int, facts: dict[str, Any], anew: bool = False) -> None:
        self.system, self.one = system, PROBLEMS[system]
        self.data = general_problems.starts(self.one, n_starts)
        sources = (general_problems.__file__, str(measure.HERE / "general_heyoka_worker.py"))
        asked = hashlib.sha256(b"".join(Path(source).read_bytes() for source in sources) + self.data.tobytes())
        question = {"processor": facts["processor"], "heyoka": facts["heyoka"], "problem": asked.hexdigest()}
        self.folder = SEARCHES / f"{system}-{n_starts}"
        self.kept = self.folder / "search.json"
        self.search: dict[str, Any] = json.loads(self.kept.read_text()) if self.kept.exists() and not anew else {}
        if self.search.get("question") != question:
            shutil.rmtree(self.folder, ignore_errors=True)  # also heyoka's compiled code, so that compiling is measured
            self.folder.mkdir(parents=True)
            np.save(self.folder / "starts.npy", self.data)
            other, exact = (self._reference(tol) for tol in REFERENCE_TOLERANCES)
            np.save(self.folder / "reference.npy", exact)
            error = float(np.median(problem.relative_error(other, exact)))
            self.search = {"question": question, "reference_error": error, "rows": {}}
        self.exact: Extended = np.load(self.folder / "reference.npy")
        self.orders = cache(self._orders)
        self.scan = cache(self._scan)

    def _reference(self, tol: float) -> Extended:
        return self._found("heyoka", {"task": "reference", "tangent": True, "t_end": self.one.t_accuracy, "tol": tol})[
            1
        ]

    def _found(self, side: str, request: dict[str, Any]) -> tuple[dict[str, Any], Any]:
        """What a worker answers, and what it has written."""
        out = self.folder / "found.npy"
        answer, _ = measure.call(side, self._request() | request | {"out": str(out)})
        found = np.load(out)
        out.unlink()
        return answer, found

    def _request(self) -> dict[str, Any]:
        return {
            "problem": str(self.folder / "starts.npy"),
            "system": self.system,
            "t_accuracy": self.one.t_accuracy,
        }

    def _t_end(self, tangent: bool) -> float:
        return self.one.t_end if tangent else self.one.t_one

    def _run(self, tangent: bool) -> dict[str, Any]:
        """What is asked of both sides, but for their settings; heyoka keeps compiled code between processes."""
        kept = {"diskcache": str(self.folder / "heyoka"), "repeats": REPEATS}
        return self._request() | kept | {"task": "run", "tangent": tangent, "t_end": self._t_end(tangent)}

    def setting(self, chosen: dict[str, Any], ends: problem.Array, **more: Any) -> Setting:
        """A setting with its errors: medians over the starts, and the worst, with how its tangent vector has grown."""
        n, errors, largest = self.one.n, {}, {}
        for name, part in (("state", slice(n)), ("tangent", slice(n, ends.shape[1]))):
            off = problem.relative_error(ends[:, part], self.exact[:, part]) if ends[:, part].size else np.zeros(1)
            start = int(np.argmax(off))  # the first that is not a number, if there are any
            growth = float(np.linalg.norm(self.exact[start, n:]))
            errors[name] = float(np.median(off))
            largest[name] = {"error": float(off[start]), "start": start, "growth": growth}
        return Setting(**chosen, **errors, largest=largest, **more)

    def _settings(self, side: str, request: dict[str, Any]) -> list[Setting]:
        answer, found = self._found(side, request | {"task": "scan"})
        return [self.setting(chosen, ends) for chosen, ends in zip(answer["settings"], found, strict=True)]

    def _orders(self, tangent: bool) -> list[Setting]:
        """heyoka's errors at each order, with the flags that compile fastest."""
        way = {"batch": BATCHES[tangent][-1], "flags": {"compact_mode": True}}
        return self._settings("heyoka", way | {"tangent": tangent, "orders": list(ORDERS)})

    def _scan(self, tangent: bool) -> list[Setting]:
        """Our errors with each method and tolerance."""
        methods = [request for family in FAMILIES for request in family.requests()]
        return self._settings("liepoisson", {"tangent": tangent, "methods": methods})

    def ways(self, name: str) -> list[dict[str, Any]]:
        """All ways of heyoka at the order that a row needs, with errors and times: those kept, or a search.

        The first process of each has to compile: its time to a first result is the cold start.
        """
        rows = self.search["rows"]
        if name not in rows:
            _, tangent, level = ROWS[name]
            order, _ = calibrate.loosest(self.orders(tangent), level, level)
            found: list[dict[str, Any]] = []
            for flags, batch in product(FLAGS, BATCHES[tangent]):
                way = order.request | {"flags": flags, "batch": batch}
                looks = [self._found("heyoka", self._run(tangent) | way) for _ in range(LOOK_ROUNDS)]
                times = {"seconds": min(min(look["seconds"]) for look, _ in looks), "cold": looks[0][0]["cold"]}
                setting = self.setting({"request": way, "order": order.order}, looks[0][1], **times)
                found.append(asdict(setting) | {"meets": setting.meets(level, level)})
            rows[name] = found
            self.kept.write_text(json.dumps(self.search, indent=1))
        return rows[name]

    def row(self, name: str, simds: list[str | None]) -> Row:
        """heyoka's best beside ours, with each instruction set, and with the first also without compiled code."""
        _, tangent, level = ROWS[name]
        ways = [way for way in self.ways(name) if way["meets"]] or self.ways(name)
        best = min(ways, key=lambda way: way["seconds"])
        best = best | {"cold": min(way["cold"] for way in ways)}  # of another way, if compact_mode compiles faster
        contenders = [Contender(_name(best["request"]), "heyoka", self._run(tangent) | best["request"], best)]
        for simd in simds:
            fastest = bench.quickest([self._ours(family, tangent, best, simd) for family in FAMILIES])
            contenders.append(fastest)
        plain = contenders[1].request | {"environment": {"LIEPOISSON_JIT": "0"}}
        name = f"{contenders[1].name}, not compiled"
        contenders.append(Contender(name, "liepoisson", plain, contenders[1].setting, simds[0], NOT_COMPILED))
        n, what = (len(self.data), " orbits with a tangent vector each") if tangent else (1, " orbit")
        title = f"{self.one.name} at {problem.shown(level)}: {n}{what}, t = 0..{self._t_end(tangent):g}"
        return Row(title, contenders, n * self._t_end(tangent))

    def _ours(self, family: Family, tangent: bool, best: dict[str, Any], simd: str | None) -> Contender:
        """One of our methods at the loosest tolerance whose errors are at most heyoka's."""
        own = [setting for setting in self.scan(tangent) if setting.request["method"]["name"] == family.method]
        chosen, meets = calibrate.loosest(own, *(max(best[error], ROUND_OFF) for error in ("state", "tangent")))
        name = f"liepoisson {family.name}" + (f", {simd}" if simd else "")
        request = self._run(tangent) | chosen.request
        return Contender(name, "liepoisson", request, asdict(chosen) | {"meets": meets}, simd, "double")


def _name(way: dict[str, Any]) -> str:
    """What tables call a way of heyoka."""
    batch = [f"batch {way['batch']}"] if way["batch"] > 1 else []
    return ", ".join(["heyoka", *batch, *(flag for flag, on in way["flags"].items() if on)])


def main() -> None:
    """Measure, print tables, and write their data."""
    parser = argparse.ArgumentParser(description="systems that users type, against heyoka.py", epilog=DURATION)
    run.add_options(parser)
    parser.add_argument("--only", nargs="+", metavar="ROW", help="only these rows; an unknown one lists them")
    parser.add_argument("--avx2", action="store_true", help="ours also with LIEPOISSON_SIMD=avx2")
    parser.add_argument("--search", action="store_true", help="search heyoka's best settings anew")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.only or [] if name not in ROWS]
    if unknown:
        parser.error(f"--only: wanted rows out of {', '.join(ROWS)}; got {', '.join(unknown)}")
    facts, rounds, folder = run.start(arguments)
    avx2 = arguments.avx2 and facts["liepoisson"]["kernel"] != "avx2"
    print(f"{report.environment_text(facts)}\n{DURATION}", flush=True)
    for system in PROBLEMS:
        wanted = [name for name in arguments.only or ROWS if ROWS[name][0] == system]
        if wanted:
            found = Bench(system, QUICK_STARTS if arguments.quick else problem.N_STARTS, facts, arguments.search)
        for name in wanted:
            begin = time.monotonic()
            row = found.row(name, [None, "avx2"] if avx2 else [None])
            data = report.record(row, measure.run_row(row, rounds), rounds) | {"search": found.ways(name)}
            report.save(folder, name, data, facts | {"reference_error": found.search["reference_error"]})
            print(f"\n{report.render(data)}\n{time.monotonic() - begin:.0f} seconds.", flush=True)


if __name__ == "__main__":
    main()
