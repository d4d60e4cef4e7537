"""Monodromy of the twisted Lagrange top by braids, against laws, quadratures and closing flows."""

from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import OrbitError, ParameterError, ShapeError

TOP = lp.Top.twisted_lagrange()
LEAVES = {
    "AA": (-5, 0), "AU": (0, 2), "UU-": (0, "1/5"), "UU+": (8, 1), "BU": (20, "3.58"), "AB": (35, 5),
}  # fmt: skip
GROUPS = {"AA": "trivial", "AU": "Z", "UU-": "SL(2, Z)", "UU+": "SL(2, Z)", "BU": "SL(2, Z)", "AB": "Z"}
UNIT = np.eye(3, dtype=int)


@cache
def diagram(name):
    c1, c2 = LEAVES[name]
    return lp.tori.lagrange_diagram(lp.Leaf(TOP, {"C1": c1, "C2": c2, "C3": 1}))


@cache
def around_threads(name):
    return lp.tori.lagrange_monodromy(diagram(name))


@pytest.mark.parametrize("name", LEAVES)
def test_groups_of_the_six_classes(name):
    found = around_threads(name)
    assert found.group == GROUPS[name]
    assert len(found.loops) == len(diagram(name).threads)
    assert found.is_abelian == (name in ("AA", "AU", "AB"))


@pytest.mark.parametrize("name", LEAVES)
def test_around_one_thread_the_lattice_is_sheared(name):
    """M - 1 is primitive, of rank 1 and square 0; M fixes the circle of l3 and has the determinant 1."""
    found = around_threads(name)
    for matrix in found.matrices:
        rest = matrix - UNIT
        assert round(np.linalg.det(matrix)) == 1
        assert np.linalg.matrix_rank(rest) == 1
        assert not (rest @ rest).any()
        assert np.gcd.reduce(rest.ravel()) == 1
    circle = found.periods[0] - found.periods[1] + found.periods[2]
    np.testing.assert_allclose(circle, [0, 2 * np.pi, 0], atol=1e-10)
    for row in found.invariant:
        assert (row @ found.matrices == row).all()
    assert len(found.invariant) == {"trivial": 3, "Z": 2, "SL(2, Z)": 1}[found.group]


@pytest.mark.thorough
@pytest.mark.parametrize(("side", "name"), [(-1, "UU-"), (1, "UU+")])
@pytest.mark.parametrize("c2", [0.0, 0.4, -2.0])
def test_beside_the_wall_where_threads_exchange_their_ends_both_braids_occur(side, name, c2):
    leaf = lp.Leaf(TOP, {"C1": 3 + 4 * c2**2 / 3 + 0.2 * side, "C2": c2, "C3": 1})
    found = lp.tori.lagrange_monodromy(lp.tori.lagrange_diagram(leaf))
    assert found.diagram.leaf_class == name
    assert found.group == "SL(2, Z)"
    one, other = found.matrices
    assert (one @ other @ one == other @ one @ other).all()


@pytest.mark.parametrize(("c2", "name"), [(0, "UU+"), (0.8, "UU+"), (0.83, "AB"), (-0.99, "AB")])
def test_classes_of_a_small_twist(c2, name):
    """UU+ for C2^2 < 2 C1 C3/3 = 0.667, AB beyond."""
    top = lp.Top.twisted_lagrange(epsilon=Fraction(1, 10**6))
    assert lp.tori.leaf_class(lp.Leaf(top, {"C1": 1, "C2": c2, "C3": 1})) == name


@pytest.mark.thorough
@pytest.mark.parametrize("c1", [3.2, 4, 5, 8, 20, 40])
def test_threads_of_symmetric_leaves_are_threads(c1):
    """C2 = 0: both Hopf points are at one g but for round-off."""
    found = lp.tori.lagrange_diagram(lp.Leaf(TOP, {"C1": c1, "C2": 0, "C3": 1}))
    assert {curve.ends for curve in found.threads} == {("HH", "HH"), ("S+", "S-")}
    assert lp.tori.lagrange_monodromy(found).group == "SL(2, Z)"


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_the_rank_is_three_less_the_degree_of_the_common_divisor(degree):
    """Of the gradients of C1, C2, C3, H, l3 and P, written by hand, at M = q N with random q and N."""
    draw = np.random.default_rng(degree)
    for _ in range(20):
        q = np.concatenate([[1], draw.normal(size=degree)])
        rest = np.zeros((3, 4 - degree))
        rest[2, 0], rest[:, 1:] = 1, draw.normal(size=(3, 3 - degree))
        l, alpha, beta = np.array([np.convolve(q, row) for row in rest])[:, 1:].T
        zero, axis = np.zeros(3), np.array([0, 0, 1.0])
        gradients = [
            (2 * beta, 2 * alpha, 2 * l), (zero, beta, alpha), (zero, zero, 2 * beta),
            (l * [1, 1, 1 / 0.6], axis, zero), (axis, zero, zero), (alpha, l, axis),
        ]  # fmt: skip
        sizes = np.linalg.svd(np.reshape(gradients, (6, 9)))[1]
        assert (sizes > 1e-9).sum() == 6 - degree


@pytest.mark.parametrize("name", ["UU-", "UU+", "BU"])
def test_two_threads_obey_the_relation_of_braids(name):
    one, other = around_threads(name).matrices
    assert (one @ other @ one == other @ one @ other).all()
    both = around_threads(name).in_plane
    np.testing.assert_array_equal(np.linalg.matrix_power(both[0] @ both[1], 3), -np.eye(2))


def test_loops_one_after_the_other_multiply_their_matrices():
    """Around both threads M has order 6."""
    two = around_threads("UU-")
    both = np.concatenate([*two.loops])
    found = lp.tori.lagrange_monodromy(diagram("UU-"), [both, two.loops[0][::-1], both[::-1]])
    np.testing.assert_array_equal(found.matrices[0], two.matrices[0] @ two.matrices[1])
    np.testing.assert_array_equal(found.matrices[1] @ two.matrices[0], UNIT)
    np.testing.assert_array_equal(found.matrices[2] @ found.matrices[0], UNIT)
    orders = [k for k in range(1, 13) if (np.linalg.matrix_power(found.matrices[0], k) == UNIT).all()]
    assert orders == [6, 12]
    assert found.group == "not decided"


@pytest.mark.parametrize("name", ["AU", "UU+"])
def test_finer_loops_have_the_same_braid(name):
    found = around_threads(name)
    fine = [refined(diagram(name), loop, 2) for loop in found.loops]
    assert lp.tori.lagrange_monodromy(diagram(name), fine).braids == found.braids


@pytest.mark.parametrize("name", ["AU", "UU-", "BU"])
def test_another_base_gives_conjugate_matrices(name):
    """By way of another value, and along other loops: the same group, and traces of products of the same loops."""
    found, scaled = around_threads(name), diagram(name).scaled
    other = scaled.integrals(scaled.scaled(found.base) * [0.5, 1, 0.6] + [0, 1.5, 0])
    moved = lp.tori.lagrange_monodromy(
        diagram(name), [np.concatenate([other[None], loop, other[None]]) for loop in found.loops]
    )
    loops = [lp.tori.thread_loop(diagram(name), thread, other) for thread in diagram(name).threads]
    own = lp.tori.lagrange_monodromy(diagram(name), loops)
    for one in (moved, own):
        assert one.group == found.group
        assert [np.trace(matrix) for matrix in one.matrices] == [3] * len(found.loops)
    for i, j in ((0, 0), (0, -1)):
        product, before = moved.matrices[i] @ moved.matrices[j], found.matrices[i] @ found.matrices[j]
        assert np.trace(product) == np.trace(before)


def refined(found, loop, n):
    """The corners of a loop and n - 1 values on each of its sides, straight in the scaled values."""
    corners = found.scaled.scaled(loop)
    share = np.arange(n)[:, None] / n
    sides = [one + share * (other - one) for one, other in pairwise(corners)]
    fine = found.scaled.integrals(np.concatenate([*sides, corners[-1:]]))
    fine[::n] = loop
    return fine


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["UU-", pytest.param("UU+", marks=pytest.mark.slow)])
def test_quadratures_along_a_loop_are_carried_by_the_same_matrix(name):
    """P(k) is nearly an integer matrix times P(k + 1); the product of these matrices is M."""
    found, threads = diagram(name), around_threads(name)
    for loop, matrix in zip(threads.loops, threads.matrices, strict=True):
        carried, last = UNIT, threads.periods
        for value in refined(found, loop[:-1], 4)[1:]:
            periods = lp.tori.lagrange_lattice(found, value)
            quotient = np.linalg.solve(periods.T, last.T).T
            step = np.round(quotient).astype(int)
            assert np.abs(quotient - step).max() < 0.25
            carried, last = carried @ step, periods
        np.testing.assert_array_equal(carried, matrix)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["AU", "UU-", "UU+", "BU"])
def test_closing_flows_are_carried_by_the_same_matrix(name):
    """N M = M' N with the matrix N that takes the basis by quadrature to that by closing flows."""
    found, threads = diagram(name), around_threads(name)
    for thread, loop, matrix in zip(found.threads, threads.loops, threads.matrices, strict=True):
        near = thread.states[np.abs(thread.values - loop[24:48].mean(axis=0)).sum(axis=1).argmin()]
        state = found.leaf.project(near + 0.05 * np.random.default_rng(0).normal(size=9))
        flows = lp.tori.monodromy(found.momentum, state, loop)
        change = np.linalg.solve(threads.periods.T, flows.periods.T).T
        np.testing.assert_allclose(change, np.round(change), atol=1e-9)
        np.testing.assert_array_equal(flows.matrix @ np.round(change), np.round(change) @ matrix)
        assert flows.is_unipotent


@pytest.mark.slow
def test_the_ordinary_top_has_one_focus_value_with_the_same_shear():
    """beta = 0: [[1, 1], [0, 1]] up to the basis, around the unstable sleeping top."""
    top = lp.catalog.system("lagrange")
    leaf = lp.Leaf.through(top, [0, 0, 1, 0, 0, 1])
    momentum = lp.tori.momentum_map(top)
    center = momentum(np.array([0, 0, 1, 0, 0, 1.0]))
    angle = np.linspace(0, 2 * np.pi, 25)
    loop = center + 0.1 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    start = leaf.project(np.array([0.3, 0, 1, 0.1, 0, 1]))
    matrix = lp.tori.monodromy(momentum, start, loop).matrix
    rest = matrix - np.eye(2, dtype=int)
    assert round(np.linalg.det(matrix)) == 1
    assert not (rest @ rest).any()
    assert np.gcd.reduce(rest.ravel()) == 1


def test_a_charge_and_units_change_no_braid():
    """s = a3 I1, u = epsilon s^2; alpha -> alpha + (b3/a3) beta takes a charged top to one that is not."""
    s, epsilon, ratio = Fraction(3), Fraction(5, 7), Fraction(-2, 3)
    u = epsilon * s**2
    one, two, three = 8 / s**2, 1 / (s * u), 1 / u**2
    top = lp.Top.twisted(inertia=(2, 2, 1), a=(0, 0, "3/2"), b=(0, 0, -1), epsilon=epsilon)
    casimirs = {"C1": one - 2 * ratio * two + ratio**2 * three, "C2": two - ratio * three, "C3": three}
    found = lp.tori.lagrange_monodromy(lp.tori.lagrange_diagram(lp.Leaf(top, casimirs)))
    assert found.braids == around_threads("UU+").braids
    circle = found.periods[0] - found.periods[1] + found.periods[2]
    np.testing.assert_allclose(circle, [0, 2 * np.pi, 0], atol=1e-10)


def test_a_loop_around_nothing_does_nothing():
    base = around_threads("AU").base
    loop = base + np.array([[0, 0, 0], [0.2, 0, 0], [0.2, 0, 0.2], [0, 0, 0]])
    found = lp.tori.lagrange_monodromy(diagram("AU"), [loop])
    assert (found.braids, found.group) == (((),), "trivial")
    assert found.invariant.shape == (3, 3)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda d, b: lp.tori.thread_loop(d, d.edges[0]), ParameterError, "one of diagram.threads"),
        (lambda d, b: lp.tori.thread_loop(d, d.threads[0], [-99, 0, 0]), OrbitError, "inside of the image"),
        (lambda d, b: lp.tori.thread_loop(d, d.threads[0], [1, 2]), ShapeError, "base: wanted"),
        (lambda d, b: lp.tori.lagrange_monodromy(d, []), ParameterError, "at least one"),
        (lambda d, b: lp.tori.lagrange_monodromy(d, [b]), ShapeError, "loops: wanted"),
        (lambda d, b: lp.tori.lagrange_monodromy(d, [[b, b + 1, b + 2]]), ParameterError, "closed polygons"),
        (lambda d, b: lp.tori.lagrange_monodromy(d, [[b, -99 * b, b]]), OrbitError, "leaves the image"),
        (lambda d, b: lp.tori.lagrange_monodromy(d, [[b, d.threads[0].values[50], b]]), OrbitError, "meets a thread"),
    ],
)
def test_refusals(call, error, message):
    with pytest.raises(error, match=message):
        call(diagram("AU"), around_threads("AU").base)
