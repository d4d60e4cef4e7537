r"""Monodromy of the twisted Lagrange top, exactly: braids of the zeros of its spectral sextic.

Inside of the image $R = \prod_j(\lambda - z_j)(\lambda - \bar z_j)$ with three zeros $z_j$ of the upper half plane; a
value is critical there where two of them meet.  A loop of regular values moves them in a braid: a word of $\sigma_1$
and $\sigma_2$, where $\sigma_i$ is half a turn, anticlockwise, of the i-th and the next one, counted by their real
parts.  The cycles $\gamma_j$ of `lagrange_lattice` are carried by two facts.  While $z$ passes above $z'$, nothing
crosses the straight line of $z'$, and its cycle stays.  $\gamma_1 - \gamma_2 + \gamma_3$, the residue at infinity,
stays as well.  So

$$ \sigma_1:\ (\gamma_1, \gamma_2, \gamma_3) \mapsto (\gamma_2, 2\gamma_2 - \gamma_1, \gamma_3), \qquad
   \sigma_2:\ (\gamma_1, \gamma_2, \gamma_3) \mapsto (\gamma_1, \gamma_3, 2\gamma_3 - \gamma_2) . $$

This is the formula of Picard and Lefschetz for the two conjugate cycles that vanish.  On $w_1 = \gamma_1 - \gamma_2$,
$w_2 = \gamma_2 - \gamma_3$ these are the transvections $w_2 \mapsto w_2 - w_1$ and $w_1 \mapsto w_1 + w_2$, which
generate SL(2, Z); the lattice is the sum of the circle of $\ell_3$, which is fixed, and of this plane.

The braid of a polygon is found with a bound.  On a step that changes R by D the zero $z_j$ stays in its disc of the
radius $\rho$, half the distance to the nearest other zero, by Rouché's theorem, if $|D| < |R|$ on the circle, for which
$\sum_i|D_i|(|z_j| + \rho)^i < \rho\prod_{k \ne j}(|z_j - z_k| - \rho)$ is enough.  In disjoint discs any motion can be
deformed into the straight one.

References: [duistermaat1980]; [musso2005] for the curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import OrbitError, ParameterError, ShapeError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import check_kind
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import elementary, linear
from liepoisson.tori.lagrange_diagrams import CriticalCurve, LagrangeDiagram, one_value_of, values_of
from liepoisson.tori.lagrange_lattices import lagrange_lattice

if TYPE_CHECKING:
    from liepoisson.model.system import System

N_CORNERS = 24
"""Corners of the circle of a loop, and of the way to it."""
_PLACES = 2000
"""Planes R(mu) = 0 that are looked at for the distance to the boundary, which only scales a loop."""
_LEAST_STEP = 2.0**-30
"""The shortest step, relative to a side of a polygon: below it two zeros meet."""

_SIGMA = np.array([[[0, 1, 0], [-1, 2, 0], [0, 0, 1]], [[1, 0, 0], [0, 0, 1], [0, -1, 2]]])
_INVERSE = np.array([[[2, -1, 0], [1, 0, 0], [0, 0, 1]], [[1, 0, 0], [0, 2, -1], [0, 1, 0]]])
_CIRCLE = np.array([1, -1, 1])
"""The circle of l3 in the basis of the lattice."""


@dataclass(frozen=True, eq=False)
class LagrangeMonodromy(SavedWhole):
    r"""The monodromy of the twisted Lagrange top along loops that begin at one value.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> found = lp.tori.lagrange_monodromy(lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 8, "C2": 1, "C3": 1})))
        >>> print(found)
        base H = 11.4955, l3 = -0.278454, P = 1.77392: 2 loops, group SL(2, Z)
          braid (2): [[1, 0, 0], [0, 0, 1], [0, -1, 2]], on (w1, w2) [[1, 1], [0, 1]]
          braid (1): [[0, 1, 0], [-1, 2, 0], [0, 0, 1]], on (w1, w2) [[1, 0], [-1, 1]]

    Attributes:
        diagram: The diagram.
        base: The first value of all loops, H, l3 and the third integral, shape (3,).
        loops: Closed polygons of values, shapes (corner, 3).
        braids: Of each loop the word of the braid of the zeros: i for $\sigma_i$, -i for its inverse, reduced.
        matrices: M of each loop, shape (loop, 3, 3): the carried basis is M times `periods`.
        periods: The basis $\gamma_1, \gamma_2, \gamma_3$ at the base as rows, see `lagrange_lattice`.
    """

    kind = "monodromy of a twisted Lagrange top"
    made_by = "lp.tori.lagrange_monodromy"
    row = "loop"

    diagram: LagrangeDiagram
    base: Array
    loops: tuple[Array, ...]
    braids: tuple[tuple[int, ...], ...]
    matrices: NDArray[np.int64]
    periods: Array

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.diagram.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each loop the word of its braid, and M, row by row."""
        words = np.array([" ".join(map(str, braid)) for braid in self.braids], dtype=np.str_)
        places = [(i, j) for i in range(3) for j in range(3)]
        return {"braid": words} | {f"M_{i + 1}{j + 1}": self.matrices[:, i, j] for i, j in places}

    @property
    def in_plane(self) -> NDArray[np.int64]:
        r"""The matrices on $w_1 = \gamma_1 - \gamma_2$ and $w_2 = \gamma_2 - \gamma_3$, shape (loop, 2, 2).

        The lattice is the sum of this plane and of $\gamma_1 - \gamma_2 + \gamma_3$, which is fixed.
        """
        differences = np.array([[1, -1, 0], [0, 1, -1]])
        carried = _product(differences, self.matrices).reshape(-1, 2, 3)
        return np.stack([carried[..., 0], -carried[..., 2]], -1)

    @property
    def is_abelian(self) -> bool:
        """Whether all matrices commute."""
        return all(
            (_product(one, other) == _product(other, one)).all() for one in self.in_plane for other in self.in_plane
        )

    @property
    def invariant(self) -> NDArray[np.int64]:
        """A basis of the periods that no loop changes, as rows, in terms of `periods`; the circle of l3 comes first."""
        rest = np.concatenate(
            [np.zeros((2, 0), dtype=np.int64), *(m - np.eye(2, dtype=np.int64) for m in self.in_plane)], 1
        )
        columns = [tuple(int(v) for v in column) for column in rest.T if column.any()]
        fixed = [(1, 0), (0, 1)] if not columns else [(-columns[0][1], columns[0][0])]
        if any(x * u + y * v for x, y in fixed for u, v in columns):
            fixed = []
        rows = [(x, y - x, -y) for x, y in ((np.array(one) // np.gcd(*one)).tolist() for one in fixed)]
        return np.array([_CIRCLE.tolist(), *rows], dtype=np.int64)

    @property
    def group(self) -> str:
        r"""The group that the matrices generate: "trivial", "Z", "SL(2, Z)", "free" or "not decided".

        Two transvections $v \mapsto v + k\,\langle u, v\rangle u$ along primitive u and u' with k = ±1 commute if
        $\langle u, u'\rangle = 0$, generate SL(2, Z) if it is ±1, and a free group otherwise, by the ping-pong lemma.
        """
        moving = [m for m in self.in_plane if (m != np.eye(2)).any()]
        if not moving:
            return "trivial"
        directions = [_direction(m) for m in moving]
        if None in directions:
            return "not decided"
        pairings = {abs(u[0] * v[1] - u[1] * v[0]) for u in directions for v in directions if u and v}
        if pairings == {0}:
            return "Z"
        simple = [
            u
            for u, m in zip(directions, moving, strict=True)
            if np.gcd.reduce((m - np.eye(2, dtype=np.int64)).ravel()) == 1
        ]
        if any(abs(u[0] * v[1] - u[1] * v[0]) == 1 for u in simple for v in simple if u and v):
            return "SL(2, Z)"
        return "free" if len(moving) == 2 else "not decided"

    def __str__(self) -> str:
        at = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.diagram.integrals, self.base, strict=True))
        lines = [f"base {at}: {len(self.loops)} loop{'s' if len(self.loops) != 1 else ''}, group {self.group}"]
        for braid, matrix, plane in zip(self.braids, self.matrices, self.in_plane, strict=True):
            word = " ".join(map(str, braid))
            lines.append(f"  braid ({word}): {matrix.tolist()}, on (w1, w2) {plane.tolist()}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Monodromy of {len(self.loops)} loops of class {self.diagram.leaf_class}: group {self.group}>"


def _direction(plane: NDArray[np.int64]) -> tuple[int, int] | None:
    """The primitive vector along which a matrix moves, if it is unipotent."""
    rest = plane - np.eye(2, dtype=np.int64)
    if _product(rest, rest).any():
        return None
    row = rest[0] if rest[0].any() else rest[1]
    x, y = (row // np.gcd.reduce(row)).tolist()
    return x, y


@explains_its_arguments
def thread_loop(diagram: LagrangeDiagram, thread: CriticalCurve, base: ArrayLike | None = None) -> Array:
    r"""A loop of regular values once around a thread: a way to it, a small circle, and the way back.

    The circle is around the value of the thread that is farthest from the other threads and from the boundary, with
    half that distance for its radius, in the plane across the thread; all this in the scaled $(\ell_3, h, p)$, in which
    the image is convex: its boundary is enveloped by the planes $R(\mu) = 0$.  It goes such that the zeros of R that
    meet turn around one another anticlockwise.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0, "C2": 2, "C3": 1}))
        >>> loop = lp.tori.thread_loop(diagram, diagram.threads[0])
        >>> loop.shape, bool((loop[0] == loop[-1]).all()), bool(diagram.depth(loop).min() > 0)
        ((73, 3), True, True)

    Args:
        diagram: What `lagrange_diagram` returned.
        thread: One of its threads.
        base: H, l3 and the third integral where the loop begins, shape (3,), inside of the image; by default at l3 and
            p of the means of the circles' centres, and at an h above all threads.

    Returns:
        The corners, the last equal to the first, shape (corner, 3).

    Raises:
        ParameterError: the curve is no thread of the diagram.
        OrbitError: the base is not inside of the image, or the thread is too near to another one or to the boundary.
    """
    check_kind(diagram, LagrangeDiagram, "diagram", "a LagrangeDiagram", "make it by lp.tori.lagrange_diagram(leaf)")
    if not any(thread is one for one in diagram.threads):
        raise ParameterError("thread: wanted one of diagram.threads")
    return diagram.scaled.integrals(_around(diagram, thread, _base(diagram, base)))


@explains_its_arguments
def lagrange_monodromy(diagram: LagrangeDiagram, loops: Sequence[ArrayLike] | None = None) -> LagrangeMonodromy:
    r"""The monodromy around the threads of a twisted Lagrange top, or along given loops, by braids of the zeros of R.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0, "C2": 2, "C3": 1}))
        >>> found = lp.tori.lagrange_monodromy(diagram)
        >>> found.group, found.matrices.tolist(), found.invariant.tolist()
        ('Z', [[[1, 0, 0], [0, 0, 1], [0, -1, 2]]], [[1, -1, 1], [0, 1, -1]])

    Args:
        diagram: What `lagrange_diagram` returned.
        loops: Closed polygons of values of H, l3 and the third integral, shapes (corner, 3), that begin at one value;
            their sides are straight in the scaled $(\ell_3, h, p)$.  By default `thread_loop` of each thread.

    Raises:
        ShapeError: a loop is no array of values.
        ParameterError: loops are not closed, or begin at different values.
        OrbitError: a loop leaves the image or meets a thread; or see `thread_loop` and `lagrange_lattice`.
    """
    check_kind(diagram, LagrangeDiagram, "diagram", "a LagrangeDiagram", "make it by lp.tori.lagrange_diagram(leaf)")
    if loops is None:
        first = _base(diagram, None)
        given = [diagram.scaled.integrals(_around(diagram, thread, first)) for thread in diagram.threads]
        start = diagram.scaled.integrals(first)
    else:
        given = [_polygon(diagram, loop) for loop in sequence(loops, "loops", "closed polygons of values", "[loop]")]
        if not given:
            raise ParameterError("loops: wanted at least one; got none")
        start = given[0][0]
    if any(not np.array_equal(end, start) for loop in given for end in (loop[0], loop[-1])):
        raise ParameterError("loops: wanted closed polygons that begin at one value")
    braids = tuple(_braid(diagram, diagram.scaled.scaled(loop)) for loop in given)
    matrices = np.array([_matrix(braid) for braid in braids], dtype=np.int64).reshape(-1, 3, 3)
    return LagrangeMonodromy(diagram, start, tuple(given), braids, matrices, lagrange_lattice(diagram, start))


def _polygon(diagram: LagrangeDiagram, given: ArrayLike) -> Array:
    loop = values_of(given, diagram.integrals, "loops")
    if loop.ndim != 2 or len(loop) < 3:
        raise ShapeError(f"loops: wanted values of {', '.join(diagram.integrals)}, shape (corner, 3); got {loop.shape}")
    return loop


def _product(one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
    """Products of matrices of whole numbers, exactly."""
    return np.asarray((one[..., None] * other[..., None, :, :]).sum(axis=-2), dtype=np.int64)


def _matrix(braid: Sequence[int]) -> NDArray[np.int64]:
    letters = (_SIGMA[i - 1] if i > 0 else _INVERSE[-i - 1] for i in braid)
    return reduce(_product, letters, np.eye(3, dtype=np.int64))


def _base(diagram: LagrangeDiagram, given: ArrayLike | None) -> Array:
    """The first value of loops, scaled."""
    if given is not None:
        base = one_value_of(given, diagram.integrals, "base")
        if not diagram.depth(base) > 0:
            raise OrbitError(f"base: wanted a value inside of the image; got {base.tolist()}. See diagram.depth.")
        return diagram.scaled.scaled(base)
    threads = [diagram.scaled.scaled(thread.values) for thread in diagram.threads]
    found = np.mean([_center(diagram, thread)[0] for thread in diagram.threads], axis=0) if threads else np.zeros(3)
    top, height = max((float(values[:, 1].max()) for values in threads), default=0.0), 1.0
    while True:
        found[1] = top + height
        try:
            lagrange_lattice(diagram, diagram.scaled.integrals(found))
        except OrbitError:  # outside, or two zeros have one real part: not so where h is great
            height *= 2
        else:
            return found


def _center(diagram: LagrangeDiagram, thread: CriticalCurve) -> tuple[Array, Array, float]:
    """The value of a thread farthest from all else, its tangent, and half of that distance, scaled."""
    values = diagram.scaled.scaled(thread.values)
    angle = (np.arange(_PLACES) + 0.5) * (np.pi / _PLACES) - np.pi / 2
    mu = elementary.tan(angle)
    # R(mu) is affine in l3, h and p: divided by the length of its gradient it is a distance
    square = mu * mu
    gradient = 2 * np.abs(mu) * square * np.sqrt(square * square + square + 1)
    far = np.array([(np.polyval(row, mu) / gradient).min() for row in diagram.sextic(thread.values)])
    for other in diagram.threads:
        if other is not thread:
            gaps = values[:, None] - diagram.scaled.scaled(other.values)
            far = np.minimum(far, linear.norm(gaps, axis=2).min(axis=1))
    best = int(far.argmax())
    # Along the thread R keeps its double zero: mu^2 dl3 + mu dh + dp = 0
    zeros = _upper(diagram, values[best])
    i, j = min(((0, 1), (0, 2), (1, 2)), key=lambda pair: abs(zeros[pair[0]] - zeros[pair[1]]))
    a, b = float(zeros[i].real + zeros[j].real) / 2, float(zeros[i].imag + zeros[j].imag) / 2
    tangent = _cross(np.array([a * a - b * b, a, 1.0]), np.array([2 * a * b, b, 0.0]))
    return values[best], tangent / linear.norm(tangent), float(far[best]) / 2


def _cross(one: Array, other: Array) -> Array:
    return np.array([one[i - 2] * other[i - 1] - one[i - 1] * other[i - 2] for i in range(3)])


def _around(diagram: LagrangeDiagram, thread: CriticalCurve, base: Array) -> Array:
    center, tangent, radius = _center(diagram, thread)
    towards = base - center
    towards = towards - tangent * (tangent * towards).sum()
    towards = towards / linear.norm(towards)
    across = _cross(tangent, towards)
    angle = np.arange(N_CORNERS + 1) * (2 * np.pi / N_CORNERS)
    circle = center + radius * (elementary.cos(angle)[:, None] * towards + elementary.sin(angle)[:, None] * across)
    circle[-1] = circle[0]
    turns = sum(1 if letter > 0 else -1 for letter in _braid(diagram, circle))
    if abs(turns) != 1:
        raise OrbitError(
            f"thread: wanted one around which two zeros of R turn once; around the circle of radius {radius:.1g} they "
            f"make {turns} half turns: it is too near to another thread or to the boundary. Take another leaf."
        )
    circle = circle if turns > 0 else circle[::-1]
    share = (np.arange(N_CORNERS) / N_CORNERS)[:, None]
    way = base + share * (circle[0] - base)
    return np.concatenate([way, circle, way[::-1]])


def _upper(diagram: LagrangeDiagram, scaled: Array) -> NDArray[np.complex128]:
    """The zeros of R in the upper half plane."""
    sextic = diagram.sextic(diagram.scaled.integrals(scaled))
    zeros = np.asarray(linear.roots(sextic), dtype=np.complex128)
    return zeros[zeros.imag > 0]


def _braid(diagram: LagrangeDiagram, path: Array) -> tuple[int, ...]:
    """The word of the zeros along a polygon in l3, h and p, reduced.

    Raises:
        OrbitError: two zeros meet.
    """
    here, zeros = path[0], _upper(diagram, path[0])
    word = list[int]()
    for corner in path[1:]:
        done, begin, share = 0.0, here, 1.0
        while done < 1:
            share = min(2 * share, 1 - done)
            while len(zeros) == 3 and not _stays_apart(zeros, share * (corner - begin)):
                share /= 2
                if share < _LEAST_STEP:
                    break
            if len(zeros) < 3 or share < _LEAST_STEP:
                at = diagram.scaled.integrals(here).tolist()
                raise OrbitError(
                    f"loop: wanted one of regular values inside of the image; at {at} it meets a thread or leaves the "
                    "image. Go around the thread."
                )
            done += share
            here = corner if done >= 1 else begin + done * (corner - begin)
            found = _upper(diagram, here)
            following = found[[int(np.abs(found - zero).argmin()) for zero in zeros]]
            word.extend(_letters(zeros, following))
            zeros = following
    reduced = list[int]()
    for letter in word:
        if reduced and reduced[-1] == -letter:
            reduced.pop()
        else:
            reduced.append(letter)
    return tuple(reduced)


def _stays_apart(zeros: NDArray[np.complex128], step: Array) -> bool:
    """Whether no zero leaves its disc while l3, h and p change by a step."""
    every = np.concatenate([zeros, zeros.conj()])
    for j in range(3):
        gaps = np.abs(np.delete(every, j) - zeros[j])
        radius = gaps.min() / 2
        size = np.abs(zeros[j]) + radius
        change = 2 * (abs(step[0]) * size**5 + abs(step[1]) * size**4 + abs(step[2]) * size**3)
        if not change < radius * np.prod(gaps - radius):
            return False
    return True


def _letters(zeros: NDArray[np.complex128], following: NDArray[np.complex128]) -> list[int]:
    """The letters of a straight motion of three zeros."""
    crossings = list[tuple[float, int, int]]()
    for i, j in ((0, 1), (0, 2), (1, 2)):
        before, after = (zeros[i] - zeros[j]).real, (following[i] - following[j]).real
        if (before < 0) != (after < 0):
            crossings.append((before / (before - after), i, j))
    order: list[Any] = [int(i) for i in np.argsort(zeros.real, kind="stable")]
    letters = list[int]()
    for share, i, j in sorted(crossings):
        first, second = (zeros[k] + share * (following[k] - zeros[k]) for k in (i, j))
        upper = i if first.imag > second.imag else j
        one, other = sorted((order.index(i), order.index(j)))
        letters.append(-(one + 1) if order[one] == upper else one + 1)
        order[one], order[other] = order[other], order[one]
    return letters
