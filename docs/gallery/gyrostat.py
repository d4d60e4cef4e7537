r"""A rotor takes equilibria away.

Orbits of a gyrostat on the sphere $|\ell| = 1$ with moments $I = (1, 2, 3)$ for three momenta $k$ of a rotor along the
first axis, seen from $(2, 1, 1)$; dots are equilibria, filled where they are stable. Without rotor it is Euler's top
with its separatrix; a rotor shifts the centres, and a fast one leaves two.

Read on: [gyrostats](../canonical.md#gyrostats), [equilibria](../equilibria.md); [audin1996](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

eye = np.array([2, 1, 1]) / np.sqrt(6)
right = np.array([-1, 2, 0]) / np.sqrt(5)
view = np.stack([right, np.cross(eye, right), eye], axis=1)
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.2, 2.5))
    for ax, k in zip(axes, (0, 0.25, 1), strict=True):
        energy = f"(l1 - {k})^2/2 + l2^2/4 + l3^2/6"
        body = lp.System(lp.so(3) @ lp.trivial(), energy, name="gyrostat")
        starts = lp.sample_states(body, 22, seed=8)
        ax.add_patch(plt.Circle((0, 0), 1, fill=False, color="#6b7280", linewidth=0.8))
        for path in lp.integrate(body, starts, times=np.linspace(0, 60, 2401)).state @ view:
            front = path[:, 2] > 0
            for side, shade in ((front, 1.0), (~front, 0.15)):
                x, y = np.where(side[:, None], path[:, :2], np.nan).T
                ax.plot(x, y, color="#1668b8", linewidth=0.7, alpha=shade)
        for one in lp.equilibria(body, {"C1": 1}):
            x, y, depth = one.state @ view
            face = "#d1571b" if one.nonlinear_stability == "stable" else "white"
            ax.plot(x, y, "o", color="#d1571b", markerfacecolor=face, markersize=5, alpha=1 if depth > 0 else 0.25)
        ax.set(title=f"$k = {k}$", aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05))
        ax.axis("off")
figure.savefig("gyrostat.png")
