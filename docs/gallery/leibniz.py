r"""Kovalevskaya's top with two, three, four and five fields.

The top with $n$ fields on the Leibniz extension of order $n$: the ordinary top for $n = 2$, the twisted one for $n =
3$. Means of the finite-time exponents of 500 random starts with 95% bands. That of the ordinary top falls like $\ln
t/t$, the others level off. The values depend on the ensemble, here unit vectors.

Read on: [brackets](../brackets.md#extensions), [families](../catalog.md#families); [extensions2000](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.8))
    for n, colour in zip((2, 3, 4, 5), ("#1668b8", "#d1571b", "#0b8f5f", "#7a4fa3"), strict=True):
        top = lp.catalog.leibniz_top(n, (2, 2, 1), [(-1, 0, 0)])
        starts = lp.sample_states(top, 500, seed=1)
        growth = lp.finite_time_exponents(top, starts, times=np.geomspace(5, 300, 60), method=lp.Taylor(tol=1e-9))
        lp.plot.convergence(lp.fits.mean_curve(growth.time, growth.exponent), label=f"$n = {n}$", colour=colour, ax=ax)
    ax.set_ylim(0, None)
    ax.set_title("Kovalevskaya's top with $n$ fields")
figure.savefig("leibniz.png")
