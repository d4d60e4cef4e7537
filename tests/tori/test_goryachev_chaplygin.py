r"""The top of Goryachev and Chaplygin on l.alpha = 0, |alpha| = 1 against its separated variables.

Let $s = l_1^2 + l_2^2$, $u, v = \sqrt{l_3^2 + s} \pm l_3$, so that $u - v = 2l_3$, $uv = s$.  Then 8 H (u + v) =
u^3 + v^3 + 8 alpha1 (u + v) and 2 G = (u - v) u v - 8 l1 alpha3 are the same as

    u^3 - 8 H u - 2 G = -8 (u alpha1 - l1 alpha3) = 8 u cos X,
    v^3 - 8 H v + 2 G = -8 (v alpha1 + l1 alpha3) = -8 v cos Y,     X = phi - theta, Y = phi + theta.

Here phi is the angle of (l1, l2), and theta that of ((u + v) alpha3/(2 sqrt s), (l1 alpha2 - l2 alpha1)/sqrt s): with
l.alpha = 0 the component of alpha along (l1, l2) is -l3 alpha3/sqrt s, so that |alpha| = 1 makes this a unit vector.
With w = u > 0 and w = -v < 0 both are one curve

    y^2 = P(w) = 64 w^2 - (w^3 - 8 H w - 2 G)^2 = -f(w, 1) f(w, -1),     f(w, sigma) = w^3 - 8 (H + sigma) w - 2 G,

where sigma = cos X of u, -cos Y of -v at the ends of an interval with P > 0, an *oval*.

**Critical values.** Where s is not 0, (u, X, v, Y) are coordinates up to the shift of phi and theta by pi.  The two
equations are linear in H and G with the determinant u + v up to a number, so a state is critical where one of the two
curves is singular: sin X = 0 and f has a double root t, that is 3 t^2 = 8 (H + sigma), G = -t^3.  For sigma = 1 it is
where P has a maximum: an isolated point times an oval, elliptic.  For sigma = -1 it is a minimum: hyperbolic.  Both
curves cannot be singular at once, as -t^3 has one sign.  Where s = 0, G = 0 and l3 alpha3 = 0; at l = 0, alpha3 not 0
the fields are independent.  There remains the pendulum l1 = l2 = alpha3 = 0, critical as G is of the second order
there.  Oscillations, |H| < 1, are mapped to themselves by l -> -l with G -> -G: no extremum, so hyperbolic or
degenerate.  Beside rotations with l3 > 0, H > 1, where v = 0, is 2 G >= v (8 H - 8 - v^2) >= 0: elliptic or degenerate.
The equilibria are degenerate, as on the leaf l1 is of the second order there and G of the third.

**Tori.** A fibre with G not 0 is a covering of two sheets of the products of an oval of u and one of v: the state of
(phi + pi, theta + pi) is another one, (-l1, -l2, l3, alpha1, alpha2, -alpha3).  Around an oval X returns, or, if sigma
is not the same at both ends, increases by 2 pi; phi = (X + Y)/2 then increases by pi.  So a product is covered by one
torus if one of its ovals is of the second kind, else by two.

**Periods.** {u, X} = -{v, Y} = 2 up to sign, the other brackets vanish, and with the times t of H and r of G

    4 du/y = (dt + 4 v dr)/(u + v),   4 dv/y = (dt - 4 u dr)/(u + v)  up to signs of y:

an oval has the periods of (t, r) that are the integrals of (4 w dw/y, dw/y) around it, and the lattice of a torus
consists of those sums of them that increase phi by a multiple of 2 pi.
"""

from collections import Counter
from itertools import pairwise, product

import numpy as np
import pytest
from connected import pieces

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError

TOP = lp.catalog.system("goryachev-chaplygin")
LEAF = lp.Leaf(TOP, {"C1": 0, "C2": 1})
MAP = lp.tori.momentum_map(TOP, leaf=LEAF)
REGIONS = {(0.3, 4.0): 1, (0.3, -4.0): 1, (2.0, 9.0): 1, (2.0, -9.0): 1, (2.0, 2.0): 2, (2.0, -2.0): 2}
"""Values and their tori: beyond the inner curves one, inside of them two."""


def cubics(value):
    h, g = value
    return {sigma: np.array([1, 0, -8 * (h + sigma), -2 * g]) for sigma in (1, -1)}


def ovals(value):
    """Ends with sigma there, for w > 0 and for w < 0."""
    ends = [(w.real, sigma) for sigma, f in cubics(value).items() for w in np.roots(f) if abs(w.imag) < 1e-9]
    ends.sort()
    found = {1: [], -1: []}
    for one, other in pairwise(ends):
        middle = (one[0] + other[0]) / 2
        if np.prod([np.polyval(f, middle) for f in cubics(value).values()]) < 0:
            found[1 if middle > 0 else -1].append((one, other))
    return found


def turns(oval):
    return int(oval[0][1] != oval[1][1])


def n_tori(value):
    found = ovals(value)
    return sum(1 if turns(one) or turns(other) else 2 for one, other in product(found[1], found[-1]))


def separated(x):
    """(u, X, v, Y) of states."""
    l, a = x[..., :3], x[..., 3:]
    s = l[..., 0] ** 2 + l[..., 1] ** 2
    u, v = (np.sqrt(l[..., 2] ** 2 + s) + sign * l[..., 2] for sign in (1, -1))
    phi = np.arctan2(l[..., 1], l[..., 0])
    theta = np.arctan2(2 * (l[..., 0] * a[..., 1] - l[..., 1] * a[..., 0]), (u + v) * a[..., 2])
    return u, phi - theta, v, phi + theta


def states_of_leaf(n, seed=0):
    return LEAF.project(1.5 * np.random.default_rng(seed).normal(size=(n, 6)))


# --------------------------------------------------------------------------------------------- the map and its leaf


def test_the_cubic_commutes_with_h_on_this_leaf_alone():
    assert MAP.names == ("H", "G")
    assert MAP.leaf is LEAF
    assert repr(MAP) == "<Momentum map (H, G) of 'goryachev-chaplygin' where C1 = 0, C2 = 1>"
    cubic = "l3*(l1^2 + l2^2) - 4*l1*alpha3"
    assert lp.tori.momentum_map(TOP, [cubic], leaf=LEAF).leaf is LEAF
    assert lp.tori.momentum_map(TOP, [f"{cubic} + l2*dot(l, alpha)"], leaf=LEAF).leaf is LEAF
    assert lp.tori.momentum_map(TOP, [f"{cubic} + l2*(dot(alpha, alpha) - 1)"], leaf=LEAF).leaf is LEAF
    for values, other in (
        ({"C1": 0, "C2": 1}, f"{cubic} + l2*(dot(alpha, alpha) - 2)"),
        ({"C1": 2.0**-60, "C2": 1}, cubic),
    ):
        with pytest.raises(ParameterError, match="wanted functions that commute on"):
            lp.tori.momentum_map(TOP, [other], leaf=lp.Leaf(TOP, values))
    with pytest.raises(ParameterError, match="independent"):
        lp.tori.momentum_map(TOP, [f"({cubic})*dot(l, alpha)"], leaf=LEAF)
    with pytest.raises(ParameterError, match=r"G where alpha1\*l1 \+ alpha2\*l2 \+ alpha3\*l3 = 0; take one"):
        lp.tori.momentum_map(TOP)
    with pytest.raises(ParameterError, match="Where some leaf is meant, give it"):
        lp.tori.momentum_map(TOP, ["G"])


def test_what_commutes_everywhere_is_a_map_of_all_leaves():
    pendulum = lp.catalog.system("spherical-pendulum")
    leaf = lp.Leaf(pendulum, {"C1": 0, "C2": 1})
    assert lp.tori.momentum_map(pendulum, leaf=leaf).leaf is None
    assert lp.tori.momentum_map(pendulum, ["l3"], leaf=leaf).leaf is None
    with pytest.raises(ParameterError, match="wanted one of 'goryachev-chaplygin'"):
        lp.tori.momentum_map(TOP, leaf=leaf)


def test_other_leaves_are_refused():
    other = lp.Leaf(TOP, {"C1": 0, "C2": 2})
    state = other.state
    for call in (
        lambda: lp.tori.critical_states(other, momentum=MAP),
        lambda: lp.tori.diagram(other, momentum=MAP),
        lambda: lp.tori.fibre(other, [0.3, 4], momentum=MAP),
        lambda: lp.tori.molecule(other, 0.3, momentum=MAP),
        lambda: lp.tori.period_lattice(MAP, state),
        lambda: lp.tori.monodromy(MAP, state, [[0, 1], [0, 2], [1, 1]]),
        lambda: MAP.flow([LEAF.state, state], [0.1, 0.1]),
    ):
        with pytest.raises(LeafError, match=r"C1 = 0, C2 = 1>, on which alone the map \(H, G\) holds"):
            call()
    assert np.isfinite(MAP.flow([LEAF.state, np.full(6, np.nan)], [0.1, 0.1])[0]).all()


def test_files_keep_the_leaf(tmp_path):
    found = lp.tori.critical_states(LEAF, n_starts=5)
    again = lp.load(found.save(tmp_path / "critical.nc"))
    assert again.momentum.leaf.casimirs == {"C1": 0, "C2": 1}
    with pytest.raises(LeafError, match="holds"):
        again.momentum.flow([1, 2, 3, 4, 5, 6], [0.1, 0.1])


# ------------------------------------------------------------------------------------------------------ the diagram


@pytest.mark.parametrize("n", [500, pytest.param(10_000, marks=pytest.mark.slow)])
def test_random_states_are_on_the_separated_curves(n):
    """And so in the image, |G| <= (8 (H + 1)/3)^(3/2), and on ovals of their values."""
    x = states_of_leaf(n)
    h, g = MAP(x).T
    u, X, v, Y = separated(x)
    size = 1 + u**3 + v**3 + np.abs(g)
    assert (np.abs(u**3 - 8 * h * u - 2 * g - 8 * u * np.cos(X)) < 1e-12 * size).all()
    assert (np.abs(v**3 - 8 * h * v + 2 * g + 8 * v * np.cos(Y)) < 1e-12 * size).all()
    assert (np.abs(g) <= (8 * (h + 1) / 3) ** 1.5).all()
    for value, place in zip(MAP(x), zip(u, -v, strict=True), strict=True):
        found = ovals(value)
        for w, some in zip(place, (found[1], found[-1]), strict=True):
            assert any(low - 1e-7 <= w <= high + 1e-7 for (low, _), (high, _) in some), (value, w)


@pytest.mark.parametrize("n", [100, pytest.param(10_000, marks=[pytest.mark.slow])])
def test_orbits_stay_on_their_ovals(n):
    x = states_of_leaf(n, seed=1)
    ends = lp.integrate(TOP, x, times=[0, 5, 10], method=lp.Taylor()).state
    for value, orbit in zip(MAP(x), ends, strict=True):
        np.testing.assert_allclose(MAP(orbit), np.broadcast_to(value, (3, 2)), rtol=1e-9, atol=1e-9)
        u, _, v, _ = separated(orbit)
        found = ovals(value)
        for w, some in ((u, found[1]), (-v, found[-1])):
            inside = [((low - 1e-6 <= w) & (w <= high + 1e-6)).all() for (low, _), (high, _) in some]
            assert sum(inside) == 1, (value, w)


def on_curves(value):
    """How far a value is from the nearest curve, as a share of what its sides are, and which: 1, -1 or 0 for G = 0."""
    h, g = value
    misses = {0: abs(g) / (1 + abs(h) ** 1.5)}
    for sigma in (1, -1):
        t = -np.cbrt(g)
        misses[sigma] = abs(3 * t**2 - 8 * (h + sigma)) / (8 + 8 * abs(h))
    best = min(misses, key=lambda one: misses[one])
    return misses[best], best


def kind_of(curve, h):
    if curve == 0:
        return "hyperbolic" if h < 1 else "elliptic"
    return "elliptic" if curve == 1 else "hyperbolic"


@pytest.mark.parametrize("n", [60, pytest.param(400, marks=pytest.mark.slow)])
def test_critical_values_are_on_the_curves(n):
    found = lp.tori.critical_states(LEAF, n_starts=n)
    assert len(found) > 0.8 * n
    seen = Counter()
    for value, rank, kind in zip(found.values, found.rank, found.type, strict=True):
        miss, curve = on_curves(value)
        assert miss < 1e-9, value
        if rank == 1 and abs(value[0] - 1) > 1e-3 and value[0] > -0.999:
            assert kind == kind_of(curve, value[0]), (value, curve)
            seen[curve, kind] += 1
    if n > 100:
        assert set(seen) == {(1, "elliptic"), (-1, "hyperbolic"), (0, "hyperbolic"), (0, "elliptic")}


@pytest.fixture(scope="module")
def drawn():
    return lp.tori.diagram(LEAF, energy_max=3.0, n_starts=80)


@pytest.mark.thorough
def test_the_diagram_is_these_curves_each_once(drawn):
    assert drawn.momentum.leaf is drawn.leaf
    order = np.argsort(drawn.rest_values[:, 0])
    np.testing.assert_allclose(drawn.rest_values[order], [[-1, 0], [1, 0]], atol=1e-12)
    assert drawn.rest_types == ("degenerate", "degenerate")
    seen = Counter()
    for family in drawn.families:
        curves = set()
        for value in family.values[2:-2]:
            miss, curve = on_curves(value)
            assert miss < 1e-9
            assert family.type == kind_of(curve, value[0])
            curves.add((curve, float(np.sign(value[1])) if curve else float(np.sign(value[0] - 1))))
        assert len(curves) == 1
        steps = np.diff(family.values[:, 0])
        assert (steps * steps[len(steps) // 2] > -1e-12).all(), "a curve that is run along twice"
        seen[curves.pop()] += 1
    assert seen == dict.fromkeys([(1, 1.0), (1, -1.0), (-1, 1.0), (-1, -1.0), (0, 1.0), (0, -1.0)], 1)
    wanted = [[h, 0.0] for h in np.linspace(-1, 3, 200)]
    for sigma in (1, -1):
        t = np.linspace(-1, 1, 401) * np.sqrt(8 * (3 + sigma) / 3)
        wanted += np.stack([3 * t**2 / 8 - sigma, -(t**3)], axis=1).tolist()
    begins, ends = (np.concatenate([one.values[part] for one in drawn.families]) for part in (np.s_[:-1], np.s_[1:]))
    along = ends - begins
    for value in np.array(wanted):
        share = np.clip(((value - begins) * along).sum(1) / (along**2).sum(1).clip(1e-300), 0, 1)
        assert np.linalg.norm(begins + share[:, None] * along - value, axis=1).min() < 0.02, value


# --------------------------------------------------------------------------------------------------------- the tori


def functions(x):
    """l.alpha, |alpha|^2, H, G."""
    l, a = x[:, :3], x[:, 3:]
    s = l[:, 0] ** 2 + l[:, 1] ** 2
    h, g = s / 8 + l[:, 2] ** 2 / 2 + a[:, 0], l[:, 2] * s - 4 * l[:, 0] * a[:, 2]
    return np.stack([(l * a).sum(1), (a * a).sum(1), h, g], axis=1)


def by_pieces(value):
    starts = 1.2 * np.random.default_rng(0).normal(size=(1500, 6))
    shares = np.bincount(pieces(functions, np.array([0, 1, *value]), starts))
    return int((shares > 0.02 * shares.sum()).sum())


def test_tori_of_the_separation():
    assert {value: n_tori(value) for value in REGIONS} == REGIONS


@pytest.mark.thorough
@pytest.mark.parametrize("value", [*REGIONS][::2])
def test_fibres_have_these_tori(value):
    assert lp.tori.fibre(LEAF, value, momentum=MAP, n_states=40).n_tori == REGIONS[value]


@pytest.mark.slow
@pytest.mark.parametrize("value", [*REGIONS])
def test_pieces_of_fibres_are_as_many(value):
    assert by_pieces(value) == REGIONS[value]


@pytest.mark.thorough
def test_regions_have_these_tori(drawn):
    found = lp.tori.regions(drawn, n_states=40)
    assert len(found) == 4
    assert sorted(one.fibre.n_tori for one in found) == [1, 1, 2, 2]
    for region in found:
        assert {n_tori(value) for value in region.values} == {region.fibre.n_tori}


def lattice(x):
    """The periods of the product of ovals through a state, as rows, and of them a basis of those of the torus."""
    value = MAP(x)
    u, _, v, _ = separated(x)
    ways = [
        next(one for one in ovals(value)[sign] if one[0][0] - 1e-9 <= w <= one[1][0] + 1e-9)
        for sign, w in ((1, u), (-1, -v))
    ]
    rows = []
    for (low, _), (high, _) in ways:
        others = np.concatenate([np.roots(f) for f in cubics(value).values()])
        others = np.delete(others, [np.abs(others - low).argmin(), np.abs(others - high).argmin()])
        angle = (np.arange(4000) + 0.5) * np.pi / 4000 - np.pi / 2
        w = (low + high) / 2 + (high - low) / 2 * np.sin(angle)
        rate = 2 * np.pi / 4000 / np.sqrt(np.prod(w[:, None] - others, axis=1).real)
        rows.append([(4 * w * rate).sum(), rate.sum()])
    one, other = np.array(rows)
    match [turns(way) for way in ways]:
        case [0, 0]:
            return np.array([one, other])
        case [1, 0]:
            return np.array([2 * one, other])
        case [0, 1]:
            return np.array([one, 2 * other])
    return np.array([one + other, one - other])


@pytest.mark.parametrize(
    "value", [(2.0, 2.0), *(pytest.param(one, marks=pytest.mark.thorough) for one in REGIONS if one != (2.0, 2.0))]
)
def test_periods_are_integrals_around_the_ovals(value):
    """On each torus of a fibre, of which (H, G) = (2, 2) has two with different lattices."""
    fibre = lp.tori.fibre(LEAF, value, momentum=MAP, n_states=12)
    for number in range(fibre.n_tori):
        x = fibre.states[fibre.torus == number][0]
        torus = lp.tori.period_lattice(MAP, x)
        assert torus.momentum.leaf is LEAF
        quotient = torus.periods @ np.linalg.inv(lattice(x))
        np.testing.assert_allclose(quotient, np.round(quotient), atol=1e-9)  # measured up to
        assert abs(round(np.linalg.det(quotient))) == 1


# ------------------------------------------------------------------------------------------------------- the graphs


@pytest.mark.thorough
@pytest.mark.parametrize("energy", [1.5, *(pytest.param(h, marks=pytest.mark.slow) for h in (-0.5, 0.9, 1.3, 4.0))])
def test_graphs_are_those_of_the_diagram(energy):
    """H < 1: a saddle that one torus passes at G = 0.  H > 1: of two tori beside, one ends or begins there."""
    found = lp.tori.molecule(LEAF, energy, n_starts=80)
    outer, inner = ((8 * max(energy + sigma, 0) / 3) ** 1.5 for sigma in (1, -1))
    if energy < 1:
        names, values, families = ["A", "A*", "A"], [-outer, 0, outer], [[0, 1], [1, 2]]
    else:
        names, values = ["A", "B", "A", "A", "B", "A"], [-outer, -inner, 0, 0, inner, outer]
        families = [[0, 1], [1, 3], [1, 4], [2, 4], [4, 5]]
    assert [atom.name for atom in found.atoms] == names
    np.testing.assert_allclose([atom.value for atom in found.atoms], values, rtol=1e-9, atol=1e-9)
    if energy > 1 and not found.atoms[2].above:  # of the two atoms at G = 0 either may be the first
        families = [[0, 1], [1, 2], [1, 4], [3, 4], [4, 5]]
    assert found.families.tolist() == families
