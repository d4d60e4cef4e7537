from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.lie.representations import semidirect_sum
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, heisenberg, se, sl, so, su

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
