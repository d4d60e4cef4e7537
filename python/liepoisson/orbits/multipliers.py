r"""Symmetric periodic orbits, lists of them, and their multipliers, with a check of the structure that these must have.

The derivative D of the flow along one loop, followed by the symmetry that closes it, has the trivial multipliers 1 of
the flow and of H and the Casimirs.  They are divided out exactly, not picked out of a spectrum: with an orthonormal
basis Q of the vectors that are orthogonal to the flow, in the level,

$$ M = Q^T D Q $$

has the others.  M is symplectic, so its multipliers come in pairs $\mu, 1/\mu$, and $w = \mu + 1/\mu$ is a double
eigenvalue of $M + M^{-1}$.  $M^{-1}$ is computed by running the loop backwards; hence large and small multipliers are
accurate alike, and the two values of w are a check.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.formula.scalars import as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import counted
from liepoisson.io.tables import vector_columns
from liepoisson.orbits.level import Level
from liepoisson.orbits.saved_orbits import SavedOrbits, SearchedOrbits
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.refine import PreciseSegment

ComplexArray = NDArray[np.complex128]

HYPERBOLIC = 1e-6
"""How far a multiplier must be from the unit circle: a double one at 1 scatters by the root of the round-off."""


@dataclass(frozen=True)
class LoopSpectrum:
    r"""The multipliers of a loop.

    Attributes:
        values: The multipliers, the largest first, then their reciprocals in the same order, shape (2m - 2,).
        pair_defect: The largest difference between the two computed values of a $\mu + 1/\mu$, relative to the largest.
        trivial_defect: How far the flow, H and the Casimirs are from being kept by D: the larger one of
            $|Df - f|/|f|$ and $|D^T\nabla C - \nabla C|/|\nabla C|$, relative to $|D|$.
        expanding: The matrix M, shape (2m - 2, 2m - 2).
        basis: The columns Q, shape (N, 2m - 2).
    """

    values: ComplexArray
    pair_defect: float
    trivial_defect: float
    expanding: Array
    basis: Array


def transversal_basis(gradients: Array, rates: Array) -> Array:
    """An orthonormal basis of the vectors that are orthogonal to the gradients and to the flow, shape (..., N, k)."""
    rows = np.concatenate([gradients, np.atleast_2d(rates)], axis=-2)
    rows = rows / linear.norm(rows, axis=-1, keepdims=True)
    left = linear.svd(np.swapaxes(rows, -1, -2), full_matrices=True)[0]
    return left[..., rows.shape[-2] :]


def loop_spectrum(forwards: Array, backwards: Array, gradients: Array, rates: Array) -> LoopSpectrum:
    """The multipliers of a loop.

    Args:
        forwards: The derivative of the loop, shape (N, N).
        backwards: That of the loop run backwards.
        gradients: The gradients of H, the Casimirs and other held functions where it begins, shape (function, N).
        rates: The vector field there, shape (N,), and those of symmetries, shape (field, N).
    """
    return loop_spectra(forwards[None], backwards[None], gradients[None], np.atleast_2d(rates)[None])[0]


def loop_spectra(forwards: Array, backwards: Array, gradients: Array, rates: Array) -> list[LoopSpectrum]:
    """The multipliers of loops: arrays as for one, along a first axis, and fields of shape (loop, field, N)."""
    bases = transversal_basis(gradients, rates)
    across = np.swapaxes(bases, -1, -2)
    forth, back = (linear.matmul(linear.matmul(across, one), bases) for one in (forwards, backwards))
    size = linear.norm(forwards, 2, axis=(-2, -1))
    off = (
        linear.matmul(rates, np.swapaxes(forwards, -1, -2)) - rates,
        linear.matmul(gradients, forwards) - gradients,
    )
    trivial = np.maximum(*(
        (linear.norm(moved, axis=-1) / linear.norm(kept, axis=-1)).max(axis=-1)
        for moved, kept in zip(off, (rates, gradients), strict=True)
    ))  # fmt: skip
    found = map(_paired, linear.eigvals(forth + back).astype(np.complex128))
    return [
        LoopSpectrum(values, defect, float(trivial[k] / size[k]), forth[k], bases[k])
        for k, (values, defect) in enumerate(found)
    ]


def _paired(sums: ComplexArray) -> tuple[ComplexArray, float]:
    r"""Multipliers from the eigenvalues $\mu + 1/\mu$, which are double, and how far they are from being so."""
    left = sorted(sums.tolist(), key=lambda w: (-abs(w), w.imag))
    large: list[complex] = []
    defect, scale = 0.0, max((abs(w) for w in left), default=1.0)
    while left:
        one = left.pop(0)
        k = min(range(len(left)), key=lambda k: abs(left[k] - one))
        other = left.pop(k)
        defect = max(defect, abs(one - other) / scale)
        w = (one + other) / 2
        root = complex(np.sqrt(complex(w * w - 4)))
        large.append(max((w + root) / 2, (w - root) / 2, key=lambda m: (abs(m), m.imag)))
    large.sort(key=lambda m: (-round(abs(m), 9), -m.imag))
    return np.array([*large, *(1 / m for m in large)], dtype=np.complex128), defect


def kind_of(values: ComplexArray) -> str:
    """What multipliers say of a loop: "hyperbolic", "elliptic", "mixed" or, where there is none, "neutral"."""
    if not values.size:
        return "neutral"
    off = np.abs(np.abs(values) - 1) > HYPERBOLIC
    return "hyperbolic" if off.all() else "mixed" if off.any() else "elliptic"


def growth_rate(values: ComplexArray, time: float) -> float:
    r"""$\ln\max|\mu|$ over the time of the loop; 0 if all multipliers are on the unit circle."""
    if kind_of(values) in {"neutral", "elliptic"}:
        return 0.0
    return float(elementary.log(np.abs(values).max())) / time


_CLOSED = 1e-9


class ClosedOrbit(SavedOrbits):
    """A periodic orbit, however it was found: what its start, its times and its multipliers say."""

    level: Level
    start: Array
    multipliers: ComplexArray
    residual: float
    pair_defect: float
    trivial_defect: float

    @property
    @abstractmethod
    def return_time(self) -> float:
        """The time of the loop that has the multipliers: it closes up to a symmetry, or to rotations."""

    @property
    @abstractmethod
    def period(self) -> float:
        """The time after which it closes without the symmetry."""

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.level.system

    @property
    def energy(self) -> float:
        """The value of H."""
        return float(self.system.functions.energy(self.start))

    @property
    def rate(self) -> float:
        r"""$\ln\max|\mu|$ over `return_time`, the growth rate of neighbours, in inverse time.

        0 if all multipliers are on the unit circle.
        """
        return growth_rate(self.multipliers, self.return_time)

    @property
    def stability(self) -> str:
        """The multipliers are off the unit circle ("hyperbolic"), on it ("elliptic"), or both ("mixed").

        "neutral" where there are no multipliers but the trivial ones, as on a leaf of dimension 2.
        """
        return kind_of(self.multipliers)

    @property
    def multiplier_words(self) -> str:
        """The multipliers as tables show them: one of each reciprocal pair, with five digits."""
        half = self.multipliers[: len(self.multipliers) // 2].tolist()
        return ", ".join(f"{m if m.imag else m.real:.5g}" for m in half)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table, which has one row: level, period, stability, start and multipliers."""
        return orbit_columns((self,), self.system)

    def states(self, n_times: int = 201) -> Array:
        """States at evenly spaced times over one period, from the start to the start, shape (n_times, N)."""
        from liepoisson.numeric.integrate import integrate

        n_times = as_count(n_times, "n_times", least=2)
        return integrate(self.system, self.start, times=np.linspace(0.0, self.period, n_times)).state[0].copy()


def orbit_columns(orbits: Sequence[ClosedOrbit], system: System) -> dict[str, NDArray[Any]]:
    """The columns of a table of orbits: energy, Casimirs, times, stability, start and multipliers of each."""
    listed = ("period", "rate", "stability", "residual", "pair_defect", "trivial_defect", "return_time")
    names, functions = system.component_names, system.functions
    starts = np.array([one.start for one in orbits], dtype=float).reshape(len(orbits), len(names))
    multipliers = np.array([one.multipliers for one in orbits], dtype=np.complex128)
    return {
        **{name: f(starts) for name, f in {"energy": functions.energy, **functions.casimirs}.items()},
        **{name: np.array([getattr(one, name) for one in orbits]) for name in listed},
        **vector_columns("start", starts, names),
        **vector_columns("multiplier_real", multipliers.real),
        **vector_columns("multiplier_imaginary", multipliers.imag),
    }


@explains_its_methods
@dataclass(frozen=True, eq=False)
class SymmetricOrbit(ClosedOrbit):
    r"""A periodic orbit that meets the fixed sets of two reversers $\rho_0$ and $\rho_1$, perhaps one and the same.

    It is made of one segment, from `start` to `end`, and its mirror images: with $P = \rho_1\rho_0$,

    $$ \varphi_{2T}(x) = P x , \qquad x = \rho_0 x, \quad \varphi_T(x) = \rho_1\varphi_T(x) . $$

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> orbit = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)[0]
        >>> round(orbit.period, 6), orbit.stability
        (6.794385, 'hyperbolic')

    Attributes:
        level: The energy and the leaf.
        first: $\rho_0$.
        last: $\rho_1$.
        start: The state x in $\mathrm{Fix}\,\rho_0$, shape (N,).
        end: The state $\varphi_T(x)$ in $\mathrm{Fix}\,\rho_1$, shape (N,).
        time: T, the time of the segment.
        residual: How far the computed end is from the fixed set, or the start from the level, in units of the level.
        multipliers: Those of the loop $P^{-1}\varphi_{2T}$ on the level across the flow, the largest first, then their
            reciprocals in the same order, shape (2m - 2,).  Where the period is 4T and $P^2 = 1$, those over the period
            are their squares.
        pair_defect: A check of the multipliers: how far they are from reciprocal pairs (see
            `liepoisson.orbits.multipliers`); round-off.
        trivial_defect: Another: how far the flow, H and the Casimirs are from the multiplier 1; round-off.
    """

    kind = "symmetric orbit"
    made_by = "lp.orbits.symmetric_periodic_orbits"

    level: Level
    first: DiscreteSymmetry
    last: DiscreteSymmetry
    start: Array
    end: Array
    time: float
    residual: float
    multipliers: ComplexArray
    pair_defect: float
    trivial_defect: float

    @property
    def return_time(self) -> float:
        """2T: after this time the orbit is at the image of its start under P."""
        return 2 * self.time

    @property
    def period(self) -> float:
        """The time after which it closes: 2T times the number of images of the start under P."""
        closing = linear.matmul(self.last.matrix, self.first.matrix)
        x, n = linear.matmul(closing, self.start), 1
        while np.abs((x - self.start) / self.level.units).max() > _CLOSED:
            x, n = linear.matmul(closing, x), n + 1
        return n * self.return_time

    @property
    def slowest(self) -> float:
        """The smallest modulus of the unstable multipliers, 1 if some multiplier is on the unit circle."""
        half = len(self.multipliers) // 2
        return float(np.abs(self.multipliers[:half]).min()) if self.stability == "hyperbolic" else 1.0

    def polished(self, *, digits: int = 30) -> PreciseSegment:
        """The segment to any number of digits, by Newton's method in the arithmetic of Arb.

        Raises:
            ParameterError: the equations are no polynomials.
            OrbitError: Newton's method does not converge.
        """
        from liepoisson.orbits.refine import refined_segment

        return refined_segment(self, digits)

    def __repr__(self) -> str:
        loop = "" if self.period == self.return_time else f" in 2T = {self.return_time:.8g}"
        big = f", |mu| = {abs(self.multipliers[0]):.6g}{loop}" if self.multipliers.size else ""
        return f"<SymmetricOrbit of {self.system.name!r}: period {self.period:.8g}, {self.stability}{big}>"


@dataclass(frozen=True, eq=False, repr=False)
class SymmetricOrbits(SearchedOrbits[SymmetricOrbit]):
    """Symmetric periodic orbits of a level, those with the largest growth rate first.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)
        >>> [(round(orbit.period, 3), orbit.stability) for orbit in found[:2]]
        [(6.794, 'hyperbolic'), (6.11, 'elliptic')]

    Attributes:
        level: The level.
        found: The orbits; of those that symmetries of the system take to one another, one.
        reversers: The reversers that were used.
        t_end: The longest segment that was looked for.
        n_starts: How many starts were taken for each pair of reversers, at most where the time limit ended the search.
        n_families: How many segments were left out since they have a further multiplier 1, and so are most likely not
            isolated on the level.
        is_cut_short: Whether the time limit ended the search.
    """

    kind = "symmetric orbits"
    made_by = "lp.orbits.symmetric_periodic_orbits"
    titles = ("period", "2T", "rate", "stability", "multipliers in 2T", "residual", "pairs")

    level: Level
    found: tuple[SymmetricOrbit, ...]
    reversers: tuple[DiscreteSymmetry, ...]
    t_end: float
    n_starts: int
    n_families: int
    is_cut_short: bool = False

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.level.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its period, stability, start and multipliers."""
        return orbit_columns(self.found, self.system)

    def _head(self) -> str:
        where = f"of {self.system.name!r} on {self.level.text}, with segments up to {self.t_end:g}"
        starts = f"{{}} starts for each pair of {counted(len(self.reversers), 'reverser')}"
        return self._sentence("symmetric periodic orbit", where, starts, "segments that belong to families")

    def _row(self, one: SymmetricOrbit, /) -> tuple[str, ...]:
        times = f"{one.period:.8f}", f"{one.return_time:.8f}", f"{one.rate:.4f}"
        return *times, one.stability, one.multiplier_words, f"{one.residual:.0e}", f"{one.pair_defect:.0e}"
