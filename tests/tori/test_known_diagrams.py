"""Diagrams of the free rigid body with a vector, of Lagrange's top and of the spherical pendulum, in closed form."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
import sympy as sp
from lattices import check_frequencies, same_lattice
from numpy.polynomial import Polynomial

import liepoisson as lp
from liepoisson.tori.momentum_maps import MomentumMap

STARTS = [60, pytest.param(400, marks=pytest.mark.slow)]
STATES = [500, pytest.param(10_000, marks=pytest.mark.slow)]
ROUND_OFF = 1e-9  # of values, relative to their size; 3e-12 was measured


@dataclass(frozen=True)
class Known:
    """A leaf whose diagram is known.

    Attributes:
        curves: By type, values of the two integrals on curves of rank 1 up to the energy, shape (m, 2) each.
        kind: The type of a value of rank 1, and how far it is from its curve.
        region: The name of the region of regular values, shape (m, 2); "" where there are no states.
        tori: Their number by region.
        rests: Values and types of the equilibria, each as often as there are.
    """

    leaf: lp.Leaf
    momentum: MomentumMap
    energy_max: float
    curves: dict[str, list[np.ndarray]]
    kind: Callable[[np.ndarray], tuple[str, float]]
    region: Callable[[np.ndarray], list[str]]
    tori: dict[str, int]
    rests: list[tuple[float, float, str]]


# -------------------------------------------------------------------- the free rigid body, and a vector fixed in space

MOMENTS = 1.0, 1.5, 2.5
BODY = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/3 + l3^2/5", name="free body")
SQUARE = "dot(l, l)"


def free_body(c):
    r"""H and G = |l|^2 where l.alpha = c > 0 and |alpha| = 1.

    The fields are $(l\times\omega, \alpha\times\omega)$ and $(0, 2\alpha\times l)$.  They are dependent where alpha
    and l are parallel, G = c^2, a minimum of G; and where l is along a principal axis, G = 2 I_k H, an extremum
    of H on a sphere of l for the least and largest moments and a saddle for the middle one.  At both the body rests in
    a frame that turns around l.

    Regular fibres: l is on one of the two closed curves of |l|^2 = G and H, around one axis and its opposite; over each
    l the alpha with l.alpha = c are a circle.  So there are two tori.
    """

    def line(moment):
        g = np.linspace(c**2, 4.0, 200)
        return np.stack([g / (2 * moment), g], axis=1)

    h = np.linspace(c**2 / (2 * MOMENTS[2]), c**2 / (2 * MOMENTS[0]), 200)
    floor = np.stack([h, 0 * h + c**2], axis=1)

    def kind(value):
        miss = np.abs([*(value[0] - value[1] / (2 * one) for one in MOMENTS), value[1] - c**2])
        return ["elliptic", "hyperbolic", "elliptic", "elliptic"][miss.argmin()], miss.min()

    def region(values):
        h, g = values.T
        inside = (g > c**2) & (g < 2 * MOMENTS[2] * h) & (g > 2 * MOMENTS[0] * h)
        return np.where(inside, np.where(g > 2 * MOMENTS[1] * h, "largest", "least"), "").tolist()

    ends = ["elliptic, elliptic", "elliptic, hyperbolic", "elliptic, elliptic"]
    return Known(
        lp.Leaf(BODY, {"C1": c, "C2": 1}),
        lp.tori.momentum_map(BODY, [SQUARE]),
        2.0,
        {"elliptic": [line(MOMENTS[0]), line(MOMENTS[2]), floor], "hyperbolic": [line(MOMENTS[1])]},
        kind,
        region,
        {"largest": 2, "least": 2},
        2 * [(c**2 / (2 * one), c**2, end) for one, end in zip(MOMENTS, ends, strict=True)],
    )


# -------------------------------------------------------------- Lagrange's top, of which the pendulum is the case c = 0

LAGRANGE = lp.catalog.system("lagrange")
PENDULUM = lp.catalog.system("spherical-pendulum")


def of_height(c, excess, value):
    r"""f with $\dot z^2 = f(z)$ for $z = \alpha_3$, a = I1 = 1: $(2H - rl_3^2 - 2z)(1 - z^2) - (c - l_3z)^2$, r = 1/I3.

    Of $(l_1, l_2)$ $\dot z = \alpha_1l_2 - \alpha_2l_1$ and $\alpha_1l_1 + \alpha_2l_2 = c - l_3z$ are the parts.
    """
    h, spin = value
    return Polynomial([2 * h - excess * spin**2, -2]) * Polynomial([1, 0, -1]) - Polynomial([c, -spin]) ** 2


def symmetric_top(system, c, excess, energy_max):
    r"""H and l3 where l.alpha = c >= 0, |alpha| = 1, I1 = a = 1 and I3 = 1/r.

    Critical states of rank 1 precess steadily at a rate p: with the vertical momentum $l = p(\alpha - ze_3) + l_3e_3$
    the torques balance where $p^2z - pl_3 + 1 = 0$, and $c = p(1 - z^2) + l_3z$.  So $l_3 = pz + 1/p$, $c = p + z/p$:

    $$ z = p(c - p), \quad l_3 = p^2(c - p) + 1/p, \quad 2H = p^2(1 - z^2) + rl_3^2 + 2z, \qquad |z| < 1. $$

    f goes to infinity with z and is not positive at 1 and -1, so that one of three roots is at 1 or beyond: a double
    root between is a maximum, and elliptic.  Equilibria: z = l3/c = -1, and z = 1, where $1 + s(s - c) = 0$ for rates s
    in the rotating frame: focus-focus for c < 2, else elliptic.

    Regular fibres: f > 0 on one interval between -1 and 1.  Of its circle of (z, dz/dt) and that of the azimuth the
    fibre is the product: one torus.
    """
    ends = [(c - np.sqrt(c**2 + 4)) / 2, (c + np.sqrt(c**2 + 4)) / 2]
    parts = [(ends[0], -1e-3)]
    if c < 2:
        parts += [(1e-3, ends[1])]
    else:
        parts += [(1e-3, (c - np.sqrt(c**2 - 4)) / 2), ((c + np.sqrt(c**2 - 4)) / 2, ends[1])]

    def curve(low, high):
        p = np.sign(low) * np.geomspace(abs(low), abs(high), 3000)
        z = p * (c - p)
        spin = p * z + 1 / p
        values = np.stack([(p**2 * (1 - z**2) + excess * spin**2) / 2 + z, spin], axis=1)
        return values[values[:, 0] < energy_max]

    def kind(value):
        f = of_height(c, excess, value)
        z = f.deriv().roots()
        z = z.real[np.abs(z.imag) < 1e-6]
        return "elliptic", np.abs(f(z[np.abs(z) < 1 + 1e-6])).min()

    def region(values):
        names = []
        for value in values:
            f = of_height(c, excess, value)
            z = f.deriv().roots()
            z = z.real[np.abs(z.imag) < 1e-9]
            names.append("whole" if (f(z[np.abs(z) < 1]) > 0).any() else "")
        return names

    def rest(z, type_):
        return (excess * c**2 / 2 + z, c * z, type_)

    upright = "focus-focus" if c < 2 else "elliptic, elliptic"
    return Known(
        lp.Leaf(system, {"C1": c, "C2": 1}),
        lp.tori.momentum_map(system),
        energy_max,
        {"elliptic": [curve(*part) for part in parts]},
        kind,
        region,
        {"whole": 1},
        [rest(-1, "elliptic, elliptic"), rest(1, upright)],
    )


DIAGRAMS = {
    "free body, 0.7": lambda: free_body(0.7),
    "free body, 1.2": lambda: free_body(1.2),
    "lagrange, 0": lambda: symmetric_top(LAGRANGE, 0.0, 2.0, 6.0),
    "lagrange, 1": lambda: symmetric_top(LAGRANGE, 1.0, 2.0, 6.0),
    "lagrange, 2.5": lambda: symmetric_top(LAGRANGE, 2.5, 2.0, 12.0),
    "pendulum": lambda: symmetric_top(PENDULUM, 0.0, 1.0, 3.0),
}


OFTEN = "free body, 0.7", "lagrange, 2.5", "pendulum"
PARAMS = [name if name in OFTEN else pytest.param(name, marks=pytest.mark.slow) for name in DIAGRAMS]


@pytest.fixture(scope="module", params=PARAMS)
def known(request):
    return DIAGRAMS[request.param]()


@pytest.fixture(scope="module")
def drawn(known):
    return lp.tori.diagram(known.leaf, momentum=known.momentum, energy_max=known.energy_max, n_starts=30)


@pytest.mark.parametrize("n", STARTS)
def test_critical_values_are_on_the_curves(known, n):
    found = lp.tori.critical_states(known.leaf, momentum=known.momentum, n_starts=n)
    assert len(found) > 0.4 * n
    for value, rank, type_ in zip(found.values, found.rank, found.type, strict=True):
        expected, miss = known.kind(value)
        assert miss < ROUND_OFF * (1 + np.abs(value).max()), value
        if rank == 1:
            assert type_ == expected, value
        else:
            assert type_ in {one[2] for one in known.rests if np.allclose(value, one[:2])}


@pytest.mark.parametrize("n", STATES)
def test_values_of_random_states_are_in_a_region(known, n):
    states = known.leaf.project(np.random.default_rng(n).normal(size=(n, 6)))
    assert "" not in known.region(known.momentum(states))


def test_equilibria_are_known(known, drawn):
    wanted = sorted(known.rests)
    found = sorted((*value, kind) for value, kind in zip(drawn.rest_values.tolist(), drawn.rest_types, strict=True))
    assert sorted(one[2] for one in found) == sorted(one[2] for one in wanted)
    for kind in {one[2] for one in wanted}:
        values = [[one[:2] for one in some if one[2] == kind] for some in (found, wanted)]
        distance = np.abs(np.array(values[0])[:, None] - np.array(values[1])).max(axis=2)
        assert max(distance.min(axis=0).max(), distance.min(axis=1).max()) < ROUND_OFF


def test_families_are_on_the_curves_and_cover_them(known, drawn):
    for family in drawn.families:
        for value in family.values[1:-1]:
            expected, miss = known.kind(value)
            assert family.type == expected
            assert miss < ROUND_OFF * (1 + np.abs(value).max())
    for type_, curves in known.curves.items():
        families = [one.values for one in drawn.families if one.type == type_]
        begins, ends = (np.concatenate([one[cut] for one in families]) for cut in (slice(-1), slice(1, None)))
        for curve in curves:
            inside = curve[curve[:, 0] < known.energy_max]
            along, offset = ends - begins, inside[:, None] - begins
            share = np.clip((offset * along).sum(2) / np.maximum((along**2).sum(1), 1e-300), 0, 1)
            miss = np.linalg.norm(offset - share[..., None] * along, axis=2).min(axis=1)
            assert miss.max() < 2e-3 * (1 + np.abs(inside).max()), (type_, inside[miss.argmax()])  # chords


def test_regions_have_as_many_tori_as_is_proved(known, drawn):
    regions = [one for one in lp.tori.regions(drawn, n_values=200, n_states=40) if one.fibre is not None]
    seen = set()
    for region in regions:
        (name,) = set(known.region(region.values))
        assert region.fibre.n_tori == known.tori[name]
        seen.add(name)
    assert seen == set(known.tori)


# ------------------------------------------------------------------------------------------------------------- lattices


def states_of(known, n, seed=3):
    return known.leaf.project(np.random.default_rng(seed).normal(size=(n, 6)))


def lattice_of_the_free_body(x):
    r"""A period T of l, in which the body turns by an angle around l, and the turn by 2 pi of the flow of |l|^2.

    l is around the axis a; $l_m = A\sin\theta$, $l_o = B\cos\theta$ with m the middle axis and o the other one, and
    $\dot l_m = \pm(1/I_a - 1/I_o)l_al_o$.  The axis m precesses around l at the rate
    $|l|(2H - l_m^2/I_m)/(|l|^2 - l_m^2)$, and the flow of |l|^2 turns everything around l at the rate 2|l|.
    """
    l = x[:3]
    square, twice = l @ l, l @ (l / MOMENTS)
    m = 1
    a, o = (2, 0) if square > twice * MOMENTS[m] else (0, 2)
    rate = {k: 1 / MOMENTS[k] for k in range(3)}
    first = (twice - square * rate[a]) / (rate[m] - rate[a])  # A^2
    other = (twice - square * rate[a]) / (rate[o] - rate[a])  # B^2
    theta = (np.arange(4000) + 0.5) * 2 * np.pi / 4000
    middle = first * np.sin(theta) ** 2
    along = np.sqrt(square - middle - other * np.cos(theta) ** 2)
    dt = np.sqrt(first / other) / (abs(rate[a] - rate[o]) * along) * 2 * np.pi / 4000
    turn = (np.sqrt(square) * (twice - middle * rate[m]) / (square - middle) * dt).sum()
    return np.array([[dt.sum(), -turn / (2 * np.sqrt(square))], [0, np.pi / np.sqrt(square)]])


def lattice_of_the_top(c, excess, value):
    r"""A period of z, in which the azimuth in the body turns, and the turn by 2 pi of the flow of l3.

    The azimuth of $(\alpha_1, \alpha_2)$ has the rate $z(c - l_3z)/(1 - z^2) - rl_3$, that of the flow of l3 -1.
    """
    low, high, above = np.sort(of_height(c, excess, value).roots().real)
    theta = (np.arange(4000) + 0.5) * np.pi / 4000 - np.pi / 2
    z = (low + high) / 2 + (high - low) / 2 * np.sin(theta)
    dt = np.pi / 4000 / np.sqrt(2 * (above - z))
    turn = ((z * (c - value[1] * z) / (1 - z**2) - excess * value[1]) * dt).sum()
    return np.array([[2 * dt.sum(), 2 * turn], [0, 2 * np.pi]])


@pytest.mark.parametrize("c", [0.7, 1.2])
def test_the_lattice_of_the_free_body_is_that_of_a_quadrature(c):
    known = free_body(c)
    for x in states_of(known, 5):
        assert same_lattice(lp.tori.period_lattice(known.momentum, x).periods, lattice_of_the_free_body(x)) < 1e-11


@pytest.mark.parametrize("c", [0.0, 1.0, 2.5])
def test_the_lattice_of_the_top_is_that_of_a_quadrature(c):
    known = symmetric_top(LAGRANGE, c, 2.0, 6.0)
    for x in states_of(known, 5):
        torus = lp.tori.period_lattice(known.momentum, x)
        assert same_lattice(torus.periods, lattice_of_the_top(c, 2.0, torus.values)) < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_frequencies_of_the_free_body_are_those_of_orbits(seed):
    known = free_body(0.7)
    check_frequencies(known.momentum, states_of(known, 1, seed)[0], ("l2", "alpha2", "alpha1"))


@pytest.mark.parametrize(
    ("c", "turns"), [(1.0, True), *(pytest.param(c, c < 2, marks=pytest.mark.slow) for c in (0.0, 1.5, 2.5))]
)
def test_the_top_has_monodromy_while_it_sleeps_unstably(c, turns):
    """[[1, 1], [0, 1]] in some basis around a focus-focus value; none around nothing."""
    known = symmetric_top(LAGRANGE, c, 2.0, 6.0)
    center = np.array(known.rests[1][:2] if turns else (2 * c**2 / 2 + 4, c))
    angle = np.linspace(0, 2 * np.pi, 9)
    loop = center + 0.01 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert "" not in known.region(loop)
    found = lp.tori.monodromy(known.momentum, states_of(known, 1)[0], loop)
    assert found.is_unipotent
    assert found.is_trivial != turns
    if turns:
        assert np.gcd.reduce((found.matrix - np.eye(2, dtype=int)).ravel()) == 1


def test_the_pendulum_by_elimination():
    """f and f' vanish at z: 2 h = 3 z - 1/z and k^2 = -(1 - z^2)^2/z; z is eliminated."""
    h, k, z = sp.symbols("h k z")
    wanted = 16 * h**4 - 8 * h**3 * k**2 - 32 * h**2 + 72 * h * k**2 - 27 * k**4 + 16
    f = 2 * (h - z) * (1 - z**2) - k**2
    slope = sp.solve(sp.diff(f, z), h)[0]
    assert sp.simplify(slope - (3 * z - 1 / z) / 2) == 0
    square = sp.factor((f + k**2).subs(h, slope))
    assert sp.simplify(square + (1 - z**2) ** 2 / z) == 0
    by_hand = sp.resultant(2 * z * h - 3 * z**2 + 1, z * k**2 + (1 - z**2) ** 2, z)
    assert sp.rem(by_hand, wanted, h) == 0
    (curve,) = lp.tori.critical_equations(PENDULUM, {"C1": 0, "C2": 1}).curves
    ratio = sp.cancel(sp.sympify(str(curve)).subs({"H": h, "l3": k}) / wanted)
    assert ratio.is_number
    found = symmetric_top(PENDULUM, 0.0, 1.0, 3.0).curves["elliptic"]
    values = sp.lambdify((h, k), wanted)(*np.concatenate(found).T)
    assert np.abs(values).max() < 1e-8
