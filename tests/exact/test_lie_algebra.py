from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.exact.lie_algebra import LieAlgebra, so


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def test_so3_is_the_cross_product():
    c = so(3).structure_constants
    unit = [[int(i == k) for k in range(3)] for i in range(3)]
    for i in range(3):
        for j in range(3):
            assert list(c[i][j]) == cross(unit[i], unit[j])


def test_only_so3_has_a_name():
    with pytest.raises(ParameterError, match="got n = 4"):
        so(4)


def test_antisymmetry_is_required_and_the_entry_named():
    c = [[[0] * 2 for _ in range(2)] for _ in range(2)]
    c[0][1][0], c[1][0][0] = 1, 1
    with pytest.raises(BracketError, match=r"antisymmetric.*c\[0\]\[1\]\[0\] = 1 and c\[1\]\[0\]\[0\] = 1"):
        LieAlgebra(c)


def antisymmetric(n, entries):
    c = [[[0] * n for _ in range(n)] for _ in range(n)]
    for (i, j, k), value in entries.items():
        c[i][j][k], c[j][i][k] = value, -value if isinstance(value, int) else -sp.Symbol(value)
    return c


def test_jacobi_is_required_and_the_triple_named():
    # [e0, e1] = e2, [e2, e3] = e4: [[e0, e1], e3] = e4 and the other two cyclic terms vanish.
    with pytest.raises(BracketError, match=r"\(i, j, k\) = \(0, 1, 3\).*component 1 along e_4"):
        LieAlgebra(antisymmetric(5, {(0, 1, 2): 1, (2, 3, 4): 1}))


def test_symbolic_structure_constants_can_be_given_values():
    algebra = LieAlgebra(antisymmetric(3, {(0, 1, 2): "s", (1, 2, 0): 1, (2, 0, 1): 1}), name="so(s)")
    assert algebra.symbols == {"s"}
    assert algebra.substitute({"s": Fraction(1)}).structure_constants == so(3).structure_constants
    assert algebra.substitute({"t": Fraction(1)}) is algebra


@pytest.mark.parametrize("ragged", [[], [[[1]], [[1]]], [[[0, 0], [0, 0]], [[0, 0], [0]]]])
def test_the_tensor_is_cubic(ragged):
    with pytest.raises(ShapeError, match=r"structure_constants must have shape \(n, n, n\)"):
        LieAlgebra(ragged)


def test_basis_names_fit_the_dimension():
    with pytest.raises(ShapeError, match="3 names; got 2"):
        LieAlgebra(so(3).structure_constants, basis_names=("x", "y"))
