"""The whole study: integrate or resume, reduce, judge the claims, draw, report."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top import PRINTED
from liepoisson.studies.twisted_top.figures import ENSEMBLE_LABELS, draw_all
from liepoisson.studies.twisted_top.integration import (
    Progress,
    RunStore,
    Tracker,
    alone_in,
    complete,
    discard,
    write_json,
    write_text,
)
from liepoisson.studies.twisted_top.measurements import RunResult, measurements, produced_by, reduce_run
from liepoisson.studies.twisted_top.runs import ENSEMBLES, Settings, plan


@dataclass(frozen=True)
class StudyResult:
    """What the study found."""

    settings: Settings  # the options it ran with
    out: Path  # the output folder
    results: dict[str, RunResult]  # every run, reduced, by name
    measurements: dict[str, Any]  # the numbers, in the schema of `measurements`
    claims: dict[str, Any]  # the table of claims, in the schema of `findings`
    seconds: float  # wall time of this invocation


def reproduce(settings: Settings, out: Path, *, fresh: bool = False, progress: Progress | None = None) -> StudyResult:
    """Run the study and write figures, data, `measurements.json`, `claims.json` and `report.html` into `out`.

    Finished pieces are stored as they come: after an interruption the same call goes on from there, unless `fresh`
    discards them first.
    """
    with alone_in(out):
        if fresh:
            discard(out)
        return _computed(settings, out, progress)


def _computed(settings: Settings, out: Path, progress: Progress | None) -> StudyResult:
    """What `reproduce` does in its folder."""
    started = time.perf_counter()
    stores = [RunStore(out, run) for run in plan(settings)]
    tracker = Tracker(stores, progress)
    results = run_all(stores, settings.threads, tracker)
    numbers = measurements(list(results.values()), settings)
    write_json(out / "measurements.json", numbers)
    tracker.tell("judging the claims")
    claims = judge(numbers, settings)
    write_json(out / "claims.json", claims)
    figures = draw_all(results, out, tracker.tell)
    tracker.tell("writing the report")
    study = StudyResult(settings, out, results, numbers, claims, time.perf_counter() - started)

    from liepoisson.studies.twisted_top.report import render

    write_text(out / "report.html", render(study, figures))
    return study


def run_all(stores: Sequence[RunStore], threads: int | None, tracker: Tracker) -> dict[str, RunResult]:
    """Integrate, or read, and reduce every run."""
    return {store.run.name: _reduced(store, threads, tracker) for store in stores}


def _reduced(store: RunStore, threads: int | None, tracker: Tracker) -> RunResult:
    """One run; its curves, which fill the memory of the study, are let go before those of the next one are made."""
    growth, seconds = complete(store, threads, tracker)
    tracker.tell(f"{store.run.name}: fits")
    return reduce_run(store.run, growth, seconds)


def judge(numbers: dict[str, Any], settings: Settings) -> dict[str, Any]:
    """The table of claims, judged by the exact algebra and by these numbers."""
    from liepoisson.studies.twisted_top import claims
    from liepoisson.studies.twisted_top.findings import claims_to_json

    return claims_to_json(claims.evaluate_claims(claims.Context(measurements=numbers)), produced_by(settings))


def summary(study: StudyResult) -> str:
    """The main results as plain text: the fits, and what is wrong with the paper."""
    from liepoisson.studies.twisted_top.findings import errata_lines

    settings = study.settings
    window = study.results["twisted-unit-vectors"].fit.window
    log_window = study.results["ordinary-unit-vectors"].log_fit.window
    lines = [
        f"The twisted top: {settings.members} starts per ensemble, to t = {settings.end_time:g}, seed {settings.seed}",
        "",
        f"twisted:  <lambda(t)> = lambda + c1/sqrt(t) + c0/t over t in [{window[0]:g}, {window[1]:g}]",
        *(_fit_line(study.results[f"twisted-{name}"]) for name in ENSEMBLES),
        f"  {'as printed':<14}{PRINTED['lambda']:<22}{PRINTED['c1']:<20}{PRINTED['c0']}",
        f"ordinary: t <lambda(t)> = A + B ln t over t in [{log_window[0]:g}, {log_window[1]:g}]",
        f"  {'':<14}{'B':<22}{'D':<24}D with a term E/t beside it",
        *(_log_line(study.results[f"ordinary-{name}"]) for name in ENSEMBLES),
        "",
        *errata_lines(study.claims["errata"]),
        "",
        f"claims of the paper: {verdict_counts(study.claims)}",
        f"report: {study.out / 'report.html'}",
    ]
    return "\n".join(lines)


def _fit_line(result: RunResult) -> str:
    texts = [str(estimate) for estimate in result.fit.estimates.values()]
    return f"  {ENSEMBLE_LABELS[result.run.ensemble]:<14}{texts[0]:<22}{texts[1]:<20}{texts[2]}"


def _log_line(result: RunResult) -> str:
    fit = result.log_fit
    name, power = ENSEMBLE_LABELS[result.run.ensemble], fit.estimates["B"]
    return f"  {name:<14}{power!s:<22}{_small(fit.with_linear_term['D']):<24}{_small(fit.floor)}"


def _small(estimate: lp.results.Estimate) -> str:
    return f"{estimate.value:.1e} ± {estimate.standard_error:.1e}"


def verdict_counts(claims: dict[str, Any]) -> str:
    """How many claims got which verdict, as text; a mistake that several claims share is counted once."""
    from liepoisson.studies.twisted_top.findings import count_verdicts

    counts = count_verdicts(claims["claims"], claims["errata"])
    repeated = len(claims["claims"]) - sum(counts.values())
    texts = [f"{counts[verdict]} {verdict}" for verdict in sorted(counts, key=lambda v: -counts[v])]
    return ", ".join(texts) + (f"\n  {repeated} more repeat one of these mistakes" if repeated else "")
