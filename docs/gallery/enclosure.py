"""Bounds that hold for every orbit of a box.

All orbits of a heavy top that start in the first box, of width 0.02 in each of the six components, are in these boxes
at these times: a theorem, round-off included. The lines are some of the orbits, computed in doubles for comparison.

Read on: [rigorous enclosures](../enclosures.md#the-flow-on-a-box); [lohner1987](../references.md),
[moore2009](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Rectangle

import liepoisson as lp

top = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/4 + l3^2/6 + alpha3", name="heavy top")
box = lp.proofs.Box.around([0.1, 0.2, 1, 0, "3/5", "4/5"], 0.01)
rng = np.random.default_rng(0)
starts = rng.uniform(box.lower, box.upper, (12, 6))
orbits = lp.integrate(top, starts, times=np.linspace(0, 2.4, 241)).state
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.9))
    for time in np.linspace(0, 2.4, 13):
        bounds = lp.proofs.enclose_flow(top, box, time=time).image if time else box
        corner, size = bounds.lower[:2], bounds.width[:2]
        ax.add_patch(Rectangle(corner, *size, facecolor="#1668b8", alpha=0.15))
        ax.add_patch(Rectangle(corner, *size, fill=False, edgecolor="#1668b8", label=None if time else "proved bounds"))
    for k, states in enumerate(orbits):
        ax.plot(*states[:, :2].T, color="#d1571b", linewidth=0.6, label=None if k else "orbits, in doubles")
    ax.set(xlabel=r"$\ell_1$", ylabel=r"$\ell_2$", title="Heavy top: a box of states every 0.2 time units")
    ax.legend(loc="best")
figure.savefig("enclosure.png")
