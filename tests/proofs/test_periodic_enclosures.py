"""Periodic orbits are proved on their level; periods and multipliers are those of forty digits and of formulas."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

import liepoisson as lp
from liepoisson import _core
from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.proofs.balls import periodic as ball_periodic
from liepoisson.proofs.balls.field import BallField, working
from liepoisson.proofs.balls.lohner import How
from liepoisson.proofs.balls.periodic import Chain
from liepoisson.proofs.polynomial_field import field_of_formulas, polynomial_field

ARITHMETICS = ("intervals", "balls")
HENON = lp.catalog.system("henon-heiles")
LORENZ = field_of_formulas({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"})
LEVEL = {"H": "1/10"}


@pytest.fixture(scope="module")
def symmetric():
    return lp.orbits.symmetric_periodic_orbits(HENON, {}, energy="1/10", n_starts=10)[0]


@pytest.fixture(scope="module")
def both(symmetric):
    start, period = symmetric.start, symmetric.period
    return {
        a: lp.proofs.prove_periodic_orbit(HENON, start, period=period, level=LEVEL, arithmetic=a, precision=96)
        for a in ARITHMETICS
    }


@pytest.fixture(params=ARITHMETICS)
def proved(request, both):
    return both[request.param]


def between(bounds, exact):
    return bool(arb(float(bounds[0])) <= exact) and bool(exact <= arb(float(bounds[1])))


def test_period_and_state_are_those_of_forty_digits(proved, symmetric):
    precise = symmetric.polished(digits=40)
    segments = round(symmetric.period / float(precise.time))
    with ctx.workprec(200):
        assert between(proved.period, (segments * arb(precise.time)).mid())
    assert np.abs(proved.states.midpoint[0] - symmetric.start).max() < 1e-10
    assert proved.period[1] - proved.period[0] < 1e-11
    assert proved.unique_radius > proved.states.width.max() / 2
    assert dict(proved.level) == {"H": Fraction(1, 10)}


def test_multipliers_come_in_pairs_and_agree_with_the_search(proved, symmetric):
    real, imaginary = proved.multipliers_real, proved.multipliers_imaginary
    assert proved.is_simple.all()
    assert not imaginary.width.any()
    product = (real.lower.prod(), real.upper.prod())
    assert min(product) - 1e-9 < 1 < max(product) + 1e-9
    segments = round(symmetric.period / symmetric.time)  # the loop of the search is closed by a symmetry
    wanted = np.sort(np.real(symmetric.multipliers) ** (segments / 2))
    assert np.sort(real.midpoint) == pytest.approx(wanted, rel=1e-6)


def test_both_arithmetics_agree(both):
    first, second = both.values()
    assert max(first.period[0], second.period[0]) <= min(first.period[1], second.period[1])
    for k in range(2):
        assert any(first.multipliers_real[k].overlaps(second.multipliers_real[j]) for j in range(2))
    assert second.unique_radius >= first.unique_radius


def test_the_shortest_orbit_of_lorenz():
    """Viswanath (2004): 1.558652210716175; not a Hamiltonian system."""
    start = [-13.7636106821342, -19.5787519424518, 27.0]
    found = lp.proofs.prove_periodic_orbit(LORENZ, start, period=1.55865)
    assert found.period[0] < 1.558652210716175 < found.period[1]
    assert found.period[1] - found.period[0] < 1e-11
    assert any(
        a < 4.712947273 < b for a, b in zip(found.multipliers_real.lower, found.multipliers_real.upper, strict=True)
    )
    assert not found.level


def chain(symmetric):
    how = How(order=24, step=10.0, precision=96)
    field = BallField(polynomial_field(HENON))
    return Chain(field, [symmetric.start], [symmetric.period], level=[arb(1) / 10], reach=1e-2, how=how)


def test_a_box_that_is_not_mapped_into_its_interior_proves_nothing(monkeypatch, symmetric):
    monkeypatch.setattr(Chain, "_krawczyk", lambda _self, _passages, boxes, _middle: boxes)
    monkeypatch.setattr(ball_periodic, "_RADII", (1e-10,))
    with working(96), pytest.raises(EnclosureError, match="into itself"):
        chain(symmetric).prove()


def test_the_derivative_on_a_level_is_that_of_difference_quotients(symmetric):
    """Away from the center of the chart, where the level is not orthogonal to the gradients of the center."""
    h, size = 2.0**-30, 2.0**-8
    with working(96):
        sections = chain(symmetric)
        q = [arb(size), arb(-size)]
        at = sections._pass(0, 0, q, q)
        for k in range(2):
            moved = [c + h * (i == k) for i, c in enumerate(q)]
            image = sections._pass(0, 0, moved, moved).offset
            for i in range(2):
                slope = float(((image[i] - at.offset[i]) / h).mid())
                error = 1e-6 + float(at.derivative[i, k].rad())
                assert error < 1e-3
                assert abs(slope - float(at.derivative[i, k].mid())) < error, (i, k)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: prove(period=5.0), EnclosureError, "comes back to after the period 5"),
        (lambda: prove(start=[0.3, 0.1, 0.2, -0.1], period=6.3), EnclosureError, "not proved|comes back"),
        (lambda: prove(start=[0, 0, 0, 0]), EnclosureError, "equilibrium|singular"),
        (lambda: prove(period=0), ParameterError, "period"),
        (lambda: prove(level={"H": 1, "C1": 1}), ParameterError, "values of H; got H, C1"),
        (lambda: prove(n_sections=0), ParameterError, "n_sections"),
        (
            lambda: prove(system=lp.catalog.system("free-rigid-body"), start=[1, 1, 1]),
            ParameterError,
            "three dimensions",
        ),
        # every orbit of two equal oscillators is periodic: none is isolated
        (lambda: prove(system=EQUAL, start=[1, 0, 0, 0.5], period=2 * math.pi), EnclosureError, "isolated"),
        (
            lambda: prove(system=EQUAL, start=[1, 0, 0, 0.5], period=2 * math.pi, arithmetic="balls"),
            EnclosureError,
            "isolated",
        ),
    ],
)
def test_refusals_say_what_was_wanted(call, error, words):
    with pytest.raises(error, match=words):
        call()


EQUAL = lp.System(lp.canonical(2), "dot(p, p)/2 + dot(q, q)/2", name="equal oscillators")


def prove(*, system=HENON, start=(0, 0.1, 0.3, 0.1), period=6.0, level=None, **more):
    return lp.proofs.prove_periodic_orbit(system, list(start), period=period, level=level, **more)


def test_what_the_core_does_not_know_proves_nothing(monkeypatch, symmetric):
    whole = _core.enclose_periodic_orbit

    def unknown(*arguments):
        found = whole(*arguments)
        found["times_upper"][0] = math.nan
        return found

    monkeypatch.setattr(_core, "enclose_periodic_orbit", unknown)
    with pytest.raises(ParameterError, match="finite"):
        prove(start=symmetric.start, period=symmetric.period)
