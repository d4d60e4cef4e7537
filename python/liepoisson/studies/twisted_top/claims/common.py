"""Steps that several checks share: Poisson bracket, Casimirs, complete integrability."""

from __future__ import annotations

from typing import Any

from liepoisson.studies.twisted_top.claims.evidence import Evidence, show
from liepoisson.studies.twisted_top.claims.model import Context
from liepoisson.studies.twisted_top.claims.phase_space import (
    GENERIC_POINT,
    SymbolicTop,
    at_generic_parameters,
    gradient_rank,
    rank_at,
    symbolic_top,
)


def poisson_identities(context: Context, epsilon: int | str) -> Evidence:
    """Antisymmetry and the Jacobi identity of the bracket of the context."""
    evidence = Evidence()
    bracket = context.bracket(epsilon)
    J = bracket.poisson_tensor()
    evidence.zero("J is antisymmetric", J + J.T)
    residuals = list(bracket.jacobi_residuals().values())
    evidence.zero(f"the cyclic sum vanishes for all {len(residuals)} triples of coordinates", residuals)
    evidence.note("The cyclic sum is a derivation in each argument, so this is the Jacobi identity for all functions.")
    evidence.data = {"triples": len(residuals), "nonzero": sum(value != 0 for value in residuals)}
    return evidence


def casimir_identities(context: Context, epsilon: int | str) -> Evidence:
    """The three Casimirs as printed, their independence, and the corank."""
    evidence = Evidence()
    top = symbolic_top(context, epsilon=epsilon)
    for k, casimir in enumerate(top.casimirs):
        evidence.zero(f"J ∇C{'₁₂₃'[k]} = 0", list(top.bracket.vector_field(casimir)))
    numbers = dict.fromkeys(top.epsilon.free_symbols, 2)
    independent = gradient_rank((c.subs(numbers) for c in top.casimirs), top.bracket.variables, GENERIC_POINT)
    evidence.equal("rank of the three differentials at a rational point", independent, 3)
    generic = context.bracket(2 if numbers else 0)
    rank = rank_at(generic, GENERIC_POINT)
    evidence.equal("rank of J there, so there is no fourth independent Casimir", rank, 6)
    evidence.data = {"casimirs": [show(c) for c in top.casimirs], "rank": rank}
    return evidence


def complete_integrability(evidence: Evidence, top: SymbolicTop, integrals: dict[str, Any]) -> None:
    """State that three integrals are constant, in involution, and independent together with the Casimirs."""
    names = list(integrals)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            evidence.zero(f"{{{first}, {second}}} = 0", top.bracket(integrals[first], integrals[second]))
    functions = at_generic_parameters((*integrals.values(), *top.casimirs), top.bracket.variables)
    rank = gradient_rank(functions, top.bracket.variables, GENERIC_POINT)
    evidence.equal(f"rank of d({', '.join(names)}, C₁, C₂, C₃) at a rational point", rank, 6)
