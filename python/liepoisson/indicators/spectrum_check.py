"""The self-check of a Lyapunov spectrum: its sum, its pairs, its zeros."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.indicators.structural_zeros import keeps_volume
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.numeric.time_scale import zero_threshold

if TYPE_CHECKING:
    from liepoisson.indicators.spectrum import Spectrum

RATIO_LIMIT = 1e8
"""Within an interval the stretchings should not differ by more: half of the digits of a double."""


@dataclass(frozen=True)
class SpectrumResiduals(ReadOnlyArrays):
    r"""How far spectra are from the structure that the bracket prescribes.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> found = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=1000).residuals
        >>> bool(abs(found.sum[0]) < 1e-12), found.zeros.shape[1], found.zeros_below_threshold.tolist()
        (True, 5, [1.0])

    Attributes:
        sum: Sum of all exponents, shape (trajectory,): zero where the flow keeps the volume,
            $\mathrm{div}\,J\nabla H = 0$, as for all H on a unimodular algebra.  On others, such as the affine one, it
            is the mean of the divergence.
        pairing: $\lambda_k + \lambda_{N+1-k}$ for the exponents in decreasing order, shape (trajectory, N // 2); NaN
            for starts on leaves of lower rank, across which exponents need not be paired.
        zeros: The structural zeros, the middle exponents in decreasing order, shape (trajectory, largest number of
            them); NaN beyond the number of this trajectory, and for starts on leaves of lower rank, where a growing
            direction across the leaf moves the middle.
        zero_threshold: $3\ln(t/T)/t$ with T the time scale of the orbit, below which an exponent at time t is
            consistent with zero: tangent vectors in these directions grow like powers of time; shape (trajectory,).  A
            fault that makes an exponent smaller than this is not seen: with T = 1 0.021 at t = 1,000, 0.0028 at
            t = 10,000.
    """

    sum: Array
    pairing: Array
    zeros: Array
    zero_threshold: Array

    @property
    def zeros_below_threshold(self) -> Array:
        """Fraction of the structural zeros below the threshold, per trajectory; NaN where there are none."""
        known = np.isfinite(self.zeros)
        n = known.sum(axis=1)
        small = (np.abs(np.where(known, self.zeros, np.inf)) <= self.zero_threshold[:, None]).sum(axis=1)
        return np.divide(small, n, out=np.full(len(n), np.nan), where=n > 0)


def spectrum_residuals(spectrum: Spectrum) -> SpectrumResiduals:
    """The residuals; sums, pairs and zeros are NaN where not all exponents are known, or no structure."""
    values, n = -np.sort(-spectrum.end_exponent, axis=1), len(spectrum.components)
    threshold = zero_threshold(spectrum.time[-1], spectrum.time_scale)
    complete, structure = values.shape[1] == n, spectrum.structure
    total = values.sum(axis=1) if complete else np.full(len(values), np.nan)
    pairing = (values + values[:, ::-1])[:, : n // 2] if complete else np.full((len(values), n // 2), np.nan)
    if structure is None:
        return SpectrumResiduals(total, np.full_like(pairing, np.nan), np.empty((len(values), 0)), threshold)
    pairing = np.where(structure.is_regular[:, None], pairing, np.nan)
    zeros = np.full((len(values), int(structure.n_zeros.max(initial=0))), np.nan)
    for k in np.flatnonzero(structure.is_regular & complete):
        count = int(structure.n_zeros[k])
        side = (n - count) // 2
        zeros[k, :count] = values[k, side : side + count]
    return SpectrumResiduals(total, pairing, zeros, threshold)


def check_lines(spectrum: Spectrum) -> list[str]:
    """The self-check in words, a line for each property."""
    finished = spectrum.outcome == "finished"
    if not finished.any():
        return ["no trajectory finished: there is nothing to check"]
    residuals, structure = spectrum.residuals, spectrum.structure
    if not np.isfinite(residuals.sum[finished]).any():
        return [
            f"only {spectrum.exponent.shape[2]} of {len(spectrum.components)} exponents: sum and pairs are not known"
        ]
    lines = [_sum_line(spectrum, residuals.sum[finished])]
    if structure is None:
        return [*lines, "no Poisson tensor is known: no pairs and zeros to check", *_ratio_line(spectrum)]
    if np.isfinite(residuals.pairing[finished]).any():
        lines.append(f"pairs +x, -x: equal within {_largest(residuals.pairing[finished]):.1e}")
    else:
        lines.append("the leaves are of lower rank: exponents across them need not come in pairs")
    counts = sorted(set(structure.n_zeros[finished].tolist()))
    within, zeros = residuals.zeros_below_threshold[finished], residuals.zeros[finished]
    claim = f"structural zeros: {' or '.join(map(str, counts))} of {len(spectrum.components)}"
    if np.isfinite(zeros).any():
        threshold = _range(residuals.zero_threshold[finished])
        lines.append(
            f"{claim}, at most {_largest(zeros):.1e}; below 3 ln(t/T) / t = {threshold} for "
            f"{int(np.sum(within == 1.0))} of {int(finished.sum())} trajectories (smaller faults are not seen)"
        )
    lines.append("assumed: the ranks of J and of the gradients at the start stay the same along the orbits")
    return lines + _ratio_line(spectrum)


def _sum_line(spectrum: Spectrum, total: Array) -> str:
    finished = spectrum.outcome == "finished"
    states = np.concatenate([spectrum.start[finished], spectrum.end_state[finished]])
    if keeps_volume(spectrum.field, states, time=spectrum.interval, method=spectrum.method):
        return f"sum of all exponents: at most {_largest(total):.1e}"
    return (
        f"sum of all exponents: from {total.min():.2g} to {total.max():.2g}; not expected to vanish, as the flow does "
        "not keep the volume (div J grad H is not 0)"
    )


def _largest(values: Array) -> float:
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if known.size else float("nan")


def _range(values: Array) -> str:
    """The least and the largest one, or the one that both are to two digits."""
    ends = sorted({f"{value:.1e}" for value in (np.nanmin(values), np.nanmax(values))}, key=float)
    return " to ".join(ends)


def _ratio_line(spectrum: Spectrum) -> list[str]:
    ratio = float(np.max(spectrum.largest_ratio))
    if ratio <= RATIO_LIMIT:
        return []
    return [
        f"within an interval of up to {spectrum.interval:g} stretchings differ by {ratio:.1e}: the smallest exponents "
        "are lost in round-off; take a shorter interval"
    ]
