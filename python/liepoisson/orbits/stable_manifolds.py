r"""Orbits on the stable manifold of an equilibrium, or on the unstable one, that pass by given states.

Followed from its start such an orbit does not arrive: round-off grows with the fastest rate, the orbit falls with the
slowest.  So it solves a boundary value problem, by multiple shooting with the time $\tau$ for each segment,

$$ \varphi_\tau(x_i) = x_{i+1},\qquad P_u(x_m - x_*) = 0, $$

with the projection $P_u$ to the directions that grow at the equilibrium.  The conormals of the manifold are carried
back from the end; along them the corrections are found from the end to the start, a way on which they shrink, and along
all others from the start to the end.  Centre directions, of Casimirs or of oscillations, are left as they are.

References: [beyn1990].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OrbitError, ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.deadline import checkpoint
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.systems import HasField, without_value
from liepoisson.orbits.closing import exponential
from liepoisson.portable import elementary, linear

NEAR = 1e-7
"""How near to the equilibrium orbits are cut, relative to their largest distance: the rest is linear up to the square
of this."""
_SAFETY = 4.0
"""An orbit is followed for so much longer than ln(1/NEAR), in units of the slowest rate."""
OFF = float(np.finfo(float).eps) ** 0.5
"""How far a start may be from the manifold, relative to the largest distance: what depends on it changes by a first
order in this, which can be reported, and the second is round-off."""
_HYPERBOLIC = 1e-6
"""Relative size below which a real part is zero."""
_MOST_STEPS = 30
"""Newton's method doubles the digits with each step where it converges at all."""
UNDER_WAY = "the computation of homoclinic orbits"


@dataclass(frozen=True)
class AsymptoticOrbits:
    r"""Orbits on a stable manifold.

    Attributes:
        node: States between segments, shape (orbit, segment + 1, N).
        slope: The derivatives of segments, shape (orbit, segment, N, N).
        conormal: Orthonormal columns orthogonal to the centre-stable manifold at the nodes, shape
            (orbit, segment + 1, N, u).
        triangle: How they are carried back, $\Phi_i^Tu_{i+1} = u_iR_i$, shape (orbit, segment, u, u).
        off: Distances of the starts from the first nodes, shape (orbit,).
        aside: How far the last nodes are from the stable directions, shape (orbit,).
    """

    node: Array
    slope: Array
    conormal: Array
    triangle: Array
    off: Array
    aside: Array


@dataclass(frozen=True)
class StableManifold:
    """The stable manifold of an equilibrium, or the unstable one, on which times are counted backwards.

    Attributes:
        system: The system.
        limit: The equilibrium.
        way: 1 for the stable manifold, -1 for the unstable one.
        segment: The time of a segment, the inverse of the largest eigenvalue: neighbours grow by e along it.
        n_segments: How many lead from a start to the neighbourhood of the equilibrium.
        away: Rows that annihilate all but the growing directions, orthonormal, as columns, shape (N, u).
        stable: The stable directions, orthonormal, shape (N, s).
        inward: Takes a distance from the equilibrium to its coordinates in them, shape (s, N).
        rates: The linearised flow in these, shape (s, s).
    """

    system: HasField
    limit: Array
    way: int
    segment: float
    n_segments: int
    away: Array
    stable: Array
    inward: Array
    rates: Array

    @classmethod
    def of(cls, system: HasField, limit: Array, matrix: Array, way: int) -> StableManifold:
        """The manifold of an equilibrium at which the field has these derivatives.

        Raises:
            ParameterError: no eigenvalue has a real part.
        """
        matrix = way * matrix
        values, stable = _falling(matrix)
        if not stable.shape[1]:
            raise ParameterError("origin: wanted an equilibrium with a growing direction; it has only oscillations")
        _, left = _falling(matrix.T)
        inward = linear.solve(linear.matmul(left.T, stable), left.T)
        size, slowest = float(np.abs(linear.eigvals(matrix)).max()), float(np.abs(values.real).min())
        return cls(
            system, limit, way, 1 / size, int(np.ceil((_SAFETY - elementary.log(NEAR)) / slowest * size)),
            _falling(-matrix.T)[1], stable, inward, linear.matmul(linear.matmul(inward, matrix), stable),
        )  # fmt: skip

    def flow(self, starts: Array, times: Array, run: RunOptions, tangents: Array | None = None) -> tuple[Array, Array]:
        """States at times in units of the segment, shape (n, time, N), and tangent vectors as rows, (n, time, k, N).

        Raises:
            TimeLimitError: the deadline has passed.
        """
        checkpoint(UNDER_WAY)
        orbit = integrate(
            self.system, starts, times=self.way * self.segment * times, tangents=tangents, method=run.method,
            kernel="lanes", threads=run.threads, time_limit=run.left,
        )  # fmt: skip
        checkpoint(UNDER_WAY)
        return orbit.state, orbit.tangent

    def orbits(self, starts: Array, first: int, run: RunOptions) -> AsymptoticOrbits:
        """The orbits on the manifold that pass nearest to the starts, of which the first has this number.

        Raises:
            OrbitError: a start is the equilibrium or not near the manifold, or its orbit does not come near the
                equilibrium.
            TimeLimitError: the deadline has passed.
        """
        node, closest = self._guesses(starts, first, run)
        n, m, N = len(starts), self.n_segments, len(self.limit)
        size = linear.norm(node - self.limit, axis=2).max(axis=1)
        slope, conormal = np.zeros((n, m, N, N)), np.zeros((n, m + 1, *self.away.shape))
        triangle = np.zeros((n, m, *2 * self.away.shape[1:]))
        active, good = np.flatnonzero(self._has_values(node)), np.zeros(n, dtype=bool)
        for _ in range(_MOST_STEPS):
            if not active.size:
                break
            ends, tangents = self.flow(node[active, :-1].reshape(-1, N), np.array([0.0, 1.0]), run, np.eye(N))
            ends = ends[:, 1].reshape(-1, m, N)
            slopes = np.swapaxes(tangents[:, 1], 1, 2).reshape(-1, m, N, N)
            fine = np.isfinite(ends).all(axis=(1, 2)) & np.isfinite(slopes).all(axis=(1, 2, 3))
            active, ends, slopes = active[fine], ends[fine], slopes[fine]
            moves, conormal[active], triangle[active] = self._newton(starts[active], node[active], ends, slopes)
            node[active] += moves
            slope[active] = slopes
            largest = linear.norm(moves, axis=2).max(axis=1) / size[active]
            good[active] = largest < OFF
            active = active[(largest >= OFF) & (largest < 1) & self._has_values(node[active])]
        xi = node[:, -1] - self.limit
        off = linear.norm(node[:, 0] - starts, axis=1)
        aside = linear.norm(xi - linear.matmul(linear.matmul(xi, self.inward.T), self.stable.T), axis=1)
        good &= np.maximum(off, aside) < OFF * size
        if not good.all():
            k = int(good.argmin())
            raise OrbitError(
                "starts: wanted states on orbits that go to the equilibrium both ways, at most "
                f"{OFF:.1e} of their size off; orbit {first + k} comes no nearer than {closest[k]:.2g} at t "
                f"{'>' if self.way > 0 else '<'} 0, as far as such a state decides where it goes"
            )
        left = linear.norm(xi, axis=1)
        if (far := left >= NEAR * size).any():
            k = int(far.argmax())
            raise OrbitError(
                f"starts: wanted states from which the equilibrium is reached to {NEAR:.0e} of the orbit's size by "
                f"t = {self.way * self.segment * m:.4g}; orbit {first + k} is still {left[k]:.2g} from it; start "
                "nearer to its middle"
            )
        return AsymptoticOrbits(node, slope, conormal, triangle, off, aside)

    def _guesses(self, starts: Array, first: int, run: RunOptions) -> tuple[Array, Array]:
        """States between segments, and how near each orbit comes to the equilibrium.

        An orbit is followed as long as an error of `OFF` in its start cannot have grown to its distance from the
        equilibrium, and goes on by the linearised flow on the stable directions.

        Raises:
            OrbitError: a start is the equilibrium.
        """
        m = self.n_segments
        path, tangent = self.flow(starts, np.arange(m + 1.0), run, np.eye(len(self.limit)))
        node = path.copy()
        distance = linear.norm(node - self.limit, axis=2)
        if not distance[:, 0].all():
            raise OrbitError(
                f"starts: wanted states on homoclinic orbits; orbit {first + int(distance[:, 0].argmin())} starts at "
                "the equilibrium itself, and stays there; start at the orbit's middle"
            )
        growth = linear.norm(tangent, axis=(2, 3))
        followed = np.logical_and.accumulate(distance > OFF * growth * distance[:, :1], axis=1)
        last = followed.sum(axis=1) - 1
        flow = linear.matmul(self.stable, linear.matmul(exponential(self.segment * self.rates), self.inward))
        for i in range(1, m + 1):
            checkpoint(UNDER_WAY)
            beyond = i > last
            node[beyond, i] = self.limit + linear.matmul(node[beyond, i - 1] - self.limit, flow.T)
        return node, np.where(followed, distance, np.inf).min(axis=1)

    def _has_values(self, nodes: Array) -> NDArray[np.bool_]:
        """Where all invariants of the system are real numbers, shape (orbit,)."""
        fine = np.asarray(np.isfinite(nodes).all(axis=(1, 2)))
        for lost in without_value(self.system, np.where(fine[:, None, None], nodes, self.limit)).values():
            fine &= ~lost.any(axis=1)
        return fine

    def _newton(self, starts: Array, node: Array, ends: Array, slope: Array) -> tuple[Array, Array, Array]:
        r"""A step of Newton's method: corrections of all nodes, the conormals there, and their triangles.

        With columns $u_m$ that annihilate all but the growing directions, $\Phi_i^Tu_{i+1} = u_iR_i$ by QR, and
        $u_i^T\delta_i = r_i$ where $R_i^Tr_i = r_{i+1} - u_{i+1}^Tg_i$ with the gap $g_i$ of a segment.

        Args:
            starts: States that the first nodes are to be nearest to, shape (n, N).
            node: Shape (n, m + 1, N).
            ends: Those of segments, shape (n, m, N).
            slope: $\Phi_i$, shape (n, m, N, N).
        """
        n, m, _ = ends.shape
        gaps = ends - node[:, 1:]
        normals, rests = np.zeros((n, m + 1, *self.away.shape)), np.zeros((n, m + 1, self.away.shape[1]))
        triangles = np.zeros((n, m, *2 * self.away.shape[1:]))
        normals[:, m] = self.away
        rests[:, m] = -linear.matmul(node[:, m] - self.limit, self.away)
        for i in range(m - 1, -1, -1):
            checkpoint(UNDER_WAY)
            after = normals[:, i + 1]
            normals[:, i], triangles[:, i] = linear.qr(linear.matmul(np.swapaxes(slope[:, i], 1, 2), after))
            rest = rests[:, i + 1] - linear.einsum("nik,ni->nk", after, gaps[:, i])
            rests[:, i] = linear.solve(np.swapaxes(triangles[:, i], 1, 2), rest[..., None])[..., 0]
        moves = np.zeros(node.shape)
        moves[:, 0] = starts - node[:, 0]
        for i in range(m + 1):
            checkpoint(UNDER_WAY)
            if i:
                moves[:, i] = linear.einsum("nij,nj->ni", slope[:, i - 1], moves[:, i - 1]) + gaps[:, i - 1]
            short = rests[:, i] - linear.einsum("nik,ni->nk", normals[:, i], moves[:, i])
            moves[:, i] += linear.einsum("nik,nk->ni", normals[:, i], short)
        return moves, normals, triangles


def _falling(matrix: Array) -> tuple[NDArray[np.complex128], Array]:
    """The eigenvalues with negative real parts, and an orthonormal basis of their space, shape (N, k)."""
    found = linear.eig(matrix)
    values, vectors = found[0].astype(np.complex128), found[1].astype(np.complex128)
    chosen = values.real < -_HYPERBOLIC * np.abs(values).max(initial=0.0)
    some, k = vectors[:, chosen], int(chosen.sum())
    basis = linear.svd(np.hstack([some.real, some.imag]))[0][:, :k] if k else np.zeros((len(matrix), 0))
    return values[chosen], basis
