r"""Free rigid bodies in four dimensions: Manakov's top and another.

Mean finite-time exponents of 200 random starts on so(4). Manakov's top has another quadratic integral and is
integrable; its mean falls like $\ln t/t$. The mean of a body with six arbitrary moments levels off.

Read on: [catalog](../catalog.md#families), [exponents](../exponents.md);
[manakov1976](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

tops = {
    "Manakov's top": lp.catalog.system("manakov-so4"),
    "another top": lp.catalog.euler_top_on("so(4)", (1, 8, 3, 4, 7, 2)),
}
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.8))
    for (label, top), colour in zip(tops.items(), ("#1668b8", "#d1571b"), strict=True):
        starts = lp.sample_states(top, 200, seed=1)
        unit = np.median(lp.orbits.time_scale(top, starts))
        growth = lp.finite_time_exponents(
            top, starts, times=unit * np.geomspace(1, 1_000, 60), method=lp.Taylor(tol=1e-9)
        )
        mean = growth.exponent.mean(axis=0)
        ax.loglog(growth.time / unit, unit * mean, color=colour, label=label)
    t = np.geomspace(10, 1_000, 50)
    ax.loglog(t, np.log(t) / t, ":", color="#1d2433", label=r"$\ln t/t$")
    ax.set(xlabel="$t/T$, with the time scale $T$ of each top", ylabel=r"$T\,\langle\lambda(t)\rangle$", ylim=(3e-3, 1))
    ax.legend(loc="lower left")
figure.savefig("manakov.png")
