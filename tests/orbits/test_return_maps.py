"""Maps of first return: derivatives, areas, cycles and exponents, against closed forms and laws."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LiePoissonError

HENON = lp.catalog.system("henon-heiles")
TOP = lp.Top.twisted_kovalevskaya()
LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}
P = lp.sections.return_map(HENON, "x", t_end=100)
Q = lp.sections.return_map(TOP, lp.sections.good_surface(TOP), t_end=1000)


def test_a_rotation():
    """Between two returns to q1 = 0 the second oscillator turns by 2 pi omega."""
    omega = 0.7
    system = lp.System(lp.canonical(2), "(p1^2 + q1^2)/2 + (p2^2 + 49/100*q2^2)/2")
    turn = lp.sections.return_map(system, "q1", t_end=10)
    c, s = np.cos(2 * np.pi * omega), np.sin(2 * np.pi * omega)
    states = np.array([[0, 0.3, 1.0, 0.4], [0, -0.2, 0.5, 0.1]])
    wanted = [[c, s / omega], [-omega * s, c]]
    np.testing.assert_allclose(turn.derivative(states, ["q2", "p2"]), [wanted, wanted], atol=1e-13)
    np.testing.assert_allclose(turn(states).state[:, [1, 3]], states[:, [1, 3]] @ np.transpose(wanted), atol=1e-13)
    assert turn.derivative(states[0], ["q2", "p2"]).shape == (2, 2)
    assert turn.derivative(states[0]).shape == (4, 4)
    once = turn.exponents(states, 20)
    np.testing.assert_allclose(once.exponent, 0, atol=0.03)  # at most ln(1/omega) / 20
    np.testing.assert_allclose(once.time, 2 * np.pi, rtol=1e-13)


def lifted(y, p_y, energy):
    """The state on x = 0 with this energy."""
    return np.array([0, y, np.sqrt(2 * energy - y * y + 2 * y**3 / 3 - p_y * p_y), p_y])


def test_the_derivative_is_that_of_differences():
    energy, h = 0.1, 1e-5
    ends = [P(lifted(0.1 + a, 0.05 + b, energy)).state[[1, 3]] for a, b in ((h, 0), (-h, 0), (0, h), (0, -h))]
    wanted = np.array([ends[0] - ends[1], ends[2] - ends[3]]).T / (2 * h)
    np.testing.assert_allclose(P.derivative(lifted(0.1, 0.05, energy), ["y", "p_y"]), wanted, atol=1e-8)


@pytest.mark.parametrize(
    ("back", "coordinates"),
    [
        (P, ["y", "p_y"]),
        (P, ["y", "p_x"]),
        (Q, ["l1", "l3", "alpha1", "alpha2"]),
        (Q, ["l2", "atan2(l1, l3)", "alpha3", "beta1"]),
    ],
)
def test_areas_are_kept(back, coordinates):
    """|det dP| is the density at a state over that at its image; of a coordinate and its momentum it is 1."""
    if back is P:
        states = np.array([lifted(0.1, 0.05, 0.1), lifted(-0.2, 0.1, 0.12)])
    else:
        surface = lp.sections.good_surface(TOP)
        states = lp.sections.section_starts(lp.Leaf(TOP, LEVEL), surface, energy=0.5, n_starts=3, seed=3, direction=1)
    density = [back.density(x, coordinates) for x in (states, back(states).state)]
    found = np.abs(np.linalg.det(back.derivative(states, coordinates)))
    np.testing.assert_allclose(found, density[0] / density[1], rtol=1e-8)
    if coordinates == ["y", "p_y"]:
        np.testing.assert_allclose(density, 1, rtol=1e-14)


EQUAL_STEPS = {
    "midpoint": (P, lambda h: lp.methods.Gauss(step=h, order=2), 2),
    "gauss": (P, lambda h: lp.methods.Gauss(step=h, order=4), 4),
    "runge-kutta": (P, lambda h: lp.methods.RungeKutta(step=3 * h), 8),
    "splitting": (Q, lambda h: lp.Splitting(step=h, order=4), 4),
    "gauss of a top": (Q, lambda h: lp.methods.Gauss(step=h, order=4), 4),
}
"""A map, a method of equal steps, and its order."""


def of_equal_steps(name, step):
    back, method, _ = EQUAL_STEPS[name]
    surface = "x" if back is P else lp.sections.good_surface(TOP)
    return lp.sections.return_map(back.system, surface, t_end=back.t_end, method=method(step))


def states_of(back):
    if back.system is HENON:
        return np.array([lifted(0.03 * k, 0.05 - 0.02 * k, 0.1) for k in range(-5, 6)]), ["y", "p_x"]
    surface = lp.sections.good_surface(TOP)
    states = lp.sections.section_starts(lp.Leaf(TOP, LEVEL), surface, energy=0.5, n_starts=12, seed=3, direction=1)
    return states, ["l1", "l3", "alpha1", "alpha2"]


@pytest.mark.parametrize("name", EQUAL_STEPS)
def test_the_derivative_is_that_of_the_map_that_a_method_computes(name):
    """As differences of the same map say, which is 1e-3 and more from that of the flow."""
    back, h = of_equal_steps(name, 0.2), 1e-5
    for x in states_of(back)[0][:2]:
        slope = back.surface.gradient(x)
        along = np.eye(len(x)) - np.outer(slope, slope) / (slope @ slope)  # along the section
        wanted = np.array([(back(x + h * e).state - back(x - h * e).state) / (2 * h) for e in along]).T
        np.testing.assert_allclose(back.derivative(x) @ along, wanted, atol=1e-6)


@pytest.mark.parametrize("name", EQUAL_STEPS)
def test_images_and_areas_are_those_of_the_flow_to_the_order_of_the_method(name):
    """The last step has any length up to the others, and its own error: of many states one is near the largest."""
    exact, _, order = EQUAL_STEPS[name]
    states, coordinates = states_of(exact)
    errors = []
    for step in (0.2, 0.1):
        back = of_equal_steps(name, step)
        once = back(states)
        assert np.abs(back.surface(once.state)).max() < 1e-14
        area = np.abs(np.linalg.det(back.derivative(states, coordinates)))
        ratio = back.density(states, coordinates) / back.density(once.state, coordinates)
        errors.append([np.abs(once.state - exact(states).state).max(), np.abs(area / ratio - 1).max()])
    rates = np.log2(np.array(errors[0]) / errors[1])
    assert (np.array(errors[0]) < 0.2).all(), errors
    assert ((rates > order - 0.7) | (np.array(errors[1]) < 1e-10)).all(), (rates, errors)


@pytest.mark.parametrize("name", EQUAL_STEPS)
def test_the_map_of_a_method_is_an_orbit_and_has_an_inverse_and_exponents(name):
    back = of_equal_steps(name, 0.05)
    states = states_of(back)[0][:2]
    once, run = back(states), back.orbit(states, 3)
    np.testing.assert_allclose(run.state[run.time < np.repeat(once.time, 3) + 1e-9], once.state, atol=1e-12)
    inverse = lp.sections.return_map(
        back.system, back.surface.expression, t_end=-back.t_end, direction=-1, method=back.method
    )
    np.testing.assert_allclose(inverse(once.state).state, states, atol=1e-3)
    found, exact = back.exponents(states, 4), EQUAL_STEPS[name][0].exponents(states, 4)
    np.testing.assert_allclose(found.exponent, exact.exponent, atol=0.01)
    np.testing.assert_array_equal(lp.rerun(once.dataset).state, once.state)


@pytest.mark.parametrize(("name", "n_points"), [("midpoint", 1), ("gauss", 1), ("gauss", 5), ("runge-kutta", 1)])
def test_cycles_of_a_method_are_those_of_the_flow_to_its_order(name, n_points):
    order = EQUAL_STEPS[name][2]
    energy, errors = 1 / 12 if n_points == 1 else 1 / 8, []
    exact = P.cycles({}, energy, n_points=n_points, n_starts=30)
    for step in (0.1, 0.05):
        back = of_equal_steps(name, step)
        found = back.cycles({}, energy, n_points=n_points, n_starts=30)
        assert len(found) == len(exact) > 0
        assert found.method == back.method
        errors.append(max(abs(a.period - b.period) for a, b in zip(found, exact, strict=True)))
        for one, points in zip(found, found.points, strict=True):
            assert len(points) == n_points
            np.testing.assert_allclose(back(points).state, np.roll(points, -1, axis=0), atol=10 * one.residual + 1e-12)
            np.testing.assert_allclose(HENON.functions.energy(points[0]), energy, rtol=1e-11)
    assert np.log2(errors[0] / errors[1]) > order - 0.5 or errors[1] < 1e-11, errors


def test_cycles_of_a_splitting():
    exact = Q.cycles(LEVEL, "1/2", n_starts=20)
    found = of_equal_steps("splitting", 0.02).cycles(LEVEL, "1/2", n_starts=20)
    assert len(found) == len(exact) > 0
    for one, other in zip(found, exact, strict=True):
        assert one.period == pytest.approx(other.period, rel=1e-5)
        np.testing.assert_allclose(abs(one.multipliers[0]), abs(other.multipliers[0]), rtol=1e-3)


def test_the_inverse_map():
    start = lifted(0.1, 0.05, 0.1)
    inverse = lp.sections.return_map(HENON, "x", t_end=-100, direction=-1)
    image = P(start).state
    np.testing.assert_allclose(inverse(image).state, start, atol=1e-13)
    product = inverse.derivative(image, ["y", "p_y"]) @ P.derivative(start, ["y", "p_y"])
    np.testing.assert_allclose(product, np.eye(2), atol=1e-11)


def test_cycles_return_in_their_order():
    found = P.cycles({}, "1/8", n_points=5, n_starts=60)
    assert len(found) > 5
    for one, points in zip(found, found.points, strict=True):
        np.testing.assert_allclose(P(points).state, np.roll(points, -1, axis=0), atol=1e-9)
        matrix = np.linalg.multi_dot(P.derivative(points, ["y", "p_y"])[::-1])
        np.testing.assert_allclose(np.trace(matrix), one.multipliers.sum().real, rtol=1e-7)
        np.testing.assert_allclose(HENON.functions.energy(points), 0.125, atol=1e-13)
    table = found.to_dataframe()
    assert table.point_y.tolist() == [points[0, 1] for points in found.points]
    assert np.all(np.diff([one.rate * one.period for one in found]) < 1e-6)


def test_the_exponents_of_a_fixed_point_are_its_multipliers():
    found = P.cycles({}, "1/12", n_starts=40)
    assert "fixed points on H = 1/12" in repr(found)
    grown = P.exponents(found.points[0], 12)
    wanted = np.log(found[0].multipliers[0].real)
    np.testing.assert_allclose(grown.exponent.sum(), 0, atol=1e-9)
    np.testing.assert_allclose(grown.exponent[0, 0], wanted, atol=np.log(30) / 12)  # the frame turns first
    np.testing.assert_allclose(grown.time, found[0].period, rtol=1e-10)
    both = P.exponents(found.points[0], 4).exponent[0, 0] * 4, grown.exponent[0, 0] * 12
    assert (both[1] - both[0]) / 8 == pytest.approx(wanted, rel=1e-3)


def test_in_more_dimensions():
    found = Q.cycles(LEVEL, "1/2", n_starts=40)
    fixed = found.points[0][0]  # of a reversal of time, which keeps l1 and alpha2
    assert np.isnan(Q.derivative(fixed, ["l1", "l3", "alpha1", "alpha2"])).all()
    values = np.linalg.eigvals(Q.derivative(fixed, ["l1 + l2", "l3 - alpha2", "alpha3 + beta1", "beta2"]))
    np.testing.assert_allclose(sorted(values, key=abs), sorted(found[0].multipliers, key=abs), atol=1e-9)


def test_what_does_not_return_has_no_derivative():
    free = lp.System(lp.canonical(2), "(p1^2 + p2^2)/2 - q1^2/2")
    back = lp.sections.return_map(free, "q1", t_end=5)
    assert back([0, 0, 1, 1]).outcome == "no return"
    assert np.isnan(back.derivative([0, 0, 1, 1])).all()
    with pytest.raises(LiePoissonError, match="wanted 3 returns; state 0 has 0: no return"):
        back.exponents([0, 0, 1, 1], 3)
    with pytest.raises(LiePoissonError, match="must return 1 times; none does before t = 5"):
        back.cycles({}, 1, n_starts=3)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lp.sections.return_map(HENON, "x", t_end=9, direction=0), "one side of the surface"),
        (lambda: lp.sections.return_map(TOP, "C1", t_end=9), "constant on each leaf"),
        (lambda: lp.sections.return_map(HENON, "x", t_end=0), "t_end"),
        (lambda: P.derivative(lifted(0, 0, 0.1), ["y"]), "wanted 2, as the section of a level has dimensions; got 1"),
        (lambda: P.derivative(lifted(0, 0, 0.1), {"y", "p_y"}), "coordinates"),
        (lambda: P.density(lifted(0, 0, 0.1), "y"), "coordinates"),
        (lambda: P.cycles({}, 0.1, n_points=0), "n_points"),
        (lambda: lp.sections.return_map(HENON, "x", t_end=9, method=lp.methods.RungeKutta()), "or a method of equal"),
        (
            lambda: lp.sections.return_map(TOP, "l1", t_end=9, method=lp.Splitting(step=0.1, precision="single")),
            "in double precision",
        ),
        (lambda: P.cycles({}, -1), "energ"),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises(LiePoissonError, match=words):
        call()
