"""The graph of the tori of a level of energy: atoms at critical values, joined by the families of tori."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind
from liepoisson.plot.labels import label, number, plain
from liepoisson.plot.style import ANGULAR_MOMENTUM, FIRST_FIELD, INK, axes_or_new, house_style, set_heading

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from liepoisson.tori.molecules import Molecule


@explains_its_arguments
def molecule(found: Molecule, *, ax: Axes | None = None) -> Axes:
    r"""The graph of the tori of a level of energy.

    Critical values of the integral are drawn at equal distances, from the least to the largest one; each line is a
    family of tori, each disc an atom with its name, filled where it has hyperbolic circles.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> axes = lp.plot.molecule(lp.tori.molecule(leaf, 0))
        >>> [text.get_text() for text in axes.texts]
        ['A', 'A']
        >>> plt.close(axes.figure)

    Args:
        found: What `liepoisson.tori.molecule` returned.
    """
    from liepoisson.tori.molecules import Molecule

    check_kind(found, Molecule, "found", "what lp.tori.molecule returns", "call it first")
    levels = sorted({atom.value for atom in found.atoms})
    rank = [levels.index(atom.value) for atom in found.atoms]
    lanes = _lanes(found, rank)
    with house_style():
        is_new, ax = ax is None, axes_or_new(ax, height=1.4 + 0.6 * len(levels))
        places = [
            float(
                np.mean([lanes[f][gap] for f, gap in [(f, r - 1) for f in atom.below] + [(f, r) for f in atom.above]])
            )
            for atom, r in zip(found.atoms, rank, strict=True)
        ]
        for (lower, upper), lane in zip(found.families.tolist(), lanes, strict=True):
            x = [places[lower], *lane.values(), places[upper]]
            y = [rank[lower], *(gap + 0.5 for gap in lane), rank[upper]]
            ax.plot(x, y, color=FIRST_FIELD, linewidth=1.2, zorder=1, solid_joinstyle="round")
        for atom, x, r in zip(found.atoms, places, rank, strict=True):
            is_saddle = bool(atom.below and atom.above)
            ax.plot(x, r, "o", markersize=20, color=ANGULAR_MOMENTUM if is_saddle else "white", markeredgecolor=INK)
            is_short = len(atom.name) < 3
            colour, shift = ("white" if is_saddle and is_short else INK), (0 if is_short else 14)
            align = "center" if is_short else "left"
            ax.annotate(
                atom.name,
                (x, r),
                (shift, 0),
                textcoords="offset points",
                ha=align,
                va="center",
                color=colour,
                fontsize=9,
            )
        widest = max(max(lane.values()) for lane in lanes)
        ax.set(xlim=(-widest - 1, widest + 1), ylim=(-0.6, len(levels) - 0.4), xticks=[])
        # Zeros are known to round-off
        size = max(map(abs, levels))
        ax.set_yticks(range(len(levels)), [f"${number(v if abs(v) > 1e-12 * size else 0)}$" for v in levels])
        ax.set_ylabel(label(found.momentum.names[1]))
        ax.grid(visible=False, axis="x")
        values = [*found.leaf.casimirs.items(), ("H", found.energy)]
        heading = ", ".join(f"{label(name)} = ${number(value)}$" for name, value in values)
        set_heading(ax, f"{plain(found.leaf.system.name)}\n{heading}", is_new=is_new)
    return ax


def _lanes(found: Molecule, rank: list[int]) -> list[dict[int, float]]:
    """Where each family is in each of the gaps between critical values that it crosses, from left to right."""
    lanes: list[dict[int, float]] = [{} for _ in range(len(found))]
    side_by_side = list[int]()
    for gap in range(max(rank)):
        for atom, r in zip(found.atoms, rank, strict=True):
            if r != gap:
                continue
            place = min((side_by_side.index(f) for f in atom.below), default=len(side_by_side))
            rest = [f for f in side_by_side if f not in atom.below]
            side_by_side = [*rest[:place], *atom.above, *rest[place:]]
        for k, family in enumerate(side_by_side):
            lanes[family][gap] = k - (len(side_by_side) - 1) / 2
    return lanes
