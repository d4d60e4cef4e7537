"""Monodromy matrices in balls, against closed forms and ordinary numerical integration."""

import numpy as np
import pytest
import sympy as sp

from liepoisson.errors import ParameterError
from liepoisson.integrability import linear_system, monodromy
from liepoisson.integrability.galois.criteria import commutators
from liepoisson.integrability.galois.monodromy import continued, generators, loop_around_all

s = sp.Symbol("s")
SQUARE = [1, 1j, -1, -1j]


def hypergeometric(a, b, c):
    """The equation of Gauss for (f, f')."""
    a, b, c = map(sp.Rational, (a, b, c))
    return linear_system(sp.Matrix([[0, 1], [a * b / (s * (1 - s)), -(c - (a + b + 1) * s) / (s * (1 - s))]]), s)


@pytest.mark.parametrize("e", ["1/2", "-2/7"])
def test_a_power_is_multiplied_by_a_root_of_unity(e):
    found = monodromy(linear_system(sp.Matrix([[sp.Rational(e) / s]]), s), SQUARE)
    assert found.error < 1e-18
    assert abs(found.matrix[0, 0] - np.exp(2j * np.pi * float(sp.Rational(e)))) < 1e-14
    assert [w for _, w in found.windings] == [1]


def test_a_loop_the_other_way_gives_the_inverse():
    system = hypergeometric("1/3", "1/5", "1/7")
    loop = [0.5 + 0.5j, -0.5 + 0.5j, -0.5 - 0.5j, 0.5 - 0.5j]
    there, back = monodromy(system, loop), monodromy(system, [loop[0], *reversed(loop[1:])])
    assert abs(there.matrix @ back.matrix - np.eye(2)).max() < 1e-12
    assert sorted(w for _, w in back.windings) == [-1, 0]


def test_generators_have_the_exponents_and_their_product_those_of_infinity():
    system = hypergeometric("1/3", "1/5", "1/7")
    matrices = [continued(system, loop) for _, loop in generators(system)]
    for (f, _), found in zip(generators(system), matrices, strict=True):
        exponents = [float(e) for e in system.local(f).exponents.rational]
        wanted = np.poly(np.exp(2j * np.pi * np.array(exponents)))
        assert abs(np.poly(found.matrix) - wanted).max() < 1e-12
    around = matrices[1].matrix @ matrices[0].matrix
    wanted = np.poly(np.exp(-2j * np.pi * np.array([1 / 3, 1 / 5])))  # s^-a, s^-b
    assert abs(np.poly(around) - wanted).max() < 1e-12


def test_three_generators_in_their_order_go_around_all():
    # y' = sum of A_k / (s - s_k) y: the product of all has the eigenvalues of exp(2 pi i sum A_k)
    A = [sp.Matrix([[0, 1], [sp.Rational(1, 3), 0]]), sp.Matrix([[1, 0], [1, -1]]) / 5, sp.Matrix([[0, 2], [0, 0]])]
    system = linear_system(sum((a / (s - z) for a, z in zip(A, (0, 1, -2), strict=True)), sp.zeros(2)), s)
    around = np.eye(2)
    for _, loop in generators(system):
        around = continued(system, loop).matrix @ around
    total = np.array(sum(A, sp.zeros(2)), dtype=float)
    wanted = np.poly(np.exp(2j * np.pi * np.linalg.eigvals(total)))
    assert abs(np.poly(around) - wanted).max() < 1e-9
    outer = continued(system, loop_around_all(system, generators(system)[0][1]))
    assert abs(np.poly(outer.matrix) - wanted).max() < 1e-9
    assert [w for _, w in outer.windings] == [1, 1, 1]
    # It is the product itself from one of them on, and no conjugate of it: all have one base point, to the last digit.
    loops = [loop for _, loop in generators(system)]
    assert {loop.corners[0] for loop in (*loops, outer.loop)} == {loops[0].corners[0]}
    each = [continued(system, loop).matrix for loop in loops]
    products = [each[(k + 2) % 3] @ each[(k + 1) % 3] @ each[k] for k in range(3)]
    assert min(abs(product - outer.matrix).max() for product in products) < 1e-12


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([-1, 1, 1j], "goes through or very near to the singular point 0"),
        ([0, 1j, 1], "singular point"),
        ([1, 2], "at least 3"),
        ([1, 2, "x"], "finite complex numbers"),
        ([1, 2, float("nan")], "finite complex numbers"),
        ([1, 1, 1], "one point"),
        ([1e308, 1e308j, -1e308], "numbers up to"),
    ],
)
def test_loops_that_are_none_are_refused(corners, words):
    with pytest.raises(ParameterError, match=words):
        monodromy(linear_system(sp.Matrix([[1 / s]]), s), corners)


def test_diagonal_equations_commute_and_those_of_gauss_do_not():
    diagonal = linear_system(sp.diag(sp.Rational(1, 3) / s, sp.Rational(1, 2) / (s - 1)), s)
    found, left = commutators(diagonal)
    assert not left
    assert not any(c.is_proved for c in found)
    assert max(c.error for c in found) < 1e-9
    found, _ = commutators(hypergeometric("1/2", "1/2", "1"))  # complete elliptic integrals: G is SL(2)
    assert any(c.is_proved for c in found)


def test_finite_groups_are_no_obstruction():
    # the tetrahedral group, from the list of Schwarz: (1/4, -1/12; 2/3)
    found, left = commutators(hypergeometric("1/4", "-1/12", "2/3"))
    assert not left
    assert not any(c.is_proved for c in found)
