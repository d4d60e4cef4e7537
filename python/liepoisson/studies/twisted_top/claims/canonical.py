"""Claims of the section on the canonical description."""

from __future__ import annotations

from typing import Any

from liepoisson.model.charts.euler_angles import EulerAngles
from liepoisson.studies.twisted_top.claims.canonical_coordinates import CanonicalChart
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.model import Claim, Context, Verdict
from liepoisson.studies.twisted_top.claims.phase_space import column, substitution, symbolic_top

E1, E3 = (1, 0, 0), (0, 0, 1)


def _epsilon() -> Any:
    from sympy import Symbol

    return Symbol("epsilon")


def rotation_matrix(context: Context) -> Verdict:
    """A is a rotation."""
    del context
    from sympy import eye

    evidence, q = Evidence(), EulerAngles()
    evidence.zero("A Aᵀ = 1", (q.A * q.A.T - eye(3)).applyfunc(q.reduce))
    evidence.zero("det A = 1", q.reduce(q.A.det() - 1))
    return evidence.conclude("holds")


def momentum_matrix(context: Context) -> Verdict:
    """The determinant of L^-1 is sin theta, and l = L p has the brackets of angular momentum."""
    evidence, q = Evidence(), EulerAngles()
    evidence.zero("det L⁻¹ = sin θ", q.reduce(q.L_inverse.det() - q.theta[1]))
    l = q.L * q.momenta
    bracket = context.bracket("epsilon")
    fields = bracket.fields["l"]
    here = substitution(fields, l)
    pairs = ((0, 1), (1, 2), (2, 0))
    residuals = [q.reduce(q.bracket(l[i], l[j]) - bracket(fields[i], fields[j]).subs(here)) for i, j in pairs]
    evidence.zero("the canonical brackets of l = Lp are those of the Lie–Poisson bracket", residuals)
    return evidence.conclude("holds")


def printed_product(context: Context) -> Verdict:
    """The product of L transposed and A."""
    del context
    from sympy import Matrix

    evidence, q = Evidence(), EulerAngles()
    (cf, sf), (ct, st) = q.phi, q.theta
    printed = Matrix([[-ct / st * sf, ct / st * cf, 1], [sf / st, -cf / st, 0], [cf, sf, 0]])
    product = (q.L.T * q.A).applyfunc(q.reduce)
    evidence.zero("LᵀA is the printed matrix", (product - printed).applyfunc(q.reduce))
    evidence.zero("the third row of A, e₃·A, does not contain ψ", [q.derivative(entry, 1) for entry in q.A.row(2)])
    evidence.zero("the entries of LᵀA do not contain ψ", [q.derivative(entry, 1) for entry in product])
    return evidence.conclude("holds")


def l_dot_beta(context: Context) -> Verdict:
    """l.beta as a function of the momenta, for a general w."""
    del context
    from sympy import symbols

    evidence, q = Evidence(), EulerAngles()
    w = column(*symbols("w1:4"))
    l, beta = q.L * q.momenta, q.A * w
    evidence.zero("(Lp)·(Aw) = p·LᵀA w for every w", q.reduce(l.dot(beta) - q.momenta.dot(q.L.T * q.A * w)))
    return evidence.conclude("holds")


def leaf_coordinates(context: Context) -> Verdict:
    """The map lands on the leaf: the three Casimirs come out constant."""
    evidence = Evidence()
    top = symbolic_top(context)
    for gauge, chart in _printed_charts():
        v, w, eta, _ = chart.constants
        image = substitution(top.bracket.variables, (*chart.angular_momentum, *chart.alpha, *chart.beta))
        values = (eta + v**2, v * w, w**2)
        for name, casimir, value in zip(("C₁", "C₂", "C₃"), _bracket_casimirs(context), values, strict=True):
            residual = chart.reduce(casimir.subs(image, simultaneous=True) - value)
            evidence.zero(f"{gauge}: {name} = {('η + v²', 'vw', 'w²')[('C₁', 'C₂', 'C₃').index(name)]}", residual)
    l, alpha, beta = top.vectors
    C1, C2, C3 = top.casimirs
    v_perp = C1 - C2**2 / C3 - 2 * top.epsilon * l.dot(beta)
    evidence.zero(
        "v⊥² = C₁ − v² − 2ε l·β = |α|² − (α·β)²/β²", v_perp - alpha.dot(alpha) + alpha.dot(beta) ** 2 / beta.dot(beta)
    )
    return evidence.conclude("holds")


def collinear_iff(context: Context) -> Verdict:
    """v_perp vanishes exactly for collinear fields, if beta is not zero."""
    evidence = Evidence()
    _, alpha, beta = symbolic_top(context).vectors
    v_perp = alpha.dot(alpha) - alpha.dot(beta) ** 2 / beta.dot(beta)
    normal = alpha.cross(beta)
    evidence.zero("v⊥² = |α × β|²/|β|²", v_perp - normal.dot(normal) / beta.dot(beta))
    evidence.note("So v⊥² ≥ 0, and it is zero exactly when α × β = 0 (α = 0 included); for β = 0 it is not defined.")
    return evidence.conclude("holds with a condition", "True for β ≠ 0; for β = 0 the expression is 0/0.")


def rate_of_l_dot_beta(context: Context) -> Verdict:
    """The rate of l.beta, for any b."""
    evidence = Evidence()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    rate = 2 * top.epsilon * top.rate(l.dot(beta))
    evidence.zero("2ε d(l·β)/dt = −d|α|²/dt", rate + top.rate(alpha.dot(alpha)))
    evidence.zero("= −2ε a·(α × β), for every b", rate + 2 * top.epsilon * top.a.dot(alpha.cross(beta)))
    return evidence.conclude("holds")


def canonical_form(context: Context) -> Verdict:
    """The canonical brackets of the images, for any orthonormal pair of space-fixed vectors."""
    evidence = Evidence()
    bracket = context.bracket("epsilon")
    l, _, beta = bracket.fields.values()
    J: Any = bracket.poisson_tensor()
    q = EulerAngles()
    images = q.L * q.momenta
    here = substitution(l, images)
    residuals = [q.reduce(q.bracket(images[i], images[j]) - J[i, j].subs(here)) for i in range(3) for j in range(i)]
    evidence.zero("canonical {lᵢ, lⱼ} for l = Lp is the Lie–Poisson bracket", residuals)
    residuals = []
    for axis in (q.A.col(k) for k in range(3)):
        there = substitution(beta, axis)
        residuals += [
            q.reduce(q.bracket(images[i], axis[j]) - J[i, 6 + j].subs(there)) for i in range(3) for j in range(3)
        ]
    evidence.zero("canonical {lᵢ, Aⱼₖ} is the Lie–Poisson {lᵢ, βⱼ} with column k of A for β; {Aᵢⱼ, Aₖₘ} = 0", residuals)
    evidence.note("Linear in the columns, so also for n = A e∥ and u = A e⊥ with any fixed orthonormal e∥, e⊥.")
    evidence.zero(
        "hence for β = wn, α = vn + ru, r = √(η − 2ε l·β) all 36 brackets are those of the Leibniz bracket",
        _leaf_residual(bracket),
    )
    evidence.note("(compared at n = e₃, u = e₁ with any l, to which l·axis rotates every point by Poisson maps)")
    evidence.note("The division by r needs r ≠ 0, and L needs sin θ ≠ 0; for w = 0 there is no leaf of dimension 6.")
    return evidence.conclude(
        "holds with a condition",
        "True where η − 2ε l·β > 0 (α and β not collinear), β ≠ 0 and sin θ ≠ 0.",
    )


def _leaf_residual(bracket: Any) -> Any:
    """D Pi D^T - J for x = (l, v n + r u, w n), where Pi holds the brackets of l, u, n, at n = e3, u = e1."""
    from sympy import Matrix, Symbol, symbols, zeros

    l, alpha, beta = bracket.fields.values()
    u, n = column(*symbols("u1:4")), column(*symbols("n1:4"))
    v, w, r, epsilon = *symbols("v w r"), Symbol("epsilon")
    J: Any = bracket.poisson_tensor()
    vectors = [J[:3, 6:].subs(substitution(beta, vector), simultaneous=True) for vector in (u, n)]
    upper: Any = Matrix.hstack(J[:3, :3], *vectors)
    Pi: Any = Matrix.vstack(upper, Matrix.hstack(-upper[:, 3:].T, zeros(6, 6)))
    x = column(*l, *(v * n + r * u), *(w * n))
    z = column(*l, *u, *n)
    slope = Matrix(
        [*(-epsilon * w / r * n), 0, 0, 0, *(-epsilon * w / r * l)]
    ).T  # of r, from r^2 = eta - 2 epsilon w l.n
    D = x.jacobian(z) + x.diff(r) * slope
    residual = D * Pi * D.T - J.subs(substitution((*alpha, *beta), x[3:]), simultaneous=True)
    return residual.subs(substitution((*u, *n), (1, 0, 0, 0, 0, 1)))


def potential_first_gauge(context: Context) -> Verdict:
    """The potential for e_par = e3, e_perp = e1, w = 1."""
    return _potential(context, E3, E1)


def potential_second_gauge(context: Context) -> Verdict:
    """The potential for e_par = e1, e_perp = e3, w = 1."""
    return _potential(context, E1, E3)


def _potential(context: Context, parallel: tuple[int, ...], perpendicular: tuple[int, ...]) -> Verdict:
    from sympy import Symbol

    evidence = Evidence()
    chart = CanonicalChart(parallel, perpendicular, _epsilon())
    q = chart.angles
    v, w, _, r = chart.constants
    (cf, sf), (ct, st) = q.phi, q.theta
    p_phi, p_psi, p_theta = q.momenta
    a3 = Symbol("a3")
    top = symbolic_top(context, inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, 0))
    potential = (top.hamiltonian - top.vectors[0].dot(top.omega) / 2).subs(substitution(top.vectors[1], chart.alpha))
    l_beta = q.reduce(chart.angular_momentum.dot(chart.beta).subs(w, 1))
    if parallel == E3:
        evidence.zero("l·β = p_φ", l_beta - p_phi)
        evidence.zero("V = a₃(v cos θ + r sin θ sin φ), r = √(η − 2ε p_φ)", potential - a3 * (v * ct + r * st * sf))
    else:
        printed = -p_phi * ct / st * sf + p_psi * sf / st + p_theta * cf
        evidence.zero("l·β = −p_φ cot θ sin φ + p_ψ csc θ sin φ + p_θ cos φ", q.reduce(l_beta - printed))
        evidence.zero("V = a₃(v sin θ sin φ + r cos θ), r = √(η − 2ε l·β)", potential - a3 * (v * st * sf + r * ct))
    return evidence.conclude("holds")


def general_potential(context: Context) -> Verdict:
    """The potential for general a, b and general space-fixed vectors."""
    from sympy import symbols

    evidence, q = Evidence(), EulerAngles()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    e_par, e_perp = column(*symbols("e1:4")), column(*symbols("f1:4"))
    v, w, r = symbols("v w r")
    image = substitution((*alpha, *beta), (*(q.A * (v * e_par + r * e_perp)), *(w * q.A * e_par)))
    potential = (top.hamiltonian - l.dot(top.omega) / 2).subs(image)
    printed = (v * top.a + w * top.b).dot(q.A * e_par) + r * top.a.dot(q.A * e_perp)
    evidence.zero("a·α + b·β = (va + wb)·A e∥ + r a·A e⊥, r = √(η − 2ε l·β)", potential - printed)
    return evidence.conclude("holds")


def gauge_limits(context: Context) -> Verdict:
    """Which gauge has the form of the Lagrange top without twist."""
    del context
    evidence = Evidence()
    for name, chart in _printed_charts():
        q, (v, _, _, r) = chart.angles, chart.constants
        V = chart.alpha[2].subs(v, 0)
        slope = q.derivative(V, 0)
        if chart.parallel == E1:
            evidence.zero(f"{name}, ε = v = 0: V/a₃ = r cos θ with r = √η, the Lagrange top", V - r * q.theta[0])
        else:
            evidence.nonzero(f"{name}, ε = 0: V/a₃ = v cos θ + √η sin θ sin φ still contains φ", slope)
    return evidence.conclude("holds")


def cyclic_psi(context: Context) -> Verdict:
    """The angle psi does not occur in the Hamiltonian of the twisted Lagrange top, and p_psi = l3."""
    evidence = Evidence()
    for name, chart in _printed_charts():
        q = chart.angles
        top = symbolic_top(context, inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, 0))
        image = substitution(top.bracket.variables, (*chart.angular_momentum, *chart.alpha, *chart.beta))
        H = top.hamiltonian.subs(image, simultaneous=True)
        kinetic = (top.vectors[0].dot(top.omega) / 2).subs(image, simultaneous=True)
        evidence.zero(
            f"{name}: T = p_θ²/2I₁ + (p_φ − p_ψ cos θ)²/(2I₁ sin²θ) + p_ψ²/2I₃",
            q.reduce(kinetic - _kinetic_energy(q, top.inertia)),
        )
        evidence.zero(f"{name}: ∂T/∂φ = ∂T/∂ψ = 0", [q.reduce(q.derivative(kinetic, k)) for k in (0, 1)])
        evidence.zero(
            f"{name}: ∂H/∂ψ = 0 (r contains ψ as little)",
            [q.reduce(q.derivative(H, 1)), q.derivative(chart.r_squared, 1)],
        )
        evidence.zero(f"{name}: p_ψ = l₃", q.reduce(chart.angular_momentum[2] - q.momenta[1]))
    return evidence.conclude("holds")


def _kinetic_energy(q: EulerAngles, inertia: Any) -> Any:
    """The kinetic energy of a top with I1 = I2 in Euler angles."""
    p_phi, p_psi, p_theta = q.momenta
    cosine, sine = q.theta
    horizontal = p_theta**2 + (p_phi - p_psi * cosine) ** 2 / sine**2
    return horizontal / (2 * inertia[0]) + p_psi**2 / (2 * inertia[2])


def angles_from_fields(context: Context) -> Verdict:
    """The orientation is a function of alpha and beta alone."""
    from sympy import simplify

    del context
    evidence = Evidence()
    chart = CanonicalChart(E3, E1, _epsilon())
    q = chart.angles
    v, w, _, r = chart.constants
    third = chart.beta / w
    first = (chart.alpha - v * third) / r
    evidence.zero("β/w is the third column of A, and fixes ψ and θ", third - q.A.col(2))
    evidence.zero(
        "(α − (α·β)β/β²)/r is its first column, and fixes φ; l does not occur", (first - q.A.col(0)).applyfunc(simplify)
    )
    evidence.zero(
        "β/w has components (sin ψ sin θ, cos ψ sin θ, cos θ)",
        third - column(q.psi[1] * q.theta[1], q.psi[0] * q.theta[1], q.theta[0]),
    )
    return evidence.conclude("holds with a condition", "True where α × β ≠ 0 and sin θ ≠ 0.")


def _printed_charts() -> tuple[tuple[str, CanonicalChart], ...]:
    return (
        ("e∥ = e₃, e⊥ = e₁", CanonicalChart(E3, E1, _epsilon())),
        ("e∥ = e₁, e⊥ = e₃", CanonicalChart(E1, E3, _epsilon())),
    )


def _bracket_casimirs(context: Context) -> tuple[Any, ...]:
    return symbolic_top(context).casimirs


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "rotation-matrix",
        "Section 4, Canonical Description, matrix A after equation (9)",
        "The printed matrix A is orthogonal.",
        rotation_matrix,
    ),
    Claim(
        "momentum-matrix",
        "Section 4, Canonical Description, equation (10) and the matrix L⁻¹ after it",
        "l = Lp maps canonical momenta to angular momentum, and det L⁻¹ = sin θ.",
        momentum_matrix,
    ),
    Claim(
        "leaf-coordinates",
        "Section 4, Canonical Description, equations (9) and (11) to (13)",
        "With β = Aw and α = A(v e∥ + √(η − 2ε l·β) e⊥) the Casimirs are constants: C₂ = vw, C₁ = η + v², C₃ = w².",
        leaf_coordinates,
    ),
    Claim(
        "v-perp-zero-iff-collinear",
        "Section 4, Canonical Description, after equation (12)",
        "v⊥² = 0 if and only if α and β are collinear.",
        collinear_iff,
        words="with v⊥² = 0 if and only if α and β are collinear",
    ),
    Claim(
        "l-dot-beta-rate",
        "Section 4, Canonical Description, equation (14)",
        "2ε d(l·β)/dt = −d|α|²/dt = −2ε a·(α × β).",
        rate_of_l_dot_beta,
    ),
    Claim(
        "angles-from-fields",
        "Section 4, Canonical Description, next paragraph after equation (14)",
        "The Euler angles are functions of α and β only, not of l.",
        angles_from_fields,
        words="the Euler angles are only a function of α and β, not of l",
        follows_from="collinear-stays-collinear",
    ),
    Claim(
        "canonical-bracket",
        "Section 4, Canonical Description, before equation (15)",
        "In the coordinates (q, p) the Leibniz bracket has the canonical form.",
        canonical_form,
        words="in the coordinates (q, p) the bracket (3) does indeed have the canonical form",
        follows_from="collinear-stays-collinear",
    ),
    Claim(
        "canonical-potential",
        "Section 4, Canonical Description, equation (15)",
        "The potential is (va + wb)·A e∥ + √(η − 2ε l·β) a·A e⊥.",
        general_potential,
    ),
    Claim(
        "l-dot-beta-momenta",
        "Section 4, Canonical Description, displayed equation after (15)",
        "l·β = p·LᵀA w.",
        l_dot_beta,
    ),
    Claim(
        "matrix-lta",
        "Section 4, Canonical Description, matrix LᵀA after equation (15)",
        "LᵀA is the printed matrix, independent of ψ.",
        printed_product,
    ),
    Claim(
        "lagrange-cyclic-psi",
        "Section 4, Canonical Description, next paragraph after equation (15)",
        "The kinetic energy is independent of φ and ψ, and ψ is cyclic, with p_ψ conserved.",
        cyclic_psi,
        words="in the twisted Lagrange top case ψ is cyclic (p_ψ conserved)",
    ),
    Claim(
        "potential-e3-e1",
        "Section 4, Canonical Description, last paragraph",
        "For e∥ = e₃, e⊥ = e₁, w = 1: V = a₃(v cos θ + √(η − 2ε p_φ) sin θ sin φ).",
        potential_first_gauge,
        words="A particularly simple choice is e∥ = e₃, e⊥ = e₁, w = 1",
    ),
    Claim(
        "potential-e1-e3",
        "Section 4, Canonical Description, last paragraph",
        "For e∥ = e₁, e⊥ = e₃, w = 1: V = a₃(v sin θ sin φ + √(η − 2ε l·β) cos θ), with the printed l·β.",
        potential_second_gauge,
        words="The choice e⊥ = e₃, e∥ = e₁, w = 1",
    ),
    Claim(
        "gauge-limits",
        "Section 4, Canonical Description, last paragraph",
        "For ε → 0 the second choice has the form of the Lagrange top when v = 0, the first does not.",
        gauge_limits,
        words="has the Lagrange top form when v = ε = 0",
    ),
)
