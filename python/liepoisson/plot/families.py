"""The figure of a family: the period of its orbits against the energy or a Casimir, with stability and bifurcations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind
from liepoisson.plot.labels import label, number, plain
from liepoisson.plot.style import (
    ANGULAR_MOMENTUM,
    FIRST_FIELD,
    INK,
    MUTED,
    axes_or_new,
    house_style,
    named_once,
    set_heading,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from liepoisson.orbits.closed_orbits import PeriodicOrbit
    from liepoisson.orbits.orbit_families import OrbitFamily

_LINES = {
    "elliptic": ("-", FIRST_FIELD),
    "neutral": ("-", FIRST_FIELD),
    "mixed": ("-.", MUTED),
    "hyperbolic": ("--", ANGULAR_MOMENTUM),
}
_MARKS = {"fold": "s", "branch": "o", "double period": "^", "collision": "D"}


@explains_its_arguments
def family(found: OrbitFamily, *, ax: Axes | None = None) -> Axes:
    """The periods of a family against what varies along it: a dot for each orbit, marks at bifurcations.

    Lines by stability join them; between the dots nothing was computed.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> henon = lp.catalog.system("henon-heiles")
        >>> straight = lp.orbits.periodic_orbit(henon, [0, 0, 0, 0.2], period=6.3)
        >>> axes = lp.plot.family(lp.orbits.orbit_family(henon, straight, until=0.14))
        >>> [text.get_text() for text in axes.get_legend().get_texts()]
        ['elliptic', 'hyperbolic', 'double period']
        >>> plt.close(axes.figure)

    Args:
        found: What `orbit_family` returned; call it again with the same `ax` for a branch.

    Raises:
        ParameterError: it is no family of orbits, or the axes show another quantity.
    """
    from liepoisson.orbits.orbit_families import OrbitFamily

    check_kind(found, OrbitFamily, "found", "what orbit_family returns", "call it first")
    with house_style():
        is_new, ax = ax is None, axes_or_new(ax)
        varies = "$H$" if found.along == "energy" else label(found.along)
        if ax.get_xlabel() not in {"", varies}:
            raise ParameterError(
                f"found: wanted a family along what these axes show, {ax.get_xlabel()}; this one is along {varies}. "
                "Draw it into other axes."
            )
        name = named_once(ax)
        for kind, places in _stretches(found):
            style, colour = _LINES[kind]
            (drawn,) = ax.plot(*zip(*places, strict=True), linestyle=style, color=colour, label=name(kind))
            drawn.set(linewidth=1.4, marker=".", markersize=4)
        for point in found.points:
            ax.plot(
                *_place(point.orbit, found.along),
                _MARKS[point.kind],
                color=INK,
                markersize=4.5,
                zorder=4,
                label=name(point.kind),
            )
        ax.set(xlabel=varies, ylabel="period $T$")
        held = {"H": found[0].energy, **found[0].level.leaf.casimirs}
        held.pop("H" if found.along == "energy" else found.along, None)
        words = ", ".join(f"{label(key)} = ${number(one)}$" for key, one in held.items())
        set_heading(ax, "\n".join(filter(None, [plain(found.system.name), words])), is_new=is_new)
        ax.legend()
    return ax


def _place(orbit: PeriodicOrbit, along: str) -> tuple[float, float]:
    """Where an orbit stands in the figure."""
    from liepoisson.orbits.orbit_families import value_of

    return value_of(orbit, along), orbit.period


def _stretches(found: OrbitFamily) -> list[tuple[str, list[tuple[float, float]]]]:
    """Stretches of one stability with their places; where it changes at a bifurcation, they meet there."""
    stretches = [(found[0].stability, [_place(found[0], found.along)])]
    for k, orbit in enumerate(found[1:]):
        between = [_place(one.orbit, found.along) for one in found.points if one.after == k]
        here = _place(orbit, found.along)
        if orbit.stability == stretches[-1][0]:
            stretches[-1][1].extend([*between, here])
        else:
            *before, last = between or [here]
            stretches[-1][1].extend([*before, last])
            stretches.append((orbit.stability, [last, here]))
    return stretches
