"""A regular, a sticky and a chaotic orbit.

Three indicators along three orbits of a heavy top: growth of a tangent vector, MEGNO and the alignment index SALI. To
$t = 1000$ (dotted) nothing tells the sticky orbit from the regular one; at $t = 3000$ all three do. No indicator says
anything about later times.

Read on: [regular or chaotic](../chaos.md#sticky-orbits); [skokos2001](../references.md),
[cincotta2000](../references.md).
"""

import numpy as np

import liepoisson as lp

top = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))
sticky = lp.sample_states(top, 1, seed=100, first=424)
others = lp.sample_states(top, 40, seed=3)
verdict = lp.decide(top, others, t_end=1_000).verdict
starts = np.vstack([others[verdict == "regular"][:1], sticky, others[verdict == "chaotic"][:1]])
growth = lp.chaos.megno(top, starts, t_end=3_000)
angle = lp.chaos.alignment(top, starts, times=np.geomspace(1, 3_000, 200))
axes = lp.plot.indicators(growth, angle, labels=["regular", "sticky", "chaotic"], decided_at=1_000)
figure = axes[0].figure
figure.set_size_inches(5.4, 6.4)
figure.savefig("sticky.png")
