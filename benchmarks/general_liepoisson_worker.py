"""liepoisson's side of `general.py`: the same systems, as a quadratic field or as a tape, by the public calls."""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np

import general_problems
import liepoisson as lp
from general_problems import Problem

if TYPE_CHECKING:
    from liepoisson.compile.field import QuadraticField, TapeField
    from problem import Array


def field_of(one: Problem) -> QuadraticField | TapeField:
    """The field that the exact wing lowers the equations to."""
    import sympy

    from liepoisson.compile.lowering import quadratic_of_equations, tape_of_equations

    x = sympy.symbols(f"x0:{one.n}")
    rates = [sympy.sympify(rate) for rate in one.rates(list(x), sympy)]
    return quadratic_of_equations(x, rates) if one.quadratic else tape_of_equations(x, rates)


def run(field: QuadraticField | TapeField, data: Array, t_end: float, tol: float) -> lp.results.FiniteTimeExponents:
    """State and tangent vector of every start, on one thread."""
    n = data.shape[1] // 2
    growth = lp.finite_time_exponents(
        field, data[:, :n], tangents=data[:, n:], times=[t_end], method=lp.Taylor(tol=tol), threads=1
    )
    if not (growth.outcome == "finished").all():
        raise RuntimeError(f"trajectories did not finish: {np.unique(growth.outcome)}")
    return growth


def ensemble(request: dict[str, Any]) -> dict[str, Any]:
    """Seconds of each repeat."""
    one = general_problems.PROBLEMS[request["system"]]
    data, field, seconds = np.load(request["problem"]), field_of(one), []
    growth = run(field, data[:8], request["t_end"], request["tol"])
    for _ in range(request["repeats"]):
        begin = time.perf_counter()
        growth = run(field, data, request["t_end"], request["tol"])
        seconds.append(time.perf_counter() - begin)
    return {"seconds": seconds, "order": growth.order, "kernel": growth.kernel}


def scan(request: dict[str, Any]) -> dict[str, Any]:
    """For each tolerance: states and tangent vectors at `t_end`, written to the file `request["out"]`."""
    one = general_problems.PROBLEMS[request["system"]]
    data, field = np.load(request["problem"]), field_of(one)
    settings, ends = [], []
    for tol in request["tols"]:
        orbit = lp.integrate(
            field,
            data[:, : one.n],
            tangents=data[:, None, one.n :],
            times=[0.0, request["t_end"]],
            method=lp.Taylor(tol=tol),
            threads=1,
        )
        ends.append(np.concatenate([orbit.state[:, -1], orbit.tangent[:, -1, 0]], axis=1))
        settings.append({"request": {"tol": tol}, "order": orbit.order})
    np.save(request["out"], np.array(ends))
    return {"settings": settings}


def cold(request: dict[str, Any]) -> dict[str, Any]:
    """One ensemble result as soon as possible, from a field given as plain data; the clock is the caller's."""
    from liepoisson.compile.field import QuadraticField

    field = QuadraticField(**json.loads(request["field"]))
    growth = run(field, np.load(request["problem"]), request["t_end"], request["tol"])
    return {"mean_exponent": float(growth.exponent[:, -1].mean()), "kernel": growth.kernel}


def cold_text(request: dict[str, Any]) -> dict[str, Any]:
    """The same from the text of the Hamiltonian, which takes the exact wing; a general quadratic field in the end."""
    from liepoisson.compile.lowering import lower

    system = lp.System(lp.so(3) @ lp.leibniz(3, 1), "l1^2/4 + l2^2/4 + l3^2/2 - alpha1")
    field = lower(system.bracket, system.hamiltonian)
    growth = run(field, np.load(request["problem"]), request["t_end"], request["tol"])
    return {"mean_exponent": float(growth.exponent[:, -1].mean()), "kernel": growth.kernel}


if __name__ == "__main__":
    asked: dict[str, Any] = json.loads(sys.argv[1])
    print(json.dumps({"ensemble": ensemble, "scan": scan, "cold": cold, "cold_text": cold_text}[asked["task"]](asked)))
