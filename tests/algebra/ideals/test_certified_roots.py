"""Real roots with proofs, against polynomials whose roots are known."""

import numpy as np
import pytest
from flint import Ordering, arb, fmpq, fmpq_mpoly_ctx, fmpq_poly

from liepoisson.algebra.ideals.certified_roots import (
    UndecidedError,
    ball,
    enclosures,
    precision,
    real_roots,
    resultant,
    unique_zero,
)


def with_roots(*roots):
    total = fmpq_poly([1])
    for root in roots:
        total *= fmpq_poly([-fmpq(root), 1])
    return total


def test_real_roots_are_distinct_and_complex_ones_are_left_out():
    p = with_roots(1, 1, 1, -2, fmpq(1, 3)) * fmpq_poly([1, 0, 1]) ** 2
    assert sorted(float(r.mid()) for r in real_roots(p)) == pytest.approx([-2, 1 / 3, 1])
    assert real_roots(fmpq_poly([5])) == []


def test_close_roots_are_told_apart():
    with precision(128):
        gap = fmpq(1, 10**30)
        assert len(real_roots(with_roots(1, 1 + gap))) == 2
        assert len(real_roots(fmpq_poly([1 + gap, -2, 1]))) == 0  # (x - 1)^2 + 1e-30


def test_resultant_vanishes_at_the_first_coordinates_of_common_zeros():
    s, t = fmpq_mpoly_ctx.get(("s", "t"), Ordering.lex).gens()
    circle, line = s**2 + t**2 - 25, t - s / 3 * 4
    assert sorted(float(r.mid()) for r in real_roots(resultant(circle, line))) == pytest.approx([-3, 3])
    without_t = resultant(circle, s - 4 + 0 * t)
    assert {float(r.mid()) for r in real_roots(without_t)} == {4.0}


@pytest.mark.parametrize("roots", [(0, 1, -1), (fmpq(1, 2), fmpq(1, 2)), (7, 1000, -3, -3), (fmpq(1, 7),) * 4])
def test_enclosures_contain_every_zero_and_little_else(roots):
    with precision(128):
        p = with_roots(*roots) * fmpq_poly([1, 1, 1])
        found = enclosures([ball(c) for c in p.coeffs()])
        for root in roots:
            assert any(cell.contains(root) for cell in found)
        for cell in found:
            assert min(abs(float(cell.mid()) - float(fmpq(r).p) / float(fmpq(r).q)) for r in roots) < 1e-6 * max(
                1, abs(float(cell.mid())) ** 2
            )


def test_a_zero_at_infinity_is_not_passed_over():
    with pytest.raises(UndecidedError):
        enclosures([arb(1), arb(1), arb(0, 1e-30)])


def on_circle_and_line(box):
    x, y = box
    return [x * x + y * y - 1, x - y], [[2 * x, 2 * y], [arb(1), arb(-1)]]


def test_krawczyk_proves_one_zero_or_none_and_refuses_a_double_one():
    root = np.sqrt(0.5)
    near = [arb(root, 1e-6), arb(root, 1e-6)]
    proved = unique_zero(on_circle_and_line, near)
    assert proved is not None
    assert all(x.rad() < 1e-6 and abs(float(x.mid()) - root) < 1e-12 for x in proved)
    assert unique_zero(on_circle_and_line, [arb(0.5, 1e-3), arb(0.5, 1e-3)]) is None

    def touching(box):
        x, y = box
        return [x * x + y * y - 1, x - 1], [[2 * x, 2 * y], [arb(1), arb(0)]]

    with pytest.raises(UndecidedError):
        unique_zero(touching, [arb(1, 1e-6), arb(0, 1e-6)])
