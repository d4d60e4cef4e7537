from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
import sympy as sp

from liepoisson.errors import ParameterError
from liepoisson.structure.extensions import semidirect
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import ALGEBRAS, abelian, affine, gl, heisenberg, se, sine, sl, so, su

SMALL = [
    *(so(n) for n in (2, 3, 4, 5, 6)),
    *(so(p, q) for p, q in ((2, 1), (1, 2), (0, 3), (1, 1), (3, 1), (2, 2), (1, 3), (4, 1))),
    *(f(n) for f in (su, sl, gl, se, affine) for n in (2, 3, 4)),
    *(f(1) for f in (gl, heisenberg, affine, abelian)),
    heisenberg(3),
    abelian(4),
]


def unit(n, i, j):
    return sp.Matrix(n, n, lambda r, c: int((r, c) == (i, j)))


@pytest.mark.parametrize("algebra", SMALL, ids=str)
def test_named_algebras_obey_jacobi(algebra):
    assert algebra.jacobi_residuals() == {}
    checked = LieAlgebra(algebra.structure_constants, algebra.name, algebra.basis_names)
    assert checked.brackets == algebra.brackets
    assert all(type(c) is Fraction for row in algebra.brackets.values() for c in row.values())
    assert len(set(algebra.basis_names)) == algebra.dimension


@pytest.mark.parametrize("algebra", [so(8), su(5), sl(5), se(6)], ids=str)
def test_one_flipped_constant_breaks_jacobi(algebra):
    assert algebra.jacobi_residuals() == {}
    pair, row = list(algebra.brackets.items())[len(algebra.brackets) // 2]
    k = min(row)
    flipped = {**algebra.brackets, pair: {**row, k: -row[k]}}
    assert LieAlgebra.from_brackets(algebra.dimension, flipped, check=False).jacobi_residuals()


@pytest.mark.parametrize("n", [4, 5])
def test_so_is_the_commutator_of_antisymmetric_matrices(n):
    matrices = [unit(n, i, j) - unit(n, j, i) for i, j in combinations(range(n), 2)]
    assert so(n).brackets == LieAlgebra.from_matrices(matrices).brackets


@pytest.mark.parametrize(("p", "q"), [(3, 1), (2, 2), (1, 4)])
def test_so_with_a_metric_keeps_the_metric(p, q):
    n, eta = p + q, sp.diag(*[1] * p, *[-1] * q)
    matrices = [(unit(n, i, j) - unit(n, j, i)) * eta for i, j in combinations(range(n), 2)]
    assert all((x.T * eta + eta * x).is_zero_matrix for x in matrices)
    assert so(p, q).brackets == LieAlgebra.from_matrices(matrices).brackets


@pytest.mark.parametrize("n", [2, 3, 4])
def test_su_sl_gl_are_the_commutators_of_their_matrices(n):
    upper = list(combinations(range(n), 2))
    diagonal = [unit(n, k, k) - unit(n, k + 1, k + 1) for k in range(n - 1)]
    a = [unit(n, j, k) - unit(n, k, j) for j, k in upper]
    s = [sp.I * (unit(n, j, k) + unit(n, k, j)) for j, k in upper]
    assert su(n).brackets == LieAlgebra.from_matrices(a + s + [sp.I * h for h in diagonal]).brackets
    pairs = list(product(range(n), repeat=2))
    off_diagonal = [unit(n, i, j) for i, j in pairs if i != j]
    assert sl(n).brackets == LieAlgebra.from_matrices(off_diagonal + diagonal).brackets
    assert gl(n).brackets == LieAlgebra.from_matrices([unit(n, i, j) for i, j in pairs]).brackets


@pytest.mark.parametrize("n", [2, 3, 4])
def test_se_and_affine_are_matrices_with_a_column_more(n):
    def bordered(x):
        return sp.Matrix.vstack(sp.Matrix.hstack(x, sp.zeros(n, 1)), sp.zeros(1, n + 1))

    translations = [unit(n + 1, k, n) for k in range(n)]
    planes = {2: [(1, 0)], 3: [(2, 1), (0, 2), (1, 0)]}.get(n, list(combinations(range(n), 2)))
    rotations = [bordered(unit(n, i, j) - unit(n, j, i)) for i, j in planes]
    assert se(n).brackets == LieAlgebra.from_matrices(rotations + translations).brackets
    linear = [bordered(unit(n, i, j)) for i, j in product(range(n), repeat=2)]
    assert affine(n).brackets == LieAlgebra.from_matrices(linear + translations).brackets


def test_se3_is_so3_with_one_passive_field():
    assert (se(3) @ semidirect(1)).poisson_tensor().shape == (6, 6)
    x = dict(zip((se(3) @ semidirect(1)).variables, (so(3) @ semidirect(2)).variables, strict=True))
    assert (se(3) @ semidirect(1)).poisson_tensor().subs(x) == (so(3) @ semidirect(2)).poisson_tensor()


def test_so21_is_the_cross_product_of_its_metric():
    eta = (1, 1, -1)
    for i, j in combinations(range(3), 2):
        u, v = ([int(i == k) for k in range(3)], [int(j == k) for k in range(3)])
        cross = np.cross(u, v)
        assert so(2, 1).bracket(u, v) == tuple(eta[k] * int(cross[k]) for k in range(3))
    assert so(3, 0).brackets == so(3).brackets


def velocity(algebra, x, gradient):
    """The minus Lie-Poisson equations, x_i' = -c_ij^k x_k dH/dx_j."""
    c, n = algebra.structure_constants, algebra.dimension
    return [-sum(c[i][j][k] * x[k] * gradient[j] for j in range(n) for k in range(n)) for i in range(n)]


def test_the_casimir_of_so21_is_its_metric():
    x = [Fraction(v) for v in (2, -3, 5)]
    assert not any(velocity(so(2, 1), x, [2 * x[0], 2 * x[1], -2 * x[2]]))
    assert any(velocity(so(2, 1), x, [2 * v for v in x]))


def test_the_manakov_top_has_its_signs():
    # M' = [M, Omega], Omega_ij = M_ij / (J_i + J_j), for M12, ..., M34 = 1, ..., 6 and J = (1, 2, 3, 4).
    pairs, J = list(combinations(range(4), 2)), (1, 2, 3, 4)
    M = [Fraction(k + 1) for k in range(6)]
    omega = [m / (J[i] + J[j]) for m, (i, j) in zip(M, pairs, strict=True)]
    expected = [Fraction(*v) for v in ((9, 10), (52, 105), (-89, 42), (37, 42), (-34, 35), (29, 30))]
    assert velocity(so(4), M, omega) == expected


def test_the_free_rigid_body_has_its_signs():
    # Euler: x' = x cross omega.
    x, omega = [Fraction(v) for v in (1, 2, 3)], [Fraction(v) for v in (5, -1, 2)]
    assert velocity(so(3), x, omega) == [int(v) for v in np.cross([1, 2, 3], [5, -1, 2])]


def test_basis_names_are_readable():
    assert so(4).basis_names == ("12", "13", "14", "23", "24", "34")
    assert so(10).basis_names[7:10] == ("19", "1_10", "23")
    assert su(2).basis_names == ("a12", "s12", "h1")
    assert sl(2).basis_names == ("e12", "e21", "h1")
    assert se(2).basis_names == ("r", "t1", "t2")
    assert se(3).basis_names == ("r1", "r2", "r3", "t1", "t2", "t3")
    assert heisenberg(1).basis_names == ("q1", "p1", "c")
    assert affine(1).basis_names == ("a", "b")
    for large in (gl(12), so(12), su(12)):
        assert len(set(large.basis_names)) == large.dimension


@pytest.mark.parametrize("name", sorted(ALGEBRAS))
@pytest.mark.parametrize("n", [True, 2.0, "3", None, -1, Fraction(3), 10**6, 10**30, 0, float("nan")])
def test_wrong_sizes_are_refused(name, n):
    with pytest.raises(ParameterError, match=name):
        ALGEBRAS[name](n)


@pytest.mark.parametrize("sizes", [(2, -1), (2, True), (1, 0), (0, 1), (2, 10**9), (3, 1.0)])
def test_wrong_metrics_are_refused(sizes):
    with pytest.raises(ParameterError, match="so"):
        so(*sizes)


def test_names_print_as_they_are_written():
    made = [so(4), so(2, 1), su(3), sl(2), gl(2), se(3), heisenberg(2), affine(1), abelian(2), sine(3)]
    for algebra in made:
        name, _, sizes = repr(algebra).rstrip(")").partition("(")
        again = ALGEBRAS[name](*(int(size) for size in sizes.split(",")))
        assert again.brackets == algebra.brackets
    assert {repr(algebra).partition("(")[0] for algebra in made} == set(ALGEBRAS)


@pytest.mark.parametrize("integer", [np.int64, np.int32, sp.Integer])
@pytest.mark.parametrize("name", sorted(ALGEBRAS))
def test_sizes_may_be_integers_of_any_type(name, integer):
    assert ALGEBRAS[name](integer(3)).brackets == ALGEBRAS[name](3).brackets


def test_a_sine_algebra_that_is_too_large_is_refused_for_its_size():
    with pytest.raises(ParameterError, match="Take a smaller n"):
        ALGEBRAS["sine"](1_000_000)
    with pytest.raises(ParameterError, match="Take 5"):
        ALGEBRAS["sine"](6)
