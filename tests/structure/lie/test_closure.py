"""Algebras that matrices and polynomials generate."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.algebras import closure
from liepoisson.errors import BracketError, ExpressionError, ParameterError, ShapeError
from liepoisson.structure.lie_algebra import LieAlgebra

PAULI = [sp.Matrix([[0, 1], [1, 0]]), sp.Matrix([[0, -sp.I], [sp.I, 0]]), sp.Matrix([[1, 0], [0, -1]])]


def unit(n, i, j, value=1):
    m = sp.zeros(n, n)
    m[i, j] = value
    return m


def gell_mann():
    """The hermitian generators of su(3)."""
    pairs = [(0, 1), (0, 2), (1, 2)]
    symmetric = [unit(3, i, j) + unit(3, j, i) for i, j in pairs]
    other = [unit(3, i, j, -sp.I) + unit(3, j, i, sp.I) for i, j in pairs]
    return [*symmetric, *other, sp.diag(1, -1, 0), sp.diag(1, 1, -2)]


def test_spins_have_the_structure_constants_of_rotations():
    """[S_a, S_b] = i eps_abc S_c for S = sigma/2."""
    found = closure([m / 2 for m in PAULI[:2]], hermitian=True)
    assert found.words == ("1", "2", "[1, 2]")
    assert found.algebra.brackets == lp.so(3).brackets
    assert [sp.Matrix(m) for m in found.elements] == [m / 2 for m in PAULI]
    assert LieAlgebra.from_matrices([m / 2 for m in PAULI], hermitian=True).brackets == lp.so(3).brackets


def test_hermitian_generators_generate_su_3():
    whole = LieAlgebra.from_matrices(gell_mann(), hermitian=True)
    assert whole.killing_signature() == (0, 8, 0)
    chosen = [gell_mann()[k] for k in (0, 2, 6)]
    assert closure(chosen, hermitian=True).algebra.killing_signature() == (0, 8, 0)


@pytest.mark.parametrize("hermitian", [False, True])
def test_the_elements_have_the_commutators_of_the_algebra(hermitian):
    found = closure(
        [gell_mann()[k] for k in (0, 4)] if hermitian else [unit(3, 0, 1), unit(3, 1, 2)], hermitian=hermitian
    )
    elements = [sp.Matrix(m) for m in found.elements]
    factor = sp.I if hermitian else 1
    for (i, j), row in found.algebra.brackets.items():
        wanted = sum((c * elements[k] for k, c in row.items()), sp.zeros(3, 3))
        assert elements[i] * elements[j] - elements[j] * elements[i] == factor * wanted
    assert not found.algebra.jacobi_residuals()


def test_quadratic_functions_are_the_symplectic_algebra():
    """{q^2/2, p^2/2} = q p: sl(2, R), and in n degrees of freedom the quadratic forms have n (2n + 1) dimensions."""
    found = closure(["q1^2/2", "p1^2/2"], lp.canonical(1))
    assert [str(f) for f in found.elements] == ["q1**2/2", "p1**2/2", "p1*q1"]
    assert found.algebra.killing_signature() == (2, 1, 0)
    assert closure(["q1^2", "p1^2", "q1*q2", "q2^2", "p2^2"], lp.canonical(2)).algebra.dimension == 10
    linear = closure(["q1", "p1"], lp.canonical(1))  # Heisenberg's algebra, with the constant 1
    assert linear.elements[2] == 1
    assert linear.algebra.is_nilpotent


def test_functions_on_a_lie_poisson_bracket_have_its_brackets():
    bracket = lp.so(3) @ lp.leibniz(2)
    found = closure(["l1", "l2", "alpha3"], bracket)
    for (i, j), row in found.algebra.brackets.items():
        wanted = sum(c * found.elements[k] for k, c in row.items())
        assert sp.expand(bracket(found.elements[i], found.elements[j]) - wanted) == 0
    assert found.algebra.dimension == 6
    assert found.algebra.radical().dimension == 3


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: closure(["q1^3", "p1^2"], lp.canonical(1), limit=9), BracketError, r"within 9 dim.* bracket \[2, "),
        (lambda: closure(PAULI[:2], hermitian=True, limit=2), BracketError, r"the commutator \[1, 2\] is outside"),
        (lambda: closure([[[0, 1], [0, 0]]], hermitian=True), ParameterError, r"generators\[0\]: wanted a hermitian"),
        (
            lambda: LieAlgebra.from_matrices([[[0, 1], [2, 0]]], hermitian=True),
            ParameterError,
            r"matrices\[0\]: wanted",
        ),
        (lambda: closure(["1/q1"], lp.canonical(1)), ParameterError, "a polynomial in the coordinates; got 1/q1"),
        (lambda: closure(["q2"], lp.canonical(1)), ExpressionError, "q2"),
        (lambda: closure(["q1"], lp.canonical(1), hermitian=True), ParameterError, "got functions"),
        (lambda: closure(["x"], lp.PoissonTensor(["x", "y"], {("x", "y"): "exp(x)"})), ParameterError, "polynomials"),
        (lambda: closure(PAULI, lp.so(3)), ParameterError, "a Poisson bracket; got so"),
        (lambda: closure([]), ShapeError, "Give at least one"),
        (lambda: closure([[[0]]]), BracketError, "got zeros only"),
        (lambda: closure(PAULI, limit=0), ParameterError, "from 1 to 1000; got 0"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
