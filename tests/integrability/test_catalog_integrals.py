"""Every integral that an entry of the catalog states is found again; searches are told H and the Casimirs only."""

from random import Random

import pytest
import sympy as sp
from searched_systems import is_polynomial_in, random_points

import liepoisson as lp

first_integrals = lp.integrability.first_integrals

DEGREES = {
    "charged-lagrange": 2, "charged-twisted-lagrange": 2, "chaplygin": 4, "clebsch": 2, "compressible-reduced-mhd": 2,
    "goryachev": 4, "goryachev-chaplygin": 3, "goryachev-chaplygin-gyrostat": 3, "henon-heiles-kaup-kupershmidt": 6,
    "henon-heiles-kdv": 4, "henon-heiles-sawada-kotera": 3, "kepler-on-the-sphere": 2, "kirchhoff": 1,
    "kovalevskaya": 4, "kovalevskaya-gyrostat": 4, "kovalevskaya-so4": 4, "lagrange": 1, "leibniz-lagrange-4": 2,
    "leibniz-lagrange-5": 2, "lyapunov": 2, "manakov-so4": 2, "neumann": 2, "poincare-ellipsoidal-cavity": 1,
    "so21-heavy-top": 1, "so21-twisted-top": 2, "spherical-pendulum": 1, "steklov": 2, "three-wave": 2, "toda": 3,
    "twisted-lagrange": 2, "three-field-kovalevskaya": 4, "twisted-two-field-kovalevskaya": 4,
    "two-field-kovalevskaya": 4, "two-field-spherical": 4, "volterra-lattice-5": 2,
}  # fmt: skip
"""The degree to which is searched, the largest of the integrals that are stated."""


QUICK = ("clebsch", "toda", "kepler-on-the-sphere", "goryachev-chaplygin")
"""Entries of several kinds, which the quick tests have."""

NAMES = lp.catalog.names()


def names_with_integrals():
    return {name for name in NAMES if (here := lp.catalog.system(name)).integrals or here.partial_integrals}


def points(system, zero):
    """Random points at which all functions of the system are rational, on the level where a function vanishes."""
    random = Random(5)
    for point in random_points(system):
        if system.name.startswith("Toda") or system.name == "toda":
            # exponentials of differences of logarithms are rational
            point |= {q: sp.log(random.randint(1, 30)) for q in system.variables if str(q).startswith("q")}
        elif system.name == "kepler-on-the-sphere":
            m, n = random.randint(1, 9), random.randint(10, 19)
            _, _, _, first, second, _ = system.variables
            point |= {first: 2 * m * n, second: n * n - m * m}
        elif system.name == "goryachev":
            point[system.variables[5]] = sp.Integer(random.randint(1, 9))
        if zero is None:
            yield point
            continue
        last = system.variables[2]  # l3 or m3, in which the level l.alpha = 0 is linear
        slope = zero.diff(last).subs(point)
        if slope != 0:
            yield point | {last: point[last] - zero.subs(point) / slope}


def check(system, degree):
    """Each stated integral is an integral, and a polynomial in those that are found and known."""
    stated = [(f, None) for f in system.integrals.values()] + list(system.partial_integrals.values())
    for zero in dict.fromkeys(on for _, on in stated):
        found = first_integrals(system, degree=degree, on=() if zero is None else (zero,))
        assert set(found.known) == {"H", *(f"C{k + 1}" for k in range(len(system.bracket.casimirs())))}
        assert found.complete
        if zero is None:
            assert all(system.is_constant(f.expression) for f in found.found)
        generators = [*found.known.values(), *(f.expression for f in found.found)]
        # H of a system with other functions has no degree as a polynomial in the coordinates: it is two in all of these
        known = [
            sp.Poly(g, *system.variables).total_degree() if g.is_polynomial(*system.variables) else 2
            for g in generators
        ]
        degrees = [*known[: len(found.known)], *(f.degree for f in found.found)]
        for integral, on in stated:
            if on == zero:
                assert is_polynomial_in(
                    integral, generators, system, degree=degree, degrees=degrees, points=points(system, zero)
                )
                without = [g for g in generators if g in found.known.values()]
                assert not is_polynomial_in(
                    integral,
                    without,
                    system,
                    degree=degree,
                    degrees=degrees[: len(without)],
                    points=points(system, zero),
                ), "nothing to find"


def test_every_entry_with_integrals_is_searched():
    assert set(DEGREES) == names_with_integrals()


@pytest.mark.slow
@pytest.mark.parametrize("name", DEGREES)
def test_the_integrals_of_every_entry_are_found_again(name):
    check(lp.catalog.system(name), DEGREES[name])


@pytest.mark.parametrize("name", QUICK)
def test_integrals_are_found_again(name):
    check(lp.catalog.system(name), DEGREES[name])
