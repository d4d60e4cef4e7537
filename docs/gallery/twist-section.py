r"""The twist destroys the curves of a section.

The same starts, on $\ell_3 = 0$ and with $\ell\perp\beta$, for three values of the twist. Without twist $\ell$ and
$\alpha$ form a Kovalevskaya top of their own and leave curves. With twist $\ell\cdot\alpha$ changes, the section has
four dimensions, and the panels are projections of it: they show that the curves are gone, and prove neither tori nor
chaos.

Read on: [what a projection does not prove](../sections.md#what-a-projection-does-not-prove), [the proof of
chaos](../proof.md); [twistedtop2001](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

heavy = lp.catalog.system("kovalevskaya")
leaf = lp.Leaf(heavy, {"C1": 0.5, "C2": 1})
six = lp.sections.section_starts(leaf, "l3", energy=1.5, n_starts=18, seed=4, spread=True)
beta = np.cross(six[:, :3], six[:, 3:])
starts = np.hstack([six, beta / np.linalg.norm(beta, axis=1, keepdims=True)])
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.4, 3), sharex=True, sharey=True)
    for ax, epsilon in zip(axes, ("0", "1/100", "1/10"), strict=True):
        points = lp.section(lp.Top.kovalevskaya(epsilon=epsilon), starts, surface="l3", t_end=2e4, n_crossings=500)
        l1, l2, _, alpha1, alpha2, alpha3, *_ = points.state.T
        angle = np.mod(np.arctan2(l2, l1) / np.pi + 0.5, 2) - 0.5
        lp.plot.section(points, np.where(l1 * alpha2 > l2 * alpha1, angle, np.nan), alpha3, size=0.8, ax=ax)
        ax.set(xlim=(-0.5, 1.5), ylim=(-1.15, 1.15), xticks=(0, 1), title=rf"$\epsilon = {epsilon}$", ylabel="")
    figure.supxlabel(r"direction of $(\ell_1, \ell_2)$, in units of $\pi$", fontsize=11.5)
    axes[0].set_ylabel(r"$\alpha_3$")
figure.savefig("twist-section.png")
