r"""Lyapunov spectrum of a fluid on su(5).

All 24 exponents of Zeitlin's truncation with $N = 5$, the mean of six orbits of one leaf and energy with standard
errors. They come in pairs $\pm\lambda$. Six vanish by the structure of the bracket: four for the Casimirs, two for the
energy and the flow. Grey: consistent with zero at this time, which says less.

Read on: [a fluid](../catalog.md#a-fluid), [spectra](../spectrum.md); [zeitlin1991](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

fluid = lp.catalog.zeitlin(5)
orbit = lp.integrate(fluid, lp.sample_states(fluid, 1, seed=1), times=np.arange(7) * 400.0)
spectrum = lp.lyapunov_spectrum(fluid, orbit.state[0, 1:], t_end=2_000, transient=100, method=lp.Taylor(tol=1e-8))
mean, error = spectrum.mean
threshold = spectrum.residuals.zero_threshold.max()
k = np.arange(1, 25)
zero = np.abs(mean) < threshold
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.8))
    ax.axhspan(-threshold, threshold, color="#6b7280", alpha=0.2)
    ax.plot(
        k, -mean[::-1], "o", color="#6b7280", markersize=8, markerfacecolor="none", label=r"mirror images $-\lambda_k$"
    )
    ax.errorbar(k[~zero], mean[~zero], error[~zero], fmt="o", color="#d1571b", markersize=4, label=r"$\lambda_k$")
    ax.errorbar(k[zero], mean[zero], error[zero], fmt="o", color="#6b7280", markersize=4)
    ax.set(xlabel="$k$", ylabel=r"$\lambda_k$", title="Zeitlin's fluid, $N = 5$, $t = 2000$", xticks=range(2, 25, 2))
    ax.legend()
figure.savefig("fluid-spectrum.png")
