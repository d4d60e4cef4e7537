"""A shaken body comes to its law and stays on its sphere.

Left: a thousand free rigid bodies, all started at one state, shaken and damped along the noise for a few units of time,
on the sphere of their angular momentum: they gather where the energy is small. Right: the histogram of the energy and
the law of Gibbs. Every step turns the angular momentum, so no body leaves the sphere by more than round-off.

Read on: [noise](../noise.md); [arnaudon2018](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

body, beta = lp.catalog.euler_top_on("so(3)", [1, 2, 3]), 12.0
starts = np.tile([1.0, 0, 0], (1_000, 1))
run = lp.stochastic.noisy_orbits(
    body, starts, noises=["l1", "l2", "l3"], inverse_temperature=beta, times=[0, 5], method=lp.Splitting(step=0.02)
)
l, energy = run.end_state, run.invariants["H"][:, -1]

figure = plt.figure(figsize=(8, 3.6))
sphere = figure.add_subplot(1, 2, 1, projection="3d")
sphere.scatter(*l.T, c=energy, s=3, cmap="viridis")
sphere.set(
    xlabel="$l_1$", ylabel="$l_2$", zlabel="$l_3$", box_aspect=(1, 1, 1), xticks=(-1, 1), yticks=(-1, 1), zticks=(-1, 1)
)

# the law of the energy, from points spread evenly over the sphere
k = np.arange(200_000) + 0.5
height, angle = 1 - 2 * k / len(k), np.pi * (1 + 5**0.5) * k
radius = np.sqrt(1 - height**2)
even = body.functions.energy(np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1))
edges = np.linspace(1 / 6, 1 / 2, 21)
law = figure.add_subplot(1, 2, 2)
law.hist(energy, bins=edges, density=True, color="#9ecae1", label="1,000 bodies at $t = 5$")
density, _ = np.histogram(even, bins=edges, weights=np.exp(-beta * even), density=True)
law.stairs(density, edges, color="#333333", label=rf"Gibbs, $\beta = {beta:g}$")
law.set(xlabel="$H$", ylabel="probability density")
law.legend(frameon=False)
figure.tight_layout()
figure.savefig("noise.png")
