"""Cases of parameters: every point where a matrix is singular lies in one, and all points of a case are singular."""

import random
from fractions import Fraction
from itertools import product

import flint
import pytest

from liepoisson.algebra.ideals.limits import Limits
from liepoisson.integrability import parameter_cases
from liepoisson.integrability.parameter_cases import Cases, CaseSplitting

CONTEXT = flint.fmpq_mpoly_ctx.get(["a", "b", "c"], "degrevlex")
A, B, C = CONTEXT.gens()
GRID = [Fraction(k) for k in (-2, -1, 0, 1, 2, 3)]


def value(p, point):
    total = Fraction(0)
    for monomial, c in p.terms():
        term = Fraction(int(c.p), int(c.q))
        for x, k in zip(point, monomial, strict=True):
            term *= x ** int(k)
        total += term
    return total


def rank(rows):
    rows, found = [list(row) for row in rows], 0
    for column in range(len(rows[0])):
        pivot = next((k for k in range(found, len(rows)) if rows[k][column]), None)
        if pivot is None:
            continue
        rows[found], rows[pivot] = rows[pivot], rows[found]
        for k in range(found + 1, len(rows)):
            factor = rows[k][column] / rows[found][column]
            rows[k] = [x - factor * y for x, y in zip(rows[k], rows[found], strict=True)]
        found += 1
    return found


def nullity(rows, n, point):
    return n - rank([[value(row[c], point) if c in row else Fraction(0) for c in range(n)] for row in rows])


def random_entry(rng):
    p = CONTEXT.constant(0)
    for _ in range(rng.choice([0, 1, 1, 2])):
        p = p + rng.choice([-2, -1, 1, 2]) * A ** rng.choice([0, 1]) * B ** rng.choice([0, 1]) * C ** rng.choice(
            [0, 0, 1]
        )
    return p


def split(rows, n, *, positive=(), nonzero=(), scalings=(), n_known=0):
    splitting, cases = CaseSplitting(CONTEXT, frozenset(positive), list(nonzero), scalings), Cases()
    splitting.run([dict(row) for row in rows], n, n_known, cases)
    return splitting, cases


@pytest.mark.parametrize("seed", range(12))
def test_cases_are_all_points_where_a_matrix_has_a_larger_null_space(seed):
    rng, n = random.Random(seed), 3
    rows = [{c: p for c in range(n) if (p := random_entry(rng))} for _ in range(4)]
    rows = [row for row in rows if row]
    splitting, cases = split(rows, n)
    for point in product(GRID, repeat=3):
        if nullity(rows, n, point):
            places = (*cases.found, *cases.left)
            assert any(all(value(q, point) == 0 for q in splitting.conditions(case)) for case in places)
    for case in cases.found:
        inside = 0
        for point in product(GRID, repeat=3):
            bound = dict(enumerate(point))
            for v, a, b in case.solved:
                if not (below := value(b, point)):
                    break
                bound[v] = value(a, point) / below
            else:
                here = tuple(bound[k] for k in range(3))
                if all(value(q, here) == 0 for q in case.unsolved):
                    inside += 1
                    assert nullity(rows, n, here) > 0
        assert inside or case.unsolved


def random_form(rng, degree):
    """A homogeneous polynomial, for a scaling of all parameters."""
    p = CONTEXT.constant(0)
    for _ in range(rng.choice([0, 1, 1, 2])):
        term = CONTEXT.constant(rng.choice([-2, -1, 1, 2]))
        for _ in range(degree):
            term = term * rng.choice([A, B, C])
        p = p + term
    return p


@pytest.mark.parametrize("seed", range(15))
def test_scalings_lose_no_point_where_a_parameter_that_was_set_to_one_vanishes(seed):
    rng, n = random.Random(seed), 2
    rows = [{c: p for c in range(n) if (p := random_form(rng, 1 + k % 2))} for k in range(4)]
    rows = [row for row in rows if row]
    splitting, cases = split(rows, n, scalings=((1, 1, 1),))
    for point in product(GRID, repeat=3):
        if nullity(rows, n, point):
            places = (*cases.found, *cases.left)
            assert any(all(value(q, point) == 0 for q in splitting.conditions(case)) for case in places), point


def test_a_case_is_not_taken_for_a_part_of_another_whose_closure_misses_it():
    # a c = b d and a d = b c: a = b and c = d, or a = -b and c = -d, or a = b = 0, or c = d = 0
    context = flint.fmpq_mpoly_ctx.get(["a", "b", "c", "d"], "degrevlex")
    a, b, c, d = context.gens()
    splitting, cases = CaseSplitting(context, frozenset(), [], [(1, 1, 1, 1)]), Cases()
    splitting.run([{0: a * c - b * d}, {0: a * d - b * c}], 1, 0, cases)
    points = [p for p in product(GRID, repeat=4) if p[0] * p[2] == p[1] * p[3] and p[0] * p[3] == p[1] * p[2]]
    assert (1, 2, 0, 0) in points
    for point in points:
        assert any(all(value(q, point) == 0 for q in splitting.conditions(case)) for case in cases.found), point


def test_real_parameters_and_positive_ones():
    # a^2 + b^2 = 0 only where both vanish; a + b never, if both are positive
    _, cases = split([{0: A**2 + B**2}], 1)
    assert [sorted(map(str, case.equations)) for case in cases.found] == [["a", "b"]]
    _, cases = split([{0: A + B}], 1, positive=(0, 1))
    assert not cases.found
    # b = -2 a is no case for positive parameters, though no equation says so by its signs alone
    _, cases = split([{0: A * B - C * A}, {0: 2 * A + C}], 1, positive=(0, 1, 2))
    assert not cases.found
    _, cases = split([{0: A * B - C * A}, {0: 2 * A + C}], 1)
    assert len(cases.found) == 2


def conditions(rows, n=1, **more):
    splitting, cases = split(rows, n, **more)
    assert not cases.left
    return sorted(sorted(map(str, splitting.conditions(case))) for case in cases.found)


def test_several_equations_of_higher_degree_are_taken_apart():
    # a^2 = b^2 = 2: a = b, or else c = 0
    rows = [{0: A**2 - 2}, {0: B**2 - 2}, {0: C * (A - B)}]
    assert conditions(rows) == [["a - b", "b^2 - 2"], ["a^2 - 2", "b^2 - 2", "c"]]
    # the second unknown is free where a b is not a root of six; a^2 b^2 = 6 follows
    rows = [{0: A**2 - 2}, {0: B**2 - 3}, {1: A**2 * B**2 - 6}]
    assert conditions(rows, 2, n_known=1) == [["a^2 - 2", "b^2 - 3"]]
    # a real c exists for two of the four signs
    rows = [{0: A**2 - 2}, {0: B**2 - 3}, {0: A * B * C**2 - 6}]
    assert len(conditions(rows)) == 1


def test_what_would_cost_too_much_is_left(monkeypatch):
    monkeypatch.setattr(parameter_cases, "LIMITS", Limits(work=10))
    _, cases = split([{0: A**2 - 2}, {0: B**2 - 2}, {0: C * (A - B)}], 1)
    assert cases.left


def test_contradictions_and_sums_of_squares_are_no_case():
    # at a^2 = 2 the second is a - 1
    assert conditions([{0: A**2 - 2}, {0: A**3 + A**2 - A - 3}]) == []
    # a = 1 leaves a unit, or a product
    assert conditions([{0: A - 1}, {0: A**2 * B - B + C}], nonzero=(C,)) == []
    # (a - 1/2)^2 + b^2 + 3/4 never vanishes; a^2 + a b + b^2 does at a = b = 0
    assert conditions([{0: A**2 - A + B**2 + 1}]) == []
    assert conditions([{0: A**2 + A * B + B**2}]) == [["a", "b"]]
    assert conditions([{0: A**2 + B**2 - 1}]) == [["a^2 + b^2 - 1"]]
