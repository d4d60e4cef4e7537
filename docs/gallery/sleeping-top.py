r"""Where a sleeping top is stable.

A symmetric top spins upright with spin $\ell_3$ in a field. The ordinary top has a stable spectrum outside of the
parabola. The twist leaves the shaded region: most stable spins of one sign are gone, and a tongue reaches to where the
ordinary top is unstable.

Read on: [the sleeping top](../equilibria.md#the-sleeping-top); [twistedtop2001](../references.md).
"""

import matplotlib.pyplot as plt

import liepoisson as lp

with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 4))
    lp.plot.sleeping_diagram((0, 1), ax=ax)
figure.savefig("sleeping-top.png")
