import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.residues import Residues

e = sp.Symbol("e")


@pytest.mark.parametrize(
    ("values", "relation"),
    [
        ([sp.Rational(2, 3)], lambda a: 3 * a - 2),
        ([sp.sqrt(2)], lambda a: a * a - 2),
        ([sp.cbrt(2)], lambda a: a**3 - 2),
        ([e, 1 / (e + 1)], lambda a, b: b * (a + 1) - 1),
        ([e, sp.sqrt(2) * e], lambda a, b: b * b - 2 * a * a),
        # cos(2 pi/7) = 1 - 2 sin^2(pi/7); without the common factor 1/pi
        ([sp.sin(sp.pi / 7) / sp.pi, sp.cos(2 * sp.pi / 7) / sp.pi], lambda s, c: c - 1 + 2 * s * s),
    ],
)
def test_residues_keep_relations(values, relation):
    field = Coefficients.containing(values)
    residues = field.residues(1)
    images = [residues(field.read(value)) for value in values]
    assert relation(*images) % residues.p == 0
    assert (relation(*images) + 1) % residues.p != 0


def test_residues_are_refused_where_a_denominator_vanishes():
    field = Coefficients.containing([1 / (e - 5)])
    pole = Residues(field.residues(1).p, values=(5,))
    with pytest.raises(ZeroDivisionError):
        pole(field.read(1 / (e - 5)))


def test_there_are_none_where_sympy_only_simplifies():
    assert Coefficients.containing([sp.sqrt(e) + sp.log(e + sp.sqrt(2))]).residues(1) is None
