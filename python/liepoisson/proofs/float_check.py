r"""The conditions of a certificate in floating-point numbers: whether a proof is likely to succeed, and no proof.

For each edge the return map is differentiated at the centre and at random points of the set.  In the coordinates of the
target its derivative has blocks uu, us, su, ss; with $K = uu^{-1}$ at the centre the conditions are

$$ \frac{1 - |K o_u| - |K\,\delta uu| - |K||us|}{|K|} > 1, \qquad |o_s| + |su| + |ss| < 1, $$

with the offset o of the image of the centre and the largest change $\delta$ over the points, and, for the cones of
$Q = |u|^2 - |s|^2$ with $a = 1/|K| - |\delta uu|$,

$$ (a^2 - |su|^2 - 1)(1 + |us|^2 - |ss|^2) > (a|us| + |su||ss|)^2 . $$
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import linear
from liepoisson.streams import Random, generator

if TYPE_CHECKING:
    from liepoisson.orbits.level import Level
    from liepoisson.proofs.chain import Chain, Edge, HSet

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
