r"""Chains of h-sets along a periodic and a homoclinic orbit: the certificate of a proof by covering relations.

A set has a centre c and a frame B, whose columns are k unstable vectors, the flow, k stable vectors, and the gradients
of H and the Casimirs:

$$ N = \{\, c + B(q_u, 0, q_s, w) : |q_u| \le 1,\ |q_s| \le 1 \,\}, $$

w being fixed by the level.  An edge says that the set i, after a time and perhaps the symmetry, maps across the set j.

**The adapted norm.** The map across one segment may contract an unstable direction although all grow in the long run,
so no fixed norm will do.  With the matrices $K_j$ of the segments on the unstable spaces and

$$ P_{j+1} = 1 + \kappa^2 K_j^{-T} P_j K_j^{-1}, $$

$|K_j y|_{P_{j+1}} \ge \kappa\,|y|_{P_j}$ holds on every segment.  The recursion begins at its fixed point along the
periodic orbit and stays bounded where the growth over many segments is faster than $\kappa$.

References: [zgliczynski2004].

The conditions of a certificate in floating-point numbers: whether a proof is likely to succeed, and no proof.

For each edge the return map is differentiated at the centre and at random points of the set.  In the coordinates of the
target its derivative has blocks uu, us, su, ss; with $K = uu^{-1}$ at the centre the conditions are

$$ \frac{1 - |K o_u| - |K\,\delta uu| - |K||us|}{|K|} > 1, \qquad |o_s| + |su| + |ss| < 1, $$

with the offset o of the image of the centre and the largest change $\delta$ over the points, and, for the cones of
$Q = |u|^2 - |s|^2$ with $a = 1/|K| - |\delta uu|$,

$$ (a^2 - |su|^2 - 1)(1 + |us|^2 - |ss|^2) > (a|us| + |su||ss|)^2 . $$
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import ceil, log
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import OrbitError
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.model.system_text import formula_text
from liepoisson.orbits.homoclinic import lengthened
from liepoisson.orbits.level import Level
from liepoisson.orbits.multipliers import transversal_basis
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import linear
from liepoisson.proofs.certificate import FORMAT, LEVEL_RADIUS
from liepoisson.streams import Random, generator

if TYPE_CHECKING:
    from liepoisson.orbits.homoclinic_orbits import HomoclinicOrbit
    from liepoisson.orbits.multipliers import SymmetricOrbit

_INSIDE = 0.25
"""Where a homoclinic orbit begins in the set of the periodic orbit, as a part of its size."""

_CYCLES = 500
_SETTLED = 1e-14


@dataclass(frozen=True, eq=False)
class HSet(ReadOnlyArrays):
    """A set of a chain.

    Attributes:
        name: How it is called.
        center: Its centre, shape (N,).
        frame: Columns: unstable, flow, stable, gradients, shape (N, N).
    """

    name: str
    center: Array
    frame: Array


@dataclass(frozen=True)
class Edge:
    """One set maps across another.

    Attributes:
        source: Name of the first.
        target: Name of the second.
        time: The time between them.
        symmetry: Whether the symmetry is applied at the end.
    """

    source: str
    target: str
    time: float
    symmetry: bool


@dataclass(frozen=True, eq=False)
class Chain:
    """Sets and edges along a periodic orbit and along an orbit homoclinic to it.

    Attributes:
        level: The level.
        symmetry: A symmetry that keeps time and changes signs only, as nine (N) signs.
        sets: The sets.
        edges: The edges: two along half a loop of the periodic orbit, the others along the excursion.
        level_radius: By how much H and the Casimirs may differ on other levels for which the same is claimed.
    """

    level: Level
    symmetry: tuple[int, ...]
    sets: tuple[HSet, ...]
    edges: tuple[Edge, ...]
    level_radius: Fraction = LEVEL_RADIUS

    def record(self) -> dict[str, Any]:
        """The chain as plain data: doubles as C99 hexadecimal texts, rational numbers as texts.

        Raises:
            OrbitError: a value of the level is no rational number.
        """
        system = self.level.system
        equations = {str(x): formula_text(rate) for x, rate in system.equations.items()}
        return {
            "format": FORMAT,
            "system": {"name": system.name, "equations": equations},
            "level": {name: _rational(name, value) for name, value in self.level.values.items()},
            "level_radius": str(self.level_radius),
            "symmetry": list(self.symmetry),
            "sets": [
                {"name": one.name, "center": _hexadecimal(one.center), "frame": [_hexadecimal(r) for r in one.frame]}
                for one in self.sets
            ],
            "edges": [
                {"from": e.source, "to": e.target, "time": e.time.hex(), "symmetry": e.symmetry} for e in self.edges
            ],
        }


def _hexadecimal(values: Array) -> list[str]:
    return [(float(v) + 0.0).hex() for v in values]


def _rational(name: str, value: Any) -> str:
    if not isinstance(value, Fraction):
        raise OrbitError(f"level: wanted rational values for a certificate; got {name} = {value}")
    return str(value)


@dataclass(frozen=True, eq=False)
class ChainMaker:
    """Makes chains along an orbit and orbits homoclinic to it.

    Attributes:
        orbit: A hyperbolic symmetric orbit, its start and end as near to it as doubles are.
        radius: The size of the sets, in the adapted norm.
        kappa: The growth per segment that the adapted norm is made for.
    """

    orbit: SymmetricOrbit
    radius: float = 1e-4
    kappa: float = 1.3

    @property
    def flow(self) -> Flow:
        """How the pieces are integrated; each is one trajectory."""
        return Flow(self.orbit.system, 1)

    def along(self, homoclinic: HomoclinicOrbit) -> Chain:
        """The chain of the orbit and one homoclinic orbit.

        Raises:
            OrbitError: the loop of the orbit is no change of signs, the homoclinic orbit does not come back to it in a
                way that the format can say, or the norm does not stay bounded.
        """
        orbit = self.orbit
        closing = linear.matmul(orbit.last.matrix, orbit.first.matrix)
        has_symmetry = not np.array_equal(closing, np.eye(len(closing)))
        comes_back_to_image = _comes_back_to_image(orbit, homoclinic) and has_symmetry
        a, b = orbit.start, orbit.end
        unstable_a = self._unstable()
        unstable_b, K_ab = self._split(self._moved(a, orbit.time, unstable_a), b)
        _, K_ba = self._split(linear.matmul(closing, self._moved(b, orbit.time, unstable_b)), a, unstable_a)
        norm_a, norm_b = self._norms(K_ab, K_ba)
        u_a, u_b = self._scaled(unstable_a, norm_a), self._scaled(unstable_b, norm_b)
        sets = [
            HSet("p_a", a, self._frame(a, u_a, linear.matmul(orbit.first.matrix, u_a))),
            HSet("p_b", b, self._frame(b, u_b, linear.matmul(orbit.last.matrix, u_b))),
        ]
        excursion = self._lengthened(homoclinic, norm_a)
        n = max(2, round(excursion.time / orbit.time))
        tau = excursion.time / n
        centers = self._centers(excursion, tau, n)
        scaled = self._along_excursion(centers, tau, unstable_a, norm_a)
        mirror = homoclinic.reverser.matrix
        sets += [
            HSet(f"q{j}", centers[j], self._frame(centers[j], scaled[j], linear.matmul(mirror, scaled[2 * n - j])))
            for j in range(1, 2 * n)
        ]
        names = ["p_a", *(f"q{j}" for j in range(1, 2 * n)), "p_a"]
        edges = [Edge("p_a", "p_b", orbit.time, False), Edge("p_b", "p_a", orbit.time, has_symmetry)]
        edges += [Edge(names[j], names[j + 1], tau, comes_back_to_image and j == 2 * n - 1) for j in range(2 * n)]
        return Chain(orbit.level, tuple(int(s) for s in np.diag(closing)), tuple(sets), tuple(edges))

    def _along_excursion(self, centers: list[Array], tau: float, unstable: Array, norm: Array) -> list[Array]:
        """The scaled unstable vectors at the ends of all segments but the last, which ends in a set with its own."""
        scaled = [self._scaled(unstable, norm)]
        for start, target in pairwise(centers[:-1]):
            unstable, K = self._split(self._moved(start, tau, unstable), target)
            norm = self._carried(norm, K)
            scaled.append(self._scaled(unstable, norm))
        return scaled

    def _unstable(self) -> Array:
        """The unstable vectors at the start of the orbit, orthonormal, across the flow, shape (N, k)."""
        from liepoisson.orbits.unstable_spaces import unstable_space

        space = unstable_space(self.orbit)
        across = self._across(self.orbit.start)
        return linear.qr(linear.matmul(across, linear.matmul(across.T, space.basis)))[0]

    def _across(self, x: Array) -> Array:
        return transversal_basis(self.orbit.level.gradients(x), self.orbit.system.vector_field(x))

    def _moved(self, start: Array, time: float, vectors: Array) -> Array:
        """Tangent vectors after a time."""
        return self.flow.ends(start[None], np.array([time]), vectors)[1][0]

    def _split(self, moved: Array, target: Array, basis: Array | None = None) -> tuple[Array, Array]:
        """Vectors across the flow at the target, as a basis (orthonormal, if it is not given) times a matrix."""
        across = self._across(target)
        part = linear.matmul(across, linear.matmul(across.T, moved))
        if basis is None:
            orthonormal, factor = linear.qr(part)
            return orthonormal, factor
        return basis, linear.lstsq(basis, part, rcond=None)[0].astype(np.float64)

    def _carried(self, norm: Array, K: Array) -> Array:
        back = linear.inv(K)
        return np.eye(len(K)) + linear.matmul(linear.matmul(self.kappa**2 * back.T, norm), back)

    def _norms(self, K_ab: Array, K_ba: Array) -> tuple[Array, Array]:
        """The fixed point of the recursion along the periodic orbit, at both of its sets."""
        norm = np.eye(len(K_ab))
        for _ in range(_CYCLES):
            norm_b = self._carried(norm, K_ab)
            new = self._carried(norm_b, K_ba)
            done = np.abs(new - norm).max() <= _SETTLED * np.abs(new).max()
            norm = new
            if done:
                return norm, self._carried(norm, K_ab)
        raise OrbitError(
            f"every unstable multiplier of the orbit must be larger than kappa^2 = {self.kappa**2:g}; got "
            f"{np.abs(self.orbit.multipliers[: len(K_ab)])}; take a smaller kappa or another orbit"
        )

    def _scaled(self, U: Array, norm: Array) -> Array:
        """The vectors whose combinations with |q| = 1 have the length `radius` in a norm."""
        values, vectors = linear.eigh(norm)
        return linear.matmul(linear.matmul(self.radius * U, (vectors / np.sqrt(values))), vectors.T)

    def _frame(self, x: Array, unstable: Array, stable: Array) -> Array:
        return np.column_stack([unstable, self.orbit.system.vector_field(x), stable, self.orbit.level.gradients(x).T])

    def _lengthened(self, homoclinic: HomoclinicOrbit, norm: Array) -> HomoclinicOrbit:
        """The same from a start so near to the periodic orbit that it is well inside of its set."""
        largest = float(linear.eigvalsh(norm).max())
        size = float(linear.norm(homoclinic.amplitude) * np.sqrt(largest)) / self.radius
        slowest = float(np.abs(linear.eigvals(homoclinic.space.matrix)).min())
        return lengthened(homoclinic, max(0, ceil(log(size / _INSIDE) / log(slowest))))

    def _centers(self, homoclinic: HomoclinicOrbit, tau: float, n: int) -> list[Array]:
        """The start, all ends of segments, and the end; the second half is the mirror image of the first."""
        from liepoisson.numeric.integrate import integrate

        times = np.arange(n + 1) * tau
        first = integrate(self.orbit.system, homoclinic.start, times=times, kernel="lanes").state[0]
        middle = (first[-1] + homoclinic.reverser(first[-1])) / 2
        return [*first[:-1], middle, *(homoclinic.reverser(x) for x in reversed(first[:-1]))]


def _comes_back_to_image(orbit: SymmetricOrbit, homoclinic: HomoclinicOrbit) -> bool:
    r"""Whether the homoclinic orbit, which begins at the start x of the orbit, comes back to P x, and not to x.

    The reverser of its midpoint takes x to the state that it comes back to: $\rho_0 x = x$, $\rho_1 x = Px$.

    Raises:
        OrbitError: the reverser is neither, or P is no change of signs.
    """
    closing, middle = linear.matmul(orbit.last.matrix, orbit.first.matrix), homoclinic.reverser.matrix
    if not np.array_equal(closing, np.diag(np.diag(closing))):
        raise OrbitError("the loop of the orbit must be closed by changes of signs; it exchanges components")
    if np.array_equal(middle, orbit.last.matrix):
        return True
    if np.array_equal(middle, orbit.first.matrix):
        return False
    raise OrbitError("the midpoint must be in one of the two fixed sets that the periodic orbit meets")


def with_polished_ends(orbit: SymmetricOrbit, digits: int = 25) -> SymmetricOrbit:
    """The orbit with start, end and time rounded from numbers of many digits."""
    precise = orbit.polished(digits=digits)
    return replace(
        orbit,
        start=np.array([float(v) for v in precise.start]),
        end=np.array([float(v) for v in precise.end]),
        time=float(precise.time),
    )


_POINTS = 24
_TO_SECTION, _TO_LEVEL = 4, 4


@dataclass(frozen=True)
class FloatCheck:
    """The worst values over all edges.

    Attributes:
        covering: The smallest expansion across the target; must be above 1.
        stable: The largest extent in the stable directions; must be below 1.
        cones: The smallest difference of the two sides of the condition on cones, -inf where a factor is not positive;
            must be above 0.
        chart: The largest w of an image point; must be far below 1e-3, up to which charts are certified.
    """

    covering: float
    stable: float
    cones: float
    chart: float

    @property
    def passes(self) -> bool:
        """Whether all conditions hold, in floating-point numbers."""
        return self.covering > 1 and self.stable < 1 and self.cones > 0 and self.chart < 1e-3


def float_check(chain: Chain, *, seed: int = 0) -> FloatCheck:
    """Checks all edges of a chain."""
    flow, by_name = Flow(chain.level.system, 1), {one.name: one for one in chain.sets}
    found = [
        edge_check(flow, chain, e, (by_name[e.source], by_name[e.target]), generator([seed, k]))
        for k, e in enumerate(chain.edges)
    ]
    covering, stable, cones, chart = np.array(found).T
    return FloatCheck(float(covering.min()), float(stable.max()), float(cones.min()), float(chart.max()))


def points_of(level: Level, one: HSet, q: Array) -> Array:
    """States of a set with coordinates (q_u, q_s), shape (n, 2k), put on the level along the gradients."""
    N, k = len(one.center), q.shape[1] // 2
    columns = [*range(k), *range(k + 1, 2 * k + 1)]
    normal = one.frame[:, 2 * k + 1 : N]
    x = one.center + linear.matmul(q, one.frame[:, columns].T)
    for _ in range(_TO_LEVEL):
        move = linear.solve(linear.matmul(level.gradients(x), normal), level.deviations(x)[..., None])[..., 0]
        x = x - linear.matmul(move, normal.T)
    return x


def edge_check(
    flow: Flow, chain: Chain, edge: Edge, ends_of_edge: tuple[HSet, HSet], draw: Random
) -> tuple[float, float, float, float]:
    """Covering, stable extent, cones and chart of one edge (see `FloatCheck`)."""
    source, target = ends_of_edge
    N = len(source.center)
    k = (chain.level.dimension - 1) // 2
    u, s = list(range(k)), list(range(k + 1, 2 * k + 1))
    q = draw.standard_normal((_POINTS, 2, k))
    q = np.concatenate([np.zeros((1, 2, k)), q / linear.norm(q, axis=2, keepdims=True)]).reshape(-1, 2 * k)
    x = points_of(chain.level, source, q)
    tangents = source.frame[:, u + s]
    normal = source.frame[:, 2 * k + 1 :]
    slopes = chain.level.gradients(x)
    tangents = tangents - linear.matmul(
        normal, linear.solve(linear.matmul(slopes, normal), linear.matmul(slopes, tangents))
    )
    ends, moved = flow.ends(x, np.full(len(x), edge.time), tangents)
    if edge.symmetry:
        signs = np.array(chain.symmetry, dtype=np.float64)
        ends, moved = ends * signs, moved * signs[:, None]
    inverse = linear.inv(target.frame)
    row = inverse[k]
    rate = flow.system.vector_field
    # the images are within 1e-3 of the section: a few steps of a short Taylor series, which is a Newton iteration
    for _ in range(_TO_SECTION):
        delay = -linear.matmul((ends - target.center), row) / linear.matmul(rate(ends), row)
        if np.abs(delay).max() < 1e-15:
            break
        for i in np.flatnonzero(delay):
            (end,), (tangent,) = flow.ends(ends[i : i + 1], delay[i : i + 1], moved[i : i + 1])
            ends[i], moved[i] = end, tangent
    along = rate(ends)
    moved = moved - along[:, :, None] * (linear.matmul(row, moved) / linear.matmul(along, row)[:, None])[:, None, :]
    R, offset = linear.matmul(inverse, moved), linear.matmul(inverse, (ends[0] - target.center))
    uu, us = R[:, u][:, :, :k], R[:, u][:, :, k:]
    su, ss = R[:, s][:, :, :k], R[:, s][:, :, k:]
    K = linear.inv(uu[0])
    size = float(linear.norm(K, 2))
    change, kick = _largest(uu - uu[0]), _largest(linear.matmul(K, (uu - uu[0])))
    n_us, n_su, n_ss = _largest(us), _largest(su), _largest(ss)
    covering = (1 - float(linear.norm(linear.matmul(K, offset[u]))) - kick - size * n_us) / size
    stable = float(linear.norm(offset[s])) + n_su + n_ss
    a = 1 / size - change
    first, second = a * a - n_su**2 - 1, 1 + n_us**2 - n_ss**2
    cones = first * second - (a * n_us + n_su * n_ss) ** 2 if first > 0 and second > 0 else -np.inf
    w = linear.matmul((ends - target.center), inverse[2 * k + 1 : N].T)
    return covering, stable, float(cones), float(np.abs(w).max())


def _largest(matrices: Array) -> float:
    return float(linear.norm(matrices, 2, axis=(1, 2)).max())
