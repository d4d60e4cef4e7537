r"""Equilibria of a top and their stability as the twist grows.

Energies of all equilibria of the Kovalevskaya top with twist $\epsilon$ on the leaf $C_1 = 1$, $C_2 = 1/5$, $C_3 = 1$;
that these are all is proved by algebra at each $\epsilon$. Dots: stable, by the energy-Casimir method. Crosses:
unstable, the linearised flow grows. Branches that meet end there: near $\epsilon = 0.42$ equilibria vanish in pairs.

Read on: [equilibria and their stability](../equilibria.md); [holm1985](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

kinds = {"stable": ([], "o", "#1668b8"), "stable spectrum": ([], "s", "#0b8f5f"), "unstable": ([], "x", "#d1571b")}
for k in range(5, 25):
    top = lp.Top.kovalevskaya(epsilon=f"{k}/24")
    for one in lp.equilibria(top, {"C1": 1, "C2": "1/5", "C3": 1}):
        kind = "stable" if one.nonlinear_stability == "stable" else one.linear_stability
        if kind in kinds:
            kinds[kind][0].append((k / 24, one.energy))
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4))
    for label, (points, marker, colour) in ((label, kind) for label, kind in kinds.items() if kind[0]):
        face = {} if label == "unstable" else {"markerfacecolor": colour if label == "stable" else "none"}
        ax.plot(*np.array(points).reshape(-1, 2).T, marker, color=colour, markersize=4, label=label, **face)
    ax.set(xlabel=r"twist $\epsilon$", ylabel="energy $H$", title="Twisted Kovalevskaya top: equilibria of one leaf")
    ax.set_ylim(-1.7, 2.2)
    ax.legend(loc="upper right")
figure.savefig("equilibria.png")
