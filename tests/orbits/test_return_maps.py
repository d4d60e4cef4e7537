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
        (lambda: lp.sections.return_map(HENON, "x", t_end=9, method=lp.methods.Gauss(step=0.1)), "wanted Taylor"),
        (lambda: P.cycles({}, -1), "energ"),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises(LiePoissonError, match=words):
        call()
