r"""An orbit homoclinic to a periodic orbit.

The distance of a homoclinic orbit of the twisted Kovalevskaya top from the hyperbolic periodic orbit $\gamma$ of the
proof of chaos: it leaves $\gamma$ and comes back like $e^{\pm\lambda t}$ with the rate $\lambda$ of $\gamma$ (dashed).
The orbit is its own mirror image under a reversal of time.

Read on: [symmetric homoclinic orbits](../orbits.md#symmetric-homoclinic-orbits), [the proof](../proof.md);
[devaney1976](../references.md), [champneys1998](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top.twisted_kovalevskaya()
gamma = lp.orbits.symmetric_periodic_orbits(top, {"C1": 1, "C2": "1/2", "C3": 1}, energy="1/2", n_starts=30)[0]
loop = lp.integrate(top, gamma.start, times=np.linspace(0, 2 * gamma.period, 1001)).state[0]
one = lp.orbits.symmetric_homoclinic_orbits(gamma, n_starts=20)[1]
times, states = one.states(801)
along = top.vector_field(loop) / np.linalg.norm(top.vector_field(loop), axis=1, keepdims=True)
apart = states[:, None] - loop
apart -= np.sum(apart * along, axis=-1, keepdims=True) * along  # across the orbit
distance = np.linalg.norm(apart, axis=-1)[range(801), np.linalg.norm(states[:, None] - loop, axis=-1).argmin(axis=1)]
with lp.plot.house_style():
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 4.6), sharex=True)
    for k, colour in enumerate(("#d1571b", "#1668b8", "#0b8f5f")):
        upper.plot(times, states[:, k], color=colour, label=rf"$\ell_{k + 1}$")
    upper.legend(ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1))
    lower.semilogy(times, distance, color="#1d2433")
    far = np.abs(times) > 6
    guide = 1e-3 * np.exp(gamma.rate * (11 - np.abs(times)))
    lower.semilogy(times, np.where(far, guide, np.nan), "--", color="#d1571b", label=r"$e^{\pm\lambda t}$")
    lower.set(xlabel="$t$", ylabel=r"distance from $\gamma$")
    lower.legend(loc="upper right")
figure.savefig("homoclinic.png")
