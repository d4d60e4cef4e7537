"""Multipliers from the derivative of a loop."""

import numpy as np

from liepoisson.orbits.multipliers import kind_of, loop_spectrum, transversal_basis

RATE, GRADIENT = np.array([1.0, 0, 0, 0, 0, 0]), np.array([[0.0, 1, 0, 0, 0, 0]])


def loop(small, shear=0.3):
    """A derivative with the flow along the first axis, one gradient along the second, and a part across."""
    found = np.eye(6)
    found[2:, 2:] = small
    found[0, 1:] = shear
    return found


def symplectic(values):
    """A matrix with the multipliers mu, 1/mu, in a random basis."""
    basis = np.random.default_rng(1).standard_normal((4, 4))
    return basis @ np.diag(values) @ np.linalg.inv(basis)


def test_the_others_are_left_when_the_trivial_ones_are_divided_out():
    small = symplectic([3.0, -1.7, 1 / 3, -1 / 1.7])
    found = loop_spectrum(loop(small), np.linalg.inv(loop(small)), GRADIENT, RATE)
    np.testing.assert_allclose(found.values, [3, -1.7, 1 / 3, -1 / 1.7], rtol=1e-12)
    assert found.pair_defect < 1e-13
    assert found.trivial_defect < 1e-15


def test_a_wrong_structure_is_seen():
    unpaired = symplectic([3.0, 2.0, 0.4, 0.5])
    assert loop_spectrum(loop(unpaired), np.linalg.inv(loop(unpaired)), GRADIENT, RATE).pair_defect > 1e-2
    moved = loop(symplectic([3.0, 2.0, 1 / 3, 0.5]))
    moved[1, 2] = 1e-3  # the gradient is not kept
    assert loop_spectrum(moved, np.linalg.inv(moved), GRADIENT, RATE).trivial_defect > 1e-5


def test_kinds():
    circle = np.exp(1j * np.array([0.3, -0.3]))
    assert kind_of(circle) == "elliptic"
    assert kind_of(np.array([2, 0.5], complex)) == "hyperbolic"
    assert kind_of(np.array([2, circle[0], 0.5, circle[1]])) == "mixed"
    assert kind_of(np.zeros(0, complex)) == "neutral"


def test_a_transversal_basis():
    basis = transversal_basis(np.array([[2.0, 1, 0, 0]]), np.array([0.0, 0, 1, 5]))
    np.testing.assert_allclose(basis.T @ basis, np.eye(2), atol=1e-15)
    np.testing.assert_allclose(basis.T @ np.array([[2.0, 1, 0, 0], [0, 0, 1, 5]]).T, 0, atol=1e-15)
