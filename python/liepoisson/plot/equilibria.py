r"""The stability diagram of the sleeping top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed
from liepoisson.plot.style import FIRST_FIELD, INK, SEQUENCE, axes_or_new, house_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatArray: TypeAlias = NDArray[np.float64]

_WIDE = 3.0
"""Width of a word over its height, in parts of the axes."""


@explains_its_arguments
def sleeping_diagram(
    twists: Sequence[float] = (0.0, 1.0), *, spin: float = 6.0, field: float = 6.0, ax: Axes | None = None
) -> Axes:
    r"""Where the sleeping top has a stable spectrum, in the plane of its spin and its field.

    The axes are $p = \ell_3$ and $q = I_1(a_3\alpha_3 + b_3\beta_3)$; each $u = \epsilon a_3^2I_1^2\beta_3$ has a
    curve, on which $Q(\lambda) = \lambda^3 + p\lambda^2 + q\lambda + u$ has a double root m: $p = u/m^2 - 2m$,
    $q = m^2 - 2u/m$. The region in which Q has three real roots is shaded for the last of them. For $u = 0$
    the curve is the parabola $p^2 = 4q$ of the ordinary top, which is stable outside of it.  The words say on which
    side the spectrum of that last top is stable, and lie where no curve crosses them.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = lp.plot.sleeping_diagram(twists=[0, 1, 2])
        >>> print(axes.get_xlabel(), "and", axes.get_ylabel())
        spin $\ell_3$ and field $I_1(a_3\alpha_3 + b_3\beta_3)$
        >>> plt.close(axes.figure)

    Args:
        twists: The values of u.
        spin: The plane is drawn for $|p|$ up to this.
        field: And for $|q|$ up to this.
        ax: Axes to draw into, by default those of a new figure.

    Raises:
        ParameterError: no twist, or a number that is not finite.
    """
    try:
        values = [as_number(u, "twists", "a number") for u in listed(twists, "twists") or ()]
        sound = bool(values) and np.isfinite([*values, spin, field]).all() and spin > 0 and field > 0
    except (TypeError, ValueError):  # no sequence, or no numbers
        values, sound = twists, False
    if not sound:
        raise ParameterError(
            f"twists, spin and field must be finite numbers, at least one twist and positive ranges; got twists = "
            f"{values!r:.80}, spin = {spin!r:.40}, field = {field!r:.40}."
        )
    with house_style():
        ax = axes_or_new(ax, width=5.6, height=4.4)
        _shade(ax, values[-1], spin, field)
        for u, colour in zip(values, SEQUENCE * len(values), strict=False):
            _boundary(ax, u, colour, max(spin, field))
        ax.set(xlim=(-spin, spin), ylim=(-field, field))
        ax.set(xlabel=r"spin $\ell_3$", ylabel=r"field $I_1(a_3\alpha_3 + b_3\beta_3)$")
        ax.legend(loc="upper center")
        for stable, word in ((True, "stable spectrum"), (False, "unstable")):
            if (place := _clear_place(values, spin, field, stable=stable)) is not None:
                words = f"{word}\nfor $u = {values[-1]:g}$"
                ax.text(*place, words, transform=ax.transAxes, color=INK, style="italic", ha="center", va="center")
    return ax


def _clear_place(values: Sequence[float], spin: float, field: float, *, stable: bool) -> tuple[float, float] | None:
    """The point of the region farthest from all curves, the edges and the legend, in parts of the axes."""
    # Middles of cells; a word is about three times as wide as high, so distances across count a third.
    x, y = (grid.ravel() for grid in np.meshgrid((np.arange(60) + 0.5) / 60, (np.arange(60) + 0.5) / 60))
    signs = np.array([_discriminant((2 * x - 1) * spin, (2 * y - 1) * field, u) > 0 for u in values])
    wanted = signs[-1] == stable
    if not wanted.any():
        return None
    edge = np.minimum(np.minimum(x, 1 - x) / _WIDE, np.minimum(y, 1 - y))
    legend = (np.abs(x - 0.5) < 0.3) & (y > 0.82)
    room = np.zeros(len(x))
    for k in np.flatnonzero(wanted & ~legend):
        other = (signs != signs[:, k : k + 1]).any(axis=0) | legend
        distance = np.maximum(np.abs(x[other] - x[k]) / _WIDE, np.abs(y[other] - y[k]))
        room[k] = min(edge[k], distance.min(initial=np.inf))
    best = int(np.argmax(room))
    return float(x[best]), float(y[best])


def _discriminant(p: FloatArray, q: FloatArray, u: float) -> FloatArray:
    """Positive where Q has three real roots; without twist one is 0, and the others are those of the quadratic."""
    return 18 * p * q * u - 4 * p**3 * u + p**2 * q**2 - 4 * q**3 - 27 * u**2 if u else p**2 - 4 * q


def _shade(ax: Axes, u: float, spin: float, field: float) -> None:
    p, q = np.meshgrid(np.linspace(-spin, spin, 801), np.linspace(-field, field, 801))
    ax.contourf(p, q, _discriminant(p, q, u), levels=[0.0, np.inf], colors=[FIRST_FIELD], alpha=0.12)


def _boundary(ax: Axes, u: float, colour: str, extent: float) -> None:
    """The curve of double roots, both branches; the root itself can reach the size of the plane."""
    root = np.geomspace(1e-3, 4 * extent, 4000)
    for m, label in ((-root, rf"$u = \epsilon a_3^2 I_1^2\beta_3 = {u:g}$"), (root, None)):
        ax.plot(u / m**2 - 2 * m, m**2 - 2 * u / m, label=label, color=colour, linestyle="-" if u else "--")
