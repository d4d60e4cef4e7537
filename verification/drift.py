r"""Do errors of energy, Casimirs and integrals grow like $\sqrt t$ (Brouwer's law), or faster?

64 members take up to 10^8 steps each, on the second top 10^7.  In windows of
time that are equally spaced in $\ln t$, with a few samples in
each, the root mean square over members and samples and the largest error are recorded.  Round-off without bias makes
a random walk, RMS $= c\,t^{1/2}$; a bias, or a truncation error that accumulates, makes RMS $\propto t$; a bounded
error, as of the energy under a symplectic method, makes it constant.  The power is fitted over the last decades of
time.

A run is cut into pieces.  Each is stored and starts from the last states of the one before it, at time 0 of its own
(the systems are autonomous), so that times stay exact multiples of the step.  Compensation begins anew with each
piece.

References: Brouwer, Astronomical Journal 46 (1937) 149; Hairer, McLachlan and Razakarivony, BIT 48 (2008) 231.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import contenders
import drift_figures
import figures
from fits import growth_of_rms
from problems import TOPS, Array, integrate, invariant_errors, starts
from settings import Settings
from store import Piece, Store

if TYPE_CHECKING:
    from contenders import Contender

TOP_NAMES = ("twisted Kovalevskaya", "twisted Lagrange")
N_MEMBERS = 64
N_WINDOWS, N_SAMPLES = 40, 16
FIRST = 16
"""Steps at which the first window begins."""
DECADES = 3
"""The last decades of time, over which powers are fitted."""
WORK_OF_A_PIECE = 64_000_000
"""Steps of all members together: some seconds to some minutes."""


@dataclass(frozen=True)
class Run:
    """A method with its tolerance or step, and how far it goes.

    `step` is the unit of time in which samples are placed: the step of the method, or for an adaptive method about
    its mean.
    """

    contender: Contender
    value: float
    step: float
    long: bool = False

    @property
    def label(self) -> str:
        """The method and its setting."""
        return f"{self.contender.name}, {figures.setting(self.contender.knob, self.value)}"


def _stepping(contender: Contender, step: float, *, long: bool = False) -> Run:
    return Run(contender, step, step, long)


RUNS = (
    # The tightest tolerance: what is left of a bias here is one of rounding, and not of truncation.
    Run(contenders.TAYLOR, 1.2e-16, 0.35, long=True),
    # Steps are sums of powers of two, so that every multiple is exact and the map stays the same.
    # At this step the energy of splitting 6 oscillates by about 5e-13, below the round-off of the last decades.
    _stepping(contenders.SPLITTING[6], 0.046875, long=True),
    _stepping(contenders.SPLITTING[2], 0.03125),
    _stepping(contenders.SPLITTING[4], 0.03125),
    _stepping(contenders.SPLITTING[8], 0.0625),
    _stepping(contenders.GAUSS[2], 0.03125),
    _stepping(contenders.GAUSS[4], 0.03125),
    _stepping(contenders.GAUSS[6], 0.03125),
    _stepping(contenders.GAUSS[8], 0.0625),
    _stepping(contenders.FIXED, 0.0625),
    # Truncation is below round-off here: what compensated sums are for.
    _stepping(contenders.FIXED, 0.015625),
    _stepping(contenders.COMPENSATED, 0.015625),
    Run(contenders.ADAPTIVE, 1e-12, 0.09),
    Run(contenders.TAYLOR, 1e-15, 0.36),
    Run(contenders.MIXED, 1e-13, 0.36),
)


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Curves of the errors and fitted powers of every run."""
    members = settings.choose(quick=16, full=N_MEMBERS)
    plan = [(top, run, _n_steps(top, run, settings)) for top in TOP_NAMES for run in RUNS]
    estimate = sum(_seconds(top, run, members) * n for top, run, n in plan)
    print(f"drift: about {estimate / 60:.0f} minutes of computing, less what is stored", flush=True)
    curves = [_curve(top, run, n, members, store) for top, run, n in plan]
    return {"members": members, "decades": DECADES, "curves": curves}


def _n_steps(top: str, run: Run, settings: Settings) -> int:
    if not run.long:
        return settings.choose(quick=10_000, full=1_000_000)
    return settings.choose(quick=100_000, full=100_000_000 if top == TOP_NAMES[0] else 10_000_000)


def _seconds(top: str, run: Run, members: int, n: int = 200) -> float:
    """Wall time of one step of all members, from a short run."""
    x0, method = starts(top, members), run.contender.make(run.value)
    began = time.perf_counter()
    integrate(TOPS[top], x0, [0.0, n * run.step], method)
    return (time.perf_counter() - began) / n


def windows(n_steps: int) -> tuple[NDArray[np.int64], list[NDArray[np.int64]]]:
    """Edges of the windows and the samples in each, in steps; a window holds its later edge and not its earlier one."""
    edges = np.unique(np.geomspace(FIRST, n_steps, N_WINDOWS + 1).round().astype(np.int64))
    return edges, [_samples(low, high) for low, high in pairwise(edges.tolist())]


def _samples(low: int, high: int) -> NDArray[np.int64]:
    """Whole numbers of steps after `low` and up to `high`, equally spaced; fewer where there are not so many."""
    steps = np.unique(np.linspace(low, high, N_SAMPLES + 1).round().astype(np.int64))
    return steps[steps > low]


def trajectory(top: str, run: Run, samples: NDArray[np.int64], members: int, store: Store) -> Piece:
    """States at the samples, shape (member, sample, 9), piece by piece from the store, and the steps of each member."""
    x, begin = starts(top, members), 0
    length = max(1, WORK_OF_A_PIECE // members)
    states, n_steps = [], np.zeros(members, dtype=np.int64)
    ends = [*range(length, int(samples[-1]), length), int(samples[-1])]
    for end in ends:
        wanted = samples[(samples > begin) & (samples <= end)]
        question = {
            "top": top, "method": run.contender.name, "value": run.value, "step": run.step, "members": members,
            "begin": begin, "end": end, "samples": wanted.tolist(),
        }  # fmt: skip
        piece = store.piece(
            f"drift-{run.contender.name}-{top}-{end}",
            question,
            lambda x=x, wanted=wanted, begin=begin, end=end: _piece(top, run, x, wanted - begin, end - begin),
        )
        states.append(piece["states"])
        n_steps += piece["n_steps"]
        x, begin = piece["final"], end
    return {"states": np.concatenate(states, axis=1), "n_steps": n_steps}


def _piece(top: str, run: Run, x: Array, samples: NDArray[np.int64], length: int) -> Piece:
    """A member that has failed before starts from NaN, fails at once and stays NaN."""
    grid = np.unique([0, *samples.tolist(), length])
    orbit = integrate(TOPS[top], x, grid * run.step, run.contender.make(run.value))
    wanted = orbit.state[:, np.isin(grid, samples)]
    return {"states": wanted, "final": orbit.state[:, -1], "n_steps": orbit.n_steps}


def _curve(top: str, run: Run, n_steps: int, members: int, store: Store) -> dict[str, Any]:
    edges, inside = windows(n_steps)
    found = trajectory(top, run, np.concatenate(inside), members, store)
    finished = np.isfinite(found["states"]).all(axis=(1, 2))
    errors = invariant_errors(TOPS[top], starts(top, members)[finished], found["states"][finished])
    middle = np.sqrt(edges[:-1] * edges[1:]) * run.step
    cuts = np.cumsum([len(window) for window in inside])[:-1]
    return {
        "top": top,
        "run": run.label,
        "method": run.contender.name,
        "long": run.long,
        "failed": int(np.count_nonzero(~finished)),
        "steps": float(found["n_steps"].mean()),
        "time": figures.numbers(middle),
        "t_end": float(edges[-1] * run.step),
        "quantities": {name: _summary(middle, np.split(error, cuts, axis=1)) for name, error in errors.items()},
    }


def _summary(middle: Array, by_window: list[Array]) -> dict[str, Any]:
    """RMS and largest error in each window, the power over the last decades, and whether the members share a bias."""
    squares = np.stack([(error**2).mean(axis=1) for error in by_window], axis=1)
    late = middle >= middle[-1] / 10**DECADES
    some = (squares[:, late].sum(axis=0) > 0).all()
    fit = growth_of_rms(middle[late], squares[:, late]) if some else None
    last = by_window[-1].mean(axis=1)
    spread = last.std(ddof=1) / np.sqrt(len(last))
    return {
        "rms": figures.numbers(np.sqrt(squares.mean(axis=0))),
        "largest": figures.numbers(np.abs(error).max() for error in by_window),
        "power": figures.power(fit),
        "mean in errors of the mean": figures.number(last.mean() / spread) if spread > 0 else None,
    }


def table(result: dict[str, Any]) -> str:
    """End values and powers: energy, the worst of the Casimirs, the worst of the other integrals, for each top."""
    asked = (("H", ("H",)), ("Casimir", ("C1", "C2", "C3")), ("l3, P", ("l3", "P")))
    tops = list(dict.fromkeys(curve["top"] for curve in result["curves"]))
    columns = {
        (top, title): {curve["run"]: worst(curve, names) for curve in result["curves"] if curve["top"] == top}
        for top in tops
        for title, names in asked
    }
    columns = {key: column for key, column in columns.items() if any(column.values())}
    titles = [f"{top}: {title}" for top, title in columns]
    lines = [f"| method | {' | '.join(titles)} |", "|---|" + "---|" * len(titles)]
    for run in dict.fromkeys(curve["run"] for curve in result["curves"]):
        lines.append(f"| {run} | " + " | ".join(column.get(run, "") for column in columns.values()) + " |")
    return "\n".join(lines) + "\n\n" + _bias_text(result)


def worst(curve: dict[str, Any], names: tuple[str, ...]) -> str:
    """The largest of some quantities at the end, with its power of time."""
    known = [curve["quantities"][name] for name in names if name in curve["quantities"]]
    worst = max(known, key=lambda one: one["rms"][-1], default=None)
    if worst is None:
        return ""
    power = figures.with_error(worst["power"]).replace(" ± ", "±")
    failed = f" ({curve['failed']} failed)" if curve["failed"] else ""
    return f"{figures.scientific(worst['rms'][-1])}, {power}{failed}"


def _bias_text(result: dict[str, Any]) -> str:
    """The largest common bias of members among the long runs."""
    found = [
        (abs(quantity["mean in errors of the mean"] or 0.0), curve, name)
        for curve in result["curves"]
        if curve["long"]
        for name, quantity in curve["quantities"].items()
    ]
    size, curve, name = max(found, key=lambda one: one[0])
    return (
        f"Bias: of {len(found)} means over members at the end of the long runs, the one farthest from zero is "
        f"{size:.1f} standard errors away ({name}, {curve['run']}, {curve['top']} top)."
    )


FIGURES = {"drift": drift_figures.long_runs, "drift-others": drift_figures.other_runs}
