r"""The bifurcations of the twisted Lagrange top: critical values, classes of leaves, tori and their monodromy.

All follows from $M(\lambda) = \lambda^3e_3 + \lambda^2l + \lambda\alpha + \epsilon\beta$ (for $I_1 = a_3 = 1$), whose
square has the integrals and the Casimirs for coefficients.  The identities are verified on the bracket; docs/
twisted-lagrange.md puts them together.

References: [musso2005] for the Lax matrix; H. R. Dullin, M. Juhnke and P. H. Richter, Int. J. Bifurcation Chaos 4
(1994) 1535 (the Kovalevskaya top).
"""

from __future__ import annotations

from typing import Any

import numpy as np

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks
from liepoisson.studies.twisted_top.claims.phase_space import UNCHARGED, SymbolicTop, column, symbolic_top

LEAVES = {
    "AA": (-5, 0),
    "AU": (0, 2),
    "UU-": (0, "1/5"),
    "UU+": (8, 1),
    "BU": (20, "3.58"),
    "AB": (35, 5),
}
"""C1 and C2 of a leaf of each class, for epsilon = C3 = 1."""
_BY_FLOWS = "UU-"
"""The class whose loops are followed by closing flows, too."""


@checks("lagrange-bifurcations")
def lagrange_bifurcations(evidence: Evidence, context: Context) -> None:
    """The critical set and its types, the diagram, the classes of leaves, the tori and their monodromy."""
    top = symbolic_top(context, inertia=(1, 1, "I3"), a=(0, 0, 1), b=UNCHARGED)
    _curve(evidence, top)
    _critical_set(evidence, top)
    _diagram(evidence)
    _classes(evidence)
    _lattice(evidence)
    _monodromy(evidence)
    if all(step.succeeded is not False for step in evidence.steps):
        _numbers(evidence)


def _matrix(top: SymbolicTop, at: Any) -> Any:
    """M at a value of lambda."""
    l, alpha, beta = top.vectors
    return at**3 * column(0, 0, 1) + at**2 * l + at * alpha + top.epsilon * beta


def _curve(evidence: Evidence, top: SymbolicTop) -> None:
    """State the Lax equation, the coefficients of R, and the flow of each value of R."""
    from sympy import Poly, symbols

    x, mu = symbols("lambda mu")
    l, alpha, beta = top.vectors
    M, axis = _matrix(top, x), column(0, 0, 1)
    evidence.note(
        "I = (1, 1, I₃), a = (0, 0, 1), b = 0; other I₁ and a₃ are scalings, and for b ∥ a the map α → α + (b₃/a₃)β of "
        "the phase space removes b. Let M(λ) = λ³e₃ + λ²l + λα + εβ and R = M·M; ε ≠ 0 and β ≠ 0."
    )
    evidence.zero(
        "M changes by dM/dt = M × (ω + λe₃)", M.applyfunc(top.rate) - M.cross(top.omega + x * axis), decisive=True
    )
    h = top.hamiltonian - (1 / top.inertia[2] - 1) * l[2] ** 2 / 2
    P = l.dot(alpha) + top.epsilon * beta[2]
    one, two, three = top.casimirs
    wanted = [1, 2 * l[2], 2 * h, 2 * P, one, 2 * top.epsilon * two, top.epsilon**2 * three]
    found = Poly(M.dot(M).expand(), x).all_coeffs()
    evidence.zero(
        "R = λ⁶ + 2l₃λ⁵ + 2hλ⁴ + 2Pλ³ + C₁λ² + 2εC₂λ + ε²C₃ with h = H − (1/I₃ − 1)l₃²/2",
        [a - b for a, b in zip(found, wanted, strict=True)],
        decisive=True,
    )
    N = _matrix(top, mu)
    value = N.dot(N) / 2
    evidence.zero(
        "the flow of |M(μ)|²/2 is M′(λ) = −μ³M(λ) × M(μ)/(λ − μ), so that all of these commute",
        (x - mu) * M.applyfunc(lambda entry: top.bracket(entry, value)) + mu**3 * M.cross(N),
        decisive=True,
    )


def _critical_set(evidence: Evidence, top: SymbolicTop) -> None:
    """State where the integrals are dependent, and the types of these states."""
    from sympy import symbols

    mu = symbols("mu")
    evidence.note(
        "dR = 2M·dM, where dM is any vector of polynomials of degree 2. M₃ is monic of degree 3: the sums ΣMᵢfᵢ with "
        "deg fᵢ ≤ 2 are all multiples of degree ≤ 5 of the greatest common divisor q of M₁, M₂, M₃ (multiples of M₃, "
        "and modulo M₃ the ideal of q). So the coefficients of R have the rank 6 − deg q, and on the leaf l₃, H and P "
        "have the rank 3 − deg q."
    )
    # Near a state with M(mu) = 0, M = (lambda - mu) N, the perturbation at mu turns about N(mu).
    N, d = column(*symbols("N1:4")), column(*symbols("d1:4"))
    turning = -(mu**3) * N.cross(d)
    s = symbols("s")
    characteristic = turning.jacobian(list(d)).charpoly(s).as_expr()
    evidence.zero(
        "where M = (λ − μ)N the linearised flow of |M(μ)|²/2 takes δM(μ) to −μ³N(μ) × δM(μ), with the characteristic "
        "polynomial s(s² + μ⁶N(μ)·N(μ))",
        characteristic - s * (s**2 + mu**6 * N.dot(N)),
    )
    evidence.note(
        "A real root of q is elliptic, of frequency |μ|³|N(μ)|. A complex one, with its conjugate, is focus-focus: the "
        "real parts of all multiples of |M(μ)|²/2 have the eigenvalues ±ζ and their conjugates, ζ any complex number. "
        "Nothing is hyperbolic. N(μ)·N(μ) is R/(λ − μ)² at μ, and zero only where R has a root more than twice: a real "
        "one four times, or R = q³."
    )


def _diagram(evidence: Evidence) -> None:
    """State the image, the curves of rank 1 and their ends."""
    from sympy import Poly, symbols

    x, g, k, c1, c2, c3 = symbols("lambda g k c1 c2 c3")
    evidence.note(
        "A value is attained exactly where R ≥ 0 on the real line: R = |M|², and conversely R = p² + f² with p monic "
        "of degree 3 and deg f ≤ 2, and M = (f, 0, p). The image is convex in l₃, h and P. Where R has a double real "
        "root the value is on its boundary."
    )
    nu = g**2 * (c2 - k * c3)
    square = (x**2 + k * x / g + 1 / g) ** 2 * (x**2 + 2 * nu * x + c3 * g**2)
    found = Poly(square.expand(), x).all_coeffs()
    relation = 3 * c3 * k**2 - 4 * c2 * k + c1 - 1 / g**2 - 2 * c3 * g
    evidence.zero(
        "rank 1: R = q²(λ² + 2νλ + c₃g²), q = λ² + kλ/g + 1/g, has the coefficients c₁, 2c₂, c₃ of a leaf (c₁ = C₁, "
        "c₂ = εC₂, c₃ = ε²C₃) exactly where ν = g²(c₂ − kc₃) and 3c₃k² − 4c₂k + c₁ = 1/g² + 2c₃g",
        [found[-1] - c3, found[-2] - 2 * c2, found[-3] - c1 + relation],
        decisive=True,
    )
    evidence.note(
        "With ν² ≤ c₃g² these are the relative equilibria M = q(λe₃ + n). Where k² < 4g their values are threads, "
        "curves of focus-focus values in the interior; the others are edges of the boundary. They meet where q = "
        "(λ − μ)², at Hamiltonian Hopf points, and end there or where M = Qe₃ vanishes with q, at the sleeping tops."
    )


def _classes(evidence: Evidence) -> None:
    """State the sleeping tops, the walls between the classes, and which classes small epsilon has."""
    from sympy import Poly, discriminant, symbols

    x, e, c, c1, t = symbols("lambda e c c1 t")
    cubic = x**3 + e * x**2 + c * x + 1
    found = Poly((cubic**2).expand(), x).all_coeffs()
    evidence.zero(
        "in units in which c₃ = 1, rank 0: R = Q² exactly for Q = λ³ + eλ² + c₂λ + 1, or with opposite signs of all "
        "but λ³, e = (c₁ − c₂²)/2: two sleeping tops on each leaf",
        [found[-3].subs(e, (c1 - c**2) / 2) - c1, found[-2] - 2 * c],
    )
    wall = e**2 * c**2 - 4 * c**3 - 4 * e**3 + 18 * e * c - 27
    evidence.zero(
        "Q has a double root where e²c² − 4c³ − 4e³ + 18ec − 27 = 0, c = ±c₂: walls, where a sleeping top changes "
        "between stable (three real roots, of both signs, A, or of one, B) and unstable (U)",
        discriminant(cubic, x) - wall,
        decisive=True,
    )
    cube = Poly(((x**2 + t * x + 1) ** 3).expand(), x).all_coeffs()
    evidence.zero(
        "R = q³ for q = λ² + tλ + 1 where c₂ = 3t/2 and c₁ = 3 + 4c₂²/3: the wall, |c₂| < 3, on which two threads meet "
        "and exchange their ends (UU− below, UU+ above)",
        [cube[-2] - 2 * (3 * t / 2), cube[-3] - 3 - 3 * t**2],
        decisive=True,
    )
    _no_other_walls(evidence)
    one, two = symbols("C1 C2")
    lead = Poly(wall.subs({e: t**2 * (one - two**2) / 2, c: t * two}).expand(), t).LC()
    evidence.zero(
        "C₃ = 1, ε → 0: c₁ = C₁t², c₂ = C₂t with t = ε^(−2/3), and the walls are at e²(C₂² − 4e) = 0 to leading order, "
        "e = (C₁ − C₂²)/2: the class is UU+ for C₂² < 2C₁/3 and AB for 2C₁/3 < C₂² < C₁",
        lead - ((one - two**2) / 2) ** 2 * (3 * two**2 - 2 * one),
    )


def _no_other_walls(evidence: Evidence) -> None:
    """State that edges and threads change nowhere else."""
    from sympy import Poly, cancel, symbols

    mu, g, k, c1, c2 = symbols("mu g k c1 c2")
    relation = 3 * k**2 - 4 * c2 * k + c1 - 1 / g**2 - 2 * g
    hopf = mu**6 - c1 * mu**2 - 8 * c2 * mu - 10
    evidence.zero(
        "c₃ = 1: at a Hamiltonian Hopf point q = (λ − μ)² the relation of the curve is μ⁶ − c₁μ² − 8c₂μ − 10 = 0",
        cancel(relation.subs({g: mu**-2, k: -2 / mu}) * mu**2 + hopf),
    )
    double: Any = {c2: -(mu**6 + 5) / (2 * mu), c1: (5 * mu**6 + 10) / mu**2}
    evidence.zero(
        "two of them meet where c₂ = −(μ⁶ + 5)/2μ; there (c₂μ + 2)² − μ⁶ = (μ⁶ − 1)²/4, which must not be positive: "
        "only for μ = ±1, at the cusps c₁ = 15, c₂ = ∓3 of the walls",
        [
            *(cancel(f.subs(double)) for f in (hopf, hopf.diff(mu))),
            ((c2 * mu + 2) ** 2 - mu**6 - (mu**6 - 1) ** 2 / 4).subs(double).expand(),
            *(double[c1].subs(mu, s) - 15 for s in (1, -1)),
            *(double[c2].subs(mu, s) + 3 * s for s in (1, -1)),
        ],
        decisive=True,
    )
    crossing = {g: 1, k: 2 * c2 / 3}
    evidence.zero(
        "the curve is singular only at g = 1, k = 2c₂/3, which has c₁ = 3 + 4c₂²/3 and ν = c₂/3, admitted for |c₂| ≤ 3",
        [
            *(relation.diff(v).subs(crossing) for v in (g, k)),
            relation.subs(crossing) - (c1 - 3 - 4 * c2**2 / 3),
            Poly((relation.diff(g) * g**3 / 2).expand(), g).as_expr() - (1 - g**3),
        ],
        decisive=True,
    )
    evidence.note(
        "It is a saddle of the relation, so that no closed curve is born. As g → 0 the curve has four ends, at "
        "infinity, with ν/g → ±1/√3. Edges and threads and their ends are the same on all leaves between the walls."
    )


def _lattice(evidence: Evidence) -> None:
    """State the basis of the period lattice by the one at a stable sleeping top."""
    from sympy import cancel, symbols

    x = symbols("lambda")
    roots = symbols("mu1:4")
    Q = ((x - roots[0]) * (x - roots[1]) * (x - roots[2])).expand()
    slope = Q.diff(x)
    off: list[Any] = []
    for j, near in enumerate(roots):
        for k, mode in enumerate(roots):
            rate = near**2 + (Q.coeff(x, 2) + mode) * near + Q.coeff(x, 1) + Q.coeff(x, 2) * mode + mode**2
            off.append(cancel(rate / slope.subs(x, near)) - (j == k))
    evidence.note(
        "Inside R has the zeros z₁, z₂, z₃ of the upper half-plane, by their real parts, and their conjugates. Let γⱼ "
        "be 2∫(λ², λ, 1)dλ/(i√R) from the conjugate of zⱼ straight up to zⱼ, √R > 0 on the real line. The flows of l₃, "
        "h, P are M′ = M × e₃, M × (l + λe₃), M × (α + λl + λ²e₃): at M = Qe₃ they turn δM(μₖ) about e₃ at the rates "
        "1, l₃ + μₖ, α₃ + l₃μₖ + μₖ²."
    )
    evidence.zero(
        "at a stable sleeping top γⱼ = 2π(μⱼ², μⱼ, 1)/|Q′(μⱼ)|, and after these times the mode k has turned by ±2πδⱼₖ",
        off,
        decisive=True,
    )
    evidence.note(
        "It is the only state with its values. The fibres near to it are one torus. By the theorem on Lax pairs the "
        "periods are integrals over cycles of the curve, and those of other cycles than the γⱼ are not real near to "
        "it: the γⱼ are a basis. So they are over all R > 0 with distinct zeros, on all leaves: a connected set."
    )
    sums = [cancel(sum(r**n / slope.subs(x, r) for r in roots)) - (n == 2) for n in range(3)]
    evidence.zero("γ₁ − γ₂ + γ₃ = (2π, 0, 0), the circle of l₃: the residue of √R at infinity", sums)


def _monodromy(evidence: Evidence) -> None:
    """State how half turns of two zeros carry the lattice."""
    from sympy import Matrix, eye

    first: Any = Matrix([[0, 1, 0], [-1, 2, 0], [0, 0, 1]])
    second: Any = Matrix([[1, 0, 0], [0, 0, 1], [0, -1, 2]])
    circle: Any = Matrix([[1, -1, 1]])
    plane: Any = Matrix([[1, -1, 0], [0, 1, -1]])
    evidence.note(
        "While a zero passes above another one nothing crosses the straight line of the lower one, whose γ stays; so "
        "does γ₁ − γ₂ + γ₃. Half a turn of z₁ and z₂, anticlockwise, gives σ₁: (γ₁, γ₂, γ₃) → (γ₂, 2γ₂ − γ₁, γ₃), one "
        "of z₂ and z₃ gives σ₂: (γ₁, γ₂, γ₃) → (γ₁, γ₃, 2γ₃ − γ₂). At a thread (zⱼ − zₖ)² changes at a rate "
        "proportional to that of R at μ, μ³ times any real polynomial of degree 2, which takes all complex values: a "
        "loop around the thread is conjugate to σ₁ or its inverse as a braid."
    )
    evidence.zero("both fix the circle of l₃", [*(circle * first - circle), *(circle * second - circle)], decisive=True)
    evidence.zero(
        "on w₁ = γ₁ − γ₂ and w₂ = γ₂ − γ₃ they are w₂ → w₂ − w₁ and w₁ → w₁ + w₂, which generate SL(2, ℤ): with the "
        "circle these make the whole lattice",
        [
            *(plane * first - Matrix([[1, 0], [-1, 1]]) * plane),
            *(plane * second - Matrix([[1, 1], [0, 1]]) * plane),
            plane.col_join(circle).det() ** 2 - 1,
        ],
        decisive=True,
    )
    evidence.zero(
        "σ₁σ₂σ₁ = σ₂σ₁σ₂; (σ₁σ₂)³ is −1 on w₁ and w₂, and (σ₁σ₂)⁶ = 1",
        [
            *(first * second * first - second * first * second),
            *(plane * (first * second) ** 3 + plane),
            *((first * second) ** 6 - eye(3)),
        ],
    )
    _near_the_wall(evidence)


def _near_the_wall(evidence: Evidence) -> None:
    """State that beside the wall R = q^3 both braids occur."""
    from sympy import symbols

    x, w, v, m, a, b = symbols("lambda w v m a b")
    pole = -w / (1 - w * x)  # 1/(lambda - z), w = 1/z
    change = (-3 * m * pole + a * pole**2 + b * pole**3).series(x, 0, 3).removeO().expand()
    jet = [change.coeff(x, n) for n in range(3)]
    # of the real parts; v is the conjugate of w
    condition = (jet[2] - (w + v) * jet[1] + w * v * jet[0]).expand()
    evidence.zero(
        "near R = q³, q = |λ − z|², let the zeros above be those of (λ − z − m)³ + a(λ − z − m) + b. To first order "
        "half of the change of R/q³ is the real part of −3m/(λ − z) + a/(λ − z)² + b/(λ − z)³. With w = 1/z and its "
        "conjugate v one combination of the coefficients of 1, λ, λ², which the leaf determines, has no m, and a with "
        "the factor w³(w − v), not zero; the others determine m",
        [condition.coeff(m), condition.coeff(a) - w**3 * (w - v)],
        decisive=True,
    )
    evidence.note(
        "So the leaf cuts the set 4a³ + 27b² = 0 of the threads with Re(κa) = t to leading order, κ ≠ 0, where t "
        "changes its sign with the side of the wall. Each a ≠ 0 has two values of b, around which x³ + ax + b has the "
        "braids σ₁ and σ₂. On both sides the loops give the whole group of braids, and the monodromy SL(2, ℤ)."
    )


def _numbers(evidence: Evidence) -> None:
    """State the threads, their braids and groups on a leaf of each class."""
    top = lp.Top.twisted_lagrange()
    rows: list[tuple[object, ...]] = [("class", "C₁", "C₂", "edges", "threads", "Hopf points", "braids", "group")]
    groups: dict[str, str] = {}
    signs = {"Z": "ℤ", "SL(2, Z)": "SL(2, ℤ)"}
    for name, (one, two) in LEAVES.items():
        diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": one, "C2": two, "C3": 1}))
        found = lp.tori.lagrange_monodromy(diagram)
        groups[diagram.leaf_class] = signs.get(found.group, found.group)
        words = ", ".join("·".join(_sigma(i) for i in braid) for braid in found.braids) or "none"
        ends = ", ".join("–".join(thread.ends) for thread in diagram.threads) or "none"
        rows.append((name, one, two, len(diagram.edges), ends, len(diagram.hopf_values), words, groups[name]))
    wanted = dict(zip(LEAVES, ("trivial", "ℤ", "SL(2, ℤ)", "SL(2, ℤ)", "SL(2, ℤ)", "ℤ"), strict=True))
    evidence.computation(
        "ε = C₃ = 1: the threads, S± the sleeping tops and HH Hamiltonian Hopf points, the braids of loops around each "
        "from one regular value, every step bounded by Rouché’s theorem, and the group that they generate",
        groups == wanted,
        table=rows,
    )
    off, agree = _by_flows(top)
    evidence.computation(
        f"class {_BY_FLOWS}: the periods found by closing flows and carried along both loops by Newton’s method come "
        "back by the same matrices, in the basis of the integrals γⱼ",
        agree and off < 1e-9,
        [f"largest difference from integers in the change of basis: {off:.0e}"],
    )
    evidence.data["groups"] = ", ".join(f"{name} {group}" for name, group in groups.items()).replace("UU-", "UU−")


def _by_flows(top: lp.Top) -> tuple[float, bool]:
    """How far the change of basis is from integers, and whether closing flows are carried by the same matrices."""
    one, two = LEAVES[_BY_FLOWS]
    diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": one, "C2": two, "C3": 1}))
    found = lp.tori.lagrange_monodromy(diagram)
    off, agree = 0.0, True
    for thread, loop, matrix in zip(diagram.threads, found.loops, found.matrices, strict=True):
        middle = loop[len(loop) // 3 : -(len(loop) // 3)].mean(axis=0)
        near = thread.states[np.abs(thread.values - middle).sum(axis=1).argmin()]
        state = diagram.leaf.project(near + 0.05 * np.array([1, 1, 0, -1, 1, 0, 1, 0, -1]))
        flows = lp.tori.monodromy(diagram.momentum, state, loop)
        change = np.linalg.solve(found.periods.T, flows.periods.T).T
        whole = np.round(change).astype(int)
        off = max(off, float(np.abs(change - whole).max()))
        agree &= bool((flows.matrix @ whole == whole @ matrix).all())
    return off, agree


def _sigma(letter: int) -> str:
    """A letter of a braid."""
    return f"σ{'₁₂'[abs(letter) - 1]}{'' if letter > 0 else '⁻¹'}"
