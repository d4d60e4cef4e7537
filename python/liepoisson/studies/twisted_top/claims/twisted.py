"""Claims of the section on the twisted top: the bracket, the equations, the Casimirs, boundedness."""

from __future__ import annotations

from typing import Any

from liepoisson.exact.extension import Extension
from liepoisson.exact.lie_algebra import so
from liepoisson.studies.twisted_top.claims.common import casimir_identities, poisson_identities
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import column, poisson_map_residual, substitution, symbolic_top


def two_field_extensions(context: Context) -> Verdict:
    """Two-dimensional commutative algebras beside the semidirect one."""
    del context  # about two fields; the bracket of three fields is not concerned
    from sympy import Matrix

    evidence = Evidence()
    evidence.note("e₀ is the unit of A, e₁e₁ = p e₁ + q e₀; the Lie algebra is so(3) ⊗ A with Killing form K.")
    signatures: dict[str, list[int]] = {}
    for name, p, q, wanted in (
        ("semidirect, e₁e₁ = 0", 0, 0, [0, 3]),
        ("R × R, e₁e₁ = e₁ (so(4))", 1, 0, [0, 6]),
        ("C, e₁e₁ = −e₀ (so(3,1))", 0, -1, [3, 3]),
    ):
        extension = Extension([[[1, 0], [0, q]], [[0, 1], [1, p]]])
        bracket = so(3) @ extension
        evidence.zero(f"{name}: Jacobi identity", list(bracket.jacobi_residuals().values()))
        form: Any = Matrix(_killing_form(bracket))
        eigenvalues: dict[Any, int] = form.eigenvals()
        counts = [sum(m for v, m in eigenvalues.items() if v > 0), sum(m for v, m in eigenvalues.items() if v < 0)]
        evidence.equal(f"{name}: positive and negative eigenvalues of K", counts, wanted)
        signatures[name] = counts
    W = [[[0, 0], [0, 0]], [[1, 0], [0, 0]]]
    without_unit = so(3) @ Extension(W)
    evidence.zero(
        "without unit, e₀e₀ = e₁ ([l, l] → α only): Jacobi identity", list(without_unit.jacobi_residuals().values())
    )
    form = Matrix(_killing_form(without_unit))
    evidence.zero("without unit: the Killing form K vanishes", form)
    evidence.note("K is invariant under isomorphism, so none of these is the semidirect product.")
    evidence.note("If A has a unit and e₁ is nilpotent, e₁e₁ = c e₁ gives e₁ⁿ = cⁿ⁻¹e₁ = 0, so c = 0: semidirect.")
    evidence.data = {"killing_signatures": signatures}
    return evidence.conclude(
        "holds with a condition",
        "True when the algebra of the two fields has a unit (l acts on both fields) and the second field is nilpotent. "
        "Otherwise there are also so(4) = so(3) ⊗ (R × R), so(3,1) = so(3) ⊗ C, and algebras without unit.",
    )


def _killing_form(bracket: Any) -> list[list[Any]]:
    """K(x, y) = tr(ad x ad y) from the linear Poisson tensor, J_ij = -c_ij^k x_k."""
    J, x = bracket.poisson_tensor(), bracket.variables
    n = len(x)
    c = [[[-J[i, j].coeff(x[k]) for k in range(n)] for j in range(n)] for i in range(n)]
    return [[sum(c[i][m][k] * c[j][k][m] for m in range(n) for k in range(n)) for j in range(n)] for i in range(n)]


def not_semidirect(context: Context) -> Verdict:
    """The cocycle can not be removed: the fields alpha, beta do not span an abelian ideal."""
    from sympy import Symbol

    evidence = Evidence()
    twisted, charged = context.bracket("epsilon"), context.bracket(0)
    _, alpha, beta = twisted.fields.values()
    inner = [twisted(alpha[i], alpha[(i + 1) % 3]) + Symbol("epsilon") * beta[(i + 2) % 3] for i in range(3)]
    evidence.zero("{α₁, α₂} = −ε β₃ and cyclic, for the Leibniz bracket", inner)
    flat = [charged(u, v) for u in (*alpha, *beta) for v in (*alpha, *beta)]
    evidence.zero("all brackets among α and β vanish for ε = 0", flat)
    evidence.note(
        "The ideal spanned by α, β is the radical of the Lie algebra, whatever the coordinates: for ε ≠ 0 it is"
    )
    evidence.note("not abelian, so no linear change of coordinates turns the bracket into the semidirect one.")
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
    evidence.note("All components, with symbolic I, a, b, ε.")
    return evidence.conclude("holds")


def alpha_not_rigid(context: Context) -> Verdict:
    """The length of alpha changes, its projection on beta does not."""
    evidence = Evidence()
    top = symbolic_top(context)
    _, alpha, beta = top.vectors
    growth = top.rate(alpha.dot(alpha))
    evidence.zero("d|β|²/dt = 0", top.rate(beta.dot(beta)))
    evidence.zero("d(α·β)/dt = 0, so the projection α·β/|β| is constant where β ≠ 0", top.rate(alpha.dot(beta)))
    evidence.zero("d|α|²/dt = 2ε a·(α × β)", growth - 2 * top.epsilon * top.a.dot(alpha.cross(beta)))
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
    evidence.zero("l·I⁻¹l − |l|²/Imax = Σ lᵢ² (Imax − Iᵢ)/(Iᵢ Imax) ≥ 0", excess - exact)
    evidence.note(
        "With w² = C₃: |l|²/(2Imax) ≤ H − a·α − b·β ≤ H + |b|w + |a| √(|C₁| + 2|ε| w |l|), and the right-hand"
    )
    evidence.note("side grows only like |l|^½: l is bounded, hence α, and |β| = w.")
    s, c = Symbol("s"), Matrix(symbols("c1:4"))
    far = substitution((*l, *alpha, *beta), (0, 0, 0, *(s * top.a.cross(c)), 0, 0, 0))
    evidence.zero("the points l = β = 0, α = s a × c have H = 0 for every s and c", top.hamiltonian.subs(far))
    evidence.note("(take c not parallel to a; for a = 0 any α will do).")
    return evidence.conclude(
        "holds with a condition",
        "The joint level sets of H and the three Casimirs are bounded (I > 0): with w² = C₃, |l|²/(2Imax) ≤ H + |b|w + "
        "|a| √(|C₁| + 2|ε| w |l|). The level sets of H alone are not.",
    )


_TWISTED = "Section 3, The twisted top"

CLAIMS: tuple[Claim, ...] = (
    Claim(
        "two-field-extensions",
        f"{_TWISTED}, first paragraph",
        "The only extension of the bracket to two field variables is the semidirect product.",
        two_field_extensions,
    ),
    Claim(
        "leibniz-not-semidirect",
        f"{_TWISTED}, first paragraph",
        "With three fields there is an extension that is not semidirect, the Leibniz bracket.",
        not_semidirect,
    ),
    Claim(
        "leibniz-jacobi",
        f"{_TWISTED}, equation of the bracket",
        "The Leibniz bracket is a Poisson bracket.",
        leibniz_jacobi,
    ),
    Claim(
        "epsilon-measures-deviation",
        f"{_TWISTED}, after the equation of the bracket",
        "ε measures the deviation from the semidirect bracket and need not be small.",
        epsilon_is_a_scale,
    ),
    Claim(
        "leibniz-equations",
        f"{_TWISTED}, equations of motion",
        "The equations are dl/dt = l × ω + α × a + β × b, dα/dt = α × ω + ε β × a, dβ/dt = β × ω.",
        equations,
    ),
    Claim(
        "leibniz-casimirs",
        f"{_TWISTED}, equation of the Casimirs",
        "The Casimirs of the Leibniz bracket are |α|² + 2ε l·β, α·β and |β|².",
        leibniz_casimirs,
    ),
    Claim(
        "alpha-not-rigid",
        f"{_TWISTED}, before and after the Casimirs",
        "α does not turn rigidly, its length is not constant, but its projection on β is; β does turn rigidly.",
        alpha_not_rigid,
    ),
    Claim(
        "bounded-energy-surfaces",
        f"{_TWISTED}, paragraph on boundedness",
        "For a positive definite inertia tensor the energy surfaces of the twisted top are bounded.",
        bounded,
    ),
)
