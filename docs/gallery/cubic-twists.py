r"""Where integrability returns among the twists.

Kovalevskaya's top in two fields, with the twist of the cubic $Y(X^2 + tY^2)$: the mean exponent of 48 random starts at
time 1000, and the share that is chaotic, with standard errors. For t < 0 the algebra is $\mathbb R^3$, for t > 0 it is
$\mathbb R\times\mathbb C$. At t = 1 both integrals are back.

Read on: [which twists keep an integral](../twists.md#which-twists-keep-an-integral).
"""

import numpy as np
from matplotlib import pyplot as plt

import liepoisson as lp

strengths = [k / 8 for k in range(-8, 17)]
exponents, errors, shares = [], [], []
for t in strengths:
    top = lp.catalog.cubic_top((0, 1, 0, t), (2, 2, 1), (1, 0, 0), (0, 1, 0))
    verdict = lp.decide(top, lp.sample_states(top, 48, seed=2), t_end=1000, seed=2)
    exponents.append(np.mean(verdict.exponent))
    errors.append(np.std(verdict.exponent, ddof=1) / np.sqrt(48))
    shares.append(np.mean(verdict.verdict == "chaotic"))
share = np.array(shares)
with lp.plot.house_style():
    figure, (above, below) = plt.subplots(2, 1, figsize=(5.4, 4.4), sharex=True)
    above.errorbar(strengths, exponents, errors, fmt="o-", ms=3)
    above.set_ylabel("mean exponent")
    below.errorbar(strengths, share, np.sqrt(share * (1 - share) / 48), fmt="o-", ms=3)
    below.set(xlabel="$t$ in $Y(X^2 + tY^2)$", ylabel="chaotic share", ylim=(-0.05, 1.05))
    for ax in (above, below):
        ax.axvline(0, color="0.8", lw=1, zorder=0)
    for at, name in ((-0.5, r"$\mathbb{R}^3$"), (1.0, r"$\mathbb{R}\times\mathbb{C}$")):
        above.text(at, 1.02, name, transform=above.get_xaxis_transform(), ha="center", va="bottom")
figure.savefig("cubic-twists.png")
