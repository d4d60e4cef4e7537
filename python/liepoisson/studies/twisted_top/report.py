"""The report page: one self-contained HTML file with figures, fits, claims and how to repeat it all."""

from __future__ import annotations

import base64
import math
import platform
import re
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import liepoisson as lp
from liepoisson.studies.twisted_top import PRINTED, TEXTS
from liepoisson.studies.twisted_top.figures import ENSEMBLE_LABELS
from liepoisson.studies.twisted_top.findings import (
    KINDS,
    STATUS_CLASSES,
    TITLE,
    count_verdicts,
    front_page,
    mistakes,
    open_questions,
)
from liepoisson.studies.twisted_top.measurements import RESAMPLING, RunResult, by_energy, command
from liepoisson.studies.twisted_top.runs import ENSEMBLES, Moments
from liepoisson.studies.twisted_top.typography import mathematics

if TYPE_CHECKING:
    from liepoisson.studies.twisted_top.study import StudyResult

# Growth like t to a power within this of 1 is called regular: the bound fixed for the ordinary top before it was run.
REGULAR_POWER = 0.02

# The finite-time law does not describe the mean before this time.
FIRST_WINDOW = 10.0

# Order of the summary, and the colour class of each verdict.
VERDICTS = {
    "holds": "good",
    "holds with a condition": "partly",
    "incomplete": "partly",
    "misprint": "partly",
    "underspecified": "partly",
    "wrong": "bad",
    "not settled": "open",
    "not run": "open",
}


def render(study: StudyResult, figures: Mapping[str, Path]) -> str:
    """The report as HTML text; figures are embedded, nothing is loaded from outside."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    filters: dict[str, Callable[..., Any]] = {
        "pm": plus_minus,
        "sci": scientific,
        "millionths": millionths,
        "power": power_of_ten,
        "moments": moments,
        "minus": true_minus,
        "interval": interval,
        "count": with_spaces,
        "mathematics": mathematics,
        "inside": inside_quotation,
        "spans": spans,
    }
    environment.filters.update(filters)
    template = environment.from_string(
        files("liepoisson.studies.twisted_top").joinpath("report.html.j2").read_text(encoding="utf-8")
    )
    return template.render(_context(study, figures))


def _context(study: StudyResult, figures: Mapping[str, Path]) -> dict[str, Any]:
    results = study.results
    main, ordinary = results["twisted-unit-vectors"], results["ordinary-unit-vectors"]
    twisted = [results[f"twisted-{name}"] for name in ENSEMBLES]
    scan_ranges, scan_range = _scan_ranges(twisted)
    claims = study.claims["claims"]
    errata = study.claims["errata"]
    counts = count_verdicts(claims, errata)
    disputed = {entry["id"] for entry in errata}
    return {
        "settings": study.settings,
        "results": results,
        "main": main,
        "ordinary": ordinary,
        "ensembles": [
            (ENSEMBLE_LABELS[name], results[f"twisted-{name}"], results[f"ordinary-{name}"]) for name in ENSEMBLES
        ],
        "scan_ranges": scan_ranges,
        "readings": [
            results[name]
            for name in ("twisted-unit-vectors", "twisted-halved-unit-vectors", "twisted-cube", "twisted-halved-cube")
        ],
        "labels": ENSEMBLE_LABELS,
        "printed": PRINTED,
        "difference": _difference(main.fit),
        "scan_range": scan_range,
        "overshoot": _overshoot(main),
        "energies": by_energy(main),
        "regular_share": _regular_share(results),
        "as_printed": results["ordinary-as-printed-unit-vectors"],
        "as_printed_twisted": results["twisted-as-printed-unit-vectors"],
        "short_end": results["ordinary-as-printed-unit-vectors"].run.end_time,
        "claims": claims,
        "by_id": {claim["id"]: claim for claim in claims},
        "others": [claim for claim in claims if claim["id"] not in disputed],
        "errata": [
            (words, [(entry, same) for entry, same in mistakes(errata) if entry["verdict"] == verdict])
            for verdict, words in KINDS.items()
        ],
        "front": front_page(claims, errata),
        "questions": open_questions(claims),
        "statuses": STATUS_CLASSES,
        "symbols": TEXTS["symbols"].items(),
        "repeated": len(claims) - sum(counts.values()),
        "errata_title": TITLE,
        "numbers": {claim["id"]: number for number, claim in enumerate(claims, 1)},
        "paper": study.claims["paper"],
        "verdicts": [(verdict, kind, counts[verdict]) for verdict, kind in VERDICTS.items() if verdict in counts],
        "kinds": VERDICTS,
        "exact": sum(claim["method"] == "exact" and claim["verdict"] != "not run" for claim in claims),
        "figures": {name: _data_address(path) for name, path in figures.items()},
        "confidence": round(100 * RESAMPLING.confidence),
        "resampling": RESAMPLING,
        "command": command(study.settings),
        "out": study.out.name,
        "seconds": study.seconds,
        "integration_seconds": sum(result.seconds for result in results.values()),
        "version": lp.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "date": datetime.now(UTC).date().isoformat(),
        "regular": abs(ordinary.log_fit.B - 1) < REGULAR_POWER,
        "misprint": _is_misprint(results),
        "floor_sentences": _floor_sentences(ordinary.log_fit),
        "slope_in_errors": abs(ordinary.log_fit.B - 1) / ordinary.log_fit.estimates["B"].standard_error,
        "log_scan": (ordinary.log_fit, *ordinary.log_scan),
    }


def _difference(fit: lp.results.FiniteTimeFit) -> dict[str, float]:
    """Our exponent minus the printed one, and the same in units of our standard error."""
    difference = fit.lambda_ - PRINTED["lambda"]
    return {"value": difference, "in_errors": difference / fit.standard_errors["lambda"]}


def _scan_ranges(results: list[RunResult]) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """Smallest and largest fitted exponent over windows, for each ensemble and for all of them.

    Left out are windows before t = 10, as the law does not describe the early rise of the curve, and those with a
    standard error above 0.002, or in small studies above what some window of every ensemble has.  The limit is the same
    for all ensembles, so that the range of one lies within the range of all.
    """
    scans = {r.run.ensemble: [fit for fit in r.scan if fit.window[0] >= FIRST_WINDOW] for r in results}
    limit = max(0.002, *(2 * min(fit.standard_errors["lambda"] for fit in scan) for scan in scans.values()))

    def ends(fits: list[lp.results.FiniteTimeFit]) -> dict[str, float]:
        values = [fit.lambda_ for fit in fits if fit.standard_errors["lambda"] <= limit]
        return {"low": min(values), "high": max(values), "limit": limit, "first": FIRST_WINDOW}

    return {name: ends(scan) for name, scan in scans.items()}, ends([fit for scan in scans.values() for fit in scan])


def _overshoot(result: RunResult) -> dict[str, Any]:
    """The mean at the end of the run against the fit continued to there."""
    end = result.run.end_time
    measured = result.curve.at(end)
    fitted = float(result.fit.curve(end))
    return {
        "measured": measured,
        "fitted": fitted,
        "continues": end > result.fit.window[1],
        "outside": not measured.contains(fitted),
        "above": fitted > measured.high,
        "below": fitted < measured.low,
    }


def _regular_share(results: Mapping[str, RunResult]) -> dict[str, float]:
    """Per ensemble, the share of twisted starts below the 99.9% quantile of the ordinary top at the same time."""
    shares: dict[str, float] = {}
    for name in ENSEMBLES:
        threshold = np.quantile(results[f"ordinary-{name}"].final_exponent, 0.999)
        shares[ENSEMBLE_LABELS[name]] = float(np.mean(results[f"twisted-{name}"].final_exponent <= threshold))
    return shares


def _is_misprint(results: Mapping[str, RunResult]) -> bool:
    """Whether the ordinary top with the inertia as printed has an exponent that stays far above that of (2, 2, 1)."""
    printed, kovalevskaya = results["ordinary-as-printed-unit-vectors"], results["ordinary-unit-vectors"]
    end = printed.run.end_time
    stays = printed.curve.at(end).low > 0.9 * printed.curve.at(end / 4).high
    return stays and printed.curve.at(end).low > 2 * kovalevskaya.curve.at(end).high


def _floor_sentences(fit: lp.results.LogFit) -> dict[str, str]:
    """What the fits with a linear term say about a floor, in words that follow from the numbers."""
    zero, nonzero = "zero within its error", "not zero within its statistical error"
    return {
        "linear": zero if fit.linear_term_is_zero else nonzero,
        "next": zero if fit.floor_is_zero else nonzero,
    }


def plus_minus(estimate: lp.results.Estimate) -> str:
    """Value ± standard error with a typographic minus sign."""
    return _unbroken(str(estimate))


def scientific(estimate: lp.results.Estimate) -> str:
    """A small number with its error, as (1.04 ± 0.13) × 10⁻⁵."""
    largest = max(abs(estimate.value), estimate.standard_error)
    if largest == 0:
        return "0"
    exponent = math.floor(math.log10(largest))
    scale = 10.0**exponent
    return _unbroken(
        f"({estimate.value / scale:.2f} ± {estimate.standard_error / scale:.2f}) × {_power_text(exponent)}"
    )


def millionths(estimate: lp.results.Estimate) -> str:
    """Value ± standard error in units of 10⁻⁶."""
    return _unbroken(f"{1e6 * estimate.value:.1f} ± {1e6 * estimate.standard_error:.1f}")


def power_of_ten(number: float) -> str:
    """A tolerance such as 10⁻¹³, or 2.5 × 10⁻⁹."""
    exponent = math.floor(math.log10(number) + 1e-9)
    factor = number / 10.0**exponent
    return _power_text(exponent) if abs(factor - 1) < 1e-9 else _unbroken(f"{factor:g} × {_power_text(exponent)}")


def _power_text(exponent: int) -> str:
    return "10" + str(exponent).translate(str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"))


def _unbroken(text: str) -> str:
    """Text with typographic minus signs that is not broken over lines."""
    return true_minus(text).replace(" ", "\u00a0")


def interval(estimate: lp.results.Estimate, places: int = 4) -> str:
    """The confidence interval, as [0.1229, 0.1257]."""
    return _unbroken(f"[{estimate.low:.{places}f}, {estimate.high:.{places}f}]")


def moments(inertia: Moments) -> str:
    """Moments of inertia, as (1, 1, ½)."""
    return _unbroken("(" + ", ".join(str(moment).replace("1/2", "½") for moment in inertia) + ")")


def with_spaces(number: float) -> str:
    """A whole number with thin spaces between groups of three digits."""
    return f"{round(number):,}".replace(",", "\u2009")


def true_minus(value: object) -> str:
    """Text with typographic minus signs before numbers."""
    return re.sub(r"(?<![\w\u2212])-(?=[\d.])", "\u2212", str(value))


def spans(names: Iterable[str], numbers: Mapping[str, int]) -> list[tuple[str, str]]:
    """Claims in the order of their numbers, runs of three or more as first and last: [5, 9, 10, 11] as 5, 9–11."""
    runs: list[list[str]] = []
    for name in sorted(names, key=lambda name: numbers[name]):
        if runs and numbers[name] == numbers[runs[-1][-1]] + 1:
            runs[-1].append(name)
        else:
            runs.append([name])
    return [pair for run in runs for pair in ([(run[0], run[-1])] if len(run) > 2 else [(name, name) for name in run])]


def inside_quotation(words: str) -> str:
    """Words for use between quotation marks: their own become single ones, and the last full stop goes."""
    return words.replace("“", "‘").replace("”", "’").removesuffix(".")


def _data_address(path: Path) -> str:
    return "data:image/svg+xml;base64," + base64.b64encode(path.read_bytes()).decode()
