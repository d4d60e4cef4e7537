"""liepoisson's side: how fast and how accurate is liepoisson, called as a user calls it?  The twin of heyoka_worker.py.

    python liepoisson_worker.py '{"task": "ensemble", "problem": "problem.npy", "tol": 1e-13, ...}'

The environment variable LIEPOISSON_SIMD chooses the kernel; the answer, one line of JSON, says which one ran.
"""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np

import liepoisson as lp
import problem

if TYPE_CHECKING:
    from problem import Array


def _top() -> lp.Top:
    return lp.Top(inertia=problem.INERTIA, a=problem.A, b=problem.B, epsilon=problem.EPSILON)


def run_ensemble(x0: Array, t_end: float, tol: float) -> lp.Growth:
    """The exponent of every start at one time, on one thread, as heyoka's side computes it."""
    growth = lp.lyapunov_exponent(_top(), x0, times=[t_end], seed=problem.SEED, method=lp.Taylor(tol=tol), threads=1)
    _require_finished(growth)
    return growth


def run_single(top: lp.Top, x0: Array, t_end: float, tol: float) -> lp.Orbit:
    """One trajectory, state only."""
    return lp.integrate(top, x0, t=[0.0, t_end], method=lp.Taylor(tol=tol), threads=1)


def _require_finished(result: lp.Growth | lp.Orbit) -> None:
    if not (result.outcome == "finished").all():
        raise RuntimeError(f"trajectories did not finish: {np.unique(result.outcome)}")


def ensemble(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of the ensemble run."""
    x0, t_end = np.load(request["problem"])[:, :9], request["t_end"]
    growth, seconds = run_ensemble(x0, problem.T_ACCURACY, request["tol"]), []
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        growth = run_ensemble(x0, t_end, request["tol"])
        seconds.append(time.perf_counter() - begin)
    return {
        "seconds": seconds,
        "order": growth.order,
        "kernel": growth.kernel,
        "mean_exponent": float(growth.exponent[:, -1].mean()),
    }


def single(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds per trajectory of each repeat, each averaged over the first starts; and where they end."""
    x0, t_end, top = np.load(request["problem"])[: problem.N_SINGLE, :9], request["t_end"], _top()
    orbit, seconds = run_single(top, x0[0], problem.T_ACCURACY, request["tol"]), []
    ends = np.empty_like(x0)
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        for k, x in enumerate(x0):
            orbit = run_single(top, x, t_end, request["tol"])
            ends[k] = orbit.state[0, -1]
        seconds.append((time.perf_counter() - begin) / len(x0))
    _require_finished(orbit)
    return {"seconds": seconds, "order": orbit.order, "kernel": orbit.kernel, "drift": problem.drift(x0, ends)}


def cold(request: dict[str, Any]) -> dict[str, Any]:
    """One ensemble result as soon as possible; the clock is the caller's."""
    x0, t_end = np.load(request["problem"])[:, :9], request["t_end"]
    growth = run_ensemble(x0, t_end, request["tol"])
    return {"mean_exponent": float(growth.exponent[:, -1].mean()), "kernel": growth.kernel}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each tolerance: states, tangent vectors and exponents at `t_end`, written to the file `request["out"]`.

    Exponents and states come from the very call that is timed; the tangent vectors, which that call does not return,
    from `integrate`, which must arrive at the same states.
    """
    data, t_end, top = np.load(request["problem"]), request["t_end"], _top()
    x0, tangents = data[:, :9], data[:, None, 9:]
    settings: list[dict[str, Any]] = []
    states: list[Array] = []
    ends: list[Array] = []
    exponents: list[Array] = []
    for tol in request["tols"]:
        if request["single"]:
            orbit = run_single(top, x0[0], t_end, tol)
            states.append(np.array([run_single(top, x, t_end, tol).state[0, -1] for x in x0]))
        else:
            growth = run_ensemble(x0, t_end, tol)
            orbit = lp.integrate(top, x0, t=[0.0, t_end], tangents=tangents, method=lp.Taylor(tol=tol), threads=1)
            if not np.allclose(orbit.state[:, -1], growth.final_state, rtol=0.0, atol=tol):
                raise RuntimeError("integrate and lyapunov_exponent arrive at different states")
            states.append(growth.final_state)
            ends.append(orbit.tangent[:, -1, 0])
            exponents.append(growth.exponent[:, -1])
        settings.append({"tol": tol, "order": orbit.order})
    np.savez(request["out"], state=np.array(states), tangent=np.array(ends), exponent=np.array(exponents))
    return {"settings": settings}


def versions(_: dict[str, Any]) -> dict[str, Any]:
    """What this side is made of."""
    from liepoisson import _core

    return {
        "liepoisson": lp.__version__,
        "numpy": np.__version__,
        "kernel": _core.simd(),
        "available": _core.available_simd(),
    }


def main() -> None:
    """Answer the request on the command line."""
    request: dict[str, Any] = json.loads(sys.argv[1])
    tasks = {"ensemble": ensemble, "single": single, "cold": cold, "scan": scan, "versions": versions}
    print(json.dumps(tasks[request["task"]](request)))


if __name__ == "__main__":
    main()
