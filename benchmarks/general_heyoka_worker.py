"""heyoka's side of `general.py`: a system of `general_problems`, with one tangent vector or without.

One request, one fresh process.  The equations are explicit, 2 n of them or n, with products merged as far as they can.
"""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import heyoka as hy  # pyright: ignore[reportMissingImports]  # lives in the peer's environment only
import numpy as np

import general_problems
import problem
from heyoka_worker import choose_disk_cache, run_ensemble, run_single

if TYPE_CHECKING:
    from problem import Array


def equations(request: dict[str, Any]) -> list[tuple[Any, Any]]:
    """The state, with its tangent vector if it has one, and their rates."""
    one = general_problems.PROBLEMS[request["system"]]
    x = list(hy.make_vars(*(f"x{i}" for i in range(one.n))))
    v = list(hy.make_vars(*(f"v{i}" for i in range(one.n)))) if request["tangent"] else []
    rates = general_problems.rates_with_tangent(one, x, v, hy) if v else one.rates(x, hy)
    return list(zip(x + v, [rate + hy.expression(0.0) for rate in rates], strict=True))


def make(request: dict[str, Any]) -> Any:
    """The integrator: of one orbit, or of as many as its batch has."""
    system, flags, batch = equations(request), request.get("flags", {}), request["batch"]
    if batch == 1:
        return hy.taylor_adaptive(system, np.zeros(len(system)), tol=request["tol"], **flags)
    return hy.taylor_adaptive_batch(system, np.zeros((len(system), batch)), tol=request["tol"], **flags)


def ends(integrator: Any, starts: Array, t_end: float) -> Array:
    """What is reached from each start."""
    if hasattr(integrator, "batch_size"):
        return run_ensemble(integrator, starts, t_end)
    return np.array([run_single(integrator, start, t_end) for start in starts])


def reference(request: dict[str, Any]) -> dict[str, Any]:
    """States and tangent vectors at `t_end` in 80-bit arithmetic, written to the file `request["out"]`."""
    x0, t_end = np.load(request["problem"]).astype(np.longdouble), np.longdouble(request["t_end"])
    start, tol = np.zeros(x0.shape[1], dtype=np.longdouble), np.longdouble(request["tol"])
    integrator = hy.taylor_adaptive(equations(request), start, tol=tol, fp_type=np.longdouble, compact_mode=True)
    found = np.empty_like(x0)
    for k, x in enumerate(x0):
        integrator.time = np.longdouble(0.0)
        integrator.state[:] = x
        integrator.propagate_until(t_end)
        found[k] = integrator.state
    np.save(request["out"], found)
    return {"order": integrator.order}


def run(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of the processor: of each repeat, and from the start of the process to the first result.

    With `out` in the request what is reached at `t_accuracy` is written there.
    """
    data, t_end = np.load(request["problem"]), request["t_end"]
    integrator, seconds = make(request), []
    starts = data if request["tangent"] else data[: problem.N_SINGLE, : data.shape[1] // 2]
    parts = [starts] if request["tangent"] else [starts[k : k + 1] for k in range(len(starts))]
    ends(integrator, parts[0], t_end)
    cold = time.process_time()
    for _ in range(request["repeats"]):
        begin = time.process_time()
        for part in parts:
            ends(integrator, part, t_end)
        seconds.append((time.process_time() - begin) / len(parts))
    if "out" in request:
        np.save(request["out"], ends(integrator, data[:, : len(integrator.state)], request["t_accuracy"]))
    return {"seconds": seconds, "cold": cold, "order": integrator.order}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each order: what is reached at `t_accuracy`, written to the file `request["out"]`.

    heyoka's order is ceil(1 - ln(tol) / 2) and nothing else depends on its tolerance; e^(3 - 2 n) lies in the middle of
    those of order n.
    """
    data, settings, found = np.load(request["problem"]), [], []
    for order in request["orders"]:
        tol = float(np.exp(3.0 - 2.0 * order))
        integrator = make(request | {"tol": tol})
        if integrator.order != order:
            raise RuntimeError(f"heyoka's rule has changed: order {integrator.order}, not {order}, for tol={tol}")
        found.append(ends(integrator, data[:, : len(integrator.state)], request["t_accuracy"]))
        settings.append({"request": {"tol": tol}, "order": order})
    np.save(request["out"], np.array(found))
    return {"settings": settings}


if __name__ == "__main__":
    asked: dict[str, Any] = json.loads(sys.argv[1])
    choose_disk_cache(asked)
    print(json.dumps({"run": run, "scan": scan, "reference": reference}[asked["task"]](asked)))
