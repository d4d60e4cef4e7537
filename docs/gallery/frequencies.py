r"""How far the main frequency of an orbit drifts.

Orbits of a heavy top that start along a line of the section $\alpha_3 = 0$. Above the main frequency of $\alpha_1 +
i\alpha_2$, without its sign: smooth where orbits lie on tori, scattered in chaos. Below how far it moves from one
window of time to the next. There is no threshold that makes of a drift a verdict.

Read on: [frequency drift](../chaos.md#frequency-drift); [laskar1990](../references.md),
[laskar1993](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

I3, energy, c = 1.2, 1.0, 0.5  # as in the card of the MEGNO map: phi = 0.4 pi
top = lp.Top.heavy(inertia=(2, 2, I3), a=(-1, 0, 0))
cos, sin, l3 = np.cos(0.4 * np.pi), np.sin(0.4 * np.pi), np.linspace(-1.6, 1.6, 401)
across = np.sqrt(4 * (energy + cos) - c**2 - 2 * l3**2 / I3)
states = np.zeros((len(l3), 9))
states[:, :5] = np.stack([c * cos - across * sin, c * sin + across * cos, l3, cos + 0 * l3, sin + 0 * l3], axis=1)
found = lp.chaos.frequency_drift(top, states, observable=("alpha1", "alpha2"), t_end=1_000)
with lp.plot.house_style():
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 4.4), sharex=True)
    upper.plot(l3, np.abs(found.frequency[:, 0]), ".", color="#1668b8", markersize=2.5)
    upper.set(ylabel="$|$main frequency$|$", title=r"$I = (2, 2, 1.2)$, $H = 1$, $\ell\cdot\alpha = 1/2$")
    lower.semilogy(l3, found.drift, ".", color="#d1571b", markersize=2.5)
    lower.set(xlabel=r"$\ell_3$ at the start", ylabel="drift")
figure.savefig("frequencies.png")
