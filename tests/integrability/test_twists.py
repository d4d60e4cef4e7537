"""Which twists keep an integral: the answers of docs/twists.md, for all cubics and rotors at once, and beyond."""

from functools import partial
from itertools import combinations

import pytest
from sympy import Symbol, sympify

import liepoisson as lp

cubic = lp.extensions.binary_cubic
families = lp.integrability.integrable_families
KINETIC = {
    "Kovalevskaya": "l1^2/4 + l2^2/4 + l3^2/2",
    "spherical": "dot(l, l)/2",
    "Chaplygin": "(l1^2 + l2^2)/8 + l3^2/2",
}
ROTORS = ("k1", "k2", "k3")
ROTOR = " + k1*l1 + k2*l2 + k3*l3"


def top(extension, inertia, potential, symbols=()):
    return lp.System(lp.so(3) @ extension, KINETIC[inertia] + potential, symbols=symbols)


def cases(found):
    assert found.complete
    return [{str(c) for c in case.conditions} for case in found.cases]


def test_two_centres_keep_a_quartic_on_one_kind_of_cubic():
    """Without rotors: (aX + bY)(X^2 + Y^2) is the condition, and both integrals are found again there."""
    found = families(top(cubic(), "Kovalevskaya", " + alpha1 + beta2"), degree=4)
    assert cases(found) == [{"a - c", "b - d"}]
    assert len(found.cases[0].integrals) == 2


@pytest.mark.thorough
def test_a_changed_coefficient_of_the_cubic_ends_it():
    for form in ((0, 1, 0, 1), (2, -1, 2, -1)):
        assert lp.integrability.first_integrals(top(cubic(*form), "Kovalevskaya", " + alpha1 + beta2"), degree=4).found
    for form in ((0, 1, 0, 2), (0, 1, 0, -1), (1, 0, 0, 0)):
        found = lp.integrability.first_integrals(top(cubic(*form), "Kovalevskaya", " + alpha1 + beta2"), degree=4)
        assert found.complete
        assert not found.found


SETTLED = {
    "two centres, b off the equator": (cubic(), " + alpha1 + b2*beta2 + beta3" + ROTOR, ("b2", *ROTORS), []),
    "two centres, rotors": (cubic(), " + alpha1 + beta2" + ROTOR, ROTORS, [{"k1", "k2", "a - c", "b - d"}]),
    "one centre that generates A": (cubic(1, "b", "c", "d"), " + alpha1" + ROTOR, ROTORS, []),
    "one centre off the equator": (
        cubic(1, "b", "c", "d"), " + p*alpha1 + alpha3" + ROTOR, ("p", *ROTORS), [{"p", "k1", "k2"}],
    ),
    "one centre, inert beta": (cubic(0, "b", "c", "d"), " + alpha1" + ROTOR, ROTORS, [{"k2", "b + 2*k1"}]),
}  # fmt: skip


# Those of more than 2 s are on the page of twists, which the quick tests run.
LONG = {"two centres, b off the equator", "two centres, rotors", "one centre off the equator"}


@pytest.mark.thorough
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in LONG else n for n in SETTLED])
def test_kovalevskayas_inertia_for_every_cubic_and_rotor(name):
    extension, potential, symbols, wanted = SETTLED[name]
    found = families(top(extension, "Kovalevskaya", potential, symbols), degree=4)
    assert cases(found) == wanted


@pytest.mark.slow  # on the page of twists, too
def test_the_spherical_top_with_two_centres_keeps_its_integrals_on_no_twist():
    system = top(cubic(), "spherical", " + alpha1 + b2*beta2" + ROTOR, ("b2", *ROTORS))
    assert cases(families(system, degree=4, nonzero=["b2"])) == [{*"abcd", *ROTORS}]


def one_field(kappa):
    return lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: kappa}})


@pytest.mark.thorough
def test_in_one_field_kovalevskayas_quartic_stays_and_chaplygins_cubic_does_not():
    """so(4) and so(3, 1); the level l.alpha = 0 reduces a Casimir to zero, which ended in an error once."""
    make = partial(top, one_field("kappa"), symbols=ROTORS)
    assert cases(families(make("Kovalevskaya", " + alpha1" + ROTOR), degree=4)) == [{"k1", "k2"}]
    on = ["dot(l, alpha) = 0"]
    assert cases(families(make("Chaplygin", " + alpha1" + ROTOR), degree=3, on=on)) == [{"k1", "k2", "kappa"}]


@pytest.mark.slow
def test_in_one_field_every_inertia_and_centre_is_decided():
    """On so(4) and so(3, 1), degree 4: spherical, free, Lagrange's and Kovalevskaya's tops, about all three axes."""
    energy = "l1^2/(2*I1) + l2^2/(2*I2) + l3^2/2 + a1*alpha1 + a2*alpha2 + a3*alpha3"
    system = lp.System(lp.so(3) @ one_field("kappa"), energy, symbols=["I1", "I2", "a1", "a2", "a3"])
    found = cases(families(system, degree=4, positive=["I1", "I2"], nonzero=["kappa"]))
    spherical, free = {"I1 - 1", "I2 - 1"}, {"a1", "a2", "a3"}
    lagrange = [{"a2", "a3", "I2 - 1"}, {"a1", "a3", "I1 - 1"}, {"a1", "a2", "I1 - I2"}]
    kovalevskaya = [{"a3", "I1 - 2", "I2 - 2"}, {"a1", "2*I1 - 1", "I2 - 1"}, {"a2", "I1 - 1", "2*I2 - 1"}]
    assert sorted(map(sorted, found)) == sorted(map(sorted, [spherical, free, *lagrange, *kovalevskaya]))


@pytest.mark.thorough
@pytest.mark.parametrize("form", [(-1, 0, 0, 0), (0, 1, 0, 0), (0, 1, -1, 0), (0, 1, 0, 1)])
def test_goryachev_and_chaplygins_top_has_no_cubic_on_any_level_of_casimirs(form):
    """With two centres, and with one that generates the algebra; of the five orbits one cubic each."""
    for b in ((0, 1, 0), (2, 0, 0)):
        system = lp.catalog.cubic_top(form, (4, 4, 1), (1, 0, 0), b)
        casimirs = [f"{c} = 0".replace("**", "^") for c in system.bracket.casimirs()]
        for n in range(4):
            for on in combinations(casimirs, n):
                found = lp.integrability.first_integrals(system, degree=3, on=on)
                assert found.complete
                assert not found.independent


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "wanted"), [(1, []), (2, [{"q2"}]), (3, [{"q2"}]), (4, [{"q2"}, {"p2", "q2 - 1"}, {"p2", "q2 + 1"}])]
)
def test_three_fields(number, wanted):
    """Two centres on the equator, of elements p, q of the maximal ideal: p = (1, p2, p3), q = (0, q2, q3) by a turn.

    q2 = 0 are centres that are parallel modulo the squares of the ideal; the others are (x + iy)^2 = 0.
    """
    form = lp.extensions.normal_forms(4)[number - 1].rename("l", "alpha", "beta", "gamma")
    potential, symbols = " + alpha1 + p2*beta1 + p3*gamma1 + q2*beta2 + q3*gamma2", ("p2", "p3", "q2", "q3")
    found = cases(families(top(form, "Kovalevskaya", potential, symbols), degree=4))
    assert sorted(map(sorted, found)) == sorted(map(sorted, wanted))


def test_associativity_leaves_the_four_coefficients_of_a_cubic():
    """With e1 e2 = q a number: e1 (e1 e2) = (e1 e1) e2 and e2 (e1 e2) = (e2 e2) e1 give all other coefficients."""
    p0, p1, p2, q, r0, r1, r2 = map(Symbol, ("p0", "p1", "p2", "q", "r0", "r1", "r2"))
    products = {(0, k): {k: 1} for k in range(3)}
    products |= {(1, 1): {0: p0, 1: p1, 2: p2}, (1, 2): {0: q}, (2, 2): {0: r0, 1: r1, 2: r2}}
    solved = {p0: -p2 * r2, q: p2 * r1, r0: -p1 * r1}
    # the residuals (e1 e1) e2 - e1 (e1 e2) and (e2 e2) e1 - e2 (e1 e2), by coordinates
    residuals = [p1 * q + p2 * r0, p2 * r1 - q, p0 + p2 * r2, r1 * p0 + r2 * q, r0 + r1 * p1, r1 * p2 - q]
    assert all(f.subs(solved).expand() == 0 for f in residuals)
    named = cubic(-p2, p1, -r2, r1).products
    assert all(
        (named[pair][k] - sympify(v).subs(solved)).expand() == 0 for pair in products for k, v in products[pair].items()
    )
