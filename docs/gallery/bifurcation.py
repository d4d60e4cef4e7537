"""Critical values of Kovalevskaya's top, and how many tori lie over each region.

A point of the plane is the set of motions with one energy H and one value of Kovalevskaya's integral K. Over a regular
value they are tori, as many as the number says; on the curves tori begin and end (elliptic) or join and divide
(hyperbolic). The marks are the top that spins about its axis, hanging and upright.

Read on: [integrable systems](../tori.md#the-bifurcation-diagram); [bolsinov2004](../references.md).
"""

import matplotlib.pyplot as plt

import liepoisson as lp

leaf = lp.Leaf(lp.catalog.system("kovalevskaya"), {"C1": 0.6, "C2": 1})
found = lp.tori.diagram(leaf, energy_max=2.5)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4))
    lp.plot.diagram(found, regions=lp.tori.regions(found, n_states=60), ax=ax)
    ax.set(xlim=(-0.4, 6), title="Kovalevskaya top, $C_1 = 0.6$, $C_2 = 1$")
figure.savefig("bifurcation.png")
