"""The diagram of the twisted Lagrange top against exact roots, common divisors and states that are built here."""

from fractions import Fraction
from math import lcm

import flint
import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError
from liepoisson.tori.critical_search import Critical
from liepoisson.tori.lagrange_leaves import class_of

TOP = lp.Top.twisted_lagrange()  # I = (1, 1, 1/2), a = (0, 0, 1), epsilon = 1: M = lambda^3 e3 + lambda^2 l + ...
SAMPLES = {"AA": (-5, 0), "AU": (0, 2), "UU-": (0, 0.2), "UU+": (8, 1), "BU": (17.52, 3.317), "AB": (35, 5)}
EDGES = {"AA": 5, "AU": 4, "UU-": 3, "UU+": 3, "BU": 5, "AB": 6}
THREADS = {
    "AA": [], "AU": ["HH S"], "UU-": ["HH S", "HH S"], "UU+": ["HH HH", "S S"], "BU": ["HH HH", "HH S"],
    "AB": ["HH HH"],
}  # fmt: skip
HOPF = {"AA": 0, "AU": 1, "UU-": 2, "UU+": 2, "BU": 3, "AB": 2}


def leaf(c1, c2, c3=1):
    return lp.Leaf(TOP, {"C1": c1, "C2": c2, "C3": c3})


def diagram(name):
    return lp.tori.lagrange_diagram(leaf(*SAMPLES[name]))


def vector_polynomials(states):
    """The components of M, shape (..., 3, 4), the highest power first."""
    axis = np.broadcast_to([0.0, 0.0, 1.0], (*states.shape[:-1], 3))
    return np.stack([axis, states[..., :3], states[..., 3:6], states[..., 6:]], axis=-1)


def spectral(c1, c2, c3, values):
    """The coefficients of R, exact: H = h + l3^2/2."""
    h, l3, p = (Fraction(float(v)) for v in values)
    return [Fraction(1), 2 * l3, 2 * h - l3**2, 2 * p, Fraction(c1), 2 * Fraction(c2), Fraction(c3)]


def real_roots(coefficients):
    """The real roots of a polynomial with rational coefficients, the highest power first: isolated, exactly real."""
    whole = lcm(*(one.denominator for one in coefficients))
    exact = flint.fmpz_poly([int(one * whole) for one in reversed(coefficients)])
    return [(root.real, m) for root, m in exact.complex_roots() if root.imag == 0]


def common_roots(components):
    """The roots of gcd(M1, M2, M3): M3 is the characteristic polynomial of T, and M1(T), M2(T) vanish on them."""
    T = np.diag([1.0, 1.0], -1)
    T[0] = -components[2, 1:]
    one, other = (sum(c * np.linalg.matrix_power(T, 3 - k) for k, c in enumerate(row)) for row in components[:2])
    stacked = np.concatenate([one, other])
    _, sizes, vectors = np.linalg.svd(stacked)
    null = vectors[sizes <= 1e-6 * max(1.0, np.abs(T).max() ** 2)].T
    return np.linalg.eigvals(null.T @ T @ null)


def kind_of(roots):
    """A real root is elliptic, a pair of complex ones is focus-focus."""
    complex_ones = int((np.abs(roots.imag) > 1e-6).sum())
    return ", ".join(["elliptic"] * (len(roots) - complex_ones) + ["focus-focus"] * (complex_ones // 2))


def touches(coefficients):
    """The least |R| where R' vanishes, relative to the terms: zero at a double root, real or complex."""
    c = np.array([float(one) for one in coefficients])
    x = np.roots(np.polyder(c))
    return np.abs(np.polyval(c, x) / np.polyval(np.abs(c), np.abs(x))).min()


@pytest.mark.parametrize(
    ("name", "n"), [("UU-", 30), *(pytest.param(name, 400, marks=pytest.mark.slow) for name in SAMPLES)]
)
def test_critical_states_have_common_roots(name, n):
    """rank = 3 - deg gcd(M1, M2, M3), the type is that of the roots, and R has a double root."""
    found = lp.tori.critical_states(leaf(*SAMPLES[name]), n_starts=n)
    assert len(found) > n / 3
    c = (*map(Fraction, SAMPLES[name]), 1)
    for state, values, rank, kind in zip(found.states, found.values, found.rank, found.type, strict=True):
        roots = common_roots(vector_polynomials(state))
        assert (rank, kind) == (3 - len(roots), kind_of(roots))
        assert touches(spectral(*c, values)) < 1e-9


@pytest.mark.parametrize("name", SAMPLES)
def test_curves_consist_of_relative_equilibria(name):
    """M = q(lambda)(lambda e3 + n) with the values of R = |M|^2; real roots of q on edges, complex ones on threads."""
    found = diagram(name)
    search = Critical.on(found.leaf, found.momentum)
    for curve in found.curves:
        M = vector_polynomials(curve.states)
        R = sum(np.stack([np.convolve(row, row) for row in M[:, k]]) for k in range(3))
        size = np.abs(R).max(axis=1)
        casimirs = [*found.leaf.casimirs.values()]
        assert np.abs((R[:, 4:] - np.multiply(casimirs, [1, 2, 1])) / size[:, None]).max() < 1e-10
        h, l3, p = curve.values.T
        assert np.abs((R[:, 1:4].T - [2 * l3, 2 * h - l3**2, 2 * p]) / size).max() < 1e-10
        some = slice(30, -30, 45)
        for state, rank, kind in zip(curve.states[some], *search.kinds(curve.states[some] / search.units), strict=True):
            roots = common_roots(vector_polynomials(state))
            assert (rank, kind) == (1, kind_of(roots))
            assert kind == ("elliptic, elliptic" if curve.kind == "edge" else "focus-focus")
        depth = found.depth(curve.values[some])
        assert (np.abs(depth) < 1e-9).all() if curve.kind == "edge" else (depth > 0).all()


@pytest.mark.parametrize("name", SAMPLES)
def test_sleeping_tops_have_rank_zero_and_their_letters(name):
    found = diagram(name)
    search = Critical.on(found.leaf, found.momentum)
    states = np.array([*found.sleeping_tops.values()])
    ranks, kinds = search.kinds(states / search.units)
    assert not ranks.any()
    assert [*kinds] == [kind_of(common_roots(vector_polynomials(state))) for state in states]
    assert sorted(kinds) == sorted(
        "elliptic, focus-focus" if s == "U" else "elliptic, elliptic, elliptic" for s in name[:2]
    )


@pytest.mark.parametrize("name", SAMPLES)
def test_the_parts_of_each_class(name):
    """Ends of edges: three at each stable sleeping top, one at each Hopf point, four at infinity."""
    found = diagram(name)
    assert found.leaf_class == name
    assert len(found.hopf_values) == HOPF[name]
    assert (
        sorted(" ".join(sorted(end.rstrip("+-") for end in thread.ends)) for thread in found.threads) == THREADS[name]
    )
    assert len(found.edges) == EDGES[name]


def is_attained(coefficients):
    """R > 0 on the whole real line, exactly."""
    return not real_roots(coefficients)


@pytest.mark.parametrize(
    ("name", "n"), [("UU-", 500), *(pytest.param(name, 10_000, marks=pytest.mark.slow) for name in SAMPLES)]
)
def test_depth_tells_what_is_attained(name, n):
    """Of random states it is positive; of random values it has the sign that the exact number of real roots tells."""
    found = diagram(name)
    draw = np.random.default_rng(n)
    states = found.leaf.project(draw.normal(size=(n, 9)))
    values = found.momentum(states)
    assert (found.depth(values) > 0).all()
    middle, spread = np.median(values, axis=0), values.std(axis=0)
    tried = middle + draw.normal(size=(n, 3)) * spread
    c = (*map(Fraction, SAMPLES[name]), 1)
    expected = np.array([is_attained(spectral(*c, one)) for one in tried])
    assert 0.02 < expected.mean() < 0.98
    np.testing.assert_array_equal(found.depth(tried) > 0, expected)
    for one in values[:500]:
        assert is_attained(spectral(*c, one))


@pytest.mark.parametrize("name", SAMPLES)
def test_what_has_depth_is_attained(name):
    """With R = p^2 + q^2, p monic of degree 3, q of degree 2, the state M = (q, 0, p) has the values."""
    found = diagram(name)
    draw = np.random.default_rng(1)
    tried = found.momentum(found.leaf.state) + draw.normal(size=(400, 3)) * [20, 2, 10]
    inside = tried[found.depth(tried) > 1e-6]
    assert len(inside) > 10
    c = (*map(Fraction, SAMPLES[name]), 1)
    for values in inside:
        roots = np.roots([float(one) for one in spectral(*c, values)])
        product = np.poly(roots[roots.imag > 0])
        p, q = product.real, product.imag
        state = np.stack([q[1:], np.zeros(3), p[1:]], axis=-1).ravel()
        np.testing.assert_allclose(found.momentum(state), values, atol=1e-8 * (1 + np.abs(values).max()))
        l, alpha, beta = state[:3], state[3:6], state[6:]
        casimirs = [alpha @ alpha + 2 * l @ beta, alpha @ beta, beta @ beta]
        size = 1 + np.abs(state).max() ** 2
        np.testing.assert_allclose(casimirs, [*found.leaf.casimirs.values()], atol=1e-8 * size)


@pytest.mark.parametrize("spins", [(0.7,), pytest.param((-1.3, 0.0, 2.1), marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", SAMPLES)
def test_the_boundary_of_a_cut_is_where_rays_leave_the_image(name, spins):
    found = diagram(name)
    c = (*map(Fraction, SAMPLES[name]), 1)
    for l3 in spins:
        parts = found.boundary(l3)
        h, p = np.concatenate(parts).T
        some = np.stack([h, np.full_like(h, l3), p], axis=1)[::17]
        assert max(touches(spectral(*c, values)) for values in some) < 1e-9
        assert np.abs(found.depth(some)).max() < 1e-9
        # The image is convex; a high energy is inside
        top = np.array([h.min() + 30.0, p[h.argmin()]])
        for angle in np.linspace(0, 2 * np.pi, 12, endpoint=False) + 0.1:
            ray = np.array([np.sin(angle), np.cos(angle)])
            low, high = 0.0, 80.0
            if is_attained(spectral(*c, (top[0] + high * ray[0], l3, top[1] + high * ray[1]))):
                continue
            for _ in range(40):
                middle = (low + high) / 2
                there = top + middle * ray
                low, high = (middle, high) if is_attained(spectral(*c, (there[0], l3, there[1]))) else (low, middle)
            assert min(distance_to(part, top + low * ray) for part in parts) < 2e-3


def distance_to(curve, point):
    """From a point to a polygon."""
    begin, along = curve[:-1], np.diff(curve, axis=0)
    share = np.clip(((point - begin) * along).sum(1) / (along**2).sum(1), 0, 1)
    return np.linalg.norm(begin + share[:, None] * along - point, axis=1).min()


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLES)
def test_over_regular_values_there_is_one_torus(name):
    """R > 0 has a connected fibre."""
    found = diagram(name)
    values = found.momentum(found.leaf.project(np.random.default_rng(5).normal(size=(100, 9))))
    for one in values[np.argsort(-found.depth(values))[:2]]:
        assert lp.tori.fibre(found.leaf, one, momentum=found.momentum, n_states=40).n_tori == 1


# ----------------------------------------------------------------------------------------------- classes of leaves


def counted_class(c1, c2, c3):
    """The class and the number of Hopf points, by real roots of polynomials with rational coefficients.

    Both sleeping tops at once: Q+ Q- = lambda^6 - c3 (a lambda^2 + b lambda + 1)^2, where the sign of
    lambda (a lambda^2 + b lambda + 1) tells whose a root is.  Threads exchange their ends where the curve
    3 c3 k^2 - 4 c2 k + c1 = 1/g^2 + 2 c3 g has a saddle; they cross the line k = 2 c2/(3 c3) of it or they do not.
    """
    a, b = (c1 - c2**2 / c3) / (2 * c3), c2 / c3
    square = [a**2, 2 * a * b, b**2 + 2 * a, 2 * b, Fraction(1)]
    both = [Fraction(1), Fraction(0), *(-c3 * one for one in square)]
    tops = {1: [], -1: []}
    for root, m in real_roots(both):
        assert m == 1
        tops[sign_of(lambda x=root: -x * (ball(a) * x * x + ball(b) * x + 1))].append(sign_of(lambda x=root: x))
    letters = ["U" if len(signs) == 1 else "B" if len(set(signs)) == 1 else "A" for signs in tops.values()]
    assert all(len(signs) in {1, 3} for signs in tops.values())
    name = "".join(sorted(letters))
    if name == "UU":
        line = real_roots([2 * c3, -(c1 - Fraction(4, 3) * c2**2 / c3), Fraction(0), Fraction(1)])
        name += {0: "-", 2: "+"}[sum(sign_of(lambda x=root: x) > 0 for root, _ in line)]
    hopf = 0
    for root, m in real_roots([Fraction(1), *[Fraction(0)] * 3, -c1, -8 * c2, -10 * c3]):
        assert m == 1
        hopf += sign_of(lambda x=root: ball(c3) * x**6 - (ball(c2) * x + 2 * ball(c3)) ** 2) > 0
    return name, hopf


def ball(one):
    return flint.arb(flint.fmpq(one.numerator, one.denominator))


def sign_of(number):
    value = number()
    assert not value.contains(0), value
    return 1 if value > 0 else -1


def random_leaves(n):
    """Casimirs of leaves: half anywhere, half at 1e-1 to 1e-12 from a wall."""
    draw = np.random.default_rng(n)
    for k in range(n):
        near = 10.0 ** -draw.uniform(1, 12) * draw.choice([1, -1])
        if k % 2:
            c1, c2 = draw.normal(size=2) * [12, 4]
        elif k % 4:
            r = draw.uniform(0.2, 2) * draw.choice([1, -1])
            e = (1 - 2 * r**3) / r**2
            c2 = -3 * r**2 - 2 * e * r
            c1 = 2 * e + c2**2 + near
            c2 *= draw.choice([1, -1])
        else:
            c2 = draw.uniform(-3, 3)
            c1 = 3 + 4 * c2**2 / 3 + near
        c3 = float(draw.gamma(1.0) + 0.05)
        unit = c3 ** (1 / 6)
        yield Fraction(float(c1 * unit**4)), Fraction(float(c2 * unit**5)), Fraction(c3)


@pytest.mark.parametrize("n", [1000, pytest.param(100_000, marks=[pytest.mark.slow, pytest.mark.timeout(1200)])])
def test_leaf_classes_are_those_of_exact_roots(n):
    seen = set()
    old, flint.ctx.prec = flint.ctx.prec, 200
    try:
        for casimirs in random_leaves(n):
            name = class_of(*casimirs)
            seen.add(name)
            assert (name, HOPF[name]) == counted_class(*casimirs), [*map(float, casimirs)]
    finally:
        flint.ctx.prec = old
    assert seen == set(HOPF)


@pytest.mark.parametrize("n", [12, pytest.param(1000, marks=pytest.mark.slow)])
def test_diagrams_of_random_leaves_have_the_parts_of_their_class(n):
    """Refused are only leaves nearer to a wall than doubles can tell."""
    refused = 0
    for casimirs in random_leaves(n):
        chosen = leaf(*casimirs)
        assert lp.tori.leaf_class(chosen) == class_of(*casimirs)
        try:
            found = lp.tori.lagrange_diagram(chosen)
        except LeafError:
            refused += 1
            continue
        name = found.leaf_class
        assert (len(found.edges), len(found.hopf_values)) == (EDGES[name], HOPF[name])
        ends = sorted(" ".join(sorted(end.rstrip("+-") for end in thread.ends)) for thread in found.threads)
        assert ends == THREADS[name]
    assert refused <= n / 20
