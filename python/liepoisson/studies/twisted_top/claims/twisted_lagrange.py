"""Claims on the integrable case: the twisted Lagrange top."""

from __future__ import annotations

from liepoisson.studies.twisted_top.claims.common import complete_integrability
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import lagrange_top, substitution


def p_constant(context: Context) -> Verdict:
    """P is constant, and each displayed line of its derivation equals the one before."""
    evidence = Evidence()
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
    return evidence.conclude("holds")


def involution(context: Context) -> Verdict:
    """H, l3 and P commute and are independent: complete integrability on generic leaves."""
    evidence = Evidence()
    top = lagrange_top(context)
    l, alpha, beta = top.vectors
    P = l.dot(alpha) + top.epsilon * top.inertia[0] * top.a[2] * beta[2]
    complete_integrability(evidence, top, {"H": top.hamiltonian, "l₃": l[2], "P": P})
    evidence.note("Three independent integrals in involution on six-dimensional leaves: completely integrable there.")
    return evidence.conclude("holds")


def charged_case(context: Context) -> Verdict:
    """The charged twisted Lagrange top is integrable too, being the image of the uncharged one."""
    evidence = Evidence()
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
    return evidence.conclude(
        "incomplete",
        "The charged top is integrable as well: with b on the axis too, l₃ and P′ = l·(a₃α + b₃β) + ε a₃² I₁ β₃ are "
        "constant and in involution. For ε ≠ 0 a centre of charge parallel to a ≠ 0 is the uncharged top in other "
        "coordinates.",
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "twisted-lagrange-p",
        "Section 3, The Twisted Top, equation (8) and the three lines after it",
        "With I₁ = I₂, a on the axis and b = 0, P = l·α + ε I₁a₃β₃ is constant, by the displayed three lines.",
        p_constant,
    ),
    Claim(
        "twisted-lagrange-involution",
        "Section 3, The Twisted Top, last paragraph, and abstract",
        "H, l₃ and P are in involution, and the twisted Lagrange top is integrable.",
        involution,
        words="the invariants {H, l₃, P} are in involution",
    ),
    Claim(
        "twisted-lagrange-uncharged",
        "Section 1, Introduction, third paragraph, and Section 3, before equation (8)",
        "The symmetric twisted top is integrable when it is uncharged, b = 0.",
        charged_case,
        words="it is integrable when it has an axis of symmetry (two moments of inertia are equal), … and the "
        "electric field vanishes (or, equivalently, the top is uncharged)",
    ),
)
