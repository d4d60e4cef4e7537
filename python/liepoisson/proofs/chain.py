r"""Chains of h-sets along a periodic and a homoclinic orbit: the certificate of a proof by covering relations.

A set has a centre c and a frame B, whose columns are k unstable vectors, the flow, k stable vectors, and the gradients of
H and the Casimirs:

$$ N = \{\, c + B(q_u, 0, q_s, w) : |q_u| \le 1,\ |q_s| \le 1 \,\}, $$

w being fixed by the level.  An edge says that the set i, after a time and perhaps the symmetry, maps across the set j.

**The adapted norm.** The map across one segment may contract an unstable direction although all grow in the long run, so
no fixed norm will do.  With the matrices $K_j$ of the segments on the unstable spaces and

$$ P_{j+1} = 1 + \kappa^2 K_j^{-T} P_j K_j^{-1}, $$

$|K_j y|_{P_{j+1}} \ge \kappa\,|y|_{P_j}$ holds on every segment.  The recursion begins at its fixed point along the
periodic orbit and stays bounded where the growth over many segments is faster than $\kappa$.

References: [zgliczynski2004].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.arrays import Array, ReadOnlyArrays
from liepoisson.errors import OrbitError
from liepoisson.exact.system_text import formula_text
from liepoisson.orbits.homoclinic import lengthened
from liepoisson.orbits.level import Level
from liepoisson.orbits.multipliers import transversal_basis
from liepoisson.orbits.shooting import Flow

if TYPE_CHECKING:
    from liepoisson.exact.discrete_symmetries import DiscreteSymmetry
    from liepoisson.orbits.homoclinic_orbits import HomoclinicOrbit
    from liepoisson.orbits.periodic_orbits import SymmetricOrbit

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
    """

    level: Level
    symmetry: tuple[int, ...]
    sets: tuple[HSet, ...]
    edges: tuple[Edge, ...]

    def record(self) -> dict[str, Any]:
        """The chain as plain data: doubles as C99 hexadecimal texts, rational numbers as texts.

        Raises:
            OrbitError: a value of the level is no rational number.
        """
        system = self.level.system
        equations = {str(x): formula_text(rate) for x, rate in system.equations.items()}
        return {
            "system": {"name": system.name, "equations": equations},
            "level": {name: _rational(name, value) for name, value in self.level.values.items()},
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
    from fractions import Fraction

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
        first, last, middle = orbit.first, orbit.last, homoclinic.reverser
        closing = last.matrix @ first.matrix
        if not np.array_equal(closing, np.diag(np.diag(closing))):
            raise OrbitError("the loop of the orbit must be closed by changes of signs; it exchanges components")
        # the mirror image of the orbit under the reverser of the midpoint must begin at its start, or at P of it
        if middle.matrix.tolist() == last.matrix.tolist():
            flag = True
        elif middle.matrix.tolist() == first.matrix.tolist():
            flag = False
        else:
            raise OrbitError("the midpoint must be in one of the two fixed sets that the periodic orbit meets")
        flag = flag and not np.array_equal(closing, np.eye(len(closing)))
        P = closing
        a, b = orbit.start, orbit.end
        U_a = self._unstable()
        U_b, K_ab = self._next(a, orbit.time, U_a, b, None)
        back, K_ba = self._next(b, orbit.time, U_b, a, P, U_a)
        norm_a, norm_b = self._norms(K_ab, K_ba)
        homoclinic = self._lengthened(homoclinic, norm_a)
        start, half = homoclinic.start, homoclinic.time
        n = max(2, round(half / orbit.time))
        tau = half / n
        path, spaces, maps = [start], [U_a], []
        centers = self._centers(start, tau, n, homoclinic)
        for j in range(2 * n):
            ends_here = j == 2 * n - 1
            target = a if ends_here else centers[j + 1]
            U, K = self._next(
                start if j == 0 else centers[j],
                tau,
                spaces[-1],
                target,
                P if ends_here and flag else None,
                U_a if ends_here else None,
            )
            spaces.append(U)
            maps.append(K)
        del back, path
        norms = [norm_a]
        for K in maps:
            norms.append(self._carried(norms[-1], K))
        scaled = [self._scaled(U, norm) for U, norm in zip(spaces, norms, strict=True)]
        u_a, u_b = self._scaled(U_a, norm_a), self._scaled(U_b, norm_b)
        sets = [
            HSet("p_a", a, self._frame(a, u_a, first.matrix @ u_a)),
            HSet("p_b", b, self._frame(b, u_b, last.matrix @ u_b)),
        ]
        for j in range(1, 2 * n):
            frame = self._frame(centers[j], scaled[j], middle.matrix @ scaled[2 * n - j])
            sets.append(HSet(f"q{j}", centers[j], frame))
        names = ["p_a", *(f"q{j}" for j in range(1, 2 * n)), "p_a"]
        has_symmetry = not np.array_equal(P, np.eye(len(P)))
        edges = [Edge("p_a", "p_b", orbit.time, False), Edge("p_b", "p_a", orbit.time, has_symmetry)]
        edges += [Edge(names[j], names[j + 1], tau, flag and j == 2 * n - 1) for j in range(2 * n)]
        signs = tuple(int(s) for s in np.diag(P))
        return Chain(orbit.level, signs, tuple(sets), tuple(edges))

    def _unstable(self) -> Array:
        """The unstable vectors at the start of the orbit, orthonormal, across the flow, shape (N, k)."""
        from liepoisson.orbits.unstable import unstable_space

        space = unstable_space(self.orbit)
        across = self._across(self.orbit.start)
        return np.linalg.qr(across @ (across.T @ space.basis))[0]

    def _across(self, x: Array) -> Array:
        return transversal_basis(self.orbit.level.gradients(x), self.orbit.system.vector_field(x))

    def _next(
        self, start: Array, time: float, U: Array, target: Array, symmetry: Array | None, basis: Array | None = None
    ) -> tuple[Array, Array]:
        """The vectors after a segment in a basis across the flow at the target, and the matrix of the map."""
        (_,), (moved,) = self.flow.ends(start[None], np.array([time]), U)
        if symmetry is not None:
            moved = symmetry @ moved
        across = self._across(target)
        moved = across @ (across.T @ moved)
        if basis is None:
            return np.linalg.qr(moved)
        return basis, np.linalg.lstsq(basis, moved, rcond=None)[0]

    def _carried(self, norm: Array, K: Array) -> Array:
        back = np.linalg.inv(K)
        return np.eye(len(K)) + self.kappa**2 * back.T @ norm @ back

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
        values, vectors = np.linalg.eigh(norm)
        return self.radius * U @ (vectors / np.sqrt(values)) @ vectors.T

    def _frame(self, x: Array, unstable: Array, stable: Array) -> Array:
        return np.column_stack([unstable, self.orbit.system.vector_field(x), stable, self.orbit.level.gradients(x).T])

    def _lengthened(self, homoclinic: HomoclinicOrbit, norm: Array) -> HomoclinicOrbit:
        """The same from a start so near to the periodic orbit that it is well inside of its set."""
        largest = float(np.linalg.eigvalsh(norm).max())
        size = float(np.linalg.norm(homoclinic.amplitude) * np.sqrt(largest)) / self.radius
        slowest = float(np.abs(np.linalg.eigvals(homoclinic.space.matrix)).min())
        return lengthened(homoclinic, max(0, int(np.ceil(np.log(size / _INSIDE) / np.log(slowest)))))

    def _centers(self, start: Array, tau: float, n: int, homoclinic: HomoclinicOrbit) -> list[Array]:
        """Points of the excursion at all ends of segments; the second half is the mirror image of the first."""
        from liepoisson.numeric.integrate import integrate

        first = integrate(self.orbit.system, start, times=np.arange(n + 1) * tau, kernel="lanes").state[0]
        middle = (first[-1] + homoclinic.reverser(first[-1])) / 2
        half = [*first[:-1], middle]
        return [*half, *(homoclinic.reverser(x) for x in reversed(first[:-1]))]


_INSIDE = 0.25
"""Where a homoclinic orbit begins in the set of the periodic orbit, as a part of its size."""


def with_polished_ends(orbit: SymmetricOrbit, digits: int = 25) -> SymmetricOrbit:
    """The orbit with start, end and time rounded from numbers of many digits."""
    precise = orbit.polished(digits=digits)
    return replace(
        orbit,
        start=np.array([float(v) for v in precise.start]),
        end=np.array([float(v) for v in precise.end]),
        time=float(precise.time),
    )


def signs_of(symmetry: DiscreteSymmetry) -> Mapping[str, int]:
    """The sign of each component, by name."""
    return dict(zip(symmetry.system.component_names, symmetry.signs, strict=True))
