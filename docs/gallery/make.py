"""The gallery: `python docs/gallery/make.py [NAME ...]` draws pictures, by default all of them, and writes the index.

A card is a script `NAME.py`, which leaves its picture in `figure`, and the picture `NAME.png`. The docstring of a
script has the title, what is seen, and what to read; the site makes a page of it (docs/site/cards.py). What a picture
shows (words, limits, where its points lie) stands in its file, too, so that a test finds a picture that the script
would draw otherwise today.
"""

from __future__ import annotations

import contextlib
import io
import runpy
import sys
import tempfile
import time
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

from matplotlib import pyplot as plt
from PIL import Image
from PIL.PngImagePlugin import PngInfo

import liepoisson as lp

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER.parent / "site"))

from cards import card, plain  # noqa: E402

DPI = 170
COLOURS = 256
"""Of the palette of a picture, which makes its file three times smaller."""
KEY = "Description"
"""The entry of a picture's file that says what it shows."""
ACROSS = 3
GROUPS = {
    "Tops and bodies": (
        *("kovalevskaya-section", "lagrange-chart", "attitude", "gyrostat", "rattleback", "sphere"),
        *("kirchhoff", "regions", "equilibria", "damped-body", "sleeping-top", "bifurcation", "rod"),
        "double-pendulum",
    ),
    "Twist and charge": (
        *("lyapunov", "twist-section", "twist-sweep", "cubic-twists", "charged-top", "leibniz", "structure"),
    ),
    "Chaos and its measures": (
        *("henon-heiles", "megno-map", "frequencies", "sticky", "spectrum", "exponent-error"),
        *("covariant", "splitting", "homoclinic", "orbit-families", "lorenz", "forced-pendulum", "noise"),
    ),
    "Proofs": ("coverings", "enclosure", "painleve"),
    "Lattices, waves, fluids, other algebras": (
        *("toda", "three-wave", "fluid", "fluid-spectrum", "manakov", "magnetic-bottle"),
    ),
    "Methods": ("discrete-top", "methods", "fit"),
}
"""The cards in the order of the index."""
NAMES = tuple(name for names in GROUPS.values() for name in names)


def figure_of(name: str):
    """The figure that a script leaves; what the script writes goes to a folder that is thrown away."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), mpl.rc_context():
        figure = runpy.run_path(str(FOLDER / f"{name}.py"))["figure"]
    plt.close("all")
    return figure


def content(figure) -> str:
    """What a figure shows, in words and numbers; places of points are in units of the axes."""
    parts = [figure.get_suptitle(), *(text.get_text() for text in figure.texts)]
    parts += [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    for ax in figure.axes:
        legend = ax.get_legend()
        parts += [ax.get_title(loc) for loc in ("left", "center")] + [ax.get_xlabel(), ax.get_ylabel()]
        parts += [text.get_text() for text in ax.texts]
        parts += [] if legend is None else [text.get_text() for text in legend.get_texts()]
        parts.append("limits " + " ".join(f"{end:.3g}" for end in (*ax.get_xlim(), *ax.get_ylim())))
        parts += _drawn("line", ax, [line.get_xydata() for line in ax.lines if line.get_transform() == ax.transData])
        parts += _drawn("set", ax, [np.ma.getdata(one.get_offsets()) for one in ax.collections])
        images = [one.get_array() for one in (*ax.images, *ax.collections) if one.get_array() is not None]
        parts += [f"{one.size} colours, mean {one.mean():.3g}, spread {one.std():.2g}" for one in images]
    return " | ".join(" ".join(part.split()) for part in parts if part)


def _drawn(word: str, ax, pieces) -> list[str]:
    if not pieces:
        return []
    points = np.concatenate([np.asarray(piece, dtype=float) for piece in pieces])
    places = ax.transAxes.inverted().transform(ax.transData.transform(points))
    places = np.clip(places[np.isfinite(places).all(axis=1)], -1, 2)
    if not len(places):
        return [f"{len(pieces)} {word}s without points"]
    x, y = places.T  # the waves see a curve that moved although its mean and its spread did not
    waves = [np.mean(np.exp(40j * x) * y), np.mean(np.exp(30j * y)), np.mean(np.exp(25j * x))]
    values = (*places.mean(axis=0), *places.std(axis=0), *np.real(waves), *np.imag(waves))
    numbers = " ".join(f"{value:.3f}" for value in values)
    return [f"{len(pieces)} {word}s, {len(points)} points at {numbers}"]


def write_picture(name: str) -> Path:
    """Draws a picture."""
    figure, path = figure_of(name), FOLDER / f"{name}.png"
    description = PngInfo()
    description.add_text(KEY, content(figure))
    buffer = io.BytesIO()
    with lp.plot.house_style():
        figure.savefig(buffer, format="png", dpi=DPI)
    with Image.open(buffer) as drawn:
        few = drawn.convert("RGB").quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    few.save(path, optimize=True, pnginfo=description)
    return path


def index() -> str:
    """The page with all cards, group by group."""
    lines = [
        "# Gallery",
        "",
        "Pictures, each with a script of less than 40 lines that makes it in some seconds.",
        "`python docs/gallery/make.py NAME` draws a card again.",
    ]
    for group, names in GROUPS.items():
        lines += ["", f"## {group}", "", "| " * ACROSS + "|", "|---" * ACROSS + "|"]
        for k in range(0, len(names), ACROSS):
            titles = [card(FOLDER / f"{name}.py").title for name in names[k : k + ACROSS]]
            row = [
                f"[![{plain(title)}]({name}.png)]({name}.py)" for name, title in zip(names[k:], titles, strict=False)
            ]
            lines.append("| " + " | ".join(f"{a}<br>{b}" for a, b in zip(row, titles, strict=True)) + " |")
            lines[-1] += " |" * (ACROSS - len(row))
    return "\n".join(lines) + "\n"


def main(names) -> None:
    """Draws the pictures of some cards, and writes the index."""
    for name in names:
        began = time.perf_counter()
        path = write_picture(name)
        seconds, size = time.perf_counter() - began, path.stat().st_size / 1000
        print(f"{name}: {seconds:.1f} s, {size:.0f} kB")
    (FOLDER / "index.md").write_text(index(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:] or NAMES)
