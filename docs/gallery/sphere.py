"""Three integrable motions on the sphere.

A point on the sphere in a uniform field (spherical pendulum), in a quadratic potential (Neumann), and attracted by the
pole (Kepler). The pendulum and Neumann's particle move between two curves and do not return to their start; Kepler's
orbit is closed. The far side is pale.

Read on: [catalog](../catalog.md), [integrability](../integrability.md); [moser1980](../references.md),
[marsden1999](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

eye, right = np.array([0.6, 0.4, 0.69]), np.array([-0.4, 0.6, 0]) / np.hypot(0.4, 0.6)
eye = eye / np.linalg.norm(eye)
view = np.stack([right, np.cross(eye, right), eye], axis=1)
point, velocity = np.array([0.8, 0, 0.6]), np.array([-0.1, 1.0, 0.4])
names = {"spherical-pendulum": "pendulum", "neumann": "Neumann", "kepler-on-the-sphere": "Kepler"}
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.2, 2.5))
    for ax, (name, title) in zip(axes, names.items(), strict=True):
        system = lp.catalog.system(name)
        start = [*np.cross(point, velocity), *point]
        path = lp.integrate(system, start, times=np.linspace(0, 45, 3001)).state[0, :, 3:] @ view
        ax.add_patch(plt.Circle((0, 0), 1, fill=False, color="#6b7280", linewidth=0.8))
        for side, shade in ((path[:, 2] > 0, 1.0), (path[:, 2] < 0, 0.2)):
            x, y = np.where(side[:, None], path[:, :2], np.nan).T
            ax.plot(x, y, color="#1668b8", linewidth=0.8, alpha=shade)
        ax.set(title=title, aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05))
        ax.axis("off")
figure.savefig("sphere.png")
