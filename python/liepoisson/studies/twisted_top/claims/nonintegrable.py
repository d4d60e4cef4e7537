"""The twisted Kovalevskaya top is not integrable: the differential Galois group along a separatrix, exactly.

The pendulum motion of the ordinary top is a curve along which the variational equations are rational in exp t.  If the
top were integrable, with three commuting fields and six integrals (the Casimirs among them), the identity component of
the differential Galois group of these equations would be abelian.  Two elements of it are found here that do not
commute: a local monodromy at a complex pole, unipotent, which the twist makes different from one, and a power of the
monodromy at t = -infinity.

References: M. Ayoul and N. T. Zung, Comptes Rendus Mathematique 348 (2010) 1323 (the theorem for systems with commuting
fields); J. J. Morales-Ruiz and J. P. Ramis, Methods and Applications of Analysis 8 (2001) 33.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from liepoisson.integrability.galois.linear_systems import LinearSystem, linear_system
from liepoisson.integrability.galois.local_solutions import Exponents, local_system
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import SymbolicTop, column, substitution, symbolic_top

# Places of (dl1, dl2, dalpha3, dbeta1, dbeta2) in the state, and their weights: l 1, alpha 2, beta 3.
_ODD = (0, 1, 5, 6, 7)
_WEIGHTS = (1, 1, 2, 3, 3)
_WITHOUT_BETA = 3  # so many of them span the subspace dbeta = 0


@dataclass(frozen=True)
class Separatrix:
    """The motion l = (0, 0, z), alpha = (z^2/2 - 1, z', 0), beta = 0 with z = 2 sech t = 4x/(1 + x^2), x = exp t."""

    top: SymbolicTop
    x: Any

    @property
    def z(self) -> Any:
        """The third component of l."""
        return 4 * self.x / (1 + self.x**2)

    @property
    def state(self) -> Any:
        """The nine components as functions of x."""
        z = self.z
        return column(0, 0, z, z**2 / 2 - 1, self.rate(z), 0, 0, 0, 0)

    def rate(self, f: Any) -> Any:
        """Time derivative of a function of x = exp t."""
        from sympy import cancel

        return cancel(self.x * f.diff(self.x))

    @property
    def residual(self) -> Any:
        """What is left of the equations of motion on the curve."""
        field = column(*self.top.bracket.vector_field(self.top.hamiltonian))
        return self.state.applyfunc(self.rate) - field.subs(self._here)

    @property
    def variational_matrix(self) -> Any:
        """The matrix of the variational equations, shape (9, 9), rational in x."""
        from sympy import cancel

        field: Any = column(*self.top.bracket.vector_field(self.top.hamiltonian))
        return field.jacobian(list(self.top.bracket.variables)).subs(self._here).applyfunc(cancel)

    @property
    def _here(self) -> dict[Any, Any]:
        return substitution(self.top.bracket.variables, self.state)


def not_integrable(context: Context) -> Verdict:
    """Two elements of the identity component of the Galois group that do not commute."""
    from sympy import Symbol, default_sort_key, sqrt

    evidence = Evidence()
    x = Symbol("x")
    curve = Separatrix(_kovalevskaya(context, 1), x)
    evidence.note(
        "I = (2, 2, 1), a = (−1, 0, 0), b = 0, ε = 1 (another ε ≠ 0 is a scaling). The curve, with x = exp t: "
        "l = (0, 0, z), α = (z²/2 − 1, dz/dt, 0), β = 0, z = 2 sech t = 4x/(1 + x²), poles at x = ±i."
    )
    if not evidence.zero("it solves the equations of motion", curve.residual):
        return evidence.conclude("incomplete")
    A = curve.variational_matrix
    even = [k for k in range(9) if k not in _ODD]
    evidence.zero(
        "V₅ = (δl₁, δl₂, δα₃, δβ₁, δβ₂) decouples from the other four variations",
        [*A.extract(list(_ODD), even), *A.extract(even, list(_ODD))],
    )
    block = A.extract(list(_ODD), list(_ODD))
    _flag(evidence, curve, block)
    counts = _local_counts(evidence, context, curve, block)
    equations = _equations(block, x)
    origin, _ = equations.singular_points
    evidence.equal(
        "exponents at x = 0 (t → −∞) on V₃, those of V₅ with δβ = 0, of which 0 belongs to V₃/V₂ and the others to "
        "V₂, those with l·δα + α·δl = 0",
        _listed(equations.part(range(_WITHOUT_BETA)).local(origin).exponents),
        sorted((0 * sqrt(2), sqrt(2) / 2, -sqrt(2) / 2), key=default_sort_key),
        decisive=True,
    )
    evidence.note(
        "At x = i the monodromy is U = 1 + N with N ≠ 0, N V₃ = 0 and N V₅ in V₂ (V₅/V₃ has trivial monodromy, and f "
        "is conserved). U is unipotent, so it lies in the identity component G⁰ of the Galois group. At x = 0 the "
        "monodromy g has the eigenvalues exp(±2πi/√2) on V₂, no power of which is 1, and some power gᵏ, k ≥ 1, lies in "
        "G⁰. As gᵏ N g⁻ᵏ = gᵏ N ≠ N, the two do not commute: G⁰ is not abelian."
    )
    evidence.note(
        "By the theorem of Ayoul and Zung (that of Morales-Ruiz and Ramis for commuting fields) there are then no "
        "three commuting fields, the top's among them, with six common independent integrals, the Casimirs among them, "
        "all meromorphic near this curve."
    )
    evidence.data = {"single_valued_solutions": counts}
    return evidence.conclude(
        "incomplete",
        "The conclusion is right, and it is a theorem: for I₁ = I₂ = 2I₃, a equatorial, b = 0 and every ε ≠ 0 the top "
        "is not Liouville integrable with meromorphic integrals. The exponents of the paper are evidence, not a proof.",
    )


def _kovalevskaya(context: Context, epsilon: int) -> SymbolicTop:
    return symbolic_top(context, inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=epsilon)


def _flag(evidence: Evidence, curve: Separatrix, block: Any) -> None:
    """The invariant subspaces V2 < V3 < V5, and the solutions of the quotient V5/V3."""
    from sympy import Matrix, zeros

    n, top, state = _WITHOUT_BETA, curve.top, curve.state
    evidence.zero("V₃ = {δβ = 0} is invariant", block[n:, :n] - zeros(2, n))
    alpha = state[3], state[4]
    solutions = (column(*alpha), column(-alpha[1], alpha[0]))
    residuals = [entry for v in solutions for entry in v.applyfunc(curve.rate) - block[n:, n:] * v]
    evidence.zero("V₅/V₃ has the rational solutions (δβ₁, δβ₂) = (α₁, α₂), (−α₂, α₁)", residuals)
    # The variation of l.alpha + epsilon I3 a.beta, which is constant along this curve.
    f: Any = Matrix([[alpha[0], alpha[1], curve.z, top.epsilon * top.inertia[2] * top.a[0], 0]])
    evidence.zero(
        "f = α₁δl₁ + α₂δl₂ + zδα₃ − εδβ₁ is constant; V₂ = {δβ = 0, f = 0} is invariant",
        f.applyfunc(curve.rate) + f * block,
    )


def _local_counts(evidence: Evidence, context: Context, curve: Separatrix, block: Any) -> dict[str, int]:
    """State how many solutions are single valued at the pole x = i, with and without the twist."""
    x, n = curve.x, _WITHOUT_BETA
    untwisted = Separatrix(_kovalevskaya(context, 0), x).variational_matrix.extract(list(_ODD), list(_ODD))
    cases = (
        ("V₃", block[:n, :n], _WEIGHTS[:n], [0, 1, 3], 3),
        ("V₅ for ε = 0", untwisted, _WEIGHTS, [0, 1, 1, 3, 5], 5),
        ("V₅ = (δl₁, δl₂, δα₃, δβ₁, δβ₂) for ε = 1", block, _WEIGHTS, [0, 1, 1, 3, 5], 4),
    )
    counts: dict[str, int] = {}
    for name, matrix, weights, exponents_wanted, wanted in cases:
        equations = _equations(matrix, x)
        local = local_system(equations, equations.singular_points[-1], weights=weights)
        counts[name] = local.n_single_valued
        evidence.equal(
            f"x = i, exponents of (x − i)ʷ δ on {name}, w = 1, 2, 3 for l, α, β",
            _listed(local.exponents),
            exponents_wanted,
        )
        evidence.equal(
            f"x = i, x = exp t along the separatrix: solutions on {name} without logarithm, out of {len(weights)}",
            counts[name],
            wanted,
            decisive=name.endswith("1"),
        )
    return counts


def _equations(matrix: Any, x: Any) -> LinearSystem:
    """The equations with x = exp t as the variable, of which dx/dt = x; they are singular at 0 and where x^2 = -1."""
    return linear_system(matrix / x, x)


def _listed(found: Exponents) -> list[Any]:
    """Exponents in a fixed order, each as often as it occurs."""
    from sympy import Rational, Symbol, default_sort_key, roots

    e = Symbol("e")
    listed: list[Any] = [
        Rational(r.numerator, r.denominator) for r, count in found.rational.items() for _ in range(count)
    ]
    for polynomial in found.others:
        listed += list(roots(sum(int(c) * e**k for k, c in enumerate(polynomial.numer().coeffs())), e))
    return sorted(listed, key=default_sort_key)


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "deformation-breaks-integrability",
        "Section 5, Discussion, third paragraph",
        "Integrability does not always survive the deformation: numerically, the twisted Kovalevskaya top is chaotic.",
        not_integrable,
        words="We conclude that integrability does not always survive deformation",
    ),
)
