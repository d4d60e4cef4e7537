r"""Lyapunov exponents of the twisted Kovalevskaya top, and of the ordinary one.

The mean finite-time exponent of 1,000 random starts with its 95% band; light bands hold the middle 90% of the members.
The mean of the twisted top levels off, with a fit of $\lambda + c_1/\sqrt t + c_0/t$; that of the integrable one falls
like $\ln t/t$. Finite-time exponents are biased upwards, and a mean over random starts is the exponent of no orbit.

Read on: [exponents](../exponents.md), [the study of the paper](../getting-started.md#the-paper); the figure is that of
[twistedtop2001](../references.md), here with fewer starts.
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

tops = {"twisted, $\\epsilon = 1$": lp.Top.twisted_kovalevskaya(), "ordinary": lp.Top.kovalevskaya()}
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.9))
    for (label, top), colour in zip(tops.items(), ("#d1571b", "#1668b8"), strict=True):
        starts = lp.sample_states(top, 1_000, seed=7)
        growth = lp.finite_time_exponents(top, starts, times=np.geomspace(1, 300, 120), method=lp.Taylor(tol=1e-9))
        fit = None
        if label != "ordinary":
            fit = lp.fits.finite_time_fit(growth.time, growth.exponent, window=(20, 300))
        lp.plot.convergence(growth, fit=fit, label=label, colour=colour, ax=ax)
    ax.set_title("Kovalevskaya tops: mean of 1,000 random starts")
figure.savefig("lyapunov.png")
