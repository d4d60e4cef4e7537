"""How fast an exponent converges.

Exponents of eight orbits that start within $10^{-9}$ of each other, each with the standard error that its own run
states, for growing times. The orbits forget their common start, so their scatter shows what an error should be. It
falls slowly, since chaotic orbits stick to the edges of regular islands.

Read on: [how large is the error?](../spectrum.md#how-large-is-the-error), [exponents](../exponents.md);
[pikovsky2016](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top.twisted_kovalevskaya()
copies = lp.sample_states(top, 1, seed=1) + 1e-9 * np.random.default_rng(0).standard_normal((8, 9))
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.9))
    for t_end in 500 * 2 ** np.arange(7):
        run = lp.lyapunov_exponent(top, copies, t_end=t_end, method=lp.Taylor(tol=1e-9))
        times = run.time * np.geomspace(0.84, 1.19, 8)
        ax.errorbar(times, run.exponent, run.error, fmt="o", markersize=3, linewidth=1, color="#1668b8", capsize=1.5)
    mean = run.mean
    ax.axhspan(
        mean.value - mean.standard_error,
        mean.value + mean.standard_error,
        color="#d1571b",
        alpha=0.3,
        label="mean at the end ± standard error",
    )
    ax.legend(loc="upper right")
    ax.set_xscale("log")
    ax.set(xlabel="$t$", ylabel=r"$\lambda_1$", title="Twisted Kovalevskaya top: eight copies of one orbit")
figure.savefig("exponent-error.png")
