"""The twisted Kovalevskaya top is not integrable and chaotic, exactly; singularities in complex time; two remarks.

The pendulum motion of the ordinary top is a curve along which the variational equations are rational in exp t.  If the
top were integrable, with three commuting fields and six integrals (the Casimirs among them), the identity component of
the differential Galois group of these equations would be abelian.  Two elements of it are found here that do not
commute: a local monodromy at a complex pole, unipotent, which the twist makes different from one, and a power of the
monodromy at t = -infinity.

References: M. Ayoul and N. T. Zung, Comptes Rendus Mathematique 348 (2010) 1323 (the theorem for systems with commuting
fields); J. J. Morales-Ruiz and J. P. Ramis, Methods and Applications of Analysis 8 (2001) 33.  All solutions of a heavy
top are single-valued in the cases of Euler, Lagrange and Kovalevskaya only: S. Kovalevskaya, Acta Mathematica 12 (1889)
177; A. M. Lyapunov, Communications of the Kharkov Mathematical Society 4 (1894) 123.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, Verdict, checks
from liepoisson.studies.twisted_top.claims.phase_space import (
    CENTRE_OF_MASS,
    KOVALEVSKAYA,
    UNCHARGED,
    SymbolicTop,
    column,
    kovalevskaya_quartic,
    kovalevskaya_top,
    lagrange_top,
    substitution,
    symbolic_top,
)
from liepoisson.studies.twisted_top.typography import typeset

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


@checks("deformation-breaks-integrability")
def not_integrable(evidence: Evidence, context: Context) -> None:
    """Two elements of the identity component of the Galois group that do not commute."""
    from sympy import Symbol, default_sort_key, sqrt

    x = Symbol("x")
    curve = Separatrix(kovalevskaya_top(context, 1), x)
    evidence.note(
        "I = (2, 2, 1), a = (−1, 0, 0), b = 0, ε = 1 (another ε ≠ 0 is a scaling). The curve, with x = exp t: "
        "l = (0, 0, z), α = (z²/2 − 1, dz/dt, 0), β = 0, z = 2 sech t = 4x/(1 + x²), poles at x = ±i."
    )
    if not evidence.zero("it solves the equations of motion", curve.residual):
        return
    A = curve.variational_matrix
    even = [k for k in range(9) if k not in _ODD]
    evidence.zero(
        "V₅ = (δl₁, δl₂, δα₃, δβ₁, δβ₂) decouples from the other four variations",
        [*A.extract(list(_ODD), even), *A.extract(even, list(_ODD))],
    )
    block = A.extract(list(_ODD), list(_ODD))
    _flag(evidence, curve, block)
    counts = _local_counts(evidence, context, curve, block)
    equations = _equations(block[:_WITHOUT_BETA, :_WITHOUT_BETA], x)
    evidence.equal(
        "exponents at x = 0 (t → −∞) on V₃, those of V₅ with δβ = 0, of which 0 belongs to V₃/V₂ and the others to "
        "V₂, those with l·δα + α·δl = 0",
        _listed(equations.local(equations.singular_points[0]).exponents),
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
    untwisted = Separatrix(kovalevskaya_top(context, 0), x).variational_matrix.extract(list(_ODD), list(_ODD))
    cases = (
        ("V₃", block[:n, :n], _WEIGHTS[:n], [0, 1, 3], 3),
        ("V₅ for ε = 0", untwisted, _WEIGHTS, [0, 1, 1, 3, 5], 5),
        ("V₅ = (δl₁, δl₂, δα₃, δβ₁, δβ₂) for ε = 1", block, _WEIGHTS, [0, 1, 1, 3, 5], 4),
    )
    counts: dict[str, int] = {}
    for name, matrix, weights, exponents_wanted, wanted in cases:
        equations = _equations(matrix, x, weights)
        local = equations.local(equations.singular_points[-1])
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


def _equations(matrix: Any, x: Any, weights: Sequence[int] = ()) -> Any:
    """The equations with x = exp t as the variable, of which dx/dt = x; they are singular at 0 and where x^2 = -1.

    With weights w they are those of (1 + x^2)^w times the solutions, which have simple poles where x^2 = -1.
    """
    from sympy import diag

    equations = matrix / x
    if weights:
        scale: Any = diag(*((1 + x**2) ** w for w in weights))
        equations = (scale * equations + scale.diff(x)) * scale.inv()
    return lp.integrability.linear_system(equations, x)


def _listed(found: Any) -> list[Any]:
    """Exponents in a fixed order, each as often as it occurs."""
    from sympy import Rational, Symbol, default_sort_key, roots

    e = Symbol("e")
    listed: list[Any] = [
        Rational(r.numerator, r.denominator) for r, count in found.rational.items() for _ in range(count)
    ]
    for polynomial in found.others:
        listed += list(roots(sum(int(c) * e**k for k, c in enumerate(polynomial.numer().coeffs())), e))
    return sorted(listed, key=default_sort_key)


@checks("chaos-from-bounded-motion")
def chaos_from_bounded_motion(evidence: Evidence, context: Context) -> None:
    """A bounded orbit of an integrable top with a positive exponent: one asymptotic to a saddle."""
    from sympy import Symbol, oo, sqrt

    x = Symbol("x")
    top = kovalevskaya_top(context, 0)
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


@checks("section-surface")
def section_surface(evidence: Evidence, context: Context) -> None:
    """The surface on which l.beta is extremal: bounded, so that almost every orbit returns to it."""
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    s = top.a.dot(alpha.cross(beta))
    evidence.zero("s = a·(α × β) = −d(l·β)/dt, for every I, a, b, ε", top.rate(l.dot(beta)) + s, decisive=True)
    evidence.note(
        "l·β is bounded for given H, C₁, C₂, C₃. An orbit that returns near its start, as almost every one does "
        "(Poincaré), cannot have a monotone l·β unless it is constant: so s changes its sign again and again on almost "
        "every orbit, or is zero on a whole component of the energy surface (as for a = 0, and for β = 0)."
    )
    expected = alpha.cross(beta).dot(top.omega.cross(top.a)) + top.epsilon * top.a.cross(beta).dot(top.a.cross(beta))
    evidence.zero("ds/dt = (α × β)·(ω × a) + ε|a × β|², ω the angular velocity", top.rate(s) - expected)
    evidence.note(
        "Where this is zero, too, the flow is tangent to the surface. At collinear states ds/dt = ε|a × β|²: the "
        "surface is crossed there unless a is parallel to β, and it contains them all, which the Euler angles exclude."
    )
    symmetric = lagrange_top(context)
    sigma = symmetric.a.dot(symmetric.vectors[1].cross(symmetric.vectors[2]))
    evidence.zero(
        "twisted Lagrange top: {s, l₃} = 0, so the section can be reduced by l₃",
        symmetric.bracket(sigma, symmetric.vectors[0][2]),
    )


@checks("kovalevskaya-painleve")
def single_valued_tops(evidence: Evidence, context: Context) -> None:
    """No twisted top but Lagrange's has single-valued solutions only."""
    evidence.note(
        "Let all solutions of a twisted top (ε ≠ 0) be single-valued functions of complex time. β = 0 leaves the heavy "
        "top (I, a), so by Lyapunov’s theorem (1894) it is Euler’s (a = 0), Lagrange’s or Kovalevskaya’s."
    )
    evidence.note(
        "α → α + cβ keeps the bracket and takes b to b + ca: only the part of b across a matters. Scalings of l, α, β "
        "and t take every ε ≠ 0, and every length of a and of b ≠ 0 across a, to 1."
    )
    evidence.note(
        "If b is not along a, let ε → 0 (such scalings), and α = xγ, β = yγ: the heavy top with xa + yb in the place "
        "of a must have single-valued solutions for all x, y. So the top is spherical, or Kovalevskaya’s with a and b "
        "equatorial. With a = 0, (l, β) is a heavy top and α follows linearly: the twist is inert."
    )
    across = (0, 1, 0)
    cases = (
        ("I = (2, 2, 1), a equatorial, b = 0 (or b along a): Kovalevskaya’s", KOVALEVSKAYA, UNCHARGED),
        ("I = (2, 2, 1), a and b equatorial, across each other", KOVALEVSKAYA, across),
        ("I = (1, 1, 1), b across a", (1, 1, 1), across),
    )
    for what, inertia, b in cases:
        found = _test(context, inertia, CENTRE_OF_MASS, b)
        failing = next((balance for balance in found.balances if balance.status == "fails"), None)
        evidence.equal(f"{what}, ε = 1: the test", found.verdict, "fails", _shown(failing), decisive=True)
        if b != UNCHARGED:
            without = _test(context, inertia, CENTRE_OF_MASS, b, epsilon=0)
            evidence.equal("the same for ε = 0", without.verdict, "passes")
    lagrange = _test(context, ("I1", "I1", "I3"), (0, 0, 1), UNCHARGED, epsilon="epsilon")
    evidence.equal(
        "I = (I₁, I₁, I₃), a = (0, 0, 1), b = 0, any ε: Lagrange’s, the test", lagrange.verdict, "passes",
        [_exponents(balance) for balance in lagrange.balances[:1]],
    )  # fmt: skip
    evidence.data = {"tests": {what: "fails" for what, _, _ in cases} | {"Lagrange": lagrange.verdict}}


def _test(
    context: Context, inertia: Sequence[Any], a: Sequence[Any], b: Sequence[Any], *, epsilon: Any = 1
) -> lp.results.PainleveTest:
    return lp.integrability.painleve_test(symbolic_top(context, inertia=inertia, a=a, b=b, epsilon=epsilon).system)


def _shown(balance: Any) -> list[str]:
    if balance is None:
        return []
    obstructions = [typeset(line) for line in balance.obstructions]
    free = [name for name in map(typeset, balance.family) if any(name in line for line in obstructions)]
    if free:
        obstructions.append(
            f"{' and '.join(free)}: leading coefficient{'s' * (len(free) > 1)} that the balance leaves free"
        )
    return [_exponents(balance), *obstructions]


def _exponents(balance: Any) -> str:
    return typeset(f"exponents {', '.join(map(str, balance.exponents))}")


_ROWS: tuple[tuple[str, Callable[[Any], str]], ...] = (
    ("covering: images reach out to (> 1)", lambda m: f"{m.expansion:.3f}"),
    ("covering: stable size of images (< 1)", lambda m: f"{m.contraction:.3f}"),
    ("cone condition, least margin (> 0)", lambda m: f"{m.cone:.3f}"),
    ("distance of the middle set to γ (> 0)", lambda m: f"{m.apart_from_orbit:.3f}"),
    ("… to the excursion at other times (> 0)", lambda m: f"{m.apart_from_excursion:.3f}"),
    ("… to its image under R (> 0)", lambda m: f"{m.apart_from_image:.3f}"),
    ("rotation number, H = 1/2 − 2⁻²⁶ (<)", lambda m: f"{m.rotations[0].upper:.11f}" if m.rotations else "—"),
    ("rotation number, H = 1/2 + 2⁻²⁶ (>)", lambda m: f"{m.rotations[1].lower:.11f}" if m.rotations else "—"),
)
_NAMES = {"intervals": "doubles, rounded outward", "Arb balls": "Arb’s balls"}


@checks("rigorous-demonstration")
def rigorous_demonstration(evidence: Evidence, context: Context) -> Verdict:
    """Covering relations along a homoclinic orbit, in rigorous arithmetic."""
    top = kovalevskaya_top(context, 1)
    evidence.note("I = (2, 2, 1), a = (−1, 0, 0), b = 0, ε = 1; the level H = 1/2, C₁ = 1, C₂ = 1/2, C₃ = 1:")
    system = lp.System(top.bracket, top.hamiltonian, name="twisted Kovalevskaya top")
    what = "the certificate of covering relations with cone conditions is accepted"
    try:
        proof = lp.proofs.prove_chaos(system, arithmetics=context.arithmetics)
    except lp.errors.LiePoissonError as error:
        return _not_proved(evidence, what, [str(error)])
    if not proof.excludes_integrals:
        return _not_proved(evidence, what, proof.notes)
    heading = ("condition", *(_NAMES[m.arithmetic] for m in proof.margins))
    table = [heading, *((name, *(show(m) for m in proof.margins)) for name, show in _ROWS)]
    evidence.enclosures(what, table, [note for note in proof.notes if note.startswith("The level")])
    bound = math.floor(proof.entropy * 1e4) / 1e4
    evidence.data = {
        "entropy_above": proof.entropy,
        "n_sets": len(proof.certificate.sets),
        "n_covering_relations": len(proof.certificate.edges),
        "arithmetics": [m.arithmetic for m in proof.margins],
    }
    evidence.note(
        "Command: liepoisson prove twisted-kovalevskaya. The lemmas by which the theorem follows are in docs/proof.md. "
        "Nothing is proved of the measure of the chaotic set, or of typical states."
    )
    verdict = evidence.conclude()
    statement = verdict.correct_statement.replace("{entropy}", f"{bound:.4f}")
    return replace(verdict, method="enclosed", correct_statement=statement)


def _not_proved(evidence: Evidence, what: str, reasons: Sequence[str]) -> Verdict:
    evidence.proof("enclosure", what, succeeded=False, computed=reasons)
    return replace(evidence.conclude(), method="enclosed")
