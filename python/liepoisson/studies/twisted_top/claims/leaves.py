"""Claims of the canonical section that concern collinear fields and the shape of the symplectic leaves."""

from __future__ import annotations

from typing import Any

from liepoisson.structure.strata import Locus
from liepoisson.studies.twisted_top.claims.common import strata_steps
from liepoisson.studies.twisted_top.claims.evidence import Evidence, show, written
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import SymbolicTop, column, substitution, symbolic_top

COLLINEAR = (1, 2, -1, 4, -2, 2, 2, -1, 1)


def collinear_stays(context: Context) -> Verdict:
    """Collinear fields do not stay collinear."""
    evidence = Evidence()
    _leaves_collinearity(evidence, symbolic_top(context))
    evidence.note(
        "The paper argues that the right-hand side of the equation for l·β vanishes there; but u = v⊥² obeys "
        "d√u/dt = εw a·n with a unit vector n, so du/dt is not Lipschitz in u and u = 0 need not persist."
    )
    return evidence.conclude(
        "wrong",
        "On α = cβ, d/dt(α × β) = ε (β × a) × β, which vanishes only when a is parallel to β (or ε = 0): collinear "
        "fields separate at once. The collinear set is not invariant.",
    )


def never_collinear(context: Context) -> Verdict:
    """An orbit that starts with independent fields and becomes collinear."""
    from sympy import Rational

    evidence = Evidence()
    top = symbolic_top(context, a=(0, 0, 1), b=(0, 0, 0), epsilon=1)
    _, alpha, beta = top.vectors
    start = substitution(top.bracket.variables, (0, 0, 0, 0, 0, 0, 1, 0, 0))
    normal = alpha.cross(beta)
    u = normal.dot(normal)
    series: list[Any] = []
    for _ in range(3):
        series.append(u.subs(start))
        u = top.rate(u)
    names = ("|α × β|²", "d/dt |α × β|²", "d²/dt² |α × β|²")
    evidence.counterexample(
        "|α × β|² = t² + O(t³) on an orbit: independent for small t ≠ 0, collinear at t = 0",
        {"dα/dt": (tuple(top.rate(alpha).subs(start)), (0, -1, 0))}
        | {name: (value, Rational(wanted)) for name, value, wanted in zip(names, series, (0, 0, 2), strict=True)},
        "t = 0 on the orbit through l = α = (0, 0, 0), β = (1, 0, 0), for ε = 1, a = (0, 0, 1), b = 0, any inertia",
    )
    evidence.data = {"derivatives": [show(value) for value in series]}
    _stays_away(evidence, context)
    return evidence.conclude(
        "wrong",
        "Orbits with α × β ≠ 0 do reach collinear states. These form a set of codimension two in the leaf, so almost "
        "every orbit avoids it. How near an orbit comes depends on the leaf and the energy: where the energy "
        "surface of the leaf contains collinear states, orbits pass arbitrarily near, and φ then changes by nearly π "
        "at once; where it contains none, they stay away.",
    )


def _stays_away(evidence: Evidence, context: Context) -> None:
    """State that the energy surface of some leaf contains no collinear state."""
    from sympy import Rational, Symbol

    top = symbolic_top(context, inertia=(2, "3/2", 1), a=(0, 0, 1), b=(0, 0, 0), epsilon="1/20")
    tenth = Rational(1, 10)
    start = substitution(top.bracket.variables, (3 * tenth, 2 * tenth, tenth, 1, 0, 0, 0, 1, 0))
    C1, C2, C3 = (casimir.subs(start) for casimir in top.casimirs)
    # With C2 = 0 and C3 = 1 a collinear state has alpha = 0 and 2 epsilon l.beta = C1, so |l| >= C1/(2 epsilon).
    least = (C1 / (2 * top.epsilon)) ** 2 / (2 * top.inertia[0])
    l, alpha, beta = top.vectors
    s = Symbol("s")
    collinear = substitution((*l, *alpha, *beta), (s, 0, 0, 0, 0, 0, 1, 0, 0))
    evidence.zero("α = 0, β = e₁, l = s e₁: C₁ = 2ε s", top.casimirs[0].subs(collinear) - 2 * top.epsilon * s)
    evidence.counterexample(
        "an energy surface may contain no collinear state: on this leaf one has α = 0 and l·β = C₁/2ε, hence "
        "H = l·I⁻¹l/2 ≥ (C₁/2ε)²/(2 I_max) with I_max = 2 the largest moment of inertia, far above the energy",
        {
            "C₂, C₃": ((C2, C3), (0, 1)),
            "H": (top.hamiltonian.subs(start), Rational(49, 1200)),
            "(C₁/2ε)²/(2 I_max)": (least, Rational(2601, 100)),
        },
        "I = (2, 3/2, 1), a = (0, 0, 1), b = 0, ε = 1/20, l = (3/10, 1/5, 1/10), α = (1, 0, 0), β = (0, 1, 0)",
        decisive=False,
    )


def always_invertible(context: Context) -> Verdict:
    """The inversion fails at collinear states, which orbits reach."""
    evidence = Evidence()
    top = symbolic_top(context)
    _, alpha, beta = top.vectors
    _leaves_collinearity(evidence, top)
    normal = alpha.cross(beta)
    perpendicular = alpha - alpha.dot(beta) / beta.dot(beta) * beta
    evidence.zero("v⊥ A e⊥ = α − (α·β)β/β² = β × (α × β)/β²", perpendicular - beta.cross(normal) / beta.dot(beta))
    evidence.note(
        "It vanishes at collinear states, so e⊥ and with it φ is undefined there; before and after the passage it has "
        "opposite signs (its rate is not zero), so φ jumps by π."
    )
    return evidence.conclude(
        "wrong",
        "The inversion holds where α × β ≠ 0 only, which the flow does not preserve.",
    )


def _leaves_collinearity(evidence: Evidence, top: SymbolicTop) -> None:
    """On alpha = c beta the fields separate: first derivative of the cross product, second of its square."""
    from sympy import Symbol

    _, alpha, beta = top.vectors
    collinear = substitution(alpha, Symbol("c") * beta)
    normal, torque = alpha.cross(beta), beta.cross(top.a)
    rate = top.rate(normal).subs(collinear)
    evidence.zero(
        "α = cβ: d/dt(α × β) = ε (β × a) × β",
        rate - top.epsilon * torque.cross(beta),
        [f"computed, first component: {written(rate[0], top.bracket)}"],
        decisive=True,
    )
    second = top.rate(top.rate(normal.dot(normal))).subs(collinear)
    expected = 2 * top.epsilon**2 * beta.dot(beta) * torque.dot(torque)
    evidence.identity("α = cβ: d²/dt² |α × β|² = 2ε²|β|²|β × a|²", second, expected, top.bracket, decisive=True)
    evidence.nonzero("which is positive unless ε = 0 or a is parallel to β", expected)


def leaf_dimension(context: Context) -> Verdict:
    """Ranks of the Poisson tensor on all strata, for epsilon not zero."""
    from sympy import Matrix, Symbol

    evidence = Evidence()
    bracket = context.bracket("epsilon")
    l, alpha, beta = bracket.fields.values()
    J: Any = bracket.poisson_tensor()
    epsilon, w, s = Symbol("epsilon"), Symbol("w"), Symbol("s")
    _rotation_symmetric(evidence, bracket)
    gradients = Matrix.hstack(
        column(*(2 * epsilon * beta), *(2 * alpha), *(2 * epsilon * l)),
        column(0, 0, 0, *beta, *alpha),
        column(0, 0, 0, 0, 0, 0, *(2 * beta)),
    )
    evidence.zero("J ∇C₁ = J ∇C₂ = J ∇C₃ = 0: rank at most 6", J * gradients)
    rows = [0, 1, 3, 4, 6, 7]
    minor = J.extract(rows, rows).subs(substitution(beta, (0, 0, w))).det()
    evidence.zero(
        "β = (0, 0, w), any l and α: a principal 6 × 6 minor is ε²w⁶, so the rank is 6 for β ≠ 0",
        minor - epsilon**2 * w**6,
    )
    no_beta = dict.fromkeys(beta, 0)
    flat = J.subs(no_beta)
    null = Matrix.hstack(
        *(column(0, 0, 0, 0, 0, 0, *unit) for unit in ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        column(*alpha, *l, 0, 0, 0),
        column(0, 0, 0, *alpha, 0, 0, 0),
    )
    evidence.zero("β = 0: ∂β₁, ∂β₂, ∂β₃, ∇(l·α), ∇|α|² are null vectors: rank at most 4", flat * null)
    rows = [0, 1, 3, 4]
    minor = flat.extract(rows, rows).subs(substitution(alpha, (0, 0, s))).det()
    evidence.zero("β = 0, α = (0, 0, s): a principal 4 × 4 minor is s⁴, so the rank is 4 for α ≠ 0", minor - s**4)
    evidence.rank("rank at α = β = 0, l ≠ 0", context.bracket(1), (1, 2, -1, 0, 0, 0, 0, 0, 0), 2)
    evidence.note("The same by the Pfaffians of J, for symbolic ε:")
    wanted = {
        Locus(nonzero=(("beta",),)): 6,
        Locus(zero=("beta",), nonzero=(("alpha",),)): 4,
        Locus(zero=("beta", "alpha"), nonzero=(("l",),)): 2,
        Locus(zero=("beta", "alpha", "l")): 0,
    }
    strata_steps(evidence, bracket, wanted)
    return evidence.conclude(
        "holds with a condition",
        "For ε ≠ 0 a leaf has dimension 6 exactly when β ≠ 0. On β = 0 ≠ α it has dimension 4, with the Casimirs l·α "
        "and |α|² of the heavy top; on α = β = 0 ≠ l dimension 2.",
    )


def leaves_are_cotangent(context: Context) -> Verdict:
    """The leaves with beta not zero, as graphs over pairs of tangent planes of a sphere."""
    from sympy import symbols

    evidence = Evidence()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    _rotation_symmetric(evidence, top.bracket)
    evidence.rank(
        "collinear states are regular, rank of J at α = 2β (ε = 1)", context.bracket(1), COLLINEAR, 6, decisive=True
    )
    v, w, C1, x1, x2, y1, y2 = symbols("v w C1 x1 x2 y1 y2")
    n, x, y = column(0, 0, 1), column(x1, x2, 0), column(y1, y2, 0)
    height = (C1 - v**2 - x.dot(x)) / (2 * top.epsilon * w)
    image = substitution((*l, *alpha, *beta), (*(height * n + y), *(v * n + x), *(w * n)))
    evidence.note(
        "Put β = wn, α = vn + x, l = hn + y with |n| = 1, x and y orthogonal to n, h = (C₁ − v² − |x|²)/(2εw):"
    )
    names = ("|α|² + 2ε l·β is the given C₁", "α·β = vw", "|β|² = w²")
    for name, casimir, value in zip(names, top.casimirs, (C1, v * w, w**2), strict=True):
        evidence.zero(name, casimir.subs(image, simultaneous=True) - value)
    evidence.zero(
        "2ε l·β = η − |x|² ≤ η with η = C₁ − v²: the chart without x = 0 fills a half-space of momenta only",
        (2 * top.epsilon * l.dot(beta)).subs(image, simultaneous=True) - (C1 - v**2 - x.dot(x)),
    )
    evidence.note(
        "Every point of the leaf is of this form for one (n, x, y): the leaf is the sum of two tangent bundles of the "
        "sphere S², a bundle of rank 4 with second Stiefel–Whitney class twice that of the tangent bundle, which "
        "is 0; hence it is trivial (bundles over S² are classified by π₁(SO(4)) = ℤ₂): the leaf is S² × ℝ⁴, simply "
        "connected, while T*SO(3) has fundamental group ℤ₂."
    )
    return evidence.conclude(
        "underspecified",
        "The paper does not say so. If it is meant: for ε ≠ 0 every leaf with β ≠ 0 is diffeomorphic to S² × ℝ⁴ "
        "(S² the sphere of directions of β), not to T*SO(3); the collinear states are regular points of it. The "
        "Euler-angle chart covers the leaf without them (the part 2ε l·β < η) and without sin θ = 0.",
    )


def _rotation_symmetric(evidence: Evidence, bracket: Any) -> None:
    """The component n.l generates the rotation of all three vectors about n, so ranks do not depend on directions."""
    from sympy import symbols

    n = column(*symbols("n1:4"))
    generator = n.dot(bracket.fields["l"])
    residuals: list[Any] = []
    for vector in bracket.fields.values():
        rotated = vector.cross(n)
        residuals += [bracket(vector[k], generator) - rotated[k] for k in range(3)]
    evidence.zero(
        "n·l generates the rotation of l, α, β about n, a Poisson map: β may be put on the third axis", residuals
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "leaf-dimension",
        "Section 4, Canonical Description, first paragraph",
        "The symplectic leaves have six dimensions, nine coordinates less three Casimirs.",
        leaf_dimension,
        words="(9 coordinates, 3 Casimirs)",
    ),
    Claim(
        "collinear-stays-collinear",
        "Section 4, Canonical Description, after equation (14)",
        "If η = 2ε l·β initially (α and β collinear), then it remains so for all times.",
        collinear_stays,
        words="If η = 2ε l·β initially, then it remains so for all times",
    ),
    Claim(
        "never-collinear",
        "Section 4, Canonical Description, after equation (14)",
        "If α and β are not collinear initially, they never become collinear.",
        never_collinear,
        words="if η ≠ 2ε l·β initially, then the two vectors α and β are never collinear",
        follows_from="collinear-stays-collinear",
    ),
    Claim(
        "always-invertible",
        "Section 4, Canonical Description, next paragraph after equation (14)",
        "The map to Euler angles can always be inverted, if α and β are not initially collinear.",
        always_invertible,
        words="we can always invert Eqs. (9) and (13) for (φ, ψ, θ), as long as α and β are not initially collinear",
        follows_from="collinear-stays-collinear",
    ),
    Claim(
        "leaves-cotangent-so3",
        "Section 4, Canonical Description, first paragraph",
        "Implied: the leaves of the twisted top are covered by Euler angles and their momenta, as T*SO(3) is.",
        leaves_are_cotangent,
        words="the transformation is invertible on the symplectic leaves, so that it can be used to canonize the "
        "system",
        follows_from="collinear-stays-collinear",
    ),
)
