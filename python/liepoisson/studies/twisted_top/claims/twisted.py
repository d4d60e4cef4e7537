"""Claims of the section on the twisted top: the bracket, the equations, the Casimirs, the integrable case."""

from __future__ import annotations

import re
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks
from liepoisson.studies.twisted_top.claims.phase_space import (
    column,
    complete_integrability,
    lagrange_top,
    poisson_map_residual,
    substitution,
    symbolic_top,
)

_UNIT = {(0, 0): {0: 1}, (0, 1): {1: 1}}
# Two-dimensional commutative algebras: the nonzero products e_mu e_nu in words and as data, and what should be found:
# the name of the normal form; of so(3) (x) A the numbers of positive and negative eigenvalues of the Killing form, and
# the dimension of the derived algebra.
_TWO_FIELDS: tuple[tuple[str, dict[tuple[int, int], dict[int, int]], str, tuple[int, int], int], ...] = (
    ("e₀ the unit, e₁e₁ = 0 (semidirect)", _UNIT, "R[x]/(x^2)", (0, 3), 6),
    ("e₀ the unit, e₁e₁ = e₀", _UNIT | {(1, 1): {0: 1}}, "R + R", (0, 6), 6),
    ("e₀ the unit, e₁e₁ = −e₀", _UNIT | {(1, 1): {0: -1}}, "C", (3, 3), 6),
    ("no unit, e₀e₀ = e₁ ([l, l] → α only)", {(0, 0): {1: 1}}, "maximal ideal of R[x]/(x^3)", (0, 0), 3),
    ("no unit, e₀e₀ = e₀, α inert", {(0, 0): {0: 1}}, "R + maximal ideal of R[x]/(x^2)", (0, 3), 3),
)


@checks("two-field-extensions")
def two_field_extensions(evidence: Evidence, context: Context) -> None:
    """All two-dimensional commutative algebras with unit, and some without, beside the semidirect one."""
    _square_completed(evidence)
    for name, products, *wanted in _TWO_FIELDS:
        extension = lp.Extension.from_products(2, products, name)
        bracket = context.extended(extension)
        proof = bracket.jacobi_certificate()
        form, killing, derived = extension.classify().name, _killing_signature(bracket), _derived_dimension(bracket)
        found = proof.holds and [form, killing, derived] == wanted
        computed = (
            f"A = {_blackboard(form)}; {proof}",
            f"so(3) ⊗ A: Killing form with {killing[0]} positive and {killing[1]} negative eigenvalues, derived "
            f"algebra of dimension {derived}",
        )
        evidence.proof("value", name, found, computed, decisive=wanted[0] != "R[x]/(x^2)")
        evidence.data[name] = {"normal_form": form, "killing_signature": list(killing), "derived": derived}
    evidence.note("The Killing form and the dimension of the derived algebra tell all five Lie algebras apart.")
    evidence.note("If A has a unit and e₁ is nilpotent, e₁e₁ = c e₁ gives e₁ⁿ = cⁿ⁻¹e₁ = 0, so c = 0: semidirect.")


def _blackboard(form: str) -> str:
    """The name of an algebra with the usual letters for real and complex numbers."""
    text = re.sub(r"\bR\b", "ℝ", re.sub(r"\bC\b", "ℂ", form))
    return text.replace("^2", "²").replace("^3", "³")


def _square_completed(evidence: Evidence) -> None:
    """With a unit e0, the square of e1 - p/2 is a number: three algebras, by its sign."""
    from sympy import Symbol

    p, q = Symbol("p"), Symbol("q")
    general = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: q, 1: p}}, "A")
    W = general.tensor
    t = (-p / 2, 1)
    square = [sum(W[k][m][n] * t[m] * t[n] for m in range(2) for n in range(2)) for k in range(2)]
    evidence.zero(
        "e₀ the unit, e₁e₁ = q e₀ + p e₁ in general: t = e₁ − p/2 has t² = (q + p²/4) e₀, so after scaling t there "
        "are three algebras, t² = 0, t² = e₀, t² = −e₀",
        [square[0] - (q + p**2 / 4), square[1]],
    )


def _structure(bracket: lp.Bracket) -> list[list[list[Any]]]:
    """The structure constants of the Lie algebra, from the linear Poisson tensor, J_ij = -c_ij^k x_k."""
    J: Any = bracket.poisson_tensor()
    n = range(bracket.dimension)
    return [[[-J[i, j].diff(x) for x in bracket.variables] for j in n] for i in n]


def _killing_signature(bracket: lp.Bracket) -> tuple[int, int]:
    """The numbers of positive and negative eigenvalues of the Killing form, K(x, y) = tr(ad x ad y)."""
    from sympy import Matrix

    c, n = _structure(bracket), range(bracket.dimension)
    form: Any = Matrix([[sum(c[i][m][k] * c[j][k][m] for m in n for k in n) for j in n] for i in n])
    eigenvalues: dict[Any, int] = form.eigenvals()
    positive, negative = (sum(m for v, m in eigenvalues.items() if sign * v > 0) for sign in (1, -1))
    return positive, negative


def _derived_dimension(bracket: lp.Bracket) -> int:
    """The dimension of the span of all brackets of the Lie algebra."""
    from sympy import Matrix

    return int(Matrix([row for plane in _structure(bracket) for row in plane]).rank())


@checks("leibniz-not-semidirect")
def not_semidirect(evidence: Evidence, context: Context) -> None:
    """The cocycle cannot be removed: the fields alpha, beta do not span an abelian ideal."""
    from sympy import Symbol

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


@checks("epsilon-measures-deviation")
def epsilon_is_a_scale(evidence: Evidence, context: Context) -> None:
    """All brackets with epsilon not zero are isomorphic."""
    from sympy import Symbol

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


@checks("leibniz-equations")
def equations(evidence: Evidence, context: Context) -> None:
    """The three vector equations, derived from the bracket."""
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    torque = l.cross(top.omega) + alpha.cross(top.a) + beta.cross(top.b)
    evidence.zero("{l, H} = l × ω + α × a + β × b", top.rate(l) - torque)
    evidence.zero(
        "{α, H} = α × ω + ε β × a", top.rate(alpha) - alpha.cross(top.omega) - top.epsilon * beta.cross(top.a)
    )
    evidence.zero("{β, H} = β × ω", top.rate(beta) - beta.cross(top.omega))
    found = lp.inspect(top.system).record()["equations"].get("vector") or ()
    rows = [row["unicode"].partition(" = ")[2].replace("-", "−") for row in found]
    computed = [f"d{name}/dt = {row}" for name, row in zip("lαβ", rows, strict=False)]
    evidence.proof("identity", "derived from the bracket and H, in vector notation", bool(computed), computed)
    evidence.note("All components, with symbolic I, a, b, ε.")


@checks("alpha-not-rigid")
def alpha_not_rigid(evidence: Evidence, context: Context) -> None:
    """The length of alpha changes, its projection on beta does not."""
    top = symbolic_top(context)
    _, alpha, beta = top.vectors
    growth = top.rate(alpha.dot(alpha))
    evidence.zero("d|β|²/dt = 0", top.rate(beta.dot(beta)))
    evidence.zero("d(α·β)/dt = 0, so the projection α·β/|β| is constant where β ≠ 0", top.rate(alpha.dot(beta)))
    evidence.identity("d|α|²/dt = 2ε a·(α × β)", growth, 2 * top.epsilon * top.a.dot(alpha.cross(beta)), top.bracket)
    evidence.nonzero("which is not zero in general: α does not turn rigidly when ε ≠ 0 and a ≠ 0", growth)


@checks("bounded-energy-surfaces")
def bounded(evidence: Evidence, context: Context) -> None:
    """Joint level sets of H and the Casimirs are bounded, those of H alone are not."""
    from sympy import Matrix, Symbol, symbols

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


@checks("twisted-lagrange-p")
def p_constant(evidence: Evidence, context: Context) -> None:
    """P is constant, and each displayed line of its derivation equals the one before."""
    top = lagrange_top(context)
    l, alpha, beta = top.vectors
    inertia, a3, epsilon, omega = top.inertia[0], top.a[2], top.epsilon, top.omega
    P = l.dot(alpha) + epsilon * inertia * a3 * beta[2]
    first = top.rate(l).dot(alpha) + l.dot(top.rate(alpha)) + epsilon * inertia * a3 * top.rate(beta)[2]
    second = (
        l.cross(omega).dot(alpha)
        + l.dot(alpha.cross(omega) + epsilon * beta.cross(top.a))
        + epsilon * inertia * a3 * beta.cross(omega)[2]
    )
    third = epsilon * top.a.dot(l.cross(beta)) + epsilon * top.a.dot(beta.cross(inertia * omega))
    evidence.zero("dP/dt = (dl/dt)·α + l·(dα/dt) + ε I₁a₃ dβ₃/dt", top.rate(P) - first)
    evidence.zero("= (l × ω)·α + l·(α × ω + ε β × a) + ε I₁a₃ (β × ω)₃", first - second)
    evidence.zero("= ε a·(l × β) + ε a·(β × I₁ω)", second - third)
    evidence.zero("= 0", third)
    evidence.zero("P = l·α for ε = 0, the integral of the Lagrange top", P.subs(epsilon, 0) - l.dot(alpha))


@checks("twisted-lagrange-involution")
def involution(evidence: Evidence, context: Context) -> None:
    """H, l3 and P commute and are independent: complete integrability on generic leaves."""
    top = lagrange_top(context)
    l, alpha, beta = top.vectors
    P = l.dot(alpha) + top.epsilon * top.inertia[0] * top.a[2] * beta[2]
    complete_integrability(evidence, top, {"H": top.hamiltonian, "l₃": l[2], "P": P})
    evidence.note("Three independent integrals in involution on six-dimensional leaves: completely integrable there.")


@checks("twisted-lagrange-uncharged")
def charged_case(evidence: Evidence, context: Context) -> None:
    """The charged twisted Lagrange top is integrable too, being the image of the uncharged one."""
    top = lagrange_top(context, charged=True)
    l, alpha, beta = top.vectors
    a3, b3, epsilon, inertia = top.a[2], top.b[2], top.epsilon, top.inertia[0]
    P = l.dot(a3 * alpha + b3 * beta) + epsilon * a3**2 * inertia * beta[2]
    evidence.identity("dP′/dt = 0 for P′ = l·(a₃α + b₃β) + εa₃²I₁β₃", top.rate(P), 0 * P, top.bracket, decisive=True)
    complete_integrability(evidence, top, {"H": top.hamiltonian, "l₃": l[2], "P′": P})
    uncharged = lagrange_top(context)
    image = substitution(alpha, alpha + b3 / a3 * beta)
    evidence.zero(
        "H is the uncharged H after α → α + (b₃/a₃)β, which preserves the bracket",
        uncharged.hamiltonian.subs(image, simultaneous=True) - top.hamiltonian,
    )
