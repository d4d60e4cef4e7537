from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.structure.poisson.exceptional_parameters import special_values

a, b = sp.symbols("a b")
PLANE, LINE = Coefficients.containing([a, b]), Coefficients.containing([a])
ROOT = sp.sqrt(2)


@pytest.mark.parametrize(
    ("pivots", "field", "expected", "undecided"),
    [
        # roots of numerators and denominators, in order
        (
            [(a**3 - a) / (a**2 - 2)],
            LINE,
            [{"a": v} for v in (-ROOT, Fraction(-1), Fraction(0), Fraction(1), ROOT)],
            (),
        ),
        *(([pivot], LINE, [], ()) for pivot in (sp.Integer(5), a**2 + 1, 1 / (a**4 + a**2 + 1))),
        ([a * b, a**2, b / a, a**3 * b], PLANE, [{"a": Fraction(0)}, {"b": Fraction(0)}], ()),
        ([(a - 1) * (a * b + 3)], PLANE, [{"a": Fraction(1)}, {"a": -3 / b}], ()),
        ([a**2 + b**2 - 1, b - 2], PLANE, [{"b": Fraction(2)}], ("a**2 + b**2 - 1 = 0",)),
    ],
)
def test_special_values(pivots, field, expected, undecided):
    found = special_values([field.read(sp.sympify(pivot)) for pivot in pivots], field)
    assert ([inserted for _, inserted in found[0]], found[1]) == (expected, undecided)


def test_the_condition_is_the_text_of_its_values():
    assert special_values([PLANE.read(a + b)], PLANE)[0] == [("a = -b", {"a": -b})]
