r"""A section of the Kovalevskaya top.

Crossings of $\ell_3 = 0$ on one leaf and one energy. The top has two degrees of freedom there, so this is a true
section. The top is integrable, and each orbit leaves curves, the cuts of a torus; six colours take turns. Half of the
section is drawn, where $(\ell\times\alpha)_3 > 0$.

Read on: [sections](../sections.md#true-sections), [tops](../tops.md); [kowalewski1889](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.catalog.system("kovalevskaya")
leaf = lp.Leaf(top, {"C1": 0.5, "C2": 1})  # C1 = l.alpha, C2 = |alpha|^2
starts = lp.sections.section_starts(leaf, "l3", energy=1.5, n_starts=40, seed=3, spread=True)
points = lp.section(top, starts, surface="l3", t_end=1e5, n_crossings=1500)
l1, l2, _, alpha1, alpha2, alpha3 = points.state.T
angle = np.mod(np.arctan2(l2, l1) / np.pi + 0.5, 2) - 0.5
shown = np.where(l1 * alpha2 - l2 * alpha1 > 0, angle, np.nan)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4))
    lp.plot.section(points, shown, alpha3, size=0.9, ax=ax)
    ax.set(xlim=(-0.5, 1.5), ylim=(-1, 1), xlabel=r"direction of $(\ell_1, \ell_2)$, in units of $\pi$")
    ax.set_ylabel(r"$\alpha_3$")
    ax.set_title(r"Kovalevskaya top, $\ell_3 = 0$: $H = 3/2$, $\ell\cdot\alpha = 1/2$")
figure.savefig("kovalevskaya-section.png")
