from fractions import Fraction

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon

exactly = settings(deadline=None, max_examples=40, derandomize=True)

s = sp.Symbol("s")
small = st.integers(-3, 3)


@exactly
@given(st.lists(st.lists(small, min_size=5, max_size=5), min_size=1, max_size=6))
def test_the_echelon_form_is_that_of_sympy(rows):
    echelon = Echelon(Coefficients())
    grown = [echelon.insert({k: Fraction(v) for k, v in enumerate(row) if v}) for row in rows]
    reduced, pivots = sp.Matrix(rows).rref()
    assert sorted(echelon.rows) == list(pivots)
    assert sum(grown) == len(echelon) == len(pivots)
    for r, row in enumerate(echelon.basis()):
        assert [row.get(k, 0) for k in range(5)] == [Fraction(str(v)) for v in reduced.row(r)]
    kernel = echelon.null_space(5)
    assert len(kernel) == 5 - len(pivots)
    for vector in kernel:
        assert not any(sum(v * row[k] for k, v in vector.items()) for row in rows)


def test_a_symbolic_echelon_form_is_generic():
    field = Coefficients.containing([s])
    x, one = field.read(s), field.one
    echelon = Echelon(field)
    assert echelon.insert({0: one, 1: x})
    assert echelon.insert({0: x, 1: one})
    assert not echelon.insert({1: x})


def test_hidden_relations_make_vectors_dependent():
    # (sin, cos) and (sin cos, 1 - sin^2) are parallel.
    field = Coefficients.containing([sp.sin(s), sp.cos(s)])
    sine, cosine = field.read(sp.sin(s)), field.read(sp.cos(s))
    echelon = Echelon(field)
    assert echelon.insert({0: sine, 1: cosine})
    assert not echelon.insert({0: sine * cosine, 1: field.one - sine * sine})
    assert echelon.insert({0: sine * cosine, 1: field.one})
