"""The Toda lattice and its Lax spectrum.

Five particles on a line, which repel like $e^{-r}$. They collide and then move freely. The eigenvalues of Flaschka's
matrix, $L_{kk} = p_k$ and $L_{k,k+1} = e^{(q_k - q_{k+1})/2}$, are constant all the time, and they are the momenta to
which the particles tend.

Read on: [Lax pairs](../lax.md), [canonical systems](../canonical.md#canonical-coordinates);
[toda1967](../references.md), [flaschka1974](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

n = 5
lattice = lp.catalog.toda(n, closed=False)
start = [-7.0, -3.0, 0.5, 4.0, 7.5, 1.6, 0.3, -0.9, -0.2, -1.5]
orbit = lp.integrate(lattice, start, times=np.linspace(0, 25, 401))
q, p = orbit.state[0, :, :n], orbit.state[0, :, n:]
side = np.exp((q[:, :-1] - q[:, 1:]) / 2)
matrices = [np.diag(row) + np.diag(s, 1) + np.diag(s, -1) for row, s in zip(p, side, strict=True)]
eigenvalues = np.linalg.eigvalsh(matrices)
with lp.plot.house_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.6, 3.6))
    left.plot(orbit.time, q)
    left.set(xlabel="$t$", ylabel="$q_k$", title="positions")
    lines = right.plot(orbit.time, p)
    spectrum = right.plot(orbit.time, eigenvalues, color="#1d2433", linestyle="--", linewidth=0.9)
    right.set(xlabel="$t$", title="momenta and eigenvalues", ylim=(-2.2, 2.6))
    right.legend([lines[0], spectrum[0]], ["$p_k$", "eigenvalues of $L$"], loc="upper right", ncols=2)
figure.savefig("toda.png")
