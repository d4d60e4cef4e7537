"""The figures of docs/sections.md: `python docs/figures/sections.py [FOLDER]`, about half a minute."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import liepoisson as lp
from liepoisson.plot.section import section as draw
from liepoisson.plot.style import house_style, new_figure
from liepoisson.poincare.surfaces import section_state

FOLDER = Path(__file__).parent.parent / "images"
FORMAT = {"format": "png", "dpi": 160}


def kovalevskaya():
    r"""The Kovalevskaya top, two degrees of freedom: a true section, whose curves are cuts of tori.

    On $\ell_3 = 0$, for the values of $H$ and $\ell\cdot\alpha$ below, the direction of $(\ell_1, \ell_2)$ and
    $\alpha_3$ determine the state up to the sign of $(\ell\times\alpha)_3$; the points where it is positive are shown.
    For other values there may be several $|\ell|$.
    """
    top = lp.catalog.system("kovalevskaya")
    energy, leaf = 1.5, lp.Leaf(top, {"C1": 0.5, "C2": 1})
    wanted = [(0.0, v) for v in (0.25, 0.5, 0.7, 0.82, 0.91)] + [(np.pi, v) for v in (0.06, 0.2, 0.33, 0.46, 0.6, 0.75)]
    wanted += [(np.pi, -v) for v in (0.3, 0.45, 0.6, 0.75)] + [(angle, 0.0) for angle in (0.95, 1.1, 1.3, 1.45)]
    wanted += [(angle, 0.0) for angle in (1.6, 1.75, 1.9, 2.05, 2.2, -1.1, -1.3, -1.5, -1.7, -1.9)]
    x0 = [_with_direction(leaf, energy, angle, height) for angle, height in wanted]
    points = lp.section(top, x0, surface="l3", t_end=1e5, n_crossings=2500)
    l1, l2, _, alpha1, alpha2, alpha3 = points.state.T
    angle = np.mod(np.arctan2(l2, l1) + np.pi / 2, 2 * np.pi) - np.pi / 2
    side = l1 * alpha2 - l2 * alpha1 > 0
    with house_style():
        figure = new_figure(6.6, 4.4)
        ax = figure.add_subplot()
    draw(points, np.where(side, angle / np.pi, np.nan), alpha3, size=0.9, ax=ax)
    ax.set_xlabel(r"direction of $(\ell_1, \ell_2)$, in units of $\pi$")
    ax.set_ylabel(r"$\alpha_3$")
    ax.set_xlim(-0.5, 1.5)
    ax.set_title(r"Kovalevskaya top, $\ell_3 = 0$: $H = 3/2$, $\ell\cdot\alpha = 1/2$, $|\alpha| = 1$")
    return figure


def _with_direction(leaf, energy, angle, height):
    """The state on l3 = 0 with this direction of l and this alpha3, alpha to the left of l."""
    c, s = np.cos(angle), np.sin(angle)
    guess = [2.4 * c, 2.4 * s, 0, -0.9 * s, 0.9 * c, height]
    return section_state(leaf, "l3", energy, {"alpha3": height, f"({s})*l1 - ({c})*l2": 0.0}, guess=guess)


def twisted_lagrange():
    r"""The twisted Lagrange top reduced by its axis: two degrees of freedom, a true section.

    On $a\cdot(\alpha\times\beta) = 0$ the azimuth is $\phi = \pm\pi/2$, so that the section is $\cos\phi = 0$.  Where
    $\phi = -\pi/2$ the reduced Hamiltonian is convex in $p_\phi$, so that $(\theta, p_\theta)$ and the direction of
    travel determine $p_\phi$.  Shown are the crossings with $\sin\phi < 0$ and $\dot\phi < 0$.
    """
    top = lp.Top.twisted_lagrange(transverse=2, axial=1)
    start = np.array([0.4, 0.3, 0.9, 0.5, -0.2, 0.3, 0.3, 0.1, 0.8])
    leaf, energy, surface = lp.Leaf.through(top, start), 1.6, lp.sections.good_surface(top)
    x0 = []
    for cosine in (
        -0.95,
        -0.92,
        -0.84,
        -0.78,
        -0.7,
        -0.62,
        -0.55,
        -0.48,
        -0.41,
        -0.34,
        -0.28,
        *np.linspace(-0.2, 0.98, 16),
    ):
        wanted = {"l3": 0.9, "beta3": cosine * np.sqrt(leaf.casimirs["C3"]), "beta1*l2 - beta2*l1": 0.0}
        try:
            x0.append(section_state(leaf, surface, energy, wanted))
        except lp.errors.LeafError:  # the energy does not reach this inclination
            continue
    chart = lp.charts.ReducedLagrange(top, state=start)
    points = lp.section(chart.system, chart.from_body(x0), surface="cos(phi)", t_end=1e5, n_crossings=4000)
    phi, theta, _, momentum = points.state.T
    side = np.sin(phi) < 0
    shown = side & (points.sign == points.sign[side][0])
    with house_style():
        figure = new_figure(6.6, 4.4)
        ax = figure.add_subplot()
    draw(points, np.where(shown, theta, np.nan), momentum, xlabel=r"$\theta$", ylabel=r"$p_\theta$", size=0.9, ax=ax)
    ax.set_title(rf"twisted Lagrange top, $\phi = -\pi/2$, $\dot\phi < 0$: $H = {energy}$, $\ell_3 = 0.9$")
    return figure


def projections():
    r"""Two 4-dimensional sections projected to a plane: one orbit of an integrable top, and one of a chaotic one.

    Each panel has its own scale: on a common one the folds on the left could not be seen.
    """
    with house_style():
        figure = new_figure(8.6, 4.0)
        axes = figure.subplots(1, 2)
    panels = (
        (lp.Top.twisted_lagrange(transverse=2, axial=1), "twisted Lagrange top"),
        (lp.Top.twisted_kovalevskaya(), "twisted Kovalevskaya top"),
    )
    for ax, (top, name), colour in zip(axes, panels, ("#1668b8", "#d1571b"), strict=True):
        x0 = lp.sample_states(top, 12, seed=4)[6]
        kept = ("l1", "dot(l, beta)")
        points = lp.section(
            top, x0, surface=lp.sections.good_surface(top), direction=1, t_end=1e6, n_crossings=20_000, keep=kept
        )
        draw(points, "l1", "dot(l, beta)", ylabel=r"$\ell\cdot\beta$", colour=colour, size=0.6, ax=ax)
        ax.set_title(name)
    return figure


def main(folder: Path) -> None:
    """Draws all figures into a folder."""
    for make in (kovalevskaya, twisted_lagrange, projections):
        with house_style():
            path = folder / f"section-{make.__name__.replace('_', '-')}.png"
            make().savefig(path, **FORMAT, metadata={"Software": None})
        print(path, path.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
