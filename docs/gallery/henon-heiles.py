"""Order and chaos in Hénon and Heiles' system.

The section $x = 0$, $p_x > 0$ at three energies, the last one that of escape. The curves of the first panel give way
to islands in a sea that one orbit fills. Two degrees of freedom: a true section.

Read on: [canonical systems](../canonical.md#canonical-coordinates), [sections](../sections.md);
[henonheiles1964](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

system = lp.catalog.system("henon-heiles")
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.4, 2.9), sharex=True, sharey=True)
    for ax, parts in zip(axes, (12, 8, 6), strict=True):
        y, p = np.meshgrid(np.linspace(-0.45, 0.85, 8), np.array([-0.6, -0.2, 0, 0.2, 0.6]) * (2 / parts) ** 0.5)
        square = 2 / parts - p**2 - y**2 + 2 * y**3 / 3
        inside = (square > 0) & (y < 1)
        starts = np.stack([0 * y, y, np.sqrt(np.abs(square)), p], axis=-1)[inside]
        points = lp.section(system, starts, surface="x", direction=1, t_end=1e4, n_crossings=250)
        lp.plot.section(points, "y", "p_y", size=0.7, ax=ax)
        ax.set(title=f"$H = 1/{parts}$", xlabel="$y$", ylabel="", xlim=(-0.55, 1.02), ylim=(-0.62, 0.62))
    axes[0].set_ylabel("$p_y$")
figure.savefig("henon-heiles.png")
