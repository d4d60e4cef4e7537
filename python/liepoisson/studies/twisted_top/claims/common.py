"""Steps that several checks share: Poisson bracket, Casimirs, complete integrability."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from liepoisson.studies.twisted_top.claims.evidence import Evidence, show, written
from liepoisson.studies.twisted_top.claims.model import Context
from liepoisson.studies.twisted_top.claims.phase_space import (
    GENERIC_POINT,
    SymbolicTop,
    at_generic_parameters,
    symbolic_top,
)
from liepoisson.studies.twisted_top.claims.typography import typeset

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.strata import Locus, Stratum

_SUBSCRIPTS = "₁₂₃"
_CASIMIR_DEGREE = 3


def poisson_identities(context: Context, epsilon: int | str) -> Evidence:
    """Antisymmetry and the Jacobi identity of the bracket of the context."""
    evidence = Evidence()
    bracket = context.bracket(epsilon)
    proof = bracket.jacobi_certificate()
    what = f"J is antisymmetric, and the cyclic sum vanishes for all {proof.n_triples} triples of coordinates"
    evidence.proof("identity", what, proof.holds, [str(proof)], decisive=True)
    l, alpha, _ = bracket.fields.values()
    _example(evidence, bracket, (l[0], l[1], alpha[0]))
    _example(evidence, bracket, (l[0], alpha[0], alpha[1]))
    evidence.note("The cyclic sum is a derivation in each argument, so this is the Jacobi identity for all functions.")
    evidence.data = {
        "triples": proof.n_triples,
        "holds": proof.holds,
        "failures": [str(failure) for failure in proof.failures],
    }
    return evidence


def _example(evidence: Evidence, bracket: Bracket, triple: tuple[Any, Any, Any]) -> None:
    """One of the cyclic sums, written out."""
    x, y, z = triple
    terms = {(u, v, w): bracket(bracket(u, v), w) for u, v, w in ((x, y, z), (y, z, x), (z, x, y))}
    computed = [f"{{{{{show(u)}, {show(v)}}}, {show(w)}}} = {show(value)}" for (u, v, w), value in terms.items()]
    evidence.zero(f"for example the triple {show(x)}, {show(y)}, {show(z)}", sum(terms.values()), computed)


def casimir_identities(context: Context, epsilon: int | str) -> Evidence:
    """The three Casimirs as printed, their independence, the corank, and that there are no others of low degree."""
    evidence = Evidence()
    top = symbolic_top(context, epsilon=epsilon)
    for k, casimir in enumerate(top.casimirs):
        name = f"C{_SUBSCRIPTS[k]}"
        computed = [f"{name} = {written(casimir, top.bracket)}"]
        evidence.zero(f"J ∇{name} = 0", list(top.bracket.vector_field(casimir)), computed, decisive=True)
    numbers = dict.fromkeys(top.epsilon.free_symbols, 2)
    generic = context.bracket(2 if numbers else 0)
    evidence.independent(
        "rank of the differentials of the three at a rational point",
        [c.subs(numbers) for c in top.casimirs],
        generic,
        GENERIC_POINT,
    )
    what = "rank of J there, so there is no fourth independent Casimir"
    rank = evidence.rank(what, generic, GENERIC_POINT, 6)
    _all_polynomial_casimirs(evidence, top)
    evidence.data["casimirs"] = [show(c) for c in top.casimirs]
    evidence.data["rank"] = rank
    return evidence


def _all_polynomial_casimirs(evidence: Evidence, top: SymbolicTop) -> None:
    """The finder of all polynomial Casimirs gives the three and no more, for every value of the parameter."""
    report = top.bracket.casimir_report(_CASIMIR_DEGREE)
    found = report.independent == report.corank == len(report.generators) == len(top.casimirs)
    sizes = ", ".join(f"{n} of degree {degree}" for degree, n in report.dimensions.items())
    computed = [
        "generators: " + "; ".join(written(c, top.bracket) for c in report.generators),
        f"linearly independent Casimirs: {sizes}; functionally independent: {report.independent}; "
        f"corank of J: {report.corank}",
    ]
    if report.examined:
        more = ", ".join(typeset(case.condition) for case in report.exceptional) or "none"
        examined = ", ".join(map(typeset, report.examined))
        computed.append(f"special values looked at: {examined}; with more Casimirs: {more}")
    what = f"all homogeneous Casimirs of degree ≤ {_CASIMIR_DEGREE}, from the null space of J∇ on all monomials"
    evidence.proof("search", what, found and not report.exceptional, computed)
    evidence.data = {"dimensions_by_degree": {str(degree): n for degree, n in report.dimensions.items()}}


def complete_integrability(evidence: Evidence, top: SymbolicTop, integrals: dict[str, Any]) -> None:
    """State that three integrals are constant, in involution, and independent together with the Casimirs."""
    names = list(integrals)
    texts = {name: written(integral, top.bracket) for name, integral in integrals.items()}
    formulas = [f"{name} = {text}" for name, text in texts.items() if text != name]
    for formula in formulas:
        evidence.note(formula)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            evidence.zero(f"{{{first}, {second}}} = 0", top.bracket(integrals[first], integrals[second]))
    functions = at_generic_parameters((*integrals.values(), *top.casimirs), top.bracket.variables)
    what = f"rank of d({', '.join(names)}, C₁, C₂, C₃) at a rational point, with primes for the parameters"
    evidence.independent(what, functions, top.bracket, GENERIC_POINT, formulas)


def strata_steps(evidence: Evidence, bracket: Bracket, wanted: dict[Locus, int]) -> list[Stratum]:
    """State on which sets the Poisson tensor has which rank, by the Pfaffians of J.

    Args:
        evidence: Where to record it.
        bracket: The bracket.
        wanted: Rank for each locus, from the open stratum down.
    """
    from liepoisson.formula.styles import UNICODE
    from liepoisson.report.lines import Conditions

    strata = bracket.strata()
    for stratum in strata:
        casimirs = "; ".join(written(c, bracket) for c in stratum.casimirs)
        computed = [_readable(stratum.certificate), *([f"Casimirs there: {casimirs}"] if casimirs else [])]
        where = Conditions(stratum.locus, are_vectors=True).write(UNICODE)
        what = f"{where}: rank {stratum.rank} at every point"
        good = stratum.proved and wanted.get(stratum.locus) == stratum.rank
        evidence.proof("rank", what, good, computed, decisive=True)
    evidence.equal("number of strata", len(strata), len(wanted))
    return strata


def _readable(certificate: str) -> str:
    return show(certificate).replace("!=", "≠")
