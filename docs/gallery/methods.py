"""What methods of integration do to the energy.

Change of the energy along one orbit of the heavy top to $t = 10^4$. Splitting keeps the Casimirs and lets the energy
oscillate; Gauss' method keeps this energy, which is quadratic, to round-off; Runge-Kutta drifts in proportion to time;
the Taylor method of default tolerance stays near round-off. A small change of the energy does not tell that an orbit
is accurate.

Read on: [methods](../methods.md), [verification](../verification.md); [hairer2006](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top.heavy(inertia=(2, "3/2", 1), a=("3/5", 0, "4/5"))
start = lp.sample_states(top, 1, seed=1)
times = np.linspace(0, 10_000, 2001)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.9))
    for method, label in (
        (lp.RungeKutta(step=0.25), "Runge-Kutta, order 8, step 1/4"),
        (lp.Splitting(step=0.25, order=4), "splitting, order 4, step 1/4"),
        (lp.Gauss(step=0.25, order=4), "Gauss, order 4, step 1/4"),
        (lp.Taylor(), "Taylor, tolerance $10^{-13}$"),
    ):
        energy = top.functions.energy(lp.integrate(top, start, times=times, method=method).state[0])
        change = np.maximum.accumulate(np.abs(energy - energy[0]))
        ax.loglog(times[1:], np.maximum(change[1:], 1e-17), label=label)
    ax.set(xlabel="$t$", ylabel=r"$\max_{s\leq t}\,|H(s) - H(0)|$", ylim=(1e-17, 100))
    ax.legend(loc="upper left", ncols=1)
figure.savefig("methods.png")
