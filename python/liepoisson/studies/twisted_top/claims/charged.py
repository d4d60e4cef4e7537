"""Claims of the introduction and of the section on the charged heavy top."""

from __future__ import annotations

from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks
from liepoisson.studies.twisted_top.claims.phase_space import (
    COLLINEAR,
    GENERIC_POINT,
    SymbolicTop,
    column,
    complete_integrability,
    lagrange_top,
    strata_steps,
    substitution,
    symbolic_top,
)
from liepoisson.studies.twisted_top.typography import show


@checks("lagrange-centre-of-rotation")
def centre_of_rotation(evidence: Evidence, context: Context) -> None:
    """It is the centre of mass that must lie on the axis."""
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


@checks("zero-field-equals-uncharged")
def zero_field(evidence: Evidence, context: Context) -> None:
    """Zero charge leaves the twist, zero field removes it."""
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


@checks("charged-rigid-fields")
def charged_rotation(evidence: Evidence, context: Context) -> None:
    """The equations of the charged top: both fields rotate rigidly in the body frame."""
    top = symbolic_top(context, epsilon=0)
    l, alpha, beta = top.vectors
    torque = l.cross(top.omega) + alpha.cross(top.a) + beta.cross(top.b)
    evidence.zero("dl/dt = l × ω + α × a + β × b", top.rate(l) - torque)
    evidence.zero("dα/dt = α × ω", top.rate(alpha) - alpha.cross(top.omega))
    evidence.zero("dβ/dt = β × ω", top.rate(beta) - beta.cross(top.omega))
    evidence.note("All with symbolic I, a, b: α and β are fixed in space and turn rigidly in the body frame.")


@checks("charged-phase-space")
def charged_phase_space(evidence: Evidence, context: Context) -> None:
    """The fields fix an orientation where they are independent, and only there."""
    from sympy import Matrix, Symbol

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
    rank = evidence.rank("rank of J at a point with α = 2β", bracket, COLLINEAR, 4)
    evidence.note("Everywhere, by the Pfaffians of J:")
    pair = ("alpha", "beta")
    wanted = {
        lp.brackets.Locus(not_parallel=(pair,)): 6,
        lp.brackets.Locus(parallel=(pair,), nonzero=(pair,)): 4,
        lp.brackets.Locus(zero=("beta", "alpha"), nonzero=(("l",),)): 2,
        lp.brackets.Locus(zero=("beta", "alpha", "l")): 0,
    }
    strata_steps(evidence, bracket, wanted)
    evidence.data = {"rank_independent": independent, "rank_parallel": rank}


@checks("charged-lagrange")
def charged_lagrange(evidence: Evidence, context: Context) -> None:
    """H, l3 and l.alpha of the Lagrange top in the charged phase space."""
    top = lagrange_top(context, epsilon=0)
    l, alpha, _ = top.vectors
    integrals = {"H": top.hamiltonian, "l₃": l[2], "l·α": l.dot(alpha)}
    complete_integrability(evidence, top, integrals)


@checks("charged-lagrange-coplanar")
def coplanar_remark(evidence: Evidence, context: Context) -> None:
    """The charged Lagrange top is integrable without the coplanarity, which is not even preserved."""
    from sympy import Symbol

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


def _coplanarity_rate(top: SymbolicTop) -> Any:
    """The rate of (alpha x beta).b for I1 = I2 and both centres on the axis."""
    l, alpha, beta = top.vectors
    moment, a3, b3 = top.inertia[0], top.a[2], top.b[2]
    turning = beta[2] * (alpha[0] * l[0] + alpha[1] * l[1]) - alpha[2] * (beta[0] * l[0] + beta[1] * l[1])
    return b3 / moment * (turning + top.epsilon * a3 * moment * (beta[0] ** 2 + beta[1] ** 2))


@checks("charged-integrable-cases")
def integrable_list(evidence: Evidence, context: Context) -> None:
    """Two further integrable families of charged tops, with complete sets of integrals."""
    from sympy import Symbol

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
        known = lp.Top(inertia=tuple(top.inertia), a=tuple(top.a), b=tuple(top.b), epsilon=0).invariants
        found = {name: integral for name, integral in known.items() if name not in ("H", "C1", "C2", "C3")}
        evidence.note(title)
        complete_integrability(evidence, top, {"H": top.hamiltonian, **found})
        data[title] = {name: str(value) for name, value in found.items()}
    evidence.data = data
