"""A claim on a set is refuted by a real point only: by none of a set that has none, or on which the claim holds."""

import pytest
import sympy as sp

from liepoisson.report.counterexamples import is_nonzero_on, is_nonzero_somewhere

x, y, z = variables = sp.symbols("x y z")


@pytest.mark.parametrize(
    ("function", "zero", "expected"),
    [
        (y, x, True),
        (y, x**2 + y**2, False),  # the real points are x = y = 0
        (z, x**2 + y**2, True),
        (y, x**2 + 1, False),  # no real points
        (y, x * y, True),  # where x = 0
        (x * (x**2 + y**2), x**3 + x * y**2, False),
        (x - y, x**3 - y**3, False),  # x^2 + x y + y^2 = 0 at the origin only
        (y, sp.sqrt(2) * x - 1, True),
        (y, sp.exp(x) - 2, True),
        (y, sp.exp(x) + 2, False),
        (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, sp.exp(y) - 2, False),
        (y, 1 / x, False),  # changes its sign at a pole
        (y, sp.Symbol("c") * x, True),
    ],
)
def test_refuted_by_a_real_point_of_the_set(function, zero, expected):
    assert is_nonzero_on(function, zero, variables) is expected


@pytest.mark.parametrize(
    ("function", "expected"),
    [(x**2 * y, True), (1 / x, True), (sp.sqrt(x), True), (sp.sqrt(x**2) - sp.Abs(x), False), (x - x, False)],
)
def test_refuted_by_any_real_point(function, expected):
    assert is_nonzero_somewhere(function, variables) is expected
