"""How long do Lyapunov spectra take, and how does the time grow with the number of vectors?

`python benchmarks/spectra.py [T_END]`.  Seconds of the processor in this process (user time, one thread, the least of
three), without the imports: all nine exponents of a hundred starts of the twisted Kovalevskaya top until T_END, by
default 10,000, by the default method and in mixed precision, beside one integration with as many tangent vectors and
no orthonormalisation; then what each of 1 to 18 tangent vectors costs more than the states alone, for the Euler
equations on su(5), in units of the best.
"""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

import liepoisson as lp
from liepoisson.numeric.tangent_frames import TangentFrames

TOP = lp.Top.twisted_kovalevskaya()
METHODS = {"default": lp.Taylor(tol=1e-13), "mixed": lp.Taylor(precision="mixed")}
N_VECTORS = (1, 2, 3, 4, 6, 9, 12, 18)


def main(t_end: float) -> None:
    """One line for each call."""
    starts = lp.sample_states(TOP, 100, seed=1)
    for name, method in METHODS.items():
        repeats = 3 if t_end <= 1000 else 1
        found, seconds = least(
            lambda method=method: lp.lyapunov_spectrum(TOP, starts, t_end=t_end, method=method, threads=1), repeats
        )
        _, alone = least(
            lambda method=method: lp.integrate(
                TOP, starts, times=[0, t_end], tangents=np.eye(9), method=method, threads=1
            ),
            repeats,
        )
        steps = int(found.n_steps.sum())
        print(
            f"{name:8} {seconds:8.3f} s  {1e6 * seconds / steps:6.2f} us a step, intervals of {found.interval:g}; "
            f"one integration {alone:.3f} s",
            flush=True,
        )
    zeitlin = lp.catalog.zeitlin(5)
    starts = lp.sample_states(zeitlin, 32, seed=1)
    _, state = least(lambda: lp.integrate(zeitlin, starts, times=[0, 200], method=METHODS["default"], threads=1), 3)
    costs: dict[int, float] = {}
    for n in N_VECTORS:

        def carry(n: int = n) -> TangentFrames:
            frames = TangentFrames(zeitlin, starts, n_vectors=n, threads=1, time_limit=3600.0)
            frames.carry(100, 2.0, per_row=100)
            return frames

        _, seconds = least(carry, 3)
        costs[n] = (seconds - state) / n
    best = min(costs.values())
    print(f"su(5), {len(starts)} starts, states alone {state:.3f} s")
    for n, cost in costs.items():
        print(f"{n:3} vectors {cost:8.4f} s each, {cost / best:.2f}", flush=True)


def least(call: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """The last result, and the least user time."""
    times: list[float] = []
    result = None
    for _ in range(repeats):
        began = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        result = call()
        times.append(resource.getrusage(resource.RUSAGE_SELF).ru_utime - began)
    return result, min(times)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 10_000.0)
