"""Three integrable motions on the sphere.

A point on the sphere in a uniform field (spherical pendulum), in a quadratic potential (Neumann), and attracted by the
pole (Kepler). The pendulum and Neumann's particle do not return to their start; Kepler's orbit is closed. A dot is the
pole; the far side is pale.

Read on: [catalog](../catalog.md), [integrability](../integrability.md); [moser1980](../references.md),
[marsden1999](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

eye, right = np.array([0.6, 0.4, 0.69]), np.array([-0.4, 0.6, 0]) / np.hypot(0.4, 0.6)
view = np.stack([right, np.cross(eye, right), eye], axis=1) / [1, np.linalg.norm(eye), np.linalg.norm(eye)]
point, velocity = np.array([0.8, 0, 0.6]), np.array([-0.1, 1.0, 0.4])
turn, names = np.linspace(0, 2 * np.pi, 181), ("spherical-pendulum", "neumann", "kepler-on-the-sphere")
rings = [np.stack([np.cos(turn), np.sin(turn), z + 0 * turn], axis=1) * [0.8, 0.8, 1] for z in (-0.6, 0.6)]
rings.append(rings[0] * [1.25, 1.25, 0])
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.6, 2.45))
    for ax, name, title in zip(axes, names, ("pendulum", "Neumann", "Kepler"), strict=True):
        start = [*np.cross(point, velocity), *point]
        path = lp.integrate(lp.catalog.system(name), start, times=np.linspace(0, 26, 3001)).state[0, :, 3:]
        ax.add_patch(plt.Circle((0, 0), 1, fill=False, color="#6b7280", linewidth=0.8))
        for curve, colour, width in (*((ring, "#c9c5b8", 0.6) for ring in rings), (path, "#1668b8", 1.1)):
            x, y, z = (curve @ view).T
            for near, shade in ((z > 0, 1.0), (z < 0, 0.3)):
                ax.plot(np.where(near, x, np.nan), np.where(near, y, np.nan), colour, linewidth=width, alpha=shade)
        ax.plot(*view[2, :2], "o", color="#d1571b", markersize=4)
        ax.set_title(title, loc="center")
        ax.set(aspect="equal", xlim=(-1.04, 1.04), ylim=(-1.04, 1.04))
        ax.axis("off")
figure.savefig("sphere.png")
