"""Periodic orbits against a loop of single shootings with SciPy's DOP853 (right-hand side by Numba) and `fsolve`.

`python benchmarks/periodic.py [ROW ...]`.  Families of 200 orbits, followed in the energy: SciPy gets the energies of
ours and their first two orbits to four digits, and ours have their bifurcations, too.  And 100 guesses of four digits
on one level, the same for both sides, which liepoisson improves together, with all multipliers.

Both sides are judged by one measure: the gap of an orbit after its period, by an integration to round-off from its
start, relative to the start.  SciPy runs with the quickest of its settings by which as many orbits close as ours:
tolerances of the integration and of `fsolve`, with the Jacobian of the variational equations or with differences.
Closed is what closes to 1e-12, and to 1e-11 and 1e-10 in the rows where neighbours grow some thousand times in a
period, of which single shooting loses the digits.  Times are those of the processor, without compiling and imports,
medians, on one core, by turns.  Results: benchmarks/results/.
"""

from __future__ import annotations

import argparse
import itertools
import json
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

import environment
import measure

MEMBERS, ROUNDS = 200, 5
GUESSES, CROSSINGS = 100, 5
"""So many guesses on one level, of each orbit at most so many crossings of the section."""
SAME = 1e-8
"""Periods of the same orbit differ by less, relative."""
TOLERANCES = (1e-11, 1e-12, 1e-13, 3e-14)
STEPS = (1e-8, 1e-10, 1e-12)
ENERGY = "4/25"
MOON = "0.0121505856"
"""That of `periodic_worker.py`."""


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes:
        title: What the table calls it.
        system: What the worker calls the system.
        surface: The section on which its unknowns are, crossed upwards.
        ours: Computes our orbits.
        request: What the worker is asked, from our orbits.
        level: The largest residual of an orbit that is closed.
    """

    title: str
    system: str
    surface: str
    ours: Callable[[], Sequence[Any]]
    request: Callable[[Row, Sequence[Any]], dict[str, Any]]
    level: float = 1e-12


@cache
def system_of(name: str) -> Any:
    """The system as liepoisson has it."""
    import liepoisson as lp

    if name == "henon":
        return lp.catalog.system("henon-heiles")
    plane = lp.canonical(2)
    if name == "saddle":
        return lp.System(plane, "p1^2/2 - cos(q1) + (p2^2 + q2^2)/2 + q2*sin(q1)/10", name="saddle")
    hamiltonian = "(p1^2 + p2^2)/2 + q2*p1 - q1*p2 - (1 - m)/sqrt((q1 + m)^2 + q2^2) - m/sqrt((q1 - 1 + m)^2 + q2^2)"
    return lp.System(plane, hamiltonian, {"m": MOON}, name="three bodies")


@cache
def first_of(name: str) -> Any:
    """The first orbit of a family."""
    import liepoisson as lp

    system = system_of(name)
    if name == "saddle":
        return lp.orbits.periodic_orbit(system, [3.1, 0, 0, 0.4], period=6.3, energy="1.1")
    if name == "henon":
        curved = lp.orbits.periodic_orbits(system, {}, "1/8", n_starts=50)[0]
        return lp.orbits.orbit_family(system, curved, until=0.05, longest_step=0.05)[-1]
    point = lp.phase_space.equilibrium_near(system, [0.8369, 0, 0, 0.8369])
    return lp.orbits.orbit_family(system, point, until=-1.59)[-1]


def family(name: str, step: float) -> Callable[[], Sequence[Any]]:
    """A family of so many orbits, with steps of one length."""

    def ours() -> Sequence[Any]:
        import liepoisson as lp

        return lp.orbits.orbit_family(
            system_of(name), first_of(name), max_orbits=MEMBERS, longest_step=step, threads=1
        ).found

    return ours


@cache
def guesses() -> tuple[Any, Any]:
    """States of the section and periods, of four digits, near orbits of one level."""
    import liepoisson as lp

    system, energy = system_of("henon"), 0.16
    states, periods = list[Any](), list[float]()
    for orbit in lp.orbits.periodic_orbits(system, {}, ENERGY, n_starts=600, t_end=40):
        crossed = lp.section(system, orbit.start, surface="x", direction=1, t_end=1.01 * orbit.period).state
        for x in crossed[:CROSSINGS]:
            y, p = (float(f"{v:.4g}") for v in x[[1, 3]])
            states.append([0.0, y, np.sqrt(2 * energy - p * p - y * y + 2 * y**3 / 3), p])
            periods.append(float(f"{orbit.period:.4g}"))
    return np.array(states[:GUESSES]), np.array(periods[:GUESSES])


def level() -> Sequence[Any]:
    """The orbits of one level that all guesses lead to; none where Newton's method does not converge."""
    import liepoisson as lp

    states, periods = guesses()
    found = lp.orbits.periodic_orbits(system_of("henon"), {}, ENERGY, guesses=states, periods=periods, threads=1)
    none = SimpleNamespace(start=np.full(4, np.nan), period=np.nan)
    return [none if k < 0 else found[k] for k in found.orbit.tolist()]


def of_family(row: Row, orbits: Sequence[Any]) -> dict[str, Any]:
    """The energies of our orbits, and the first two of them."""
    return {
        "task": "family",
        "energies": [one.energy for one in orbits],
        "guesses": [on_section(row, one) for one in orbits[:2]],
    }


def of_level(row: Row, orbits: Sequence[Any]) -> dict[str, Any]:
    """The same guesses."""
    states, periods = guesses()
    del row, orbits
    return {
        "task": "level",
        "energies": [0.16],
        "guesses": np.column_stack([states[:, [1, 3]], periods]).tolist(),
    }


def on_section(row: Row, orbit: Any) -> list[float]:
    """Where an orbit crosses the section, and its period, to four digits."""
    import liepoisson as lp

    x = lp.section(orbit.system, orbit.start, surface=row.surface, direction=1, t_end=2 * orbit.period).state[0]
    places = [1, 3] if row.system == "henon" else [0, 2]
    return [float(f"{v:.4g}") for v in (*x[places], orbit.period)]


ROWS = {
    "family-henon": Row("Hénon and Heiles: curved orbits", "henon", "x", family("henon", 1.3e-3), of_family),
    "family-saddle": Row("Lyapunov orbits above a saddle", "saddle", "q2", family("saddle", 8e-3), of_family),
    "family-moon": Row("Lyapunov orbits at L1, Earth and Moon", "moon", "q2", family("moon", 1.5e-3), of_family, 1e-11),
    "level": Row(f"Hénon and Heiles: {GUESSES} guesses, H = {ENERGY}", "henon", "x", level, of_level, 1e-10),
}


def residuals(row: Row, starts: Any, periods: Any) -> Any:
    """The gaps of orbits after their periods, relative to the size of the start."""
    import liepoisson as lp

    found = np.full(len(starts), np.inf)
    for k in np.flatnonzero(np.isfinite(starts).all(axis=1) & (periods > 0)):
        end = lp.integrate(system_of(row.system), starts[k], times=[0, periods[k]], method=lp.Taylor(tol=1.2e-16)).state
        found[k] = np.abs(end[0, -1] - starts[k]).max() / np.abs(starts[k]).max()
    return found


def asked(request: dict[str, Any]) -> dict[str, Any]:
    """The answer of the peer, in a fresh process."""
    worker = [str(measure.PYTHON["scipy"]), str(measure.HERE / "periodic_worker.py"), json.dumps(request)]
    return json.loads(subprocess.run(worker, check=True, capture_output=True, text=True).stdout)


def judged(row: Row, answer: dict[str, Any], periods: Any) -> tuple[Any, Any]:
    """The residuals of the peer's orbits, and which are those of ours."""
    orbits = np.array(answer["orbits"])
    states, times = orbits[:, :4].copy(), orbits[:, 4]
    if row.system == "moon":  # momenta from velocities
        states[:, 2] -= states[:, 1]
        states[:, 3] += states[:, 0]
    return residuals(row, states, times), np.abs(times / periods - 1) < SAME


def setting(row: Row, request: dict[str, Any], periods: Any, wanted: int) -> dict[str, Any]:
    """The quickest setting by which so many orbits close, or most of them."""
    tried: list[tuple[int, float, dict[str, Any]]] = []
    for exact in (True, False):
        for tol, xtol in itertools.product(TOLERANCES, STEPS):
            chosen = {"exact": exact, "tol": tol, "xtol": xtol}
            if not exact and tol != min(tried, key=lambda one: one[:2])[2]["tol"]:
                continue
            answer = asked(request | chosen)
            gaps, same = judged(row, answer, periods)
            n = int((same & (gaps <= row.level)).sum())
            tried.append((-min(n, wanted), answer["seconds"], chosen))
            print(row.title, chosen, f"{n} closed in {answer['seconds']:.2f} s", flush=True)
            if n >= wanted:  # smaller ones only take longer
                break
    return min(tried, key=lambda one: one[:2])[2]


def compared(row: Row, rounds: int) -> dict[str, Any]:
    """The times of both sides by turns, and what they found."""
    orbits = row.ours()
    periods = np.array([one.period for one in orbits])
    request = row.request(row, orbits) | {"system": row.system}
    own = residuals(row, np.array([one.start for one in orbits]), periods) <= row.level
    chosen = setting(row, request, periods, int(own.sum()))
    seconds: dict[str, list[float]] = {"ours": [], "peer": []}
    answer: dict[str, Any] = {}
    for _ in range(rounds):
        begin = time.process_time()
        orbits = row.ours()
        seconds["ours"].append(time.process_time() - begin)
        answer = asked(request | chosen)
        seconds["peer"].append(answer["seconds"])
    own = residuals(row, np.array([one.start for one in orbits]), periods)
    gaps, same = judged(row, answer, periods)
    closed = same & (gaps <= row.level), own <= row.level
    return {
        "title": row.title,
        "seconds": seconds,
        "n_orbits": len(orbits),
        "n_closed": [int(one.sum()) for one in closed],
        "residual": [float(gaps[closed[0]].max(initial=0.0)), float(own[closed[1]].max(initial=0.0))],
        "setting": chosen,
        "integrations": answer["n_integrations"] / len(orbits),
    }


def run(names: Sequence[str], rounds: int) -> dict[str, Any]:
    """All rows, as plain data for `report`."""
    return {
        "kind": "periodic",
        "title": "Periodic orbits beside single shootings with SciPy and Numba",
        "rows": [compared(ROWS[name], rounds) for name in names],
        "rounds": rounds,
    }


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: of each row the milliseconds per orbit on both sides, medians, and their ratio."""
    table = [
        ["what", "orbits", "SciPy: closed, residual", "its setting", "ms an orbit", "ours: closed, residual",
         "ms an orbit", "ratio"],
    ]  # fmt: skip
    for one in data["rows"]:
        peer, ours = (1e3 * float(np.median(one["seconds"][side])) / one["n_orbits"] for side in ("peer", "ours"))
        chosen = one["setting"]
        how = "variational equations" if chosen["exact"] else "differences"
        table.append([
            one["title"],
            str(one["n_orbits"]),
            f"{one['n_closed'][0]}, {one['residual'][0]:.0e}",
            f"{how}, tol {chosen['tol']:.0e}, xtol {chosen['xtol']:.0e}, {one['integrations']:.1f} integrations",
            f"{peer:.2f}",
            f"{one['n_closed'][1]}, {one['residual'][1]:.0e}",
            f"{ours:.2f}",
            f"{peer / ours:.1f}",
        ])  # fmt: skip
    return table


def main() -> None:
    """Measure, print the table, and write its data."""
    import report
    import run as runs

    parser = argparse.ArgumentParser(description="periodic orbits beside single shootings with SciPy and Numba")
    parser.add_argument("rows", nargs="*", metavar="ROW", default=list(ROWS), help=f"of {', '.join(ROWS)}")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="fewer do not go to the docs")
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.rows if name not in ROWS]:
        parser.error(f"wanted rows out of {', '.join(ROWS)}; got {', '.join(unknown)}")
    facts = runs.facts(arguments.core)
    environment.ensure_peers()
    data = run(arguments.rows, arguments.rounds)
    whole = arguments.rounds >= ROUNDS and len(arguments.rows) == len(ROWS)
    report.save(report.TABLES if whole else report.QUICK, "periodic", data, facts)
    print(report.render(data))


if __name__ == "__main__":
    main()
