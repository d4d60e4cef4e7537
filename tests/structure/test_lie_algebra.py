import pickle
from fractions import Fraction
from itertools import combinations

import pytest
import sympy as sp
from flint import fmpq_mat
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, heisenberg, se, sine, sl, so, su

exactly = settings(deadline=None, max_examples=20, derandomize=True)


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def test_so3_is_the_cross_product():
    c = so(3).structure_constants
    unit = [[int(i == k) for k in range(3)] for i in range(3)]
    for i in range(3):
        for j in range(3):
            assert list(c[i][j]) == cross(unit[i], unit[j])


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
    assert algebra.substitute({}) is algebra


@pytest.mark.parametrize("ragged", [[], [[[1]], [[1]]], [[[0, 0], [0, 0]], [[0, 0], [0]]]])
def test_the_tensor_is_cubic(ragged):
    with pytest.raises(ShapeError, match=r"structure_constants must have shape \(n, n, n\)"):
        LieAlgebra(ragged)


def test_basis_names_fit_the_dimension():
    with pytest.raises(ShapeError, match="3 names; got 2"):
        LieAlgebra(so(3).structure_constants, basis_names=("x", "y"))


def test_brackets_are_sparse_and_equal_to_the_dense_tensor():
    algebra = LieAlgebra.from_brackets(3, {(0, 1): {2: 1}, (1, 2): {0: "1"}, (2, 0): {1: 1.0}})
    assert algebra.brackets == {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}
    assert algebra.structure_constants == so(3).structure_constants
    assert LieAlgebra(so(3).structure_constants).brackets == algebra.brackets


def test_zero_entries_are_not_stored():
    x = sp.Symbol("x")
    algebra = LieAlgebra.from_brackets(3, {(0, 1): {2: (x + 1) ** 2 - x**2 - 2 * x - 1}, (1, 2): {0: "s", 1: 0}})
    assert algebra.brackets == {(1, 2): {0: sp.Symbol("s")}}


@pytest.mark.parametrize(
    ("brackets", "error", "message"),
    [
        ({(0, 3): {1: 1}}, BracketError, r"indices of brackets must be integers from 0 to 2; got 3"),
        ({(0, -1): {1: 1}}, BracketError, r"from 0 to 2; got -1"),
        ({(0, True): {1: 1}}, BracketError, r"got True"),
        ({(0, 1): {3: 1}}, BracketError, r"indices of brackets\[0, 1\] must be .* got 3"),
        ({(1, 1): {0: 1}}, BracketError, r"antisymmetric; got the pair \(1, 1\)"),
        ({(0, 1): {2: 1}, (1, 0): {2: -1}}, BracketError, r"each pair once"),
        ({0: {2: 1}}, BracketError, r"pairs \(i, j\); got 0"),
        ({(0, 1): 2}, ShapeError, r"brackets\[0, 1\] must be a mapping"),
        ([1], ShapeError, "must be a mapping; got list"),
        ({(0, 1): {2: "1+"}}, ParameterError, r"brackets\[0, 1\]\[2\]"),
        ({(0, 1): {2: sp.nan}}, ParameterError, r"finite real number"),
        ({(0, 1): {2: True}}, ParameterError, r"a number, a name or a formula"),
    ],
)
def test_sparse_brackets_are_read_strictly(brackets, error, message):
    with pytest.raises(error, match=message):
        LieAlgebra.from_brackets(3, brackets)


@pytest.mark.parametrize("n", [0, -1, 1001, 2.0, True, "3", None])
def test_the_dimension_is_bounded(n):
    with pytest.raises(ParameterError, match="integer from 1 to 1000"):
        LieAlgebra.from_brackets(n, {})


def test_sparse_jacobi_failures_are_named_too():
    with pytest.raises(BracketError, match=r"\(i, j, k\) = \(0, 1, 3\).*component 1 along e_4"):
        LieAlgebra.from_brackets(5, {(0, 1): {2: 1}, (2, 3): {4: 1}})


def test_se3_with_one_wrong_constant_is_refused():
    for pair, row in se(3).brackets.items():
        for k, c in row.items():
            for wrong in (-c, 2 * c):
                changed = {**se(3).brackets, pair: {**row, k: wrong}}
                with pytest.raises(BracketError, match="Jacobi"):
                    LieAlgebra.from_brackets(6, changed)


def random_antisymmetric(data, n):
    entry = st.integers(-3, 3)
    return {pair: {k: data.draw(entry) for k in range(n)} for pair in combinations(range(n), 2)}


def dense_jacobi(algebra):
    """The textbook sum over all indices, component by component."""
    c, n = algebra.structure_constants, algebra.dimension
    residuals = {}
    for i, j, k in combinations(range(n), 3):
        for m in range(n):
            cyclic = ((i, j, k), (j, k, i), (k, i, j))
            value = sum(c[p][q][s] * c[s][r][m] for p, q, r in cyclic for s in range(n))
            if value:
                residuals.setdefault((i, j, k), {})[m] = value
    return residuals


@pytest.mark.thorough
@exactly
@given(st.data(), st.integers(3, 5))
def test_jacobi_residuals_are_those_of_the_textbook(data, n):
    algebra = LieAlgebra.from_brackets(n, random_antisymmetric(data, n), check=False)
    assert algebra.jacobi_residuals() == dense_jacobi(algebra)


def test_random_brackets_in_five_dimensions_fail_jacobi():
    brackets = {(i, j): {k: (7 * i + 5 * j + 3 * k) % 5 - 2 for k in range(5)} for i, j in combinations(range(5), 2)}
    with pytest.raises(BracketError, match="Jacobi"):
        LieAlgebra.from_brackets(5, brackets)


def test_three_diagonal_constants_always_obey_jacobi():
    # Why so(3) alone is no test: [e_i, e_j] = eps_ijk s_k e_k is a Lie algebra for every s.
    algebra = LieAlgebra.from_brackets(3, {(0, 1): {2: "r"}, (1, 2): {0: "s"}, (2, 0): {1: "t"}}, check=False)
    assert dense_jacobi(algebra) == algebra.jacobi_residuals() == {}


ALGEBRAS = [so(3), so(2, 1), so(4), su(3), sl(2), se(3), heisenberg(2), affine(2), abelian(3) + sl(2)]


@st.composite
def unimodular(draw, n):
    P = [[int(i == j) for j in range(n)] for i in range(n)]
    for _ in range(draw(st.integers(1, 6))):
        i, j = draw(st.permutations(range(n)))[:2]
        factor = draw(st.integers(-2, 2))
        P[i] = [a + factor * b for a, b in zip(P[i], P[j], strict=True)]
    return P


@pytest.mark.thorough
@exactly
@given(st.data(), st.sampled_from(ALGEBRAS))
def test_a_change_of_basis_changes_no_invariant(data, algebra):
    n = algebra.dimension
    P = data.draw(unimodular(n))
    inverse = fmpq_mat(n, n, [v for row in P for v in row]).inv()

    def in_new_basis(u):
        return [sum(u[k] * Fraction(int(inverse[k, d].p), int(inverse[k, d].q)) for k in range(n)) for d in range(n)]

    brackets = {
        (a, b): dict(enumerate(in_new_basis(algebra.bracket(P[a], P[b])))) for a, b in combinations(range(n), 2)
    }
    changed = LieAlgebra.from_brackets(n, brackets)
    assert changed.killing_signature() == algebra.killing_signature()
    for series in ("derived_series", "lower_central_series"):
        old, new = getattr(algebra, series)(), getattr(changed, series)()
        assert [s.dimension for s in new] == [s.dimension for s in old]
    assert changed.centre().dimension == algebra.centre().dimension


def test_the_bracket_of_elements():
    assert so(3).bracket((1, 2, 3), ("1/2", 0, -1)) == tuple(cross((1, 2, 3), (Fraction(1, 2), 0, -1)))
    x = sp.Symbol("x")
    assert so(3).bracket(("x", 0, 0), (0, 1, 0)) == (0, 0, x)
    assert abelian(2).bracket((1, 2), (3, 4)) == (0, 0)
    with pytest.raises(ShapeError, match="v must have 3 components; got 2"):
        so(3).bracket((1, 2, 3), (1, 2))


def test_a_direct_sum_commutes_across():
    both = so(3) + heisenberg(1)
    assert both.basis_names == ("1", "2", "3", "q1", "p1", "c")
    assert both.brackets == so(3).brackets | {(3, 4): {5: 1}}
    assert repr(both) == "so(3) + heisenberg(1)"
    assert not both.jacobi_residuals()


def test_names_of_a_sum_stay_distinct():
    assert (so(3) + so(3) + so(3)).basis_names == tuple("123456789")
    twice = heisenberg(1) + heisenberg(1)
    assert twice.basis_names == ("q1", "p1", "c", "q1_2", "p1_2", "c_2")
    assert (twice + heisenberg(1)).basis_names[6:] == ("q1_3", "p1_3", "c_3")


def test_rational_and_symbolic_algebras_add():
    scaled = LieAlgebra.from_brackets(2, {(0, 1): {1: "s"}})
    both = so(3) + scaled
    assert both.symbols == {"s"}
    assert both.jacobi_residuals() == {}
    assert both.substitute({"s": Fraction(1)}).brackets[3, 4] == {4: Fraction(1)}


def test_substitution_drops_what_vanishes_and_becomes_rational():
    algebra = LieAlgebra.from_brackets(3, {(0, 1): {2: "s"}, (1, 2): {0: 1}, (2, 0): {1: 1}})
    euclidean = algebra.substitute({"s": Fraction(0)})
    assert euclidean.brackets == {(0, 2): {1: -1}, (1, 2): {0: 1}}
    assert all(type(c) is Fraction for row in euclidean.brackets.values() for c in row.values())


def test_algebras_survive_pickling():
    for algebra in (so(4), sine(3), LieAlgebra.from_brackets(2, {(0, 1): {1: "s"}}, "scaled")):
        copy = pickle.loads(pickle.dumps(algebra))
        assert (copy.name, copy.dimension, copy.basis_names) == (algebra.name, algebra.dimension, algebra.basis_names)
        assert copy.brackets == algebra.brackets
        assert copy.jacobi_residuals() == {}


def test_the_dense_tensor_is_not_made_for_large_algebras():
    with pytest.raises(ParameterError, match=r"up to 200 dimensions; so\(21\) has 210"):
        _ = so(21).structure_constants


def test_the_adjoint_representation_acts_as_the_bracket():
    algebra = se(3)
    ad = algebra.adjoint_representation()
    u, v = (1, 2, 3, 4, 5, 6), (2, -1, 1, 0, 3, -2)
    acted = tuple(sum(u[i] * ad[i][k][j] * v[j] for i in range(6) for j in range(6)) for k in range(6))
    assert acted == algebra.bracket(u, v)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["2", "1"], "own place"),  # l[1] would be l2
        (["a b", "c"], "letters, digits"),
        (["(", "c"], "letters, digits"),
        (["", "c"], "letters, digits"),
        (["a", "a"], "distinct"),
    ],
)
def test_basis_names_with_which_formulas_would_go_wrong_are_refused(names, message):
    with pytest.raises(ParameterError, match=message):
        LieAlgebra.from_brackets(2, {}, basis_names=names)


@pytest.mark.parametrize("algebra", [so(4), so(6), so(11), so(4) + so(3)])
def test_pairs_of_indices_are_no_numbers_of_basis_elements(algebra):
    """Of so(6) the first is "12", though there are fifteen."""
    copy = LieAlgebra.from_brackets(algebra.dimension, algebra.brackets, basis_names=algebra.basis_names, check=False)
    assert copy.basis_names == algebra.basis_names
