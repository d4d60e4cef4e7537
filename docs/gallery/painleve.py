r"""A pole in complex time.

A solution of the Kovalevskaya top near a singularity at complex times, from its Laurent series. The colour is the
phase of $\alpha_1$, the lines are those of $\log|\alpha_1|$. Around the pole at 0 the phase turns twice, since
$\alpha_1\approx c/t^2$; around a zero it turns once, the other way. The series has no logarithm: the solution comes
back to its value around the pole.

Read on: [singularities in complex time](../painleve.md); [kowalewski1889](../references.md),
[ablowitz1980](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

found = lp.integrability.painleve_test(lp.catalog.system("kovalevskaya"))
balance = next(balance for balance in found.balances if balance.is_principal)
series = balance.series({"l2": 1, "C1": 0.3, "C2": -0.2, "C3": 0.1}, n_terms=60)
side = np.linspace(-2.4, 2.4, 240)
t = side[None, :] + 1j * side[:, None]
value = np.array([series(z)[3] for z in t.ravel()]).reshape(t.shape)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5, 4.2))
    image = ax.pcolormesh(side, side, np.angle(value) / np.pi, cmap="twilight", vmin=-1, vmax=1, rasterized=True)
    ax.contour(side, side, np.log10(np.abs(value)), levels=np.arange(-1.5, 2.1, 0.25), colors="white", linewidths=0.6)
    ax.set(
        xlabel=r"$\mathrm{Re}\,t$", ylabel=r"$\mathrm{Im}\,t$", aspect="equal", title=r"Kovalevskaya top: $\alpha_1(t)$"
    )
    ax.grid(visible=False)
    figure.colorbar(image, ax=ax, label=r"phase of $\alpha_1$, in units of $\pi$")
figure.savefig("painleve.png")
