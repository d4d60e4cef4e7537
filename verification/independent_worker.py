"""heyoka's side of `independent.py`: exponents of given starts and tangent vectors.  Needs numpy and heyoka only.

    python independent_worker.py '{"problem": "problem.npy", "out": "exponent.npy", "top": {...}, ...}'

The equations of state and tangent vector are written out here once more, from the vector equations
l' = l x omega + alpha x a + beta x b, alpha' = alpha x omega + epsilon beta x a, beta' = beta x omega.
"""

from __future__ import annotations

import json
import math
import sys
from typing import Any

import heyoka as hy  # pyright: ignore[reportMissingImports]  # lives in the peer's environment only
import numpy as np

Expressions = list[Any]

RENORMALISE = 25.0
"""Time after which tangent vectors are made unit vectors again: they grow by some e^4 until then, and the step of the
integrator is chosen by the largest component of states and tangent vectors together."""


def _cross(u: Expressions, v: Expressions) -> Expressions:
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def _sum(*vectors: Expressions) -> Expressions:
    return [sum(terms[1:], terms[0]) for terms in zip(*vectors, strict=True)]


def equations(top: dict[str, Any]) -> list[tuple[Any, Any]]:
    """The 18 equations of a state and a tangent vector."""
    names = [f"{name}{i}" for name in ("l", "alpha", "beta") for i in "123"]
    variables: Expressions = list(hy.make_vars(*names, *(f"d{name}" for name in names)))
    l, alpha, beta, dl, dalpha, dbeta = (variables[k : k + 3] for k in range(0, 18, 3))
    a, b = list(top["a"]), list(top["b"])
    twist = [top["epsilon"] * c for c in a]
    omega = [x / moment for x, moment in zip(l, top["inertia"], strict=True)]
    domega = [x / moment for x, moment in zip(dl, top["inertia"], strict=True)]
    rates = _sum(_cross(l, omega), _cross(alpha, a), _cross(beta, b))
    rates += _sum(_cross(alpha, omega), _cross(beta, twist)) + _cross(beta, omega)
    rates += _sum(_cross(dl, omega), _cross(l, domega), _cross(dalpha, a), _cross(dbeta, b))
    rates += _sum(_cross(dalpha, omega), _cross(alpha, domega), _cross(dbeta, twist))
    rates += _sum(_cross(dbeta, omega), _cross(beta, domega))
    return list(zip(variables, rates, strict=True))


def exponents(request: dict[str, Any]) -> Any:
    """Growth of the tangent vectors over the window, per unit of time, shape (n,)."""
    begin, end = request["window"]
    data = np.load(request["problem"])
    batch = hy.recommended_simd_size()
    padded = np.concatenate([data, np.repeat(data[-1:], -len(data) % batch, axis=0)])
    integrator = hy.taylor_adaptive_batch(equations(request["top"]), np.zeros((18, batch)), tol=request["tol"])
    found = np.empty(len(padded))
    stops = [RENORMALISE * k for k in range(1, math.ceil(end / RENORMALISE)) if RENORMALISE * k != begin]
    for k in range(0, len(padded), batch):
        integrator.set_time(0.0)
        integrator.state[:] = padded[k : k + batch].T
        growth = np.zeros(batch)
        for stop in sorted([*stops, begin, end]):
            integrator.propagate_until(stop)
            length = np.linalg.norm(integrator.state[9:], axis=0)
            growth += np.log(length)
            integrator.state[9:] /= length
            if stop == begin:
                growth[:] = 0.0
        found[k : k + batch] = growth / (end - begin)
    if not np.isfinite(found).all():
        raise RuntimeError("heyoka did not finish")
    return found[: len(data)]


def main() -> None:
    """Answer the request on the command line."""
    request: dict[str, Any] = json.loads(sys.argv[1])
    if "problem" in request:
        np.save(request["out"], exponents(request))
    print(json.dumps({"version": hy.__version__}))


if __name__ == "__main__":
    main()
