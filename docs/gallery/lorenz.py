r"""Lorenz's system as its parameter grows.

Above, the largest values of z along an orbit from (1, 1, 20), after a time of 60: where $\dot z = xy - \beta z$ falls
through zero. Below, its largest exponent over a time of 100. In the windows without chaos the orbit is periodic; at
large $\rho$ its period doubles as $\rho$ falls.

Read on: [vector fields](../vector-fields.md).
"""

import numpy as np
from matplotlib import pyplot as plt

import liepoisson as lp

rates = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
places, largest, strengths, exponents = [], [], np.linspace(20, 240, 221), []
for rho in strengths:
    lorenz = lp.VectorField(rates, {"sigma": 10, "rho": float(rho), "beta": "8/3"}, name="Lorenz")
    start = lp.integrate(lorenz, [1, 1, 20], t_end=60).end_state[0]
    tops = lp.section(lorenz, start, surface="x*y - 8/3*z", direction=-1, t_end=40, keep=["z"]).state[:, 0]
    places.append(np.full(len(tops), rho))
    largest.append(tops)
    exponents.append(lp.lyapunov_exponent(lorenz, start, t_end=100, seed=1).exponent[0])
with lp.plot.house_style():
    figure, (above, below) = plt.subplots(2, 1, figsize=(6.0, 4.8), sharex=True, height_ratios=(2, 1))
    above.plot(np.concatenate(places), np.concatenate(largest), ".", ms=1, mec="none")
    above.set_ylabel("largest values of $z$")
    below.plot(strengths, exponents, lw=1)
    below.axhline(0, color="0.8", lw=1, zorder=0)
    below.set(xlabel=r"$\rho$", ylabel="exponent", xlim=(18, 242))
figure.savefig("lorenz.png")
