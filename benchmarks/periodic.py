"""Periodic orbits against a loop of single shootings with SciPy's DOP853 (right-hand side by Numba) and `fsolve`.

`python benchmarks/periodic.py` (a minute; the peer's environment is made first).  Two tasks, both measured in turn on
one core, the least of three: 200 orbits of the Lyapunov family of a saddle, of which ours have their multipliers and
bifurcations, too; and 100 guesses on one level of Hénon and Heiles's potential, the nearest returns of 50 random
states, which SciPy is given and ours looks for.  SciPy does a tenth of each: seconds are of one orbit, or one guess.
"""

from __future__ import annotations

import json
import subprocess
import time
from typing import Any

import numpy as np

import environment
import liepoisson as lp
import measure

MEMBERS, STARTS, REPEATS, TENTH = 200, 50, 3, 10
SADDLE = lp.System(lp.canonical(2), "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10", name="saddle")
HENON = lp.catalog.system("henon-heiles")


def ours_family() -> lp.results.OrbitFamily:
    """The family from its first orbit, with so many members."""
    first = lp.orbits.periodic_orbit(SADDLE, [3.1, 0, 0, 0.4], period=6.3, energy="1.1")
    return lp.orbits.orbit_family(SADDLE, first, max_orbits=MEMBERS, longest_step=0.01, threads=1)


def ours_level() -> lp.results.PeriodicOrbits:
    """Orbits of a level from two guesses for each start."""
    return lp.orbits.periodic_orbits(HENON, {}, "1/8", n_starts=STARTS, threads=1)


def theirs(request: dict[str, Any]) -> dict[str, Any]:
    """The answer of the peer."""
    worker = [str(measure.PYTHON["scipy"]), str(measure.HERE / "periodic_worker.py"), json.dumps(request)]
    return json.loads(subprocess.run(worker, check=True, capture_output=True, text=True).stdout)


def section_guess(orbit: lp.results.PeriodicOrbit, surface: str, names: tuple[int, int]) -> list[float]:
    """Where an orbit crosses a section upwards, in two coordinates, and its period."""
    x = lp.section(orbit.system, orbit.start, surface=surface, direction=1, t_end=2 * orbit.period).state[0]
    return [*x[list(names)].tolist(), orbit.period]


def guesses() -> list[list[float]]:
    """The nearest returns of random states of the section x = 0: where they begin, and after what time."""
    leaf = lp.Leaf(HENON, {})
    starts = lp.sections.section_starts(leaf, "x", energy=0.125, n_starts=STARTS, seed=1, direction=1)
    found: list[tuple[float, list[float]]] = []
    for state in starts:
        run = lp.section(HENON, state, surface="x", direction=1, start_side=1, t_end=30)
        gaps = np.linalg.norm(run.state - state, axis=1)
        best = np.argsort(gaps)[:2]
        found += [(float(gaps[k]), [float(state[1]), float(state[3]), float(run.time[k])]) for k in best]
    return [guess for _, guess in found]


def main() -> None:
    """Both tasks in turn, as lines of a table."""
    environment.ensure_peers()
    environment.pin(None)
    ours_level()  # imports and compiled formulas are not measured
    family = ours_family()
    energies = family.value[: MEMBERS // TENTH]
    requests = (
        {"task": "family", "guess": section_guess(family[0], "q1 - pi", (1, 3)), "energies": energies.tolist()},
        {"task": "level", "guesses": guesses()[::TENTH], "energy": 0.125},
    )
    for name, call, request in zip(("family", "level"), (ours_family, ours_level), requests, strict=True):
        seconds: list[float] = []
        peer: list[dict[str, Any]] = []
        found: Any = ()
        for _ in range(REPEATS):
            begin = time.perf_counter()
            found = call()
            seconds.append(time.perf_counter() - begin)
            peer.append(theirs(request))
        best = min(peer, key=lambda one: one["seconds"])
        n = MEMBERS if name == "family" else 2 * STARTS
        ours, other = min(seconds) / n, best["seconds"] / (n // TENTH)
        residual = np.median([one.residual for one in found])
        print(
            f"{name}: ours {1e3 * ours:.2f} ms, residual {residual:.0e}; SciPy {1e3 * other:.1f} ms, residual "
            f"{best['residual']:.0e}, {best['found']} of {n // TENTH} closed; ratio {other / ours:.0f}"
        )


if __name__ == "__main__":
    main()
