"""How the axis of a top moves in space.

The path of the axis of three Lagrange tops that are released with the same spin and different precession, seen in
space from above: loops, cusps and waves. The attitude is integrated with the orbit.

Read on: [frames](../frames.md#attitude); [arnold1989](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top.lagrange(transverse=1, axial="1/2")
theta, spin = 0.6, 3.2
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.2, 2.6))
    for ax, rate, word in zip(axes, (-0.35, 0.0, 0.15), ("loops", "cusps", "waves"), strict=True):
        start = [0, rate * np.sin(theta), spin, 0, np.sin(theta), np.cos(theta), 0, 0, 0]
        motion = lp.orbits.attitude(top, start, times=np.linspace(0, 21, 1051), attitude="alpha")
        x, y, _ = motion.space([0, 0, 1])[0].T
        ax.plot(np.cos(t := np.linspace(0, 2 * np.pi, 200)), np.sin(t), color="#6b7280", linewidth=0.7)
        ax.plot(x, y, color="#1668b8", linewidth=1.1)
        ax.plot(0, 0, "+", color="#1d2433", markersize=6)
        ax.set_title(word)
        ax.set(aspect="equal", xlabel="$e_x$", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    axes[0].set_ylabel("$e_y$")
figure.savefig("attitude.png")
