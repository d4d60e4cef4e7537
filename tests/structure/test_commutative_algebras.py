"""All commutative associative algebras of small dimension, with or without a unit."""

from random import Random

import numpy as np
import pytest
import sympy as sp
from random_bases import unimodular

from liepoisson.errors import ParameterError
from liepoisson.structure.extension import Extension
from liepoisson.structure.normal_forms import commutative_algebras


def in_another_basis(extension, seed):
    n = extension.dimension
    P, inverse = unimodular(n, Random(seed))
    p, q = np.array(P.tolist(), dtype=int), np.array(inverse.tolist(), dtype=int)
    W = np.array([[[int(v) for v in row] for row in plane] for plane in extension.tensor])
    return Extension(np.einsum("ma,nb,lab,lk->kmn", p, p, W, q).tolist())


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_each_algebra_is_found_by_its_name_in_every_basis(n):
    algebras = commutative_algebras(n)
    assert len(algebras) == len({a.name for a in algebras}) == {1: 2, 2: 6, 3: 15, 4: 42}[n]
    for seed, one in enumerate(algebras):
        Extension(one.tensor)  # is checked to be associative
        assert one.classify().name == one.name
        assert in_another_basis(one, seed).classify().name == one.name


def tensors(rows, n, p):
    """All symmetric tensors by the products e_i e_j, i <= j, in the order of `rows`."""
    W = np.zeros((len(rows), n, n, n), dtype=np.int64)
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    for k, (i, j) in enumerate(pairs):
        W[:, i, j] = W[:, j, i] = rows[:, n * k : n * (k + 1)]
    return W


def grid(length, p):
    return np.array(np.meshgrid(*[range(p)] * length, indexing="ij")).reshape(length, -1).T


def n_associative(n, p):
    """The number of commutative associative products on F_p^n.

    A commutative product is associative if and only if the multiplications L_1, ..., L_n with basis elements commute.
    They are chosen one after the other; L_i has e_i e_j for j < i from those before it.
    """

    def extended(known):
        """All choices of the next multiplication, for each row of `known` the ones before; those that commute."""
        i = known.shape[1]
        free = grid(n * (n - i), p).reshape(-1, n, n - i)
        before = known[:, :, :, i].transpose(0, 2, 1)  # columns e_i e_j, j < i
        shape = (len(known), len(free), n, i)
        following = np.concatenate(
            [np.broadcast_to(before[:, None], shape), np.broadcast_to(free[None], (len(known), *free.shape))], axis=3
        )
        good = np.ones(following.shape[:2], dtype=bool)
        for j in range(i):
            left = known[:, None, j]
            good &= ((left @ following - following @ left) % p == 0).all(axis=(2, 3))
        a, b = np.nonzero(good)
        return np.concatenate([known[a], following[a, b][:, None]], axis=1)

    total = 0
    for first in np.array_split(grid(n * n, p).reshape(-1, 1, n, n), 1 + p ** (n * n) // 200):
        current = first.astype(np.int32)
        for _ in range(n - 1):
            current = extended(current)
        total += len(current)
    return total


def n_automorphisms(W, p):
    """How many invertible matrices g have g(x y) = g(x) g(y), and how many there are."""
    n = W.shape[0]
    matrices = grid(n * n, p).reshape(-1, n, n)
    invertible = matrices[np.round(np.linalg.det(matrices)).astype(int) % p != 0]
    left = np.einsum("gip,gjq,pqk->gijk", invertible, invertible, W)
    right = np.einsum("ijs,gsk->gijk", W, invertible)
    return int((((left - right) % p).reshape(len(invertible), -1) == 0).all(axis=1).sum()), len(invertible)


@pytest.mark.thorough
@pytest.mark.parametrize("n", [2, 3])
def test_there_are_no_others(n):
    r"""Over $\mathbb F_3$: the associative products are as many as $\sum_A |GL_n| / |\mathrm{Aut}\, A|$.

    There C stands for the field of 9 elements, as -1 is no square, and one field more is the analogue of none over R:
    that of 27 elements, $x^3 = x + 1$.
    """
    p = 3
    orbits = 0
    found = [np.array(a.tensor, dtype=int).transpose(1, 2, 0) for a in commutative_algebras(n)]
    if n == 3:  # 1, x, x^2
        rows = np.array([[1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 0, 1, 1]])
        found.append(tensors(rows, 3, p)[0])
    for W in found:
        own, all_of_them = n_automorphisms(W, p)
        orbits += all_of_them // own
    assert orbits == n_associative(n, p)


@pytest.mark.parametrize("seed", range(20))
def test_the_powers_of_a_random_matrix_span_an_algebra_whose_name_its_minimal_polynomial_says(seed):
    """They are x R[x]/(f): a product of R[x]/(g^k), g^k in f; for g = x it is the maximal ideal of R[x]/(x^k)."""
    random = Random(seed)
    X = sp.Matrix(3, 3, lambda i, j: random.choice((0, 0, 1, -1)))
    if X.is_zero_matrix:
        X[0, 1] = 1
    power, basis = X, []
    while sp.Matrix([list(m) for m in (*basis, power)]).rank() > len(basis):
        basis.append(power)
        power = power * X
    span = sp.Matrix([list(m) for m in basis]).T
    n = len(basis)
    W = [[[0] * n for _ in range(n)] for _ in range(n)]
    for i in range(n):
        for j in range(n):
            coordinates = (span.T * span).inv() * span.T * sp.Matrix(list(basis[i] * basis[j]))
            for k in range(n):
                W[k][i][j] = coordinates[k]
    found = Extension(W).classify()
    nilpotent = next(k for k in range(1, 5) if (X**k).rank() == (X ** (k + 1)).rank()) if X.rank() < 3 else 0
    assert found.is_unital is (nilpotent <= 1)
    distinct = {complex(value.evalf()) for value in X.eigenvals()} - {0}
    complex_pairs = sum(abs(value.imag) > 1e-9 for value in distinct) // 2
    assert sum(factor.residue_field == "C" for factor in found.factors) == complex_pairs
    assert sum(factor.residue_field == "R" for factor in found.factors) == (
        len(distinct) - 2 * complex_pairs + (nilpotent > 1)
    )
    assert found.name in {a.name for a in commutative_algebras(n)}


@pytest.mark.parametrize("n", [0, 5, 2.0, True, "3"])
def test_dimensions_that_are_not_listed_are_refused(n):
    with pytest.raises(ParameterError, match="dimensions 1 to 4"):
        commutative_algebras(n)
