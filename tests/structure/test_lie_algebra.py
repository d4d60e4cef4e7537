import pickle
from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.errors import BracketError
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import affine, gl, heisenberg, se, sine, sl, so


def test_brackets_are_sparse_and_equal_to_the_dense_tensor():
    algebra = LieAlgebra.from_brackets(3, {(0, 1): {2: 1}, (1, 2): {0: "1"}, (2, 0): {1: 1.0}})
    assert algebra.brackets == {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}
    assert algebra.structure_constants == so(3).structure_constants
    assert LieAlgebra(so(3).structure_constants).brackets == algebra.brackets
    x = sp.Symbol("x")
    zero = LieAlgebra.from_brackets(3, {(0, 1): {2: (x + 1) ** 2 - x**2 - 2 * x - 1}, (1, 2): {0: "s", 1: 0}})
    assert zero.brackets == {(1, 2): {0: sp.Symbol("s")}}


@pytest.mark.parametrize("wrong", [-1, 2])
def test_se3_with_one_wrong_constant_is_refused(wrong):
    """so(3) would not do: [e_i, e_j] = eps_ijk s_k e_k is a Lie algebra for every s."""
    for pair, row in se(3).brackets.items():
        for k, c in row.items():
            with pytest.raises(BracketError, match="Jacobi"):
                LieAlgebra.from_brackets(6, {**se(3).brackets, pair: {**row, k: wrong * c}})
    diagonal = LieAlgebra.from_brackets(3, {(0, 1): {2: "r"}, (1, 2): {0: "s"}, (2, 0): {1: "t"}}, check=False)
    assert diagonal.jacobi_residuals() == {}


def test_the_bracket_of_elements():
    assert so(3).bracket((1, 2, 3), ("1/2", 0, -1)) == (-2, Fraction(5, 2), -1)
    assert so(3).bracket(("x", 0, 0), (0, 1, 0)) == (0, 0, sp.Symbol("x"))
    ad, u, v = se(3).adjoint_representation(), (1, 2, 3, 4, 5, 6), (2, -1, 1, 0, 3, -2)
    acted = tuple(sum(u[i] * ad[i][k][j] * v[j] for i in range(6) for j in range(6)) for k in range(6))
    assert acted == se(3).bracket(u, v)


def test_a_direct_sum_commutes_across():
    both = so(3) + heisenberg(1)
    assert both.basis_names == ("1", "2", "3", "q1", "p1", "c")
    assert both.brackets == so(3).brackets | {(3, 4): {5: 1}}
    assert repr(both) == "so(3) + heisenberg(1)"
    assert (so(3) + so(3) + so(3)).basis_names == tuple("123456789")
    thrice = heisenberg(1) + heisenberg(1) + heisenberg(1)
    assert thrice.basis_names == ("q1", "p1", "c", "q1_2", "p1_2", "c_2", "q1_3", "p1_3", "c_3")


def test_substitution_drops_what_vanishes_and_becomes_rational():
    algebra = so(3) + LieAlgebra.from_brackets(3, {(0, 1): {2: "s"}, (1, 2): {0: 1}, (2, 0): {1: 1}})
    assert algebra.symbols == {"s"}
    euclidean = algebra.substitute({"s": Fraction(0)})
    assert euclidean.brackets == so(3).brackets | {(3, 5): {4: -1}, (4, 5): {3: 1}}
    assert all(type(c) is Fraction for row in euclidean.brackets.values() for c in row.values())


@pytest.mark.parametrize(
    "algebra", [so(4), so(6), so(11), so(4) + so(3), sine(3), LieAlgebra.from_brackets(2, {(0, 1): {1: "s"}}, "scaled")]
)
def test_copies_are_the_same(algebra):
    """The first name of so(6) is "12", a pair of indices and no number of a basis element."""
    made = LieAlgebra.from_brackets(algebra.dimension, algebra.brackets, algebra.name, algebra.basis_names, check=False)
    for copy in (made, pickle.loads(pickle.dumps(algebra))):
        assert (copy.name, copy.dimension, copy.basis_names) == (algebra.name, algebra.dimension, algebra.basis_names)
        assert copy.brackets == algebra.brackets


@pytest.mark.parametrize(
    ("algebra", "signature"),
    [
        (so(2, 1), (2, 1, 0)),
        (so(3, 1), (3, 3, 0)),  # boosts positive, rotations negative
        (sl(3), (5, 3, 0)),  # symmetric traceless minus antisymmetric
        (gl(2), (2, 1, 1)),
        (se(3), (0, 3, 3)),
        (heisenberg(2), (0, 0, 5)),
    ],
    ids=str,
)
def test_killing_signatures(algebra, signature):
    assert algebra.killing_signature() == signature


@pytest.mark.parametrize(
    ("algebra", "derived", "central", "centre"),
    [
        (se(2), [3, 2, 0], [3, 2], 0),
        (se(3), [6], [6], 0),
        (gl(3), [9, 8], [9, 8], 1),
        (heisenberg(3), [7, 1, 0], [7, 1, 0], 1),
        (affine(1), [2, 1, 0], [2, 1], 0),
        (so(3) + heisenberg(1), [6, 4, 3], [6, 4, 3], 1),
        # Filiform: [e0, e_i] = e_(i+1), nilpotent of the largest class.
        (LieAlgebra.from_brackets(5, {(0, i): {i + 1: 1} for i in (1, 2, 3)}), [5, 3, 0], [5, 3, 2, 1, 0], 1),
    ],
    ids=str,
)
def test_series_and_centre(algebra, derived, central, centre):
    assert [ideal.dimension for ideal in algebra.derived_series()] == derived
    assert [ideal.dimension for ideal in algebra.lower_central_series()] == central
    assert algebra.centre().dimension == centre
    assert algebra.is_solvable == (derived[-1] == 0)
    assert algebra.is_nilpotent == (central[-1] == 0)


def test_ideals_come_with_a_basis():
    algebra = se(2)
    _, translations, zero = algebra.derived_series()
    assert translations.basis == ((0, 1, 0), (0, 0, 1))
    assert zero.basis == ()
    (c,) = heisenberg(1).centre().basis
    assert c == (0, 0, 1)
    (unit,) = gl(2).centre().basis
    assert unit == (1, 0, 0, 1)


def deformed(s):
    """so(3) for s > 0, se(2) for s = 0, so(2, 1) for s < 0."""
    return LieAlgebra.from_brackets(3, {(0, 1): {2: s}, (1, 2): {0: 1}, (2, 0): {1: 1}})


def test_symbols_are_generic():
    s = sp.Symbol("s")
    algebra = deformed("s")
    assert algebra.killing_form() == ((-2 * s, 0, 0), (0, -2 * s, 0), (0, 0, -2))
    assert algebra.is_semisimple
    assert algebra.derived_series()[-1].dimension == 3
    assert deformed(0).is_solvable
    assert [deformed(v).killing_signature() for v in (1, 0, -1)] == [(0, 3, 0), (0, 1, 2), (2, 1, 0)]


def conditional(s, t, v, u=1):
    """[e0, e1] = s e1, [e0, e2] = t e2, [e1, e2] = u e3, [e0, e3] = v e3: a Lie algebra iff u (s + t - v) = 0."""
    return LieAlgebra.from_brackets(4, {(0, 1): {1: s}, (0, 2): {2: t}, (1, 2): {3: u}, (0, 3): {3: v}}, check=False)


COS, ROOT = [sp.cos(n * sp.pi / 7) for n in range(6)], sp.sqrt(2)


@pytest.mark.parametrize(
    ("numbers", "holds"),
    [
        ((ROOT, sp.sqrt(3), sp.sqrt(5 + 2 * sp.sqrt(6))), True),
        ((ROOT, sp.sqrt(3), sp.Rational(3146264370, 10**9)), False),
        ((COS[1], COS[3], sp.Rational(1, 2) - COS[5]), True),
        ((COS[1], COS[3], sp.Rational(1, 2) + COS[5]), False),
        (("s", "t", "s + t"), True),
    ],
)
def test_jacobi_residuals_are_decided_also_where_only_an_identity_of_numbers_makes_them_vanish(numbers, holds):
    assert (not conditional(*numbers).jacobi_residuals()) is holds
    s, t, u, v = sp.symbols("s t u v")
    ((triple, residual),) = conditional("s", "t", "v", "u").jacobi_residuals().items()
    assert triple == (0, 1, 2)
    # [[e0, e1], e2] + [[e1, e2], e0] + [[e2, e0], e1] = (s u - u v + t u) e3
    assert sp.expand(residual[3] - u * (s + t - v)) == 0
