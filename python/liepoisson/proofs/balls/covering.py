r"""Does one set cover another, with cone conditions? The Poincaré map between two sets, enclosed and judged, in balls.

The image of set i after the time T, perhaps followed by the symmetry, crosses the section of set j near T. In the
coordinates of set j it is $q' = q'_0 + R\,q$ with $|q_u|, |q_s| \le 1$, where R has blocks uu, us, su, ss. With
$K = uu^{-1}$ and Euclidean norms the set i covers the set j if

- $(1 - |K q'_{0,u}| - |K||us|)/|K| > 1$: the part with $|q_u| = 1$ is mapped outside, all the way round, and
- $|q'_{0,s}| + |su| + |ss| < 1$: the image lies inside in the stable directions;

and differences of orbits grow in $Q = |q_u|^2 - |q_s|^2$ if, with $a = 1/|K|$,

- $(a^2 - |su|^2 - 1)(1 + |us|^2 - |ss|^2) > (a|us| + |su||ss|)^2$ with both factors positive.

References: P. Zgliczynski and M. Gidea, Covering relations for multidimensional dynamical systems, J. Differential
Equations 202 (2004) 32; P. Zgliczynski, Covering relations, cone conditions and the stable manifold theorem, J.
Differential Equations 246 (2009) 1774.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, lies_inside, magnitude, norm
from liepoisson.proofs.balls.flow import Parallelepiped, Tube, column, flow
from liepoisson.proofs.balls.sets import LARGEST_W, BallSet, Chart, states_of

LARGEST_STEP = 0.1


@dataclass(frozen=True)
class Landing:
    """Where orbits cross the section of a set.

    Attributes:
        offset: The image of the center of the chart, q'_0.
        slopes: R, the derivative over the set, a matrix with a row and a column for each coordinate q.
        q: A box of all images.
        w: A box of their coordinates w.
        time: The times that are left until they cross.
        window: Each orbit crosses exactly once at times of at most this size.
        box: A box that contains the orbits at these times.
    """

    offset: Vector
    slopes: arb_mat
    q: Vector
    w: Vector
    time: arb
    window: arb
    box: Vector


@dataclass(frozen=True)
class Transition:
    """The Poincaré map from one set to the section of another.

    Attributes:
        landing: The images.
        time: The flight times.
        tubes: Boxes on the way, in the frame of the start, before the symmetry.
    """

    landing: Landing
    time: arb
    tubes: tuple[Tube, ...]


@dataclass(frozen=True)
class CoveringMargins:
    """How far the conditions of a covering hold.

    Attributes:
        expansion: The least |q'_u| of images with |q_u| = 1; above 1.
        contraction: The largest |q'_s| of images; below 1.
        cone: The left side of the cone condition minus the right side; positive.
    """

    expansion: arb
    contraction: arb
    cone: arb


def transition(
    field: BallField,
    source: BallSet,
    proved: Chart,
    target: BallSet,
    *,
    time: arb,
    signs: Sequence[int] | None = None,
) -> Transition:
    """The Poincaré map of a set to the section of another set, near a time.

    Args:
        field: The equations.
        source: The set where the orbits start.
        proved: Its chart over |q_i| <= 1.
        target: The set whose section it is.
        time: When they are near the section.
        signs: The symmetry that follows, if one does.

    Raises:
        EnclosureError: the orbits do not provably cross the section once.
    """
    end, tubes = flow(field, states_of(source, proved, source.unit), time, LARGEST_STEP)
    found = landing(field, end if signs is None else end.mapped(diagonal(signs)), proved, target)
    last = found.box if signs is None else [s * b for s, b in zip(signs, found.box, strict=True)]
    whole = Tube(time - found.window, time + found.window, last)  # the symmetry is its own inverse
    return Transition(found, time + found.time, (*tubes, whole))


def landing(field: BallField, states: Parallelepiped, proved: Chart, target: BallSet) -> Landing:
    """Where the orbits of states that are near the section of a set cross it.

    Args:
        field: The equations.
        states: The image of a set; its coordinates are q and w.
        proved: The chart of that set.
        target: The set whose section it is.

    Raises:
        EnclosureError: the orbits do not provably cross the section once.
    """
    window, box = _window(field, states, target)
    rates = field.rates(box)
    speed = crossing_rate(field, target, box)
    center_time = -_product(target.normal, _difference(states.center, target.center)) / speed
    center = [c + center_time * f for c, f in zip(states.center, rates, strict=True)]
    at_center = column(target.inverse * as_column(_difference(center, target.center)))
    derivative = _derivative(field, states.matrix, target, box, window)
    n_q, q_columns = 2 * target.k, target.q_columns
    by_q, by_w = _columns(derivative, range(n_q)), _columns(derivative, range(n_q, derivative.ncols()))
    from_middle = as_column(_difference(proved.w_center, proved.middle))
    offset = [a + b for a, b in zip(at_center, column(by_w * from_middle), strict=True)]
    slopes = by_q + by_w * proved.slopes
    everywhere = [o + c for o, c in zip(offset, column(slopes * as_column(states.ranges[:n_q])), strict=True)]
    rows = slopes.tolist()
    return Landing(
        offset=[offset[k] for k in q_columns],
        slopes=arb_mat([rows[k] for k in q_columns]),
        q=[everywhere[k] for k in q_columns],
        w=[everywhere[k] for k in target.w_columns],
        time=-_gap(states, target) / speed,
        window=window,
        box=box,
    )


def covering(name: str, found: Landing) -> CoveringMargins:
    """Judge the images of a set.

    Raises:
        EnclosureError: a condition fails; the message names it.
    """
    rows, k = found.slopes.tolist(), found.slopes.nrows() // 2
    uu, us = (arb_mat([row[j : j + k] for row in rows[:k]]) for j in (0, k))
    su, ss = (norm2(arb_mat([row[j : j + k] for row in rows[k:]])) for j in (0, k))
    try:
        K = uu.inv()
    except ZeroDivisionError as error:
        raise EnclosureError(f"{name}: the unstable block of the derivative may be singular") from error
    size, us_norm = norm2(K), norm2(us)
    expansion = (1 - length(column(K * as_column(found.offset[:k]))) - size * us_norm) / size
    contraction = length(found.offset[k:]) + su + ss
    a = 1 / size
    first, second = a**2 - su**2 - 1, 1 + us_norm**2 - ss**2
    cone = first * second - (a * us_norm + su * ss) ** 2
    for holds, what in (
        (expansion > 1, f"covering fails: the image reaches out to {_shown(expansion)} only, wanted above 1"),
        (
            contraction < 1,
            f"covering fails: the image has stable coordinates up to {_shown(contraction)}, wanted below 1",
        ),
        (first > 0 and second > 0 and cone > 0, f"the cone condition fails: its margin is {_shown(cone)}"),
        (all(magnitude(w) < LARGEST_W for w in found.w), "the image leaves the region where w is unique"),
    ):
        if not holds:
            raise EnclosureError(f"{name}: {what}")
    return CoveringMargins(expansion, contraction, cone)


def norm2(matrix: arb_mat) -> arb:
    """An upper bound of the norm of a 1 x 1 or 2 x 2 matrix: that of its midpoint, and the Frobenius norm of the rest.

    Raises:
        EnclosureError: it is larger.
    """
    if matrix.nrows() == 1:
        return length(matrix.entries())
    if matrix.nrows() != 2:
        raise EnclosureError(f"a norm: wanted one or two unstable directions; got {matrix.nrows()}")
    middle = matrix.mid()
    (a, b), (c, d) = middle.tolist()
    squares, determinant = a**2 + b**2 + c**2 + d**2, a * d - b * c
    discriminant = squares**2 - 4 * determinant**2
    largest = ((squares + discriminant.nonnegative_part().sqrt()) / 2).sqrt()
    rest = length([e - m for e, m in zip(matrix.entries(), middle.entries(), strict=True)])
    return arb((largest + rest).upper())


def length(vector: Sequence[arb]) -> arb:
    """An upper bound of the Euclidean length."""
    return arb(sum((magnitude(e) ** 2 for e in vector), arb(0)).sqrt().upper())


def _derivative(field: BallField, matrix: arb_mat, target: BallSet, box: Vector, window: arb) -> arb_mat:
    r"""B^-1 times the derivative of the map to the section, for crossings within the window of time.

    The derivative of the flow for a time $|\tau| \le \delta$ is $1 + \tau\,Df$ and at most
    $e^{\delta|Df|} - 1 - \delta|Df|$ more; the map to the section then projects along f, by $1 - f n^T/(n\cdot f)$.
    Products are formed from the right, where the large entries of $B^{-1}$ meet differences that are small.
    """
    rates, jacobian = field.rates(box), field.jacobian(box)
    speed = crossing_rate(field, target, box)
    bound = (window * norm(jacobian)).upper()
    rest = (bound.exp() - 1 - bound).upper()
    sums = [sum((abs(row[k]) for row in matrix.tolist()), arb(0)) for k in range(matrix.ncols())]
    remainder = arb_mat([[arb(0, (rest * c).upper()) for c in sums]] * field.n)
    along = target.inverse * as_column([f / speed for f in rates])

    def projected(directions: arb_mat) -> arb_mat:
        return target.inverse * directions - along * (arb_mat([list(target.normal)]) * directions)

    return projected(matrix) + projected(jacobian * matrix) * arb(0, window) + projected(remainder)


def crossing_rate(field: BallField, target: BallSet, box: Vector) -> arb:
    """How fast the coordinate of the flow changes along orbits in a box; without a zero it changes its sign once."""
    return _product(target.normal, field.rates(box))


def _window(field: BallField, end: Parallelepiped, target: BallSet) -> tuple[arb, Vector]:
    """A half-width of times in which all orbits cross the section exactly once, and a box that contains them then."""
    start = end.box()
    gap = _gap(end, target)
    speed = crossing_rate(field, target, start)
    if speed.contains(0):
        raise EnclosureError(f"the orbits to set {target.name}: they may touch its section")
    window = arb((magnitude(gap) / speed.abs_lower() * 1.25 + arb(2) ** -60).upper())
    box = start
    for _ in range(10):
        rates = field.rates(box)
        reached = [s + arb(0, window) * f for s, f in zip(start, rates, strict=True)]
        if all(lies_inside(a, b) for a, b in zip(reached, box, strict=True)):
            speed = crossing_rate(field, target, box)
            if not speed.contains(0) and magnitude(gap) < window * speed.abs_lower():
                return window, box
            break
        box = [arb(r.mid(), (r.rad() * 1.1 + arb(2) ** -60).upper()) for r in reached]
    raise EnclosureError(f"the orbits to set {target.name}: they do not provably cross its section once")


def _gap(end: Parallelepiped, target: BallSet) -> arb:
    """How far all states are from the section."""
    along = (arb_mat([list(target.normal)]) * end.matrix).entries()
    return _product(target.normal, _difference(end.center, target.center)) + _product(along, end.ranges)


def _columns(matrix: arb_mat, chosen: Sequence[int]) -> arb_mat:
    return arb_mat([[row[k] for k in chosen] for row in matrix.tolist()])


def diagonal(signs: Sequence[int]) -> arb_mat:
    """The matrix of a change of signs."""
    return arb_mat([[s if i == j else 0 for j in range(len(signs))] for i, s in enumerate(signs)])


def _product(a: Sequence[arb], b: Sequence[arb]) -> arb:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))


def _difference(a: Sequence[arb], b: Sequence[arb]) -> Vector:
    return [x - y for x, y in zip(a, b, strict=True)]


def _shown(x: arb) -> str:
    return x.str(6, radius=False) if x.is_finite() else "nothing finite"
