"""Curves of solutions: plane curves whose folds and crossings are known."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from liepoisson.numeric.curves import Curve, Follower
from liepoisson.numeric.run_options import RunOptions
from liepoisson.portable import linear

RUN = RunOptions.read()


@dataclass(frozen=True)
class Point:
    unknowns: np.ndarray
    units: np.ndarray
    residual: float


@dataclass(frozen=True)
class Plane(Curve[Point]):
    """f(x, y) = 0, followed in x; where f_y = 0 it has a fold, or another curve crosses it."""

    function: object
    gradient: object
    units: tuple[float, float] = (1.0, 1.0)
    ends_at: float = np.inf
    wall: float = np.inf

    def point(self, x, y):
        at = np.array([x, y]) * self.units
        return Point(at, np.array(self.units), abs(self.function(*(at / self.units))))

    def value(self, point):
        return float(point.unknowns[0])

    def solved(self, guess, near, aim):
        start = z = guess / self.units
        for _ in range(20):
            row, off = (aim, aim @ (z - start)) if np.ndim(aim) else ([1, 0], z[0] - aim / self.units[0])
            z = z - linear.pinv(np.array([self.gradient(*z), row]), rcond=1e-11) @ [self.function(*z), off]
        return self.point(*z)

    def null_space(self, point, n, *, least=1):
        x, y = point.unknowns / self.units
        if y > self.wall:
            raise linear.LinAlgError
        return linear.svd(np.array([self.gradient(x, y)]))[2][-n:] * self.units

    def tests(self, point, tangent):
        x, y = point.unknowns / self.units
        if x > self.ends_at:
            return {}
        return {"fold": tangent[:1], "branch": np.array([self.gradient(x, y)[1]]), "height": np.array([y - 0.7])}


CIRCLE = Plane(lambda x, y: x * x + y * y - 1, lambda x, y: (2 * x, 2 * y))
FORK = Plane(lambda x, y: y * (x - y * y), lambda x, y: (y, x - 3 * y * y))


def followed(curve, start, bound=None, increasing=None, most=60):
    follower = Follower(curve, curve.point(*start), 0.2)
    follower.turn_towards(bound, increasing)
    return follower.followed(bound, most, RUN, lambda point: point.unknowns / curve.units)


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e6, 1e-6)])
def test_folds_and_zeros_of_a_circle(units):
    circle = Plane(CIRCLE.function, CIRCLE.gradient, units)
    members, zeros, end = followed(circle, (0.0, -1.0))
    assert end == ""
    assert len(members) == 60
    np.testing.assert_allclose(linear.norm(members, axis=1), 1, rtol=1e-12)
    kinds = [zero.kind for zero in zeros]
    assert kinds[:5] == ["fold", "height", "height", "fold", "fold"]
    x = [zero.point.unknowns[0] / units[0] for zero in zeros[:4]]
    np.testing.assert_allclose(x, [1, np.sqrt(0.51), -np.sqrt(0.51), -1], rtol=1e-12)
    assert all(zero.is_located for zero in zeros)


def test_it_ends_at_the_wanted_value_and_turns_towards_it():
    members, zeros, end = followed(CIRCLE, (0.0, -1.0), bound=-0.5)
    assert (end, zeros, members[-1][0]) == ("the wanted value", (), -0.5)


def test_a_branch_is_left_and_seen_again_from_the_other_curve():
    """From the parabola x = y^2 the value turns where it crosses y = 0, and f_y comes back from zero."""
    _, (zero,), _ = followed(FORK, (-1.0, 0.0), bound=1.0)
    assert (zero.kind, zero.is_located) == ("branch", True)
    np.testing.assert_allclose(zero.point.unknowns, 0, atol=1e-12)
    follower = Follower(FORK, zero.point, 0.2)
    assert follower.leave(zero.tangent)
    members, _, _ = follower.followed(1.0, 60, RUN, lambda point: point.unknowns)
    np.testing.assert_allclose([x for x, _ in members], [y * y for _, y in members], atol=1e-12)
    _, zeros, _ = followed(FORK, (0.25, 0.5), increasing=False, most=20)
    assert [(zero.kind, zero.is_located) for zero in zeros] == [("branch", True)]
    np.testing.assert_allclose(zeros[0].point.unknowns, 0, atol=1e-12)
    assert abs(zeros[0].tangent[1]) == pytest.approx(1)


def test_it_ends_where_its_functions_do_not_exist():
    line = Plane(lambda x, y: y, lambda x, y: (0.0, 1.0), ends_at=0.5)
    members, zeros, end = followed(line, (0.0, 0.0))
    assert (end, zeros) == ("a singular level", ())
    assert 0.3 < members[-1][0] <= 0.5


def test_it_ends_before_points_that_have_no_tangent():
    """No point is taken whose neighbours cannot be followed: a tangent that is not a number is near to no other."""
    wall = Plane(lambda x, y: x - y, lambda x, y: (1.0, -1.0), wall=0.5)
    members, _, end = followed(wall, (0.0, 0.0))
    assert end == "the steps became too short"
    assert 0.49 < members[-1][1] <= 0.5


@dataclass(frozen=True)
class Blocked(Plane):
    is_final: bool = False

    def obstacle(self, first, last):
        return ("a stone", self.is_final) if last.unknowns[0] > 0.5 else ("", False)


@pytest.mark.parametrize(("is_final", "nearest"), [(False, 0.4999), (True, 0.3)])
def test_it_ends_before_an_obstacle(is_final, nearest):
    line = Blocked(lambda x, y: y, lambda x, y: (0.0, 1.0), is_final=is_final)
    members, _, end = followed(line, (0.0, 0.0))
    assert end == "a stone"
    assert nearest < members[-1][0] <= 0.5


def test_what_does_not_hold_is_no_member():
    """Beyond x = 1/2 there are no solutions."""
    half = Plane(lambda x, y: y if x < 0.5 else np.nan, lambda x, y: (0, 1))
    members, _, end = followed(half, (0.0, 0.0))
    assert end == "the steps became too short"
    assert 0.4999 < members[-1][0] < 0.5


@dataclass(frozen=True)
class Several(Plane):
    """The same, with so many points of each prediction, of which one may not hold."""

    together = 8
    spoiled: int = 8
    asked: tuple[list[int], ...] = ([], [])

    def ahead(self, guesses, last, direction, length):
        found = []
        for guess in guesses:
            point = self.solved(last.unknowns + length * direction, last, direction / last.units)
            if linear.norm(point.unknowns - guess) > 1e-3 or point.residual > 1e-12:
                break
            found.append(replace(point, residual=1.0) if len(found) == self.spoiled else point)
            if point.unknowns[1] > self.wall:
                break
            last, old = point, direction
            direction = self.null_space(point, 1)[0]
            direction = direction * np.sign(direction @ old)
        self.asked[0].append(len(guesses))
        self.asked[1].append(len(found))
        return found


AMID = {"folds": {}, "a singular level": {"ends_at": 0.9}, "no tangent": {"wall": 0.45}, "no point": {"spoiled": 1}}


@pytest.mark.parametrize("options", AMID.values(), ids=AMID)
def test_points_ahead_change_nothing(options):
    """Folds and zeros of the circle, a singular level and the last point with a tangent, amid what is predicted."""
    several = Several(CIRCLE.function, CIRCLE.gradient, asked=([], []), **options)
    shared = {name: value for name, value in options.items() if name != "spoiled"}
    alone = Plane(CIRCLE.function, CIRCLE.gradient, **shared)
    found = []
    for curve in (several, alone):
        follower = Follower(curve, curve.point(0.0, -1.0), 0.05)
        follower.turn_towards(None, None)
        found.append(follower.followed(None, 150, RUN, lambda point: point.unknowns))
    (members, zeros, end), (same, single, last) = found
    assert max(several.asked[1]) > 2
    assert max(several.asked[0]) <= 8
    np.testing.assert_allclose(members, same, atol=1e-12)
    assert (end, [(zero.kind, zero.after) for zero in zeros]) == (last, [(zero.kind, zero.after) for zero in single])
    for one, other in zip(zeros, single, strict=True):
        np.testing.assert_allclose(one.point.unknowns, other.point.unknowns, atol=1e-12)
        assert one.is_located
