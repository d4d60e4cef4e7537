r"""Where a heavy top can go at a given energy.

Random states of a leaf at three energies, drawn with the measure that the flow preserves, as directions of $\alpha$.
They lie where the amended potential is below the energy (black curves): in one region, in two, in a band. Dots are the
equilibria below the energy, crosses those above it.

Read on: [leaves](../leaves.md#random-states), [equilibria](../equilibria.md); [marsden1999](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

inertia, a, c = np.array([2, 1.5, 1]), np.array([0.6, 0, 0.8]), 2.5  # c = l.alpha
top = lp.Top.heavy(inertia=(2, "3/2", 1), a=("3/5", 0, "4/5"))
leaf = lp.Leaf.through(top, [c, 0, 0, 1, 0, 0, 0, 0, 0])
steady = np.array([[*one.state, one.energy] for one in lp.equilibria(top, leaf)])
azimuth, height = np.meshgrid(np.linspace(0, 2 * np.pi, 241), np.linspace(-1, 1, 161))
x, y = np.sqrt(1 - height**2) * np.array([np.cos(azimuth), np.sin(azimuth)])
alpha = np.stack([x, y, height], axis=-1)
potential = c**2 / (2 * alpha**2 @ inertia) + alpha @ a
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.4, 2.9), sharex=True, sharey=True)
    for ax, energy in zip(axes, (1.4, 1.94, 2.5), strict=True):
        points = leaf.sample(1_500, seed=1, energy=energy)
        for states, marker, colour, size in (
            (points, ".", "#1668b8", 1.4),
            (steady[steady[:, 9] < energy], "o", "#d1571b", 4.5),
            (steady[steady[:, 9] > energy], "x", "#d1571b", 4.5),
        ):
            place = np.mod(np.arctan2(states[:, 4], states[:, 3]) / np.pi + 0.5, 2) - 0.5
            ax.plot(place, states[:, 5], marker, color=colour, markersize=size)
        for shift in (-2, 0):
            ax.contour(azimuth / np.pi + shift, height, potential, levels=[energy], colors="#1d2433", linewidths=1)
        ax.set(title=f"$H = {energy}$", xticks=(0, 1), xlim=(-0.5, 1.5), ylim=(-1, 1))
    figure.supxlabel(r"azimuth of $\alpha$, in units of $\pi$", fontsize=11.5)
    axes[0].set_ylabel(r"$\alpha_3$")
figure.savefig("regions.png")
