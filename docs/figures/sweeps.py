"""The figures of docs/sweeps.md: `python docs/figures/sweeps.py [FOLDER]`, some minutes on two cores."""

from __future__ import annotations

import sys
from pathlib import Path

from liepoisson.plot.style import INK, MUTED, house_style, new_figure
from liepoisson.plot.sweep import sweep as draw
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis, Refinement

FOLDER = Path(__file__).parent.parent / "images"
FORMAT = {"format": "png", "dpi": 160}


def twist():
    """Where the integrability of the Kovalevskaya top goes when it is twisted."""
    result = sweep(
        system="twisted-top",
        parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        axes=(Axis.linear("epsilon", 0, 1, 21, label=r"twist $\epsilon\,|\beta|$, $|\beta| = 1$"),),
        n_starts=64,
        t_end=1000.0,
        quantity="chaotic_fraction",
        seed=1,
        refine=Refinement(levels=2, difference=0.15),
    )
    told("twist", result)
    with house_style():
        figure = new_figure(6.2, 3.8)
        ax = figure.add_subplot()
    draw(result, ax=ax)
    ax.set_title("Kovalevskaya inertia, $a$ equatorial, $b = 0$: unit-vector starts")
    return figure


def direction():
    """Lagrange inertia, a along the axis: the direction of b decides."""
    common = {
        "system": "twisted-top",
        "axes": (Axis.linear("angle", 0, 1, 25, label=r"angle between $a$ and $b$, in units of $\pi$"),),
        "t_end": 1000.0,
        "quantity": "chaotic_fraction",
        "seed": 1,
    }
    parameters = {"I": [2, 2, 1], "a": [0, 0, 1], "b": ["sin(pi*angle)", 0, "cos(pi*angle)"]}
    refine = Refinement(levels=2, difference=0.2)
    curve = sweep(**common, parameters={**parameters, "epsilon": 1}, n_starts=64, refine=refine)
    told("direction", curve)
    axes = (*common["axes"], Axis.linear("epsilon", 0, 1, 9, label=r"twist $\epsilon\,|\beta|$, $|\beta| = 1$"))
    plane = sweep(**{**common, "axes": axes, "t_end": 500.0}, parameters=parameters, n_starts=16)
    told("direction and twist", plane)
    with house_style():
        figure = new_figure(9.6, 3.9)
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.15))
    draw(curve, ax=left)
    left.set_title(r"twisted, $\epsilon = 1$")
    draw(plane, ax=right)
    right.set_title("Lagrange inertia, $a$ along the axis")
    for ax in (left, right):
        ax.set_xticks([0, 0.25, 0.5, 0.75, 1])
    with house_style():
        for end in (0.0, 1.0):
            line = {"arrowstyle": "-", "color": MUTED, "shrinkA": 0, "linewidth": 0.7}
            left.annotate("", (end, 0.0), (0.3 + 0.4 * end, 0.14), arrowprops=line)
        left.text(0.5, 0.155, r"$b \parallel a$: integrable", ha="center", color=INK)
    return figure


def told(name, result):
    """Print both ends and the numbers of points and orbits."""
    low, high = result.interval()
    for end in (0, len(result.spec.axes[0].values) - 1):
        print(f"{name}: {result.points[end]} {result.statistic[end]:.4f} [{low[end]:.4f}, {high[end]:.4f}]")
    print(f"{name}: {len(result.points)} points, {result.outcomes}")


def main(folder: Path) -> None:
    """Draws both figures into a folder."""
    for name, draw_figure in (("sweep-twist", twist), ("sweep-direction", direction)):
        figure = draw_figure()
        with house_style():
            figure.savefig(folder / f"{name}.png", **FORMAT, metadata={"Software": None})


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
