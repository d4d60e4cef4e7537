"""The figure of docs/twisted-lagrange.md: `python docs/figures/lagrange_bifurcations.py [FOLDER]`, seconds.

The classes of leaves, the critical values on one leaf, and the zeros of R along loops around its two threads.
"""

from __future__ import annotations

import sys
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
    return np.concatenate([a + share * (b - a) for a, b in zip(loop[:-1], loop[1:], strict=True)] + [loop[-1:]])


def main(folder: Path) -> None:
    """Draw it."""
    top = lp.Top.twisted_lagrange()
    diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 8, "C2": 1, "C3": 1}))
    found = lp.tori.lagrange_monodromy(diagram)
    with house_style():
        figure = new_figure(10.5, 4.0)
        lp.plot.leaf_classes(ax=figure.add_subplot(1, 3, 1))
        space = figure.add_subplot(1, 3, 2, projection="3d")
        lp.plot.diagram(diagram, ax=space)
        space.set_title("class UU+", fontsize=9)
        space.legend(loc="upper left", fontsize=6)
        for k, loop in enumerate(found.loops):
            ax = figure.add_subplot(2, 3, 3 * (k + 1))
            for path, colour in zip(zeros(diagram, refined(loop)).T, (ANGULAR_MOMENTUM, FIRST_FIELD, INK), strict=True):
                ax.plot(path.real, path.imag, color=colour, linewidth=1)
                ax.plot(path.real[0], path.imag[0], "o", color=colour, markersize=4)
            ax.axhline(0, color=MUTED, linewidth=0.6)
            ax.set_title(rf"zeros of $R$, $\sigma_{found.braids[k][0]}$", fontsize=9)
        figure.savefig(folder / "lagrange-bifurcations.png", dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
