"""Are results the same, bit for bit, for every number of threads and every instruction set?

For each method, states, tangent vectors and numbers of steps of an ensemble are hashed, in a fresh process for each
instruction set (`LIEPOISSON_SIMD`) and for 1, 2 and 3 threads.  The ensemble does not fill the last register, and its
members take different numbers of steps.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

import contenders
import liepoisson as lp
from liepoisson._core import available_simd
from problems import NONLINEAR, TOPS, first_tangents, integrate, starts
from settings import Settings
from store import Store

THREADS = (1, 2, 3)
N_MEMBERS = 37
T_END = 20.0
STEP = 0.1


def methods() -> dict[str, Any]:
    """Every method, in each precision that it has."""
    stepping = {contender.name: contender.make(STEP) for contender in (*contenders.WITH_STEPS, contenders.COMPENSATED)}
    return {
        "Taylor": lp.Taylor(),
        "Taylor, mixed precision": contenders.MIXED.make(1e-13),
        "Runge-Kutta 8, adaptive": lp.RungeKutta(tol=1e-8),
        "Runge-Kutta 8, adaptive, single precision": lp.RungeKutta(tol=1e-4, precision="single"),
        "splitting 4, single precision": lp.Splitting(step=STEP, order=4, precision="single"),
        **stepping,
    }


def hashes() -> dict[str, dict[str, str]]:
    """Of each method, the hash of its results for each number of threads, with the kernel that this process has."""
    return {name: {str(k): _hash(method, k) for k in THREADS} for name, method in methods().items()}


def _hash(method: Any, threads: int) -> str:
    state = hashlib.sha256()
    for top in NONLINEAR:
        v0 = first_tangents(N_MEMBERS)[:, None]
        orbit = integrate(
            TOPS[top], starts(top, N_MEMBERS), np.linspace(0.0, T_END, 5), method, tangents=v0, threads=threads
        )
        for array in (orbit.state, orbit.tangent, orbit.n_steps, orbit.end_time):
            state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()[:12]


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Hashes for every instruction set that this processor has."""
    found = {simd: _in_a_process(simd) for simd in available_simd()}
    names = list(next(iter(found.values())))
    different = [
        name for name in names if len({value for table in found.values() for value in table[name].values()}) > 1
    ]
    return {"simd": list(found), "threads": THREADS, "members": N_MEMBERS, "hashes": found, "different": different}


def _in_a_process(simd: str) -> dict[str, dict[str, str]]:
    environment = os.environ | {"LIEPOISSON_SIMD": simd}
    command = [sys.executable, str(Path(__file__).resolve())]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def table(result: dict[str, Any]) -> str:
    """What was run, and the methods whose hashes differ."""
    names = list(next(iter(result["hashes"].values())))
    verdict = f"Different: {', '.join(result['different'])}." if result["different"] else "No run differs from another."
    sets, threads = ", ".join(result["simd"]), ", ".join(map(str, result["threads"]))
    return (
        f"{len(names)} methods, instruction sets {sets}; {threads} threads; {result['members']} trajectories: {verdict}"
    )


if __name__ == "__main__":
    print(json.dumps(hashes()))
