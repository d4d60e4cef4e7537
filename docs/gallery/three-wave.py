"""Three resonant waves.

The intensities of three waves, the third the sum of the others. It decays into the two, whose intensities grow
together, and takes it back. The sums of Manley and Rowe, $K_1 = |a_1|^2 + |a_3|^2$ and $K_2 = |a_2|^2 + |a_3|^2$
(dashed), are constant.

Read on: [catalog](../catalog.md), [Lax pairs of the literature](../lax.md#pairs-of-the-literature);
[alber1998](../references.md), [manley1956](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

waves = lp.catalog.system("three-wave")
start = {"q1": 0.1, "q2": 0.5, "q3": 1.0}
orbit = lp.integrate(waves, start, times=np.linspace(0, 12, 601))
intensity = orbit.state[0, :, :3] ** 2 + orbit.state[0, :, 3:] ** 2
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.7))
    for k, colour in enumerate(("#d1571b", "#1668b8", "#0b8f5f")):
        ax.plot(orbit.time, intensity[:, k], color=colour, label=f"$|a_{k + 1}|^2$")
    for k, colour in enumerate(("#d1571b", "#1668b8")):
        ax.plot(orbit.time, intensity[:, k] + intensity[:, 2], "--", color=colour, linewidth=1, label=f"$K_{k + 1}$")
    ax.set(xlabel="$t$", ylabel="intensity", ylim=(0, 1.65))
    ax.legend(ncols=5, loc="upper center", columnspacing=1.2, handlelength=1.6)
figure.savefig("three-wave.png")
