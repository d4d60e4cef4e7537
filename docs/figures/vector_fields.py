"""The figure of docs/vector-fields.md: `python docs/figures/vector_fields.py [FOLDER]`, some seconds."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import liepoisson as lp
from liepoisson.plot.section import section as draw
from liepoisson.plot.style import house_style, new_figure

FOLDER = Path(__file__).parent.parent / "images"
FORMAT = {"format": "png", "dpi": 160}


def lorenz():
    """An orbit of Lorenz's system after its transient, in x and z, and its crossings of z = 27 downwards."""
    rates = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
    system = lp.VectorField(rates, {"sigma": 10, "rho": 28, "beta": "8/3"}, name="Lorenz")
    start = lp.integrate(system, [1, 1, 20], times=[0, 30]).end_state
    orbit = lp.integrate(system, start, times=np.linspace(0, 40, 8001))
    points = lp.section(system, start, surface="z - 27", direction=-1, t_end=3000)
    with house_style():
        figure = new_figure(8.6, 4.0)
        left, right = figure.subplots(1, 2)
        left.plot(orbit.state[0, :, 0], orbit.state[0, :, 2], linewidth=0.5, color="#1668b8")
        left.set_xlabel("$x$")
        left.set_ylabel("$z$")
        left.axhline(27, color="#777777", linewidth=0.6, linestyle="--")
        left.set_title("an orbit")
        draw(points, "x", "y", colour="#d1571b", size=0.8, ax=right)
        right.set_title("z = 27, downwards")
    return figure


def main(folder: Path) -> None:
    """Draws the figure into a folder."""
    with house_style():
        path = folder / "lorenz.png"
        lorenz().savefig(path, **FORMAT, metadata={"Software": None})
    print(path, path.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
