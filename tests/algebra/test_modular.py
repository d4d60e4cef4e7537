"""Null spaces modulo a prime, against FLINT's, and what ends an elimination."""

import os
import signal
import threading
import time
from itertools import product

import flint
import numpy as np
import pytest

from liepoisson import _core
from liepoisson.errors import ParameterError, ShapeError

PRIMES = (3, 101, 65_537, 2**31 - 1, 2**61 - 1, 2**62 - 57)


def arrays(matrix):
    """The compressed rows of a dense array."""
    rows, columns = np.nonzero(matrix)
    indptr = np.searchsorted(rows, np.arange(len(matrix) + 1))
    return indptr.astype(np.uint64), columns.astype(np.uint32), matrix[rows, columns].astype(np.uint64)


def null_space(matrix, prime, *, enough_rank=None):
    return _core.modular_null_space(*arrays(matrix), matrix.shape[1], prime, enough_rank, 60, None)


def dense_basis(space, n_columns):
    basis = np.zeros((len(space["free"]), n_columns), np.uint64)
    for row, (begin, end) in enumerate(zip(space["indptr"][:-1], space["indptr"][1:], strict=True)):
        basis[row, space["columns"][begin:end]] = space["residues"][begin:end]
    return basis


def random_matrix(generator, n_rows, n_columns, n_entries, prime):
    matrix = np.zeros((n_rows, n_columns), np.uint64)
    places = generator.integers(0, [n_rows, n_columns], size=(n_entries, 2))
    matrix[places[:, 0], places[:, 1]] = generator.integers(1, prime, size=n_entries, dtype=np.uint64)
    return matrix


@pytest.mark.parametrize(
    ("prime", "shape"),
    [*product(PRIMES, [(1, 1, 1), (60, 40, 150)]), (101, (300, 150, 700)), (2**62 - 57, (400, 200, 1600))],
)
def test_null_space_is_that_of_flint(prime, shape):
    generator = np.random.default_rng(shape)
    matrix = random_matrix(generator, *shape, prime)
    matrix[:, generator.integers(shape[1], size=4)] = matrix[:, generator.integers(shape[1], size=4)]
    space = null_space(matrix, prime)
    reference = flint.nmod_mat(*matrix.shape, matrix.ravel().tolist(), prime)
    echelon, rank = reference.rref()
    entries = np.array([int(x) for x in echelon.entries()], np.uint64).reshape(matrix.shape)
    pivots = [int(np.flatnonzero(entries[row])[0]) for row in range(rank)]
    assert space["complete"]
    assert space["rank"] == rank
    assert space["pivots"].tolist() == pivots
    assert sorted([*pivots, *space["free"].tolist()]) == list(range(shape[1]))
    basis = dense_basis(space, shape[1])
    wanted = np.zeros_like(basis)
    wanted[np.arange(len(basis)), space["free"]] = 1
    negative = np.uint64(prime) - entries[:rank][:, space["free"]].T
    wanted[:, pivots] = np.where(negative == prime, np.uint64(0), negative)
    np.testing.assert_array_equal(basis, wanted)


def test_a_rank_that_is_enough_ends_the_elimination():
    matrix = random_matrix(np.random.default_rng(1), 300, 150, 700, 101)
    rank = null_space(matrix, 101)["rank"]
    space = null_space(matrix, 101, enough_rank=rank - 5)
    assert not space["complete"]
    assert (space["rank"], len(space["pivots"]), len(space["free"])) == (rank - 5, rank - 5, 150 - rank + 5)
    assert (space["indptr"].tolist(), len(space["columns"])) == ([0], 0)
    independent = flint.nmod_mat(300, rank - 5, matrix[:, space["pivots"]].ravel().tolist(), 101)
    assert independent.rank() == rank - 5
    assert null_space(matrix, 101, enough_rank=rank + 1)["complete"]


INDPTR, COLUMNS, RESIDUES = np.array([0, 1], np.uint64), np.array([0], np.uint32), np.array([1], np.uint64)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        *(((INDPTR, COLUMNS, RESIDUES, 1, p), ParameterError, rf"prime: wanted an odd prime below 2\^62; got {p}")
          for p in (0, 1, 2, 9, 2**61 + 1, 2**62 + 135, 2**64 - 59)),
        ((INDPTR, COLUMNS + np.uint32(1), RESIDUES, 1, 3), ParameterError, "columns: wanted numbers below 1; got 1 at"),
        ((INDPTR, COLUMNS, RESIDUES, 2**40, 3), ParameterError, "n_columns"),
        ((INDPTR, COLUMNS, np.ones(2, np.uint64), 1, 3), ShapeError, "residues: wanted 1.*got 2"),
        *(((np.array(starts, np.uint64), COLUMNS, RESIDUES, 1, 3), ShapeError, "wanted ascending numbers from 0 to 1")
          for starts in ([], [0], [0, 2], [1, 1], [0, 2**63, 1])),
        ((INDPTR.astype(float), COLUMNS, RESIDUES, 1, 3), TypeError, "indptr"),
    ],
)  # fmt: skip
def test_refusals(arguments, error, words):
    with pytest.raises(error, match=words):
        _core.modular_null_space(*arguments, None, 60, None)


def large_matrix():
    """One whose elimination takes minutes: rows without structure, which fill up."""
    generator = np.random.default_rng(3)
    n_rows, n_columns, per_row = 15_000, 15_000, 6
    columns = generator.integers(0, n_columns, size=n_rows * per_row, dtype=np.uint32)
    residues = generator.integers(1, 2**61 - 1, size=n_rows * per_row, dtype=np.uint64)
    return np.arange(0, n_rows * per_row + 1, per_row, dtype=np.uint64), columns, residues, n_columns


def test_time_limit_leaves_a_lower_bound_of_the_rank():
    space = _core.modular_null_space(*large_matrix(), 2**61 - 1, None, 0.5, None)
    assert not space["complete"]
    assert 0 < space["rank"] == len(space["pivots"]) < 15_000


def test_ctrl_c_ends_the_elimination():
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        _core.modular_null_space(*large_matrix(), 2**61 - 1, None, 600, None)
    assert time.monotonic() - begin < 30
