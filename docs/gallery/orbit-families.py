r"""A cascade of periodic orbits.

Left: periods of Hénon and Heiles's straight orbit and of what leaves it, against the energy, up to that of the saddles,
$H = 1/6$. Solid lines are elliptic, dashed ones hyperbolic. At two energies the period doubles; at 0.16155 a rotation
branches off, at 0.16445 a libration. Right: the three at $H = 0.1655$, inside the triangle through the saddles.

Read on: [families](../orbits.md#families); [brack2001](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

henon = lp.catalog.system("henon-heiles")
first = lp.orbits.periodic_orbit(henon, [0, 0, 0, 0.2], period=6.3)
straight = lp.orbits.orbit_family(henon, first, until=0.1655, longest_step=0.02)
branches = [point for point in straight.points if point.kind == "branch"][:2]
rotation, libration = (
    lp.orbits.orbit_family(henon, branch, until=0.1655, longest_step=0.01, max_orbits=60) for branch in branches
)
with lp.plot.house_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 4.0), width_ratios=(1.25, 1), layout="constrained")
    for family in (straight, rotation, libration):
        lp.plot.family(family, ax=left)
    left.set(xlim=(0.13, 0.167), ylim=(7.4, 11.6), title="Hénon and Heiles")
    corner = np.exp(2j * np.pi * np.array([0.25, 7 / 12, 11 / 12, 0.25]))  # the saddles
    right.plot(corner.real, corner.imag, color="#6b7280", linewidth=0.9, label="$V = 1/6$")
    for family, name, colour in (
        (straight, "straight", "#1f2937"), (rotation, "rotation", "#1668b8"), (libration, "libration", "#d1571b")
    ):  # fmt: skip
        states = family[-1].states(1001)
        right.plot(states[:, 0], states[:, 1], color=colour, linewidth=1.3, label=name)
    right.set(xlabel="$x$", ylabel="$y$", aspect="equal", title="$H = 0.1655$")
    right.legend(loc="upper left", fontsize=9)
