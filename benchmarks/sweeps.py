"""A map of 256 x 256 orbits: how long, how much memory, and what do two cores and four processes gain?

`python benchmarks/sweeps.py [--quick]`.  The map is (twist, energy) of the twisted Kovalevskaya top on the leaf
C1 = 1, C2 = 0.2, C3 = 1: one orbit and one tangent vector at each point, to t = 500.  Each row runs in a process of its
own, so that its peak memory is its own.  Seconds are those of the whole call, the start of processes included.  The
efficiency on n cores is T(1) / (n T(n)), where T runs from the first piece handed out to the last one back; processes
beyond the number of cores can gain nothing, so theirs is T(1) / (min(n, cores) T(n)).  Each worker's first piece
includes its imports, a second or so.  Last: the largest error of an orbit at t = 20.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time

import numpy as np

WANTED = "at most 45 s and 500 MB on 2 cores, error below 1e-6, efficiency above 0.9 from 1 to 2 cores"


def spec(side: int, t_end: float):
    from liepoisson.sweeps.spec import Axis, Starts, SweepSpec

    return SweepSpec(
        system="twisted-top",
        parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        axes=(Axis.linear("epsilon", 0, 1, side), Axis.linear("energy", -0.5, 2, side)),
        starts=Starts(casimirs={"C1": 1, "C2": 0.2, "C3": 1}),
        n_starts=1,
        t_end=t_end,
        seed=1,
    )


def measured(side: int, t_end: float, **where: int) -> None:
    """One run, as JSON on standard output."""
    import resource

    from liepoisson.sweeps.run import sweep

    began = time.perf_counter()
    result = sweep(spec(side, t_end), **where)
    seconds = time.perf_counter() - began
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    peaks = [resource.getrusage(kind).ru_maxrss / 1024 for kind in kinds]  # the largest child, in MB
    sums = [report.task_seconds for report in result.reports]
    facts = {
        "seconds": seconds,
        "wall": sum(report.wall_seconds for report in result.reports),
        "peak_mb": peaks,
        "tasks": sum(report.n_pieces for report in result.reports),
        "task_seconds": sum(sums),
        "overhead": result.overhead,
        "outcomes": result.outcomes,
        "digest": hash(np.nan_to_num(result.value).tobytes()),
    }
    print(json.dumps(facts))


def run(side: int, t_end: float, **where: int) -> dict[str, object]:
    code = f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r}); import sweeps; "
    code += f"sweeps.measured({side}, {t_end}, **{where!r})"
    environment = {**os.environ, "PYTHONHASHSEED": "0"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    return json.loads(done.stdout.splitlines()[-1])


def error_at_20() -> float:
    import liepoisson as lp
    from liepoisson.sweeps.spec import DEFAULT_METHOD

    top = lp.Top.twisted_kovalevskaya()
    x0 = lp.sample_states(top, 512, seed=1)
    exact, rough = (
        lp.integrate(top, x0, times=[0, 20], method=method).state[:, -1] for method in (lp.Taylor(), DEFAULT_METHOD)
    )
    return float(np.abs(rough - exact).max())


def main() -> None:
    quick = "--quick" in sys.argv
    side, t_end = (64, 200.0) if quick else (256, 500.0)
    cores = len(os.sched_getaffinity(0))
    print(f"{side} x {side} orbits to t = {t_end:g}, {cores} cores.  Wanted: {WANTED}.")
    rows = [{"threads": 1}, {"threads": 2}, {"processes": 1}, {"processes": 2}, {"processes": 4}]
    times: dict[str, float] = {}
    digests: set[object] = set()
    for where in rows:
        facts = run(side, t_end, **where)
        ((kind, n),) = where.items()
        times.setdefault(kind, float(facts["wall"]))  # type: ignore[arg-type]
        efficiency = times[kind] / (min(n, cores) * float(facts["wall"]))  # type: ignore[arg-type]
        own, child = facts["peak_mb"]  # type: ignore[misc]
        print(
            f"{n} {kind:10} {facts['seconds']:7.2f} s   efficiency {efficiency:.2f}   peak {own:.0f} MB"
            f"{f' + {child:.0f} MB the largest child' if kind == 'processes' else ''}   {facts['tasks']} tasks of "
            f"{facts['task_seconds'] / facts['tasks']:.2f} s, overhead {1e3 * facts['overhead']:.1f} ms each   "  # type: ignore[operator]
            f"{facts['outcomes']}",
            flush=True,
        )
        digests.add(facts["digest"])
    print(f"same bits: {len(digests) == 1}   largest error at t = 20: {error_at_20():.1e}")


if __name__ == "__main__":
    main()
