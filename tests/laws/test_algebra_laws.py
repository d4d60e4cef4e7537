"""Laws of the exact algebra, over every field: field axioms, elimination, rings of polynomials, matrices."""

from fractions import Fraction

import pytest
import sympy as sp
from flint import fmpq_poly
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, dense, eliminated, sparse
from liepoisson.algebra.function_fields import AlgebraicFunctions, AlgebraicNumbers, RationalFunctions, Rationals
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank, rank_mod, solve
from liepoisson.algebra.matrices import characteristic_polynomial, determinant, product
from liepoisson.algebra.number_fields import PrimeField
from liepoisson.algebra.real_fields import RealField, real_field
from liepoisson.algebra.residues import PRIME
from liepoisson.algebra.sparse_polynomials import (
    add_multiple,
    along,
    derivative,
    gradient_at,
    multiply,
    value_at,
)

EPSILON = sp.Symbol("epsilon")


def coefficients(*values):
    """The field of some values, and they."""
    field = Coefficients.containing(values)
    return field, [field.read(value) for value in values]


def real(*values):
    field = real_field(values)
    return field, [field.read(value) for value in values]


def algebraic_numbers(*modulus):
    field = AlgebraicNumbers(fmpq_poly(list(modulus)))
    return field, [field.element(fmpq_poly([0, 1]))]


def rational_functions():
    field = RationalFunctions(["s", "t"])
    return field, [field.element(x) for x in field.context.gens()]


def algebraic_functions():
    """theta^3 = s."""
    base = RationalFunctions(["s"])
    s, zero = base.element(base.context.gens()[0]), base.zero
    field = AlgebraicFunctions(base, [-s, zero, zero])
    return field, [field.element([s]), field.element([zero, base.one])]


FIELDS = {
    "Q": coefficients(Fraction(1, 2)),
    "Q(sqrt 2)": coefficients(sp.sqrt(2)),
    "cyclotomic": coefficients(sp.sin(sp.pi / 7), sp.cos(2 * sp.pi / 7)),
    "Q(2^(1/3))": coefficients(sp.cbrt(2)),
    "Q(epsilon)": coefficients(EPSILON, 1 / (EPSILON + 1)),
    "Q(sqrt 2, epsilon)": coefficients(EPSILON, sp.sqrt(2) * EPSILON),
    "real Q": real(Fraction(2, 3)),
    "real Q(sqrt 3)": real(sp.sqrt(3), sp.Integer(2)),
    "real Q(epsilon)": real(EPSILON, sp.Integer(1)),
    "F_3": (PrimeField(3), [PrimeField(3).number(2)]),
    "F_p": (PrimeField(PRIME), [PrimeField(PRIME).number(Fraction(2, 3))]),
    "F_p of two words": (PrimeField(2**89 - 1), [PrimeField(2**89 - 1).number(Fraction(2, 3))]),
    "balances in Q": (Rationals(), [Rationals().number(Fraction(3, 7))]),
    "balances in a number field": algebraic_numbers(1, -3, 0, 1),
    "balances over Q(s, t)": rational_functions(),
    "balances over Q(s)(theta)": algebraic_functions(),
}

TIMES_INTEGERS = [
    name
    for name, (field, _) in FIELDS.items()
    if isinstance(field, (Rationals, PrimeField, RealField))
    or (isinstance(field, Coefficients) and not field.is_cyclotomic)
]
"""Fields whose elements have powers and are multiplied by integers, as derivatives ask for."""

small = st.integers(-2, 2)
each_field = pytest.mark.parametrize("name", FIELDS)
some = settings(deadline=None, max_examples=8, derandomize=True)


def elements(name):
    """Sums and products of few of the generators with small numbers; zero often."""
    field, generators = FIELDS[name]
    numbers = small.map(field.number)
    return st.one_of(numbers, st.builds(lambda a, x, b: a * x + b, numbers, st.sampled_from(generators), numbers))


def matrices(name, most=4):
    return st.tuples(st.integers(1, most), st.integers(1, most)).flatmap(
        lambda shape: st.lists(
            st.lists(elements(name), min_size=shape[1], max_size=shape[1]), min_size=shape[0], max_size=shape[0]
        )
    )


def polynomials(name):
    monomials = st.tuples(*[st.integers(0, 2)] * 2)
    return st.dictionaries(monomials, elements(name), max_size=3).map(
        lambda terms: {m: c for m, c in terms.items() if c}
    )


def added(field, *summands):
    """A combination of polynomials, given with whole factors."""
    found = {}
    for factor, p in summands:
        add_multiple(found, p, field.number(factor))
    return found


def is_zero(field, *summands):
    return all(field.vanishes(c) for c in added(field, *summands).values())


def total(terms, zero):
    for term in terms:
        zero = zero + term
    return zero


@each_field
@some
@given(st.data())
def test_axioms_of_a_field(name, data):
    field, _ = FIELDS[name]
    a, b, c = (data.draw(elements(name)) for _ in range(3))
    zero, one = field.zero, field.one
    for difference in (
        a + b - (b + a),
        a * b - b * a,
        a + b + c - (a + (b + c)),
        a * b * c - a * (b * c),
        a * (b + c) - a * b - a * c,
        a + zero - a,
        a * one - a,
        a + (-a),
        field.number(Fraction(1, 2)) * field.number(2) - one,
    ):
        assert field.vanishes(difference)
        assert not difference
    assert not field.vanishes(one)
    if not field.vanishes(a):
        assert field.vanishes(a * field.inverse(a) - one)


@each_field
@some
@given(st.data())
def test_an_elimination_gives_the_null_space(name, data):
    """A v = 0, rank + nullity = number of columns, one form whichever way the rows come."""
    field, _ = FIELDS[name]
    A = data.draw(matrices(name))
    n = len(A[0])
    form, left = eliminated(map(sparse, A), n, field)
    assert not any(left)
    vectors = form.null_space(n)
    assert len(form) + len(vectors) == n
    for row in A:
        assert all(field.vanishes(total((row[k] * x for k, x in v.items()), field.zero)) for v in vectors)
    one_by_one = Echelon(field)
    grown = [one_by_one.insert(sparse(row)) for row in reversed(A)]
    assert sum(grown) == len(form)
    assert sorted(one_by_one.rows) == sorted(form.rows)
    for first, second in zip(form.basis(), one_by_one.basis(), strict=True):
        assert min(first) == min(second)
        pairs = zip(dense(first, range(n), field.zero), dense(second, range(n), field.zero), strict=True)
        assert all(field.vanishes(x - y) for x, y in pairs)
    assert not any(form.reduce(sparse(row)) for row in A)
    # rows of the form have no leading columns of others, and null vectors end in columns of their own
    assert all(lead == min(row) or lead not in row for row in form.basis() for lead in form.rows)
    assert all(field.vanishes(row[min(row)] - field.one) for row in form.basis())
    ends = [max(v) for v in vectors]
    assert ends == sorted(set(ends).difference(form.rows))
    assert all(end == other or other not in v for v, end in zip(vectors, ends, strict=True) for other in ends)


@pytest.mark.parametrize("name", [name for name in FIELDS if isinstance(FIELDS[name][0], Coefficients)])
@some
@given(st.data())
def test_null_spaces_ranks_and_solutions_agree(name, data):
    field, _ = FIELDS[name]
    A = data.draw(matrices(name))
    rows, n = list(map(sparse, A)), len(A[0])
    found = nullspace(rows, n, field).vectors
    assert len(found) == n - rank(rows, field)
    wanted = Echelon(field, rows).null_space(n)
    assert [sorted(v) for v in found] == [sorted(v) for v in wanted]
    assert all(field.vanishes(v[k] - w[k]) for v, w in zip(found, wanted, strict=True) for k in v)
    # a combination of columns is found again, up to the null space; a unit vector outside of their span is not
    columns = [sparse(column) for column in zip(*A, strict=True)]
    x = data.draw(st.lists(elements(name), min_size=n, max_size=n))
    target = [total((a * y for a, y in zip(row, x, strict=True)), field.zero) for row in A]
    y = solve(columns, sparse(target), field)
    assert y is not None
    assert all(
        field.vanishes(total((a * c for a, c in zip(row, y, strict=True)), -t))
        for row, t in zip(A, target, strict=True)
    )
    span = Echelon(field, columns)
    for k in range(len(A)):
        unit = {k: field.one}
        assert (solve(columns, unit, field) is None) == bool(span.reduce(unit))


@pytest.mark.parametrize("p", [2, 3, 101, PRIME])
@some
@given(st.data())
def test_null_spaces_modulo_primes_are_those_of_the_field(p, data):
    field = PrimeField(p)
    n = data.draw(st.integers(1, 6))
    A = data.draw(st.lists(st.lists(st.integers(-5, 5), min_size=n, max_size=n), min_size=1, max_size=6))
    rows = [sparse(map(field.number, row)) for row in A]
    form = Echelon(field, rows)
    assert nullspace_mod(map(sparse, A), n, p) == nullspace_mod(rows, n, p)
    assert nullspace_mod(rows, n, p) == [{k: int(x) for k, x in v.items()} for v in form.null_space(n)]
    assert rank_mod(rows, n, p) == len(form)


@each_field
@some
@given(st.data())
def test_polynomials_are_a_ring(name, data):
    field, _ = FIELDS[name]
    f, g, h = (data.draw(polynomials(name)) for _ in range(3))
    one = {(0, 0): field.one}
    assert is_zero(field, (1, multiply(f, g)), (-1, multiply(g, f)))
    assert is_zero(field, (1, multiply(multiply(f, g), h)), (-1, multiply(f, multiply(g, h))))
    assert is_zero(field, (1, multiply(f, added(field, (1, g), (1, h)))), (-1, multiply(f, g)), (-1, multiply(f, h)))
    assert is_zero(field, (1, multiply(one, f)), (-1, f))
    assert not added(field, (1, f), (-1, f))


@pytest.mark.parametrize("name", TIMES_INTEGERS)
@some
@given(st.data())
def test_derivatives_and_values_of_polynomials(name, data):
    """The rule of Leibniz; values are a homomorphism; gradients are values of derivatives."""
    field, _ = FIELDS[name]
    f, g, h = (data.draw(polynomials(name)) for _ in range(3))
    for k in range(2):
        by_rule = ((-1, multiply(derivative(f, k), g)), (-1, multiply(f, derivative(g, k))))
        assert is_zero(field, (1, derivative(multiply(f, g), k)), *by_rule)
    rates = [g, h]
    by_rule = ((-1, multiply(along(f, rates), g)), (-1, multiply(f, along(g, rates))))
    assert is_zero(field, (1, along(multiply(f, g), rates)), *by_rule)
    point = [data.draw(elements(name)) for _ in range(2)]

    def at(p):
        return field.zero + value_at(p.items(), point)

    assert field.vanishes(at(multiply(f, g)) - at(f) * at(g))
    assert field.vanishes(at(added(field, (1, f), (3, h))) - at(f) - at(h) * field.number(3))
    slopes = gradient_at(f, point)
    assert all(field.vanishes(at(derivative(f, k)) - slopes.get(k, field.zero)) for k in range(2))


@each_field
@some
@given(st.data())
def test_a_matrix_is_a_zero_of_its_characteristic_polynomial(name, data):
    """The theorem of Cayley and Hamilton, the trace and the determinant."""
    field, _ = FIELDS[name]
    if name == "F_3":
        return  # the algorithm divides by all numbers up to the size
    n = data.draw(st.integers(1, 3))
    A = [[data.draw(elements(name)) for _ in range(n)] for _ in range(n)]
    polynomial = characteristic_polynomial(A, field.number)
    assert field.vanishes(polynomial[n] - field.one)
    assert field.vanishes(total((A[k][k] for k in range(n)), polynomial[n - 1]))
    sign = field.number((-1) ** n)
    assert field.vanishes(determinant(A, field.zero) - sign * polynomial[0])
    found = [[field.zero] * n for _ in range(n)]
    for c in reversed(polynomial):
        found = product(A, found, field.zero)
        for k in range(n):
            found[k][k] = found[k][k] + c
    assert all(field.vanishes(x) for row in found for x in row)


@each_field
@some
@given(st.data())
def test_determinants_are_multiplicative(name, data):
    field, _ = FIELDS[name]
    n = data.draw(st.integers(1, 3))
    A, B = ([[data.draw(elements(name)) for _ in range(n)] for _ in range(n)] for _ in range(2))
    zero = field.zero
    of_product = determinant(product(A, B, zero), zero)
    assert field.vanishes(of_product - determinant(A, zero) * determinant(B, zero))
    is_regular = len(Echelon(field, map(sparse, A))) == n
    assert field.vanishes(determinant(A, zero)) != is_regular
