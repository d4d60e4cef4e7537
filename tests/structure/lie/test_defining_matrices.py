"""The matrices of algebras with a name move by conjugation, and wrong ones are refused."""

from dataclasses import replace
from fractions import Fraction

import pytest

from liepoisson.structure.lie.defining_matrices import defining_matrices
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import affine, gl, heisenberg, se, sine, sl, so, su
from liepoisson.structure.trace_casimirs import summands

ALGEBRAS = [so(3), so(2, 1), so(1, 2), so(4), so(3, 1), so(2, 2), so(5), so(6), so(3, 3), so(7), su(2), su(3), su(5)]
ALGEBRAS += [sl(2), sl(3), sl(4), gl(1), gl(2), gl(3), sine(3), sine(5)]


def scaled(matrix, factor):
    return {place: tuple((factor * q, a) for q, a in roots) for place, roots in matrix.items()}


@pytest.mark.parametrize("algebra", ALGEBRAS, ids=str)
def test_the_matrices_move_by_conjugation(algebra):
    assert defining_matrices(algebra).defect(algebra) == ""


@pytest.mark.parametrize("algebra", [so(4), so(3, 1), su(3), sl(3), gl(2), sine(3)], ids=str)
def test_a_wrong_sign_is_refused(algebra):
    """In one matrix, and in all that move: then X moves backwards."""
    right = defining_matrices(algebra)
    wrong = (right.matrices[0], scaled(right.matrices[1], Fraction(-1)), *right.matrices[2:])
    assert "is not the combination" in replace(right, matrices=wrong).defect(algebra)
    backwards = {j: scaled(matrix, Fraction(-1)) for j, matrix in right.movers.items()}
    assert "is not the combination" in replace(right, movers=backwards).defect(algebra)


def test_a_sum_knows_its_summands():
    total = so(4) + su(3) + sl(2)
    assert [(start, part.name) for start, part in summands(total)] == [(0, "so(4)"), (6, "su(3)"), (14, "sl(2)")]
    assert [start for start, _ in summands(so(4))] == [0]


def test_what_is_no_matrix_of_the_algebra_is_refused():
    right = defining_matrices(sine(3))
    first = {place: tuple((q, (a + 4) % 12) for q, a in roots) for place, roots in right.matrices[0].items()}
    assert replace(right, matrices=(first, *right.matrices[1:])).defect(sine(3)) != ""
    # the modes (1, 0) alone commute with each other: they generate two dimensions of 8
    assert "do not generate" in replace(right, movers={j: right.movers[j] for j in (0, 1)}).defect(sine(3))
    assert "field" in right.defect(su(3))
    assert defining_matrices(so(4)).defect(so(3, 1)) != ""  # of the same dimension and names
    for algebra in (se(3), affine(2), heisenberg(1), LieAlgebra.from_brackets(3, so(3).brackets)):
        assert defining_matrices(algebra) is None
