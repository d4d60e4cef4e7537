"""liepoisson's side of `general.py`: the same systems as users type them, by the public call.

One request, one fresh process.
"""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np

import general_problems
import liepoisson as lp
import problem
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from problem import Array


def integrate(system: lp.System, starts: Array, request: dict[str, Any], t_end: float) -> lp.results.Orbit:
    """All starts in one call on one thread, each with its tangent vector if the request says so."""
    arguments = dict(request["method"])
    method = getattr(lp, arguments.pop("name"))(**arguments)
    n = starts.shape[1] // 2
    tangents = starts[:, None, n:] if request["tangent"] else None
    return lp.integrate(system, starts[:, :n], times=[0.0, t_end], tangents=tangents, method=method, threads=1)


def run(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of the processor: of each repeat, and from the start of the process to the first result."""
    data, t_end, seconds = np.load(request["problem"]), request["t_end"], []
    system = general_problems.PROBLEMS[request["system"]].typed(lp)
    starts = data if request["tangent"] else data[: problem.N_SINGLE]
    parts = [starts] if request["tangent"] else [starts[k : k + 1] for k in range(len(starts))]
    orbits = [integrate(system, parts[0], request, t_end)]
    cold = time.process_time()
    for _ in range(request["repeats"]):
        begin = time.process_time()
        orbits = [integrate(system, part, request, t_end) for part in parts]
        seconds.append((time.process_time() - begin) / len(parts))
    outcomes = np.concatenate([orbit.outcome for orbit in orbits])
    if not (outcomes == "finished").all():
        raise RuntimeError(f"trajectories did not finish: {np.unique(outcomes)}")
    kernel, field = orbits[-1].kernel, system.field().kind
    return {"seconds": seconds, "cold": cold, "order": orbits[-1].order, "kernel": kernel, "field": field}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each method: what is reached at `t_accuracy`, written to the file `request["out"]`.

    A setting that the package refuses is left out; an orbit that does not finish is NaN.
    """
    data, settings, found = np.load(request["problem"]), [], []
    system = general_problems.PROBLEMS[request["system"]].typed(lp)
    for method in request["methods"]:
        try:
            orbit = integrate(system, data, request | method, request["t_accuracy"])
        except ParameterError:
            continue
        found.append(np.concatenate([orbit.state[:, -1], *orbit.tangent[:, -1].transpose(1, 0, 2)], axis=1))
        settings.append({"request": method, "order": orbit.order})
    np.save(request["out"], np.array(found))
    return {"settings": settings}


if __name__ == "__main__":
    asked: dict[str, Any] = json.loads(sys.argv[1])
    print(json.dumps({"run": run, "scan": scan}[asked["task"]](asked)))
