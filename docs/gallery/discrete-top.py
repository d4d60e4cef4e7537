"""A Lagrange top in discrete time.

An orbit of the twisted Lagrange top in coarse steps of 1/2, by splitting and by a map that is integrable itself. The
map has integrals of its own and keeps them to round-off. The energy of the top is not kept by either; its error goes to
and fro, as at the first times on the right.

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
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.1))
    for method, colour, name in (
        (lp.Splitting(step=0.5, order=2), "#d1571b", "splitting, order 2"),
        (lp.methods.LagrangeMap(step=0.5), "#1668b8", "integrable map"),
    ):
        states = lp.integrate(top, start, times=times, method=method).state[0]
        integrals = lp.methods.LagrangeMap(step=0.5).integrals(top, states)
        change = np.abs(integrals - integrals[0]).max(axis=1)
        left.semilogy(times[1:], np.maximum.accumulate(change)[1:], color=colour, label=name)
        energy = top.functions.energy(states)
        right.plot(times[:81], (energy - energy[0])[:81], color=colour, linewidth=1)
    left.set(xlabel="$t$", ylim=(1e-16, 10), title="integrals of the map: largest change")
    left.legend(loc="center right")
    right.set(xlabel="$t$", xlim=(0, 40), title="energy: change")
figure.savefig("discrete-top.png")
