"""Enclosures of the flow in balls: orbits that are integrated with more digits lie inside."""

import random

import pytest
from flint import arb, arb_mat

import liepoisson as lp
from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.proofs.balls.field import BallField, working
from liepoisson.proofs.balls.flow import Parallelepiped, advance, flow
from liepoisson.proofs.balls.lohner import Carried
from liepoisson.proofs.polynomial_field import polynomial_field

GAMMA = (
    -0.5849546905925892, 0, 0.8032794505793064, -0.09182806462693584, 0, 1.0321943875467073, 0.8296944816464006, 0,
    0.5582177595934320,
)  # fmt: skip


@pytest.fixture(scope="module")
def field():
    return BallField(polynomial_field(lp.Top.twisted_kovalevskaya()))


def cube(center, radius):
    n = len(center)
    unit = arb_mat([[arb(radius) if i == j else 0 for j in range(n)] for i in range(n)])
    return Parallelepiped([arb(c) for c in center], unit, [arb(0, 1)] * n)


def precise(field, x, time, steps, digits=200):
    """The orbit of one point with many more digits, in thin balls."""
    with working(digits):
        h = arb(time) / steps
        for _ in range(steps):
            coefficients = field.series(x, 40)
            x = [sum((c[i] * h**k for k, c in enumerate(coefficients)), arb(0)) for i in range(field.n)]
        return x


def test_random_points_of_a_set_arrive_inside_of_the_enclosure(field):
    rng, radius, time = random.Random(1), 1e-4, 1.5935
    with working():
        image, _ = flow(field, cube(GAMMA, radius), arb(time), 0.1)
        box = image.box()
    for _ in range(5):
        start = [arb(c + radius * rng.choice((-1, 1, rng.uniform(-1, 1)))) for c in GAMMA]
        end = precise(field, start, time, 20)
        assert all(b.contains(e.mid()) for b, e in zip(box, end, strict=True))


def test_a_box_contains_the_states_of_one_sided_ranges():
    with working():
        box = Carried.of([arb(1), arb(2)], arb_mat([[1, 0], [1, 1]]), [arb(0.5, 0.5), arb(-0.25, 0.25)]).box()
    for s, t in ((0, 0), (0, -0.5), (1, 0), (1, -0.5)):
        assert all(b.contains(arb(x)) for b, x in zip(box, (1 + s, 2 + s + t), strict=True)), (s, t)


def test_the_derivative_contains_difference_quotients(field):
    time, size = 0.1, 2.0**-60
    with working():
        image, _ = advance(field, cube(GAMMA, 1e-5), arb(time))
        derivative = image.matrix * arb(1e5)
    start = [arb(c) for c in GAMMA]
    with working(300):
        at = precise(field, start, time, 4, 300)
        for k in range(field.n):
            moved = precise(field, [c + size * (i == k) for i, c in enumerate(start)], time, 4, 300)
            slope = [(a - b) / size for a, b in zip(moved, at, strict=True)]
            for i, s in enumerate(slope):
                assert (derivative[i, k] + arb(0, 1e-12)).contains(s.mid()), (i, k)


def test_tubes_contain_the_orbit_between_the_steps(field):
    with working():
        _, tubes = flow(field, cube(GAMMA, 1e-6), arb(0.5), 0.1)
    for tube in tubes:
        middle = float(((tube.start + tube.end) / 2).mid())
        x = precise(field, [arb(c) for c in GAMMA], middle, 10)
        assert all(b.contains(v.mid()) for b, v in zip(tube.box, x, strict=True))


@pytest.mark.parametrize(
    ("size", "time", "step", "words"),
    [
        (3.0, 1.0, 0.5, "smaller"),
        (1e-5, -1.0, 0.1, "positive"),
        (1e-5, 1.0, 0.0, "positive"),
        (1e-5, float("nan"), 0.1, "positive"),
        (float("nan"), 0.1, 0.1, "."),
    ],
)
def test_sets_times_and_steps_that_do_not_fit_are_refused(field, size, time, step, words):
    with working(), pytest.raises(EnclosureError, match=words):
        flow(field, cube(GAMMA, size), arb(time), step)


@pytest.mark.parametrize(("term", "words"), [("- cos(q)", "polynomial"), ("+ sqrt(2)*q^2", "rational")])
def test_fields_must_be_polynomial_with_rational_numbers(term, words):
    with pytest.raises(ParameterError, match=words):
        polynomial_field(lp.System(lp.canonical(names=["q"]), f"p_q^2/2 {term}"))
