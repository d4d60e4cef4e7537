"""Claims of the discussion and of the figure that are judged by the measurements of the numerical study.

They read these keys of `Context.measurements`, in the schema of `liepoisson.studies.twisted_top.measurements` (an
estimate has `value` and `standard_error`):

    runs.twisted-<ensemble>    fit.lambda, fit.c1, fit.c0, fit.window, windows[], n_averaged      (three ensembles)
    runs.ordinary-<ensemble>   log_fit.A, log_fit.B, log_fit.with_next_term.D, log_fit.window, n_averaged
    runs.ordinary-unit-vectors, runs.ordinary-as-printed-unit-vectors    mean_at.200, fit.lambda
    runs.twisted-halved-unit-vectors, runs.twisted-halved-cube           fit.lambda
    runs.twisted-unit-vectors  by_energy[]: low, high, mean, standard_error

Where one is missing the verdict is "not run".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top import PRINTED
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, Ruling, Step, Verdict, checks
from liepoisson.studies.twisted_top.runs import ENSEMBLES
from liepoisson.studies.twisted_top.typography import typeset

# A measured number differs from a stated one when it lies beyond so many standard errors.
SIGNIFICANT = 3.0
# A fit says something about the printed exponent when this many errors of it are at most a third of the printed value.
COARSEST_ERROR = PRINTED["lambda"] / (3 * SIGNIFICANT)
# Chi squared with 3 degrees of freedom that is exceeded as seldom as three standard errors (probability 0.0027).
CHI_SQUARED_3 = 14.16
# How near the slope of t <lambda(t)> over ln t must be to one (fixed before the runs).
SLOPE_TOLERANCE = 0.02

TWISTED, ORDINARY = ([f"{top}-{ensemble}" for ensemble in ENSEMBLES] for top in ("twisted", "ordinary"))


class _NotMeasuredError(Exception):
    """A number that the check needs is not among the measurements."""


class Runs:
    """The measured runs, the steps that are stated of them, and the numbers behind the verdict."""

    def __init__(self, runs: Mapping[str, Any]) -> None:
        self.runs = runs
        self.steps: list[Step] = []
        self.data: dict[str, Any] = {}

    def state(self, text: str, succeeded: bool | None = None) -> None:
        """A measurement, and whether it bears the claim out."""
        self.steps.append(Step("measurement", typeset(text), succeeded))

    def verdict(self, ruling: Ruling, correct: str = "") -> Verdict:
        """What is concluded from the measurements."""
        return Verdict(ruling, "numerical", tuple(self.steps), correct, self.data)

    def field(self, entry: Any, run: str, key: str) -> Any:
        """A part of an entry of a run."""
        try:
            return entry[key]
        except (KeyError, TypeError):
            raise _NotMeasuredError(f"{key} of {run}") from None

    def entry(self, run: str, key: str) -> Any:
        """A part of a run."""
        if run not in self.runs:
            raise _NotMeasuredError(f"run {run}")
        return self.field(self.runs[run], run, key)

    def number(self, run: str, entry: Any, key: str) -> lp.results.Estimate:
        """An estimate in an entry of a run, or in the entry of this name."""
        found = self.field(self.entry(run, entry) if isinstance(entry, str) else entry, run, key)
        value, error = (float(self.field(found, run, name)) for name in ("value", "standard_error"))
        return lp.results.Estimate(value, error, value, value)

    def starts(self, run: str) -> str:
        """How many starts were averaged."""
        return f"{self.entry(run, 'n_averaged')} starts"

    def how(self, run: str, fit: str = "fit") -> str:
        """Starts and window of a fit."""
        first, last = self.field(self.entry(run, fit), run, "window")
        return f"{self.starts(run)}, t from {first:g} to {last:g}"

    def exceeds(self, ensemble: str, exponent: lp.results.Estimate) -> tuple[bool, str]:
        """Whether a fitted exponent is positive beyond its statistical error and beyond the error of the law itself.

        The latter is what the same fit gives for the ordinary top, whose exponent is zero: `fit.lambda` of that run.
        """
        bias = abs(self.number(f"ordinary-{ensemble}", "fit", "lambda").value)
        text = f"the same fit of the ordinary top, whose exponent is zero, is off by {bias:.4f}"
        return exponent.value > SIGNIFICANT * exponent.standard_error and exponent.value > SIGNIFICANT * bias, text

    def apart(self, names: Sequence[str] = TWISTED) -> str:
        """How many standard errors the printed exponent is from that of each run, in the window fixed beforehand."""
        estimates = [self.number(name, "fit", "lambda") for name in names]
        return ", ".join(f"{abs(PRINTED['lambda'] - e.value) / e.standard_error:.1f}" for e in estimates)


def measured(check: Callable[[Runs], Verdict]) -> Callable[[Evidence, Context], Verdict]:
    """Turn a check of measured runs into a check of a context, "not run" when runs or numbers are missing."""

    @wraps(check)
    def judge(_: Evidence, context: Context) -> Verdict:
        runs = (context.measurements or {}).get("runs", {})
        try:
            return check(Runs(runs))
        except _NotMeasuredError as missing:
            told = Runs(runs)
            told.state(f"Needs the measurements of the numerical study; missing: {missing}.")
            return told.verdict("not run")

    return judge


@checks("twisted-kovalevskaya-chaotic")
@measured
def chaotic(runs: Runs) -> Verdict:
    """Whether the fitted exponent is positive: `fit.lambda` of the twisted runs of all ensembles."""
    positive = True
    for ensemble, name in zip(ENSEMBLES, TWISTED, strict=True):
        exponent = runs.number(name, "fit", "lambda")
        exceeds, calibration = runs.exceeds(ensemble, exponent)
        positive &= exceeds
        runs.state(f"{name}: λ = {exponent} ({runs.how(name)}); {calibration}", exceeds)
        runs.data[name] = {"lambda": exponent.value, "standard_error": exponent.standard_error}
    if positive:
        return runs.verdict("holds")
    text = f"λ is not {SIGNIFICANT:g} errors, statistical and of the law, above zero throughout."
    return runs.verdict("not settled", text)


@checks("lyapunov-exponent-value")
@measured
def exponent_value(runs: Runs) -> Verdict:
    """Whether 0.122 is reproduced: `fit.lambda` and `windows` of the twisted runs.

    Runs that do not determine the exponent to a third of its value settle nothing, whether they agree or not.
    """
    printed = PRINTED["lambda"]
    estimates: list[lp.results.Estimate] = []
    scanned: list[float] = []
    runs.data["printed"] = printed
    for name in TWISTED:
        fitted = runs.number(name, "fit", "lambda")
        estimates.append(fitted)
        windows = [runs.number(name, window, "lambda").value for window in runs.entry(name, "windows")]
        values = [fitted.value, *windows]
        scanned += values
        low, high = min(values), max(values)
        runs.state(f"{name}: λ = {fitted} ({runs.how(name)}), {low:.4f} to {high:.4f} over {len(values)} windows")
        runs.data[name] = {"lambda": fitted.value, "standard_error": fitted.standard_error, "windows": [low, high]}
    if too_coarse := _too_coarse(estimates):
        return runs.verdict("not settled", too_coarse)
    if all(abs(e.value - printed) <= SIGNIFICANT * e.standard_error for e in estimates):
        return runs.verdict("holds")
    inside = min(scanned) <= printed <= max(scanned)
    correct = (
        f"The fitted λ depends on the ensemble of starts and on the window of the fit, which the paper does not state. "
        f"In the window fixed beforehand 0.122 is {runs.apart()} standard errors away "
        f"({', '.join(ENSEMBLES)}); over all windows tried, also those with large errors, λ ranges from "
        f"{min(scanned):.3f} to {max(scanned):.3f}, and 0.122 is {'inside' if inside else 'outside'} this range."
    )
    return runs.verdict("underspecified" if inside else "wrong", correct)


@checks("printed-fit")
@measured
def printed_fit(runs: Runs) -> Verdict:
    """Whether all three printed coefficients are reproduced: `fit` and `windows` of the twisted runs.

    Runs that do not determine the exponent to a third of its value settle nothing: almost any curve agrees with them.
    """
    nearest: dict[str, tuple[float, str]] = {}
    tried = 0
    runs.data["printed"] = PRINTED
    exponents = [runs.number(name, "fit", "lambda") for name in TWISTED]
    for name in TWISTED:
        numbers = {key: runs.number(name, "fit", key) for key in PRINTED}
        shown = ", ".join(
            f"{label} = {number}" for label, number in zip(("λ", "c₁", "c₀"), numbers.values(), strict=True)
        )
        distances = _distances(runs, name)
        tried += len(distances)
        distance, label = min(distances)
        nearest[name] = distance, label
        runs.state(f"{name}: {shown} ({runs.how(name)}); printed coefficients nearest for {label}, χ² = {distance:.1f}")
        pairs = {key: [number.value, number.standard_error] for key, number in numbers.items()}
        runs.data[name] = pairs | {"nearest": [label, distance]}
    best, *others = sorted(nearest, key=nearest.__getitem__)
    distance, window = nearest[best]
    runs.state(f"χ² is that of all three coefficients with their correlations; {tried} fits were tried.")
    if too_coarse := _too_coarse(exponents):
        return runs.verdict("not settled", too_coarse)
    if distance <= CHI_SQUARED_3:
        rest = min(nearest[name][0] for name in others)
        where = (
            f"Compatible with one of {tried} fits, the nearest: that to {best} over t in {window} (χ² = {distance:.1f} "
            f"for 3 degrees of freedom). The fits to the other ensembles have χ² ≥ {rest:.0f}, and in the window fixed "
            f"beforehand λ of {best} is {runs.apart([best])} standard errors from the printed one. The paper states "
            "neither its starts nor its window; chosen afterwards, they confirm nothing."
        )
        return runs.verdict("underspecified", where)
    correct = (
        "The paper states neither the ensemble of starts nor the window of the fit, and the coefficients depend on "
        f"both; none of {tried} fits gives all three (nearest: {best}, {window}, χ² = {distance:.1f} for 3 degrees of "
        "freedom)."
    )
    return runs.verdict("not settled", correct)


@checks("ordinary-exponent-vanishes")
@measured
def ordinary_vanishes(runs: Runs) -> Verdict:
    """Whether the ordinary top's exponent falls like ln t / t without a floor: `log_fit` of the ordinary runs.

    The floor is the D of t <lambda(t)> = A + B ln t + D t + E/t, the term E/t being the next one of the regular law.
    """
    holds = True
    for name in ORDINARY:
        A, B = (runs.number(name, "log_fit", key) for key in "AB")
        D = runs.number(name, runs.field(runs.entry(name, "log_fit"), name, "with_next_term"), "D")
        good = abs(B.value - 1) <= SLOPE_TOLERANCE and abs(D.value) <= SIGNIFICANT * D.standard_error
        holds &= good
        floor = f"({1e6 * D.value:.1f} ± {1e6 * D.standard_error:.1f}) × 10⁻⁶"
        runs.state(
            f"{name}: t⟨λ⟩ = {A} + ({B}) ln t; with D t + E/t added, the floor is D = {floor} "
            f"({runs.how(name, 'log_fit')})",
            good,
        )
        runs.data[name] = {key: [e.value, e.standard_error] for key, e in (("A", A), ("B", B), ("D", D))}
    runs.state(
        f"Asked: B within {SLOPE_TOLERANCE} of 1, D within {SIGNIFICANT:g} standard errors of 0. The errors are "
        "statistical; the law has further terms, and a negative D is no floor."
    )
    if holds:
        return runs.verdict("holds")
    return runs.verdict("not settled", "The logarithmic law with slope 1 and no floor is not confirmed by these runs.")


@checks("dashed-curve-inertia")
@measured
def dashed_curve_inertia(runs: Runs) -> Verdict:
    """Which inertia the dashed curve can belong to: `mean_at.200` of the ordinary runs, as printed and (2, 2, 1)."""
    printed, right = "ordinary-as-printed-unit-vectors", "ordinary-unit-vectors"
    values = {name: runs.number(name, "mean_at", "200") for name in (printed, right)}
    for name, value in values.items():
        runs.state(f"{name}: ⟨λ⟩ at t = 200 is {value} ({runs.starts(name)})")
        runs.data[name] = [value.value, value.standard_error]
    floor = runs.number(printed, "fit", "lambda")
    runs.state(f"{printed}: fitted λ = {floor} ({runs.how(printed)})")
    runs.data["lambda_as_printed"] = [floor.value, floor.standard_error]
    exceeds, calibration = runs.exceeds("unit-vectors", floor)
    chaotic_as_printed = exceeds and values[printed].value > 2 * values[right].value
    runs.state(
        f"the ordinary top with the printed inertia keeps a positive exponent; with (2, 2, 1) {calibration}",
        chaotic_as_printed,
    )
    if not chaotic_as_printed:
        return runs.verdict("not settled", "These runs do not tell the two apart.")
    correct = (
        f"With I = (1, 1, 2) as printed the ordinary top has ⟨λ⟩ = {values[printed].value:.3f} at t = 200, and its "
        f"exponent stays positive; the dashed curve is that of I₁ = I₂ = 2I₃, where it is {values[right].value:.3f} "
        "and falls like ln t/t."
    )
    return runs.verdict("misprint", correct)


@checks("parameters-fix-exponent")
@measured
def parameters_fix_exponent(runs: Runs) -> Verdict:
    """Whether ratios of inertia suffice: `fit.lambda` of the twisted runs with (2, 2, 1) and (1, 1, 1/2)."""
    differ = False
    for ensemble in ("unit-vectors", "cube"):
        whole, half = (runs.number(f"{top}-{ensemble}", "fit", "lambda") for top in ("twisted", "twisted-halved"))
        gap, error = half.value - whole.value, (whole.standard_error**2 + half.standard_error**2) ** 0.5
        differ |= abs(gap) > SIGNIFICANT * error
        runs.state(f"{ensemble}: λ = {whole} for I = (2, 2, 1), {half} for I = (1, 1, 1/2)")
        pairs = {"(2, 2, 1)": whole, "(1, 1, 1/2)": half}
        numbers = {key: [e.value, e.standard_error] for key, e in pairs.items()}
        runs.data[ensemble] = numbers | {"difference": [gap, error]}
    if not differ:
        return runs.verdict("not settled", "These runs do not tell the two scalings apart.")
    correct = (
        "The paper gives ratios of inertia only and does not say that they suffice. They do not: (2, 2, 1) and (1, "
        "1, ½) are the same top with states scaled by two, so the same starts give different exponents. The inertia "
        "itself, the starts and the window have to be stated."
    )
    return runs.verdict("underspecified", correct)


@checks("single-exponent")
@measured
def single_exponent(runs: Runs) -> Verdict:
    """Whether the average is one exponent: `by_energy` of the twisted run."""
    name = "twisted-unit-vectors"
    groups = runs.entry(name, "by_energy")
    if len(groups) < 2:
        raise _NotMeasuredError(f"{name}: groups of energy")
    means = [lp.results.Estimate(g["mean"], g["standard_error"], g["mean"], g["mean"]) for g in groups]
    for g, mean in zip(groups, means, strict=True):
        runs.state(f"H from {g['low']:+.3f} to {g['high']:+.3f}: mean final exponent {mean}")
    chi_squared, sigmas = heterogeneity([(mean.value, mean.standard_error) for mean in means])
    differ = sigmas > SIGNIFICANT
    runs.state(
        f"the groups differ: χ² = {chi_squared:.1f} for {len(groups) - 1} degrees of freedom, "
        f"{'more than ten' if sigmas > 10 else f'about {sigmas:.0f}'} standard deviations ({runs.starts(name)})",
        differ,
    )
    runs.data |= {"groups": list(groups), "chi_squared": chi_squared, "standard_deviations": sigmas}
    if not differ:
        return runs.verdict("not settled", "These runs do not tell the energies apart.")
    correct = (
        "The average over random starts mixes energies and leaves (and regular islands with the chaotic sea), whose "
        "exponents up to the end of the run differ: it is a mean of exponents, not the exponent of an orbit."
    )
    return runs.verdict("holds with a condition", correct)


def _too_coarse(estimates: Sequence[lp.results.Estimate]) -> str:
    """Why a comparison with the printed exponent says nothing with these standard errors, or ""."""
    errors = [e.standard_error for e in estimates]
    too_large = [error for error in errors if not error <= COARSEST_ERROR]  # also those that are not a number
    if not too_large:
        return ""
    return (
        f"These runs are too few or too short to tell: the standard error of λ reaches {max(too_large):.2g}, and a "
        f"comparison with {PRINTED['lambda']} needs at most {COARSEST_ERROR:.2g}."
    )


def _distances(runs: Runs, name: str) -> list[tuple[float, str]]:
    """For each window, chi squared of the printed coefficients (three, correlated) and the window."""
    found: list[tuple[float, str]] = []
    for fit in (runs.entry(name, "fit"), *runs.entry(name, "windows")):
        first, last = runs.field(fit, name, "window")
        found.append((float(runs.field(fit, name, "chi_squared_of_printed")), f"[{first:g}, {last:g}]"))
    return found


def heterogeneity(numbers: list[tuple[float, float]]) -> tuple[float, float]:
    """Chi squared of numbers with errors about their weighted mean, and its place on the normal scale.

    The latter by the cube-root transformation: E. B. Wilson and M. M. Hilferty, PNAS 17 (1931) 684.
    """
    weights = [error**-2 for _, error in numbers]
    mean = sum(w * value for w, (value, _) in zip(weights, numbers, strict=True)) / sum(weights)
    chi_squared = sum(w * (value - mean) ** 2 for w, (value, _) in zip(weights, numbers, strict=True))
    freedom = len(numbers) - 1
    spread = 2 / (9 * freedom)
    return chi_squared, ((chi_squared / freedom) ** (1 / 3) - (1 - spread)) / spread**0.5
