import time
from fractions import Fraction
from itertools import islice
from math import lcm
from random import Random

import pytest
import sympy as sp
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.algebra import linear_algebra
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank, rank_mod
from liepoisson.algebra.number_fields import PrimeField
from liepoisson.algebra.residues import PRIME, Lift, primes
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.deadline import Deadline

exactly = settings(deadline=None, max_examples=40, derandomize=True)
RATIONALS = Coefficients()

# Entries with up to 20 digits: null vectors that need more than one 61-bit prime.
entry = st.one_of(st.just(0), st.integers(-3, 3), st.fractions(-(10**20), 10**20, max_denominator=10**9))
matrices = st.integers(1, 5).flatmap(
    lambda n: st.lists(st.lists(entry, min_size=n, max_size=n), min_size=1, max_size=6)
)


def sparse(matrix):
    return [{c: Fraction(v) for c, v in enumerate(row) if v} for row in matrix]


@exactly
@given(matrices)
def test_null_spaces_are_those_of_sympy_and_ranks_modulo_primes_are_lower_bounds(matrix):
    n, dense = len(matrix[0]), sp.Matrix([[sp.Rational(str(Fraction(v))) for v in row] for row in matrix])
    vectors, exact = nullspace(sparse(matrix), n, RATIONALS).vectors, dense.rank()
    assert len(vectors) == n - exact == n - rank(sparse(matrix), RATIONALS)
    for vector in vectors:
        column = sp.Matrix([sp.Rational(str(vector.get(c, 0))) for c in range(n)])
        assert (dense * column).is_zero_matrix
    whole = [
        {c: int(v * lcm(*(w.denominator for w in row.values()))) for c, v in row.items()} for row in sparse(matrix)
    ]
    assert rank_mod(whole, n, 3) <= rank_mod(whole, n) == exact


def test_an_unlucky_prime_is_found_out():
    # Modulo PRIME the row vanishes; over Q its null space is (-1, PRIME) up to scale.
    rows = [{0: Fraction(PRIME), 1: Fraction(1)}, {0: Fraction(PRIME)}]
    assert len(nullspace_mod([{0: PRIME, 1: 1}, {0: PRIME}], 2, PRIME)) == 1
    assert nullspace(rows, 2, RATIONALS).dimension == 0


@pytest.mark.thorough
def test_the_compiled_elimination_keeps_the_time_limit():
    """Without a limit this one takes seconds; a rank that is cut short is never returned."""
    random, n = Random(1), 2000
    rows = [{random.randrange(n): random.randrange(1, 9) for _ in range(6)} for _ in range(n)]
    began = time.process_time()
    with Deadline(0.1).running(), pytest.raises(TimeLimitError, match="an elimination was under way"):
        rank_mod(rows, n)
    assert time.process_time() - began < 1


def test_pivots_name_what_was_divided_by():
    # (e - 1) x + y = 0, e y = 0: the null space is larger at e = 1 (then y = 0 alone) and at e = 0.
    e = sp.Symbol("e")
    field = Coefficients.containing([e])
    found = nullspace([{0: field.read(e - 1), 1: field.one}, {1: field.read(e)}], 2, field)
    assert found.dimension == 0
    assert {field.to_sympy(pivot) for pivot in found.pivots} == {e, e - 1}


def test_hidden_relations_make_vectors_dependent():
    """(sin, cos) and (sin cos, 1 - sin^2) are parallel."""
    s = sp.Symbol("s")
    field = Coefficients.containing([sp.sin(s), sp.cos(s)])
    sine, cosine = field.read(sp.sin(s)), field.read(sp.cos(s))
    echelon = Echelon(field)
    assert echelon.insert({0: sine, 1: cosine})
    assert not echelon.insert({0: sine * cosine, 1: field.one - sine * sine})
    assert echelon.insert({0: sine * cosine, 1: field.one})


any_prime = st.sampled_from([3, 101, 2**31 - 1, PRIME, 2**62 - 57])
wide = st.integers(10, 30).flatmap(
    lambda n: st.lists(
        st.dictionaries(st.integers(0, n - 1), st.integers(-(10**20), 10**20), max_size=5), max_size=40
    ).map(lambda rows: (n, rows))
)


@exactly
@given(wide, any_prime)
def test_the_core_gives_the_null_space_of_flint(matrix, p):
    n, rows = matrix
    reduced = linear_algebra._reduced_mod(rows, p)
    found = linear_algebra._nullspace_of_flint(reduced, n, p)
    assert nullspace_mod(rows, n, p) == found
    if linear_algebra._has_core():
        assert linear_algebra._nullspace_of_core(reduced, n, p) == found


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
