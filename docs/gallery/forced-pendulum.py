r"""A pendulum whose support shakes, once in each period.

Left the stroboscopic map of $H = p^2/2 - \cos x + \frac{3}{10}\cos x\cos 3t$: swings in the middle, above and below
turns, islands of turns that keep step with the drive, and chaos between them. Right how many turns the orbits from
$x = 0$ make in each period: steps where they keep step.

Read on: [angles and forcing](../angles-and-forcing.md#time), [chaos](../chaos.md); [chirikov1979](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

bracket = lp.canonical(names=["x"], angles=["x"])
shaken = lp.System(
    bracket, "p_x^2/2 - cos(x) + 3*cos(x)*cos(w*t)/10", {"w": 3}, period="2*pi/w", name="shaken pendulum"
)
momentum = np.linspace(-4.4, 4.4, 111)
starts = [{"p_x": p} for p in momentum]
hue = {"regular": "#1668b8", "chaotic": "#d1571b", "undecided": "#8a8f98"}
verdict = lp.decide(shaken, starts, t_end=4000).verdict
points = lp.section(shaken, starts, surface="t", t_end=300 * 2 * np.pi / 3)
x = np.mod(points.state[:, 0] + np.pi, 2 * np.pi) - np.pi
turns = points.end_state[:, 0] / (3 * points.end_time)  # in a period
with lp.plot.house_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 4.6), sharey=True, width_ratios=(1.6, 1))
    for kind in ("chaotic", "undecided", "regular"):
        of = np.isin(points.trajectory, np.flatnonzero(verdict == kind))
        left.plot(x[of], points.state[of, 1], ".", color=hue[kind], markersize=0.9, rasterized=True)
        if (of := verdict == kind).any():
            right.plot(turns[of], momentum[of], "o", color=hue[kind], markersize=2.6, label=kind)
    ticks = {"xticks": [-np.pi, 0, np.pi], "xticklabels": [r"$-\pi$", "0", r"$\pi$"]}
    left.set(xlabel="$x$", ylabel="$p$", xlim=(-np.pi, np.pi), title="once in each period", **ticks)
    right.set(xlabel="turns in a period", title="from $x = 0$", xticks=[-1, 0, 1])
    right.legend(loc="lower right", markerscale=1.5)
figure.savefig("forced-pendulum.png")
