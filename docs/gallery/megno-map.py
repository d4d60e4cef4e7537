r"""A map of chaos on a section of a heavy top.

Mean MEGNO at $t = 300$ of 5,400 orbits that start on the section $\alpha_3 = 0$ of a heavy top near Kovalevskaya's,
with $I_3 = 1.2$ in place of 1; the azimuth of $\alpha$ and $\ell_3$ are coordinates on it. Dark is 2, the value of a
torus; bright grows with time. What is dark at this time may be chaotic later. White is out of reach of the energy.

Read on: [MEGNO](../chaos.md#megno), [the rule](../chaos.md#the-rule); [cincotta2000](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

I3, energy, c = 1.2, 1.0, 0.5  # I1 = I2 = 2, a = (-1, 0, 0), c = l.alpha, |alpha| = 1
top = lp.Top.heavy(inertia=(2, 2, I3), a=(-1, 0, 0))
phi, l3 = np.meshgrid(np.linspace(-1, 1, 90) * np.pi, np.linspace(-2.1, 2.1, 60))
square = 4 * (energy + np.cos(phi)) - c**2 - 2 * l3**2 / I3  # of l across alpha in the plane of l1 and l2
across = np.sqrt(np.where(square > 0, square, 0))
cos, sin, zero = np.cos(phi), np.sin(phi), 0 * phi
states = np.stack([c * cos - across * sin, c * sin + across * cos, l3, cos, sin, *[zero] * 4], axis=-1)
mean = np.full(phi.shape, np.nan)
mean[square > 0] = lp.chaos.megno(top, states[square > 0], t_end=300, method=lp.Taylor(tol=1e-9)).mean[:, -1]
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.6, 3.9))
    image = ax.pcolormesh(phi / np.pi, l3, mean, cmap="cividis", vmin=1.5, vmax=10, rasterized=True)
    ax.grid(visible=False)
    ax.set(xlabel=r"azimuth of $\alpha$, in units of $\pi$", ylabel=r"$\ell_3$")
    ax.set_title(r"$I = (2, 2, 1.2)$, $H = 1$, $\ell\cdot\alpha = 1/2$")
    figure.colorbar(image, ax=ax, label=r"mean MEGNO $\overline{Y}$ at $t = 300$", extend="max")
figure.savefig("megno-map.png")
