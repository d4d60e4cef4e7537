"""Claims of the canonical section: the matrices, the chart of a leaf, the potentials, and what the coordinates do."""

from __future__ import annotations

from typing import Any

from liepoisson.studies.twisted_top.claims.euler_angles import CanonicalChart, EulerAngles
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks
from liepoisson.studies.twisted_top.claims.phase_space import column, lagrange_top, substitution, symbolic_top

E1, E3 = (1, 0, 0), (0, 0, 1)


@checks("rotation-matrix")
def rotation_matrix(evidence: Evidence, _: Context) -> None:
    """A is a rotation."""
    from sympy import eye

    q = EulerAngles()
    evidence.zero("A Aᵀ = 1", (q.A * q.A.T - eye(3)).applyfunc(q.reduce))
    evidence.zero("det A = 1", q.reduce(q.A.det() - 1))


@checks("momentum-matrix")
def momentum_matrix(evidence: Evidence, context: Context) -> None:
    """The determinant of L^-1 is sin theta, and l = L p has the brackets of angular momentum."""
    q = EulerAngles()
    evidence.zero("det L⁻¹ = sin θ", q.reduce(q.L_inverse.det() - q.theta[1]))
    l = q.L * q.momenta
    bracket = context.bracket("epsilon")
    fields = bracket.fields["l"]
    here = substitution(fields, l)
    pairs = ((0, 1), (1, 2), (2, 0))
    residuals = [q.reduce(q.bracket(l[i], l[j]) - bracket(fields[i], fields[j]).subs(here)) for i, j in pairs]
    evidence.zero("the canonical brackets of l = Lp are those of the Lie–Poisson bracket", residuals)


@checks("matrix-lta")
def printed_product(evidence: Evidence, _: Context) -> None:
    """The product of L transposed and A."""
    from sympy import Matrix

    q = EulerAngles()
    (cf, sf), (ct, st) = q.phi, q.theta
    printed = Matrix([[-ct / st * sf, ct / st * cf, 1], [sf / st, -cf / st, 0], [cf, sf, 0]])
    product = (q.L.T * q.A).applyfunc(q.reduce)
    evidence.zero("LᵀA is the printed matrix", (product - printed).applyfunc(q.reduce))
    evidence.zero("the third row of A, e₃·A, does not contain ψ", [q.derivative(entry, 1) for entry in q.A.row(2)])
    evidence.zero("the entries of LᵀA do not contain ψ", [q.derivative(entry, 1) for entry in product])


@checks("l-dot-beta-momenta")
def l_dot_beta(evidence: Evidence, _: Context) -> None:
    """l.beta as a function of the momenta, for a general w."""
    from sympy import symbols

    q = EulerAngles()
    w = column(*symbols("w1:4"))
    l, beta = q.L * q.momenta, q.A * w
    evidence.zero("(Lp)·(Aw) = p·LᵀA w for every w", q.reduce(l.dot(beta) - q.momenta.dot(q.L.T * q.A * w)))


@checks("leaf-coordinates")
def leaf_coordinates(evidence: Evidence, context: Context) -> None:
    """The map lands on the leaf: the three Casimirs come out constant."""
    top = symbolic_top(context)
    for gauge, chart in _printed_charts():
        v, w, eta, _ = chart.constants
        image = substitution(top.bracket.variables, (*chart.angular_momentum, *chart.alpha, *chart.beta))
        values = (eta + v**2, v * w, w**2)
        for name, casimir, value in zip(("C₁", "C₂", "C₃"), top.casimirs, values, strict=True):
            residual = chart.reduce(casimir.subs(image, simultaneous=True) - value)
            evidence.zero(f"{gauge}: {name} = {('η + v²', 'vw', 'w²')[('C₁', 'C₂', 'C₃').index(name)]}", residual)
    l, alpha, beta = top.vectors
    C1, C2, C3 = top.casimirs
    v_perp = C1 - C2**2 / C3 - 2 * top.epsilon * l.dot(beta)
    evidence.zero(
        "v⊥² = C₁ − v² − 2ε l·β = |α|² − (α·β)²/β²", v_perp - alpha.dot(alpha) + alpha.dot(beta) ** 2 / beta.dot(beta)
    )


@checks("v-perp-zero-iff-collinear")
def collinear_iff(evidence: Evidence, context: Context) -> None:
    """v_perp vanishes exactly for collinear fields, if beta is not zero."""
    _, alpha, beta = symbolic_top(context).vectors
    v_perp = alpha.dot(alpha) - alpha.dot(beta) ** 2 / beta.dot(beta)
    normal = alpha.cross(beta)
    evidence.zero("v⊥² = |α × β|²/|β|²", v_perp - normal.dot(normal) / beta.dot(beta))
    evidence.note("So v⊥² ≥ 0, and it is zero exactly when α × β = 0 (α = 0 included); for β = 0 it is not defined.")


@checks("l-dot-beta-rate")
def rate_of_l_dot_beta(evidence: Evidence, context: Context) -> None:
    """The rate of l.beta, for any b."""
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    rate = 2 * top.epsilon * top.rate(l.dot(beta))
    evidence.zero("2ε d(l·β)/dt = −d|α|²/dt", rate + top.rate(alpha.dot(alpha)))
    evidence.zero("= −2ε a·(α × β), for every b", rate + 2 * top.epsilon * top.a.dot(alpha.cross(beta)))


@checks("canonical-bracket")
def canonical_form(evidence: Evidence, context: Context) -> None:
    """The canonical brackets of the images, for any orthonormal pair of space-fixed vectors."""
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


@checks("potential-e3-e1", parallel=E3, perpendicular=E1)
@checks("potential-e1-e3", parallel=E1, perpendicular=E3)
def potential(evidence: Evidence, context: Context, parallel: tuple[int, ...], perpendicular: tuple[int, ...]) -> None:
    """The potential for these two unit vectors and w = 1."""
    from sympy import Symbol

    chart = CanonicalChart(parallel, perpendicular)
    q = chart.angles
    v, w, _, r = chart.constants
    (cf, sf), (ct, st) = q.phi, q.theta
    p_phi, p_psi, p_theta = q.momenta
    a3 = Symbol("a3")
    top = lagrange_top(context)
    potential = (top.hamiltonian - top.vectors[0].dot(top.omega) / 2).subs(substitution(top.vectors[1], chart.alpha))
    l_beta = q.reduce(chart.angular_momentum.dot(chart.beta).subs(w, 1))
    if parallel == E3:
        evidence.zero("l·β = p_φ", l_beta - p_phi)
        evidence.zero("V = a₃(v cos θ + r sin θ sin φ), r = √(η − 2ε p_φ)", potential - a3 * (v * ct + r * st * sf))
    else:
        printed = -p_phi * ct / st * sf + p_psi * sf / st + p_theta * cf
        evidence.zero("l·β = −p_φ cot θ sin φ + p_ψ csc θ sin φ + p_θ cos φ", q.reduce(l_beta - printed))
        evidence.zero("V = a₃(v sin θ sin φ + r cos θ), r = √(η − 2ε l·β)", potential - a3 * (v * st * sf + r * ct))


@checks("canonical-potential")
def general_potential(evidence: Evidence, context: Context) -> None:
    """The potential for general a, b and general space-fixed vectors."""
    from sympy import symbols

    q = EulerAngles()
    top = symbolic_top(context)
    l, alpha, beta = top.vectors
    e_par, e_perp = column(*symbols("e1:4")), column(*symbols("f1:4"))
    v, w, r = symbols("v w r")
    image = substitution((*alpha, *beta), (*(q.A * (v * e_par + r * e_perp)), *(w * q.A * e_par)))
    potential = (top.hamiltonian - l.dot(top.omega) / 2).subs(image)
    printed = (v * top.a + w * top.b).dot(q.A * e_par) + r * top.a.dot(q.A * e_perp)
    evidence.zero("a·α + b·β = (va + wb)·A e∥ + r a·A e⊥, r = √(η − 2ε l·β)", potential - printed)


@checks("gauge-limits")
def gauge_limits(evidence: Evidence, _: Context) -> None:
    """Which gauge has the form of the Lagrange top without twist."""
    for name, chart in _printed_charts():
        q, (v, _, _, r) = chart.angles, chart.constants
        V = chart.alpha[2].subs(v, 0)
        slope = q.derivative(V, 0)
        if chart.parallel == E1:
            evidence.zero(f"{name}, ε = v = 0: V/a₃ = r cos θ with r = √η, the Lagrange top", V - r * q.theta[0])
        else:
            evidence.nonzero(f"{name}, ε = 0: V/a₃ = v cos θ + √η sin θ sin φ still contains φ", slope)


@checks("lagrange-cyclic-psi")
def cyclic_psi(evidence: Evidence, context: Context) -> None:
    """The angle psi does not occur in the Hamiltonian of the twisted Lagrange top, and p_psi = l3."""
    for name, chart in _printed_charts():
        q = chart.angles
        top = lagrange_top(context)
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


def _kinetic_energy(q: EulerAngles, inertia: Any) -> Any:
    """The kinetic energy of a top with I1 = I2 in Euler angles."""
    p_phi, p_psi, p_theta = q.momenta
    cosine, sine = q.theta
    horizontal = p_theta**2 + (p_phi - p_psi * cosine) ** 2 / sine**2
    return horizontal / (2 * inertia[0]) + p_psi**2 / (2 * inertia[2])


@checks("angles-from-fields")
def angles_from_fields(evidence: Evidence, _: Context) -> None:
    """The orientation is a function of alpha and beta alone."""
    from sympy import simplify

    chart = CanonicalChart(E3, E1)
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


def _printed_charts() -> tuple[tuple[str, CanonicalChart], ...]:
    return (
        ("e∥ = e₃, e⊥ = e₁", CanonicalChart(E3, E1)),
        ("e∥ = e₁, e⊥ = e₃", CanonicalChart(E1, E3)),
    )


@checks("euler-singularity-inflated")
def inflated(evidence: Evidence, context: Context) -> None:
    """Quaternions remove the poles of the Euler angles; the square root needs one plane more."""
    _poles_and_root(evidence, context)
    _with_a_plane(evidence, context)


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
    from sympy import Matrix, Rational, Symbol, eye, symbols

    q, p = symbols("q0:4"), symbols("p0:4")
    X, Y, v, w, epsilon = *symbols("X Y v w"), Symbol("epsilon")
    N = sum(x**2 for x in q)
    u = column(*q[1:])
    turn: Any = Matrix([[0, -q[3], q[2]], [q[3], 0, -q[1]], [-q[2], q[1], 0]])  # times v it is u x v
    # A |q|^2 takes space to body components, and the body angular momentum is G p/2.
    rotation: Any = (q[0] ** 2 - u.dot(u)) * eye(3) + 2 * u * u.T - 2 * q[0] * turn
    G: Any = Matrix.hstack(-u, q[0] * eye(3) - turn)

    def bracket(f: Any, g: Any) -> Any:
        turning = sum(f.diff(x) * g.diff(y) - f.diff(y) * g.diff(x) for x, y in zip(q, p, strict=True))
        return turning - epsilon * w * (f.diff(X) * g.diff(Y) - f.diff(Y) * g.diff(X))

    l: Any = Rational(1, 2) * G * Matrix(p)
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


@checks("twist-in-hamiltonian")
def twist_in_hamiltonian(evidence: Evidence, context: Context) -> None:
    """In the paper's coordinates only the potential contains the twist, and the momenta; not at collinear states."""
    from sympy import Symbol, symbols

    q = EulerAngles()
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
