"""Exponents energy by energy on one leaf: the mixture behind a mean over random starts, taken apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.arrays import Array, as_array
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.numeric._checks import TIME_LIMIT, HasField, as_count, as_field, as_number, shown, typical
from liepoisson.numeric.estimates import Estimate, Resampling
from liepoisson.numeric.exponent_estimate import bootstrap_mean, zero_threshold
from liepoisson.numeric.lyapunov import lyapunov_exponent
from liepoisson.numeric.methods import Method
from liepoisson.numeric.proportions import proportion
from liepoisson.numeric.tangent_frames import as_duration

_MOST = 10_000_000


class SampledLeaf(Protocol):
    """What is needed of a `Leaf`: its Casimirs, and random states of an energy with the microcanonical measure."""

    @property
    def casimirs(self) -> dict[str, float]: ...  # noqa: D102
    def sample(self, n: int, *, seed: int, energy: float | None = None) -> Array: ...  # noqa: D102


@dataclass(frozen=True)
class EnergyProfile:
    """Finite-time exponents at several energies of one leaf.

    Attributes:
        system: Name of the system.
        casimirs: Values of the Casimirs of the leaf.
        energy: Shape (energy,).
        t_end: Time of each exponent.
        exponent: Exponents at `t_end`, in inverse time, shape (energy, trajectory); NaN for runs that failed.
        outcome: How each run ended, shape (energy, trajectory).
        mean: Mean exponent at each energy, with bootstrap errors over the starts; of NaN with fewer than two runs.
        threshold: What counts as chaotic: a larger exponent.
        fraction: Share of the starts at each energy whose exponent is above the threshold, with Wilson's interval;
            of NaN without runs.  With the default threshold a lower bound of the chaotic share of the energy surface.
    """

    system: str
    casimirs: dict[str, float]
    energy: Array
    t_end: float
    exponent: Array
    outcome: NDArray[np.str_]
    mean: tuple[Estimate, ...]
    threshold: float
    fraction: tuple[Estimate, ...]

    def __str__(self) -> str:
        leaf = ", ".join(f"{name} = {value:.4g}" for name, value in self.casimirs.items())
        lines = [
            f"{self.system}, {leaf}; {self.exponent.shape[1]} starts per energy, t = {self.t_end:g}, "
            f"chaotic above {self.threshold:.2g}",
            "  energy  mean exponent      chaotic at least",
        ]
        for energy, mean, fraction in zip(self.energy, self.mean, self.fraction, strict=True):
            lines.append(f"{energy:8.4g}  {mean!s:17}  {fraction.value:.2f} [{fraction.low:.2f}, {fraction.high:.2f}]")
        return "\n".join(lines)

    def __repr__(self) -> str:
        n_energies, n = self.exponent.shape
        energies = f"{n_energies} energies from {self.energy.min():.4g} to {self.energy.max():.4g}"
        value = typical("exponent", self.exponent.ravel())
        return f"<EnergyProfile of {self.system}: {energies}, {n} starts each, {value} at t = {self.t_end:g}>"


def exponents_by_energy(
    system: HasField,
    *,
    leaf: SampledLeaf,
    energies: ArrayLike,
    n: int,
    t_end: float,
    threshold: float | None = None,
    seed: int = 0,
    confidence: float = 0.95,
    method: Method | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> EnergyProfile:
    r"""Mean exponent, and a lower bound of the chaotic share, at each energy of a leaf.

    Starts have the microcanonical measure, which the flow preserves: the fraction of chaotic starts estimates the
    chaotic share of the energy surface.  What is counted are exponents above $3\ln t/t$, and a chaotic orbit that is
    weak, or sticks until t, is below: the fraction estimates a lower bound.  For the twisted Kovalevskaya top, on one
    leaf at E = -1.2, it is 0.62 at t = 1,000, where `decide` finds 0.96 at t = 5,000.  The same seed is used at each
    energy.

    Args:
        system: The system.
        leaf: The leaf, a `Leaf` of the system: of the same one, or of one with the same bracket and field.
        energies: Values of the Hamiltonian, shape (energy,); `leaf.energy_range()` tells which occur.
        n: Starts at each energy, at most 10,000,000.
        t_end: Time of the exponents, positive.
        threshold: Exponent above which an orbit counts as chaotic, >= 0; by default $3\ln t/t$.  Weak chaos below is
            missed, as are orbits that stick until then; the default takes the natural time of the system to be about 1.
        seed: Draws starts and tangent vectors.
        confidence: Coverage of the intervals.
        method: How; by default `Taylor(tol=1e-13)`.
        threads: By default all processors.  Results do not depend on it, bit for bit.
        time_limit: Seconds that the runs of one energy may take.
        progress: Called with the fraction that is done.

    Raises:
        LeafError: an energy does not occur on the leaf, or its energy surface has infinite volume.
        ShapeError: `energies` is not one-dimensional.
        ParameterError: numbers out of range, or no leaf, or one of another system.

    References: Wilson, J. Amer. Statist. Assoc. 22 (1927) 209.
    """
    _check_leaf(system, leaf)
    values = np.atleast_1d(as_array(energies, "energies"))
    if values.ndim != 1 or values.size == 0:
        raise ShapeError(f"energies must have shape (energy,) with one or more energies; got shape {values.shape}.")
    n, t_end = as_count(n, "n", least=1, most=_MOST, hint="try n=100"), as_duration(t_end, "t_end")
    limit = float(zero_threshold(t_end)) if threshold is None else as_number(threshold, "threshold", "a number >= 0")
    if not 0.0 <= limit < np.inf:
        raise ParameterError(f"threshold: wanted a finite number >= 0; got {limit}; leave it out for 3 ln t / t")
    resampling = Resampling(confidence=confidence, seed=seed)
    exponents, outcomes = np.empty((len(values), n)), np.empty((len(values), n), dtype="<U32")
    for k, energy in enumerate(values):
        listen = None if progress is None else (lambda part, k=k: progress((k + part) / len(values)))
        growth = lyapunov_exponent(
            system,
            leaf.sample(n, seed=seed, energy=float(energy)),
            times=[t_end],
            seed=seed,
            method=method,
            threads=threads,
            time_limit=time_limit,
            progress=listen,
        )
        exponents[k], outcomes[k] = growth.exponent[:, -1], growth.outcome
    finished = [row[np.isfinite(row)] for row in exponents]
    nothing = Estimate(*[float("nan")] * 4)
    return EnergyProfile(
        system=system.name,
        casimirs=leaf.casimirs,
        energy=values,
        t_end=t_end,
        exponent=exponents,
        outcome=outcomes,
        mean=tuple(bootstrap_mean(row, resampling) if len(row) > 1 else nothing for row in finished),
        threshold=limit,
        fraction=tuple(
            proportion(int(np.sum(row > limit)), len(row), confidence=confidence) if len(row) else nothing
            for row in finished
        ),
    )


def _check_leaf(system: Any, leaf: Any) -> None:
    """Refuses what is no leaf, and leaves of another system: their states have other Casimirs, or another measure."""
    if not hasattr(leaf, "casimirs") or not callable(getattr(leaf, "sample", None)):
        raise ParameterError(f"leaf: wanted a Leaf; got {shown(leaf)}; try leaf_of(system, x0)")
    other = getattr(leaf, "system", system)
    if other is not system and not _are_the_same(system, other):
        raise ParameterError(
            f"leaf: wanted a leaf of the system {shown(system.name)}; got one of {shown(other.name)}, with another "
            "bracket or field; try leaf_of(system, x0)"
        )


def _are_the_same(system: Any, other: Any) -> bool:
    """Whether field and Poisson tensor agree at a few states of no special position."""
    n = as_field(system).n_components
    if as_field(other).n_components != n:
        return False
    if not hasattr(system, "functions"):  # no bracket to compare
        return as_field(system) == as_field(other)
    states = np.random.default_rng(0).standard_normal((4, n))
    with np.errstate(all="ignore"):  # outside of the domain of a Hamiltonian both are NaN
        pairs = [(s.functions.poisson_tensor(states), s.functions.rates(states)) for s in (system, other)]
    # 1e-9: the same formulas in another order differ by round-off
    return all(np.allclose(*both, rtol=1e-9, atol=1e-9, equal_nan=True) for both in zip(*pairs, strict=True))
