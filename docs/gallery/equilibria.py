r"""Equilibria of a top and their stability as the twist grows.

Energies of all equilibria of the Kovalevskaya top with twist $\epsilon$ on the leaf $C_1 = 1$, $C_2 = 1/5$, $C_3 = 1$;
that these are all is proved by algebra at each of 24 twists, and equilibria that are nearest to each other are joined.
Thick: stable, by the energy-Casimir method. Thin: unstable, the linearised flow grows. Branches that meet end there:
near $\epsilon = 0.29$ and $0.42$ equilibria vanish in pairs.

Read on: [equilibria and their stability](../equilibria.md); [holm1985](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

style = {True: {"color": "#1668b8", "linewidth": 2.6}, False: {"color": "#d1571b", "linewidth": 1.1}}
twists = [k / 96 for k in (*range(20, 29), *range(30, 46, 2), 48, 54, 62, 72, 84, 96)]
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4))
    before, last = None, 0.0
    for twist in twists:
        found = lp.equilibria(lp.Top.kovalevskaya(epsilon=str(twist)), {"C1": 1, "C2": "1/5", "C3": 1})
        if before is not None:
            apart = np.array([[np.linalg.norm(one.state - other.state) for other in found] for one in before])
            for i, j in enumerate(apart.argmin(axis=1)):
                if apart[:, j].argmin() == i:  # one branch
                    kind = style[before[i].nonlinear_stability == "stable"]
                    ax.plot([last, twist], [before[i].energy, found[int(j)].energy], **kind)
        before, last = found, twist
    for is_stable, word in ((True, "stable"), (False, "unstable")):
        ax.plot([], [], label=word, **style[is_stable])
    ax.set(xlabel=r"twist $\epsilon$", ylabel="energy $H$", title="Twisted Kovalevskaya top: equilibria of one leaf")
    ax.set(xlim=(0.2, 1), ylim=(-1.7, 2.2))
    ax.legend(loc="upper right")
figure.savefig("equilibria.png")
