"""A rigid body that loses energy, or makes entropy, and stays on its surface.

Left a double bracket: the energy H falls on the sphere of the angular momentum. Right a metriplectic flow: the square
of its length, the entropy S, rises on the ellipsoid of the energy. Both end on the axis of the largest moment.

Read on: [Damping](../damping.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

body, start = lp.catalog.euler_top_on("so(3)", [1, 2, 3]), np.array([1.2, 0.15, 0.1])
times, root = np.linspace(0, 80, 4001), np.sqrt([1, 2, 3])  # of the moments of inertia
rigid, energetic = np.linalg.norm(start) * np.ones(3), np.linalg.norm(start / root) * root
flows = {
    "double bracket": (lp.dissipation.double_bracket(body, "1/10"), rigid, "#d1571b", "$H$"),
    "metriplectic": (lp.dissipation.metriplectic(body, "C1", "1/20"), energetic, "#2a6fbb", "$S$"),
}
u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(0, np.pi, 13))
sphere = np.array([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
with lp.plot.house_style():
    figure = plt.figure(figsize=(7.2, 5.2), layout="constrained")
    rows = figure.subfigures(2, 1, height_ratios=[2.4, 1])
    for k, (name, (flow, lengths, colour, quantity)) in enumerate(flows.items(), start=1):
        orbit = lp.integrate(flow, start, times=times)
        above = rows[0].add_subplot(1, 2, k, projection="3d", title=name)
        above.plot_wireframe(*sphere * lengths[:, None, None], color="#c9ced6", lw=0.4)
        above.plot(*orbit.state[0].T, color=colour, lw=0.9)
        above.plot(*orbit.state[0, -1:].T, "o", color="black", ms=4)
        for axis, length in zip(np.eye(3), lengths, strict=True):
            above.plot(*np.outer(axis, [length, 1.15 * length]), color="black", lw=0.7)
            above.text(*1.28 * length * axis, rf"$\ell_{int(axis @ [1, 2, 3])}$", ha="center", va="center")
        above.set_box_aspect(np.ptp(np.reshape(above.get_w_lims(), (3, 2)), axis=1), zoom=1.35)
        above.set_axis_off()
        below = rows[1].add_subplot(1, 2, k, xlabel="$t$", ylabel=quantity)
        below.plot(times, *[values[0] for values in orbit.monotone.values()], color=colour)
figure.savefig("damped-body.png")
