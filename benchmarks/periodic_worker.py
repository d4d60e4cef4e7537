"""SciPy's side of periodic orbits: single shooting with DOP853, a right-hand side compiled by Numba, and `fsolve`.

One request as JSON on the command line, one answer: `{"seconds", "residual", "found"}`.  The unknowns are the two
coordinates on a section and the period, as one would write it; the momentum across follows from the energy.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numba  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

TOL, XTOL = 1e-13, 1e-13


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def saddle(_t: float, z: Any) -> Any:
    """p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10."""
    return np.array([z[2], z[3], -np.sin(z[0]) - z[1] * np.cos(z[0]) / 10, -z[1] - np.sin(z[0]) / 10])


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def henon(_t: float, z: Any) -> Any:
    """Hénon and Heiles."""
    return np.array([z[2], z[3], -z[0] - 2 * z[0] * z[1], -z[1] - z[0] * z[0] + z[1] * z[1]])


def saddle_state(y: float, p: float, energy: float) -> Any:
    """On q1 = pi, where p1 > 0."""
    return np.array([np.pi, y, np.sqrt(max(2 * (energy - 1) - p * p - y * y, 0.0)), p])


def henon_state(y: float, p: float, energy: float) -> Any:
    """On x = 0, where p_x > 0."""
    return np.array([0.0, y, np.sqrt(max(2 * energy - p * p - y * y + 2 * y**3 / 3, 0.0)), p])


def closed(field: Any, state: Any, guess: Any, energy: float) -> tuple[Any, float]:
    """The unknowns that fsolve finds, and how far the orbit is from closing."""

    def gap(z: Any) -> Any:
        start = state(z[0], z[1], energy)
        end = solve_ivp(field, (0.0, z[2]), start, method="DOP853", rtol=TOL, atol=TOL, t_eval=[z[2]]).y[:, -1]
        return (end - start)[[0, 1, 3]]

    found = fsolve(gap, guess, xtol=XTOL)
    return found, float(np.abs(gap(found)).max())


def main() -> None:
    """Answer the request."""
    request = json.loads(sys.argv[1])
    field, state = (saddle, saddle_state) if request["task"] == "family" else (henon, henon_state)
    field(0.0, np.zeros(4))  # compiling is not counted
    residuals: list[float] = []
    begin = time.perf_counter()
    if request["task"] == "family":  # the next guess on the line through the last two
        known = [np.array(request["guess"])]
        for energy in request["energies"]:
            guess = 2 * known[-1] - known[-2] if len(known) > 2 else known[-1]
            found, residual = closed(field, state, guess, energy)
            known.append(found)
            residuals.append(residual)
    else:
        residuals = [closed(field, state, np.array(guess), request["energy"])[1] for guess in request["guesses"]]
    seconds = time.perf_counter() - begin
    good = [one for one in residuals if one < 1e-9]
    print(json.dumps({"seconds": seconds, "residual": float(np.median(good)), "found": len(good)}))


if __name__ == "__main__":
    main()
