"""heyoka's side: how fast and how accurate is heyoka.py at its best?  One request, one fresh process, one answer.

    python heyoka_worker.py '{"task": "ensemble", "problem": "problem.npy", "tol": 1e-12, ...}'

The answer is one line of JSON.  Chosen by measurement, each the fastest of what was tried: an explicit system of
9 state and 9 tangent components (not the 90 of a full variational system); its equations with the products merged that
a diagonal inertia lets merge, 10 to 25% faster than cross products written out; batches rather than scalars; one
`propagate_until` per batch, without renormalisation.
"""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import heyoka as hy  # pyright: ignore[reportMissingImports]  # lives in the peer's environment only
import numpy as np

import problem

if TYPE_CHECKING:
    from problem import Array

    Expressions = list[Any]

PAIRS = ((1, 2), (2, 0), (0, 1))


def _cross(u: Expressions, c: tuple[float, ...]) -> Expressions:
    """u x c for a constant vector c; terms with a zero vanish when heyoka simplifies."""
    return [u[i] * c[j] - u[j] * c[i] for i, j in PAIRS]


def _sum(*vectors: Expressions) -> Expressions:
    return [sum(terms[1:], terms[0]) for terms in zip(*vectors, strict=True)]


def top_system(tangent: bool) -> list[tuple[Any, Any]]:
    """Equations of the top, 9 of them, or 18 with those of one tangent vector.

    (u x omega)_i = u_j l_k / I_k - u_k l_j / I_j with each product l u formed once; for u = l the two products are one.
    """
    names = [f"{name}{i}" for name in ("l", "alpha", "beta") for i in "123"]
    variables: Expressions = list(hy.make_vars(*names, *(f"d{name}" for name in names)))
    l, alpha, beta, dl, dalpha, dbeta = (variables[k : k + 3] for k in range(0, 18, 3))
    w = [1.0 / moment for moment in problem.INERTIA]
    twist = tuple(problem.EPSILON * c for c in problem.A)

    def spun(u: Expressions) -> Expressions:
        return [w[j] * (u[i] * l[j]) - w[i] * (u[j] * l[i]) for i, j in PAIRS]

    def d_spun(u: Expressions, du: Expressions) -> Expressions:
        return [w[j] * (du[i] * l[j] + u[i] * dl[j]) - w[i] * (du[j] * l[i] + u[j] * dl[i]) for i, j in PAIRS]

    rates = _sum([(w[j] - w[i]) * (l[i] * l[j]) for i, j in PAIRS], _cross(alpha, problem.A), _cross(beta, problem.B))
    rates += _sum(spun(alpha), _cross(beta, twist)) + spun(beta)
    if not tangent:
        return list(zip(variables[:9], rates, strict=True))
    d_l = [(w[j] - w[i]) * (dl[i] * l[j] + l[i] * dl[j]) for i, j in PAIRS]
    rates += _sum(d_l, _cross(dalpha, problem.A), _cross(dbeta, problem.B))
    rates += _sum(d_spun(alpha, dalpha), _cross(dbeta, twist)) + d_spun(beta, dbeta)
    return list(zip(variables, rates, strict=True))


def make_ensemble(request: dict[str, Any]) -> Any:
    """The batch integrator of state and tangent vector; heyoka's default flags unless the request has some."""
    flags: dict[str, Any] = request.get("flags", {})
    number = np.float32 if request.get("precision") == "single" else np.float64
    start = np.zeros((18, request["batch"]), dtype=number)
    return hy.taylor_adaptive_batch(
        top_system(tangent=True), start, tol=number(request["tol"]), fp_type=number, **flags
    )


def run_ensemble(integrator: Any, x0: Array, t_end: float) -> Array:
    """States and tangent vectors at `t_end`, shape (n, 18), from those at time 0."""
    batch: int = integrator.batch_size
    number = integrator.state.dtype.type
    ends = np.empty_like(x0)
    for k in range(0, len(x0), batch):
        integrator.set_time(number(0.0))
        integrator.state[:] = x0[k : k + batch].T
        integrator.propagate_until(number(t_end))
        ends[k : k + batch] = integrator.state.T
    return ends


def run_single(integrator: Any, x0: Array, t_end: float) -> Array:
    """Final state, shape (9,), of one trajectory."""
    integrator.time = 0.0
    integrator.state[:] = x0
    integrator.propagate_until(t_end)
    return np.array(integrator.state)


def _exponents(ends: Array, t_end: float) -> Array:
    return np.log(np.linalg.norm(ends[..., 9:], axis=-1)) / t_end


def ensemble(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of the ensemble run; compiling is not counted."""
    x0, t_end = np.load(request["problem"]), request["t_end"]
    integrator, seconds, exponents = make_ensemble(request), [], np.empty(len(x0))
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        exponents = _exponents(run_ensemble(integrator, x0, t_end), t_end)
        seconds.append(time.perf_counter() - begin)
    return {"seconds": seconds, "order": integrator.order, "mean_exponent": float(exponents.mean())}


def single(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds per trajectory of each repeat, each averaged over the first starts; and where they end."""
    x0, t_end = np.load(request["problem"])[: problem.N_SINGLE, :9], request["t_end"]
    integrator = hy.taylor_adaptive(top_system(tangent=False), np.zeros(9), tol=request["tol"])
    seconds, ends = [], np.empty_like(x0)
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        ends = np.array([run_single(integrator, x, t_end) for x in x0])
        seconds.append((time.perf_counter() - begin) / len(x0))
    return {"seconds": seconds, "order": integrator.order, "drift": problem.drift(x0, ends)}


def dense(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of evaluating a kept orbit at many times."""
    integrator, x, times = _one_orbit(request)
    output = _run_kept(integrator, x, request["t_end"])
    return {"seconds": problem.timed(lambda: output(times), request["repeats"]), "order": integrator.order}


def _one_orbit(request: dict[str, Any]) -> tuple[Any, Array, Array]:
    x = np.load(request["problem"])[0, :9]
    integrator = hy.taylor_adaptive(top_system(tangent=False), np.zeros(9), tol=request["tol"])
    return integrator, x, np.linspace(0.0, request["t_end"], request["n_times"])


def _run_kept(integrator: Any, x: Array, t_end: float) -> Any:
    integrator.time, integrator.state[:] = 0.0, x
    return integrator.propagate_until(t_end, c_output=True)[4]


def grid(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of an orbit with its states at many times."""
    integrator, x, times = _one_orbit(request)

    def run() -> None:
        integrator.time, integrator.state[:] = 0.0, x
        integrator.propagate_grid(times)

    return {"seconds": problem.timed(run, request["repeats"]), "order": integrator.order}


def section(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat of finding all crossings of l3 = 0, by events in batches."""
    x0, batch, equations = np.load(request["problem"])[: request["n_starts"], :9], request["batch"], top_system(False)
    found: list[float] = []
    event = hy.nt_event_batch(equations[2][0], lambda ta, t, d, i: found.append(t))
    integrator = hy.taylor_adaptive_batch(equations, np.zeros((9, batch)), tol=request["tol"], nt_events=[event])

    def run() -> None:
        found.clear()
        for k in range(0, len(x0), batch):
            integrator.set_time(0.0)
            integrator.state[:] = x0[k : k + batch].T
            integrator.propagate_until(request["t_end"])

    return {"seconds": problem.timed(run, request["repeats"]), "order": integrator.order, "crossings": len(found)}


def cold(request: dict[str, Any]) -> dict[str, Any]:
    """One ensemble result as soon as possible; the clock is the caller's."""
    x0, t_end = np.load(request["problem"]), request["t_end"]
    return {"mean_exponent": float(_exponents(run_ensemble(make_ensemble(request), x0, t_end), t_end).mean())}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each order: states, tangent vectors and exponents at `t_end`, written to the file `request["out"]`.

    heyoka's order is ceil(1 - ln(tol) / 2) and nothing else depends on its tolerance, so one tolerance per order is a
    scan of all tolerances; e^(3 - 2 n) lies in the middle of those of order n.
    """
    x0, t_end = np.load(request["problem"]), request["t_end"]
    settings: list[dict[str, Any]] = []
    ends: list[Array] = []
    for order in request["orders"]:
        tol = float(np.exp(3.0 - 2.0 * order))
        if request["single"]:
            integrator: Any = hy.taylor_adaptive(top_system(tangent=False), np.zeros(9), tol=tol)
            ends.append(np.array([run_single(integrator, x, t_end) for x in x0[:, :9]]))
        else:
            integrator = make_ensemble(request | {"tol": tol})
            ends.append(run_ensemble(integrator, x0, t_end))
        if integrator.order != order:
            raise RuntimeError(f"heyoka's rule has changed: order {integrator.order}, not {order}, for tol={tol}")
        settings.append({"request": {"tol": tol}, "order": order})
    end = np.array(ends)
    np.savez(request["out"], state=end[..., :9], tangent=end[..., 9:], exponent=_exponents(end, t_end))
    return {"settings": settings}


def versions(_: dict[str, Any]) -> dict[str, Any]:
    """What this side is made of."""
    return {"heyoka": hy.__version__, "numpy": np.__version__, "recommended_batch": hy.recommended_simd_size()}


def choose_disk_cache(request: dict[str, Any]) -> None:
    """heyoka's cache of compiled code only where it is asked for: it hides the compiling that a first run has to do."""
    hy.llvm_state.set_diskcache_enabled("diskcache" in request)
    if "diskcache" in request:
        hy.llvm_state.set_diskcache_path(request["diskcache"])


def main() -> None:
    """Answer the request on the command line."""
    request: dict[str, Any] = json.loads(sys.argv[1])
    choose_disk_cache(request)
    tasks = (ensemble, single, dense, grid, section, cold, scan, versions)
    print(json.dumps({task.__name__: task for task in tasks}[request["task"]](request)))


if __name__ == "__main__":
    main()
