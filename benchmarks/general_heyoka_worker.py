"""heyoka's side of `general.py`: a system of `general_problems` with one tangent vector.

One request, one fresh process.  The equations are explicit, 2 n of them, with products merged as far as they can be.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import heyoka as hy  # pyright: ignore[reportMissingImports]  # lives in the peer's environment only
import numpy as np

import general_problems
from heyoka_worker import choose_disk_cache, run_ensemble


def equations(request: dict[str, Any]) -> list[tuple[Any, Any]]:
    """State and tangent vector, with their rates."""
    one = general_problems.PROBLEMS[request["system"]]
    x = list(hy.make_vars(*(f"x{i}" for i in range(one.n))))
    v = list(hy.make_vars(*(f"v{i}" for i in range(one.n))))
    rates = [rate + hy.expression(0.0) for rate in general_problems.rates_with_tangent(one, x, v, hy)]
    return list(zip(x + v, rates, strict=True))


def make(request: dict[str, Any]) -> Any:
    """The batch integrator of state and tangent vector."""
    system = equations(request)
    start = np.zeros((len(system), request["batch"]))
    return hy.taylor_adaptive_batch(system, start, tol=request["tol"], **request.get("flags", {}))


def reference(request: dict[str, Any]) -> dict[str, Any]:
    """States and tangent vectors at `t_end` in 80-bit arithmetic, written to the file `request["out"]`."""
    x0, t_end = np.load(request["problem"]).astype(np.longdouble), np.longdouble(request["t_end"])
    start = np.zeros(x0.shape[1], dtype=np.longdouble)
    tol = np.longdouble(request["tol"])
    integrator = hy.taylor_adaptive(equations(request), start, tol=tol, fp_type=np.longdouble, compact_mode=True)
    ends = np.empty_like(x0)
    for k, x in enumerate(x0):
        integrator.time = np.longdouble(0.0)
        integrator.state[:] = x
        integrator.propagate_until(t_end)
        ends[k] = integrator.state
    np.save(request["out"], ends)
    return {"order": integrator.order}


def ensemble(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat; compiling is not counted."""
    x0, t_end = np.load(request["problem"]), request["t_end"]
    integrator, seconds = make(request), []
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        run_ensemble(integrator, x0, t_end)
        seconds.append(time.perf_counter() - begin)
    return {"seconds": seconds, "order": integrator.order}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each order: states and tangent vectors at `t_end`, written to the file `request["out"]`."""
    x0, t_end = np.load(request["problem"]), request["t_end"]
    settings, ends = [], []
    for order in request["orders"]:
        tol = float(np.exp(3.0 - 2.0 * order))
        integrator = make(request | {"tol": tol})
        ends.append(run_ensemble(integrator, x0, t_end))
        settings.append({"request": {"tol": tol}, "order": integrator.order})
    np.save(request["out"], np.array(ends))
    return {"settings": settings}


if __name__ == "__main__":
    asked: dict[str, Any] = json.loads(sys.argv[1])
    choose_disk_cache(asked)
    print(json.dumps({"ensemble": ensemble, "scan": scan, "reference": reference}[asked["task"]](asked)))
