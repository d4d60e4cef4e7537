import pytest
import sympy as sp

from liepoisson.errors import ParameterError
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian, affine, gl, heisenberg, se, sl, so, su


@pytest.mark.parametrize("n", [2, 3])
def test_the_killing_form_of_sl_is_two_n_times_the_trace(n):
    # kappa(X, Y) = 2 n tr(X Y) on sl(n): Humphreys, exercise 6.7 and table.
    def unit(i, j):
        return sp.Matrix(n, n, lambda r, c: int((r, c) == (i, j)))

    basis = [unit(i, j) for i in range(n) for j in range(n) if i != j]
    basis += [unit(k, k) - unit(k + 1, k + 1) for k in range(n - 1)]
    expected = tuple(tuple(2 * n * (x * y).trace() for y in basis) for x in basis)
    assert sl(n).killing_form() == expected


@pytest.mark.parametrize(
    ("algebra", "signature"),
    [
        (so(4), (0, 6, 0)),
        (so(2, 1), (2, 1, 0)),
        (so(3, 1), (3, 3, 0)),  # boosts positive, rotations negative
        (so(2, 2), (4, 2, 0)),
        (su(3), (0, 8, 0)),  # compact
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
        (so(5), [10], [10], 0),
        (se(2), [3, 2, 0], [3, 2], 0),
        (se(3), [6], [6], 0),
        (gl(3), [9, 8], [9, 8], 1),
        (heisenberg(3), [7, 1, 0], [7, 1, 0], 1),
        (affine(1), [2, 1, 0], [2, 1], 0),
        (affine(2), [6, 5], [6, 5], 0),
        (abelian(2), [2, 0], [2, 0], 2),
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
    if algebra.is_nilpotent:
        assert algebra.is_solvable


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
    with pytest.raises(
        ParameterError, match="rational entries, up to one common factor of known sign; got the entry -2"
    ):
        algebra.killing_signature()
    assert deformed(0).is_solvable
    assert [deformed(v).killing_signature() for v in (1, 0, -1)] == [(0, 3, 0), (0, 1, 2), (2, 1, 0)]


def test_irrational_constants_are_decided():
    # The same condition with square roots and sines, where s + t = v holds only by an identity of numbers.
    def algebra(s, t, v):
        return LieAlgebra.from_brackets(
            4, {(0, 1): {1: s}, (0, 2): {2: t}, (1, 2): {3: 1}, (0, 3): {3: v}}, check=False
        )

    pi, root = sp.pi, sp.sqrt(2)
    assert not algebra(root, sp.sqrt(3), sp.sqrt(5 + 2 * sp.sqrt(6))).jacobi_residuals()
    assert not algebra(sp.cos(pi / 7), sp.cos(3 * pi / 7), sp.Rational(1, 2) - sp.cos(5 * pi / 7)).jacobi_residuals()
    assert algebra(sp.cos(pi / 7), sp.cos(3 * pi / 7), sp.Rational(1, 2) + sp.cos(5 * pi / 7)).jacobi_residuals()
    assert algebra(root, sp.sqrt(3), sp.Rational(3146264370, 10**9)).jacobi_residuals()
    assert deformed(root).killing_form()[0][0] == -2 * root
