"""Claims of the introduction and of the section on the charged heavy top."""

from __future__ import annotations

from typing import Any

from liepoisson.model.known_integrals import known_integrals
from liepoisson.model.top_parameters import TopParameters
from liepoisson.structure.strata import Locus
from liepoisson.studies.twisted_top.claims.common import (
    casimir_identities,
    complete_integrability,
    poisson_identities,
    strata_steps,
)
from liepoisson.studies.twisted_top.claims.evidence import Evidence, show
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import (
    GENERIC_POINT,
    SymbolicTop,
    column,
    lagrange_top,
    substitution,
    symbolic_top,
)


def centre_of_rotation(context: Context) -> Verdict:
    """It is the centre of mass that must lie on the axis."""
    evidence = Evidence()
    top = symbolic_top(context, inertia=("I1", "I1", "I3"), b=(0, 0, 0))
    l, alpha, _ = top.vectors
    torque = alpha.cross(top.a)[2]
    evidence.zero("dl₃/dt = α₁a₂ − α₂a₁ for I₁ = I₂: zero for all α exactly when a₁ = a₂ = 0", top.rate(l[2]) - torque)
    evidence.note("The fixed point is the origin of the body frame, on every axis through it; a points to the mass.")
    evidence.counterexample(
        "a centre of mass off the axis changes l₃",
        {"dl₃/dt": (top.rate(l[2]).subs(substitution((*top.a, *alpha), (0, 1, 0, 1, 0, 0))), 1)},
        "a = (0, 1, 0), α = (1, 0, 0)",
    )
    return evidence.conclude("misprint", "The centre of mass, the vector a, must lie on the symmetry axis.")


def zero_field(context: Context) -> Verdict:
    """Zero charge leaves the twist, zero field removes it."""
    evidence = Evidence()
    top = symbolic_top(context, b=(0, 0, 0))
    _, alpha, beta = top.vectors
    rate = top.rate(alpha)
    rigid = alpha.cross(top.omega)
    twist = top.epsilon * beta.cross(top.a)
    evidence.zero("b = 0: dα/dt = α × ω + ε β × a, the twist is there", rate - rigid - twist)
    no_field = dict.fromkeys(beta, 0)
    evidence.zero("β = 0 stays zero: dβ/dt = 0 there", top.rate(beta).subs(no_field))
    evidence.zero("β = 0: dα/dt = α × ω, the ordinary heavy top for every ε", rate.subs(no_field) - rigid)
    at_rest = substitution((*top.a, *top.vectors[0], *beta), (0, 0, 1, 0, 0, 0, 1, 0, 0))
    evidence.counterexample(
        "an uncharged top is not a heavy top: α moves while the body is at rest",
        {"dα/dt": (tuple(rate.subs(at_rest)), (0, -top.epsilon, 0)), "α × ω": (tuple(rigid.subs(at_rest)), (0, 0, 0))},
        "b = 0, a = (0, 0, 1), l = (0, 0, 0), β = (1, 0, 0), any α",
    )
    return evidence.conclude(
        "wrong",
        "Uncharged is b = 0. A vanishing field is β = 0, which removes the twist as well: on it every twisted top is "
        "an ordinary heavy top. The two are equivalent only for ε = 0.",
    )


def charged_jacobi(context: Context) -> Verdict:
    """Antisymmetry and the 84 Jacobi identities at epsilon = 0."""
    return poisson_identities(context, 0).conclude("holds")


def charged_rotation(context: Context) -> Verdict:
    """The equations of the charged top: both fields rotate rigidly in the body frame."""
    evidence = Evidence()
    top = symbolic_top(context, epsilon=0)
    l, alpha, beta = top.vectors
    torque = l.cross(top.omega) + alpha.cross(top.a) + beta.cross(top.b)
    evidence.zero("dl/dt = l × ω + α × a + β × b", top.rate(l) - torque)
    evidence.zero("dα/dt = α × ω", top.rate(alpha) - alpha.cross(top.omega))
    evidence.zero("dβ/dt = β × ω", top.rate(beta) - beta.cross(top.omega))
    evidence.note("All with symbolic I, a, b: α and β are fixed in space and turn rigidly in the body frame.")
    return evidence.conclude("holds")


def charged_casimirs(context: Context) -> Verdict:
    """The three Casimirs of the semidirect bracket, and no more."""
    return casimir_identities(context, 0).conclude("holds")


def charged_phase_space(context: Context) -> Verdict:
    """The fields fix an orientation where they are independent, and only there."""
    from sympy import Matrix, Symbol

    evidence = Evidence()
    bracket = context.bracket(0)
    l, alpha, beta = bracket.fields.values()
    units = [column(*(int(i == k) for i in range(3))) for k in range(3)]
    unit_matrix: Any = Matrix.hstack(*units)
    gram = (alpha.dot(alpha) + beta.dot(beta)) * unit_matrix - alpha * alpha.T - beta * beta.T
    normal = alpha.cross(beta)
    evidence.zero(
        "|u × α|² + |u × β|² is a quadratic form in u with determinant |α × β|² (|α|² + |β|²): a rotation that fixes α "
        "and β is the identity exactly when α × β ≠ 0",
        gram.det() - normal.dot(normal) * (alpha.dot(alpha) + beta.dot(beta)),
    )
    independent = evidence.rank("rank of J at a point with α × β ≠ 0", bracket, GENERIC_POINT, 6)
    c = Symbol("c")
    tensor: Any = bracket.poisson_tensor()
    J = tensor.subs(substitution(alpha, c * beta), simultaneous=True)
    null: Any = Matrix.hstack(
        column(*beta, 0, 0, 0, *l),
        column(0, 0, 0, 0, 0, 0, *beta),
        *(column(0, 0, 0, *unit, *(-c * unit)) for unit in units),
    )
    evidence.zero("α = cβ: five null vectors of J, so the rank is at most 4", J * null)
    parallel = (1, 2, -1, 4, -2, 2, 2, -1, 1)
    rank = evidence.rank("rank of J at a point with α = 2β", bracket, parallel, 4)
    evidence.note("Everywhere, by the Pfaffians of J:")
    pair = ("alpha", "beta")
    wanted = {
        Locus(not_parallel=(pair,)): 6,
        Locus(parallel=(pair,), nonzero=(pair,)): 4,
        Locus(zero=("beta", "alpha"), nonzero=(("l",),)): 2,
        Locus(zero=("beta", "alpha", "l")): 0,
    }
    strata_steps(evidence, bracket, wanted)
    evidence.data = {"rank_independent": independent, "rank_parallel": rank}
    return evidence.conclude(
        "holds with a condition",
        "True where α × β ≠ 0. If α and β are parallel and not both zero, they fix a direction only and the symplectic "
        "leaf has dimension 4; Euler angles are moreover singular where sin θ = 0.",
    )


def charged_lagrange(context: Context) -> Verdict:
    """H, l3 and l.alpha of the Lagrange top in the charged phase space."""
    evidence = Evidence()
    top = lagrange_top(context, epsilon=0)
    l, alpha, _ = top.vectors
    integrals = {"H": top.hamiltonian, "l₃": l[2], "l·α": l.dot(alpha)}
    complete_integrability(evidence, top, integrals)
    return evidence.conclude("holds")


def coplanar_remark(context: Context) -> Verdict:
    """The charged Lagrange top is integrable without the coplanarity, which is not even preserved."""
    from sympy import Symbol

    evidence = Evidence()
    top = lagrange_top(context, charged=True, epsilon=0)
    l, alpha, beta = top.vectors
    gamma = top.a[2] * alpha + top.b[2] * beta
    integrals = {"H": top.hamiltonian, "l₃": l[2], "l·(a₃α + b₃β)": l.dot(gamma)}
    complete_integrability(evidence, top, integrals)
    evidence.zero(
        "γ = a₃α + b₃β turns rigidly, dγ/dt = γ × ω: an ordinary Lagrange top", top.rate(gamma) - gamma.cross(top.omega)
    )
    condition = alpha.cross(beta).dot(top.b)
    rate = top.rate(condition)
    coplanar = {l[0]: 1, l[1]: 0, l[2]: 0, alpha[0]: 1, alpha[1]: 0, alpha[2]: 0, beta[0]: 0, beta[1]: 0, beta[2]: 1}
    evidence.counterexample(
        "α, β, b are coplanar at a state, and at once no longer",
        {"(α × β)·b": (condition.subs(coplanar), 0), "its rate": (rate.subs(coplanar), Symbol("b3") / Symbol("I1"))},
        "l = (1, 0, 0), α = (1, 0, 0), β = (0, 0, 1)",
    )
    twisted = lagrange_top(context, charged=True)
    expected = _coplanarity_rate(twisted)
    evidence.identity(
        "for any ε the rate of (α × β)·b is (b₃/I₁)[α₁β₃l₁ + α₂β₃l₂ − α₃(β₁l₁ + β₂l₂) + εa₃I₁(β₁² + β₂²)], "
        "for a = 0 too",
        twisted.rate(alpha.cross(beta).dot(twisted.b)),
        expected,
        twisted.bracket,
    )
    evidence.data = {"rate": show(rate)}
    return evidence.conclude(
        "wrong",
        "With I₁ = I₂, a and b on the axis the charged top is a Lagrange top in the field a₃α + b₃β: l₃ and "
        "l·(a₃α + b₃β) are constant for all initial conditions. Coplanarity is not needed, and "
        "the flow does not keep it.",
    )


def _coplanarity_rate(top: SymbolicTop) -> Any:
    """The rate of (alpha x beta).b for I1 = I2 and both centres on the axis."""
    l, alpha, beta = top.vectors
    moment, a3, b3 = top.inertia[0], top.a[2], top.b[2]
    turning = beta[2] * (alpha[0] * l[0] + alpha[1] * l[1]) - alpha[2] * (beta[0] * l[0] + beta[1] * l[1])
    return b3 / moment * (turning + top.epsilon * a3 * moment * (beta[0] ** 2 + beta[1] ** 2))


def integrable_list(context: Context) -> Verdict:
    """Two further integrable families of charged tops, with complete sets of integrals."""
    from sympy import Symbol

    evidence = Evidence()
    evidence.note("The paper names the tops with I₁ = I₂ and both centres on the axis. Two more families, ε = 0:")
    data: dict[str, Any] = {}
    kappa = Symbol("kappa", positive=True)
    families = (
        # All axes are alike: turn them so that a lies on the first and b in the plane of the first two.
        (
            "I₁ = I₂ = I₃, any a and b (by choice of axes a = (a₁, 0, 0), b = (b₁, b₂, 0))",
            ("I1", "I1", "I1"),
            ("a1", 0, 0),
        ),
        ("I = (2κ, 2κ, κ), a and b equatorial", (2 * kappa, 2 * kappa, kappa), ("a1", "a2", 0)),
    )
    for title, inertia, a in families:
        top = symbolic_top(context, inertia=inertia, a=a, b=("b1", "b2", 0), epsilon=0)
        exact = TopParameters(tuple(top.inertia), tuple(top.a), tuple(top.b), top.epsilon)
        found = known_integrals(exact, *top.vectors)
        evidence.note(title)
        complete_integrability(evidence, top, {"H": top.hamiltonian, **found})
        data[title] = {name: str(value) for name, value in found.items()}
    evidence.data = data
    return evidence.conclude(
        "incomplete",
        "The charged top is also integrable when I₁ = I₂ = I₃ with any a and b (a Neumann system on the three-sphere), "
        "and when I₁ = I₂ = 2I₃ with a and b equatorial.",
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "lagrange-centre-of-rotation",
        "Section 1, Introduction, third paragraph",
        "The Lagrange-type case needs the centre of rotation to lie on the symmetry axis.",
        centre_of_rotation,
        words="its centre of rotation lies on the symmetry axis",
    ),
    Claim(
        "zero-field-equals-uncharged",
        "Section 1, Introduction, third paragraph",
        "A vanishing electric field is equivalent to an uncharged top.",
        zero_field,
        words="the electric field vanishes (or, equivalently, the top is uncharged)",
    ),
    Claim(
        "charged-jacobi",
        "Section 2, The Charged Heavy Top, equation (2)",
        "The semidirect bracket is a Poisson bracket.",
        charged_jacobi,
        words="can be generated by a Lie–Poisson bracket with a semidirect product structure",
    ),
    Claim(
        "charged-rigid-fields",
        "Section 2, The Charged Heavy Top, second paragraph",
        "The bracket gives a charged rigid body in two constant fields, which turn rigidly in the body frame.",
        charged_rotation,
        words="The vectors α and β, being fixed in space, rotate in the body frame.",
    ),
    Claim(
        "charged-casimirs",
        "Section 2, The Charged Heavy Top, displayed equation after (2)",
        "The Casimirs of the semidirect bracket are |α|², α·β and |β|².",
        charged_casimirs,
        words="The Casimir invariants of Eq. (2)",
    ),
    Claim(
        "charged-phase-space",
        "Section 2, The Charged Heavy Top, after the Casimirs",
        "α and β correspond one-to-one to Euler angles, so the phase space is T*SO(3).",
        charged_phase_space,
        words="there is a one-to-one mapping between α and β and Euler angles. The phase space of the motion is "
        "thus SO(3) × ℝ³ ≅ T*SO(3).",
    ),
    Claim(
        "charged-lagrange",
        "Section 2, The Charged Heavy Top, last paragraph",
        "With I₁ = I₂, a on the axis and b = 0 the charged top is the Lagrange top, with invariants H, l₃ and l·α.",
        charged_lagrange,
        words="the charged heavy top reduces to the Lagrange top",
    ),
    Claim(
        "charged-lagrange-coplanar",
        "Section 2, The Charged Heavy Top, last paragraph, in parentheses",
        "With b on the axis too, the top is integrable when forces and centre of charge are coplanar, (α × β)·b = 0.",
        coplanar_remark,
        words="There is also an integrable case with b = (0, 0, b₃)ᵀ and (α × β)·b = 0",
    ),
    Claim(
        "charged-integrable-cases",
        "Section 1, Introduction, last paragraph, and Section 2, last paragraph",
        "Some integrable charged tops are those with a symmetry axis that carries both centres.",
        integrable_list,
        words="some of its integrable cases",
    ),
)
