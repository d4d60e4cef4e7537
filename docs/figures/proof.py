"""The figures of docs/proof.md, from the certificate in the package: `python docs/figures/proof.py [FOLDER]`, seconds.

Nothing here is rigorous: orbits are integrated in doubles, and the figures show what the checkers prove.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import liepoisson as lp
from liepoisson.plot.style import ANGULAR_MOMENTUM, FIRST_FIELD, INK, MUTED, house_style, new_figure
from liepoisson.proofs.theorem import shipped_certificate

FOLDER = Path(__file__).parent.parent / "images"
TOP = lp.Top.twisted_kovalevskaya()
CERTIFICATE = shipped_certificate(TOP)
CENTER = np.array([s.center for s in CERTIFICATE.sets])
FRAME = np.array([s.frame for s in CERTIFICATE.sets])
SIGNS = np.array(CERTIFICATE.symmetry)
SHORT, LONG = 2, len(CERTIFICATE.edges)
U, FLOW, S = [0, 1], 2, [3, 4]


def pieces(edges):
    """The orbits of the centers along some edges, one after the other, each in the copy in which the orbit arrives."""
    sign, found = np.ones(9), []
    for edge in edges:
        times = np.linspace(0, edge.time, 120)
        found.append(sign * lp.integrate(TOP, CENTER[edge.source], times=times).state[0])
        sign = sign * (SIGNS if edge.symmetry else 1)
    return found


def spheres():
    r"""$\gamma$ and the homoclinic orbit: the directions of $\ell$, $\alpha$ and $\beta$ in the body."""
    gamma = np.concatenate(pieces([*CERTIFICATE.edges[:SHORT]] * 2))
    parts = pieces(CERTIFICATE.edges[SHORT:])
    excursion = np.concatenate(parts)
    sets = np.array([part[0] for part in parts[1:]])
    figure = new_figure(8.2, 3.3)
    axes = figure.subplots(1, 3)
    for k, (ax, name) in enumerate(zip(axes, (r"\ell", r"\alpha", r"\beta"), strict=True)):
        azimuth = (120.0, 35.0, 35.0)[k]
        ax.set_aspect("equal")
        ax.axis("off")
        _globe(ax, azimuth)
        for states, colour, width, label in (
            (excursion, ANGULAR_MOMENTUM, 0.9, "homoclinic orbit"),
            (gamma, FIRST_FIELD, 2.2, r"$\gamma$"),
        ):
            _curve(ax, _view(_direction(states, k), azimuth), colour, width, label)
        x, y, z = _view(_direction(sets, k), azimuth)
        ax.plot(x[z > 0], y[z > 0], "o", color=INK, markersize=2.6, label="sets $N_{q_i}$", zorder=5)
        ax.plot(x[z <= 0], y[z <= 0], "o", color=MUTED, markersize=1.8, fillstyle="none", markeredgewidth=0.5, zorder=1)
        ax.text(0.0, 1.12, rf"${name}/|{name}|$", ha="center")
        ax.set_xlim(-1.06, 1.06)
        ax.set_ylim(-1.06, 1.32)
    handles = [h for h in axes[0].get_legend_handles_labels()[0] if not h.get_label().startswith("_")]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _direction(states, k):
    v = states[:, 3 * k : 3 * k + 3]
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def _view(v, azimuth):
    """Orthographic projection: to the right, up, and towards the eye."""
    azimuth, height = np.radians(azimuth), np.radians(22.0)
    eye = np.array([np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return v @ right, v @ np.cross(eye, right), v @ eye


def _globe(ax, azimuth):
    t = np.linspace(0, 2 * np.pi, 241)
    ax.plot(np.cos(t), np.sin(t), color=MUTED, linewidth=0.7)
    for axis in range(3):
        circle = np.roll(np.stack([np.zeros_like(t), np.cos(t), np.sin(t)], axis=1), axis, axis=1)
        x, y, z = _view(circle, azimuth)
        ax.plot(np.where(z > 0, x, np.nan), np.where(z > 0, y, np.nan), color="#d5d2c8", linewidth=0.6, zorder=0)
    for axis in range(3):
        tip = np.zeros((1, 3))
        tip[0, axis] = 1.0
        x, y, z = (float(value[0]) for value in _view(tip, azimuth))
        if z > 0:
            ax.plot(x, y, ".", color=MUTED, markersize=3, zorder=0)
            ax.annotate(f"${axis + 1}$", (x, y), (3, 3), textcoords="offset points", fontsize=8, color=MUTED)


def _curve(ax, projected, colour, width, label):
    x, y, z = projected
    ax.plot(
        np.where(z > 0, x, np.nan), np.where(z > 0, y, np.nan), color=colour, linewidth=width, label=label, zorder=3
    )
    ax.plot(
        np.where(z > 0, np.nan, x), np.where(z > 0, np.nan, y), color=colour, linewidth=0.5 * width, alpha=0.4, zorder=2
    )


def coverings():
    """Images of the boundaries of the sets, edge by edge: around the next set, and within it."""
    chosen = [0, 1, 2, 13, 15, LONG - 1]
    images = [_image(edge) for edge in CERTIFICATE.edges]
    names = {0: "p_a", 1: "p_b"} | {k: f"q_{{{k - 1}}}" for k in range(2, len(CENTER))}
    figure = new_figure(8.2, 5.3)
    grid = figure.add_gridspec(3, len(chosen), height_ratios=[1, 1, 1.3])
    circle = np.exp(1j * np.linspace(0, 2 * np.pi, 181))
    for column, e in enumerate(chosen):
        edge, (u, s) = CERTIFICATE.edges[e], images[e]
        for row, (points, colour) in enumerate(((u, ANGULAR_MOMENTUM), (s, FIRST_FIELD))):
            ax = figure.add_subplot(grid[row, column])
            ax.fill(circle.real, circle.imag, color="#ece9df", zorder=0)
            ax.plot(circle.real, circle.imag, color=INK, linewidth=0.8)
            ax.plot(points[:, 0], points[:, 1], ".", color=colour, markersize=1.1)
            limit = 3.9 if row == 0 else 1.15
            ax.set_xlim(-limit, limit)
            ax.set_ylim(-limit, limit)
            ax.set_aspect("equal")
            ax.grid(visible=False)
            ax.tick_params(labelsize=8)
            ticks = (-2, 0, 2) if row == 0 else (-1, 0, 1)
            ax.set(xticks=ticks, yticks=ticks)
            if row == 0:
                ax.set_title(rf"${names[edge.source]} \to {names[edge.target]}$", loc="center", fontsize=10)
            if column == 0:
                ax.set_ylabel(("unstable plane", "stable plane")[row], fontsize=9.5)
            else:
                ax.set_yticklabels([])
    ax = figure.add_subplot(grid[2, :])
    place = np.arange(len(images))
    ax.plot(place, [np.linalg.norm(u, axis=1).min() for u, _ in images], "o", color=ANGULAR_MOMENTUM, markersize=4,
            label=r"least $|q_u'|$ of images of $|q_u| = 1$")  # fmt: skip
    ax.plot(place, [np.linalg.norm(s, axis=1).max() for _, s in images], "o", color=FIRST_FIELD, markersize=4,
            label=r"greatest $|q_s'|$")  # fmt: skip
    ax.axhline(1, color=INK, linewidth=0.8, linestyle="--")
    ax.set_ylim(0, 3.0)
    ax.set_xlim(-0.7, len(images) - 0.3)
    ax.set_xticks(place, [f"${names[edge.target]}$" for edge in CERTIFICATE.edges], fontsize=9)
    ax.set_xlabel("set that is covered")
    ax.grid(visible=True, axis="y")
    ax.grid(visible=False, axis="x")
    ax.legend(ncols=2, loc="upper right")
    return figure


def _image(edge, n=600):
    """Coordinates in the next set of points with |q_u| = 1 (unstable), and of points with |q_u| <= 1 (stable)."""
    rng = np.random.default_rng(edge.source)
    angles = rng.uniform(0, 2 * np.pi, (2, n))
    size = np.where(np.arange(n) % 2, 1.0, np.sqrt(rng.random(n)))
    q = np.zeros((n, 9))
    q[:, U] = np.stack([np.cos(angles[0]), np.sin(angles[0])], axis=1) * size[:, None]
    q[:, S] = np.stack([np.cos(angles[1]), np.sin(angles[1])], axis=1) * np.sqrt(rng.random(n))[:, None]
    x = CENTER[edge.source] + q @ FRAME[edge.source].T
    x = lp.integrate(TOP, x, times=[0, edge.time]).state[:, -1] * (SIGNS if edge.symmetry else 1)
    inverse = np.linalg.inv(FRAME[edge.target])
    found = (x - CENTER[edge.target]) @ inverse.T
    rate = TOP.vector_field(x) @ inverse.T
    found -= rate * (found[:, FLOW] / rate[:, FLOW])[:, None]  # along the flow to the section, less than 1e-3 away
    return found[size == 1.0][:, U], found[:, S]


def main(folder: Path) -> None:
    """Leaves both figures in a folder."""
    with house_style():
        for name, figure in (("proof-orbits", spheres()), ("proof-coverings", coverings())):
            figure.savefig(folder / f"{name}.png", dpi=170)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
