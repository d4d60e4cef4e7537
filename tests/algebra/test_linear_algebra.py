from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.algebra import linear_algebra
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank, rank_mod, solve
from liepoisson.algebra.residues import PRIME

exactly = settings(deadline=None, max_examples=40, derandomize=True)
RATIONALS = Coefficients()

# Entries with up to 20 digits: null vectors that need more than one 61-bit prime.
entry = st.one_of(st.just(0), st.integers(-3, 3), st.fractions(-(10**20), 10**20, max_denominator=10**9))
matrices = st.integers(1, 5).flatmap(
    lambda n: st.lists(st.lists(entry, min_size=n, max_size=n), min_size=1, max_size=6)
)


def sparse(matrix):
    return [{c: Fraction(v) for c, v in enumerate(row) if v} for row in matrix]


@pytest.mark.thorough
@exactly
@given(matrices)
def test_null_spaces_are_those_of_sympy(matrix):
    n, dense = len(matrix[0]), sp.Matrix([[sp.Rational(str(Fraction(v))) for v in row] for row in matrix])
    vectors = nullspace(sparse(matrix), n, RATIONALS).vectors
    assert len(vectors) == n - dense.rank() == n - rank(sparse(matrix), RATIONALS)
    for vector in vectors:
        column = sp.Matrix([sp.Rational(str(vector.get(c, 0))) for c in range(n)])
        assert (dense * column).is_zero_matrix


@pytest.mark.thorough
@exactly
@given(matrices)
def test_a_rank_modulo_a_prime_is_a_lower_bound(matrix):
    rows = [{c: int(v * 10**9) for c, v in row.items()} for row in sparse(matrix)]
    exact = len(Echelon(RATIONALS, [{c: Fraction(v) for c, v in row.items() if v} for row in rows]))
    assert rank_mod(rows, len(matrix[0]), 3) <= exact
    assert rank_mod(rows, len(matrix[0])) <= exact


def test_an_unlucky_prime_is_found_out():
    # Modulo PRIME the row vanishes; over Q its null space is (-1, PRIME) up to scale.
    rows = [{0: Fraction(PRIME), 1: Fraction(1)}, {0: Fraction(PRIME)}]
    assert len(nullspace_mod([{0: PRIME, 1: 1}, {0: PRIME}], 2, PRIME)) == 1
    assert nullspace(rows, 2, RATIONALS).dimension == 0


def test_pivots_name_what_was_divided_by():
    # (e - 1) x + y = 0, e y = 0: the null space is larger at e = 1 (then y = 0 alone) and at e = 0.
    e = sp.Symbol("e")
    field = Coefficients.containing([e])
    found = nullspace([{0: field.read(e - 1), 1: field.one}, {1: field.read(e)}], 2, field)
    assert found.dimension == 0
    assert {field.to_sympy(pivot) for pivot in found.pivots} == {e, e - 1}


@pytest.mark.parametrize(("target", "expected"), [({0: 1, 1: 2}, [Fraction(1, 2), Fraction(2)]), ({2: 1}, None)])
def test_solving(target, expected):
    columns = [{0: Fraction(2)}, {1: Fraction(1)}]
    assert solve(columns, {k: Fraction(v) for k, v in target.items()}, RATIONALS) == expected


PRIMES = st.sampled_from([3, 101, 2**31 - 1, PRIME, 2**62 - 57])
wide = st.integers(10, 30).flatmap(
    lambda n: st.lists(
        st.dictionaries(st.integers(0, n - 1), st.integers(-(10**20), 10**20), max_size=5), max_size=40
    ).map(lambda rows: (n, rows))
)


@exactly
@given(wide, PRIMES)
def test_the_core_gives_the_null_space_of_flint(matrix, p):
    n, rows = matrix
    reduced = linear_algebra._reduced_mod(rows, p)
    found = linear_algebra._nullspace_of_flint(reduced, n, p)
    assert nullspace_mod(rows, n, p) == found
    if linear_algebra._has_core():
        assert linear_algebra._nullspace_of_core(reduced, n, p) == found


@pytest.mark.skipif(not linear_algebra._has_core(), reason="needs the compiled core")
def test_large_matrices_are_left_to_the_core(monkeypatch):
    monkeypatch.delattr(linear_algebra, "_nullspace_of_flint")
    found = nullspace_mod([{k: 1, k + 1: -2} for k in range(59)], 60, PRIME)
    assert found == [{k: pow(2, 59 - k, PRIME) for k in range(60)}]
