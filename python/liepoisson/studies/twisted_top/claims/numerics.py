"""Claims of the discussion and of the figure that are judged by the measurements of the numerical study.

The keys of the measurements are those of `liepoisson.studies.twisted_top.measurements`; which ones are read is said in
the docstring of each check.  A check whose runs are missing returns "not run".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import wraps
from typing import Any

from liepoisson.studies.twisted_top.claims.model import Claim, Context, Ruling, Verdict
from liepoisson.studies.twisted_top.claims.steps import Step
from liepoisson.studies.twisted_top.claims.typography import typeset

ENSEMBLES = ("unit-vectors", "cube", "gaussian")
PRINTED = {"lambda": 0.122, "c1": 0.113, "c0": 0.497}
# A measured number differs from a stated one when it lies beyond so many standard errors.
SIGNIFICANT = 3.0
# A fit says something about the printed exponent when this many errors of it are at most a third of the printed value.
COARSEST_ERROR = PRINTED["lambda"] / (3 * SIGNIFICANT)
# Chi squared with 3 degrees of freedom that is exceeded as seldom as three standard errors (probability 0.0027).
CHI_SQUARED_3 = 14.16
# How near the slope of t <lambda(t)> over ln t must be to one (fixed before the runs).
SLOPE_TOLERANCE = 0.02


class _NotMeasuredError(Exception):
    """A number that the check needs is not among the measurements."""


def measured(check: Callable[[Mapping[str, Any], Context], Verdict]) -> Callable[[Context], Verdict]:
    """Turn a check of measured runs into a check of a context, "not run" when runs or numbers are missing."""

    @wraps(check)
    def judge(context: Context) -> Verdict:
        runs: Mapping[str, Any] = (context.measurements or {}).get("runs", {})
        try:
            return check(runs, context)
        except _NotMeasuredError as missing:
            return _verdict(
                "not run", [f"  Needs the measurements of the numerical study; missing: {missing}."], "", {}
            )

    return judge


@measured
def chaotic(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether the fitted exponent is positive: `fit.lambda` of the twisted runs of all ensembles."""
    del context
    lines: list[str] = []
    data: dict[str, Any] = {}
    positive = True
    for ensemble in ENSEMBLES:
        name = f"twisted-{ensemble}"
        fit = _entry(runs, name, "fit")
        value, error = _number(fit, name, "lambda")
        exceeds, calibration = _exceeds(runs, ensemble, value, error)
        positive &= exceeds
        lines.append(
            f"{'✓' if exceeds else '✗'} {name}: λ = {_pm(value, error)} ({_how(runs, name, fit)}); {calibration}"
        )
        data[name] = {"lambda": value, "standard_error": error}
    verdict: Ruling = "holds" if positive else "not settled"
    correct = "" if positive else f"λ is not {SIGNIFICANT:g} errors, statistical and of the law, above zero throughout."
    return _verdict(verdict, lines, correct, data)


@measured
def exponent_value(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether 0.122 is reproduced: `fit.lambda` and `windows` of the twisted runs.

    Runs that do not determine the exponent to a third of its value settle nothing, whether they agree or not.
    """
    del context
    printed = PRINTED["lambda"]
    lines: list[str] = []
    agree: list[bool] = []
    errors: list[float] = []
    scanned: list[float] = []
    data: dict[str, Any] = {"printed": printed}
    for name in _names("twisted"):
        fit = _entry(runs, name, "fit")
        value, error = _number(fit, name, "lambda")
        agree.append(abs(value - printed) <= SIGNIFICANT * error)
        errors.append(error)
        values = [_number(window, name, "lambda")[0] for window in (fit, *_entry(runs, name, "windows"))]
        scanned += values
        lines.append(
            f"  {name}: λ = {_pm(value, error)} ({_how(runs, name, fit)}), "
            f"{min(values):.4f} to {max(values):.4f} over {len(values)} windows"
        )
        data[name] = {"lambda": value, "standard_error": error, "windows": [min(values), max(values)]}
    if too_coarse := _too_coarse(errors):
        return _verdict("not settled", lines, too_coarse, data)
    if all(agree):
        return _verdict("holds", lines, "", data)
    inside = min(scanned) <= printed <= max(scanned)
    correct = (
        f"The fitted λ depends on the ensemble of starts and on the window of the fit, which the paper does not state. "
        f"In the window fixed beforehand 0.122 is {_apart(runs)} standard errors away "
        f"({', '.join(ENSEMBLES)}); over all windows tried, also those with large errors, λ ranges from "
        f"{min(scanned):.3f} to {max(scanned):.3f}, and 0.122 is {'inside' if inside else 'outside'} this range."
    )
    return _verdict("underspecified" if inside else "wrong", lines, correct, data)


@measured
def printed_fit(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether all three printed coefficients are reproduced: `fit` and `windows` of the twisted runs.

    Runs that do not determine the exponent to a third of its value settle nothing: almost any curve agrees with them.
    """
    del context
    lines: list[str] = []
    nearest_of: dict[str, tuple[float, str]] = {}
    tried = 0
    errors: list[float] = []
    data: dict[str, Any] = {"printed": PRINTED}
    for name in _names("twisted"):
        fit = _entry(runs, name, "fit")
        numbers = {key: _number(fit, name, key) for key in PRINTED}
        shown = ", ".join(
            f"{label} = {_pm(*numbers[key])}" for key, label in zip(PRINTED, ("λ", "c₁", "c₀"), strict=True)
        )
        errors.append(numbers["lambda"][1])
        distances = sorted(_distances(runs, name))
        tried += len(distances)
        nearest, label = distances[0]
        lines.append(
            f"  {name}: {shown} ({_how(runs, name, fit)}); printed coefficients nearest for {label}, χ² = {nearest:.1f}"
        )
        data[name] = {key: list(value) for key, value in numbers.items()} | {"nearest": [label, nearest]}
        nearest_of[name] = (nearest, label)
    best, *others = sorted(nearest_of, key=lambda name: nearest_of[name])
    distance, window = nearest_of[best]
    lines.append(f"  χ² is that of all three coefficients with their correlations; {tried} fits were tried.")
    if too_coarse := _too_coarse(errors):
        return _verdict("not settled", lines, too_coarse, data)
    if distance <= CHI_SQUARED_3:
        rest = min(nearest_of[name][0] for name in others)
        where = (
            f"Compatible with one of {tried} fits, the nearest: that to {best} over t in {window} (χ² = {distance:.1f} "
            f"for 3 degrees of freedom). The fits to the other ensembles have χ² ≥ {rest:.0f}, and in the window fixed "
            f"beforehand λ of {best} is {_apart(runs, best)} standard errors from the printed one. The paper states "
            "neither its starts nor its window; chosen afterwards, they confirm nothing."
        )
        return _verdict("underspecified", lines, where, data)
    correct = (
        "The paper states neither the ensemble of starts nor the window of the fit, and the coefficients depend on "
        f"both; none of {tried} fits gives all three (nearest: {best}, {window}, χ² = {distance:.1f} for 3 degrees of "
        "freedom)."
    )
    return _verdict("not settled", lines, correct, data)


@measured
def ordinary_vanishes(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether the ordinary top's exponent falls like ln t / t without a floor: `log_fit` of the ordinary runs.

    The floor is the D of t <lambda(t)> = A + B ln t + D t + E/t, the term E/t being the next one of the regular law.
    """
    del context
    lines: list[str] = []
    data: dict[str, Any] = {}
    holds = True
    for name in _names("ordinary"):
        fit = _entry(runs, name, "log_fit")
        A, B = _number(fit, name, "A"), _number(fit, name, "B")
        D = _number(_field(fit, name, "with_next_term"), name, "D")
        good = abs(B[0] - 1) <= SLOPE_TOLERANCE and abs(D[0]) <= SIGNIFICANT * D[1]
        holds &= good
        lines.append(
            f"{'✓' if good else '✗'} {name}: t⟨λ⟩ = {_pm(*A)} + ({_pm(*B)}) ln t; with D t + E/t added, the floor is "
            f"D = ({1e6 * D[0]:.1f} ± {1e6 * D[1]:.1f}) × 10⁻⁶ ({_how(runs, name, fit)})"
        )
        data[name] = {"A": list(A), "B": list(B), "D": list(D)}
    verdict: Ruling = "holds" if holds else "not settled"
    lines.append(
        f"  Asked: B within {SLOPE_TOLERANCE} of 1, D within {SIGNIFICANT:g} standard errors of 0. The errors are "
        "statistical; the law has further terms, and a negative D is no floor."
    )
    correct = "" if holds else "The logarithmic law with slope 1 and no floor is not confirmed by these runs."
    return _verdict(verdict, lines, correct, data)


@measured
def dashed_curve_inertia(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Which inertia the dashed curve can belong to: `mean_at.200` of the ordinary runs, as printed and (2, 2, 1)."""
    del context
    printed, right = "ordinary-as-printed-unit-vectors", "ordinary-unit-vectors"
    values = {name: _number(_entry(runs, name, "mean_at"), name, "200") for name in (printed, right)}
    lines = [f"  {name}: ⟨λ⟩ at t = 200 is {_pm(*value)} ({_who(runs, name)})" for name, value in values.items()]
    fit = _entry(runs, printed, "fit")
    floor, error = _number(fit, printed, "lambda")
    lines.append(f"  {printed}: fitted λ = {_pm(floor, error)} ({_how(runs, printed, fit)})")
    exceeds, calibration = _exceeds(runs, "unit-vectors", floor, error)
    chaotic_as_printed = exceeds and values[printed][0] > 2 * values[right][0]
    lines.append(
        f"{'✓' if chaotic_as_printed else '✗'} the ordinary top with the printed inertia keeps a positive exponent; "
        f"with (2, 2, 1) {calibration}"
    )
    data = {name: list(value) for name, value in values.items()} | {"lambda_as_printed": [floor, error]}
    if not chaotic_as_printed:
        return _verdict("not settled", lines, "These runs do not tell the two apart.", data)
    correct = (
        f"With I = (1, 1, 2) as printed the ordinary top has ⟨λ⟩ = {values[printed][0]:.3f} at t = 200, and its "
        f"exponent stays positive; the dashed curve is that of I₁ = I₂ = 2I₃, where it is {values[right][0]:.3f} and "
        "falls like ln t/t."
    )
    return _verdict("misprint", lines, correct, data)


@measured
def parameters_fix_exponent(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether ratios of inertia suffice: `fit.lambda` of the twisted runs with (2, 2, 1) and (1, 1, 1/2)."""
    del context
    lines: list[str] = []
    data: dict[str, Any] = {}
    differ = False
    for ensemble in ("unit-vectors", "cube"):
        pair = [
            _number(_entry(runs, f"{top}-{ensemble}", "fit"), top, "lambda") for top in ("twisted", "twisted-halved")
        ]
        gap, error = pair[1][0] - pair[0][0], (pair[0][1] ** 2 + pair[1][1] ** 2) ** 0.5
        differ |= abs(gap) > SIGNIFICANT * error
        lines.append(f"  {ensemble}: λ = {_pm(*pair[0])} for I = (2, 2, 1), {_pm(*pair[1])} for I = (1, 1, 1/2)")
        data[ensemble] = {"(2, 2, 1)": list(pair[0]), "(1, 1, 1/2)": list(pair[1]), "difference": [gap, error]}
    if not differ:
        return _verdict("not settled", lines, "These runs do not tell the two scalings apart.", data)
    correct = (
        "The paper gives ratios of inertia only and does not say that they suffice. They do not: (2, 2, 1) and (1, "
        "1, ½) are the same top with states scaled by two, so the same starts give different exponents. The inertia "
        "itself, the "
        "starts and the window have to be stated."
    )
    return _verdict("underspecified", lines, correct, data)


@measured
def single_exponent(runs: Mapping[str, Any], context: Context) -> Verdict:
    """Whether the average is one exponent: `by_energy` of the twisted run."""
    del context
    name = "twisted-unit-vectors"
    groups = _entry(runs, name, "by_energy")
    if len(groups) < 2:
        raise _NotMeasuredError(f"{name}: groups of energy")
    lines = [
        f"  H from {g['low']:+.3f} to {g['high']:+.3f}: mean final exponent {_pm(g['mean'], g['standard_error'])}"
        for g in groups
    ]
    chi_squared, sigmas = _heterogeneity([(g["mean"], g["standard_error"]) for g in groups])
    differ = sigmas > SIGNIFICANT
    lines.append(
        f"{'✓' if differ else '✗'} the groups differ: χ² = {chi_squared:.1f} for {len(groups) - 1} degrees of freedom, "
        f"{'more than ten' if sigmas > 10 else f'about {sigmas:.0f}'} standard deviations ({_who(runs, name)})"
    )
    data = {"groups": list(groups), "chi_squared": chi_squared, "standard_deviations": sigmas}
    if not differ:
        return _verdict("not settled", lines, "These runs do not tell the energies apart.", data)
    correct = (
        "The average over random starts mixes energies and leaves (and regular islands with the chaotic sea), whose "
        "exponents up to the end of the run differ: it is a mean of exponents, not the exponent of an orbit."
    )
    return _verdict("holds with a condition", lines, correct, data)


def _verdict(ruling: Ruling, lines: list[str], correct: str, data: dict[str, Any]) -> Verdict:
    """A verdict from lines that start with their mark: ✓, ✗, or none for what is only said."""
    marks = {"✓": True, "✗": False}
    steps = tuple(Step("measurement", typeset(line[2:]), marks.get(line[0])) for line in lines)
    return Verdict(ruling, "numerical", steps, correct, data)


def _too_coarse(errors: Sequence[float]) -> str:
    """Why a comparison with the printed exponent says nothing with these standard errors, or ""."""
    too_large = [error for error in errors if not error <= COARSEST_ERROR]  # also those that are not a number
    if not too_large:
        return ""
    return (
        f"These runs are too few or too short to tell: the standard error of λ reaches {max(too_large):.2g}, and a "
        f"comparison with {PRINTED['lambda']} needs at most {COARSEST_ERROR:.2g}."
    )


def _names(top: str) -> list[str]:
    return [f"{top}-{ensemble}" for ensemble in ENSEMBLES]


def _field(entry: Any, run: str, key: str) -> Any:
    try:
        return entry[key]
    except (KeyError, TypeError):
        raise _NotMeasuredError(f"{key} of {run}") from None


def _entry(runs: Mapping[str, Any], run: str, key: str) -> Any:
    if run not in runs:
        raise _NotMeasuredError(f"run {run}")
    return _field(runs[run], run, key)


def _number(entry: Any, run: str, key: str) -> tuple[float, float]:
    """Value and standard error of an estimate."""
    estimate = _field(entry, run, key)
    return float(_field(estimate, run, "value")), float(_field(estimate, run, "standard_error"))


def _distances(runs: Mapping[str, Any], name: str) -> Iterator[tuple[float, str]]:
    """For each window, chi squared of the printed coefficients (three, correlated) and the window."""
    for fit in (_entry(runs, name, "fit"), *_entry(runs, name, "windows")):
        first, last = _field(fit, name, "window")
        yield float(_field(fit, name, "chi_squared_of_printed")), f"[{first:g}, {last:g}]"


def _exceeds(runs: Mapping[str, Any], ensemble: str, value: float, error: float) -> tuple[bool, str]:
    """Whether a fitted exponent is positive beyond its statistical error and beyond the error of the law itself.

    The latter is what the same fit gives for the ordinary top, whose exponent is zero: `fit.lambda` of that run.
    """
    regular = f"ordinary-{ensemble}"
    bias = abs(_number(_entry(runs, regular, "fit"), regular, "lambda")[0])
    text = f"the same fit of the ordinary top, whose exponent is zero, is off by {bias:.4f}"
    return value > SIGNIFICANT * error and value > SIGNIFICANT * bias, text


def _heterogeneity(numbers: list[tuple[float, float]]) -> tuple[float, float]:
    """Chi squared of numbers with errors about their weighted mean, and its place on the normal scale.

    The latter by the cube-root transformation: E. B. Wilson and M. M. Hilferty, PNAS 17 (1931) 684.
    """
    weights = [error**-2 for _, error in numbers]
    mean = sum(w * value for w, (value, _) in zip(weights, numbers, strict=True)) / sum(weights)
    chi_squared = sum(w * (value - mean) ** 2 for w, (value, _) in zip(weights, numbers, strict=True))
    freedom = len(numbers) - 1
    spread = 2 / (9 * freedom)
    return chi_squared, ((chi_squared / freedom) ** (1 / 3) - (1 - spread)) / spread**0.5


def _apart(runs: Mapping[str, Any], *names: str) -> str:
    """How many standard errors the printed exponent is from that of each run, in the window fixed beforehand."""
    estimates = [_number(_entry(runs, name, "fit"), name, "lambda") for name in names or _names("twisted")]
    return ", ".join(f"{abs(PRINTED['lambda'] - value) / error:.1f}" for value, error in estimates)


def _who(runs: Mapping[str, Any], run: str) -> str:
    return f"{_entry(runs, run, 'n_averaged')} starts"


def _how(runs: Mapping[str, Any], run: str, fit: Any) -> str:
    first, last = _field(fit, run, "window")
    return f"{_who(runs, run)}, t from {first:g} to {last:g}"


def _pm(value: float, error: float) -> str:
    """Value and error, both to the place of the error's second digit."""
    from liepoisson.indicators.finite_time_fit import Estimate

    return f"{Estimate(value, error, value, value)}"


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "twisted-kovalevskaya-chaotic",
        "Section 5, Discussion, third paragraph, and abstract",
        "The largest Lyapunov exponent of the twisted Kovalevskaya top is positive: the top is chaotic.",
        chaotic,
        words="suggesting that the twisted Kovalevskaya top is chaotic",
    ),
    Claim(
        "lyapunov-exponent-value",
        "Section 5, Discussion, third paragraph",
        "The Lyapunov exponent is λ ≃ 0.122.",
        exponent_value,
        words="The Lyapunov exponent is λ ≃ 0.122",
    ),
    Claim(
        "printed-fit",
        "Figure 1, caption",
        "The averaged exponent follows 0.497/t + 0.113/√t + 0.122.",
        printed_fit,
        words="the solid line is the function 0.497/t + 0.113/√t + 0.122, obtained by a least-squares fit",
        follows_from="lyapunov-exponent-value",
    ),
    Claim(
        "ordinary-exponent-vanishes",
        "Section 5, Discussion, third paragraph, and Figure 1",
        "The exponent of the ordinary Kovalevskaya top goes to zero.",
        ordinary_vanishes,
        words="the untwisted (ordinary) Kovalevskaya top, which shows the Lyapunov exponent going to zero",
    ),
    Claim(
        "dashed-curve-inertia",
        "Figure 1, caption, with Section 5, second paragraph",
        "The dashed curve is that of the ordinary top with I₁ = I₂, I₃ = 2I₁.",
        dashed_curve_inertia,
        words="the dashed line is the averaged Lyapunov exponent for the ordinary Kovalevskaya top",
        follows_from="kovalevskaya-inertia",
    ),
    Claim(
        "parameters-fix-exponent",
        "Section 5, Discussion, second and third paragraphs",
        "Implied: ratios of inertia, a = (−1, 0, 0) and ε = 1 determine the exponent.",
        parameters_fix_exponent,
        words="Specifically, we choose ε = 1 and a = (−1, 0, 0)ᵀ.",
        follows_from="lyapunov-exponent-value",
    ),
    Claim(
        "single-exponent",
        "Section 5, Discussion, third paragraph",
        "The average over random initial conditions gives the Lyapunov exponent of the top.",
        single_exponent,
        words="after averaging over 20,000 random initial conditions",
    ),
)
