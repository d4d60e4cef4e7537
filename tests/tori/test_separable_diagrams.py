"""Diagrams of systems with separated equations: critical values are those of polynomials with a double root."""

import numpy as np
import pytest
from connected import pieces

import liepoisson as lp
from liepoisson.errors import OrbitError

# ---------------------------------------------------------------------------------------------- Manakov's top of so(4)

MANAKOV = lp.catalog.system("manakov-so4")
A = np.array([1.0, 4, 9, 16])  # J^2
OTHER_TWO = [(2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1)]
"""The two indices that M12, M13, M14, M23, M24, M34 do not have."""
ENERGY = np.array([1 / 3, 1 / 4, 1 / 5, 1 / 5, 1 / 6, 1 / 7]) / 2
STARTS = ([0.5, 0.3, 0.2, 0.6, 0.4, 0.9], [1, 0.1, 0.2, 0.1, 0.3, 0.25])


def squares_and_pfaffian(x):
    return (x**2).sum(-1), x[..., 0] * x[..., 5] - x[..., 1] * x[..., 4] + x[..., 2] * x[..., 3]


def energy_and_k(x):
    return x**2 @ ENERGY, x**2 @ [A[i] * A[j] for i, j in OTHER_TWO]


def quartic(square, pfaffian, value):
    r"""D = Q^2 - 4 Pf^2 (a1 - t)...(a4 - t), and Q = |M|^2 t^2 - q1 t + q0.

    det(M + lambda (J^2 - t)) = lambda^4 (a1 - t)...(a4 - t) + lambda^2 Q(t) + Pf^2, with K = q0 and
    2 H = (151 |M|^2 + 5 q1 + q0)/1260.
    """
    h, k = value
    q = np.array([square, -(2520 * h - 151 * square - k) / 5, k])
    return np.polysub(np.convolve(q, q), 4 * pfaffian**2 * np.poly(A)), q


def double_root(D, q):
    """The t at which D comes nearest to a double root, and by how much of q0 the value is to be moved to it."""
    t = np.roots(np.polyder(D))
    t = t.real[np.abs(t.imag) < 1e-5]
    miss = np.abs(np.polyval(D, t) / (2 * np.polyval(q, t)))
    return t[miss.argmin()], miss.min()


def test_the_spectral_curve():
    x = np.arange(1.0, 7)
    D, q = quartic(*squares_and_pfaffian(x), [*map(float, energy_and_k(x))])
    assert [*np.round(q, 9)] == [91, -924, 1349]
    M = np.zeros((4, 4))
    M[np.triu_indices(4, 1)] = x
    for t, scale in ((-1.0, 0.3), (5.0, 2.0), (20.0, 0.7)):
        powers = [np.prod(A - t), np.polyval(q, t), squares_and_pfaffian(x)[1] ** 2]
        assert np.polyval(powers, scale**2) == pytest.approx(np.linalg.det(M - M.T + scale * np.diag(A - t)))
        assert np.polyval(D, t) == pytest.approx(powers[1] ** 2 - 4 * powers[0] * powers[2])


@pytest.mark.parametrize(
    ("start", "n"), [(STARTS[0], 30), *(pytest.param(one, 400, marks=pytest.mark.slow) for one in STARTS)]
)
def test_critical_values_of_the_top_have_a_double_root(start, n):
    """Elliptic outside of [a1, a4]; between a2 and a3 hyperbolic where Q < 0 and D has a minimum, else elliptic."""
    leaf = lp.Leaf.through(MANAKOV, start)
    numbers = squares_and_pfaffian(np.array(start))
    found = lp.tori.critical_states(leaf, n_starts=n)
    assert len(found) > 0.8 * n
    for value, rank, kind in zip(found.values, found.rank, found.type, strict=True):
        D, q = quartic(*numbers, value)
        t, miss = double_root(D, q)
        assert miss < 1e-9 * value[1]
        assert t < A[0] or A[1] < t < A[2] or t > A[3]
        is_minimum = np.polyval(np.polyder(D, 2), t) > 0
        assert is_minimum or A[1] < t < A[2]
        if rank == 1 and abs(np.polyval(np.polyder(D, 2), t)) > 1e-2:
            assert kind == ("hyperbolic" if is_minimum and np.polyval(q, t) < 0 else "elliptic")


@pytest.mark.parametrize(
    ("start", "n"), [(STARTS[0], 500), *(pytest.param(one, 10_000, marks=pytest.mark.slow) for one in STARTS)]
)
def test_values_of_random_states_of_the_top_are_in_the_image(start, n):
    """J^2 - t is definite outside of [a1, a4]; there lambda^2 < 0, so that D > 0 and Q > 0."""
    x = np.array(start)
    numbers = squares_and_pfaffian(x)
    states = lp.Leaf.through(MANAKOV, x).project(np.random.default_rng(n).normal(size=(n, 6)))
    for value in lp.tori.momentum_map(MANAKOV)(states):
        D, q = quartic(*numbers, value)
        roots = np.concatenate([np.roots(D), np.roots(q)])
        real = roots.real[np.abs(roots.imag) < 1e-9]
        assert ((A[0] < real) & (real < A[3])).all()


def tori_of_the_top(numbers, value):
    """Four where D has four roots between a2 and a3, else two: the same throughout a region."""
    roots = np.roots(quartic(*numbers, value)[0])
    return 4 if (np.abs(roots.imag) < 1e-9).all() else 2


@pytest.fixture(scope="module", params=[pytest.param(one, marks=pytest.mark.slow) for one in STARTS])
def drawn(request):
    return request.param, lp.tori.diagram(lp.Leaf.through(MANAKOV, request.param))


def test_the_equilibria_of_the_top(drawn):
    """M_ij^2 + M_kl^2 = |M|^2 with M_ij M_kl = Pf up to sign: 12, and the sum of (-1)^index is 4, as for S^2 x S^2."""
    start, found = drawn
    square, pfaffian = squares_and_pfaffian(np.array(start))
    assert len(found.rest_states) == 12
    for x in found.rest_states:
        pairs = np.sort(np.abs([(x[0], x[5]), (x[1], x[4]), (x[2], x[3])]).prod(axis=1))
        np.testing.assert_allclose(pairs, [0, 0, abs(pfaffian)], atol=1e-9)
    assert sum((-1) ** kind.split(", ").count("hyperbolic") for kind in found.rest_types) == 4
    np.testing.assert_allclose((found.rest_states**2).sum(1), square)


def test_the_diagram_of_the_top_is_the_curve_of_double_roots(drawn):
    start, found = drawn
    numbers = squares_and_pfaffian(np.array(start))
    for family in found.families:
        for value in family.values[2:-2]:
            assert double_root(*quartic(*numbers, value))[1] < 1e-9 * value[1]


def test_regions_of_the_top_have_two_or_four_tori(drawn):
    start, found = drawn
    x = np.array(start)
    numbers = squares_and_pfaffian(x)
    regions = [one for one in lp.tori.regions(found, n_values=400, n_states=80) if one.fibre is not None]
    assert len(regions) >= 2
    for region in regions:
        assert region.fibre.n_tori == tori_of_the_top(numbers, region.fibre.value)
    for region in regions[:2]:  # the large ones also by points on the fibre
        starts = 0.5 * np.random.default_rng(0).normal(size=(1500, 6))

        def functions(x):
            return np.stack([*squares_and_pfaffian(x), *energy_and_k(x)], axis=1)

        shares = np.bincount(pieces(functions, np.array([*numbers, *region.fibre.value]), starts))
        assert (shares > 30).sum() == region.fibre.n_tori


# ------------------------------------------------------------------- Henon and Heiles, the sum of two cubic oscillators

SAWADA_KOTERA = lp.catalog.system("henon-heiles-sawada-kotera")
TOP = 1 / 12
r"""H = h(u) + h(v), K = h(u) - h(v), with u, v = (y +- x)/sqrt 2 and h(u) = (p^2 + u^2)/2 + (sqrt 2/3) u^3, which rests
at 0 and on its hill, h = 1/12."""


def test_h_and_k_are_sum_and_difference():
    x, y, p, q = np.random.default_rng(1).normal(size=(4, 100))
    one, other = (
        (((q + s * p) ** 2 + (y + s * x) ** 2) / 2) / 2 + 2**0.5 / 3 * ((y + s * x) / 2**0.5) ** 3 for s in (1, -1)
    )
    values = lp.tori.momentum_map(SAWADA_KOTERA)(np.stack([x, y, p, q], axis=1))
    np.testing.assert_allclose(values, np.stack([one + other, one - other], axis=1), atol=1e-12)


@pytest.mark.parametrize("n", [30, pytest.param(400, marks=pytest.mark.slow)])
def test_critical_values_of_two_oscillators(n):
    """One of them rests: elliptic at 0, hyperbolic on the hill."""
    found = lp.tori.critical_states(lp.Leaf(SAWADA_KOTERA, {}), n_starts=n, spread=0.5)
    assert len(found) > 0.9 * n
    for (h, k), rank, kind in zip(found.values, found.rank, found.type, strict=True):
        parts = np.array([(h + k) / 2, (h - k) / 2])
        miss = np.abs([parts, parts - TOP])
        assert miss.min() < 1e-9
        assert rank == 2 - (miss.min(axis=0) < 1e-9).sum()
        if rank == 1:
            assert kind == ("elliptic" if miss[0].min() < miss[1].min() else "hyperbolic")


@pytest.mark.slow
@pytest.mark.parametrize("energy_max", [None, 0.3])
def test_the_diagram_of_two_oscillators_is_four_lines(energy_max):
    found = lp.tori.diagram(lp.Leaf(SAWADA_KOTERA, {}), energy_max=energy_max)
    rests = sorted(zip(np.round(found.rest_values, 9).tolist(), found.rest_types, strict=True))
    hill = round(TOP, 9)
    assert [kind for _, kind in rests] == [
        "elliptic, elliptic",
        *["elliptic, hyperbolic"] * 2,
        "hyperbolic, hyperbolic",
    ]
    np.testing.assert_allclose([at for at, _ in rests], [[0, 0], [hill, -hill], [hill, hill], [2 * hill, 0]], atol=1e-8)
    for family in found.families:
        parts = np.stack([family.values.sum(axis=1), family.values @ [1, -1]]) / 2
        rest = {"elliptic": 0.0, "hyperbolic": TOP}[family.type]
        assert np.abs(parts - rest).max(axis=1).min() < 1e-9
    # Each line has no lower bound, and is found from the mirror image of the highest energy in the lowest equilibrium
    assert min(np.sort(family.values[:, 0])[1] for family in found.families) >= -found.energy_max - 1e-9
    for sign in (1, -1):
        for rest, kind in ((0, "elliptic"), (TOP, "hyperbolic")):
            for other in np.linspace(-0.75 * found.energy_max - rest, 0.75 * found.energy_max - rest, 40):
                value = np.array([rest + other, sign * (rest - other)])
                ends = [(one.values[:-1], one.values[1:]) for one in found.families if one.type == kind]
                assert min(distance(value, *pair) for pair in ends) < 1e-2, (kind, value)


def distance(value, begin, end):
    along = end - begin
    share = np.clip(((value - begin) * along).sum(1) / np.maximum((along**2).sum(1), 1e-300), 0, 1)
    return np.linalg.norm(begin + share[:, None] * along - value, axis=1).min()


def test_fibres_with_parts_that_go_to_infinity_are_refused():
    with pytest.raises(OrbitError, match="not compact"):
        lp.tori.fibre(lp.Leaf(SAWADA_KOTERA, {}), [0.06, 0.01], n_states=10)


def test_a_torus_of_two_oscillators_has_the_periods_of_each():
    """2 pi/omega by quadrature between the turning points, u = middle + half sin(angle)."""
    x = np.array([0.05, 0.1, 0.12, -0.08])
    torus = lp.tori.period_lattice(SAWADA_KOTERA, x)
    h, k = torus.values
    periods = [period((h + k) / 2), period((h - k) / 2)]
    # The flows of H and K turn u by t + s and v by t - s
    expected = np.array([[periods[0], periods[0]], [periods[1], -periods[1]]]) / 2
    found = np.linalg.solve(expected.T, torus.periods.T).T
    np.testing.assert_allclose(found, np.round(found), atol=1e-9)
    assert abs(np.linalg.det(found)) == pytest.approx(1)


def period(energy):
    roots = np.sort(np.roots([-(2**1.5) / 3, -1, 0, 2 * energy]).real)
    outer, low, high = roots
    angle = (np.arange(400) + 0.5) * np.pi / 400 - np.pi / 2
    u = (low + high) / 2 + (high - low) / 2 * np.sin(angle)
    return 2 * np.pi / 400 * (1 / np.sqrt(2**1.5 / 3 * (u - outer))).sum()


# ------------------------------------------------------------------------------------------ Henon and Heiles, KdV

KDV = lp.catalog.system("henon-heiles-kdv")
FREQUENCIES = 1.0, 1.5


def f():
    r"""The quartic f with V (m - n) = f(m) - f(n), where x^2 = -4 m n, y = m + n + c and c = A - B/4."""
    a, b = FREQUENCIES
    c = a - b / 4
    return np.array([2, b / 2 + 6 * c, b * c + 6 * c**2, b * c**2 / 2 + 2 * c**3, 0])


def of_motion(value):
    """P with (m p_m)^2 = P(m), (n p_n)^2 = P(n), m >= 0 >= n: P = 2 m (S + H m - f(m)) and K = 8 S; and P/2m."""
    h, k = value
    inner = np.polysub([h, k / 8], f())
    return np.polymul([2, 0], inner), inner


@pytest.mark.parametrize("n", [500, pytest.param(10_000, marks=pytest.mark.slow)])
def test_values_of_random_states_of_kdv_have_motion(n):
    """P is the square of a momentum at the coordinates of the state."""
    states = np.random.default_rng(n).normal(size=(n, 4))
    a, b = FREQUENCIES
    for (x, y, p, q), value in zip(states, lp.tori.momentum_map(KDV)(states), strict=True):
        P = of_motion(value)[0]
        shifted = y - a + b / 4
        half = np.hypot(shifted, x) / 2
        for place, other in ((shifted / 2 + half, shifted / 2 - half), (shifted / 2 - half, shifted / 2 + half)):
            square = (place * (q - 2 * p * other / x)) ** 2
            assert np.polyval(P, place) == pytest.approx(
                square, abs=1e-7 * (1 + square + np.polyval(np.abs(P), abs(place)))
            )


@pytest.mark.parametrize("n", [30, pytest.param(400, marks=pytest.mark.slow)])
def test_critical_values_of_kdv_have_a_double_root(n):
    """At 0 where S = 0; elliptic where P has a maximum, hyperbolic where it has a minimum."""
    found = lp.tori.critical_states(lp.Leaf(KDV, {}), n_starts=n, spread=0.7)
    assert len(found) > 0.9 * n
    for value, rank, kind in zip(found.values, found.rank, found.type, strict=True):
        P, inner = of_motion(value)
        t = np.roots(np.polyder(inner))
        t = np.append(t.real[np.abs(t.imag) < 1e-5], 0.0)
        miss = np.append(np.abs(np.polyval(inner, t[:-1])), abs(value[1] / 8))
        assert miss.min() < 1e-9 * (1 + np.abs(value).max())
        bend = np.polyval(np.polyder(P, 2), t[miss.argmin()])
        if rank == 1 and abs(bend) > 1e-2:
            assert kind == ("elliptic" if bend < 0 else "hyperbolic"), (value, t[miss.argmin()])


@pytest.mark.slow
def test_the_diagram_of_kdv_is_the_curve_of_double_roots():
    found = lp.tori.diagram(lp.Leaf(KDV, {}), energy_max=1.0, spread=0.7)
    assert sorted(found.rest_types) == ["elliptic, elliptic", "elliptic, hyperbolic"]
    for family in found.families:
        for value in family.values[2:-2]:
            inner = of_motion(value)[1]
            t = np.roots(np.polyder(inner))
            t = t.real[np.abs(t.imag) < 1e-5]
            miss = np.append(np.abs(np.polyval(inner, t)), abs(value[1] / 8))
            assert miss.min() < 1e-9 * (1 + np.abs(value).max())
