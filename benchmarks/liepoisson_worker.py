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
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from problem import Array


def _top() -> lp.Top:
    return lp.Top(inertia=problem.INERTIA, a=problem.A, b=problem.B, epsilon=problem.EPSILON)


def _method(request: dict[str, Any]) -> Any:
    """The method that the request names, with its arguments."""
    arguments = dict(request["method"])
    return getattr(lp, arguments.pop("name"))(**arguments)


def run_ensemble(x0: Array, t_end: float, method: Any) -> lp.results.FiniteTimeExponents:
    """The exponent of every start at one time, on one thread, as heyoka's side computes it."""
    return lp.finite_time_exponents(_top(), x0, times=[t_end], seed=problem.SEED, method=method, threads=1)


def run_single(top: lp.Top, x0: Array, t_end: float, method: Any) -> lp.results.Orbit:
    """One trajectory, state only."""
    return lp.integrate(top, x0, times=[0.0, t_end], method=method, threads=1)


def _require_finished(result: lp.results.FiniteTimeExponents | lp.results.Orbit) -> None:
    if not (result.outcome == "finished").all():
        raise RuntimeError(f"trajectories did not finish: {np.unique(result.outcome)}")


def ensemble(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of the ensemble run, and the steps that all trajectories took in one."""
    x0, t_end, method = np.load(request["problem"])[:, :9], request["t_end"], _method(request)
    growth, seconds = run_ensemble(x0, problem.T_ACCURACY, method), []
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        growth = run_ensemble(x0, t_end, method)
        seconds.append(time.perf_counter() - begin)
    _require_finished(growth)
    return {
        "seconds": seconds,
        "order": growth.order,
        "kernel": growth.kernel,
        "mean_exponent": float(growth.exponent[:, -1].mean()),
        "n_steps": int(growth.n_steps.sum()),
    }


def single(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds per trajectory of each repeat, each averaged over the first starts; and where they end."""
    x0, t_end, top = np.load(request["problem"])[: problem.N_SINGLE, :9], request["t_end"], _top()
    method = _method(request)
    orbit, seconds = run_single(top, x0[0], problem.T_ACCURACY, method), []
    ends = np.empty_like(x0)
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        for k, x in enumerate(x0):
            orbit = run_single(top, x, t_end, method)
            ends[k] = orbit.state[0, -1]
        seconds.append((time.perf_counter() - begin) / len(x0))
    _require_finished(orbit)
    return {"seconds": seconds, "order": orbit.order, "kernel": orbit.kernel, "drift": problem.drift(x0, ends)}


def dense(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of evaluating a kept orbit at many times."""
    x, times = np.load(request["problem"])[0, :9], np.linspace(0.0, request["t_end"], request["n_times"])
    method = lp.Taylor(tol=request["tol"])
    orbit = lp.integrate(_top(), x, times=[0.0, request["t_end"]], method=method, dense=True, threads=1)
    _require_finished(orbit)
    return {
        "seconds": problem.timed(lambda: orbit.at(times), request["repeats"]),
        "order": orbit.order,
        "kernel": orbit.kernel,
    }


def grid(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of an orbit with its states at many times."""
    x, times = np.load(request["problem"])[0, :9], np.linspace(0.0, request["t_end"], request["n_times"])
    top, method = _top(), lp.Taylor(tol=request["tol"])
    orbit = lp.integrate(top, x, times=times, method=method, threads=1)
    _require_finished(orbit)
    seconds = problem.timed(lambda: lp.integrate(top, x, times=times, method=method, threads=1), request["repeats"])
    return {"seconds": seconds, "order": orbit.order, "kernel": orbit.kernel}


def section(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of finding all crossings of l3 = 0."""
    x0, top = np.load(request["problem"])[: request["n_starts"], :9], _top()
    method = lp.Taylor(tol=request["tol"])

    def run() -> Any:
        return lp.section(top, x0, surface="l3", t_end=request["t_end"], method=method, threads=1)

    found = run()
    seconds = problem.timed(run, request["repeats"])
    return {"seconds": seconds, "order": found.order, "kernel": found.kernel, "crossings": len(found.time)}


def sweep(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of a sweep through twists, one orbit at each."""
    from liepoisson.sweeps.spec import Axis, SweepSpec

    axis = Axis.linear("epsilon", 0, 1, request["n_starts"])
    parameters = {"I": problem.INERTIA, "a": problem.A, "b": problem.B}
    method = lp.Taylor(tol=request["tol"], precision="mixed")
    spec = SweepSpec(
        system="twisted-top",
        parameters=parameters,
        axes=(axis,),
        n_starts=1,
        t_end=request["t_end"],
        seed=problem.SEED,
        method=method,
    )
    return {"seconds": problem.timed(lambda: lp.sweep(spec, threads=1), request["repeats"])}


def full(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of as many orbits of one top."""
    x0 = np.load(request["problem"])[: request["n_starts"], :9]
    method = lp.Taylor(tol=request["tol"], precision="mixed")
    return {"seconds": problem.timed(lambda: run_ensemble(x0, request["t_end"], method), request["repeats"])}


def cold(request: dict[str, Any]) -> dict[str, Any]:
    """One ensemble result as soon as possible; the clock is the caller's."""
    x0, t_end = np.load(request["problem"])[:, :9], request["t_end"]
    growth = run_ensemble(x0, t_end, _method(request))
    _require_finished(growth)
    return {"mean_exponent": float(growth.exponent[:, -1].mean()), "kernel": growth.kernel}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each method: states, tangent vectors and exponents at `t_end`, written to the file `request["out"]`.

    A setting that the package refuses is left out; one whose trajectories do not finish has NaN for errors.
    """
    data, t_end = np.load(request["problem"]), request["t_end"]
    settings: list[dict[str, Any]] = []
    found: dict[str, list[Array]] = {"state": [], "tangent": [], "exponent": []}
    for one in request["methods"]:
        reach = _ends_of_single if request["single"] else _ends_of_ensemble
        try:
            order, ends = reach(data, t_end, _method(one))
        except ParameterError:
            continue
        for name, values in ends.items():
            found[name].append(values)
        settings.append({"request": one, "order": order})
    state, tangent, exponent = (np.array(found[name]) for name in ("state", "tangent", "exponent"))
    np.savez(request["out"], state=state, tangent=tangent, exponent=exponent)
    return {"settings": settings}


def _ends_of_single(data: Array, t_end: float, method: Any) -> tuple[int, dict[str, Array]]:
    orbits = [run_single(_top(), x, t_end, method) for x in data[:, :9]]
    return orbits[0].order, {"state": np.array([orbit.state[0, -1] for orbit in orbits])}


def _ends_of_ensemble(data: Array, t_end: float, method: Any) -> tuple[int, dict[str, Array]]:
    """Where the ensemble ends.

    Exponents and states come from the very call that is timed; the tangent vectors, which that call does not return,
    from `integrate`, which must arrive at the same states.
    """
    growth = run_ensemble(data[:, :9], t_end, method)
    orbit = lp.integrate(_top(), data[:, :9], times=[0.0, t_end], tangents=data[:, None, 9:], method=method, threads=1)
    finished = growth.outcome == "finished"
    # either call may rescale tangent vectors at other times; in single precision that can change last bits of a step
    if not np.allclose(orbit.state[finished, -1], growth.end_state[finished], rtol=0.0, atol=1e-4):
        raise RuntimeError(f"integrate and finite_time_exponents arrive at different states with {method}")
    state = np.where(finished[:, None], growth.end_state, np.nan)
    return growth.order, {"state": state, "tangent": orbit.tangent[:, -1, 0], "exponent": growth.exponent[:, -1]}


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
    tasks = (ensemble, single, dense, grid, section, sweep, full, cold, scan, versions)
    print(json.dumps({task.__name__: task for task in tasks}[request["task"]](request)))


if __name__ == "__main__":
    main()
