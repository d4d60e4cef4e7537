"""The equations of motion of the catalog's systems, written out by hand in plain arithmetic: no bracket, no SymPy.

A state is a list of fields, each a list of numbers; so is a derivative.  All numbers are Fractions, except where a sine
or a root makes them floats.
"""

from fractions import Fraction
from itertools import combinations
from math import cos, exp, isqrt, pi, sin, sqrt

F = Fraction


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def minkowski_cross(x, gradient):
    """The product of so(2,1) of a field and a gradient: that of so(3), with the field's third component reversed."""
    return cross([x[0], x[1], -x[2]], gradient)


def plus(*vectors):
    return [sum(components) for components in zip(*vectors, strict=True)]


def times(factor, v):
    return [factor * a for a in v]


def over(v, moments):
    return [a / F(m) for a, m in zip(v, moments, strict=True)]


def along(diagonal, v):
    return [F(d) * a for d, a in zip(diagonal, v, strict=True)]


def euclidean(gradients, product=cross):
    """The equations on e(3), l' = l x H_l + alpha x H_alpha, alpha' = alpha x H_l."""

    def equations(l, alpha):
        dl, dalpha = gradients(l, alpha)
        return [plus(product(l, dl), product(alpha, dalpha)), product(alpha, dl)]

    return equations


def heavy(inertia, a, product=cross):
    return euclidean(lambda l, _: (over(l, inertia), [F(c) for c in a]), product)


def top(inertia, a, b=(0, 0, 0), epsilon=0, product=cross):
    """The equations as Thiffeault and Morrison (2001) print them."""
    a, b = [F(c) for c in a], [F(c) for c in b]

    def equations(l, alpha, beta):
        omega = over(l, inertia)
        return [
            plus(product(l, omega), product(alpha, a), product(beta, b)),
            plus(product(alpha, omega), times(epsilon, product(beta, a))),
            product(beta, omega),
        ]

    return equations


def leibniz(inertia, a):
    """Every field turns with omega and is fed by the next one but l, which is fed by alpha (epsilon = 1)."""
    a = [F(c) for c in a]

    def equations(*fields):
        omega = over(fields[0], inertia)
        fed = [cross(following, a) for following in fields[1:]] + [[F(0)] * 3]
        return [plus(cross(x, omega), y) for x, y in zip(fields, fed, strict=True)]

    return equations


def kovalevskaya(*products):
    """I = (2, 2, 1), H = ... - alpha1 - beta2; for each e_mu the coordinates of its products with e1 and with e2."""

    def equations(*fields):
        omega = over(fields[0], (2, 2, 1))
        rates = []
        for x, both in zip(fields, products, strict=True):
            alpha, beta = (plus(*(times(F(c), y) for c, y in zip(product, fields, strict=True))) for product in both)
            rates.append(plus(cross(x, omega), cross(alpha, [-1, 0, 0]), cross(beta, [0, -1, 0])))
        return rates

    return equations


def gyrostat(l):
    k = [F(1, 2), F(1, 3), F(1, 4)]
    return [cross(l, over(plus(l, times(-1, k)), [1, 2, F(5, 2)]))]


def carrier(M):
    """The gyrostat in the momentum of the carrier: the whole momentum M + k turns with omega."""
    k = [F(1, 2), F(1, 3), F(1, 4)]
    return [cross(plus(M, k), over(M, [1, 2, F(5, 2)]))]


def cubic(A, B, C):
    """x'' = -A x - 2 x y, y'' = -B y - x^2 + C y^2."""

    def equations(x, y, u, v):
        return [u, v, [-A * x[0] - 2 * x[0] * y[0]], [-B * y[0] - x[0] ** 2 + C * y[0] ** 2]]

    return equations


def double_pendulum(a, b, p, q):
    """Unit masses, lengths and gravity; angles a, b and their momenta p, q."""
    a, b, p, q = (float(z[0]) for z in (a, b, p, q))
    s, c = sin(a - b), cos(a - b)
    D = 1 + s * s
    first = p * q * s / D
    second = (p * p + 2 * q * q - 2 * p * q * c) * 2 * s * c / (2 * D * D)
    return [[(p - q * c) / D], [(2 * q - p * c) / D], [-2 * sin(a) - first + second], [-sin(b) + first - second]]


def eating(*rows):
    """x_i' = x_i (sum_j c_ij x_j + r_i): one row of c and r for each species."""

    def equations(*fields):
        x = [field[0] for field in fields]
        return [
            [a * (sum(F(c) * b for c, b in zip(row, x, strict=False)) + F(row[-1]))]
            for a, row in zip(x, rows, strict=True)
        ]

    return equations


def ring(*fields):
    """x_k' = x_k (x_(k+1) - x_(k-1)), numbers modulo that of the species."""
    x = [field[0] for field in fields]
    return [[x[k] * (x[(k + 1) % len(x)] - x[k - 1])] for k in range(len(x))]


def of_sklyanin(s0, s1, s2, s3):
    """S1' = 2 (J3 - J2) S2 S3, and so on in turn, with J = (1, 2, 4); S0 rests."""
    a, b, c = s1[0], s2[0], s3[0]
    return [[F(0)], [4 * b * c], [-6 * c * a], [2 * a * b]]


def spring_pendulum(x, y, u, v):
    """The spring pulls with 4 (r - 3/4) towards the origin, gravity with 1 downwards."""
    x, y = float(x[0]), float(y[0])
    r = sqrt(x * x + y * y)
    pull = 4 * (r - 0.75)
    return [u, v, [-pull * x / r], [-pull * y / r - 1]]


def toda(q, p):
    """Each particle is pushed by the spring behind it and pulled back by the one before it."""
    n, q = len(q), [float(c) for c in q]
    spring = [exp(q[k] - q[(k + 1) % n]) for k in range(n)]
    return [p, [spring[k - 1] - spring[k] for k in range(n)]]


def three_wave(q, p):
    """Complex amplitudes a = q + i p: i a1' = a2* a3, i a2' = a1* a3, i a3' = a1 a2."""
    (a, b, c), minus_i = zip(q, p, strict=True), (0, -1)

    def product(z, w):
        return (z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0])

    def conjugate(z):
        return (z[0], -z[1])

    rates = [product(minus_i, product(*pair)) for pair in ((conjugate(b), c), (conjugate(a), c), (a, b))]
    return [[z[0] for z in rates], [z[1] for z in rates]]


def cavity(m, n):
    A, B, C = [F(5, 24), F(5, 24), F(1, 4)], [F(1, 6), F(1, 6), F(1, 4)], [F(1, 3), F(1, 3), F(3, 8)]
    return [cross(m, plus(along(A, m), along(B, n))), cross(n, plus(along(B, m), along(C, n)))]


def quadratic(a, b, c):
    """Kirchhoff's equations with H = (sum a m^2 + 2 b m p + c p^2)/2."""
    return euclidean(lambda m, p: (plus(along(a, m), along(b, p)), plus(along(b, m), along(c, p))))


def kepler(l, alpha):
    """mu = 1; alpha1^2 + alpha2^2 is the square of a rational number."""
    square = F(alpha[0] ** 2 + alpha[1] ** 2)
    r = F(isqrt(square.numerator), isqrt(square.denominator))
    assert r * r == square, "choose alpha1, alpha2 as legs of a rational triangle"
    force = [alpha[2] * alpha[0] / r**3, alpha[2] * alpha[1] / r**3, -1 / r]
    return euclidean(lambda l, _: (l, force))(l, alpha)


def singular(m, p):
    b, c = F(1, 2), 1
    dp = [c * p[0], -c * p[1], -b / p[2] ** 3]
    return euclidean(lambda m, _: ([m[0], m[1], 2 * m[2]], dp))(m, p)


def four_fields(omega, v, p, psi):
    """Compressible reduced magnetohydrodynamics with the cross product for the bracket of functions."""
    beta_e, k = F(1, 2), [1, 2, 3]
    d_omega, d_v, d_p, d_psi = over(omega, k), v, times(1 / beta_e, p), along(k, psi)
    return [
        plus(cross(omega, d_omega), cross(v, d_v), cross(p, d_p), cross(psi, d_psi)),
        plus(cross(v, d_omega), times(-beta_e, cross(psi, d_p))),
        plus(cross(p, d_omega), times(-beta_e, cross(psi, d_v))),
        cross(psi, d_omega),
    ]


def manakov(M):
    """M' = [M, Omega], M_ij = (J_i + J_j) Omega_ij, J = (1, 2, 3, 4)."""
    pairs = list(combinations(range(4), 2))
    matrix, velocity = [[[F(0)] * 4 for _ in range(4)] for _ in range(2)]
    for (i, j), value in zip(pairs, M, strict=True):
        for filled, x in ((matrix, value), (velocity, F(value) / (i + j + 2))):
            filled[i][j], filled[j][i] = x, -x
    return [[sum(matrix[i][k] * velocity[k][j] - velocity[i][k] * matrix[k][j] for k in range(4)) for i, j in pairs]]


def rattleback(x):
    return [[4 * x[0] * x[2], -x[1] * x[2], x[1] ** 2 - 4 * x[0] ** 2]]


def modes(N):
    """One wave vector of each pair, in the order of the coordinates."""
    half = range(-(N // 2), N // 2 + 1)
    return sorted(
        ((n, m) for n in half for m in half if (n, m) > (0, 0)), key=lambda k: (k[0] ** 2 + k[1] ** 2, -k[0], -k[1])
    )


def spectrum(coordinates, N):
    """Complex coefficients w_n for all n, from the real and imaginary parts of one of each pair."""
    w = {}
    for r, (n, m) in enumerate(modes(N)):
        value = complex(coordinates[2 * r], coordinates[2 * r + 1])
        w[n, m], w[-n, -m] = value, value.conjugate()
    return w


def sine_bracket(w, gradient, N):
    """sum_k N/(2 pi) sin(2 pi (n x k)/N) w_(n+k) g_(-k), as real and imaginary parts."""
    centred = lambda n: (n + N // 2) % N - N // 2  # noqa: E731
    found = []
    for n in modes(N):
        total = 0j
        for k in gradient:
            angle = 2 * pi * (n[0] * k[1] - n[1] * k[0]) / N
            shifted = (centred(n[0] + k[0]), centred(n[1] + k[1]))
            if shifted != (0, 0):
                total += N / (2 * pi) * sin(angle) * w[shifted] * gradient[-k[0], -k[1]]
        found += [total.real, total.imag]
    return found


def fluid(N):
    def equations(coordinates):
        w = spectrum(coordinates, N)
        return [sine_bracket(w, {k: value / (k[0] ** 2 + k[1] ** 2) for k, value in w.items()}, N)]

    return equations


def magnetofluid(vorticity, flux):
    w, psi = spectrum(vorticity, 3), spectrum(flux, 3)
    stream = {k: value / (k[0] ** 2 + k[1] ** 2) for k, value in w.items()}
    current = {k: value * (k[0] ** 2 + k[1] ** 2) for k, value in psi.items()}
    return [plus(sine_bracket(w, stream, 3), sine_bracket(psi, current, 3)), sine_bracket(psi, stream, 3)]


A = (1, 2, 4)
SQUARES = (4, 9, 1)  # (A2 - A3)^2, (A3 - A1)^2, (A1 - A2)^2
PRODUCTS = (8, 4, 2)  # A2 A3, A3 A1, A1 A2
MU = F(1, 2)

EQUATIONS = {
    "charged-heavy-top": top((2, F(3, 2), 1), (F(3, 5), 0, F(4, 5)), (0, F(1, 2), 0)),
    "charged-lagrange": top((1, 1, F(1, 2)), (0, 0, 1), (0, 0, F(1, 2))),
    "charged-twisted-lagrange": top((1, 1, F(1, 2)), (0, 0, 1), (0, 0, F(1, 2)), 1),
    "chaplygin": quadratic((1, 1, 2), (0, 0, 0), (1, -1, 0)),
    "clebsch": quadratic(A, (0, 0, 0), PRODUCTS),
    "compressible-reduced-mhd": four_fields,
    "double-pendulum": double_pendulum,
    "free-rigid-body": lambda l: [cross(l, over(l, (1, 2, F(5, 2))))],
    "goryachev": singular,
    "goryachev-chaplygin": heavy((4, 4, 1), (1, 0, 0)),
    "goryachev-chaplygin-gyrostat": euclidean(lambda l, _: ([l[0] / 4, l[1] / 4, l[2] - F(1, 3)], [1, 0, 0])),
    "gyrostat": carrier,
    "henon-heiles": cubic(1, 1, 1),
    "henon-heiles-kaup-kupershmidt": cubic(1, 16, -16),
    "henon-heiles-kdv": cubic(1, F(3, 2), -6),
    "henon-heiles-sawada-kotera": cubic(1, 1, -1),
    "heavy-top": heavy((2, F(3, 2), 1), (F(3, 5), 0, F(4, 5))),
    "kepler-on-the-sphere": kepler,
    "kirchhoff": quadratic((1, 1, 2), (F(1, 3), F(1, 3), F(1, 5)), (2, 2, 3)),
    "kirchhoff-ellipsoid": euclidean(
        lambda m, p: (
            over(m, ("0.33337736152254", "0.72130172090561", "0.70193940526629")),
            over(p, ("1.2507250879793", "1.5045658885717", "1.8662975263361")),
        )
    ),
    "kovalevskaya": heavy((2, 2, 1), (-1, 0, 0)),
    "kovalevskaya-gyrostat": euclidean(lambda l, _: ([l[0] / 2, l[1] / 2, l[2] - F(1, 3)], [1, 0, 0])),
    "kovalevskaya-so4": kovalevskaya([(0, 1), (0, 0)], [(1, 0), (0, 0)]),
    "lagrange": heavy((1, 1, F(1, 2)), (0, 0, 1)),
    "leibniz-lagrange-4": leibniz((1, 1, F(1, 2)), (0, 0, 1)),
    "leibniz-lagrange-5": leibniz((1, 1, F(1, 2)), (0, 0, 1)),
    "leibniz-top-4": leibniz((2, 2, 1), (-1, 0, 0)),
    "lotka-volterra-3": ring,
    "lotka-volterra-4": eating(
        (0, 1, 0, 0, -1), (-1, 0, F(1, 2), 0, F(1, 2)), (0, F(-1, 2), 0, 1, F(-1, 2)), (0, 0, -1, 0, 1)
    ),
    "lyapunov": quadratic((1, 1, 1), times(MU, A), times(MU**2, SQUARES)),
    "manakov-so4": manakov,
    "neumann": quadratic((1, 1, 1), (0, 0, 0), A),
    "poincare-ellipsoidal-cavity": cavity,
    "rattleback": rattleback,
    "reduced-mhd-3": magnetofluid,
    "sklyanin": of_sklyanin,
    "so21-heavy-top": heavy((1, 1, F(1, 2)), (0, 0, 1), minkowski_cross),
    "so21-twisted-top": top((1, 1, F(1, 2)), (0, 0, 1), epsilon=1, product=minkowski_cross),
    "spherical-pendulum": euclidean(lambda l, _: (l, [0, 0, 1])),
    "spring-pendulum": spring_pendulum,
    "steklov": quadratic(A, times(-MU, PRODUCTS), times(MU**2, along(A, SQUARES))),
    "three-field-kovalevskaya": kovalevskaya(
        [(0, 1, 0, 0), (0, 0, 1, 0)],
        [(0, 0, 0, 1), (0, 0, 0, 0)],
        [(0, 0, 0, 0), (0, 0, 0, 1)],
        [(0, 0, 0, 0), (0, 0, 0, 0)],
    ),
    "three-wave": three_wave,
    "toda": toda,
    "twisted-kovalevskaya": top((2, 2, 1), (-1, 0, 0), epsilon=1),
    "twisted-lagrange": top((1, 1, F(1, 2)), (0, 0, 1), epsilon=1),
    "twisted-two-field-kovalevskaya": kovalevskaya(
        [(0, 1, 0), (0, 0, 1)], [(0, 1, 0), (0, 0, 0)], [(0, 0, 0), (-1, 1, 0)]
    ),
    "two-field-kovalevskaya": top((2, 2, 1), (-1, 0, 0), (0, -1, 0)),
    "two-field-spherical": top((1, 1, 1), (1, 0, 0), (0, 1, 0)),
    "volterra-lattice-5": ring,
    "zeitlin-3": fluid(3),
    "zeitlin-5": fluid(5),
    "zhukovsky-volterra-gyrostat": gyrostat,
}
