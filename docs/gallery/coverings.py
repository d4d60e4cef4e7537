"""How chaos is proved: images that cover.

The proof of chaos of the twisted Kovalevskaya top rests on 28 covering relations between small sets. For four of them,
in the unstable coordinates of the next set, whose unit disc is shaded: the image of the boundary circle goes around
the disc. The curves are integrated in doubles and prove nothing; the checkers enclose them.

Read on: [the proof](../proof.md#the-certificate), [rigorous enclosures](../enclosures.md);
[zgliczynski2004](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp
from liepoisson.proofs.theorem import shipped_certificate

top = lp.Top.twisted_kovalevskaya()
certificate = shipped_certificate(top)
names = ["p_a", "p_b", *(f"q_{{{k}}}" for k in range(1, 26))]
circle = np.exp(1j * np.linspace(0, 2 * np.pi, 401))
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 4, figsize=(7.4, 2.35), sharey=True)
    for ax, edge in zip(axes, [certificate.edges[k] for k in (0, 1, 12, 27)], strict=True):
        here, there = certificate.sets[edge.source], certificate.sets[edge.target]
        frame, inverse = np.array(here.frame), np.linalg.inv(np.array(there.frame))
        states = np.array(here.center) + np.outer(circle.real, frame[:, 0]) + np.outer(circle.imag, frame[:, 1])
        ends = lp.integrate(top, states, times=[0, edge.time]).end_state
        ends = ends * np.array(certificate.symmetry) if edge.symmetry else ends
        q, rate = (ends - np.array(there.center)) @ inverse.T, top.vector_field(ends) @ inverse.T
        q -= rate * (q[:, 2] / rate[:, 2])[:, None]  # along the flow, to the section
        ax.fill(circle.real, circle.imag, color="#dcd8cb")
        ax.plot(q[:, 0], q[:, 1], color="#d1571b")
        ax.set(title=f"${names[edge.source]}$ to ${names[edge.target]}$", aspect="equal", xlabel="$q_{u,1}$")
        ax.set(xticks=(-2, 0, 2), yticks=(-2, 0, 2), xlim=(-3.5, 3.5), ylim=(-3.5, 3.5))
    axes[0].set_ylabel("$q_{u,2}$")
figure.savefig("coverings.png")
