r"""The Lagrange top in its canonical chart.

Rotations about the axis and about the field leave one degree of freedom, the inclination $\theta$. Above the effective
potential, with the starts of the orbits below, which are integrated in the chart: closed curves around the steady
precession.

Read on: [the Lagrange tops, reduced](../charts.md#the-lagrange-tops-reduced), [tops](../tops.md);
[arnold1989](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import liepoisson as lp

chart = lp.charts.OrdinaryLagrange(lp.Top.lagrange(transverse=1, axial="1/2"), l3=1, l_n=0.4, alpha=1)
theta = sp.Symbol("theta")
potential = sp.lambdify(list(chart.effective_potential.free_symbols), chart.effective_potential)
angle = np.linspace(0.12, 3.05, 400)
bottom = angle[potential(angle).argmin()]
starts = [[value, 0] for value in np.linspace(bottom + 0.06, 2.75, 8)]
orbit = lp.integrate(chart.system, starts, times=np.linspace(0, 8, 801))
with lp.plot.house_style():
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 5), sharex=True, height_ratios=(1, 1.4))
    upper.plot(angle, potential(angle), color="#1d2433")
    upper.set(ylabel="effective potential", ylim=(0, 8), title=r"Lagrange top, $\ell_3 = 1$, $\ell\cdot\alpha = 0.4$")
    upper.plot(*np.array([(start[0], potential(start[0])) for start in starts]).T, "o", color="#d1571b", markersize=3.5)
    for states in orbit.state:
        lower.plot(*states.T, color="#1668b8", linewidth=1)
    lower.plot(bottom, 0, ".", color="#1d2433")
    lower.set(xlabel=r"$\theta$", ylabel=r"$p_\theta$", xlim=(0, np.pi))
    lower.set_xticks([0, np.pi / 2, np.pi], ["0", r"$\pi/2$", r"$\pi$"])
figure.savefig("lagrange-chart.png")
