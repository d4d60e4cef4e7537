"""The diagram of Kovalevskaya's top against the curves of the literature, and tori counted without flows.

With l.alpha = 2 ell, |alpha| = 1 critical values are on (Kharlamov 1988; Dullin, Juhnke, Richter 1994; Bolsinov,
Richter, Fomenko 2000)

- k = 0;
- k = (h - 2 ell^2)^2, elliptic for h < 2 ell^2, hyperbolic beyond;
- h = s + ell^2/s^2, k = 1 - 2 ell^2/s + ell^4/s^4 with -1 <= s < 0, elliptic, and s > 0, hyperbolic but between the
  cusp s^3 = 2 ell^2 and s = 2 ell^2, where the curve touches the second one, which ends there.
"""

from collections import Counter

import numpy as np
import pytest
from connected import pieces

import liepoisson as lp

TOP = lp.catalog.system("kovalevskaya")
SQUARES = (0.1, 0.6, 0.9, 1.3)
"""ell^2 in each of the intervals between 0, 1/2, 4/(3 sqrt 3), 1 and infinity: at their ends the diagram changes."""


def leaf(square):
    return lp.Leaf(TOP, {"C1": 2 * square**0.5, "C2": 1})


def third_curve(s, square):
    return s + square / s**2, 1 - 2 * square / s + square**2 / s**4


def on_curves(value, square):
    """How far a value is from the nearest curve, relative to k, which it is, and its s on the third."""
    h, k = value
    s = np.roots([1, -h, 0, square])
    s = s.real[np.abs(s.imag) < 1e-5]
    miss = np.abs(k - third_curve(s, square)[1])
    best = int(miss.argmin())
    misses = [abs(k), abs(k - (h - 2 * square) ** 2), float(miss[best])]
    return min(misses) / max(1.0, abs(k)), int(np.argmin(misses)), float(s[best])


def kind_of(curve, h, s, square):
    if curve == 0:
        return "elliptic"
    if curve == 1:
        return "elliptic" if h < 2 * square else "hyperbolic"
    low, high = sorted([(2 * square) ** (1 / 3), 2 * square])
    return "elliptic" if s < 0 or low < s < high else "hyperbolic"


def is_near_a_change(curve, h, s, square):
    """Whether the type changes nearby: at the vertex of the second curve, at the cusp and where the curves touch."""
    changes = {0: [], 1: [(h, 2 * square), (h, 2 * square + 1 / (4 * square))]}
    places = changes.get(curve, [(s, 2 * square), (s, (2 * square) ** (1 / 3))])
    return any(abs(one - other) < 1e-3 for one, other in places)


@pytest.mark.parametrize(
    ("square", "n"), [(0.1, 30), *(pytest.param(square, 400, marks=pytest.mark.slow) for square in SQUARES)]
)
def test_critical_values_are_on_the_curves(square, n):
    found = lp.tori.critical_states(leaf(square), n_starts=n, spread=1.5)
    assert len(found) > 0.8 * n
    for value, rank, kind in zip(found.values, found.rank, found.type, strict=True):
        miss, curve, s = on_curves(value, square)
        assert miss < 1e-9
        if rank == 1 and not is_near_a_change(curve, value[0], s, square):
            assert kind == kind_of(curve, value[0], s, square), (value, curve, s)


@pytest.mark.parametrize(
    ("square", "n"), [(0.1, 500), *(pytest.param(square, 10_000, marks=pytest.mark.slow) for square in SQUARES)]
)
def test_values_of_random_states_are_in_the_image(square, n):
    """Below the third curve with s < 0, where h grows with s; above the second one to the left of its vertex."""
    chosen = leaf(square)
    states = chosen.project(1.5 * np.random.default_rng(n).normal(size=(n, 6)))
    h, k = lp.tori.momentum_map(TOP)(states).T
    low, high = np.full(n, -1.0), np.full(n, -1e-9)
    for _ in range(100):
        middle = (low + high) / 2
        below = third_curve(middle, square)[0] < h
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    assert (h > square - 1).all()
    assert (k < third_curve(low, square)[1]).all()
    assert (k > np.where(h < 2 * square, (h - 2 * square) ** 2, 0)).all()


@pytest.fixture(scope="module", params=[pytest.param(square, marks=pytest.mark.slow) for square in SQUARES])
def drawn(request):
    return request.param, lp.tori.diagram(leaf(request.param), energy_max=4.0)


def test_the_diagram_is_these_curves_and_all_of_them(drawn):
    square, found = drawn
    seen = Counter()
    for family in found.families:
        for value in family.values[2:-2]:
            miss, curve, s = on_curves(value, square)
            assert miss < 1e-9
            if not is_near_a_change(curve, value[0], s, square):
                assert family.type == kind_of(curve, value[0], s, square)
        seen[family.type] += 1
    s = np.concatenate([-np.linspace(0.02, 1, 400), np.geomspace(0.02, 4, 800)])
    s = s[third_curve(s, square)[1] >= 0]
    if square > 1:  # beyond the equilibrium at s = 1 there are no states up to the cusp
        s = s[(s < 1) | (s > (2 * square) ** (1 / 3))]
    h = np.linspace(square - 1, 2 * square + 1 / (4 * square), 400)
    delone = np.linspace(2 * square, 4, 300)
    wanted = np.concatenate(
        [
            np.stack(third_curve(s, square), axis=1),
            np.stack([h, (h - 2 * square) ** 2], axis=1),
            np.stack([delone, 0 * delone], axis=1),
        ]
    )
    wanted = wanted[wanted[:, 0] < 4]
    have = np.concatenate([np.concatenate([one.values[:-1], one.values[1:]], axis=1) for one in found.families])
    begin, along = have[:, :2], have[:, 2:] - have[:, :2]
    for value in wanted:
        share = np.clip(((value - begin) * along).sum(1) / np.maximum((along**2).sum(1), 1e-300), 0, 1)
        assert np.linalg.norm(begin + share[:, None] * along - value, axis=1).min() < 0.02 * (1 + abs(value[1])), value


# ------------------------------------------------------------------------------------------------- the number of tori


def functions(x):
    """l.alpha, |alpha|^2, H, K."""
    l, a = x[:, :3], x[:, 3:]
    h = (l[:, 0] ** 2 + l[:, 1] ** 2) / 4 + l[:, 2] ** 2 / 2 - a[:, 0]
    k = (l[:, 0] ** 2 / 4 - l[:, 1] ** 2 / 4 + a[:, 0]) ** 2 + (l[:, 0] * l[:, 1] / 2 + a[:, 1]) ** 2
    return np.stack([(l * a).sum(1), (a * a).sum(1), h, k], axis=1)


def between_curves(square, energies):
    """Values in the middle between two curves that are neighbours at an energy."""
    for h in energies:
        s = np.roots([1, -h, 0, square])
        s = s.real[np.abs(s.imag) < 1e-9]
        k = [*third_curve(s, square)[1], *([(h - 2 * square) ** 2] if h < 2 * square + 1 / (4 * square) else [])]
        k = np.sort([*k, *([0.0] if h > 2 * square else [])])
        yield from ((h, float(one)) for one in (k[1:] + k[:-1]) / 2)


TORI = {
    0.1: {0.05: [1], 0.95: [2, 1, 2, 1], 1.5: [2, 2, 2, 1], 3.5: [2, 2, 1]},
    0.6: {1.0: [1], 1.4: [1, 1], 1.597: [1, 1, 2, 1], 3.0: [2, 2, 1]},
    0.9: {1.0: [1], 3.0: [2, 2, 1]},
    1.3: {1.0: [1], 2.5: [1, 1], 3.5: [2, 2, 1]},
}  # by ell^2 and h, from the lowest k to the highest


def by_pieces(square, value):
    starts = 1.2 * np.random.default_rng(0).normal(size=(1500, 6))
    shares = np.bincount(pieces(functions, np.array([2 * square**0.5, 1, *value]), starts))
    return int((shares > 0.02 * shares.sum()).sum())


@pytest.mark.slow
@pytest.mark.parametrize("square", SQUARES)
def test_tori_between_the_curves(square):
    for h, expected in TORI[square].items():
        values = [*between_curves(square, [h])]
        counted = [lp.tori.fibre(leaf(square), value, n_states=60).n_tori for value in values]
        assert counted == expected == [by_pieces(square, value) for value in values], h


def test_regions_have_these_tori(drawn):
    square, found = drawn
    regions = [one for one in lp.tori.regions(found, n_states=60) if one.fibre is not None]
    assert len(regions) >= 3
    for region in regions:
        assert region.fibre.n_tori == by_pieces(square, region.fibre.value)
