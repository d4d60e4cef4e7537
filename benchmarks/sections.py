"""How long do a million crossings of the Kovalevskaya top take, and how much memory?  Aim: 15 s on two cores, 300 MB.

`python benchmarks/sections.py [N_CROSSINGS]` prints one line of JSON: crossings, seconds, the largest memory of the
process in MB (with Python and NumPy, and what was there before the run), the farthest point from the surface, and how
far the integrals of motion are from their values at the start.
"""

from __future__ import annotations

import json
import resource
import sys
import time

import numpy as np

import liepoisson as lp

TRAJECTORIES = 1000


def main(n_crossings: int) -> None:
    """Sections l3 = 0 of a thousand random starts, two numbers kept of each crossing; then a smaller check."""
    top = lp.Top.kovalevskaya()
    x0 = lp.sample_states(top, TRAJECTORIES, seed=1)
    x0[:, 2], x0[:, 6:] = 0, 0  # on the surface, so that almost all come back to it; without the second field
    lp.section(top, x0[:1], surface="l3", t_end=1)  # imports and compiled formulas are not measured
    before = _largest_memory()
    begin = time.perf_counter()
    found = lp.section(
        top, x0, surface="l3", t_end=1e5, n_crossings=-(-n_crossings // TRAJECTORIES), keep=("l1", "alpha3")
    )
    seconds = time.perf_counter() - begin
    memory = _largest_memory()
    print(
        json.dumps({
            "crossings": len(found.time),
            "seconds": round(seconds, 3),
            "crossings_per_second": round(len(found.time) / seconds),
            "steps": int(found.n_steps.sum()),
            "memory_mb": round(memory, 1),
            "memory_before_mb": round(before, 1),
            "touches": len(found.touch_time),
            "unbounded_steps": int(found.unbounded_steps.sum()),
            "kernel": found.kernel,
            **_check(top, x0[:50]),
        })
    )  # fmt: skip


def _check(top: lp.Top, x0: np.ndarray) -> dict[str, float]:
    found = lp.section(top, x0, surface="l3", t_end=1e4, n_crossings=200)
    quartic = top.functions.of("(l1**2/4 - l2**2/4 + alpha1)**2 + (l1*l2/2 + alpha2)**2")
    off = np.abs(quartic(found.state) - quartic(x0)[found.trajectory])
    return {"largest_l3": float(np.abs(found.state[:, 2]).max()), "largest_change_of_K": float(off.max())}


def _largest_memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
