"""Maximal orders of poles: as by trying all, and what follows linearly has no order of its own."""

from fractions import Fraction
from itertools import product

import pytest

import liepoisson as lp
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import Deadline
from liepoisson.integrability.derivation import derivation_of_rates
from liepoisson.integrability.painleve.quasi_homogeneous import excess, inequalities, maximal_weights

X, Y, Z = lp.systems.CanonicalSystem(["x", "y", "z"], ["p", "q", "r"], "p^2").variables[:3]


def derivation(*rates):
    return derivation_of_rates((X, Y, Z)[: len(rates)], rates)[0]


def by_trying(field, most):
    """All maximal whole weights up to a bound."""
    rows, n = inequalities(field), len(field.variables)
    fit = [w for w in product(range(most + 1), repeat=n) if excess(rows, list(map(Fraction, w))) <= 1]
    return {w for w in fit if not any(v != w and all(a >= b for a, b in zip(v, w, strict=True)) for v in fit)}


@pytest.mark.parametrize(
    ("rates", "expected"),
    [
        ((Y * Z, X * Z, X * Y), {(1, 1, 1)}),  # Euler's top
        ((Y, 6 * X**2), {(2, 3)}),  # Weierstrass' function
        ((Y, X**3), {(1, 2)}),
        ((X**2, X * Y), {(1, 1)}),  # y follows linearly
        ((X**2 * Y, X * Y**2), {(0, 1), (1, 0)}),
        ((X * Y**2, Y * X**2), {(Fraction(1, 2), Fraction(1, 2))}),  # x^2 has a pole of order one
    ],
)
def test_weights_of_small_systems(rates, expected):
    assert set(maximal_weights(derivation(*rates))) == expected


def test_weights_are_those_that_trying_all_of_them_finds():
    for rates in (
        (Y * Z, X * Z, X * Y),
        (Y, 6 * X**2, X - Z**2),
        (X**2 * Y, X * Y**2, X + Z**2),
        (Y + X**2, Z + X * Y, X * Z),
    ):
        field = derivation(*rates)
        assert set(maximal_weights(field)) == by_trying(field, 6), rates


def test_weights_of_tops():
    def weights(name):
        system = lp.catalog.system(name)
        rates = list(system.equations.values())
        return maximal_weights(derivation_of_rates(system.variables, rates)[0])

    assert weights("lagrange") == ((1, 1, 1, 2, 2, 2),)
    assert weights("twisted-lagrange") == ((1, 1, 1, 2, 2, 2, 3, 3, 3),)
    assert weights("twisted-top") == ((1, 1, 1, 2, 2, 2, 2, 2, 2),)


def test_the_search_for_weights_ends_with_the_deadline():
    given = derivation(X**3 + Y, Y**2 * X)
    with Deadline(1e-9).running(), pytest.raises(TimeLimitError, match="the weights"):
        maximal_weights(given)
