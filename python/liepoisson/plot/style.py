"""The house style of figures: serif, vector output, the colours of the vectors; applied in a context only."""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed
from liepoisson.inputs.refusals import not_a
from liepoisson.io.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The colours of the vectors, the same in every figure; the page has shades of its own for each theme (page.css).
ANGULAR_MOMENTUM = "#d1571b"
FIRST_FIELD = "#1668b8"
SECOND_FIELD = "#0b8f5f"
CENTRE_OF_MASS = "#b8860b"
VIOLET = "#7a4fa3"
INK = "#1d2433"
MUTED = "#6b7280"
GRID = "#e4e1d8"
# Of trajectories and other curves, one after the other; here the hues do not mean vectors.
SEQUENCE = (ANGULAR_MOMENTUM, FIRST_FIELD, SECOND_FIELD, CENTRE_OF_MASS, VIOLET, "#4b5563")

FORMATS = ("png", "svg", "pdf")

# Families by name and not "serif": the generic name would be looked up when the figure is drawn, outside the context.
_SETTINGS: dict[str, Any] = {
    "font.family": ["STIXGeneral", "DejaVu Serif"],
    "mathtext.fontset": "stix",
    "text.usetex": False,  # TeX would read names of users as its own text
    "font.size": 10.5,
    "axes.labelsize": 11.5,
    "axes.titlesize": 11.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 8,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.minor.width": 0.5,
    "ytick.minor.width": 0.5,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 9.5,
    "legend.handlelength": 2.2,
    "legend.borderaxespad": 0.2,
    "figure.facecolor": "white",
    "figure.dpi": 110,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 220,
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "liepoisson",
}


@contextmanager
@explains_its_arguments
def house_style() -> Generator[None]:
    """Matplotlib in the house style inside a `with` block; settings outside stay as they were.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> with lp.plot.house_style():
        ...     figure, axes = plt.subplots()
        >>> axes.spines["top"].get_visible(), plt.rcParams["axes.spines.top"]  # no frame, and only inside of the block
        (False, True)
        >>> plt.close(figure)
    """
    import matplotlib as mpl
    from matplotlib.rcsetup import cycler

    settings: dict[Any, Any] = {**_SETTINGS, "axes.prop_cycle": cycler(color=SEQUENCE)}
    interactive = mpl.is_interactive()
    try:
        with mpl.rc_context(settings):
            try:
                yield
            finally:
                interactive = mpl.is_interactive()
    finally:  # a notebook turns it on with the first figure, and shows no other where it is off again
        mpl.interactive(interactive)


def axes_or_new(ax: Axes | None, *, width: float = 6.4, height: float = 4.0) -> Axes:
    """The given axes, or those of a new figure of the given size in inches, known to pyplot."""
    if ax is not None:
        if not hasattr(ax, "get_figure"):  # pyright: ignore[reportUnnecessaryComparison]
            raise not_a("axes of Matplotlib", ax, "ax", "leave it out for a new figure")
        return ax
    import matplotlib.pyplot as plt

    return plt.figure(figsize=(width, height)).add_subplot()


def check_title_of_figure(title: object) -> None:
    """Refuse a title that is no text.

    Raises:
        ParameterError: it is neither a text nor None.
    """
    if title is not None and not isinstance(title, str):
        raise not_a("a text", title, "title", 'write title="...", or leave it out')


_HEADING = "liepoisson_heading"
"""The attribute of axes with the title that we gave them."""
_SEVERAL = re.compile(r"\d+ levels of ")
"""How the line of a title begins that counts what is drawn."""


def set_heading(ax: Axes, heading: str, *, is_new: bool) -> None:
    """Our title of new axes; a title of ours that is there keeps the lines that are true of what is drawn now, too.

    Axes of the caller, or with a title of the caller's, stay as they are.
    """
    if not is_new:
        old = getattr(ax, _HEADING, None)
        if old is None or ax.get_title(loc="left") != old:
            return
        lines = heading.split("\n")
        heading = "\n".join(line for line in old.split("\n") if line in lines and not _SEVERAL.match(line))
    ax.set_title(heading)
    setattr(ax, _HEADING, heading)


def named_once(ax: Axes) -> Callable[[str], str]:
    """What makes labels of words, so that the legend of axes has them once."""
    told = set(ax.get_legend_handles_labels()[1])

    def name(words: str) -> str:
        fresh = words not in told
        told.add(words)
        return words if fresh else "_" + words

    return name


def as_colours(colour: Any) -> tuple[Any, ...]:
    """One colour or a sequence of them, as Matplotlib reads them; without any, those of `house_style`."""
    from matplotlib.colors import is_color_like

    if colour is None:
        return SEQUENCE
    several = None if is_color_like(colour) else listed(colour, "colour")
    colours = (colour,) if several is None else tuple(several)
    if not colours or not all(map(is_color_like, colours)):
        raise ParameterError(
            f'colour must be a colour of Matplotlib or a sequence of them; got {colour!r:.80}. Try "#1668b8".'
        )
    return colours


def as_colour(colour: Any) -> Any:
    """One colour as Matplotlib reads it, or None."""
    return None if colour is None else as_colours((colour,))[0]


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, in inches, that no window system knows of: it is freed when it goes out of scope."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


@explains_its_arguments
def save_figure(figure: Figure, stem: str | Path, *, formats: Sequence[str] = FORMATS) -> tuple[Path, ...]:
    """Write a figure as `stem`.png, .svg and .pdf; the same figure gives the same bytes.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> run = lp.integrate(lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}, t_end=20)
        >>> written = lp.plot.save_figure(lp.plot.orbit(run), Path(mkdtemp()) / "kovalevskaya", formats=["svg"])
        >>> [path.name for path in written]
        ['kovalevskaya.svg']

    Args:
        figure: The figure.
        stem: The path of the files without an ending.
        formats: Those of "png", "svg" and "pdf" that are wanted.

    Raises:
        ParameterError: a format is none of these, or `stem` is no path.
        OutputError: a file could not be written.
    """
    if not hasattr(figure, "get_layout_engine"):  # pyright: ignore[reportUnnecessaryComparison]
        raise not_a("a figure of Matplotlib", figure, "figure", "axes have theirs as ax.figure")
    wanted = listed(formats, "formats")
    if wanted is None or not set(wanted) <= set(FORMATS):
        raise ParameterError(f"formats: wanted a tuple of some of {FORMATS}; got {formats!r:.60}; leave the others out")
    if not isinstance(stem, str | Path):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a path without an ending", stem, "stem", 'write for example "figure"')
    paths: list[Path] = []
    with house_style():
        # Laid out once; each format would lay it out anew.  At the resolution of the PNG file, its texts are ready.
        if (engine := figure.get_layout_engine()) is not None:
            own_dpi, figure.dpi = figure.dpi, float(_SETTINGS["savefig.dpi"])
            try:
                engine.execute(figure)
            finally:
                figure.dpi = own_dpi
        figure.set_layout_engine("none")
        for extension in wanted:
            path = Path(stem).with_suffix(f".{extension}")
            # A date in the file would make every run differ.
            no_date = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(extension, {})
            drawn = BytesIO()
            figure.savefig(drawn, format=extension, metadata=no_date)
            write_atomically(path, drawn.getbuffer())
            paths.append(path)
    return tuple(paths)
