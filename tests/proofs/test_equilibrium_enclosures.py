"""Equilibria are proved on levels of the Casimirs: where they are, how many, and eigenvalues from formulas."""

import math

import numpy as np
import pytest
from flint import arb, ctx

import liepoisson as lp
from liepoisson.errors import EnclosureError, ParameterError, ShapeError
from liepoisson.proofs import equilibrium_enclosures
from liepoisson.proofs.polynomial_field import field_of_formulas

ARITHMETICS = ("intervals", "balls")
TOP = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/4 + l3^2/6 + alpha3", name="heavy top")
"""Moments 1, 2 and 3, its centre of mass on the third axis."""
LEVEL = {"C1": 0, "C2": 1}
BODY = lp.catalog.system("free-rigid-body")
HENON = lp.catalog.system("henon-heiles")
LORENZ = field_of_formulas({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"})


def has(boxes, exact):
    """Whether exactly one of some boxes contains an exact number each, compared in balls."""
    pairs = zip(boxes.lower.tolist(), boxes.upper.tolist(), strict=True)
    return sum(bool(arb(a) <= exact) and bool(exact <= arb(b)) for a, b in pairs) == 1


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_eigenvalues_of_the_upright_top(arithmetic):
    found = lp.proofs.prove_equilibrium(TOP, [0, 0.01, 0, 0, 0.02, 0.98], level=LEVEL, arithmetic=arithmetic)
    assert found.state.contains([0, 0, 0, 0, 0, 1])
    assert found.unique_within.contains(found.state)
    assert found.unique_within.width.min() > 0.01
    assert found.is_simple.all()
    # the pendulums about the first two axes: I_k theta'' = theta
    with ctx.workprec(100):
        for exact in (arb(1), arb(2).rsqrt(), -arb(1), -arb(2).rsqrt()):
            low, high = (exact - arb(2) ** -80).lower(), (exact + arb(2) ** -80).upper()
            assert (
                sum(
                    bool(arb(a) <= high) and bool(low <= arb(b))
                    for a, b in zip(found.eigenvalues_real.lower, found.eigenvalues_real.upper, strict=True)
                )
                == 1
            )
    assert found.eigenvalues_real.width.max() < 1e-14
    assert not found.eigenvalues_imaginary.width.any()


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_all_equilibria_of_a_rigid_body(arithmetic):
    (casimir,) = BODY.bracket.casimirs()
    level = casimir.subs(dict(zip(BODY.variables, (0, 0, 2), strict=True)))
    found = lp.proofs.enclose_equilibria(BODY, ([-3] * 3, [3, 3, 3.5]), level={"C1": str(level)}, arithmetic=arithmetic)
    assert found.is_complete
    assert len(found.equilibria) == 6
    for axis in range(3):
        for sign in (2, -2):
            exact = np.zeros(3)
            exact[axis] = sign
            (one,) = [e for e in found.equilibria if e.state.contains(exact)]
            # Euler's equations, moments 1, 2 and 5/2: l^2 (1/I_j - 1/I_k) (1/I_k - 1/I_i), about the axis k
            inverse = [1, 1 / 2, 2 / 5]
            i, j = (k for k in range(3) if k != axis)
            square = 4 * (inverse[i] - inverse[axis]) * (inverse[axis] - inverse[j])
            rates = one.eigenvalues_real if square > 0 else one.eigenvalues_imaginary
            assert np.sort(rates.midpoint) == pytest.approx([-math.sqrt(abs(square)), math.sqrt(abs(square))])


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_without_casimirs_the_level_is_the_phase_space(arithmetic):
    found = lp.proofs.enclose_equilibria(HENON, ([-2] * 4, [2] * 4), arithmetic=arithmetic)
    assert found.is_complete
    assert len(found.equilibria) == 4
    (saddle,) = [e for e in found.equilibria if e.state.contains([0, 1, 0, 0])]
    assert saddle.eigenvalues_real.contains([1, 0, 0, -1])
    with ctx.workprec(100):
        assert has(saddle.eigenvalues_imaginary, arb(3).sqrt())
    # those of a box that has two of them
    part = lp.proofs.enclose_equilibria(HENON, ([-0.5, -0.5, -1, -1], [0.5, 1.5, 1, 1]), arithmetic=arithmetic)
    assert (len(part.equilibria), part.is_complete) == (2, True)
    lorenz = lp.proofs.enclose_equilibria(LORENZ, ([-50] * 3, [50] * 3), arithmetic=arithmetic)
    assert (len(lorenz.equilibria), lorenz.is_complete) == (3, True)


def test_zeros_that_are_no_equilibria_are_left_out(monkeypatch):
    """F has zeros where the rows of P and the gradients depend on each other, and where f is not zero."""
    level = {"C1": 2}
    everything = ([-3] * 3, [3, 3, 3.5])
    found = lp.proofs.enclose_equilibria(BODY, everything, level=level)
    monkeypatch.setattr(equilibrium_enclosures._Problem, "may_be_at_rest", lambda *_: True)
    without = lp.proofs.enclose_equilibria(BODY, everything, level=level)
    assert len(found.equilibria) == 6
    assert found.is_complete
    assert len(without.equilibria) + len(without.undecided) > 6


def test_the_level_is_that_of_the_guess_if_none_is_given():
    found = lp.proofs.prove_equilibrium(TOP, [0, 0, 0, 0, 0, 1.5])
    assert dict(found.level) == {"C1": 0, "C2": 2.25}
    assert found.state.contains([0, 0, 0, 0, 0, 1.5])


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: prove(guess=[0, 0, 0, 1, 0, 0]), EnclosureError, "exactly one near"),
        (lambda: prove(guess=[0, 0, 0, 1, 0, 0], arithmetic="balls"), EnclosureError, "exactly one near"),
        (lambda: prove(guess=[0, 0, 0, 0, 0, math.nan]), ParameterError, "finite"),
        (lambda: prove(guess=[0, 0]), ShapeError, "6 components"),
        (lambda: prove(level={"C1": 0}), ParameterError, r"values of C1, C2; got C1; write level=\{'C1': ..."),
        (lambda: prove(level={"C1": 0, "C2": "sqrt(2)"}), ParameterError, "rational value of C2"),
        (lambda: prove(level=3), ParameterError, "level: wanted a mapping from names to values"),
        # the sphere of equilibria of a top without gravity and without spin
        (lambda: prove(system=FREE, guess=[0, 0, 0, 0, 0, 1]), EnclosureError, "a family"),
        (lambda: prove(system=FALSE, guess=[0, 0], level={"C": 1}), ParameterError, "C: wanted a constant of motion"),
        (lambda: every(level=None), ParameterError, "level: wanted values of C1, C2"),
        (lambda: every(time_limit=1e-9), EnclosureError, "time limit has passed"),
        (lambda: every(time_limit=1e-9, arithmetic="balls"), EnclosureError, "time limit"),
    ],
)
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error, match=words):
        call()


FALSE = field_of_formulas({"q": "p", "p": "-q"}, {"C": "q^2 + 2*p^2"})
FREE = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/4 + l3^2/6")


def prove(*, system=TOP, guess=(0, 0, 0, 0, 0, 0.9), level=LEVEL, **more):
    return lp.proofs.prove_equilibrium(system, list(guess), level=level, **more)


def every(*, box=([-2] * 6, [2] * 6), level=LEVEL, **more):
    return lp.proofs.enclose_equilibria(TOP, box, level=level, **more)
