"""The angle between growing and shrinking directions.

Covariant Lyapunov vectors along an orbit of the twisted Kovalevskaya top. Left the angle between the space of the two
growing and that of the two shrinking directions on a stretch of the orbit, right its distribution over 6,000 time
units. Where the angle comes close to zero, the orbit is near a tangency: it is then far from uniformly hyperbolic.

Read on: [covariant vectors](../spectrum.md#covariant-vectors); [ginelli2007](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

top = lp.Top.twisted_kovalevskaya()
start = lp.sample_states(top, 1, seed=1)
run = lp.lyapunov_spectrum(
    top, start, t_end=6_000, transient=800, interval=2, covariant=True, method=lp.Taylor(tol=1e-9)
)
angle = np.degrees(run.covariant.angle(5)[0])
with lp.plot.house_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.6, 3.4), sharey=True, width_ratios=(2, 1))
    part = slice(0, 300)
    left.plot(run.covariant.time[part] - run.covariant.time[0], angle[part], color="#1668b8", linewidth=1)
    left.set(xlabel="$t$", ylabel="angle in degrees", title="along the orbit", ylim=(0, 92))
    right.hist(angle, bins=45, range=(0, 90), density=True, orientation="horizontal", color="#1668b8", alpha=0.6)
    right.set(xlabel="density", title="distribution")
figure.savefig("covariant.png")
