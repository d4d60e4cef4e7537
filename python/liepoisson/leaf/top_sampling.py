r"""Independent random states of a top on a leaf, with the Liouville measure.

On a leaf the Liouville measure is $\delta(C - c)\,d^9x$ up to a constant.  With $n$ a unit vector,
$\ell = \ell_\parallel n + \ell_\perp$ and $\alpha = \alpha_\parallel n + \alpha_\perp$:

- $\epsilon\ne0$, $\beta = w n \ne 0$: $\alpha_\parallel = C_2/w$, $\ell_\parallel = (C_1 - |\alpha|^2)/(2\epsilon w)$;
  the deltas leave $dn\,d^2\alpha_\perp\,d^2\ell_\perp$ times a constant: the leaf is $S^2 \times \mathbb R^4$.
- $\epsilon = 0$, $\alpha\times\beta \ne 0$: $(\alpha, \beta)$ is a rotated copy of one pair, with the invariant measure
  of SO(3), and $\ell$ is free.
- $\alpha = p\,n$, $\beta = q\,n$ ($q = 0$ if $\epsilon \ne 0$): $dn\,d^2\ell_\perp$, with $\ell_\parallel$ constant.
- $\alpha = \beta = 0$: the sphere $|\ell|$ = const.

The energy is quadratic in what is free of $\ell$, so this part is integrated: for given $n, \alpha$ it is an ellipse,
$H - V = \tfrac12 u^t A u$ with $u$ measured from its centre $\ell_\parallel I n/(n\cdot I n)$, where
$V = \ell_\parallel^2/(2\,n\cdot I n) + a\cdot\alpha + b\cdot\beta$ and $\det A = n\cdot I n/(I_1 I_2 I_3)$.  With
$k = E - V$, the states of energy E have the density $[k > 0]/\sqrt{n\cdot In}$ in the rest, those below it
$k_+/\sqrt{n\cdot In}$.  In three dimensions ($\ell$ free) it is $\sqrt k$ and $k^{3/2}$.  The rest is bounded and drawn
by rejection.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.portable import elementary, linear
from liepoisson.streams import Random

if TYPE_CHECKING:
    from liepoisson.compile.field import TopField
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.leaf.leaf_sampling import Shell

Draw: TypeAlias = Callable[[Random, int], Array]
"""Draws at most this many states from this many proposals, shape (accepted, 9)."""


def top_draw(leaf: Leaf, top: TopField, shell: Shell | None) -> Draw | None:
    """How to draw states of this leaf, or None where a bound in energy is missing and the volume infinite."""
    if leaf.rank == 2:
        return _sphere(leaf, top, shell)
    if shell is None:
        return None
    if leaf.rank == 4:
        return _one_direction(leaf, top, shell)
    return _twisted(leaf, top, shell) if top.epsilon else _two_fields(leaf, top, shell)


def _twisted(leaf: Leaf, top: TopField, shell: Shell) -> Draw:
    """The leaves of dimension six for epsilon != 0; proposals are uniform in n, |alpha_perp|^2 and its angle."""
    c1, c2, c3 = leaf.casimirs.values()
    w = np.sqrt(c3)
    along = c2 / w
    low, high = _range_of_alpha(top, c1, w, along, shell.energy)
    ellipses = _Ellipses(top, shell, shell.energy + linear.norm(top.b) * w + linear.norm(top.a) * high)

    def draw(rng: Random, n: int) -> Array:
        direction = _directions(rng, n)
        squares = rng.uniform(low**2 - along**2, high**2 - along**2, n)
        across = _across(direction, rng.uniform(0, 2 * np.pi, n)) * np.sqrt(np.maximum(squares, 0.0))[:, None]
        alpha, beta = along * direction + across, w * direction
        parallel = (c1 - np.sum(alpha**2, axis=-1)) / (2 * top.epsilon * w)
        return ellipses.filled(rng, direction, parallel, alpha, beta)

    return draw


def _range_of_alpha(top: TopField, c1: float, w: float, along: float, energy: float) -> tuple[float, float]:
    r"""An interval that contains $\rho = |\alpha|$ on all states of at most this energy.

    $(C_1 - \rho^2)^2 \le 8\epsilon^2 w^2 I_{max}(E + |b| w + |a|\rho)$, as $n\cdot In \le I_{max}$; and
    $\rho \ge |\alpha_\parallel|$.  The set is bounded by roots of this quartic; it is empty if there are none.
    """
    size_a, size_b = (float(linear.norm(v)) for v in (top.a, top.b))
    factor = 8 * top.epsilon**2 * w**2 * max(top.inertia)
    coefficients = [1.0, 0.0, -2 * c1, -factor * size_a, c1**2 - factor * (energy + size_b * w)]
    roots = linear.roots(coefficients)
    # Double roots come out as pairs with a small imaginary part; a little more room only costs proposals.
    real = roots.real[np.abs(roots.imag) <= 1e-6 * (1 + np.abs(roots))]
    above = np.sort(real[real > abs(along)])
    if not above.size:
        return abs(along), abs(along)
    inside = np.polyval(coefficients, abs(along)) <= 0
    low = abs(along) if inside else float(above[0]) * (1 - 1e-6)
    return max(low, abs(along)), float(above[-1]) * (1 + 1e-6)


def _two_fields(leaf: Leaf, top: TopField, shell: Shell) -> Draw:
    r"""The leaves of dimension six for epsilon = 0: a rotation, and $\ell$ on an ellipsoid.

    The potential is $\mathrm{tr}\,(R M)$ with $M = \alpha_0 a^t + \beta_0 b^t$ of rank two, so its smallest value is
    minus the sum of the two singular values of M.
    """
    roots = np.sqrt(np.array(top.inertia))
    alpha0, beta0 = leaf.state[3:6], leaf.state[6:9]
    lowest = -linear.svd(np.outer(alpha0, top.a) + np.outer(beta0, top.b), compute_uv=False).sum()
    bound = shell.weight(np.array(max(shell.energy - lowest, 0.0)), 3)

    def draw(rng: Random, n: int) -> Array:
        rotation = _rotations(rng, n)
        alpha, beta = linear.matmul(rotation, alpha0), linear.matmul(rotation, beta0)
        k = shell.energy - linear.matmul(alpha, np.array(top.a)) - linear.matmul(beta, np.array(top.b))
        kept = rng.uniform(0, bound, n) < shell.weight(k, 3)
        alpha, beta, k = alpha[kept], beta[kept], k[kept]
        l = shell.radius(rng, k, 3)[:, None] * roots * _directions(rng, len(k))
        return np.concatenate([l, alpha, beta], axis=-1)

    return draw


def _one_direction(leaf: Leaf, top: TopField, shell: Shell) -> Draw:
    """The leaves of dimension four: alpha and beta along one direction, the component of l along it constant."""
    a, b = np.array(top.a), np.array(top.b)
    l0, alpha0, beta0 = leaf.state.reshape(3, 3)
    longer = alpha0 if linear.norm(alpha0) >= linear.norm(beta0) else beta0
    n0 = longer / linear.norm(longer)
    parallel, p, q = (float(linear.matmul(v, n0)) for v in (l0, alpha0, beta0))
    most = shell.energy + float(linear.norm(p * a + q * b)) - parallel**2 / (2 * max(top.inertia))
    ellipses = _Ellipses(top, shell, most)

    def draw(rng: Random, n: int) -> Array:
        direction = _directions(rng, n)
        return ellipses.filled(rng, direction, np.full(n, parallel), p * direction, q * direction)

    return draw


@dataclass(frozen=True)
class _Ellipses:
    """The ellipses of l across a direction on which H is constant, or discs below it.

    Attributes:
        top: The top.
        shell: The energy.
        most: A bound of k.
    """

    top: TopField
    shell: Shell
    most: float

    def filled(self, rng: Random, direction: Array, parallel: Array, alpha: Array, beta: Array) -> Array:
        """Accept the proposals with their weights, and add l: its centre and a point of the ellipse around it."""
        inertia, a, b = (np.array(v) for v in (self.top.inertia, self.top.a, self.top.b))
        bound = float(self.shell.weight(np.array(max(self.most, 0.0)), 2)) / np.sqrt(inertia.min())
        potential = linear.matmul(alpha, a) + linear.matmul(beta, b)
        moment = linear.matmul(direction**2, inertia)
        k = self.shell.energy - potential - parallel**2 / (2 * moment)
        kept = rng.uniform(0, bound, len(k)) < self.shell.weight(k, 2) / np.sqrt(moment)
        direction, alpha, beta, k = direction[kept], alpha[kept], beta[kept], k[kept]
        centre = (parallel / moment)[kept, None] * direction * inertia
        # A = P^t I^-1 P in an orthonormal basis P of the plane; u = L^-t e with A = L L^t solves u.Au = 1.
        basis = np.stack([_across(direction, np.full(len(k), turn)) for turn in (0.0, np.pi / 2)], axis=-1)
        lower = linear.cholesky(linear.matmul(np.swapaxes(basis, -1, -2), (basis / inertia[:, None])))
        angle = rng.uniform(0, 2 * np.pi, len(k))
        unit = np.stack([elementary.cos(angle), elementary.sin(angle)], axis=-1)
        circle = self.shell.radius(rng, k, 2)[:, None] * unit
        whitened = linear.solve(np.swapaxes(lower, -1, -2), circle[..., None])
        return np.concatenate([centre + linear.matmul(basis, whitened)[..., 0], alpha, beta], axis=-1)


def _sphere(leaf: Leaf, top: TopField, shell: Shell | None) -> Draw:
    size = float(linear.norm(leaf.state[:3]))
    inertia = np.array(top.inertia)
    if shell is not None and not shell.is_filled:
        return _polhode(size, inertia, shell.energy)

    def draw(rng: Random, n: int) -> Array:
        l = size * _directions(rng, n)
        if shell is not None:
            l = l[np.sum(l**2 / inertia, axis=-1) <= 2 * shell.energy]
        return np.concatenate([l, np.zeros((len(l), 6))], axis=-1)

    return draw


def _polhode(size: float, inertia: Array, energy: float) -> Draw:
    r"""The curves $|\ell|$ = const, H = E, with the measure of time.

    Along them $dt \propto d\ell_2/|\ell_1\ell_3|$, axis 2 with the middle moment.  The squares $\ell_1^2, \ell_3^2$
    are $u - v\,\ell_2^2$, and $\ell_2 = m\sin\varphi$, where m is the largest value, makes one of them
    $\propto\cos^2\varphi$.
    """
    first, middle, last = np.argsort(inertia)
    moments = 1 / inertia[[first, middle, last]]
    if moments[0] == moments[2]:  # the sphere has one energy only
        return lambda rng, n: np.concatenate([size * _directions(rng, n), np.zeros((n, 6))], axis=-1)
    gap = moments[0] - moments[2]
    starts = np.array([2 * energy - size**2 * moments[2], size**2 * moments[0] - 2 * energy]) / gap
    slopes = np.array([moments[1] - moments[2], moments[0] - moments[1]]) / gap
    if starts.min() < 0:
        return lambda rng, n: np.zeros((0, 9))
    limits = np.divide(starts, slopes, out=np.full(2, np.inf), where=slopes > 0)
    largest = float(np.sqrt(limits.min()))
    other = 1 - int(np.argmin(limits))  # whose component does not vanish where l2 is largest
    least = np.sqrt(max(starts[other] - slopes[other] * largest**2, 0.0))

    def draw(rng: Random, n: int) -> Array:
        phase = rng.uniform(0, 2 * np.pi, n)
        across = largest * elementary.sin(phase)
        squares = np.maximum(starts[:, None] - slopes[:, None] * across**2, 0.0)
        kept = rng.uniform(size=n) * np.sqrt(squares[other]) <= least
        signs = rng.choice([-1.0, 1.0], (2, n))
        x = np.zeros((n, 9))
        x[:, middle] = across
        x[:, [first, last]] = (signs * np.sqrt(squares)).T
        return x[kept]

    return draw


def _directions(rng: Random, n: int) -> Array:
    vectors = rng.standard_normal((n, 3))
    return vectors / linear.norm(vectors, axis=-1, keepdims=True)


def _across(direction: Array, angle: Array) -> Array:
    """Unit vectors orthogonal to the directions, turned by an angle from one that varies with the direction alone."""
    smallest = np.eye(3)[np.argmin(np.abs(direction), axis=-1)]
    first = np.cross(direction, smallest)
    first /= linear.norm(first, axis=-1, keepdims=True)
    return elementary.cos(angle)[:, None] * first + elementary.sin(angle)[:, None] * np.cross(direction, first)


def _rotations(rng: Random, n: int) -> Array:
    """Rotation matrices with the invariant measure, from uniform unit quaternions, shape (n, 3, 3)."""
    q = rng.standard_normal((n, 4))
    q /= linear.norm(q, axis=-1, keepdims=True)
    s, v = q[:, :1, None], q[:, 1:]
    hat = np.cross(np.eye(3)[None], -v[:, None, :], axis=-1)
    return (2 * s**2 - 1) * np.eye(3) + 2 * v[:, :, None] * v[:, None, :] + 2 * s * hat
