"""Graphs of tori of levels of energy: products of wells, whose graphs are known, and the Kovalevskaya top."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import OrbitError, ParameterError, TimeLimitError

WELL = "p1^2/2 - q1^2/2 + q1^4/4"
OTHER = "p2^2/2 - q2^2/2 + q2^4/4"
ROUND = "p2^2/2 + q2^2/2"


def molecule_of(second, energy, size=1):
    """Of h1 + h2 with K = h1, in units of energy that are `size` times larger."""
    system = lp.System(lp.canonical(2), f"({WELL} + {second})*{size}")
    momentum = lp.tori.momentum_map(system, [f"({WELL})*{size}"])
    return lp.tori.molecule(lp.Leaf(system, {}), energy * size, momentum=momentum, n_starts=60)


def shape(found):
    """Names and values of the atoms, and how often two of them are joined, whatever the order of equal ones."""
    ends = [tuple((found.atoms[k].name, round(found.atoms[k].value, 6)) for k in pair) for pair in found.families]
    return sorted((atom.name, round(atom.value, 6)) for atom in found.atoms), sorted(ends)


def test_a_double_well_below_its_saddle_has_two_pieces():
    """K from -1/4 in either well to E, where the other oscillator rests."""
    low, high = ("A", -0.25), ("A", -0.1)
    assert shape(molecule_of(ROUND, -0.1)) == ([low, low, high, high], [(low, high)] * 2)


@pytest.mark.parametrize("size", [1, 1e6, 1e-6])
def test_above_its_saddle_two_tori_become_one(size):
    found = molecule_of(ROUND, 0.1, size)
    assert [atom.name for atom in found.atoms] == ["A", "A", "B", "A"]
    np.testing.assert_allclose([atom.value / size for atom in found.atoms], [-0.25, -0.25, 0, 0.1], atol=1e-12)
    assert sorted(map(tuple, found.families.tolist())) == [(0, 2), (1, 2), (2, 3)]


def test_small_circles_are_circles():
    """Beside the saddle the circle has the radius 0.004, less than a step along others."""
    found = molecule_of(ROUND, 1e-5)
    assert [atom.name for atom in found.atoms] == ["A", "A", "B", "A"]
    np.testing.assert_allclose([atom.value for atom in found.atoms], [-0.25, -0.25, 0, 1e-5], atol=1e-12)
    with pytest.raises(OrbitError, match="too small"):
        molecule_of(ROUND, 1e-8)


def test_two_double_wells_have_a_graph_with_circles():
    """E = -1/10: at K = E the second one is at its saddle, in either well of the first, at K = 0 the first one."""
    low, divide, join, high = ("A", -0.25), ("B", -0.1), ("B", 0.0), ("A", 0.15)
    found = molecule_of(OTHER, -0.1)
    atoms, families = shape(found)
    assert atoms == sorted([low, low, divide, divide, join, join, high, high])
    assert families == sorted([(low, divide)] * 2 + [(divide, join)] * 4 + [(join, high)] * 2)
    joins = [atom for atom in found.atoms if atom.value == pytest.approx(0, abs=1e-9)]
    assert all(len({found.families[f, 0] for f in atom.below}) == 2 for atom in joins)  # tori of both wells


def test_two_double_wells_above_both_saddles():
    low, join, divide, high = ("A", -0.25), ("B", 0.0), ("B", 0.1), ("A", 0.35)
    expected = sorted([(low, join)] * 2 + [(join, divide)] + [(divide, high)] * 2)
    assert shape(molecule_of(OTHER, 0.1))[1] == expected


@pytest.mark.slow
def test_the_order_of_starts_does_not_matter():
    system = lp.System(lp.canonical(2), f"{WELL} + {OTHER}")
    momentum = lp.tori.momentum_map(system, [WELL])
    one, other = (lp.tori.molecule(lp.Leaf(system, {}), 0.1, momentum=momentum, seed=seed) for seed in (1, 2))
    assert shape(one) == shape(other)


KOVALEVSKAYA = lp.catalog.system("kovalevskaya")
REGIONS = {
    (0.6, -0.5): ["A", "A"],
    (0.6, 0.6): ["A", "A", "B", "A"],
    (0.6, 1.05): ["A", "A", "B", "B", "A", "A"],
    (0.6, 1.3): ["A", "A", "A*", "A*", "2 circles", "A", "A"],
    (1.2, 1.5): ["A", "A", "A*", "A*", "B", "A"],
}
"""By l.alpha and H, in the order of K.  With l = (l.alpha)/2 the critical values are K = 0, (H - 2 l^2)^2, and
1 - 2 l^2/s + l^4/s^4 where H = s + l^2/s^2 (Kharlamov 1988)."""


def critical_values(constant, energy):
    squared = constant**2 / 4
    roots = np.roots([1, -energy, 0, squared])
    s = roots[np.abs(roots.imag) < 1e-12].real
    return np.array([0, (energy - 2 * squared) ** 2, *(1 - 2 * squared / s + squared**2 / s**4)])


@pytest.mark.slow
@pytest.mark.parametrize("place", REGIONS)
def test_the_kovalevskaya_top(place):
    constant, energy = place
    found = lp.tori.molecule(lp.Leaf(KOVALEVSKAYA, {"C1": constant, "C2": 1}), energy)
    assert [atom.name for atom in found.atoms] == REGIONS[place]
    known = critical_values(constant, energy)
    assert all(np.abs(known - atom.value).min() < 1e-9 for atom in found.atoms)
    for atom in found.atoms:
        if atom.name == "2 circles":
            assert len(atom.states) == len(atom.below) == len(atom.above) == 2
        if atom.name == "A*":
            assert len(atom.below) == len(atom.above) == 1


@pytest.mark.parametrize(("energy", "why"), [(-0.25, "an equilibrium"), (0, "an equilibrium"), (-1, "of this energy")])
def test_what_is_no_regular_level_is_refused(energy, why):
    with pytest.raises(OrbitError, match=why):
        molecule_of(ROUND, energy)


def test_a_level_that_is_not_compact_is_refused():
    """The cubic well lets go above 1/6."""
    free = "p1^2/2 + q1^2/2 - q1^3/3"
    system = lp.System(lp.canonical(2), f"{free} + {ROUND}")
    with pytest.raises(OrbitError, match=r"wanted a regular one of a compact level|wanted one on a torus"):
        lp.tori.molecule(lp.Leaf(system, {}), 0.3, momentum=lp.tori.momentum_map(system, [free]), n_starts=20)


def test_one_critical_value_is_no_graph():
    system = lp.System(lp.canonical(2), f"{WELL} + {ROUND}")
    with pytest.raises(OrbitError, match="one critical value"):
        lp.tori.molecule(
            lp.Leaf(system, {}), 0.1, momentum=lp.tori.momentum_map(system, [ROUND]), n_starts=50, spread=1e-300
        )


def test_three_integrals_are_refused():
    leaf = lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 0.5, "C2": 0.2, "C3": 1})
    with pytest.raises(ParameterError, match="two integrals"):
        lp.tori.molecule(leaf, 1)


def test_time_may_be_over():
    with pytest.raises(TimeLimitError):
        lp.tori.molecule(lp.Leaf(KOVALEVSKAYA, {"C1": 0.6, "C2": 1}), 1.3, time_limit=0.05)
