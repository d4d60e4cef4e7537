import json
import re
from copy import deepcopy

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.exact.bracket import Bracket
from liepoisson.exact.extension import Extension, leibniz
from liepoisson.exact.lie_algebra import so
from liepoisson.studies.twisted_top.claims import CLAIMS, Claim, Context, Verdict, claims_to_json, evaluate_claims
from liepoisson.studies.twisted_top.claims.evidence import Evidence, show
from liepoisson.studies.twisted_top.claims.integral_search import independent_products, monomials_of_weight, nullity
from liepoisson.studies.twisted_top.claims.numerics import _heterogeneity

pytestmark = pytest.mark.thorough  # all claims take several seconds

HOLDS, CONDITION, WRONG, MISPRINT, OPEN = "holds", "holds with a condition", "wrong", "misprint", "not settled"

EXACT = {
    "lagrange-centre-of-rotation": MISPRINT,
    "zero-field-equals-uncharged": WRONG,
    "charged-jacobi": HOLDS,
    "charged-rigid-fields": HOLDS,
    "charged-casimirs": HOLDS,
    "charged-phase-space": CONDITION,
    "charged-lagrange": HOLDS,
    "charged-lagrange-coplanar": WRONG,
    "charged-integrable-cases": HOLDS,
    "two-field-extensions": CONDITION,
    "leibniz-not-semidirect": HOLDS,
    "leibniz-jacobi": HOLDS,
    "epsilon-measures-deviation": CONDITION,
    "leibniz-equations": HOLDS,
    "leibniz-casimirs": HOLDS,
    "alpha-not-rigid": HOLDS,
    "bounded-energy-surfaces": CONDITION,
    "twisted-lagrange-p": HOLDS,
    "twisted-lagrange-involution": HOLDS,
    "twisted-lagrange-uncharged": CONDITION,
    "rotation-matrix": HOLDS,
    "momentum-matrix": HOLDS,
    "leaf-coordinates": HOLDS,
    "v-perp-zero-iff-collinear": CONDITION,
    "l-dot-beta-rate": HOLDS,
    "angles-from-fields": CONDITION,
    "canonical-bracket": CONDITION,
    "canonical-potential": HOLDS,
    "l-dot-beta-momenta": HOLDS,
    "matrix-lta": HOLDS,
    "lagrange-cyclic-psi": HOLDS,
    "potential-e3-e1": HOLDS,
    "potential-e1-e3": HOLDS,
    "gauge-limits": HOLDS,
    "leaf-dimension": CONDITION,
    "collinear-stays-collinear": WRONG,
    "never-collinear": WRONG,
    "always-invertible": WRONG,
    "leaves-cotangent-so3": WRONG,
    "kovalevskaya-inertia": MISPRINT,
    "kovalevskaya-integrable": CONDITION,
    "nearby-integrable-case": OPEN,
    "homoclinic-orbits": CONDITION,
}
NUMERICAL = (
    "twisted-kovalevskaya-chaotic",
    "lyapunov-exponent-value",
    "printed-fit",
    "ordinary-exponent-vanishes",
    "dashed-curve-inertia",
    "parameters-fix-exponent",
    "single-exponent",
    "deformation-breaks-integrability",
)
BY_ID = {claim.id: claim for claim in CLAIMS}


@pytest.fixture(scope="module")
def results():
    return evaluate_claims()


def test_every_claim_is_expected_here(results):
    assert [result.claim.id for result in results] == [claim.id for claim in CLAIMS]
    assert set(BY_ID) == set(EXACT) | set(NUMERICAL)
    assert len(BY_ID) == len(CLAIMS)


def test_exact_verdicts(results):
    found = {r.claim.id: r.verdict.verdict for r in results if r.verdict.method == "exact"}
    assert found == EXACT


def test_no_step_of_an_exact_check_fails(results):
    for result in results:
        if result.claim.id in EXACT:
            assert "✓" in result.verdict.certificate
            assert "✗" not in result.verdict.certificate, result.verdict.certificate


def test_what_does_not_hold_says_what_does(results):
    for result in results:
        if result.claim.id in EXACT:
            assert (result.verdict.verdict == HOLDS) == (result.verdict.correct_statement == ""), result.claim.id


def test_without_measurements_the_numerical_claims_are_not_run(results):
    for result in results:
        if result.claim.id in NUMERICAL:
            assert result.verdict.verdict == "not run"
            assert result.verdict.method == "numerical"
            assert "missing: run" in result.verdict.certificate


def test_the_json_has_the_documented_schema(results):
    document = claims_to_json(results, {"package": "liepoisson", "version": "0"})
    assert document["schema_version"] == 1
    assert json.loads(json.dumps(document)) == document
    keys = ["id", "place", "statement", "verdict", "method", "certificate", "correct_statement", "data", "produced_by"]
    for entry, result in zip(document["claims"], results, strict=True):
        assert list(entry) == keys
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", entry["id"])
        assert entry["place"].startswith(("Section ", "Figure "))
        assert entry["produced_by"]["package"] == "liepoisson"
        module, _, name = entry["produced_by"]["check"].rpartition(".")
        assert module.startswith("liepoisson.studies.twisted_top.claims.")
        assert name == result.claim.check.__name__
        for text in (entry["statement"], entry["certificate"], entry["correct_statement"]):
            assert "\\" not in text
            assert "$" not in text
            assert "**" not in text


def test_progress_counts_claims():
    chosen = [BY_ID["rotation-matrix"], BY_ID["matrix-lta"]]
    seen: list[float] = []
    assert len(evaluate_claims(claims=chosen, progress=seen.append)) == 2
    assert seen == [0.5, 1.0]


# A wrong bracket: claims turn from holding to failing.


def flipped(*entries):
    """The factory of Leibniz brackets with the sign of some entries W[lam][mu][nu] flipped."""

    def bracket(epsilon):
        W = [[list(row) for row in plane] for plane in leibniz(3, epsilon).tensor]
        for lam, mu, nu in entries:
            W[lam][mu][nu] = -W[lam][mu][nu]
        return Bracket(so(3), Extension(W, check=False))

    return bracket


COCYCLE = [(2, 1, 1)]
ALPHA_TERM = [(1, 0, 1), (1, 1, 0)]
BETA_TERM = [(2, 0, 2), (2, 2, 0)]
L_TERM = [(0, 0, 0)]
ONE_HALF = [(1, 0, 1)]


@pytest.mark.parametrize(
    ("entries", "claim"),
    [(COCYCLE, name) for name in ("leibniz-equations", "leibniz-casimirs", "twisted-lagrange-p", "canonical-bracket")]
    + [(COCYCLE, name) for name in ("alpha-not-rigid", "l-dot-beta-rate", "leibniz-not-semidirect", "leaf-dimension")]
    + [(ALPHA_TERM, name) for name in ("charged-jacobi", "charged-rigid-fields", "leibniz-jacobi", "charged-casimirs")]
    + [(ALPHA_TERM, name) for name in ("bounded-energy-surfaces", "charged-lagrange", "kovalevskaya-integrable")]
    + [(BETA_TERM, name) for name in ("leibniz-jacobi", "leibniz-equations", "twisted-lagrange-involution")]
    + [(L_TERM, name) for name in ("leibniz-jacobi", "momentum-matrix", "charged-phase-space", "twisted-lagrange-p")]
    + [(ONE_HALF, name) for name in ("leibniz-jacobi", "epsilon-measures-deviation", "canonical-bracket")],
)
def test_a_flipped_sign_turns_a_claim_from_holding_to_failing(entries, claim):
    right, wrong = (BY_ID[claim].check(Context(bracket=b)) for b in (Context().bracket, flipped(*entries)))
    assert right.verdict.startswith("holds")
    assert wrong.verdict == "wrong"
    assert "✗" in wrong.certificate
    assert wrong.correct_statement.startswith("The computation does not bear it out")


@pytest.mark.parametrize("claim", ["collinear-stays-collinear", "always-invertible", "zero-field-equals-uncharged"])
def test_a_flipped_sign_unsettles_a_refutation(claim):
    assert BY_ID[claim].check(Context()).verdict == WRONG
    assert BY_ID[claim].check(Context(bracket=flipped(*COCYCLE))).verdict == OPEN


# Independent checks of what the certificates say, by integration.


def test_collinear_fields_separate_and_meet():
    top = lp.Top(inertia=(2, 2, 1), a=(0, 0, 1), epsilon=1)
    x0 = np.array([0, 0, 0, 0, 0, 0, 1.0, 0, 0])
    for sign in (1, -1):
        t = sign * np.array([0.0, 0.01, 0.25])
        x = lp.integrate(top, x0, t=t).state[0]
        distance = np.linalg.norm(np.cross(x[:, 3:6], x[:, 6:]), axis=-1)
        assert distance[0] == 0.0
        # |alpha x beta| = |t| (1 + O(t^2)): the certificate gives the square, t^2 + ...
        np.testing.assert_allclose(distance[1:], np.abs(t[1:]), rtol=1e-2)


def test_the_homoclinic_formula_is_an_orbit():
    inertia, a1, z0, m = 1.0, 1.0, 1.0, 2.0
    k = np.sqrt(m**2 - z0**2) / inertia
    d = m**2 / (a1 * inertia)
    B = d * z0 / (inertia * a1)
    top = lp.Top(inertia=(2, 3, 1), a=(a1, 0, 0), b=(0, 0, 5), epsilon=1)

    def state(t):
        denominator = z0 + m * np.cosh(k * t)
        z = z0 + 2 * k**2 * inertia**2 / denominator
        y = 2 * k**2 * inertia**2 * m * k * np.sinh(k * t) / denominator**2 / a1
        x = (z0**2 / (2 * inertia) + a1 * d - z**2 / (2 * inertia)) / a1
        zero = np.zeros_like(t)
        return np.stack([zero, zero, z, x, y, zero, zero, zero, zero + B], axis=-1)

    t = np.linspace(-1.5, 1.5, 7)
    x = lp.integrate(top, state(t)[0], t=t).state[0]
    # Round-off grows along the unstable direction like exp(k |t|) = 180 over the run.
    np.testing.assert_allclose(x, state(t), rtol=0, atol=1e-12)
    np.testing.assert_allclose(state(np.array([40.0]))[0, [2, 3, 4]], [z0, d, 0], atol=1e-12)


# The search for polynomial integrals.

WEIGHTS = (1, 1, 1, 2, 2, 2, 3, 3, 3)


def test_monomials_of_a_weight_are_all_there():
    assert [len(list(monomials_of_weight(WEIGHTS, w))) for w in (4, 6, 8)] == [48, 182, 555]
    assert all(np.dot(m, WEIGHTS) == 5 for m in monomials_of_weight(WEIGHTS, 5))


def test_the_search_finds_the_integrals_of_the_twisted_lagrange_top():
    top = lp.Top.twisted_lagrange()
    equations = list(top.equations.values())
    weights = {"H": 2, "C1": 4, "C2": 5, "C3": 6, "l3": 1, "P": 3}
    known = {name: (top.invariants[name], weight) for name, weight in weights.items()}
    for weight in range(1, 7):
        found = nullity(equations, top.variables, WEIGHTS, weight)
        assert found == len(independent_products(known, top.variables, weight))
        assert found > len(independent_products({k: known[k] for k in ("H", "C1", "C2", "C3")}, top.variables, weight))


def test_products_of_dependent_integrals_are_counted_once():
    x, y = sp.symbols("x y")
    known = {"f": (x, 1), "g": (y, 1), "h": (x + y, 1)}
    assert len(independent_products(known, (x, y), 1)) == 2
    assert len(independent_products(known, (x, y), 2)) == 3


# Evidence and text.


def test_expressions_are_shown_in_unicode():
    x = sp.symbols("l1 alpha2 beta3 epsilon I3")
    assert show(2 * x[3] * x[0] * x[2] + x[1] ** 2) == "α₂² + 2·β₃·ε·l₁"
    assert show(1 / x[4] - x[0] ** -2) == "−1/l₁² + 1/I₃"
    assert show(sp.Symbol("p_psi") ** 12) == "p_ψ¹²"
    assert len(show(sp.expand((x[0] + x[1] + x[2]) ** 12))) == 160


def test_evidence_records_each_step():
    x = sp.Symbol("x")
    evidence = Evidence()
    assert evidence.zero("a", (x + 1) ** 2 - x**2 - 2 * x - 1)
    assert evidence.zero("b", [x - x, 1 / x - (x + 1) / (x**2 + x)])
    assert evidence.equal("c", 2, 2)
    assert evidence.nonzero("d", sp.Matrix([0, x]))
    evidence.note("e")
    assert evidence.conclude("holds") == Verdict("holds", "exact", "✓ a\n✓ b\n✓ c: 2\n✓ d\n  e")
    assert not evidence.zero("f", x * (x + 1))
    assert not evidence.equal("g", 3, 2)
    assert not evidence.nonzero("h", 0)
    failed = evidence.conclude("holds with a condition", "never mind")
    assert failed.verdict == "wrong"
    assert "✗ f — residual x·(x + 1)" in failed.certificate
    assert "✗ g: 2 — computed 3" in failed.certificate
    assert failed.correct_statement.endswith("g: 2 (computed 3); h (the value is 0).")
    assert evidence.conclude("wrong").verdict == "not settled"


# Numerical claims, on made-up measurements in the schema of the study.


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
        ("lyapunov-exponent-value", measurements(), CONDITION),
        ("lyapunov-exponent-value", changed(LAMBDA, estimate(0.122, 0.0005)), CONDITION),
        ("printed-fit", measurements(), OPEN),
        ("printed-fit", changed(("twisted-cube", "fit"), fit(0.1221, 0.112, 0.49)), CONDITION),
        ("ordinary-exponent-vanishes", measurements(), HOLDS),
        ("ordinary-exponent-vanishes", changed(FLOOR, estimate(0.001, 1e-5)), OPEN),
        ("ordinary-exponent-vanishes", changed(("ordinary-cube", "log_fit", "B"), estimate(1.1, 0.01)), OPEN),
        ("dashed-curve-inertia", measurements(), MISPRINT),
        ("dashed-curve-inertia", changed(("ordinary-as-printed-unit-vectors",), run(0.0, 0.02)), OPEN),
        ("parameters-fix-exponent", measurements(), WRONG),
        ("single-exponent", measurements(), CONDITION),
        (
            "single-exponent",
            changed(("twisted-unit-vectors",), run(0.1, 0.1, groups=((0, 1, 0.1), (1, 2, 0.101)))),
            OPEN,
        ),
        ("deformation-breaks-integrability", measurements(), HOLDS),
        ("deformation-breaks-integrability", changed(LAMBDA, estimate(0.001, 0.0005)), OPEN),
    ],
)
def test_numerical_verdicts_follow_the_measurements(claim, made_up, verdict):
    found = judge(claim, made_up)
    assert found.method == "numerical"
    assert found.verdict == verdict, found.certificate
    json.dumps(found.data)


def test_the_exponent_agrees_when_every_ensemble_does():
    made_up = measurements()
    for name in ("unit-vectors", "cube", "gaussian"):
        made_up["runs"][f"twisted-{name}"]["fit"] = fit(0.1225)
    assert judge("lyapunov-exponent-value", made_up).verdict == HOLDS


def test_an_exponent_far_from_the_printed_one_is_wrong():
    made_up = measurements()
    for name in ("unit-vectors", "cube", "gaussian"):
        made_up["runs"][f"twisted-{name}"] |= {"fit": fit(0.3), "windows": [fit(0.29)]}
    found = judge("lyapunov-exponent-value", made_up)
    assert found.verdict == WRONG
    assert "from 0.290 to 0.300" in found.correct_statement


def test_two_scalings_that_agree_leave_the_claim_open():
    made_up = measurements()
    for name in ("unit-vectors", "cube"):
        made_up["runs"][f"twisted-halved-{name}"]["fit"] = fit(0.1255)
    assert judge("parameters-fix-exponent", made_up).verdict == OPEN


def test_groups_of_energy_are_compared_by_chi_squared():
    chi_squared, sigmas = _heterogeneity([(0.1, 0.01), (0.1, 0.02), (0.1, 0.03)])
    assert chi_squared == pytest.approx(0)
    assert sigmas < 0
    # Seven degrees of freedom: 18.48 is exceeded with probability 0.01, 2.326 standard deviations.
    step = np.sqrt(18.475 / 8)
    assert _heterogeneity([(sign * step, 1.0) for sign in (1, -1) * 4]) == pytest.approx((18.475, 2.326), abs=0.02)


def test_certificates_print_the_measured_numbers():
    assert "λ = 0.12500 ± 0.00050 (1000 starts, t from 20 to 200)" in judge(LAMBDA_CLAIM, measurements()).certificate


LAMBDA_CLAIM = "twisted-kovalevskaya-chaotic"


@pytest.mark.parametrize("claim", NUMERICAL)
def test_a_missing_number_is_named(claim):
    partial = measurements()
    for entry in partial["runs"].values():
        entry.update(fit={}, log_fit={}, mean_at={}, by_energy=[])
    found = judge(claim, partial)
    assert found.verdict == "not run"
    assert "missing: " in found.certificate


def test_claims_are_plain_data():
    claim = Claim("x", "Section 1", "y", lambda context: Verdict("holds", "exact", "z"))
    assert evaluate_claims(claims=[claim])[0].verdict.certificate == "z"
