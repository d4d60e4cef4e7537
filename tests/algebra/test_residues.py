import pickle
from itertools import islice

import pytest
import sympy as sp
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.number_fields import PrimeField
from liepoisson.algebra.residues import Lift, Residues, primes

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


@given(st.fractions(max_denominator=10**25), st.integers(0, 2**61 - 2))
def test_numbers_are_lifted_from_their_residues(number, residue):
    lift = Lift()
    for p in islice(primes(), 6):
        lift.add({(1,): int(PrimeField(p).number(number))}, p)
    if abs(number.numerator) < 10**50:
        assert lift.lifted() == ({(1,): fmpq(number.numerator, number.denominator)} if number else {})
    # of other residues there is a number within the bound, or none
    one = Lift()
    one.add({(1,): residue}, 2**61 - 1)
    found = one.lifted()
    if residue and found is not None:
        c = found[(1,)]
        assert 2 * max(abs(int(c.p)), int(c.q)) ** 2 <= 2**61 - 1
        assert (int(c.p) - residue * int(c.q)) % (2**61 - 1) == 0


def test_where_there_are_none():
    """At a pole, and where SymPy only simplifies."""
    field = Coefficients.containing([1 / (e - 5)])
    with pytest.raises(ZeroDivisionError):
        Residues(field.residues(1).p, values=(5,))(field.read(1 / (e - 5)))
    assert Coefficients.containing([sp.sqrt(e) + sp.log(e + sp.sqrt(2))]).residues(1) is None
    residues = Coefficients.containing([e]).residues(1)
    assert pickle.loads(pickle.dumps(residues)) == residues
