r"""Is the mean exponent of a sticky chaotic sea the same when another program integrates it?

Orbits of a chaotic sea stick to its islands now and then, for times as long as the runs, so that a mean exponent is a
mean over rare events: a few hundred starts can look like a bias of an integrator.  The same starts and first tangent
vectors go through liepoisson's Taylor method, its splitting method of order 6, and heyoka.py, which shares no code with
it.  Each pair of means is compared start by start, and so are the numbers of orbits that stayed sticky.

The top is general, and all starts lie in one chaotic sea: they are points of one long orbit, at equal times, so on its
leaf, with its energy, and distributed as the orbit visits them.

heyoka.py runs in an environment of its own, by default that of the benchmarks (`benchmarks/.venv`, made by `make
bench`); `HEYOKA_PYTHON` names another interpreter that can import it.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import tempfile
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

import liepoisson as lp
from problems import Array, first_tangents
from settings import Settings
from store import Piece, Store

WORKER = Path(__file__).with_name("independent_worker.py")
PEER = Path(__file__).parents[1] / "benchmarks" / ".venv" / "bin" / "python"

TOP: dict[str, Any] = {"inertia": (1.5, 1.1, 0.8), "a": (0.5, -0.2, 0.9), "b": (0.3, 0.4, -0.2), "epsilon": 0.8}
START = (0.9, -0.6, 0.5, 0.7, 0.2, -0.8, 0.3, 0.9, 0.4)
SPACING = 50.0
"""Time between two starts on the long orbit: nine times the inverse of the exponent."""
WINDOW = (100.0, 1600.0)
STICKY = 0.145
"""Exponents of single orbits over the window are 0.168 ± 0.010; those of sticky orbits form a tail below, 5% of all."""
TOL = 1e-15
STEP = 0.1
OURS = {"Taylor": lp.Taylor(tol=TOL), "splitting 6": lp.Splitting(step=STEP, order=6)}
PIECE = 1024


def missing() -> str | None:
    """What is needed and not there, or None."""
    python = _interpreter()
    found = Path(python).exists()
    return None if found else f"heyoka.py: {python} does not exist; make bench installs it, HEYOKA_PYTHON names another"


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Means, errors and counts of sticky orbits of the three integrators, and their differences start by start."""
    n = settings.choose(quick=128, full=8192)
    x0, v0 = _starts(n, store), first_tangents(n)
    exponents = {name: _in_pieces(name, n, store, lambda k, m=m: _ours(m, x0[k], v0[k])) for name, m in OURS.items()}
    version, theirs = _peer_version(), lambda k: _theirs(x0[k], v0[k])
    exponents[f"heyoka {version}"] = _in_pieces(f"heyoka {version}", n, store, theirs)
    return {
        "starts": n,
        "window": WINDOW,
        "tolerance": TOL,
        "step": STEP,
        "sticky_below": STICKY,
        "integrators": {name: _summary(values) for name, values in exponents.items()},
        "differences": [_difference(exponents, *pair) for pair in combinations(exponents, 2)],
    }


def _starts(n: int, store: Store) -> Array:
    """Points of the orbit of START, the first one after one spacing, shape (n, 9)."""
    wanted = {"top": TOP, "start": START, "spacing": SPACING, "n": n, "tol": TOL}

    def follow() -> dict[str, Array]:
        orbit = lp.integrate(lp.Top(**TOP), START, times=SPACING * np.arange(n + 1), method=lp.Taylor(tol=TOL))
        return {"x0": orbit.state[0, 1:]}

    return store.piece("independent-starts", wanted, follow)["x0"]


def _in_pieces(name: str, n: int, store: Store, exponents: Callable[[slice], Array]) -> Array:
    """Exponents of all starts over the window, computed and stored piece by piece, shape (n,)."""
    pieces: list[Array] = []
    for first in range(0, n, PIECE):
        part = slice(first, min(first + PIECE, n))
        wanted = {"top": TOP, "start": START, "spacing": SPACING, "window": WINDOW, "tol": TOL, "step": STEP}
        wanted |= {"first": part.start, "last": part.stop, "n": n}
        kept: Piece = store.piece(
            f"independent-{name}-{first}", wanted, lambda part=part: {"exponent": exponents(part)}
        )
        pieces.append(kept["exponent"])
    return np.concatenate(pieces)


def _ours(method: Any, x0: Array, v0: Array) -> Array:
    growth = lp.finite_time_exponents(lp.Top(**TOP), x0, times=WINDOW, tangents=v0, method=method)
    if not (growth.outcome == "finished").all():
        raise RuntimeError(f"{method} did not finish: {set(growth.outcome.tolist())}")
    begin, end = WINDOW
    return (end * growth.exponent[:, 1] - begin * growth.exponent[:, 0]) / (end - begin)


def _theirs(x0: Array, v0: Array) -> Array:
    with tempfile.TemporaryDirectory() as folder:
        problem, out = Path(folder, "problem.npy"), Path(folder, "exponent.npy")
        np.save(problem, np.concatenate([x0, v0], axis=1))
        _ask({"problem": str(problem), "out": str(out), "top": TOP, "window": WINDOW, "tol": TOL})
        return np.load(out)


def _peer_version() -> str:
    return _ask({"version": True})["version"]


def _ask(request: dict[str, Any]) -> dict[str, Any]:
    """The worker's answer: one request, one fresh process of the other environment."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [_interpreter(), str(WORKER), json.dumps(request)]
    return json.loads(subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout)


def _interpreter() -> str:
    return os.environ.get("HEYOKA_PYTHON", str(PEER))


def _summary(values: Array) -> dict[str, Any]:
    sticky = int(np.sum(values < STICKY))
    return {
        "mean": float(values.mean()),
        "standard_error": float(values.std(ddof=1) / math.sqrt(len(values))),
        "standard_deviation": float(values.std(ddof=1)),
        "sticky": sticky,
    }


def _difference(exponents: dict[str, Array], first: str, second: str) -> dict[str, Any]:
    """The mean of the differences and its standard error; the difference of the sticky counts and its standard error.

    An orbit that is sticky for one integrator and not for the other adds one or minus one to the difference of the
    counts, so its variance is the number of such orbits.
    """
    one, other = exponents[first], exponents[second]
    gap = one - other
    sticky_one, sticky_other = one < STICKY, other < STICKY
    return {
        "of": [first, second],
        "mean": float(gap.mean()),
        "standard_error": float(gap.std(ddof=1) / math.sqrt(len(gap))),
        "correlation": float(np.corrcoef(one, other)[0, 1]),
        "sticky": int(sticky_one.sum()) - int(sticky_other.sum()),
        "sticky_error": math.sqrt(int(np.sum(sticky_one != sticky_other))),
    }


def table(result: dict[str, Any]) -> str:
    """Means and counts, then the differences."""
    below = f"{result['sticky_below']:g}"
    lines = [f"| integrator | mean exponent | orbits below {below} |", "|---|---|---|"]
    for name, found in result["integrators"].items():
        lines.append(f"| {name} | {found['mean']:.5f} ± {found['standard_error']:.5f} | {found['sticky']} |")
    lines += ["", f"| difference | of the means | of the numbers below {below} |", "|---|---|---|"]
    for found in result["differences"]:
        lines.append(
            f"| {' − '.join(found['of'])} | {_signed(found['mean'], 5)} ± {found['standard_error']:.5f} | "
            f"{_signed(found['sticky'], 0)} ± {found['sticky_error']:.0f} |"
        )
    begin, end = result["window"]
    largest = max(abs(found["mean"]) / found["standard_error"] for found in result["differences"])
    largest_count = max(abs(found["sticky"]) / max(found["sticky_error"], 1.0) for found in result["differences"])
    lines += [
        "",
        f"{result['starts']} starts, exponents over [{begin:g}, {end:g}]; Taylor methods at tolerance "
        f"{result['tolerance']:g}, splitting with step {result['step']:g}. The largest difference of two means is "
        f"{largest:.1f} of its standard errors, that of two numbers {largest_count:.1f}.",
    ]
    return "\n".join(lines)


def _signed(value: float, places: int) -> str:
    return f"{value:+.{places}f}".replace("-", "−")
