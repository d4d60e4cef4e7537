"""A double pendulum forgets its start.

The outer mass of three double pendulums that start at rest within about $10^{-6}$ rad of each other: one path for
long, three paths after $t = 40$. Right the distance of the first two, and a line for the exponent 0.43 that longer
runs give.

Read on: [chaos in canonical systems](../canonical.md#canonical-coordinates); [landau1976](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

double = lp.catalog.system("double-pendulum")
starts = [[2, 2 + 1e-6 * k, 0, 0] for k in range(3)]
orbit = lp.integrate(double, starts, times=np.linspace(0, 50, 2001))
one, two = orbit.state[..., 0], orbit.state[..., 1]
x, y = np.sin(one) + np.sin(two), -np.cos(one) - np.cos(two)
with lp.plot.house_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 3.2), width_ratios=(1, 1.2))
    for k, colour in enumerate(("#d1571b", "#1668b8", "#0b8f5f")):
        last = slice(1600, 2001)
        left.plot(x[k, last], y[k, last], color=colour, linewidth=0.8)
    left.set(aspect="equal", xlabel="$x$", ylabel="$y$", title="outer mass, $40 < t < 50$")
    distance = np.hypot(x[1] - x[0], y[1] - y[0])
    right.semilogy(orbit.time, distance, color="#1d2433")
    right.semilogy(
        orbit.time[:1300], 3e-7 * np.exp(0.43 * orbit.time[:1300]), "--", color="#d1571b", label="$e^{0.43 t}$"
    )
    right.set(xlabel="$t$", title="distance of two", ylim=(1e-9, 10))
    right.legend(loc="lower right")
figure.savefig("double-pendulum.png")
