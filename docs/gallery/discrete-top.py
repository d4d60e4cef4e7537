"""A Lagrange top in discrete time.

An orbit of the twisted Lagrange top in coarse steps of 1/2, by splitting and by a map that is integrable itself. The
map has integrals of its own and keeps them to round-off. The energy of the top is not kept by either; its error stays
bounded.

Read on: [the Lagrange top in discrete time](../methods.md#the-lagrange-top-in-discrete-time);
[bobenkosuris1999](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top(inertia=(1, 1, "1/2"), a=(0, 0, 1), b=(0, 0, 0), epsilon=1)
start = lp.sample_states(top, 1, seed=3)
times = np.arange(0, 4001) * 0.5
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.6, 3.8))
    for method, colour, name in (
        (lp.Splitting(step=0.5, order=2), "#d1571b", "splitting, order 2"),
        (lp.methods.LagrangeMap(step=0.5), "#1668b8", "integrable map"),
    ):
        states = lp.integrate(top, start, times=times, method=method).state[0]
        integrals = lp.methods.LagrangeMap(step=0.5).integrals(top, states)
        change = np.abs(integrals - integrals[0]).max(axis=1)
        ax.semilogy(times[1:], np.maximum.accumulate(change)[1:], color=colour, label=f"{name}: integrals of the map")
        energy = top.functions.energy(states)
        largest = np.maximum.accumulate(np.abs(energy - energy[0]))
        ax.semilogy(times[1:], largest[1:], ":", color=colour, label=f"{name}: energy")
    ax.set(xlabel="$t$", ylabel="largest change so far", ylim=(1e-17, 30), title="Twisted Lagrange top, step 1/2")
    ax.legend(loc="center right")
figure.savefig("discrete-top.png")
