r"""Bodies in an ideal fluid: Clebsch's case and an ellipsoid.

Kirchhoff's equations for a rigid body in a fluid at rest at infinity. The section is $p_3 = 0$, $\dot p_3 > 0$ on the
leaf $m\cdot p = 1/4$, $|p| = 1$; the azimuth of the impulse $p$ and $m_3$ are coordinates on it, so this is a true
section. Clebsch's case ($H = 5$) is integrable, and its orbits leave curves; some orbits of the ellipsoid ($H = 0.9$)
fill areas.

Read on: [catalog](../catalog.md), [sections](../sections.md); [lamb1932](../references.md),
[perelomov1981](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

cases = {"clebsch": ("Clebsch's case", 5), "kirchhoff-ellipsoid": ("ellipsoid, axes 3 : 2 : 3/2", 0.9)}
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 3.4))
    for ax, (name, (title, energy)) in zip(axes, cases.items(), strict=True):
        body = lp.catalog.system(name)
        leaf = lp.Leaf(body, {"C1": 0.25, "C2": 1})
        starts = lp.sections.section_starts(leaf, "p3", energy=energy, n_starts=20, seed=5, direction=1, spread=True)
        points = lp.section(body, starts, surface="p3", direction=1, t_end=1e5, n_crossings=700)
        _, _, m3, p1, p2, _ = points.state.T
        lp.plot.section(points, np.arctan2(p2, p1) / np.pi, m3, size=0.7, ax=ax)
        ax.set(xlim=(-1, 1), title=title, ylabel="$m_3$")
        ax.set_xlabel(r"azimuth of $p$, in units of $\pi$")
figure.savefig("kirchhoff.png")
