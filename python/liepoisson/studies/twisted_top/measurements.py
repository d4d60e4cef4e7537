"""The numbers that the study measures, as plain data: what `measurements.json` holds and what claims are judged by.

The schema (version 1).  Every estimate is `{"value", "standard_error", "low", "high"}`, the interval at 95%.

    schema_version   1
    produced_by      package, version, command, members, end_time, seed, tolerance, confidence, n_bootstrap
    printed          the paper's printed fit: {"lambda": 0.122, "c1": 0.113, "c0": 0.497}
    runs             by name, see `runs.plan`: twisted-unit-vectors, twisted-cube, twisted-gaussian,
                     ordinary-unit-vectors, ordinary-cube, ordinary-gaussian, twisted-halved-unit-vectors,
                     twisted-halved-cube, twisted-as-printed-unit-vectors, ordinary-as-printed-unit-vectors; each with
        inertia, a, b, epsilon, ensemble, members, end_time, seed, tolerance
        outcomes     how many trajectories ended how, e.g. {"finished": 20000}
        n_averaged   trajectories in the averages (those that finished)
        mean_at      {"20": estimate, "50": ..., "100", "200", "500", "1000"} of the mean exponent, as far as run
        final        {"time", "mean", "standard_deviation", "quantiles": {"0.05", "0.25", "0.5", "0.75", "0.95"}}
        by_energy    mean final exponent in eighths of the ensemble ordered by energy:
                     [{"low", "high", "members", "mean", "standard_error"}, ...]
        fit          finite-time fit over t in [20, 200]: {"window", "n_times", "rms_residual",
                     "lambda": estimate, "c1": estimate, "c0": estimate, "chi_squared_of_printed": of the three
                     printed coefficients, with the correlations of the fit}
        windows      the same for every window of the scan
        log_fit      t <lambda(t)> = A + B ln t over [50, 1000]: {"window", "n_times", "rms_residual", "A", "B",
                     "with_linear_term": {"A", "B", "D"}, "linear_term_is_zero",
                     "with_next_term": {"A", "B", "D", "E"}, "floor_is_zero"}: the fits to A + B ln t + D t and to
                     A + B ln t + D t + E/t, and whether the interval of D contains zero in each
        log_windows  the same from later starts
        steps        Taylor steps of all trajectories
        seconds      wall time of the integration
        order        order of the Taylor series
        kernel       instruction set that computed it

With an earlier end time the windows are cut there; `window` says what was used.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import liepoisson as lp
from liepoisson.studies.twisted_top import PRINTED
from liepoisson.studies.twisted_top.runs import CENTRE_OF_MASS, FloatArray, Run, Settings

SCHEMA_VERSION = 1
RESAMPLING = lp.fits.Resampling(n_bootstrap=1000, confidence=0.95, seed=0)
SPREAD = (0.05, 0.95)
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
ENERGY_GROUPS = 8

SCAN_STARTS = (5.0, 10.0, 20.0, 30.0, 50.0, 70.0, 100.0)
"""Starts of the windows of the scan."""
_ROWS_AT_A_TIME = 2000
_TIMES_AT_A_TIME = 50


@dataclass(frozen=True)
class RunResult:
    """A run, reduced to what figures, fits and claims need."""

    run: Run  # what was run
    curve: lp.results.MeanCurve  # mean exponent with confidence band
    spread: FloatArray  # exponents that 5% and 95% of the trajectories do not exceed, shape (2, time)
    fit: lp.results.FiniteTimeFit  # finite-time fit over the main window
    scan: tuple[lp.results.FiniteTimeFit, ...]  # the same over other windows
    log_fit: lp.results.LogFit  # logarithmic fit over the main window
    log_scan: tuple[lp.results.LogFit, ...]  # the same from later starts
    final_exponent: FloatArray  # exponent of each finished trajectory at the end, shape (trajectory,)
    energy: FloatArray  # energy of the same trajectories, shape (trajectory,)
    outcomes: dict[str, int]  # number of trajectories by outcome
    steps: int  # Taylor steps of all trajectories
    seconds: float  # wall time of the integration
    order: int  # order of the Taylor series
    kernel: str  # instruction set that computed it


def reduce_run(run: Run, growth: lp.results.FiniteTimeExponents, seconds: float) -> RunResult:
    """Averages, fits and final exponents of a run, after which its curves can be let go."""
    reduction = lp.fits.EnsembleReduction(
        run.time, windows=[run.window, *scan_windows(run)], log_windows=[run.log_window, *log_scan_windows(run)]
    )
    # In blocks of rows, because the variance makes temporary copies of what it is given.
    for start in range(0, len(growth.exponent), _ROWS_AT_A_TIME):
        reduction.add(growth.exponent[start : start + _ROWS_AT_A_TIME])
    fits, log_fits = reduction.finite_time_fits(RESAMPLING), reduction.log_fits(RESAMPLING)
    finished = np.isfinite(growth.exponent[:, -1])
    names, counts = np.unique(growth.outcome.astype(str), return_counts=True)
    energy = np.asarray(run.top().invariant_values(growth.start[finished])["H"], dtype=np.float64)
    return RunResult(
        run=run,
        curve=reduction.mean_curve(confidence=RESAMPLING.confidence),
        spread=_spread(growth.exponent),
        fit=fits[0],
        scan=fits[1:],
        log_fit=log_fits[0],
        log_scan=log_fits[1:],
        final_exponent=growth.exponent[finished, -1].copy(),
        energy=energy,
        outcomes={str(name): int(count) for name, count in zip(names, counts, strict=True)},
        steps=int(growth.n_steps.sum()),
        seconds=seconds,
        order=growth.order,
        kernel=growth.kernel,
    )


def scan_windows(run: Run) -> tuple[tuple[float, float], ...]:
    """The windows of the scan, those that end after the run cut at its end."""
    ends = sorted({min(end, run.end_time) for end in (100.0, 200.0, 500.0, 1000.0)})
    return lp.fits.window_grid(run.time, starts=SCAN_STARTS, ends=ends)


def log_scan_windows(run: Run) -> tuple[tuple[float, float], ...]:
    """The window of the logarithmic fit with later starts, as far as twice the start lies inside it."""
    _, end = run.log_window
    return tuple((start, end) for start in (100.0, 200.0, 300.0) if 2 * start <= end)


def _spread(exponent: FloatArray) -> FloatArray:
    # A few times at a time: quantiles sort a copy.
    columns = range(0, exponent.shape[1], _TIMES_AT_A_TIME)
    blocks = [np.nanquantile(exponent[:, k : k + _TIMES_AT_A_TIME], SPREAD, axis=0) for k in columns]
    return np.concatenate(blocks, axis=1)


def measurements(results: Sequence[RunResult], settings: Settings) -> dict[str, Any]:
    """All measured numbers in the schema of this module."""
    return {
        "schema_version": SCHEMA_VERSION,
        "produced_by": produced_by(settings),
        "printed": PRINTED,
        "runs": {result.run.name: _run_entry(result) for result in results},
    }


def produced_by(settings: Settings) -> dict[str, Any]:
    """What made the numbers, enough to make them again."""
    return {
        "package": "liepoisson",
        "version": lp.__version__,
        "command": command(settings),
        **_fields(settings, "members", "end_time", "seed", "tolerance"),
        **_fields(RESAMPLING, "confidence", "n_bootstrap"),
    }


def command(settings: Settings) -> str:
    """The command line that repeats the study; options at their defaults are left out."""
    default = Settings()
    options = [
        f"--{name.replace('_', '-')} {getattr(settings, name):g}"
        for name in ("members", "end_time", "seed")
        if getattr(settings, name) != getattr(default, name)
    ]
    return " ".join(["liepoisson reproduce twisted-top", *options])


def _fields(one: object, *names: str) -> dict[str, Any]:
    return {name: getattr(one, name) for name in names}


def _run_entry(result: RunResult) -> dict[str, Any]:
    run, curve = result.run, result.curve
    times = sorted({t for t in (20.0, 50.0, 100.0, 200.0, 500.0, 1000.0) if t < run.end_time} | {run.end_time})
    values = result.final_exponent
    return {
        "inertia": [float(moment) for moment in run.inertia],
        "a": list(CENTRE_OF_MASS),
        "b": [0, 0, 0],
        **_fields(run, "epsilon", "ensemble", "members", "end_time", "seed", "tolerance"),
        "outcomes": result.outcomes,
        "n_averaged": curve.n_members,
        "mean_at": {f"{t:g}": curve.at(t)._asdict() for t in times},
        "final": {
            "time": run.end_time,
            "mean": float(values.mean()),
            "standard_deviation": float(values.std(ddof=1)),
            "quantiles": {f"{q:g}": float(np.quantile(values, q)) for q in QUANTILES},
        },
        "by_energy": by_energy(result),
        "fit": _fit_entry(result.fit),
        "windows": [_fit_entry(fit) for fit in result.scan],
        "log_fit": _log_fit_entry(result.log_fit),
        "log_windows": [_log_fit_entry(fit) for fit in result.log_scan],
        "steps": result.steps,
        "seconds": round(result.seconds, 3),
        "order": result.order,
        "kernel": result.kernel,
    }


def by_energy(result: RunResult) -> list[dict[str, float | int]]:
    """Mean final exponent in groups of equally many trajectories of neighbouring energy."""
    order = np.argsort(result.energy)
    groups = [group for group in np.array_split(order, ENERGY_GROUPS) if len(group) > 1]
    return [
        {
            "low": float(result.energy[group[0]]),
            "high": float(result.energy[group[-1]]),
            "members": len(group),
            "mean": float(result.final_exponent[group].mean()),
            "standard_error": float(result.final_exponent[group].std(ddof=1) / math.sqrt(len(group))),
        }
        for group in groups
    ]


def _estimates(estimates: dict[str, lp.results.Estimate]) -> dict[str, dict[str, float]]:
    return {name: estimate._asdict() for name, estimate in estimates.items()}


def _facts(fit: lp.results.FiniteTimeFit | lp.results.LogFit) -> dict[str, Any]:
    return {"window": list(fit.window), **_fields(fit, "n_times", "rms_residual")}


def _fit_entry(fit: lp.results.FiniteTimeFit) -> dict[str, Any]:
    distance = fit.chi_squared(list(PRINTED.values()))
    return {**_facts(fit), **_estimates(fit.estimates), "chi_squared_of_printed": distance}


def _log_fit_entry(fit: lp.results.LogFit) -> dict[str, Any]:
    return {
        **_facts(fit),
        **_estimates(fit.estimates),
        "with_linear_term": _estimates(fit.with_linear_term),
        "linear_term_is_zero": fit.linear_term_is_zero,
        "with_next_term": _estimates(fit.with_next_term),
        "floor_is_zero": fit.floor_is_zero,
    }
