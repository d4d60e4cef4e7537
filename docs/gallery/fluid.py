"""Vorticity of an ideal fluid on the torus, in 80 modes.

Zeitlin's truncation of Euler's equation to su(9) keeps the energy and eight Casimirs, among them the enstrophy, to
round-off. The strong negative vortex persists, the weak positive vorticity around it breaks up into patches of the
size of the cut-off, below which nothing is resolved.

Read on: [a fluid](../catalog.md#a-fluid), [brackets](../brackets.md); [zeitlin1991](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

fluid = lp.catalog.zeitlin(9)
start = {"wc10": 0.5, "ws01": 0.3, "wc11": 0.2, "ws1m1": -0.4}
orbit = lp.integrate(fluid, start, times=[0, 5, 10, 20])
vorticity = lp.catalog.vorticity(orbit.state[0], n_points=96)
levels = np.linspace(-3, 3, 25)
with lp.plot.house_style():
    figure, axes = plt.subplots(2, 2, figsize=(5.2, 4.5), sharex=True, sharey=True)
    for ax, time, field in zip(axes.flat, orbit.time, vorticity, strict=True):
        side = np.linspace(0, 2, len(field))
        image = ax.contourf(side, side, field, levels=levels, cmap="RdBu_r")
        ax.set_title(f"$t = {time:g}$")
        ax.grid(visible=False)
    for k in range(2):
        axes[1, k].set_xlabel(r"$x/\pi$")
        axes[k, 0].set_ylabel(r"$y/\pi$")
    figure.colorbar(image, ax=axes, label=r"vorticity $\omega$", ticks=range(-3, 4), shrink=0.7)
figure.savefig("fluid.png")
