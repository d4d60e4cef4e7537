"""Rows of what a user waits for beside the ensembles: states at many times, sections, sweeps with one orbit a point.

Both sides are given the same tolerance, that of round-off or of a section that is looked at, since these rows time what
comes on top of the steps.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import problem
from measure import Contender, Row

REPEATS = 5
ROUND_OFF = 1e-15
BATCHES = (4, 8)
N_TIMES = 100_000
N_SECTION = 64
T_SECTION = 500.0
N_SWEEP = 512
T_SWEEP = 1000.0


def _contender(name: str, side: str, request: dict[str, Any], kind: str = "") -> Contender:
    return Contender(name, side, request, {"request": request, "order": None, "meets": True}, kind=kind)


def _both(title: str, problem_file: Path, request: dict[str, Any], work: float) -> Row:
    request = {"problem": str(problem_file), "tol": ROUND_OFF, "repeats": REPEATS} | request
    return Row(
        title,
        [_contender("heyoka", "heyoka", request), _contender("liepoisson", "liepoisson", request, "double")],
        work,
    )


def dense(problem_file: Path) -> Row:
    """States at times that are not known when the orbit is computed."""
    title = f"Dense output: one orbit, t = 0..{problem.T_SINGLE:g}, its states at {N_TIMES:,} times afterwards"
    return _both(title, problem_file, {"task": "dense", "t_end": problem.T_SINGLE, "n_times": N_TIMES}, N_TIMES)


def grid(problem_file: Path) -> Row:
    """States at times that are given with the call."""
    title = f"Output on a grid: one orbit, t = 0..{problem.T_SINGLE:g}, with its states at {N_TIMES:,} times"
    return _both(title, problem_file, {"task": "grid", "t_end": problem.T_SINGLE, "n_times": N_TIMES}, N_TIMES)


def sections(problem_file: Path, tolerance: float) -> Row:
    """Crossings of l3 = 0 by many orbits; heyoka's events, in batches, against certified crossings."""
    request = {
        "problem": str(problem_file),
        "task": "section",
        "t_end": T_SECTION,
        "n_starts": N_SECTION,
        "tol": tolerance,
        "repeats": REPEATS,
    }
    theirs = [_contender(f"heyoka, batch {n}", "heyoka", request | {"batch": n}) for n in BATCHES]
    title = f"Sections l3 = 0: {N_SECTION} orbits, t = 0..{T_SECTION:g}, tol = {tolerance:g} on both sides"
    return Row(title, [*theirs, _contender("liepoisson", "liepoisson", request, "double")], N_SECTION * T_SECTION)


def sweep(problem_file: Path) -> Row:
    """Exponents of one orbit for each of many twists, and of as many orbits of one top: no peer."""
    request = {"problem": str(problem_file), "t_end": T_SWEEP, "n_starts": N_SWEEP, "tol": 1e-9, "repeats": REPEATS}
    title = f"Sweep with one orbit a point: {N_SWEEP} twists, t = 0..{T_SWEEP:g}, mixed precision, one thread"
    tasks = {"liepoisson, one orbit a point": "sweep", f"liepoisson, {N_SWEEP} orbits of one top": "full"}
    contenders = [_contender(name, "liepoisson", request | {"task": task}) for name, task in tasks.items()]
    return Row(title, contenders, N_SWEEP * T_SWEEP)
