"""SciPy's side of periodic orbits: single shooting with DOP853, a right-hand side compiled by Numba, and `fsolve`.

One request as JSON on the command line, one answer: seconds of the processor, and of each orbit its state and period.
The unknowns are two coordinates on a section and the period; the momentum across follows from the energy.  `fsolve`
has the exact Jacobian, from variational equations that are integrated with the orbit, or takes differences.  The next
guess of a family is that of the cubic polynomial in the energy through the last four orbits.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numba  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import fsolve

MOON = 0.0121505856
"""The mass of the Moon, that of both being 1."""
ORDER = 3
"""Of the polynomial through the last orbits of a family."""
FAR = 1e3
"""The gap where there is no state of the energy."""


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def henon(_t: float, z: Any) -> Any:
    """Hénon and Heiles, with any number of tangent vectors behind the state, as in the others."""
    out = np.empty(z.size)
    x, y = z[0], z[1]
    out[0], out[1], out[2], out[3] = z[2], z[3], -x - 2 * x * y, -y - x * x + y * y
    for k in range(4, z.size, 4):
        out[k], out[k + 1] = z[k + 2], z[k + 3]
        out[k + 2] = -(1 + 2 * y) * z[k] - 2 * x * z[k + 1]
        out[k + 3] = -2 * x * z[k] + (2 * y - 1) * z[k + 1]
    return out


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def saddle(_t: float, z: Any) -> Any:
    """p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10."""
    out = np.empty(z.size)
    s, c = np.sin(z[0]), np.cos(z[0])
    out[0], out[1], out[2], out[3] = z[2], z[3], -s - z[1] * c / 10, -z[1] - s / 10
    for k in range(4, z.size, 4):
        out[k], out[k + 1] = z[k + 2], z[k + 3]
        out[k + 2] = (-c + z[1] * s / 10) * z[k] - c / 10 * z[k + 1]
        out[k + 3] = -c / 10 * z[k] - z[k + 1]
    return out


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def moon(_t: float, z: Any) -> Any:
    """The restricted problem of three bodies, in positions and velocities."""
    out = np.empty(z.size)
    x, y = z[0], z[1]
    a, b = x + MOON, x - 1 + MOON
    r, s = a * a + y * y, b * b + y * y
    p, q = (1 - MOON) / (r * np.sqrt(r)), MOON / (s * np.sqrt(s))
    out[0], out[1] = z[2], z[3]
    out[2], out[3] = 2 * z[3] + x - p * a - q * b, -2 * z[2] + y - (p + q) * y
    if z.size > 4:
        xx = 1 - p - q + 3 * (p * a * a / r + q * b * b / s)
        yy = 1 - p - q + 3 * (p / r + q / s) * y * y
        xy = 3 * (p * a / r + q * b / s) * y
        for k in range(4, z.size, 4):
            out[k], out[k + 1] = z[k + 2], z[k + 3]
            out[k + 2] = 2 * z[k + 3] + xx * z[k] + xy * z[k + 1]
            out[k + 3] = -2 * z[k + 2] + xy * z[k] + yy * z[k + 1]
    return out


def henon_start(y: float, p: float, energy: float) -> Any:
    """The state on x = 0, p_x > 0, and its derivatives by y and p_y."""
    across = np.sqrt(2 * energy - p * p - y * y + 2 * y**3 / 3)
    return np.array([0, y, across, p]), np.array([[0, 0], [1, 0], [(y * y - y) / across, -p / across], [0, 1]])


def saddle_start(q: float, p: float, energy: float) -> Any:
    """The state on q2 = 0, p2 > 0."""
    across = np.sqrt(2 * (energy + np.cos(q)) - p * p)
    return np.array([q, 0, p, across]), np.array([[1, 0], [0, 0], [0, 1], [-np.sin(q) / across, -p / across]])


def moon_start(x: float, v: float, energy: float) -> Any:
    """The state on y = 0, v_y > 0."""
    a, b = x + MOON, x - 1 + MOON
    across = np.sqrt(2 * (energy + x * x / 2 + (1 - MOON) / abs(a) + MOON / abs(b)) - v * v)
    slope = x - (1 - MOON) * np.sign(a) / a**2 - MOON * np.sign(b) / b**2
    return np.array([x, 0, v, across]), np.array([[1, 0], [0, 0], [0, 1], [slope / across, -v / across]])


SYSTEMS = {
    "henon": (henon, henon_start, [1, 3, 0]),
    "saddle": (saddle, saddle_start, [0, 2, 1]),
    "moon": (moon, moon_start, [0, 2, 1]),
}
"""The field, the states of the section, and the components that close: the coordinates there and that across it."""


class Shooting:
    """Orbits of one system by one setting: `tol` of the integration, `xtol` of `fsolve`, with or without Jacobian."""

    def __init__(self, request: dict[str, Any]) -> None:
        self.field, self.start, self.rows = SYSTEMS[request["system"]]
        self.tol, self.xtol, self.exact = request["tol"], request["xtol"], request["exact"]
        self.n_integrations = 0
        for size in (4, 12):  # compiling is not counted
            self.field(0.0, np.full(size, 0.1))

    def end(self, start: Any, time: float) -> Any:
        """The end of an orbit, and of tangent vectors."""
        solver = DOP853(self.field, 0.0, start, time, rtol=self.tol, atol=self.tol)
        while solver.status == "running":
            solver.step()
        self.n_integrations += 1
        return solver.y if solver.status == "finished" else np.full(len(start), np.nan)

    @np.errstate(invalid="ignore")
    def orbit(self, guess: Any, energy: float) -> list[float]:
        """State and period of the orbit near a guess of the two coordinates and the period."""
        gaps: dict[bytes, Any] = {}
        slopes: dict[bytes, Any] = {}

        def gap(z: Any) -> Any:
            if (key := z.tobytes()) not in gaps:
                x, _ = self.start(z[0], z[1], energy)
                known = np.isfinite(x).all() and z[2] > 0
                gaps[key] = (self.end(x, z[2]) - x)[self.rows] if known else np.full(3, FAR)
            return gaps[key]

        def slope(z: Any) -> Any:
            if (key := z.tobytes()) not in slopes:
                x, directions = self.start(z[0], z[1], energy)
                end = self.end(np.concatenate([x, directions.T.ravel()]), z[2])
                gaps[key] = (end[:4] - x)[self.rows]
                across = end[4:].reshape(2, 4).T - directions
                slopes[key] = np.column_stack([across, self.field(0.0, end[:4])])[self.rows]
            return slopes[key]

        if self.exact:
            slope(guess)  # which gives the gap, too
        found = fsolve(gap, guess, fprime=slope if self.exact else None, xtol=self.xtol, maxfev=100, full_output=True)[
            0
        ]
        return [*self.start(found[0], found[1], energy)[0].tolist(), float(found[2])]

    def family(self, energies: list[float], guesses: list[Any]) -> list[list[float]]:
        """Orbits of these energies; the first of them have guesses."""
        unknowns: list[Any] = []
        orbits: list[list[float]] = []
        for k, energy in enumerate(energies):
            guess = np.array(guesses[k]) if k < len(guesses) else _extrapolated(energies[:k], unknowns, energy)
            orbits.append(self.orbit(guess, energy))
            unknowns.append(np.array(orbits[-1])[[*self.rows[:2], 4]])
        return orbits


def _extrapolated(energies: list[float], known: list[Any], energy: float) -> Any:
    """The polynomial through the last orbits."""
    some, found = energies[-1 - ORDER :], known[-1 - ORDER :]
    weights = [np.prod([(energy - b) / (a - b) for b in some if b != a]) for a in some]
    return sum(weight * one for weight, one in zip(weights, found, strict=True))


def main() -> None:
    """Answer the request."""
    request = json.loads(sys.argv[1])
    shooting = Shooting(request)
    begin = time.process_time()
    if request["task"] == "family":
        orbits = shooting.family(request["energies"], request["guesses"])
    else:
        orbits = [shooting.orbit(np.array(guess), request["energies"][0]) for guess in request["guesses"]]
    seconds = time.process_time() - begin
    print(json.dumps({"seconds": seconds, "orbits": orbits, "n_integrations": shooting.n_integrations}))


if __name__ == "__main__":
    main()
