"""How long do Lyapunov spectra take, and how does the time grow with the number of vectors?

`python benchmarks/spectra.py [T_END]`.  Seconds of the processor in this process (user time, one thread, the least of
three), without the imports: all nine exponents of a hundred starts of the twisted Kovalevskaya top until T_END, by
default 10,000, by the default method and in mixed precision, beside one integration with as many tangent vectors and
no orthonormalisation; then what each of 1 to 18 tangent vectors costs more than the states alone, for the Euler
equations on su(5), in units of the best.
"""

from __future__ import annotations

import argparse
import resource
from collections.abc import Callable
from typing import Any

METHODS: dict[str, dict[str, Any]] = {"default": {"tol": 1e-13}, "mixed precision": {"precision": "mixed"}}
N_VECTORS = (1, 2, 3, 4, 6, 9, 12, 18)
T_END = 10_000.0
REPEATS = 3


def run(t_end: float) -> dict[str, Any]:
    """Spectra of the top and costs of tangent vectors on su(5), as plain data for `report`."""
    import liepoisson as lp

    repeats = REPEATS if t_end <= 1000 else 1
    top = lp.Top.twisted_kovalevskaya()
    starts = lp.sample_states(top, 100, seed=1)
    lp.lyapunov_spectrum(top, starts[:1], t_end=1, threads=1)  # imports are not measured
    spectra = {name: _spectrum(top, starts, t_end, lp.Taylor(**options), repeats) for name, options in METHODS.items()}
    return {
        "kind": "spectra",
        "title": f"All nine exponents of the twisted top, {len(starts)} starts, t = 0..{t_end:g}; vectors on su(5)",
        "spectra": spectra,
        **_vectors(),
        "rounds": repeats,
    }


def _spectrum(top: Any, starts: Any, t_end: float, method: Any, repeats: int) -> dict[str, float]:
    import numpy as np

    import liepoisson as lp

    found, seconds = least(lambda: lp.lyapunov_spectrum(top, starts, t_end=t_end, method=method, threads=1), repeats)
    _, alone = least(
        lambda: lp.integrate(top, starts, times=[0, t_end], tangents=np.eye(9), method=method, threads=1), repeats
    )
    steps = int(found.n_steps.sum())
    return {"seconds": seconds, "n_steps": steps, "interval": float(found.interval), "integration": alone}


def _vectors() -> dict[str, Any]:
    import liepoisson as lp
    from liepoisson.indicators.tangent_frames import TangentFrames
    from liepoisson.numeric.run_options import RunOptions

    zeitlin = lp.catalog.zeitlin(5)
    starts = lp.sample_states(zeitlin, 32, seed=1)
    method = lp.Taylor(**METHODS["default"])
    _, state = least(lambda: lp.integrate(zeitlin, starts, times=[0, 200], method=method, threads=1), REPEATS)
    costs: dict[str, float] = {}
    for n in N_VECTORS:

        def carry(n: int = n) -> None:
            TangentFrames(zeitlin, starts, RunOptions.read(None, 1), n_vectors=n).carry(100, 2.0, per_row=100)

        _, seconds = least(carry, REPEATS)
        costs[str(n)] = (seconds - state) / n
    return {"states_alone": state, "vectors": costs}


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: a line for each method of the top, then one for each number of vectors on su(5)."""
    table = [["what", "seconds of the processor", "beside it"]]
    for name, one in data["spectra"].items():
        step = f"{1e6 * one['seconds'] / one['n_steps']:.2f} us a step, intervals of {one['interval']:g}"
        beside = f"{step}; one integration with 9 tangent vectors {one['integration']:.2f}"
        table.append([f"spectrum, {name}", f"{one['seconds']:.2f}", beside])
    best = min(data["vectors"].values())
    table.append(["su(5), 32 states alone", f"{data['states_alone']:.3f}", ""])
    for n, cost in data["vectors"].items():
        table.append([f"su(5), each of {n} tangent vectors", f"{cost:.4f}", f"{cost / best:.2f} of the least"])
    return table


def main() -> None:
    """Measure, print the table, and write its data."""
    import report
    import run as runs

    parser = argparse.ArgumentParser(description="Lyapunov spectra, and what each tangent vector costs")
    parser.add_argument(
        "t_end", type=float, nargs="?", default=T_END, help="less than the default does not go to the docs"
    )
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    facts = runs.facts(arguments.core)
    data = run(arguments.t_end)
    report.save(report.TABLES if arguments.t_end >= T_END else report.QUICK, "spectra", data, facts)
    print(report.render(data))


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
    main()
