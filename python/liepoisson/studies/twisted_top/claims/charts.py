"""Remarks of the canonical section on what the coordinates do: to the singularities, and to the twist."""

from __future__ import annotations

from typing import Any

from liepoisson.model.charts.euler_angles import EulerAngles
from liepoisson.model.charts.quaternion_chart import body_rotation, left_matrix
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import column, substitution, symbolic_top


def inflated(context: Context) -> Verdict:
    """Quaternions remove the poles of the Euler angles; the square root needs one plane more."""
    evidence = Evidence()
    _poles_and_root(evidence, context)
    _with_a_plane(evidence, context)
    return evidence.conclude(
        "holds with a condition",
        "True of the singularity sin θ = 0: quaternions, or rotation matrices, have none. It is not the only one: "
        "the root r = √(η − 2ε l·β) is singular where α and β are collinear, and these states are reached. They need "
        "one plane more, with coordinates X, Y and {X, Y} = −εw: α = A(X e₁ + Y e₂ + v e₃), β = w A e₃.",
    )


def _poles_and_root(evidence: Evidence, context: Context) -> None:
    """The two singularities of the paper's coordinates lie at different states."""
    from sympy import Symbol

    q = EulerAngles()
    evidence.zero("det L⁻¹ = sin θ", q.reduce(q.L_inverse.det() - q.theta[1]))
    top = symbolic_top(context)
    _, alpha, beta = top.vectors
    state = substitution((*alpha, *beta), (0, 0, 0, 1, 0, 0))
    sine = (beta[0] ** 2 + beta[1] ** 2) / beta.dot(beta)
    root = alpha.dot(alpha) - alpha.dot(beta) ** 2 / beta.dot(beta)
    evidence.counterexample(
        "collinear fields far from the poles: β = w A e₃ has the third component w cos θ",
        {"sin²θ": (sine.subs(state), 1), "r²": (root.subs(state), 0)},
        "l = α = (0, 0, 0), β = (1, 0, 0)",
    )
    r, epsilon, eta, product = Symbol("r", positive=True), Symbol("epsilon"), Symbol("eta"), Symbol("k")
    slope = (eta - 2 * epsilon * product).diff(product) / (2 * r)
    evidence.zero("with k = l·β: ∂r/∂k = −ε/r, without bound where r → 0", slope + epsilon / r)


def _with_a_plane(evidence: Evidence, context: Context) -> None:
    """With quaternions and a plane the map is Poisson: no root, and no division but by the length of q."""
    from sympy import Matrix, Rational, Symbol, symbols

    q, p = symbols("q0:4"), symbols("p0:4")
    X, Y, v, w, epsilon = *symbols("X Y v w"), Symbol("epsilon")
    N = sum(x**2 for x in q)
    rotation: Any = Matrix(body_rotation(q))

    def bracket(f: Any, g: Any) -> Any:
        turning = sum(f.diff(x) * g.diff(y) - f.diff(y) * g.diff(x) for x, y in zip(q, p, strict=True))
        return turning - epsilon * w * (f.diff(X) * g.diff(Y) - f.diff(Y) * g.diff(X))

    l: Any = Rational(1, 2) * Matrix(left_matrix(q)) * Matrix(p)
    fields = (*(rotation * column(X, Y, v)), *(w * rotation[:, 2]))
    evidence.zero(
        "l = Gp/2, the angular momentum in quaternions q with momenta p: {|q|², l} = 0", [bracket(N, x) for x in l]
    )
    J: Any = context.bracket("epsilon").poisson_tensor()
    images = (*l, *fields)
    here = substitution(context.bracket("epsilon").variables, images)
    # The fields times |q|^2, which commutes with everything: polynomials, so that nothing is divided.
    residuals = [
        (bracket(images[i], images[j]) - (N if j >= 3 else 1) * J[i, j].subs(here, simultaneous=True)).expand()
        for i in range(9)
        for j in range(i)
    ]
    evidence.zero(
        "all 36 brackets of l = Gp/2, α = A(X e₁ + Y e₂ + v e₃), β = wAe₃ are those of the Leibniz bracket, also where "
        "X = Y = 0 (α and β collinear)",
        residuals,
        decisive=True,
    )


def twist_in_hamiltonian(context: Context) -> Verdict:
    """In the paper's coordinates only the potential contains the twist, and the momenta; not at collinear states."""
    from sympy import Symbol, symbols

    evidence, q = Evidence(), EulerAngles()
    w, r, epsilon = *symbols("w r"), Symbol("epsilon")
    e_par, e_perp, a = column(*symbols("e1:4")), column(*symbols("f1:4")), column(*symbols("a1:4"))
    strength = a.dot(q.A * e_perp)
    product = q.momenta.dot(q.L.T * q.A * (w * e_par))
    # V = (v a + w b).A e_par + r a.A e_perp with r^2 = eta - 2 epsilon l.beta, so dr = -(epsilon/r) d(l.beta).
    slopes = [-epsilon / r * product.diff(momentum) * strength for momentum in q.momenta]
    printed = -epsilon / r * strength * (q.L.T * q.A * (w * e_par))
    evidence.zero("∂V/∂p = −(ε/r)(a·A e⊥) LᵀA w, from equation (15) and l·β = p·LᵀA w", column(*slopes) - printed)
    evidence.nonzero("it is not zero for ε ≠ 0 and a ≠ 0: the potential depends on the momenta", slopes[0])
    evidence.zero("ε = 0: ∂V/∂p = 0, the charged top", [slope.subs(epsilon, 0) for slope in slopes])
    evidence.note("The canonical brackets of (q, p) contain no ε: see the claim on the canonical form of the bracket.")
    _with_a_plane(evidence, context)
    return evidence.conclude(
        "holds with a condition",
        "True where the coordinates exist, α × β ≠ 0 and sin θ ≠ 0: there V = (va + wb)·A e∥ + r a·A e⊥ with "
        "r = √(η − 2ε l·β) is the only term with ε, and it depends on p. In coordinates without that singularity, with "
        "one plane more and its coordinates X, Y, the twist is in the bracket again, {X, Y} = −εw, and the potential "
        "contains no momentum p.",
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "twist-in-hamiltonian",
        "Section 1, Introduction, last paragraph, and Section 4, equation (15)",
        "In canonical coordinates the twist moves from the bracket to the Hamiltonian, as a potential that depends on "
        "the momenta.",
        twist_in_hamiltonian,
        words="transferred from the bracket to the Hamiltonian, and appears as a term that can be interpreted as a "
        "momentum-dependent potential",
        follows_from="collinear-stays-collinear",
    ),
    Claim(
        "euler-singularity-inflated",
        "Section 4, Canonical Description, next paragraph after equation (14)",
        "The singularity of the canonical coordinates, sin θ = 0, can be avoided by inflating the phase space.",
        inflated,
        words="This singularity can be avoided by “inflating” the phase space",
        follows_from="collinear-stays-collinear",
    ),
)
