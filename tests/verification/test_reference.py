"""The reference integrator: a closed form, the bracket's own field, invariants, tangent vectors, the kept orbits."""

import json

import numpy as np
import pytest
from flint import arb

import liepoisson as lp
import reference
import reference_check
from problems import TOPS, invariants, starts

GENERAL = TOPS["general"]


@pytest.mark.parametrize("digits", [30, 50])
def test_free_rigid_body_follows_elliptic_functions(digits):
    """Euler's top, l = (A1 cn, A2 sn, A3 dn)(p t | m); see `reference_check.free_rigid_body`."""
    inertia, l0 = (3.0, 2.0, 1.0), (0.5, 0.0, 1.5)
    field = lp.fields.TopField(inertia=inertia, a=(0.0, 0.0, 0.0), b=(0.0, 0.0, 0.0), epsilon=0.0)
    found = reference.flow(field, [*l0, *[0.0] * 6], [5.0], digits=digits)[0][:3]
    exact = reference_check.free_rigid_body(inertia, l0, 5.0, digits=digits + 10)
    assert reference.agreed_digits(found, exact) >= digits - 1


def test_first_coefficients_are_the_field_of_the_bracket():
    """J grad H from the exact wing, for all parameters at once."""
    x0 = starts("general", 1)[0]
    series = reference._Top(GENERAL.field()).series([arb(c) for c in x0], 2)
    assert [float(row[1].mid()) for row in series] == pytest.approx(GENERAL.vector_field(x0), rel=1e-14)


def test_invariants_of_the_twisted_lagrange_top_are_kept():
    """H, C1..C3, l3 and P = l.alpha + epsilon I1 a3 beta3, to the last bit of 80-bit arithmetic."""
    top = TOPS["twisted Lagrange"]
    x0 = starts("twisted Lagrange", 1)
    high, low = reference.as_two_doubles(reference.flow(top.field(), x0[0], [7.0], digits=32))
    end = high.astype(np.longdouble) + low
    before, after = (invariants(top, x) for x in (x0, end))
    for name, value in before.items():
        assert abs(float(value[0] - after[name][0])) < 20 * np.finfo(np.longdouble).eps, name


@pytest.mark.thorough
def test_tangent_vector_is_the_derivative_of_the_flow():
    """Central differences at 1e-10: their error is near 1e-20 of the third derivative."""
    x0, v0 = starts("general", 1)[0], np.linspace(-1, 1, 9)
    (both,) = reference.flow(GENERAL.field(), [*x0, *v0], [2.0], digits=40)
    with reference.decimal_digits(40):
        delta = arb("1e-10")
        starts_beside = [[arb(x) + sign * delta * arb(v) for x, v in zip(x0, v0, strict=True)] for sign in (1, -1)]
        ends = [reference.flow(GENERAL.field(), start, [2.0], digits=40)[0] for start in starts_beside]
        difference = [(p - q) / (2 * delta) for p, q in zip(*ends, strict=True)]
    assert reference.agreed_digits(both[9:], difference) >= 17


@pytest.mark.thorough
def test_a_kept_orbit_is_computed_again():
    """The last one, at its first time, with other digits than it was made with."""
    record = json.loads(reference.FILE.read_text())["orbits"][-1]
    field = lp.fields.TopField(**{key: tuple(record[key]) for key in ("inertia", "a", "b")}, epsilon=record["epsilon"])
    point = record["at"][0]
    found = reference.flow(field, record["state"] + record["tangent"], [point["t"]], digits=45)[0]
    with reference.decimal_digits(45):
        exact = [arb(text) for text in point["state"] + point["tangent"]]
    assert reference.agreed_digits(found[:9], exact[:9]) >= 38 <= point["state digits"]
    assert reference.agreed_digits(found[9:], exact[9:]) >= 38 <= point["tangent digits"]


def test_digits_are_counted():
    first, second = [arb(1), arb("1.00001")], [arb(1), arb(1)]
    assert reference.agreed_digits(first, second) in (4, 5)
    assert reference.agreed_digits(second, second) == reference.STRICT_DIGITS
