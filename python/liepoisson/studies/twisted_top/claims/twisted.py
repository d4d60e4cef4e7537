"""Claims of the section on the twisted top: the bracket, the equations, the Casimirs, boundedness."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liepoisson.structure.extension import Extension
from liepoisson.studies.twisted_top.claims.common import casimir_identities, poisson_identities
from liepoisson.studies.twisted_top.claims.evidence import Evidence, show
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import (
    SymbolicTop,
    column,
    poisson_map_residual,
    substitution,
    symbolic_top,
)

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket


@dataclass(frozen=True)
class _TwoFields:
    """A two-dimensional commutative algebra and what should be found for it.

    Attributes:
        name: Its products in words.
        products: The nonzero products e_mu e_nu.
        normal_form: What the classification calls it.
        killing: Positive and negative eigenvalues of the Killing form of so(3) (x) A.
        derived: Dimension of the derived algebra of so(3) (x) A.
    """

    name: str
    products: dict[tuple[int, int], dict[int, int]]
    normal_form: str
    killing: tuple[int, int]
    derived: int


_UNIT = {(0, 0): {0: 1}, (0, 1): {1: 1}}
_TWO_FIELDS = (
    _TwoFields("e₀ the unit, e₁e₁ = 0 (semidirect)", _UNIT, "R[x]/(x^2)", (0, 3), 6),
    _TwoFields("e₀ the unit, e₁e₁ = e₀", _UNIT | {(1, 1): {0: 1}}, "R + R", (0, 6), 6),
    _TwoFields("e₀ the unit, e₁e₁ = −e₀", _UNIT | {(1, 1): {0: -1}}, "C", (3, 3), 6),
    _TwoFields("no unit, e₀e₀ = e₁ ([l, l] → α only)", {(0, 0): {1: 1}}, "maximal ideal of R[x]/(x^3)", (0, 0), 3),
    _TwoFields("no unit, e₀e₀ = e₀, α inert", {(0, 0): {0: 1}}, "R + maximal ideal of R[x]/(x^2)", (0, 3), 3),
)


def two_field_extensions(context: Context) -> Verdict:
    """All two-dimensional commutative algebras with unit, and some without, beside the semidirect one."""
    evidence = Evidence()
    _square_completed(evidence)
    for case in _TWO_FIELDS:
        extension = Extension.from_products(2, case.products, case.name)
        bracket = context.extended(extension)
        proof = bracket.jacobi_certificate()
        form, killing, derived = extension.classify().name, _killing_signature(bracket), _derived_dimension(bracket)
        found = proof.holds and (form, killing, derived) == (case.normal_form, case.killing, case.derived)
        computed = (
            f"A = {_blackboard(form)}; {proof}",
            f"so(3) ⊗ A: Killing form with {killing[0]} positive and {killing[1]} negative eigenvalues, derived "
            f"algebra of dimension {derived}",
        )
        evidence.proof("value", case.name, found, computed, decisive=case.normal_form != "R[x]/(x^2)")
        evidence.data[case.name] = {"normal_form": form, "killing_signature": list(killing), "derived": derived}
    evidence.note("The Killing form and the dimension of the derived algebra tell all five Lie algebras apart.")
    evidence.note("If A has a unit and e₁ is nilpotent, e₁e₁ = c e₁ gives e₁ⁿ = cⁿ⁻¹e₁ = 0, so c = 0: semidirect.")
    return evidence.conclude(
        "holds with a condition",
        "True when the algebra of the two fields has a unit (l acts on both fields) and the second field is nilpotent. "
        "Otherwise there are also so(4) = so(3) ⊗ (ℝ × ℝ), so(3,1) = so(3) ⊗ ℂ, and algebras without unit.",
    )


def _blackboard(form: str) -> str:
    """The name of an algebra with the usual letters for real and complex numbers."""
    text = re.sub(r"\bR\b", "ℝ", re.sub(r"\bC\b", "ℂ", form))
    return text.replace("^2", "²").replace("^3", "³")


def _square_completed(evidence: Evidence) -> None:
    """With a unit e0, the square of e1 - p/2 is a number: three algebras, by its sign."""
    from sympy import Symbol

    p, q = Symbol("p"), Symbol("q")
    general = Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: q, 1: p}}, "A")
    W = general.tensor
    t = (-p / 2, 1)
    square = [sum(W[k][m][n] * t[m] * t[n] for m in range(2) for n in range(2)) for k in range(2)]
    evidence.zero(
        "e₀ the unit, e₁e₁ = q e₀ + p e₁ in general: t = e₁ − p/2 has t² = (q + p²/4) e₀, so after scaling t there "
        "are three algebras, t² = 0, t² = e₀, t² = −e₀",
        [square[0] - (q + p**2 / 4), square[1]],
    )


def _structure(bracket: Bracket) -> list[list[list[Any]]]:
    """The structure constants of the Lie algebra, from the linear Poisson tensor, J_ij = -c_ij^k x_k."""
    from liepoisson.algebra.exact_numbers import to_sympy

    n = bracket.dimension
    c: list[list[list[Any]]] = [[[0] * n for _ in range(n)] for _ in range(n)]
    for i, j, k, value in bracket.entries():
        c[i][j][k], c[j][i][k] = -to_sympy(value), to_sympy(value)
    return c


def _killing_signature(bracket: Bracket) -> tuple[int, int]:
    """The numbers of positive and negative eigenvalues of the Killing form, K(x, y) = tr(ad x ad y)."""
    from sympy import Matrix

    c, n = _structure(bracket), range(bracket.dimension)
    form: Any = Matrix([[sum(c[i][m][k] * c[j][k][m] for m in n for k in n) for j in n] for i in n])
    eigenvalues: dict[Any, int] = form.eigenvals()
    positive, negative = (sum(m for v, m in eigenvalues.items() if sign * v > 0) for sign in (1, -1))
    return positive, negative


def _derived_dimension(bracket: Bracket) -> int:
    """The dimension of the span of all brackets of the Lie algebra."""
    from sympy import Matrix

    return int(Matrix([row for plane in _structure(bracket) for row in plane]).rank())


def not_semidirect(context: Context) -> Verdict:
    """The cocycle cannot be removed: the fields alpha, beta do not span an abelian ideal."""
    from sympy import Symbol

    evidence = Evidence()
    twisted, charged = context.bracket("epsilon"), context.bracket(0)
    _, alpha, beta = twisted.fields.values()
    inner = [twisted(alpha[i], alpha[(i + 1) % 3]) + Symbol("epsilon") * beta[(i + 2) % 3] for i in range(3)]
    evidence.zero("{α₁, α₂} = −ε β₃ and cyclic, for the Leibniz bracket", inner)
    flat = [charged(u, v) for u in (*alpha, *beta) for v in (*alpha, *beta)]
    evidence.zero("all brackets among α and β vanish for ε = 0", flat)
    evidence.note(
        "The ideal spanned by α, β is the radical of the Lie algebra, whatever the coordinates: for ε ≠ 0 it is not "
        "abelian, so no linear change of coordinates turns the bracket into the semidirect one."
    )
    evidence.nonzero("{α₁, α₂} ≠ 0 for ε ≠ 0", twisted(alpha[0], alpha[1]))
    return evidence.conclude("holds")


def epsilon_is_a_scale(context: Context) -> Verdict:
    """All brackets with epsilon not zero are isomorphic."""
    from sympy import Symbol

    evidence = Evidence()
    twisted = context.bracket("epsilon")
    l, alpha, beta = twisted.fields.values()
    evidence.zero(
        "(l, α, β) → (l, α, εβ) maps the bracket with ε to the one with ε = 1",
        poisson_map_residual(twisted, column(*l, *alpha, *(Symbol("epsilon") * beta)), context.bracket(1)),
    )
    evidence.zero(
        "(l, α, β) → (l, α + dβ, β) preserves the bracket for every d",
        poisson_map_residual(twisted, column(*l, *(alpha + Symbol("d") * beta), *beta), twisted),
    )
    return evidence.conclude(
        "holds with a condition",
        "ε = 0 and ε ≠ 0 differ, but the size of ε ≠ 0 is only a scale of β: ε = 1 without loss of generality, with "
        "b/ε in place of b. A centre of charge b parallel to a ≠ 0 can be removed by α → α + dβ.",
    )


def leibniz_jacobi(context: Context) -> Verdict:
    """Antisymmetry and the 84 Jacobi identities for symbolic epsilon."""
    return poisson_identities(context, "epsilon").conclude("holds")


def leibniz_casimirs(context: Context) -> Verdict:
    """The three Casimirs of the Leibniz bracket, and no more."""
    return casimir_identities(context, "epsilon").conclude("holds")


def equations(context: Context) -> Verdict:
    """The three vector equations, derived from the bracket."""
    evidence = Evidence()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    torque = l.cross(top.omega) + alpha.cross(top.a) + beta.cross(top.b)
    evidence.zero("{l, H} = l × ω + α × a + β × b", top.rate(l) - torque)
    evidence.zero(
        "{α, H} = α × ω + ε β × a", top.rate(alpha) - alpha.cross(top.omega) - top.epsilon * beta.cross(top.a)
    )
    evidence.zero("{β, H} = β × ω", top.rate(beta) - beta.cross(top.omega))
    _in_vector_notation(evidence, top)
    evidence.note("All components, with symbolic I, a, b, ε.")
    return evidence.conclude("holds")


def _in_vector_notation(evidence: Evidence, top: SymbolicTop) -> None:
    """The equations as the library derives and prints them."""
    from liepoisson.report.vector_equations import vector_equations

    found = vector_equations(top.bracket, top.hamiltonian)
    rows = found.rows if found is not None else ()
    computed = [f"d{show(field)}/dt = {row.unicode.replace('-', '−')}" for field, row in rows]
    evidence.proof("identity", "derived from the bracket and H, in vector notation", bool(computed), computed)


def alpha_not_rigid(context: Context) -> Verdict:
    """The length of alpha changes, its projection on beta does not."""
    evidence = Evidence()
    top = symbolic_top(context)
    _, alpha, beta = top.vectors
    growth = top.rate(alpha.dot(alpha))
    evidence.zero("d|β|²/dt = 0", top.rate(beta.dot(beta)))
    evidence.zero("d(α·β)/dt = 0, so the projection α·β/|β| is constant where β ≠ 0", top.rate(alpha.dot(beta)))
    evidence.identity("d|α|²/dt = 2ε a·(α × β)", growth, 2 * top.epsilon * top.a.dot(alpha.cross(beta)), top.bracket)
    evidence.nonzero("which is not zero in general: α does not turn rigidly when ε ≠ 0 and a ≠ 0", growth)
    return evidence.conclude("holds")


def bounded(context: Context) -> Verdict:
    """Joint level sets of H and the Casimirs are bounded, those of H alone are not."""
    from sympy import Matrix, Symbol, symbols

    evidence = Evidence()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    C1, _, _ = top.casimirs
    for name, casimir in zip(("C₁", "C₂", "C₃"), top.casimirs, strict=True):
        evidence.zero(f"d{name}/dt = 0", top.rate(casimir))
    evidence.zero("|α|² = C₁ − 2ε l·β", alpha.dot(alpha) - C1 + 2 * top.epsilon * l.dot(beta))
    evidence.zero(
        "|u|²|v|² − (u·v)² = |u × v|² ≥ 0 (for u = l, v = β; likewise for a, α and b, β)",
        l.dot(l) * beta.dot(beta) - l.dot(beta) ** 2 - l.cross(beta).dot(l.cross(beta)),
    )
    gaps = symbols("g1:4", nonnegative=True)
    largest = Symbol("Imax", positive=True)
    moments = [largest - gap for gap in gaps]
    excess = sum(x**2 / moment for x, moment in zip(l, moments, strict=True)) - l.dot(l) / largest
    exact = sum(x**2 * gap / (moment * largest) for x, moment, gap in zip(l, moments, gaps, strict=True))
    evidence.zero("l·I⁻¹l − |l|²/I_max = Σ lᵢ² (I_max − Iᵢ)/(Iᵢ I_max) ≥ 0", excess - exact)
    evidence.note(
        "With w² = C₃ and I_max the largest moment of inertia: |l|²/(2 I_max) ≤ H − a·α − b·β ≤ H + |b|w + |a| "
        "√(|C₁| + 2|ε| w |l|), and the right-hand side "
        "grows only like |l|^½: l is bounded, hence α, and |β| = w."
    )
    s, c = Symbol("s"), Matrix(symbols("c1:4"))
    far = substitution((*l, *alpha, *beta), (0, 0, 0, *(s * top.a.cross(c)), 0, 0, 0))
    evidence.zero(
        "without them it is not: the points l = β = 0, α = s a × c have H = 0 for every s and c (take c not parallel "
        "to a; for a = 0 any α will do)",
        top.hamiltonian.subs(far),
        decisive=True,
    )
    return evidence.conclude(
        "holds with a condition",
        "The joint level sets of H and the three Casimirs are bounded (all moments of inertia positive): "
        "|l|²/(2 I_max) ≤ H + |b|w + |a| √(|C₁| + 2|ε| w |l|), where w² = C₃ and I_max is the largest moment. The "
        "level sets of H alone are not.",
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "two-field-extensions",
        "Section 3, The Twisted Top, first paragraph",
        "The only extension of the bracket to two field variables is the semidirect product.",
        two_field_extensions,
        words="the only bracket extension of two field variables (such as l and α) is of the semidirect product type",
    ),
    Claim(
        "leibniz-not-semidirect",
        "Section 3, The Twisted Top, first paragraph",
        "With three fields there is an extension that is not semidirect, the Leibniz bracket.",
        not_semidirect,
        words="To obtain an extension that is not semidirect, one requires at least three variables",
    ),
    Claim(
        "leibniz-jacobi",
        "Section 3, The Twisted Top, equation (3)",
        "The Leibniz bracket is a Poisson bracket.",
        leibniz_jacobi,
    ),
    Claim(
        "epsilon-measures-deviation",
        "Section 3, The Twisted Top, after equation (3)",
        "ε measures the deviation from the semidirect bracket and need not be small.",
        epsilon_is_a_scale,
        words="ε is a parameter measuring the deviation from a semidirect bracket and is not necessarily small",
    ),
    Claim(
        "leibniz-equations",
        "Section 3, The Twisted Top, equations (4) to (6)",
        "The equations are dl/dt = l × ω + α × a + β × b, dα/dt = α × ω + ε β × a, dβ/dt = β × ω.",
        equations,
    ),
    Claim(
        "leibniz-casimirs",
        "Section 3, The Twisted Top, equation (7)",
        "The Casimirs of the Leibniz bracket are |α|² + 2ε l·β, α·β and |β|².",
        leibniz_casimirs,
    ),
    Claim(
        "alpha-not-rigid",
        "Section 3, The Twisted Top, before and after equation (7)",
        "α does not turn rigidly, its length is not constant, but its projection on β is; β does turn rigidly.",
        alpha_not_rigid,
        words="α does not simply rotate rigidly (though β still does)",
    ),
    Claim(
        "bounded-energy-surfaces",
        "Section 3, The Twisted Top, second paragraph",
        "For a positive definite inertia tensor the energy surfaces of the twisted top are bounded.",
        bounded,
        words="the energy surfaces of the twisted top are bounded",
    ),
)
