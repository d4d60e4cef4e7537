"""Claims that are judged by measurements, on made-up ones in the schema of the study."""

import json
from copy import deepcopy

import numpy as np
import pytest
from numerical_claims import NUMERICAL

from liepoisson.studies.twisted_top.claims import CLAIMS, Context
from liepoisson.studies.twisted_top.claims.numerics import _heterogeneity

HOLDS, CONDITION, WRONG, MISPRINT, OPEN = "holds", "holds with a condition", "wrong", "misprint", "not settled"
UNDERSPECIFIED = "underspecified"
BY_ID = {claim.id: claim for claim in CLAIMS}


def estimate(value, error):
    return {"value": value, "standard_error": error, "low": value - 2 * error, "high": value + 2 * error}


def fit(lam, c1=0.15, c0=0.3, error=0.0005, window=(20, 200)):
    coefficients = {"lambda": (lam, error), "c1": (c1, 0.008), "c0": (c0, 0.03)}
    estimates = {name: estimate(*value) for name, value in coefficients.items()}
    printed = {"lambda": 0.122, "c1": 0.113, "c0": 0.497}
    # as if the coefficients were independent
    distance = sum(((coefficients[name][0] - value) / coefficients[name][1]) ** 2 for name, value in printed.items())
    return {"window": list(window), **estimates, "chi_squared_of_printed": distance}


def run(lam, mean_200, windows=(), log=(-1.2, 1.0, 0.0), groups=((-1, 0, 0.1), (0, 1, 0.2))):
    A, B, D = (estimate(value, error) for value, error in zip(log, (0.02, 0.004, 1e-5), strict=True))
    return {
        "n_averaged": 1000,
        "fit": fit(lam),
        "windows": [fit(value, window=(5, 100)) for value in windows],
        "mean_at": {"200": estimate(mean_200, 0.001)},
        "log_fit": {"window": [50, 1000], "A": A, "B": B, "with_next_term": {"A": A, "B": B, "D": D}},
        "by_energy": [{"low": a, "high": b, "members": 500, "mean": m, "standard_error": 0.002} for a, b, m in groups],
    }


def measurements():
    runs = {f"twisted-{e}": run(0.125, 0.15, windows=(0.115, 0.13)) for e in ("unit-vectors", "cube", "gaussian")}
    runs |= {f"ordinary-{e}": run(0.0001, 0.021) for e in ("unit-vectors", "cube", "gaussian")}
    runs |= {f"twisted-halved-{e}": run(0.150, 0.2) for e in ("unit-vectors", "cube")}
    runs["ordinary-as-printed-unit-vectors"] = run(0.17, 0.19)
    return {"schema_version": 1, "runs": runs}


def judge(claim, made_up):
    return BY_ID[claim].check(Context(measurements=made_up))


def changed(path, value):
    made_up = deepcopy(measurements())
    *parents, last = path
    entry = made_up["runs"]
    for key in parents:
        entry = entry[key]
    entry[last] = value
    return made_up


LAMBDA = ("twisted-unit-vectors", "fit", "lambda")
FLOOR = ("ordinary-cube", "log_fit", "with_next_term", "D")


@pytest.mark.parametrize(
    ("claim", "made_up", "verdict"),
    [
        ("twisted-kovalevskaya-chaotic", measurements(), HOLDS),
        ("twisted-kovalevskaya-chaotic", changed(LAMBDA, estimate(0.001, 0.0005)), OPEN),
        ("lyapunov-exponent-value", measurements(), UNDERSPECIFIED),
        ("lyapunov-exponent-value", changed(LAMBDA, estimate(0.122, 0.0005)), UNDERSPECIFIED),
        ("printed-fit", measurements(), OPEN),
        ("printed-fit", changed(("twisted-cube", "fit"), fit(0.1221, 0.112, 0.49)), UNDERSPECIFIED),
        ("ordinary-exponent-vanishes", measurements(), HOLDS),
        ("ordinary-exponent-vanishes", changed(FLOOR, estimate(0.001, 1e-5)), OPEN),
        ("ordinary-exponent-vanishes", changed(("ordinary-cube", "log_fit", "B"), estimate(1.1, 0.01)), OPEN),
        ("dashed-curve-inertia", measurements(), MISPRINT),
        ("dashed-curve-inertia", changed(("ordinary-as-printed-unit-vectors",), run(0.0, 0.02)), OPEN),
        ("parameters-fix-exponent", measurements(), UNDERSPECIFIED),
        ("single-exponent", measurements(), CONDITION),
        (
            "single-exponent",
            changed(("twisted-unit-vectors",), run(0.1, 0.1, groups=((0, 1, 0.1), (1, 2, 0.101)))),
            OPEN,
        ),
    ],
)
def test_numerical_verdicts_follow_the_measurements(claim, made_up, verdict):
    found = judge(claim, made_up)
    assert found.method == "numerical"
    assert found.verdict == verdict, found.certificate
    json.dumps(found.data)


@pytest.mark.parametrize("claim", ["lyapunov-exponent-value", "printed-fit"])
@pytest.mark.parametrize("value", [0.1221, 0.5])
@pytest.mark.parametrize(("error", "settled"), [(0.05, False), (float("nan"), False), (0.013, True)])
def test_runs_of_large_errors_settle_nothing(claim, value, error, settled):
    made_up = measurements()
    for name in ("unit-vectors", "cube", "gaussian"):
        made_up["runs"][f"twisted-{name}"] |= {"fit": fit(value, c1=0.112, c0=0.49, error=error), "windows": []}
    found = judge(claim, made_up)
    assert ("too few or too short" in found.correct_statement) == (not settled)
    assert settled or found.verdict == OPEN
    assert value > 0.2 or not settled or found.verdict in (HOLDS, UNDERSPECIFIED)


def test_an_exponent_far_from_the_printed_one_is_wrong():
    made_up = measurements()
    for name in ("unit-vectors", "cube", "gaussian"):
        made_up["runs"][f"twisted-{name}"] |= {"fit": fit(0.3), "windows": [fit(0.29)]}
    found = judge("lyapunov-exponent-value", made_up)
    assert found.verdict == WRONG
    assert "from 0.290 to 0.300" in found.correct_statement


def test_groups_of_energy_are_compared_by_chi_squared():
    chi_squared, sigmas = _heterogeneity([(0.1, 0.01), (0.1, 0.02), (0.1, 0.03)])
    assert chi_squared == pytest.approx(0)
    assert sigmas < 0
    # Seven degrees of freedom: 18.48 is exceeded with probability 0.01, 2.326 standard deviations.
    step = np.sqrt(18.475 / 8)
    assert _heterogeneity([(sign * step, 1.0) for sign in (1, -1) * 4]) == pytest.approx((18.475, 2.326), abs=0.02)


@pytest.mark.parametrize("claim", NUMERICAL)
def test_a_missing_number_is_named(claim):
    partial = measurements()
    for entry in partial["runs"].values():
        entry.update(fit={}, log_fit={}, mean_at={}, by_energy=[])
    found = judge(claim, partial)
    assert found.verdict == "not run"
    assert "missing: " in found.certificate
