"""A charged top, energy by energy.

A heavy top in gravity and an electric field, on one leaf: the mean exponent and the chaotic share of 32 random starts
at each energy, drawn with the measure that the flow preserves. Each orbit is judged at $t = 300$; what is undecided
may be either.

Read on: [the mixture, energy by energy](../spectrum.md#the-mixture-energy-by-energy), [tops](../tops.md);
[twistedtop2001](../references.md).
"""

import numpy as np

import liepoisson as lp

top = lp.Top.charged_heavy(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, "1/2"))
leaf = lp.Leaf(top, {"C1": 1, "C2": 0.2, "C3": 1})
profile = lp.chaos.exponents_by_energy(
    top, leaf=leaf, energies=np.linspace(-1, 4, 11), n_starts=32, t_end=300, method=lp.Taylor(tol=1e-9)
)
ax = lp.plot.profile(profile)
figure = ax.figure
figure.set_size_inches(5.4, 4)
figure.savefig("charged-top.png")
