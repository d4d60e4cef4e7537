"""Boxes contain what they were made of, exactly, and refuse what is empty."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb

import liepoisson as lp
from liepoisson.errors import EnclosureError, ParameterError, ShapeError
from liepoisson.proofs.balls.field import working
from liepoisson.proofs.rigorous import down, up


def test_texts_and_fractions_are_rounded_outward():
    box = lp.proofs.Box(["1/3", Fraction(1, 10), 2], ["1/3", 0.5, 2])
    assert Fraction(box.lower[0]) < Fraction(1, 3) < Fraction(box.upper[0])
    assert box.upper[0] == math.nextafter(box.lower[0], 1)
    assert Fraction(box.lower[1]) < Fraction(1, 10)
    assert (box.lower[2], box.upper[2]) == (2, 2)


def test_a_box_around_a_center_contains_what_is_that_near():
    # 0.1 + 0.2 is rounded in doubles; the box must contain the exact sum
    box = lp.proofs.Box.around([0.1], 0.2)
    assert Fraction(box.upper[0]) >= Fraction(0.1) + Fraction(0.2)
    assert Fraction(box.lower[0]) <= Fraction(0.1) - Fraction(0.2)
    assert Fraction(box.width[0]) >= Fraction(box.upper[0]) - Fraction(box.lower[0])
    assert box.width[0] < 0.4 + 1e-15


def test_membership_is_exact_and_nan_never_belongs():
    box = lp.proofs.Box([0.0, -1.0], [1.0, 1.0])
    assert box.contains([1.0, -1.0])
    assert not box.contains([np.nextafter(1.0, 2), 0])
    assert not box.contains([np.nan, 0])
    assert not box.contains([np.inf, 0])
    assert not box.overlaps(([2.0, 0.0], [np.inf, 1.0]))
    assert box.contains(["1/3", "-1/7"])
    assert box.contains(([0.5, 0.0], [1.0, 0.5]))
    assert not box.contains(([0.5, 0.0], [1.5, 0.5]))
    assert not lp.proofs.Box([0.5], [1.0]).contains(["1/3"])
    assert box.overlaps(([1.0, 0.0], [2.0, 0.0]))
    assert not box.overlaps(([1.5, 0.0], [2.0, 0.0]))


def test_what_is_printed_lies_outside():
    box = lp.proofs.Box([0.123456789012345], [0.123456789099999])
    low, high = (Fraction(part) for part in repr(box).removeprefix("Box([").removesuffix("])").split(", "))
    assert low <= Fraction(box.lower[0]) < Fraction(box.upper[0]) <= high


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: lp.proofs.Box([1.0], [0.0]), ParameterError, "empty box"),
        (lambda: lp.proofs.Box([np.nan], [0.0]), ParameterError, "wanted finite numbers; got"),
        (lambda: lp.proofs.Box([0.0], [np.inf]), ParameterError, "wanted finite numbers"),
        (lambda: lp.proofs.Box([0.0], [0.0, 1.0]), ShapeError, "one shape"),
        (lambda: lp.proofs.Box(["sqrt(2)"], [2]), ParameterError, "rational numbers or doubles"),
        (lambda: lp.proofs.Box.around([0.0], -1), ParameterError, "not negative"),
        (lambda: lp.proofs.Box.around([0.0, 1.0], [1, 2, 3]), ShapeError, r"shape \(2,\)"),
        (lambda: lp.proofs.Box([0.0], [1.0]).contains([0.0, 1.0]), ShapeError, r"wanted shape \(1,\)"),
    ],
)
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_doubles_around_balls_are_on_the_outer_side():
    with working(200):
        for ball in (arb(1) / 3, -arb(1) / 3, arb(2).sqrt(), arb(0, "1e-30"), arb("1e-320")):
            assert arb(down(ball)) <= ball.lower()
            assert arb(up(ball)) >= ball.upper()
        with pytest.raises(EnclosureError, match="not finite"):
            up(arb("nan"))
        with pytest.raises(EnclosureError, match="range of doubles"):
            up(arb(10) ** 400)
