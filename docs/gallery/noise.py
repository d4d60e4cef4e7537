"""A shaken body comes to its law and stays on its sphere.

Left: free rigid bodies, all started at one state, shaken and damped along the noise for a few units of time, on the
sphere of their angular momentum: they gather where the energy is small. Right: the histogram of the energy and the law
of Gibbs. Every step turns the angular momentum, so no body leaves the sphere by more than round-off.

Read on: [noise](../noise.md); [arnaudon2018](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

body, beta = lp.catalog.euler_top_on("so(3)", [1, 2, 3]), 12.0
starts = np.tile([1.0, 0, 0], (4_000, 1))
run = lp.stochastic.noisy_orbits(
    body, starts, noises=["l1", "l2", "l3"], inverse_temperature=beta, times=[0, 5], method=lp.Splitting(step=0.02)
)
l, energy = run.end_state, run.invariants["H"][:, -1]

# the law of the energy, from points spread evenly over the sphere
k = np.arange(200_000) + 0.5
height, angle = 1 - 2 * k / len(k), np.pi * (1 + 5**0.5) * k
radius = np.sqrt(1 - height**2)
even = body.functions.energy(np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1))
edges = np.linspace(1 / 6, 1 / 2, 21)
density, _ = np.histogram(even, bins=edges, weights=np.exp(-beta * even), density=True)

with lp.plot.house_style():
    figure = plt.figure(figsize=(7.2, 3.4), layout="constrained")
    sphere = figure.add_subplot(1, 2, 1, projection="3d")
    azimuth, elevation = np.radians([-30, 27])
    eye = [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
    in_front = l @ eye > 0
    points = sphere.scatter(*l[in_front].T, c=energy[in_front], s=2, lw=0, cmap="viridis", depthshade=False)
    half = np.linspace(0, np.pi, 91)
    for turn in np.arange(0, 2 * np.pi, np.pi / 6):
        circle = np.array([np.cos(turn) * np.sin(half), np.sin(turn) * np.sin(half), np.cos(half)])
        sphere.plot(*np.where(eye @ circle > 0, circle, np.nan), color="#c9ced6", lw=0.4)
    for axis in np.eye(3):
        sphere.plot(*np.outer(axis, [1, 1.15]), color="black", lw=0.7)
        sphere.text(*1.3 * axis, rf"$\ell_{int(axis @ [1, 2, 3])}$", ha="center", va="center")
    sphere.view_init(elev=np.degrees(elevation), azim=np.degrees(azimuth))
    sphere.set_box_aspect((1, 1, 1), zoom=1.35)
    sphere.set_axis_off()
    figure.colorbar(points, ax=sphere, label="$H$", shrink=0.7)
    law = figure.add_subplot(1, 2, 2, xlabel="$H$", ylabel="probability density")
    law.hist(energy, bins=edges, density=True, color="#9db8d6", label="4,000 bodies at $t = 5$")
    law.stairs(density, edges, color="#d1571b", lw=1.2, label=rf"Gibbs, $\beta = {beta:g}$")
    law.legend(frameon=False)
figure.savefig("noise.png")
