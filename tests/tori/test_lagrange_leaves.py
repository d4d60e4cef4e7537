"""Classes of leaves of the twisted Lagrange top against roots in doubles, and their symmetries."""

from fractions import Fraction

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError
from liepoisson.tori.lagrange_leaves import class_of

TOP = lp.Top.twisted_lagrange()
SAMPLES = {
    "AA": (-5, 0), "AU": (0, 2), "UU-": (0, "1/5"), "UU+": (8, 1), "BU": ("17.518906228330376", "3.316771360997471"),
    "AB": (35, 5),
}  # fmt: skip
HOPF = {"AA": 0, "AU": 1, "UU-": 2, "UU+": 2, "BU": 3, "AB": 2}


def by_roots(c1, c2):
    """The class, and the number of Hamiltonian Hopf points, of a leaf with c3 = 1."""
    letters = ""
    for sign in (1, -1):
        roots = np.roots([1, (c1 - c2**2) / 2, sign * c2, 1])
        real = roots.real[np.abs(roots.imag) < 1e-9 * np.abs(roots)]
        letters += "U" if len(real) == 1 else "B" if len(set(np.sign(real))) == 1 else "A"
    mu = np.roots([1, 0, 0, 0, -c1, -8 * c2, -10])
    mu = mu.real[np.abs(mu.imag) < 1e-9 * np.abs(mu)]
    name = "".join(sorted(letters))
    side = ("+" if c1 > 3 + 4 * c2**2 / 3 else "-") if name == "UU" else ""
    return name + side, int(((c2 * mu + 2) ** 2 <= mu**6).sum())


@pytest.mark.parametrize("n", [2000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_the_class_is_that_of_the_roots(n):
    draw = np.random.default_rng(n)
    for _ in range(n):
        c3 = Fraction(int(draw.integers(1, 60)), int(draw.integers(1, 20)))
        unit = float(c3) ** (1 / 6)
        c1 = Fraction(float(draw.normal() * 8 * unit**4)).limit_denominator(50)
        c2 = Fraction(float(draw.normal() * 3 * unit**5)).limit_denominator(50)
        try:
            name = class_of(c1, c2, c3)
        except LeafError:  # a wall
            continue
        assert (name, HOPF[name]) == by_roots(float(c1) / unit**4, float(c2) / unit**5), (c1, c2, c3)


def leaf(c1, c2, top=TOP, c3=1):
    return lp.Leaf(top, {"C1": c1, "C2": c2, "C3": c3})


@pytest.mark.parametrize("name", SAMPLES)
def test_samples_of_the_six_classes(name):
    c1, c2 = SAMPLES[name]
    assert lp.tori.leaf_class(leaf(c1, c2)) == name
    assert lp.tori.leaf_class(leaf(c1, -Fraction(c2))) == name


@pytest.mark.parametrize("name", SAMPLES)
def test_units_and_a_charge_change_no_class(name):
    """s = a3 I1 and u = epsilon s^2; alpha -> alpha + (b3/a3) beta takes a charged top to one that is not."""
    c1, c2 = map(Fraction, SAMPLES[name])
    s, epsilon, ratio = Fraction(3), Fraction(5, 7), Fraction(-2, 3)
    u = epsilon * s**2
    one, two, three = c1 / s**2, c2 / (s * u), 1 / u**2
    scaled = lp.Top.twisted(inertia=(2, 2, 1), a=(0, 0, "3/2"), b=(0, 0, 0), epsilon=epsilon)
    assert lp.tori.leaf_class(leaf(one, two, scaled, three)) == name
    charged = lp.Top.twisted(inertia=(2, 2, 1), a=(0, 0, "3/2"), b=(0, 0, -1), epsilon=epsilon)
    assert (
        lp.tori.leaf_class(leaf(one - 2 * ratio * two + ratio**2 * three, two - ratio * three, charged, three)) == name
    )


def test_walls_are_refused():
    with pytest.raises(LeafError, match="on the wall C1 = 3"):
        lp.tori.leaf_class(leaf(3, 0))
    with pytest.raises(LeafError, match="changes its stability"):
        lp.tori.leaf_class(leaf(15, 3))
    with pytest.raises(LeafError, match="beta"):
        lp.tori.leaf_class(lp.Leaf.through(TOP, [0, 0, 1, 0, 0, 1, 0, 0, 0]))


@pytest.mark.parametrize("top", [lp.Top.twisted_kovalevskaya(), lp.Top.lagrange()])
def test_other_tops_are_refused(top):
    with pytest.raises((ParameterError, LeafError), match=r"system: wanted|leaf: wanted"):
        lp.tori.leaf_class(lp.Leaf.through(top, [0.1, 0.2, 1, 0, 0.1, 1, 0, 0, 1]))


@pytest.mark.parametrize("rest", ["5", "1/4 - dot(beta, beta)^2 - 3*dot(alpha, beta)"])
def test_constants_and_casimirs_in_the_energy_move_its_values_only(rest):
    """Values are those of the states, and the quadrature's periods close the flows: an integer change of basis."""
    bracket = lp.so(3) @ lp.leibniz(3, "epsilon")
    energy = "dot(l, inv(I)*l)/2 + a*alpha3"
    top, other = (
        lp.System(bracket, formula, {"I": [2, 2, 1], "a": 1, "epsilon": 1})
        for formula in (energy, f"{energy} + {rest}")
    )
    x = [0.3, 0.1, 1.2, 0.5, 0.2, 0.4, 0.1, 0.3, 0.9]
    plain, moved = (lp.tori.lagrange_diagram(lp.Leaf.through(system, x)) for system in (top, other))
    shift = float(other.functions.energy(x)) - float(top.functions.energy(x))
    for one, two in zip(plain.curves, moved.curves, strict=True):
        np.testing.assert_allclose(two.values, one.values + np.array([shift, 0, 0]), rtol=1e-12)
        np.testing.assert_allclose(moved.momentum(two.states), two.values, rtol=1e-9, atol=1e-9)
    lattices = [lp.tori.lagrange_lattice(one, one.momentum(x)) for one in (plain, moved)]
    np.testing.assert_allclose(*lattices, rtol=1e-10)
