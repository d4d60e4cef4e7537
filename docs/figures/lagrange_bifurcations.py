"""The figure of docs/twisted-lagrange.md: `python docs/figures/lagrange_bifurcations.py [FOLDER]`, seconds.

The classes of leaves, the critical values on one leaf, and the zeros of R along loops around its two threads.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

import liepoisson as lp
from liepoisson.plot.style import ANGULAR_MOMENTUM, FIRST_FIELD, INK, MUTED, house_style, new_figure

FOLDER = Path(__file__).parent.parent / "images"


def zeros(diagram, loop):
    """The zeros of R in the upper half plane along a loop, in the order in which they began."""
    found = []
    for value in loop:
        every = np.roots(diagram.sextic(value))
        upper = every[every.imag > 0]
        found.append(upper[[np.abs(upper - one).argmin() for one in found[-1]]] if found else np.sort_complex(upper))
    return np.array(found)


def refined(loop, n=40):
    """More values on the sides of a polygon."""
    share = np.arange(n)[:, None] / n
    return np.concatenate([a + share * (b - a) for a, b in pairwise(loop)] + [loop[-1:]])


def main(folder: Path) -> None:
    """Draw it."""
    top = lp.Top.twisted_lagrange()
    diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0.5, "C2": 0.2, "C3": 1}))
    found = lp.tori.lagrange_monodromy(diagram)
    with house_style():
        figure = new_figure(10.5, 4.0)
        figure.set_layout_engine("none")
        plane = figure.add_axes((0.06, 0.13, 0.3, 0.82))
        lp.plot.leaf_classes(ax=plane)
        plane.get_legend().remove()
        space = figure.add_axes((0.38, 0.03, 0.32, 0.9), projection="3d")
        lp.plot.diagram(diagram, ax=space)
        space.get_legend().remove()
        for k, loop in enumerate(found.loops):
            ax = figure.add_axes((0.77, 0.62 - 0.5 * k, 0.22, 0.31))
            for path, colour in zip(zeros(diagram, refined(loop)).T, (ANGULAR_MOMENTUM, FIRST_FIELD, INK), strict=True):
                ax.plot(path.real, path.imag, color=colour, linewidth=1)
                ax.plot(path.real[0], path.imag[0], "o", color=colour, markersize=4)
            ax.axhline(0, color=MUTED, linewidth=0.6)
            ax.set(title=rf"$\sigma_{found.braids[k][0]}$", xlabel=r"$\mathrm{Re}\,z$", ylabel=r"$\mathrm{Im}\,z$")
        figure.savefig(folder / "lagrange-bifurcations.png", dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
