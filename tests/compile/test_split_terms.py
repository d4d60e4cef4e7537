"""Hamiltonians as sums of pieces: the pieces add up, and their fields to the field of the system."""

from __future__ import annotations

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import PiecesField
from liepoisson.errors import ParameterError, UnsupportedFieldError


def field_of_pieces(field: PiecesField, x: np.ndarray) -> np.ndarray:
    """Sum over the pieces of F'(xi.x) M x."""
    rate = np.zeros_like(x)
    for form, derivative, matrix in field.pieces:
        y = sum(c * x[i] for i, c in form)
        slope = sum(c * y**k for k, c in enumerate(derivative))
        for i, k, c in matrix:
            rate[i] += slope * c * x[k]
    return rate


@pytest.mark.thorough
def test_fields_of_the_pieces_add_up_to_the_field_of_the_system() -> None:
    rng = np.random.default_rng(3)
    splittable = 0
    for name in lp.catalog.names():
        system = lp.catalog.system(name)
        try:
            pieces = system.pieces()
        except (UnsupportedFieldError, ParameterError):
            continue
        splittable += 1
        for x in rng.standard_normal((3, pieces.n_components)):
            expected = system.vector_field(x)
            size = 1.0 + np.abs(expected).max()
            # sums of some dozens of products: polarised products cancel, hence 1e-12 and not 1e-15
            assert np.abs(field_of_pieces(pieces, x) - expected).max() < 1e-12 * size, name
    assert splittable >= 15


def test_a_diagonal_kinetic_energy_splits_into_the_rotations_about_the_axes() -> None:
    pieces = lp.Top(inertia=(3, 2, 1), a=(1, 0, 2), b=(0, 1, 0), epsilon=2).pieces().pieces
    assert [form for form, _, _ in pieces] == [
        ((3, 1.0), (5, 2.0), (7, 1.0)),
        ((0, 1.0),),
        ((1, 1.0),),
        ((2, 1.0),),
    ]
    assert [derivative for _, derivative, _ in pieces] == [(1.0,), (0.0, 1 / 3), (0.0, 0.5), (0.0, 1.0)]


@pytest.mark.parametrize("seed", range(5))
def test_a_polynomial_of_one_linear_form_is_one_piece(seed: int) -> None:
    rng = np.random.default_rng(seed)
    form = "(" + " + ".join(f"{n}/7*l{k}" for k, n in enumerate(rng.integers(1, 9, 3), 1)) + ")"
    function = f"3*{form} - {form}^2/2 + 2*{form}^3 + {form}^5/3"
    assert len(lp.System(lp.so(3) @ lp.trivial(), function).pieces().pieces) == 1
    beside = lp.System(lp.so(3) @ lp.trivial(), f"{function} + l1*l2^2")
    x = rng.standard_normal(3)
    assert np.allclose(field_of_pieces(beside.pieces(), x), beside.vector_field(x), rtol=1e-12)
