"""The verdicts on the claims of the paper, their record, and what integration says of them."""

import json
import re

import numpy as np
import pytest
from numerical_claims import NUMERICAL

import liepoisson as lp
from liepoisson.studies.twisted_top.claims import CLAIMS, Context, twisted_bracket
from liepoisson.studies.twisted_top.claims.evidence import CHECKS
from liepoisson.studies.twisted_top.findings import claims_to_json

pytestmark = pytest.mark.thorough  # all claims take several seconds

INCOMPLETE, OPEN = "incomplete", "not settled"

VERDICTS = """
misprint: lagrange-centre-of-rotation kovalevskaya-inertia
wrong: zero-field-equals-uncharged charged-lagrange-coplanar collinear-stays-collinear
wrong: never-collinear always-invertible
holds: charged-jacobi charged-rigid-fields charged-casimirs charged-lagrange
holds: leibniz-not-semidirect leibniz-jacobi leibniz-equations leibniz-casimirs alpha-not-rigid
holds: twisted-lagrange-p twisted-lagrange-involution rotation-matrix momentum-matrix
holds: leaf-coordinates l-dot-beta-rate canonical-potential l-dot-beta-momenta matrix-lta
holds: lagrange-cyclic-psi potential-e3-e1 potential-e1-e3 gauge-limits
holds with a condition: charged-phase-space two-field-extensions epsilon-measures-deviation
holds with a condition: bounded-energy-surfaces v-perp-zero-iff-collinear angles-from-fields canonical-bracket
holds with a condition: twist-in-hamiltonian euler-singularity-inflated leaf-dimension kovalevskaya-integrable
holds with a condition: homoclinic-orbits chaos-from-bounded-motion
incomplete: charged-integrable-cases twisted-lagrange-uncharged deformation-breaks-integrability
incomplete: kovalevskaya-painleve section-surface lagrange-bifurcations
underspecified: leaves-cotangent-so3
not settled: nearby-integrable-case
"""
EXACT = {name: kind for kind, names in re.findall("^(.+): (.+)$", VERDICTS, re.MULTILINE) for name in names.split()}
BY_ID = {claim.id: claim for claim in CLAIMS}


@pytest.fixture(scope="module")
def results(exact_results):
    return list(exact_results)


def test_every_claim_is_expected_here(results):
    assert [result.claim.id for result in results] == [claim.id for claim in CLAIMS]
    assert set(BY_ID) == set(EXACT) | set(NUMERICAL) | {"rigorous-demonstration"}
    assert len(BY_ID) == len(CLAIMS)


def test_exact_verdicts(results):
    found = {r.claim.id: r.verdict.verdict for r in results if r.verdict.method == "exact"}
    assert found == EXACT


def test_chaos_is_proved_with_enclosures(results):
    verdict = {r.claim.id: r.verdict for r in results}["rigorous-demonstration"]
    assert (verdict.verdict, verdict.method) == (INCOMPLETE, "enclosed")
    assert 0.048 < verdict.data["entropy_above"] < 0.0481
    # Without the twist, or with the other sign: it is another system, and nothing is proved of it.
    for wrong in (Context(bracket=lambda _: twisted_bracket(0)), Context(bracket=lambda _: twisted_bracket(-1))):
        failed = next(c for c in CLAIMS if c.id == "rigorous-demonstration").check(wrong)
        assert failed.verdict == OPEN
        assert "✗" in failed.certificate


def test_no_step_of_an_exact_check_fails(results):
    for result in results:
        if result.claim.id in EXACT:
            assert "✓" in result.verdict.certificate
            assert "✗" not in result.verdict.certificate, result.verdict.certificate


def test_without_measurements_the_numerical_claims_are_not_run(results):
    for result in results:
        if result.claim.id in NUMERICAL:
            assert result.verdict.verdict == "not run"
            assert result.verdict.method == "numerical"
            assert "missing: run" in result.verdict.certificate


def test_the_json_has_the_documented_schema(results):
    document = claims_to_json(results, {"package": "liepoisson", "version": "0"})
    assert document["schema_version"] == 3
    assert json.loads(json.dumps(document)) == document
    keys = ["id", "place", "words", "statement", "follows_from", "verdict", "method", "proof", "steps", "certificate"]
    keys += ["correct_statement", "data", "produced_by"]
    for entry, result in zip(document["claims"], results, strict=True):
        assert list(entry) == keys
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", entry["id"])
        assert entry["place"].startswith(("Section ", "Figure "))
        assert entry["produced_by"]["package"] == "liepoisson"
        module, _, name = entry["produced_by"]["check"].rpartition(".")
        assert module.startswith("liepoisson.studies.twisted_top.claims.")
        assert name == CHECKS[result.claim.id].__name__
        for text in (entry["statement"], entry["words"], entry["certificate"], entry["correct_statement"]):
            assert "\\" not in text
            assert "$" not in text
            assert "**" not in text


# Independent checks of what the certificates say, by integration.


def test_a_bounded_orbit_of_an_integrable_top_has_a_positive_exponent():
    """The orbit asymptotic to the saddle, while it is followed: until round-off has grown to its size."""
    top = lp.Top.kovalevskaya()
    z = 2 / np.cosh(-14.0)
    x0 = [0, 0, z, z**2 / 2 - 1, z * np.tanh(14.0), 0, 0, 0, 0]
    growth = lp.finite_time_exponents(top, x0, times=[4.0, 10.0], tangents=[0, 0, 1.0, 0, 1.0, 0, 0, 0, 0])
    rate = (10 * growth.exponent[0, 1] - 4 * growth.exponent[0, 0]) / 6
    assert rate == pytest.approx(1.0, abs=1e-3)
    # The same top at random starts, none of them asymptotic to the saddle: ln t/t.
    typical = lp.finite_time_exponents(top, lp.sample_states(top, 20, seed=1), t_end=1000).exponent[:, -1]
    assert typical.max() < 0.02


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
    x = lp.integrate(top, state(t)[0], times=t).state[0]
    # Round-off grows along the unstable direction like exp(k |t|) = 180 over the run.
    np.testing.assert_allclose(x, state(t), rtol=0, atol=1e-12)
    np.testing.assert_allclose(state(np.array([40.0]))[0, [2, 3, 4]], [z0, d, 0], atol=1e-12)
