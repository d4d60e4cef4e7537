"""Where integrability ends as the twist grows.

The share of chaotic orbits among 48 random starts of the Kovalevskaya top, against the twist, with Wilson's 95%
interval; the dotted line counts the undecided orbits as chaotic, too. Ticks below are points that the sweep added
where the answer changes. The verdicts hold for $t = 300$.

Read on: [sweeps](../sweeps.md), [the rule and its error rates](../chaos.md#the-rule); [wilson1927](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

result = lp.sweep(
    system="twisted-top",
    parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
    axes=[lp.sweeps.Axis("epsilon", np.linspace(0, 1, 11), label=r"twist $\epsilon\,|\beta|$, $|\beta| = 1$")],
    quantity="chaotic_fraction",
    refine={"levels": 2, "difference": 0.15},
    n_starts=48,
    t_end=300,
    seed=1,
)
with lp.plot.house_style():
    figure, ax = plt.subplots(figsize=(5.4, 3.8))
    lp.plot.sweep(result, ax=ax)
    ax.set_title("Kovalevskaya inertia, $a$ equatorial, $b = 0$")
figure.savefig("twist-sweep.png")
