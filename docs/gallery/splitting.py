r"""Stable and unstable manifolds cross.

The manifolds of a hyperbolic periodic orbit of Hénon and Heiles' system at $H = 1/8$, on the section $x = 0$,
$p_x > 0$. The unstable one is a short segment carried along by the map of first return; the stable one is its mirror image,
since $p_y\to-p_y$ reverses time. They cross at homoclinic points, and fold ever more closely: computed, not proved.

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
y0 = lp.section(system, gamma.start, surface="x", direction=1, t_end=2 * gamma.period).state[0, 1]
u, v = 1e-6 * np.array([[1, -1, 0, 0], [0, 0, 1, -1]])
moved = crossings(y0 + u, v)[0]
values, vectors = np.linalg.eig(np.stack([moved[0] - moved[1], moved[2] - moved[3]], axis=1) / 2e-6)
dy, dp = vectors[:, values.argmax()]
size = 1e-5 * values.max() ** np.linspace(0, 1, 1500)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4.2))
    for side in (1, -1):
        y, p = crossings(y0 + side * size * dy, side * size * dp, n=12).reshape(-1, 2).T
        ax.plot(y, p, color="#d1571b", linewidth=0.9, label="unstable" if side == 1 else None)
        ax.plot(y, -p, color="#1668b8", linewidth=0.9, label="stable" if side == 1 else None)
    ax.plot(y0, 0, "ko", markersize=4, label="periodic orbit")
    ax.set(xlabel="$y$", ylabel="$p_y$", title="Hénon-Heiles, $H = 1/8$, $x = 0$")
    ax.legend(loc="upper right")
figure.savefig("splitting.png")
