"""The numbers at t = 10,000 on the page of spectra: zeros, pairs, errors of 100 orbits. Run: python FILE."""

from __future__ import annotations

import numpy as np

import liepoisson as lp

N_STARTS, T_END = 100, 1e4


def naive_errors(spectrum: lp.results.Spectrum, length: float = 40.0) -> np.ndarray:
    """Errors of the largest exponents if pieces of about this length were independent, shape (trajectory,)."""
    sums = spectrum.exponent[:, :, 0] * spectrum.time
    step = max(1, round(length / spectrum.time[0]))
    rates = np.diff(sums[:, step - 1 :: step], axis=1) / (step * spectrum.time[0])
    return rates.std(axis=1, ddof=1) / np.sqrt(rates.shape[1])


def main() -> None:
    """Print the statistics of the spectra."""
    top = lp.Top.twisted_kovalevskaya()
    spectrum = lp.lyapunov_spectrum(top, lp.sample_states(top, N_STARTS, seed=1), t_end=T_END, interval=5)
    residuals, error = spectrum.residuals, spectrum.error[:, 0]
    print(f"{N_STARTS} starts, t = {T_END:g}")
    print(f"zeros at most {np.abs(residuals.zeros).max():.2g}; 3 ln(t/T) / t from {residuals.zero_threshold.min():.2g}")
    print(f"pairs equal within {np.abs(residuals.pairing).max():.2g}")
    print(f"error of the largest exponent of one orbit: median {np.median(error):.2g}, least {error.min():.2g}")
    print(f"the same from independent pieces: median {np.median(naive_errors(spectrum)):.2g}")
    print(f"orbits with an error of at most 0.002: {np.sum(error <= 2e-3)}")
    over_time = np.sqrt((spectrum.error**2).sum(axis=0)) / len(spectrum.error)
    over_starts = spectrum.mean[1]
    print(f"errors of the mean spectrum: over time {over_time.max():.2g} at most, over starts {over_starts.max():.2g}")


if __name__ == "__main__":
    main()
