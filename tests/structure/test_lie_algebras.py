from fractions import Fraction
from itertools import combinations, product

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.lie.sine_algebra import sine_names
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import (
    ALGEBRAS,
    abelian,
    affine,
    galilei,
    gl,
    heisenberg,
    poincare,
    se,
    semidirect_sum,
    sine,
    sl,
    so,
    su,
)

SMALL = [
    *(so(n) for n in (2, 3, 4, 5, 6)),
    *(f(n) for f in (galilei, poincare) for n in (2, 3, 4)),
    *(poincare(n, kappa) for n in (2, 3, 4) for kappa in (-1, Fraction(2, 3))),
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


@pytest.mark.parametrize(("p", "q"), [(4, 0), (3, 1), (2, 2), (1, 4)])
def test_so_with_a_metric_keeps_the_metric(p, q):
    n, eta = p + q, sp.diag(*[1] * p, *[-1] * q)
    matrices = [(unit(n, i, j) - unit(n, j, i)) * eta for i, j in combinations(range(n), 2)]
    assert all((x.T * eta + eta * x).is_zero_matrix for x in matrices)
    assert so(p, q).brackets == LieAlgebra.from_matrices(matrices).brackets
    assert p < 2 or so(p, 0).brackets == so(p).brackets


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


def test_names_print_as_they_are_written():
    made = [so(4), so(2, 1), su(3), sl(2), gl(2), se(3), heisenberg(2), affine(1), abelian(2), sine(3)]
    made += [galilei(2), poincare(3)]
    for algebra in made:
        name, _, sizes = repr(algebra).rstrip(")").partition("(")
        again = ALGEBRAS[name](*(int(size) for size in sizes.split(",")))
        assert again.brackets == algebra.brackets
    assert {repr(algebra).partition("(")[0] for algebra in made} == set(ALGEBRAS)
    assert so(sp.Integer(3)).brackets == so(3).brackets


HAT = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
SIGMA = [sp.Matrix([[0, 1], [1, 0]]), sp.Matrix([[0, -sp.I], [sp.I, 0]]), sp.Matrix([[1, 0], [0, -1]])]


def test_spin_matrices_are_so3():
    # s_k = -i sigma_k / 2: [s_1, s_2] = s_3.
    spins = [-sp.I * s / 2 for s in SIGMA]
    assert LieAlgebra.from_matrices(spins, "su(2)", ("x", "y", "z")).brackets == so(3).brackets
    as_numbers = [[[complex(v) for v in row] for row in s.tolist()] for s in spins]
    assert LieAlgebra.from_matrices(as_numbers).brackets == so(3).brackets


def test_irrational_and_symbolic_matrices():
    root = [[[sp.sqrt(2) * v for v in row] for row in x] for x in HAT]
    assert LieAlgebra.from_matrices(root).brackets == {
        (0, 1): {2: sp.sqrt(2)},
        (0, 2): {1: -sp.sqrt(2)},
        (1, 2): {0: sp.sqrt(2)},
    }
    scaled = [[[sp.Symbol("s") * v for v in row] for row in x] for x in HAT]
    assert LieAlgebra.from_matrices(scaled).brackets[0, 1] == {2: sp.Symbol("s")}


def test_se3_is_a_semidirect_sum():
    made = semidirect_sum(so(3), HAT, "se(3)", ("t1", "t2", "t3"))
    assert made.brackets == se(3).brackets
    assert made.basis_names == ("1", "2", "3", "t1", "t2", "t3")
    assert made.name == "se(3)"


@pytest.mark.thorough
@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.sampled_from([so(3), so(4), sl(2), su(3), heisenberg(1), abelian(2)]))
def test_the_adjoint_representation_gives_a_lie_algebra(algebra):
    made = semidirect_sum(algebra, algebra.adjoint_representation())
    assert made.jacobi_residuals() == {}
    assert made.dimension == 2 * algebra.dimension


def test_a_complex_representation_acts_on_a_real_space():
    made = semidirect_sum(so(3), [-sp.I * s / 2 for s in SIGMA])
    assert made.dimension == 3 + 4
    assert made.jacobi_residuals() == {}
    assert repr(made) == "so(3) ⋉ R^4"


def test_symbols_may_stand_in_a_representation():
    """The plane with [r, z] = (s + i) z: spirals."""
    spiral = semidirect_sum(abelian(1), [[["s", -1], [1, "s"]]])
    assert spiral.jacobi_residuals() == {}
    assert spiral.substitute({"s": Fraction(0)}).brackets == se(2).brackets


@pytest.mark.parametrize("N", [3, 5])
def test_the_addition_theorem_is_the_jacobi_identity_and_the_real_form_is_compact(N):
    algebra = sine(N)
    assert algebra.jacobi_residuals() == {}
    assert algebra.killing_signature() == (0, N * N - 1, 0)


def test_the_coordinates_are_named_after_their_mode():
    names = sine(5).basis_names
    assert names[:8] == ("c10", "s10", "c01", "s01", "c11", "s11", "c1m1", "s1m1")
    assert len(set(names)) == 24
    assert all(f"w{name}".isidentifier() for name in names)
    assert len(set(sine_names(21))) == 440
