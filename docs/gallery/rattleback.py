"""A rattleback reverses its spin.

Pitch, roll and spin in the model of Yoshida, Tokieda and Morrison, a Lie-Poisson system of Bianchi type VI. Spin in
one sense is unstable to pitch, in the other, more slowly, to roll: each reverses it. Energy and Casimir are constant,
so the orbit is a closed curve and the spin reverses again and again.

Read on: [catalog](../catalog.md), [brackets](../brackets.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

body = lp.catalog.system("rattleback")
orbit = lp.integrate(body, [0.01, 0.01, 1.0], times=np.linspace(0, 60, 2401))
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.6))
    for k, (colour, word) in enumerate((("#b8860b", "pitch"), ("#0b8f5f", "roll"), ("#d1571b", "spin"))):
        ax.plot(orbit.time, orbit.state[0, :, k], color=colour, label=f"{word} $x_{k + 1}$")
    ax.set(xlabel="$t$", ylabel="angular momenta", ylim=(-1.15, 1.45))
    ax.legend(ncols=3, loc="upper center")
figure.savefig("rattleback.png")
