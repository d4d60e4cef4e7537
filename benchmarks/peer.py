"""What the other tools have in common: one request, one fresh process, one answer; like heyoka_worker.py.

Each tool's worker says how it integrates the 18 equations of state and tangent vector at a tolerance; the rest is here.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from problem import Array

Flow = Callable[["Array", float], "Array"]
"""States and tangent vectors at a time, shape (n, 18), from those at time 0; NaN where an integration failed."""

T_WARM_UP = 0.5


def one_by_one(flow_of_one: Callable[[Array, float], Array]) -> Flow:
    """The flow of many from that of one."""

    def flow(x0: Array, t_end: float) -> Array:
        return np.array([flow_of_one(x, t_end) for x in x0])

    return flow


def serve(package: str, prepare: Callable[[float], Flow]) -> None:
    """Answer the request on the command line; `prepare` makes the flow at a tolerance.

    Task "scan": ends at `t_end` for each tolerance, added one by one to the file `request["out"]`.  Task "ensemble":
    seconds of each repeat; compiling, which the first call does, is not counted.
    """
    request: dict[str, Any] = json.loads(sys.argv[1])
    data, t_end = np.load(request["problem"])[: request["members"]], request["t_end"]
    if request["task"] == "scan":
        with open(request["out"], "wb") as out:
            for tol in request["tols"]:
                np.save(out, prepare(tol)(data, t_end))
                out.flush()
        print(json.dumps({}))
        return
    flow, seconds = prepare(request["tol"]), []
    flow(data, T_WARM_UP)
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        ends = flow(data, t_end)
        seconds.append(time.perf_counter() - begin)
        if not np.isfinite(ends).all():
            raise RuntimeError(f"{package} did not finish at tol = {request['tol']}")
    print(json.dumps({"seconds": seconds, "version": version(package)}))
