"""What a sweep found, point by point, with its statistics."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.arrays import Array
from liepoisson.numeric.proportions import wilson_interval
from liepoisson.sweeps.execute import Report
from liepoisson.sweeps.lattice import Place
from liepoisson.sweeps.spec import SweepSpec
from liepoisson.sweeps.tasks import FAILED, NOT_COMPUTED, OUTCOMES

if TYPE_CHECKING:
    from xarray import Dataset


_PER_POINT = ("mean", "standard_error", "low", "high", "n_finished", "chaotic_fraction")
_DIMENSIONS = ("member", "point", "level")
OWN_NAMES = frozenset([*_DIMENSIONS, *_PER_POINT, "exponent", "value", "outcome"])
"""Variables and dimensions of the dataset of a sweep, which no axis may be taken for."""


@dataclass(frozen=True)
class Sweep:
    """The values of a sweep at its points.

    Attributes:
        spec: What was asked.
        places: The points on the lattice, see `liepoisson.sweeps.lattice`.
        points: Values of the axes, shape (point, axis).
        level: 0 for the grid, then the level of refinement that added the point, shape (point,).
        value: Exponents in inverse time, or values of the quantity, shape (point, member); NaN where an orbit failed.
        outcome_code: How each orbit ended, shape (point, member), as numbers of `OUTCOMES`.
        method: How orbits were integrated, in words.
        held: What is the same at all points, in words.
        reports: How the pieces of each level went.
        n_reused: Points that were read from the store.
        n_damaged: Pieces of the store that were damaged and computed anew.
        store: The folder with the results, or None.
    """

    spec: SweepSpec
    places: tuple[Place, ...]
    points: Array
    level: NDArray[np.int64]
    value: Array
    outcome_code: NDArray[np.int8]
    method: str
    held: tuple[str, ...]
    reports: tuple[Report, ...]
    n_reused: int
    n_damaged: int
    store: Path | None

    @property
    def outcome(self) -> NDArray[np.str_]:
        """How each orbit ended, by name: one of `OUTCOMES`; shape (point, member)."""
        return np.array(OUTCOMES)[self.outcome_code]

    @property
    def outcomes(self) -> dict[str, int]:
        """How many orbits ended in each way."""
        codes, counts = np.unique(self.outcome_code, return_counts=True)
        return {OUTCOMES[code]: int(count) for code, count in zip(codes, counts, strict=True)}

    @property
    def is_complete(self) -> bool:
        """Whether all points were computed; one at which there is no system counts as computed."""
        return not np.isin(self.outcome_code, (NOT_COMPUTED, FAILED)).any()

    @property
    def failed(self) -> tuple[str, ...]:
        """Why pieces and points failed for good, one line for each."""
        return tuple(
            f"level {k}, {what} {number}: {why}"
            for k, report in enumerate(self.reports)
            for what, failed in (("piece", report.failed), ("point", report.points))
            for number, why in failed.items()
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """What else is to be told: workers that refused, a refinement that was not done."""
        return tuple(remark for report in self.reports for remark in report.remarks)

    @property
    def n_finished(self) -> NDArray[np.int64]:
        """Orbits with a value, shape (point,)."""
        return np.isfinite(self.value).sum(axis=1)

    @property
    def mean(self) -> Array:
        """Mean over the orbits with a value, shape (point,); NaN where there is none."""
        counts = self.n_finished
        return np.where(counts > 0, np.nansum(self.value, axis=1) / np.maximum(counts, 1), np.nan)

    @property
    def standard_error(self) -> Array:
        """Of the mean over the starts, shape (point,); NaN for fewer than two."""
        counts, mean = self.n_finished, self.mean
        squares = np.nansum((self.value - mean[:, None]) ** 2, axis=1)
        with np.errstate(all="ignore"):
            return np.where(counts > 1, np.sqrt(squares / np.maximum(counts - 1, 1) / np.maximum(counts, 1)), np.nan)

    @property
    def n_chaotic(self) -> NDArray[np.int64]:
        """Orbits whose exponent is above the threshold, shape (point,)."""
        return (np.nan_to_num(self.value, nan=-np.inf) > self.spec.chaos_threshold).sum(axis=1)

    @property
    def chaotic_fraction(self) -> Array:
        """Share of the orbits with a value whose exponent is above the threshold, shape (point,)."""
        with np.errstate(all="ignore"):
            return np.where(self.n_finished > 0, self.n_chaotic / np.maximum(self.n_finished, 1), np.nan)

    def interval(self, confidence: float = 0.95) -> tuple[Array, Array]:
        """Wilson's interval of the chaotic fraction, or the normal one of the mean, shape (point,) each.

        It tells of the starts at hand as a random sample; points share their starts, so their errors are correlated.
        """
        if self.spec.quantity == "chaotic_fraction":
            return wilson_interval(self.n_chaotic, self.n_finished, confidence)
        half = NormalDist().inv_cdf((1 + confidence) / 2) * self.standard_error
        return self.mean - half, self.mean + half

    @property
    def statistic(self) -> Array:
        """What the sweep is about: the chaotic fraction, or the mean; shape (point,)."""
        return self.chaotic_fraction if self.spec.quantity == "chaotic_fraction" else self.mean

    @property
    def overhead(self) -> float:
        """Seconds of a worker beside its pieces, for each piece that was computed here; NaN if none was."""
        pieces = sum(report.n_pieces for report in self.reports)
        return sum(r.overhead_per_piece * r.n_pieces for r in self.reports) / pieces if pieces else math.nan

    @property
    def dataset(self) -> Dataset:
        """The same as a labelled xarray Dataset: on the grid of the axes, or, refined, along one axis of points.

        An axis that is called like a variable or dimension of the dataset itself is `axis_NAME` there: `axis_mean`.
        """
        from xarray import Dataset

        names = tuple(f"axis_{axis.name}" if axis.name in OWN_NAMES else axis.name for axis in self.spec.axes)
        is_grid = self.spec.refine is None
        dims = names if is_grid else ("point",)
        shape = self.spec.shape if is_grid else (len(self.points),)
        low, high = self.interval()
        per_point: Mapping[str, Any] = {
            "mean": self.mean,
            "standard_error": self.standard_error,
            "low": low,
            "high": high,
            "n_finished": self.n_finished,
            **({"chaotic_fraction": self.chaotic_fraction} if self.spec.is_exponent else {}),
        }
        variables: dict[str, Any] = {name: (dims, values.reshape(shape)) for name, values in per_point.items()}
        name = "exponent" if self.spec.is_exponent else "value"
        variables[name] = ((*dims, "member"), self.value.reshape(*shape, -1))
        variables["outcome"] = ((*dims, "member"), self.outcome.reshape(*shape, -1))
        coordinates: dict[str, Any] = (
            {name: list(axis.values) for name, axis in zip(names, self.spec.axes, strict=True)}
            if is_grid
            else {**{n: ("point", self.points[:, k]) for k, n in enumerate(names)}, "level": ("point", self.level)}
        )
        return Dataset(variables, coordinates, {**self._attributes()})

    def _attributes(self) -> dict[str, Any]:
        import json

        return {
            "title": self.spec.name or "sweep",
            "held": "; ".join(self.held),
            "method": self.method,
            "t_end": float(self.spec.t_end),
            "threshold": self.spec.chaos_threshold,
            "seed": str(self.spec.seed),
            "spec": json.dumps(self.spec.record(), sort_keys=True),
            "liepoisson_version": __version__,
        }

    def __repr__(self) -> str:
        axes = " x ".join(f"{axis.name} ({len(axis.values)})" for axis in self.spec.axes)
        return f"<Sweep over {axes}: {len(self.points)} points, {self.spec.n} orbits each, t = {self.spec.t_end:g}>"
