"""Negative controls: with a wrong bracket the verdicts change, because they are computed."""

import pytest
from numerical_claims import NUMERICAL

from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import so
from liepoisson.studies.twisted_top.claims import CLAIMS, Context

pytestmark = pytest.mark.thorough

HOLDS, CONDITION, WRONG, MISPRINT, OPEN = "holds", "holds with a condition", "wrong", "misprint", "not settled"
INCOMPLETE = "incomplete"
BY_ID = {claim.id: claim for claim in CLAIMS}


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


@pytest.fixture(scope="module")
def right_verdict(exact_results):
    """Of a claim, with the bracket as it is."""
    return {result.claim.id: result.verdict.verdict for result in exact_results}.__getitem__


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
def test_a_flipped_sign_turns_a_claim_from_holding_to_failing(entries, claim, right_verdict):
    wrong = BY_ID[claim].check(Context(bracket=flipped(*entries)))
    assert right_verdict(claim).startswith("holds")
    assert wrong.verdict == "wrong"
    assert "✗" in wrong.certificate
    assert wrong.correct_statement.startswith("The computation does not bear it out")


@pytest.mark.parametrize("claim", ["collinear-stays-collinear", "always-invertible", "zero-field-equals-uncharged"])
def test_a_flipped_sign_unsettles_a_refutation(claim, right_verdict):
    assert right_verdict(claim) == WRONG
    assert BY_ID[claim].check(Context(bracket=flipped(*COCYCLE))).verdict == OPEN


# Structure constants, and all signs at once.

ROTATIONS = {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}


def algebra(brackets):
    return LieAlgebra.from_brackets(3, brackets, check=False)


def unchanged(extension):
    return extension


def flip(*entries):
    """Flips the sign of those entries W[lam][mu][nu] that an extension has."""

    def changed(extension):
        W = [[list(row) for row in plane] for plane in extension.tensor]
        for lam, mu, nu in entries:
            if max(lam, mu, nu) < len(W):
                W[lam][mu][nu] = -W[lam][mu][nu]
        return Extension(W, extension.name, extension.field_names, check=False)

    return changed


MUTATIONS = {
    "cocycle": (so(3), flip(*COCYCLE)),
    "product with alpha": (so(3), flip(*ALPHA_TERM)),
    "square of l": (so(3), flip(*L_TERM)),
    "one structure constant": (algebra(ROTATIONS | {(0, 1): {2: -1}}), unchanged),
    "all signs": (algebra({pair: {k: -c for k, c in row.items()} for pair, row in ROTATIONS.items()}), unchanged),
    "a structure constant too many": (algebra(ROTATIONS | {(0, 1): {2: 1, 0: 1}}), unchanged),
}
# These use the coordinates, the Hamiltonian or the printed Casimirs of the bracket, and not the bracket itself.
NOT_ABOUT_THE_BRACKET = {
    "rotation-matrix",
    "leaf-coordinates",
    "v-perp-zero-iff-collinear",
    "angles-from-fields",
    "canonical-potential",
    "l-dot-beta-momenta",
    "matrix-lta",
    "lagrange-cyclic-psi",
    "potential-e3-e1",
    "potential-e1-e3",
    "gauge-limits",
    "nearby-integrable-case",  # not settled either way
}


def mutated(name):
    wrong, change = MUTATIONS[name]
    return Context(
        bracket=lambda epsilon: Bracket(wrong, change(leibniz(3, epsilon))),
        extended=lambda extension: Bracket(wrong, change(extension)),
    )


def verdict(claim, context):
    return BY_ID[claim].check(context).verdict


ABOUT_THE_BRACKET = [
    claim.id for claim in CLAIMS if claim.id not in NOT_ABOUT_THE_BRACKET and claim.id not in NUMERICAL
]


EXPECTED = {
    (claim, "one structure constant"): WRONG
    for claim in ("leibniz-equations", "leibniz-casimirs", "charged-casimirs", "leaf-dimension", "momentum-matrix")
}
EXPECTED |= {(claim, "a structure constant too many"): WRONG for claim in ("leibniz-jacobi", "charged-jacobi")}
EXPECTED |= {(claim, "all signs"): WRONG for claim in ("leibniz-equations", "l-dot-beta-rate", "canonical-bracket")}
EXPECTED |= {("two-field-extensions", name): WRONG for name in ("one structure constant", "product with alpha")}
EXPECTED |= {
    ("charged-phase-space", name): WRONG for name in ("one structure constant", "a structure constant too many")
}
EXPECTED |= {("never-collinear", "cocycle"): OPEN, ("charged-integrable-cases", "one structure constant"): OPEN}
EXPECTED |= {("deformation-breaks-integrability", name): OPEN for name in MUTATIONS}
EXPECTED |= {("kovalevskaya-inertia", "one structure constant"): OPEN}
"""Verdicts that are known beforehand, by claim and mutation; of the others some mutation must change the verdict."""


LONG = {"kovalevskaya-painleve", "rigorous-demonstration", "nearby-integrable-case", "charged-integrable-cases"}
"""Claims that are computed in many seconds with a wrong bracket."""


def marked(claims):
    return [pytest.param(claim, marks=pytest.mark.slow) if claim in LONG else claim for claim in claims]


@pytest.mark.parametrize("claim", marked(ABOUT_THE_BRACKET))
def test_every_claim_about_the_bracket_notices_a_wrong_one(claim, right_verdict):
    expected = {name: found for (about, name), found in EXPECTED.items() if about == claim}
    assert {name: verdict(claim, mutated(name)) for name in expected} == expected
    changed = any(found != right_verdict(claim) for found in expected.values())
    others = MUTATIONS.keys() - expected.keys()
    assert changed or any(verdict(claim, mutated(name)) != right_verdict(claim) for name in sorted(others)), (
        "no mutation changes the verdict"
    )


def test_all_verdicts_that_are_known_are_asked_for():
    assert {claim for claim, _ in EXPECTED} <= set(ABOUT_THE_BRACKET)


@pytest.mark.parametrize("claim", marked(sorted(NOT_ABOUT_THE_BRACKET)))
def test_the_other_claims_do_not_ask_for_the_bracket(claim, right_verdict):
    assert {verdict(claim, mutated(name)) for name in ("cocycle", "all signs")} == {right_verdict(claim)}
