r"""Stable and unstable manifolds cross.

Manifolds of a hyperbolic periodic orbit of Hénon and Heiles' system at $H = 1/8$, on the section $x = 0$, $p_x > 0$.
The unstable one is a segment carried along by the map of first return, the stable one its mirror image, since the
change of the sign of $p_y$ reverses time. They cross at homoclinic points and fold ever more: computed, not proved.

Read on: [periodic and homoclinic orbits](../orbits.md), [sections](../sections.md); [moser1973](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

system, energy = lp.catalog.system("henon-heiles"), 1 / 8


def crossings(y, p, n=1):
    """The next n points of orbits through points of the section, shape (n, point, 2)."""
    start = np.stack([0 * y, y, np.sqrt(2 * energy - p**2 - y**2 + 2 * y**3 / 3), p], axis=-1)
    state = lp.section(system, start, surface="x", direction=1, t_end=1e3, n_crossings=n).state
    return state.reshape(len(y), n, 4)[:, :, [1, 3]].swapaxes(0, 1)


gamma = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/8", n_starts=10)[0]
y0 = lp.section(system, gamma.start, surface="x", direction=1, t_end=20).state[0, 1]
moved = crossings(y0 + 1e-6 * np.array([1, -1, 0, 0]), 1e-6 * np.array([0, 0, 1, -1]))[0]
values, vectors = np.linalg.eig(np.stack([moved[0] - moved[1], moved[2] - moved[3]], axis=1) / 2e-6)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4.2))
    for side in (1, -1):
        dy, dp = side * np.outer(vectors[:, values.argmax()], 1e-5 * values.max() ** np.linspace(0, 1, 1500))
        y, p = crossings(y0 + dy, dp, n=12).reshape(-1, 2).T
        for sign, colour, word in ((1, "#d1571b", "unstable"), (-1, "#1668b8", "stable")):
            ax.plot(y, sign * p, color=colour, linewidth=0.9, label=word if side == 1 else None)
    ax.plot(y0, 0, "ko", markersize=4, label="periodic orbit")
    ax.set(xlabel="$y$", ylabel="$p_y$", title="Hénon-Heiles, $H = 1/8$, $x = 0$")
    ax.legend(loc="upper right")
figure.savefig("splitting.png")
