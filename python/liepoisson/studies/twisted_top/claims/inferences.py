"""Two remarks of the discussion: what a positive exponent proves, and which surface of section is a good one."""

from __future__ import annotations

from liepoisson.studies.twisted_top.claims.discussion import CENTRE_OF_MASS, KOVALEVSKAYA, kovalevskaya_quartic
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.nonintegrable import Separatrix
from liepoisson.studies.twisted_top.claims.phase_space import column, symbolic_top


def chaos_from_bounded_motion(context: Context) -> Verdict:
    """A bounded orbit of an integrable top with a positive exponent: one asymptotic to a saddle."""
    from sympy import Symbol, oo, sqrt

    evidence = Evidence()
    x = Symbol("x")
    top = symbolic_top(context, inertia=KOVALEVSKAYA, a=CENTRE_OF_MASS, b=(0, 0, 0), epsilon=0)
    l, alpha, _ = top.vectors
    evidence.zero(
        "ε = 0, I = (2, 2, 1), a = (−1, 0, 0), b = 0: H, l·α and Kovalevskaya's quartic K are constant, the top is "
        "integrable",
        [top.rate(f) for f in (top.hamiltonian, l.dot(alpha), kovalevskaya_quartic(top))],
    )
    curve = Separatrix(top, x)
    evidence.zero(
        "with z = 2 sech t, the curve l = (0, 0, z), α = (z²/2 − 1, dz/dt, 0), β = 0 is a bounded orbit of it",
        curve.residual,
    )
    saddle = column(0, 0, 0, -1, 0, 0, 0, 0, 0)
    ends = [curve.state.applyfunc(lambda entry, to=to: entry.limit(x, to)) for to in (0, oo)]
    evidence.zero(
        "for t → ±∞ it tends to the equilibrium l = 0, α = (−1, 0, 0), β = 0", [e for end in ends for e in end - saddle]
    )
    evidence.equal(
        "eigenvalues of the linearised equations there, without repetition",
        sorted(curve.variational_matrix.subs(x, 0).eigenvals(), key=float),
        [-1, -sqrt(2) / 2, 0, sqrt(2) / 2, 1],
        decisive=True,
    )
    evidence.note(
        "Along the orbit the linearised equations tend to these, and their coefficients differ from them by terms that "
        "decay exponentially; hence the exponents of the orbit are the eigenvalues (N. Levinson, Duke Math. J. 15 "
        "(1948) 111). The largest is 1: bounded, positive and not chaotic. For ε ≠ 0 the same curve is an orbit, too."
    )
    return evidence.conclude(
        "holds with a condition",
        "Not for a single orbit: one that is asymptotic to a saddle is bounded and has a positive exponent, also in an "
        "integrable top (here the exponent is 1). A positive exponent for a set of starts of positive measure does "
        "imply chaos, since the entropy is then positive (Pesin's formula). Random starts, as in Figure 1, are "
        "evidence of that kind.",
    )


def section_surface(context: Context) -> Verdict:
    """The surface on which l.beta is extremal: bounded, so that almost every orbit returns to it."""
    evidence = Evidence()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    s = top.a.dot(alpha.cross(beta))
    evidence.zero("s = a·(α × β) = −d(l·β)/dt, for every I, a, b, ε", top.rate(l.dot(beta)) + s, decisive=True)
    evidence.note(
        "l·β is bounded for given H, C₁, C₂, C₃. An orbit that returns near its start, as almost every one does "
        "(Poincaré), cannot have a monotone l·β unless it is constant: so s changes its sign again and again on almost "
        "every orbit, or is "
        "zero on a whole component of the energy surface (as for a = 0, and for β = 0)."
    )
    expected = alpha.cross(beta).dot(top.omega.cross(top.a)) + top.epsilon * top.a.cross(beta).dot(top.a.cross(beta))
    evidence.zero("ds/dt = (α × β)·(ω × a) + ε|a × β|², ω the angular velocity", top.rate(s) - expected)
    evidence.note(
        "Where this is zero, too, the flow is tangent to the surface. At collinear states ds/dt = ε|a × β|²: the "
        "surface is crossed there unless a is parallel to β, and it contains them all, which the Euler angles exclude."
    )
    symmetric = symbolic_top(context, inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, 0))
    sigma = symmetric.a.dot(symmetric.vectors[1].cross(symmetric.vectors[2]))
    evidence.zero(
        "twisted Lagrange top: {s, l₃} = 0, so the section can be reduced by l₃",
        symmetric.bracket(sigma, symmetric.vectors[0][2]),
    )
    return evidence.conclude(
        "incomplete",
        "One can be named, in the vectors: s = a·(α × β) = 0, where l·β is extremal. For given H, C₁, C₂, C₃ "
        "almost every orbit crosses it again and again (unless s is zero throughout, as for a = 0). In the coordinates "
        "(q, p) with e∥ = e₃ it is dp_φ/dt = 0.",
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "chaos-from-bounded-motion",
        "Section 5, Discussion, third paragraph",
        "A positive Lyapunov exponent implies chaos, because the motion is bounded.",
        chaos_from_bounded_motion,
        words="we can infer chaos from a positive Lyapunov exponent because we showed in Section 3 that the motion "
        "takes "
        "place in a bounded region of phase space",
    ),
    Claim(
        "section-surface",
        "Section 5, Discussion, last paragraph",
        "A good surface of section for the canonical coordinates is still to be found.",
        section_surface,
        words="the need to find a good surface to make Poincaré sections in the canonical coordinate space",
    ),
)
