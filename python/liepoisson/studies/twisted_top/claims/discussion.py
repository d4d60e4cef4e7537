"""Claims of the discussion that are settled, or partly settled, in exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks, written
from liepoisson.studies.twisted_top.claims.phase_space import (
    CENTRE_OF_MASS,
    KOVALEVSKAYA,
    SymbolicTop,
    complete_integrability,
    kovalevskaya_quartic,
    kovalevskaya_top,
    symbolic_top,
)
from liepoisson.studies.twisted_top.typography import show, typeset

AS_PRINTED = (1, 1, 2)
# Every polynomial of degree d in (l, alpha) has weight at most 2d, in (l, alpha, beta) at most 3d.
HEAVY_WEIGHT, TWISTED_WEIGHT = 10, 12
_WEIGHT = "in a monomial a component of l counts one, of α two"
_EXACT = (
    "Exact: the rank of d/dt on the monomials, taken modulo 2⁶¹ − 1, bounds the number of integrals from above, the "
    "known ones from below."
)
# Weights 1, 2, 3 of l, α, β, as many as there are fields.
_WEIGHTS = (1, 1, 1, 2, 2, 2, 3, 3, 3)
_COUNT_HEADING = ("weight", "monomials", "rank", "integrals", "known")
_FAMILY_DEGREE = 2
_DEFORMED_WEIGHT = 10
_COCYCLE_DEGREE = 4


@checks("kovalevskaya-inertia")
def kovalevskaya_inertia(evidence: Evidence, context: Context) -> None:
    """The quartic needs I1 = I2 = 2 I3; with the inertia as printed there is none."""
    from sympy import Symbol

    evidence.note(
        "The weight of a monomial counts a component of l once and one of α twice: for b = 0 the equations raise it by "
        "one, so that every polynomial integral is a sum of integrals of one weight each."
    )
    kappa = Symbol("kappa", positive=True)
    general = symbolic_top(context, inertia=(2 * kappa, 2 * kappa, kappa), a=("a1", "a2", 0), b=(0, 0, 0), epsilon=0)
    evidence.zero(
        "I = (2κ, 2κ, κ), a = (a₁, a₂, 0): Kovalevskaya's quartic K is constant",
        general.rate(kovalevskaya_quartic(general)),
        [f"K = {written(kovalevskaya_quartic(general), general.bracket)}"],
        decisive=True,
    )
    right = kovalevskaya_top(context, 0)
    counts = _heavy_counts(context, right, 4)
    what = f"I = {KOVALEVSKAYA}: integrals of weight ≤ 4 ({_WEIGHT}) beyond the polynomials in H, l·α, |α|², namely K"
    evidence.search(what, _table(counts), _excess(counts), 1)
    printed = symbolic_top(context, inertia=AS_PRINTED, a=CENTRE_OF_MASS, b=(0, 0, 0), epsilon=0)
    counts = _heavy_counts(context, printed, HEAVY_WEIGHT)
    what = f"I = {AS_PRINTED}: integrals of weight ≤ {HEAVY_WEIGHT} ({_WEIGHT}) beyond the polynomials in H, l·α, |α|²"
    evidence.search(what, _table(counts), _excess(counts), 0, decisive=True)
    evidence.note(f"A polynomial of degree ≤ 5 in (l, α) has weight ≤ 10: there is no further one. {_EXACT}")
    evidence.data = {
        "found_and_known_by_weight": [[count.n_integrals, count.n_integrals - len(count.found)] for count in counts]
    }


@checks("kovalevskaya-integrable")
def kovalevskaya_integrable(evidence: Evidence, context: Context) -> None:
    """H, K and l.alpha for the ordinary top."""
    top = symbolic_top(context, inertia=KOVALEVSKAYA, a=("a1", "a2", 0), b=(0, 0, 0), epsilon=0)
    l, alpha, _ = top.vectors
    integrals = {"H": top.hamiltonian, "l·α": l.dot(alpha), "K": kovalevskaya_quartic(top)}
    complete_integrability(evidence, top, integrals)


def _no_polynomial_integral(evidence: Evidence, context: Context) -> None:
    """State how the quartic is lost, and that no polynomial integral of low weight replaces it."""
    top = kovalevskaya_top(context, 1)
    evidence.nonzero("ε = 1: dK/dt is not zero", top.rate(kovalevskaya_quartic(top)))
    known: dict[str, Any] = dict(zip(("C₁", "C₂", "C₃"), top.casimirs, strict=True))
    counts = _counts(top.system, known, TWISTED_WEIGHT)
    evidence.search(
        f"integrals of weight ≤ {TWISTED_WEIGHT} beyond the polynomials in H, C₁, C₂, C₃ (exact; weights l 1, α 2, "
        f"β 3, in particular of degree ≤ {TWISTED_WEIGHT // 3})",
        _table(counts),
        _excess(counts),
        0,
    )


def _families(evidence: Evidence, context: Context) -> None:
    """State for which inertia and centre of mass there is a polynomial integral of low degree."""
    moments, centre = ("J1", "J2", "J3"), ("a1", "a2", "a3")
    energy = "(J1*l1^2 + J2*l2^2 + J3*l3^2)/2 + a1*alpha1 + a2*alpha2 + a3*alpha3"
    family = lp.System(context.bracket(1), energy, symbols=(*moments, *centre), name="uncharged top")
    found = lp.integrability.integrable_families(family, degree=_FAMILY_DEGREE, positive=moments)
    cases = {frozenset(map(str, case.conditions)) for case in found.cases}
    axes = ((1, 2, 3), (2, 3, 1), (3, 1, 2))
    symmetric = {frozenset((f"J{min(j, k)} - J{max(j, k)}", f"a{j}", f"a{k}")) for _, j, k in axes}
    wanted = {frozenset(("J1 - J2", "J1 - J3")), frozenset(centre), *symmetric}
    evidence.proof(
        "search",
        f"b = 0, ε = 1, any moments of inertia Iᵢ = 1/Jᵢ > 0 and any a: integrals of degree ≤ {_FAMILY_DEGREE} beyond "
        "the polynomials in H, C₁, C₂, C₃ exist for the spherical top, for symmetric tops with a on the axis and for "
        "a = 0, and in no other case",
        found.complete and cases == wanted,
        [", ".join(f"{show(c)} = 0" for c in case.conditions) for case in found.cases],
    )


def _deformations(evidence: Evidence, context: Context) -> None:
    """State that no integral of the Kovalevskaya top survives the twist, to first order."""
    top = symbolic_top(context, inertia=KOVALEVSKAYA, a=CENTRE_OF_MASS, b=(0, 0, 0))
    l, alpha, _ = top.vectors
    at_0 = kovalevskaya_top(context, 0).system
    given = {"K": kovalevskaya_quartic(top), "l·α": l.dot(alpha)}
    if all(at_0.is_constant(f) for f in given.values()):
        found = lp.integrability.deformations(
            top.system, parameter="epsilon", weight=_DEFORMED_WEIGHT, order=1, integrals=given
        )
        evidence.proof(
            "search",
            f"no F₀ + εF₁ with a polynomial F₀ in K, l·α, H and the Casimirs of ε = 0, of weight ≤ {_DEFORMED_WEIGHT}, "
            "is an integral to first order, whatever the polynomials F₁ and H₁ are with H + εH₁ for the Hamiltonian, "
            "but for polynomials in H and C₁, C₂, C₃",
            not found.integrals and found.hamiltonian_terms == () and len(found.obstructions) == found.n_starts,
            [f"{show(o.start)}: {o.n_corrections} terms of F₁" for o in found.obstructions],
        )


def _obstructions(evidence: Evidence, context: Context) -> None:
    """State of some neighbours that they are not integrable, by the differential Galois group."""
    evidence.note(
        "In what follows x is a variable in which a curve is rational, e an exponent of a local solution, g and h are "
        "monodromy matrices, 0 = F₀ ⊂ F₁ ⊂ F₂ ⊂ … is a chain of invariant subspaces, and its flag the list of the "
        "dimensions of F₁/F₀, F₂/F₁, …"
    )
    for what, inertia, a, b in (
        ("I = (2, 2, 1), a = (−1, 0, 0), b = (0, 0, 1)", KOVALEVSKAYA, CENTRE_OF_MASS, (0, 0, 1)),
        ("I = (1, 1, 1), a = (1, 0, 0), b = (0, 0, 1)", (1, 1, 1), (1, 0, 0), (0, 0, 1)),
        ("I = (2, 3, 4), a = (1, 0, 0), b = 0", (2, 3, 4), (1, 0, 0), (0, 0, 0)),
    ):
        top = symbolic_top(context, inertia=inertia, a=a, b=b, epsilon=1)
        found = lp.integrability.galois_obstruction(top.system)
        how = "exactly" if found.is_proved_exactly else "with monodromy matrices in rigorous balls"
        evidence.proof(
            "value" if found.is_proved_exactly else "enclosure",
            f"{what}, ε = 1: not Liouville integrable with meromorphic integrals, {how}",
            found.verdict == "not integrable",
            [typeset(step.text) for step in found.steps],
        )


@checks("nearby-integrable-case")
def nearby_integrable_case(evidence: Evidence, context: Context) -> None:
    """What is known here about integrable neighbours."""
    evidence.note("I = (2, 2, 1), a = (−1, 0, 0), b = 0, ε = 1:")
    _no_polynomial_integral(evidence, context)
    _families(evidence, context)
    _deformations(evidence, context)
    _obstructions(evidence, context)
    _other_cocycles(evidence, context)
    evidence.note(
        "For other parameters integrals of higher degree, and any that are not polynomial, are not examined here."
    )


def _other_cocycles(evidence: Evidence, context: Context) -> None:
    """State which brackets of l and two fields keep a further integral of the two-field Kovalevskaya top."""
    top = lp.catalog.system("twisted-two-field-kovalevskaya", {"kappa": "kappa"})
    bracket = context.extended(lp.extensions.binary_cubic(0, "kappa", 0, "kappa"))
    K, G = (top.integrals[name] for name in "KG")
    evidence.note(
        "Other cocycles: all brackets of l and two fields are so(3) ⊗ A with e₁e₁ = −ac + b e₁ − a e₂, e₁e₂ = −ad, "
        "e₂e₂ = −bd + d e₁ − c e₂, up to terms k·l in H; a = b = c = d = 0 is the charged heavy top, b = c = d = 0 the "
        "twisted top with ε = −a."
    )
    pairs = ((K, top.hamiltonian), (G, top.hamiltonian), (K, G))
    evidence.zero(
        "I = (2, 2, 1), a = (−1, 0, 0), b = (0, −1, 0), e₁e₁ = κe₁, e₁e₂ = 0, e₂e₂ = κe₁ − κ²: "
        "{K, H}, {G, H} and {K, G} vanish for every κ",
        [bracket(f, g) for f, g in pairs],
        [f"K = {written(K, bracket)}"],
    )
    one = context.extended(lp.extensions.binary_cubic(0, 1, 0, 1))
    member = lp.catalog.system("twisted-two-field-kovalevskaya", {"kappa": 1})
    functions = [member.hamiltonian, *(member.integrals[name] for name in "KG"), *one.casimirs()]
    point = [1, 2, 3, 1, 1, -1, 2, -1, 1]
    evidence.independent("κ = 1: H, K, G and the Casimirs are independent", functions, one, point)
    energy = "l1^2/4 + l2^2/4 + l3^2/2 + alpha1 + beta2 + k1*l1 + k2*l2 + k3*l3"
    general = lp.System(context.extended(lp.extensions.binary_cubic()), energy, symbols=["k1", "k2", "k3"])
    found = lp.integrability.integrable_families(general, degree=_COCYCLE_DEGREE)
    cases = {frozenset(map(str, case.conditions)) for case in found.cases}
    evidence.proof(
        "search",
        f"I = (2, 2, 1), a = (1, 0, 0), b = (0, 1, 0), any cocycle, any rotor: integrals of degree ≤ {_COCYCLE_DEGREE} "
        "beyond the polynomials in H, C₁, C₂, C₃ exist for a = c, b = d, k₁ = k₂ = 0 and in no other case",
        found.complete and cases == {frozenset(("k1", "k2", "a - c", "b - d"))},
        [", ".join(f"{show(c)} = 0" for c in case.conditions) for case in found.cases],
    )


def _table(counts: Sequence[lp.results.FirstIntegrals]) -> list[tuple[object, ...]]:
    """The sizes of the searches; products of known integrals span all integrals but those that were found."""
    rows = [
        (c.weight, c.n_monomials, c.n_monomials - c.n_integrals, c.n_integrals, c.n_integrals - len(c.found))
        for c in counts
    ]
    return [_COUNT_HEADING, *rows]


def _excess(counts: Sequence[lp.results.FirstIntegrals]) -> int:
    """How many integrals there are beyond the known ones."""
    return sum(len(count.found) for count in counts)


def _heavy_counts(context: Context, top: SymbolicTop, largest: int) -> list[lp.results.FirstIntegrals]:
    """Integrals of the heavy top (l, alpha) of the weights from one; the known ones are H, l.alpha, |alpha|^2."""
    system = lp.System(context.extended(lp.semidirect(2)).rename("l", "alpha"), top.hamiltonian)
    l, alpha = system.bracket.fields.values()
    return _counts(system, {"l·α": l.dot(alpha), "|α|²": alpha.dot(alpha)}, largest)


def _counts(system: lp.System, known: Mapping[str, Any], largest: int) -> list[lp.results.FirstIntegrals]:
    """The searches of the weights from one; what is claimed to be known is left out where it is no integral."""
    constant = {name: f for name, f in known.items() if system.is_constant(f)}
    counts = [
        lp.integrability.first_integrals(system, weight=weight, known={"H": system.hamiltonian, **constant})
        for weight in range(1, largest + 1)
    ]
    assert all(c.complete and c.weights == _WEIGHTS[: len(system.variables)] for c in counts)
    return counts
