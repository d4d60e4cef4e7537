"""What a sweep found, point by point, with its statistics."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.errors import ParameterError
from liepoisson.indicators.estimates import as_confidence
from liepoisson.indicators.mean_error import student_quantile, wilson_interval
from liepoisson.indicators.verdict import as_rule
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.result import Result, labelled, recorded
from liepoisson.sweeps.execute import Report
from liepoisson.sweeps.family import Family, as_family
from liepoisson.sweeps.points import Place, evaluate_targets
from liepoisson.sweeps.spec import SweepSpec
from liepoisson.sweeps.tasks import FAILED, NO_SYSTEM, NOT_COMPUTED, OUTCOMES

if TYPE_CHECKING:
    from xarray import Dataset


_PER_POINT = (
    "mean", "standard_error", "mean_low", "mean_high", "n_finished", "chaotic_fraction", "undecided_fraction",
    "chaotic_fraction_low", "chaotic_fraction_high", "reason",
)  # fmt: skip
_DIMENSIONS = ("member", "point", "level")
OWN_NAMES = frozenset([*_DIMENSIONS, *_PER_POINT, "exponent", "error", "verdict", "value", "outcome"])
"""Variables and dimensions of the dataset of a sweep, which no axis may be taken for."""
_MEANING = {"standard_error": "of the mean over the starts: their spread over the root of their number"} | {
    f"{name}_{end}": f"{which} end of the 95% interval of the {word} over the starts"
    for name, word in (("mean", "mean"), ("chaotic_fraction", "fraction"))
    for end, which in (("low", "lower"), ("high", "upper"))
}

_OVER_TIME = "standard error of each exponent over its time"


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Result):
    """The values of a sweep at its points.

    Example:
        >>> found = lp.sweep(system="twisted-top", parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        ...     axes={"epsilon": [0, 0.5, 1]}, n_starts=4, t_end=50)
        >>> found.points[:, 0].tolist(), found.mean.round(2).tolist()
        ([0.0, 0.5, 1.0], [0.05, 0.08, 0.14])

    Attributes:
        spec: What was asked.
        places: The points on the lattice, see `liepoisson.sweeps.points`.
        points: Values of the axes, shape (point, axis).
        level: 0 for the grid, then the level of refinement that added the point, shape (point,).
        value: Exponents in inverse time; verdicts, -1 regular, 0 undecided, +1 chaotic; or values of the quantity;
        shape (point, member); NaN where an orbit failed.
        outcome_code: How each orbit ended, shape (point, member), as numbers of `OUTCOMES`.
        error: Of exponents along trajectories with noise the standard error of each over its time, shape (point,
            member); None without noise.
        method: How orbits were integrated, in words.
        held: What is the same at all points, in words.
        reports: How the pieces of each level went.
        n_reused: Points that were read from the store.
        n_damaged: Pieces of the store that were damaged, which a sweep computes anew and `liepoisson.load` leaves out.
        store: The folder with the results, or None.
    """

    kind = "sweep"
    made_by = "sweep"
    rows = ("point",)

    spec: SweepSpec = recorded(
        lambda spec: {"record": spec.record(), "description": spec.description()},
        lambda written: SweepSpec.of_record(written["record"], written["description"]),
    )
    places: tuple[Place, ...]
    points: Array = labelled("point", "axis", long_name="values of the axes")
    level: NDArray[np.int64] = labelled("point", long_name="level of refinement", units="1")
    value: Array = labelled("point", "member", long_name="exponents, verdicts (-1, 0, 1) or values")
    outcome_code: NDArray[np.int8] = labelled("point", "member", long_name="outcome by number", units="1")
    error: Array | None = labelled("point", "member", long_name=_OVER_TIME, default=None)
    method: str
    held: tuple[str, ...]
    reports: tuple[Report, ...] = recorded(lambda _: None, lambda _: ())
    n_reused: int
    n_damaged: int
    store: Path | None = recorded(
        lambda path: None if path is None else str(path), lambda text: None if text is None else Path(text)
    )

    @property
    def system(self) -> Family:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The systems of the sweep."""
        return as_family(self.spec.system)

    def arguments(self) -> dict[str, Any]:
        """What `sweep` was called with."""
        return {"spec": self.spec}

    def save(self, path: str | Path) -> Path:
        """Writes a NetCDF file of the values of all orbits; `liepoisson.load` gives the sweep back.

        Raises:
            OutputError: The name does not end in .nc, or the file cannot be written.
        """
        from liepoisson.io.dataset import dataset_of, save

        return save(dataset_of(self), path)

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
        """Mean over the orbits with a value, shape (point,); NaN where there is none.

        Raises:
            ParameterError: the sweep has verdicts: their numbers -1, 0, 1 have no mean of a meaning.
        """
        if self.spec.is_verdict:
            raise ParameterError(
                "mean: wanted a sweep of numbers; got one of verdicts; take chaotic_fraction and undecided_fraction"
            )
        counts = self.n_finished
        return np.where(counts > 0, np.nansum(self.value, axis=1) / np.maximum(counts, 1), np.nan)

    @property
    def standard_error(self) -> Array:
        """Standard error of the mean over the starts, their spread over the root of their number, shape (point,).

        NaN for fewer than two.

        Raises:
            ParameterError: the sweep has verdicts; `interval` has the error of their fraction.
        """
        counts, mean = self.n_finished, self.mean
        squares = np.nansum((self.value - mean[:, None]) ** 2, axis=1)
        with np.errstate(all="ignore"):
            return np.where(counts > 1, np.sqrt(squares / np.maximum(counts - 1, 1) / np.maximum(counts, 1)), np.nan)

    @property
    def n_chaotic(self) -> NDArray[np.int64]:
        """Orbits with the verdict "chaotic", shape (point,).

        Raises:
            ParameterError: the sweep has no verdicts.
        """
        return self._count(1)

    @property
    def n_undecided(self) -> NDArray[np.int64]:
        """Orbits with the verdict "undecided", shape (point,).

        Raises:
            ParameterError: the sweep has no verdicts.
        """
        return self._count(0)

    @property
    def verdict(self) -> NDArray[np.str_]:
        """Verdict on each orbit, shape (point, member): "regular", "chaotic", or "undecided", as where it failed.

        Raises:
            ParameterError: the sweep has no verdicts.
        """
        self._require_verdicts()
        return np.where(self.value > 0, "chaotic", np.where(self.value < 0, "regular", "undecided"))

    @property
    def chaotic_fraction(self) -> Array:
        """Share of the chaotic ones among the orbits that finished, shape (point,).

        Undecided ones count among all: the true share lies between this and this plus `undecided_fraction`, but for the
        errors of both.

        Raises:
            ParameterError: the sweep has no verdicts.
        """
        return self._share(self.n_chaotic)

    @property
    def undecided_fraction(self) -> Array:
        """Share of the undecided ones among the orbits that finished, shape (point,).

        Raises:
            ParameterError: the sweep has no verdicts.
        """
        return self._share(self.n_undecided)

    def _count(self, code: int) -> NDArray[np.int64]:
        self._require_verdicts()
        return (self.value == code).sum(axis=1)

    def _share(self, counts: NDArray[np.int64]) -> Array:
        return np.where(self.n_finished > 0, counts / np.maximum(self.n_finished, 1), np.nan)

    def _require_verdicts(self) -> None:
        if not self.spec.is_verdict:
            raise ParameterError(
                f"verdicts: wanted a sweep of them; got one of {shown(self.spec.quantity)}; "
                'take quantity="chaotic_fraction"'
            )

    def interval(self, confidence: float = 0.95) -> tuple[Array, Array]:
        """Wilson's interval of the chaotic fraction, or Student's of the mean over the starts, shape (point,) each.

        It tells of the starts at hand as a random sample; points share their starts, so their errors are correlated.
        """
        if self.spec.is_verdict:
            return wilson_interval(self.n_chaotic, self.n_finished, confidence)
        probability = 0.5 + as_confidence(confidence) / 2
        sizes, where = np.unique(np.maximum(self.n_finished, 2), return_inverse=True)
        quantile = np.array([student_quantile(probability, n - 1) for n in sizes.tolist()])[where]
        half = quantile * self.standard_error
        return self.mean - half, self.mean + half

    @property
    def statistic(self) -> Array:
        """What the sweep is about: the chaotic fraction, or the mean; shape (point,)."""
        return self.chaotic_fraction if self.spec.is_verdict else self.mean

    @property
    def overhead(self) -> float:
        """Seconds of a worker beside its pieces, for each piece that was computed here; NaN if none was."""
        pieces = sum(report.n_pieces for report in self.reports)
        return sum(r.overhead_per_piece * r.n_pieces for r in self.reports) / pieces if pieces else math.nan

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each point the axes, the level, the statistics, and why it has none."""
        axes = {name: self.points[:, k] for k, name in enumerate(self._axis_names())}
        reasons = np.array([self._reason(point) for point in range(len(self.points))], dtype=np.str_)
        return {**axes, "level": self.level, **self._per_point(), "reason": reasons}

    def _reason(self, point: int) -> str:
        """Why a point has no orbit with a value: how all ended, or why there is no system; else ""."""
        ended = sorted(set(self.outcome[point].tolist()) - {"finished"})
        if np.isfinite(self.value[point]).any() or not ended:
            return ""
        if (self.outcome_code[point] == NO_SYSTEM).all():
            family = self.system
            try:
                family.system(evaluate_targets(self.spec, family, self.points[[point]]).values(0))
            except Exception as error:  # that of the user's function may be of any kind
                return f"no system: {error}"
        return ", ".join(ended)

    def _axis_names(self) -> tuple[str, ...]:
        return tuple(f"axis_{axis.name}" if axis.name in OWN_NAMES else axis.name for axis in self.spec.axes)

    def _per_point(self) -> dict[str, NDArray[Any]]:
        """The statistics of each point."""
        low, high = self.interval()
        statistic = (
            {"chaotic_fraction": self.chaotic_fraction, "undecided_fraction": self.undecided_fraction}
            if self.spec.is_verdict
            else {"mean": self.mean, "standard_error": self.standard_error}
        )
        of = "chaotic_fraction" if self.spec.is_verdict else "mean"
        return {**statistic, f"{of}_low": low, f"{of}_high": high, "n_finished": self.n_finished}

    @property
    def dataset(self) -> Dataset:
        """The same as a labelled xarray Dataset: on the grid of the axes, or, refined, along one axis of points.

        An axis that is called like a variable or dimension of the dataset itself is `axis_NAME` there: `axis_mean`.
        """
        from xarray import Dataset

        names = self._axis_names()
        is_grid = self.spec.refine is None
        dims = names if is_grid else ("point",)
        shape = self.spec.shape if is_grid else (len(self.points),)
        is_verdict = self.spec.is_verdict
        variables: dict[str, Any] = {
            name: (dims, values.reshape(shape), {"long_name": _MEANING[name]} if name in _MEANING else {})
            for name, values in self._per_point().items()
        }
        name = "exponent" if self.spec.is_exponent else "verdict" if is_verdict else "value"
        members = self.verdict if is_verdict else self.value
        variables[name] = ((*dims, "member"), members.reshape(*shape, -1))
        if self.error is not None:
            variables["error"] = ((*dims, "member"), self.error.reshape(*shape, -1), {"long_name": _OVER_TIME})
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
            **({"rule": json.dumps(vars(as_rule(self.spec.rule)))} if self.spec.is_verdict else {}),
            "seed": str(self.spec.seed),
            "spec": json.dumps(self.spec.record(), sort_keys=True),
            "description": json.dumps(self.spec.description(), sort_keys=True),
            "liepoisson_version": __version__,
        }

    def __repr__(self) -> str:
        axes = " x ".join(f"{axis.name} ({len(axis.values)})" for axis in self.spec.axes)
        n_missing = int((self.outcome_code == NOT_COMPUTED).any(axis=1).sum())
        damaged = f"; {counted(self.n_damaged, 'piece')} of the store damaged" if self.n_damaged else ""
        missing = f" ({n_missing} not computed{damaged})" if n_missing else ""
        return (
            f"<Sweep over {axes}: {counted(len(self.points), 'point')}{missing}, "
            f"{counted(self.spec.n_starts, 'orbit')} each, t = {self.spec.t_end:g}>"
        )
