r"""Homoclinic orbits that are known in closed form, and what Melnikov's method says along them.

A constant of motion K has, on the unstable and the stable manifold of a system that was changed by $\delta H_1$, values
that differ by $\delta M_K + O(\delta^2)$ with $M_K = \int\{K, H_1\}\,dt$; a change of the bracket does the same with
$\{K, H\}$ of the changed bracket.  The integrands are brought here to a form that a table of integrals has, exactly;
`splitting` has the numbers.

References: V. K. Melnikov, Trudy MMO 12 (1963) 3; P. J. Holmes and J. E. Marsden, Indiana University Mathematics
Journal 32 (1983) 273 (the heavy top near Lagrange's).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liepoisson.studies.twisted_top.claims import splitting
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks
from liepoisson.studies.twisted_top.claims.nonintegrable import Separatrix
from liepoisson.studies.twisted_top.claims.phase_space import (
    KOVALEVSKAYA,
    UNCHARGED,
    SymbolicTop,
    column,
    kovalevskaya_quartic,
    kovalevskaya_top,
    substitution,
    symbolic_top,
)
from liepoisson.studies.twisted_top.typography import show


@checks("homoclinic-orbits")
def homoclinic_orbits(evidence: Evidence, context: Context) -> None:
    """An elementary family of homoclinic orbits, for any inertia; where manifolds split at first order."""
    _elementary_family(evidence, context)
    _saddles(evidence, context)
    _sleeping_top(evidence, context)
    _pendulum_loops(evidence, context)
    _kovalevskaya_family(evidence, context)
    if all(step.succeeded is not False for step in evidence.steps):
        splitting.state_numbers(evidence)


def _elementary_family(evidence: Evidence, context: Context) -> None:
    """State the invariant set and the orbits in it."""
    from sympy import Symbol, symbols

    top = symbolic_top(context, a=("a1", 0, 0), b=(0, 0, "b3"))
    l, alpha, beta = top.vectors
    a1, epsilon, moment = top.a[0], top.epsilon, top.inertia[2]
    plane = {l[0]: 0, l[1]: 0, alpha[2]: 0, beta[0]: 0, beta[1]: 0}
    z, x, y, B = l[2], alpha[0], alpha[1], beta[2]
    off_plane = [top.rate(component).subs(plane) for component in (*plane, B)]
    evidence.zero(
        "a = (a₁, 0, 0), b = (0, 0, b₃): l = (0, 0, z), α = (x, y, 0), β = (0, 0, B) is invariant, B constant",
        off_plane,
        decisive=True,
    )
    rates = [top.rate(component).subs(plane) for component in (z, x, y)]
    wanted = (-a1 * y, y * z / moment, -x * z / moment + epsilon * B * a1)
    evidence.zero(
        "dz/dt = −a₁y, dx/dt = yz/I₃, dy/dt = −xz/I₃ + εBa₁",
        [r - v for r, v in zip(rates, wanted, strict=True)],
        decisive=True,
    )
    # With c = cosh(k t) and s = sinh(k t), c^2 = 1 + s^2; m = sqrt(a1 d I3), so that a1 d = m^2/I3.
    c, s, z0, m = symbols("c s z0 m")
    k = Symbol("k")
    k_squared = (m**2 - z0**2) / moment**2
    d = m**2 / (a1 * moment)
    strength = d * z0 / (moment * a1)  # epsilon B at the saddle, from x z = epsilon B a1 I3
    zt = z0 + 2 * k_squared * moment**2 / (z0 + m * c)
    yt = -_rate(zt, c, s, k) / a1
    xt = (z0**2 / (2 * moment) + a1 * d - zt**2 / (2 * moment)) / a1
    residuals = (
        _rate(xt, c, s, k) - yt * zt / moment,
        _rate(yt, c, s, k) + xt * zt / moment - strength * a1,
    )
    evidence.zero(
        "with z₀ ≠ 0, d = εBI₃a₁/z₀, m² = a₁dI₃ and k² = (m² − z₀²)/I₃² > 0, "
        "z = z₀ + 2k²I₃²/(z₀ ± m cosh kt), x = (z₀²/2I₃ + a₁d − z²/2I₃)/a₁, y = −(dz/dt)/a₁ solves them",
        [_hyperbolic(residual, c, s, k, k_squared) for residual in residuals],
        decisive=True,
    )
    evidence.note(
        "For t → ±∞ it tends to the saddle z = z₀, x = d, y = 0. (Either sign of m; for B = 0, z = 2I₃k sech kt.)"
    )


def _rate(f: Any, c: Any, s: Any, k: Any) -> Any:
    """Time derivative of a function of c = cosh kt, s = sinh kt."""
    return k * (f.diff(c) * s + f.diff(s) * c)


def _hyperbolic(expression: Any, c: Any, s: Any, k: Any, k_squared: Any) -> Any:
    """The numerator with s^2 = c^2 - 1 and the known k^2 inserted."""
    from sympy import Poly, fraction, together

    numerator, _ = fraction(together(expression))
    terms = Poly(numerator.expand(), s, k).terms()
    return sum(f * (c**2 - 1) ** (i // 2) * s ** (i % 2) * k_squared ** (j // 2) * k ** (j % 2) for (i, j), f in terms)


def _saddles(evidence: Evidence, context: Context) -> None:
    """State that the saddles of the elementary orbits have three growing directions, for Kovalevskaya's inertia."""
    from sympy import Rational, discriminant, symbols

    s, q, u, z0, m, a1 = symbols("s q u z0 m a1")
    top = symbolic_top(context, inertia=KOVALEVSKAYA, a=("a1", 0, 0), b=UNCHARGED)
    d = m**2 / a1
    rest = (0, 0, z0, d, 0, 0, 0, 0, d * z0 / (top.epsilon * a1))
    quadratic = 4 * q**2 + (5 * z0**2 - 2 * m**2) * q + z0**2 * (m**2 + z0**2)
    evidence.zero(
        "I = (2, 2, 1), b = 0: the linearised equations at a saddle have the characteristic polynomial "
        "s³(s² − k²)Q(s²)/4, Q(q) = 4q² + (5z₀² − 2m²)q + z₀²(m² + z₀²), k² = m² − z₀²",
        _characteristic(top, rest, s) - s**3 * (s**2 - m**2 + z0**2) * quadratic.subs(q, s**2) / 4,
    )
    roots = discriminant(quadratic.subs(m, 1), q).subs(z0**4, u**2).subs(z0**2, u)
    evidence.zero("with u = z₀²/m² the discriminant of Q is (9u² − 36u + 4)m⁴", roots - (9 * u**2 - 36 * u + 4))
    ends: list[Any] = [roots.subs(u, value) for value in (Rational(2, 5), 1)]
    evidence.proof(
        "value",
        "so for 0 < u < 1 no root of Q is negative or 0: both have the sum (2 − 5u)m²/4 and a positive product; they "
        "are not real for 2/5 ≤ u ≤ 1, where the discriminant, convex in u, is negative at both ends",
        all(end < 0 for end in ends),
        [f"u = 2/5: {show(ends[0])}, u = 1: {show(ends[1])}"],
    )
    evidence.note(
        "Of s, three values grow, k among them, three decay, and three belong to the Casimirs. On a leaf of dimension "
        "6 both manifolds have dimension 3, in a level of H of dimension 5: where they are transversal, the orbit "
        "persists under every small change of the top, and there is no integral of Melnikov."
    )


def _characteristic(top: SymbolicTop, state: Sequence[Any], s: Any) -> Any:
    """The characteristic polynomial of the linearised equations at a state."""
    field: Any = column(*top.bracket.vector_field(top.hamiltonian))
    matrix = field.jacobian(list(top.bracket.variables)).subs(substitution(top.bracket.variables, state))
    return matrix.charpoly(s).as_expr()


def _sleeping_top(evidence: Evidence, context: Context) -> None:
    """State the homoclinic orbits of Lagrange's sleeping top, and the integrands for two changes of it."""
    from sympy import Rational, cancel, symbols

    x, s, kappa, nu, mu, C, S = symbols("x s kappa nu mu C S")
    top = symbolic_top(context, inertia=(1, 1, "I3"), a=(0, 0, 1), b=UNCHARGED)
    moment, epsilon, (l, alpha, _) = top.inertia[2], top.epsilon, top.vectors
    l3, height = nu - mu, kappa**2 + nu**2 / 4
    turning = l3 * (1 / moment - Rational(1, 2)) - mu / 2
    evidence.note(
        "The sleeping top of Lagrange, I = (1, 1, I₃), a = (0, 0, 1), b = 0 (other I₁ and a₃ are scalings): l, α, β "
        "along e₃, where λ³ + l₃λ² + α₃λ + εβ₃ = (λ − μ)(λ² + νλ + A) and κ² = A − ν²/4 > 0. The ordinary top has μ = "
        "0, so that β = 0. Let Ω = l₃(1/I₃ − 1/2) − μ/2 and φ = ψ − Ωt."
    )
    rest = (0, 0, l3, 0, 0, height - mu * nu, 0, 0, -mu * height / epsilon)
    evidence.zero(
        "the characteristic polynomial is s³(s² + (l₃/I₃ + μ)²)((s − κ)² + Ω²)((s + κ)² + Ω²)",
        _characteristic(top, rest, s)
        - s**3 * (s**2 + (l3 / moment + mu) ** 2) * ((s - kappa) ** 2 + turning**2) * ((s + kappa) ** 2 + turning**2),
    )

    def rate(f: Any) -> Any:
        """Time derivative of a function of x = exp(kappa t)."""
        return kappa * x * f.diff(x)

    r, axis = 4 * kappa * x / (1 + x**2), column(0, 0, 1)
    m, n = column(r, 0, nu), column(nu * r / 2, rate(r), height - r**2 / 2)
    fields = m - mu * axis, n - mu * m, -mu * n / epsilon
    here = substitution(top.bracket.variables, [entry for v in fields for entry in v])
    motion = column(*(entry for v in fields for entry in v.applyfunc(rate) - turning * axis.cross(v)))
    field = column(*top.bracket.vector_field(top.hamiltonian)).subs(here)
    evidence.zero("l₃ is constant, so the equations do not change under rotations about e₃", top.rate(l[2]))
    evidence.zero(
        "with r = 2κ sech κt, and the angle φ of (l₁, l₂), m = (r, 0, ν), n = (νr/2, dr/dt, A − r²/2) along the axes "
        "turned by φ, the states l = m − μe₃, α = n − μm, β = −μn/ε are an orbit homoclinic to it",
        (motion - field).applyfunc(cancel),
    )
    by_inertia, by_tilt = top.bracket(l[2], (l[0] ** 2 - l[1] ** 2) / 2), top.bracket(l[2], alpha[0])
    turned = substitution(l[:2], (r * C, r * S)) | {alpha[1]: fields[1][0] * S + fields[1][1] * C}
    evidence.zero(
        "1/I₁ = 1 + δ, 1/I₂ = 1 − δ, that is H₁ = (l₁² − l₂²)/2: {l₃, H₁} = −r² sin 2φ there",
        by_inertia.subs(turned) + 2 * r**2 * S * C,
    )
    evidence.zero(
        "a = (δ, 0, 1), that is H₁ = α₁: {l₃, H₁} = l₃(1/I₃ − 1)r sin φ − d(r cos φ)/dt there",
        cancel(by_tilt.subs(turned) - l3 * (1 / moment - 1) * r * S + rate(r) * C + r * turning * S),
    )
    evidence.note(
        "With ∫ sech²τ cos qτ dτ = πq/sinh(πq/2) and ∫ sech τ cos qτ dτ = π/cosh(πq/2) over all τ the integrals of "
        "{l₃, H₁} are M = −8πΩ sin 2ψ/sinh(πΩ/κ) and M = 2πl₃(1/I₃ − 1) sin ψ/cosh(πΩ/2κ). The second one is zero for "
        "I₃ = 1, where the tilted top is Lagrange’s as well."
    )
    evidence.note(
        "For β = 0 the leaf has dimension 4, and both manifolds have dimension 2 in a level of dimension 3: by "
        "Melnikov’s theorem simple zeros are transversal homoclinic orbits for all small δ ≠ 0 (Holmes and Marsden, "
        "1983, for the ordinary heavy top). For β ≠ 0 the level has dimension 5 and ±i(l₃/I₃ + μ) are an oscillation: "
        "the manifolds of the equilibrium have dimension 2 and do not meet in general; those of the small periodic "
        "orbits around it have dimension 3."
    )


def _pendulum_loops(evidence: Evidence, context: Context) -> None:
    """State that along the pendulum loops of Kovalevskaya's top nothing changes at first order in epsilon."""
    from sympy import Symbol, cancel, oo, symbols

    x = Symbol("x")
    p, q, B = symbols("p q B")
    curve, twisted = Separatrix(kovalevskaya_top(context, 0), x), kovalevskaya_top(context, 1)
    top, z, (a1, a2) = curve.top, curve.z, curve.state[3:5]
    l, alpha, _ = top.vectors
    state = curve.state + column(0, 0, 0, 0, 0, 0, p * a1 - q * a2, p * a2 + q * a1, B)
    here = substitution(top.bracket.variables, state)
    field = column(*top.bracket.vector_field(top.hamiltonian)).subs(here)
    evidence.zero(
        "I = (2, 2, 1), a = (−1, 0, 0), b = 0, ε = 0: l = (0, 0, z), α = (z²/2 − 1, dz/dt, 0), z = ±2 sech t, with any "
        "β = (pα₁ − qα₂, pα₂ + qα₁, B) is an orbit of the ordinary Kovalevskaya top, the loops of a pendulum",
        (state.applyfunc(curve.rate) - field).applyfunc(cancel),
    )
    rates = [twisted.rate(f).subs(here) for f in (kovalevskaya_quartic(top), l.dot(alpha))]
    evidence.zero(
        "the rates at which a small twist changes K and l·α there, per ε, are d(−2B z)/dt and dβ₁/dt",
        [cancel(f - curve.rate(g)) for f, g in zip(rates, (-2 * B * z, state[6]), strict=True)],
    )
    ends = [[cancel(f).limit(x, end) for end in (0, oo)] for f in (z, state[6])]
    evidence.zero(
        "z and β₁ have the same limits for t → ±∞, so that both integrals vanish, for every β",
        [first - last for first, last in ends],
    )


def _kovalevskaya_family(evidence: Evidence, context: Context) -> None:
    """State the function that splits around the hyperbolic periodic orbits of Kovalevskaya's top."""
    from sympy import Symbol, cancel, sqrt

    top = kovalevskaya_top(context, 0)
    l, alpha, _ = top.vectors
    momentum = l.dot(alpha)
    F = kovalevskaya_quartic(top) - (top.hamiltonian - momentum**2 / (2 * alpha.dot(alpha))) ** 2
    evidence.zero("F = K − (H − (l·α)²/2|α|²)² is constant for ε = 0", cancel(top.rate(F)))
    h, c = Symbol("h"), Symbol("c")
    middle = substitution(top.bracket.variables, (2 * sqrt(h - c**2 / 2), 0, c, 0, 0, 1, 0, 0, 0))
    evidence.zero(
        "the states l = (2√(h − c²/2), 0, c), α = (0, 0, 1) have H = h, l·α = c and F = 0",
        [value.subs(middle) - wanted for value, wanted in ((top.hamiltonian, h), (momentum, c), (F, 0))],
    )
    evidence.note(
        "F = 0 with ∇F = 0 is a family of periodic orbits. Where they are hyperbolic, orbits with these middles tend "
        "to them both ways, as far as is computed below. The twist changes F by ε{F, H}₁, the bracket taken for ε = 1, "
        "and so the values of F on both manifolds of the family differ by εM, M = ∫{F, H}₁ dt. The integrand is linear "
        "in β, which stays fixed in space. The reversal l₂, α₂, β₂ → −l₂, −α₂, −β₂, t → −t maps the orbit to itself: "
        "only the part of β along e₂ in the middle counts, M is proportional to sin θ, with the angle θ of β around α "
        "from the plane of e₁ and e₃, and has simple zeros unless it vanishes."
    )
