"""How wide are the rigorous enclosures, beside what CAPD publishes?  `python verification/enclosure_widths.py`.

Prints the table of docs/enclosures.md.  The numbers of CAPD are those that its sources print as the output of their
examples (github.com/CAPDGroup/CAPD at 7310792, capdDynSys/examples: poincare/IPoincareMapDerivativeExample.cpp and
RosslerPeriodicOrbit/RosslerPeriodicOrbit.cpp).  Its example of Lorenz's equations prints no bounds; its data, the boxes
of Galias and Tucker that it starts from, are shown.  There is no published example for Henon and Heiles' system.

Every enclosure must have numbers in common with what is published: both contain the truth.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

import liepoisson as lp
from liepoisson.proofs.polynomial_field import PolynomialField, field_of_formulas

ROESSLER = field_of_formulas({"x": "-(y + z)", "y": "x + y/5", "z": "1/5 + z*(x - 57/10)"})
LORENZ = field_of_formulas({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"})

Bounds = tuple[str, str]
POINT = (0.0, -8.3809417428298, 0.029590060630665)
MAP: dict[str, Bounds] = {
    "y": ("-8.3809417428304709", "-8.380941742829652"),
    "z": ("0.029590060630664217", "0.029590060630669816"),
    "time": ("5.8810884555538525", "5.8810884555539493"),
    "dy/dy": ("-2.4048455658571841", "-2.4048455658533383"),
    "dz/dz": ("0.00089203400376549973", "0.00089203400378485296"),
}
"""CAPD: image of the point, return time, and two entries of the derivative of the Poincare map on x = 0."""

ORBITS: tuple[tuple[tuple[float, float, float], dict[str, Bounds]], ...] = (
    (
        POINT,
        {
            "y": ("-8.3809417428299415", "-8.3809417428298101"),
            "z": ("0.029590060630665858", "0.029590060630668349"),
            "time": ("5.8810884555537228", "5.881088455554079"),
        },
    ),
    (
        (0.0, -5.4240738226652, 0.031081210807875),
        {
            "y": ("-5.4240738226653775", "-5.4240738226650347"),
            "z": ("0.031081210807869089", "0.031081210807883793"),
            "time": ("11.758626071659574", "11.758626071660617"),
        },
    ),
    (
        (0.0, -6.233158628537965, 0.03064011165815),
        {
            "y": ("-6.2331586285383187", "-6.2331586285376348"),
            "z": ("0.030640111658149713", "0.030640111658171425"),
            "time": ("17.515791070334913", "17.515791070336615"),
        },
    ),
)
"""CAPD: where its orbits of periods 1, 2 and 3 cross x = 0, and their return times."""

SHORTEST = (13.7636106821342, 19.5787519424518, 27.0)
BOX: dict[str, Bounds] = {
    "x": ("13.763609251640831488", "13.763610985726442593"),
    "y": ("19.578751208220534608", "19.578752930057270021"),
}
"""Galias and Tucker: a box on z = 27 that contains a point of the shortest orbit."""


def main() -> None:
    """Print the table."""
    print("| what | quantity | published | intervals | balls |")
    print("|---|---|---|---|---|")
    for row in rows():
        print(f"| {' | '.join(row)} |")


def rows() -> Iterator[tuple[str, ...]]:
    """The rows of the table."""
    maps = [
        lp.proofs.enclose_section_map(ROESSLER, POINT, surface="x", direction=1, arithmetic=a) for a in arithmetics()
    ]
    found: list[dict[str, tuple[float, float]]] = [
        {
            "y": sides(one.image, 1),
            "z": sides(one.image, 2),
            "time": one.time,
            "dy/dy": sides(one.derivative, (1, 1)),
            "dz/dz": sides(one.derivative, (2, 2)),
        }
        for one in maps
    ]
    yield from compared("Rössler, Poincaré map of a point", MAP, found)
    for number, (start, published) in enumerate(ORBITS, start=1):
        period = sum(map(float, published["time"])) / 2
        found = [orbit(ROESSLER, start, period, a) for a in arithmetics()]
        meeting = {key: published[key] for key in ("time",)}
        yield from compared(f"Rössler, orbit of period {number}", published, found, meeting)
    found = [orbit(LORENZ, SHORTEST, 1.558652210716175, a) for a in arithmetics()]
    for row in compared("Lorenz, shortest orbit", BOX, found):
        yield (*row[:2], f"({row[2]})", *row[3:])
    yield ("Lorenz, shortest orbit", "time", "none", *(width(one["time"]) for one in found))
    yield from henon_heiles()


def henon_heiles() -> Iterator[tuple[str, ...]]:
    """A hyperbolic orbit on H = 1/10, and a box that is carried once around."""
    system = lp.catalog.system("henon-heiles")
    first = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=10)[0]
    proved = [
        lp.proofs.prove_periodic_orbit(system, first.start, period=first.period, level={"H": "1/10"}, arithmetic=a)
        for a in arithmetics()
    ]
    name = "Hénon–Heiles, hyperbolic orbit on H = 1/10"
    yield (name, "state", "none", *(f"{one.states.width[0].max():.1e}" for one in proved))
    yield (name, "time", "none", *(width(one.period) for one in proved))
    yield (name, "multiplier", "none", *(f"{one.multipliers_real.width[0]:.1e}" for one in proved))
    box = lp.proofs.Box.around([0, 0.1, 0.3, 0.1], [0, 1e-6, 1e-6, 1e-6])
    maps = [lp.proofs.enclose_section_map(system, box, surface="x", direction=1, arithmetic=a) for a in arithmetics()]
    yield ("Hénon–Heiles, a box of width 2e-6 to x = 0", "state", "none", *(f"{m.image.width.max():.1e}" for m in maps))


def arithmetics() -> tuple[Any, ...]:
    """The two arithmetics."""
    return ("intervals", "balls")


def orbit(
    field: PolynomialField, start: tuple[float, ...], period: float, arithmetic: Any
) -> dict[str, tuple[float, float]]:
    """Bounds of a periodic orbit on its first section, and of its period."""
    found = lp.proofs.prove_periodic_orbit(field, start, period=period, arithmetic=arithmetic)
    states = {name: sides(found.states, (0, k)) for k, name in enumerate(field.names)}
    return {**states, "time": found.period}


def sides(box: lp.proofs.Box, place: Any) -> tuple[float, float]:
    """The bounds of one entry of a box."""
    return float(box.lower[place]), float(box.upper[place])


def compared(
    what: str,
    published: dict[str, Bounds],
    found: list[dict[str, tuple[float, float]]],
    same: dict[str, Bounds] | None = None,
) -> Iterator[tuple[str, ...]]:
    """Rows of widths; those that bound the same number must meet."""
    for key, (low, high) in published.items():
        for one in found:
            meets = Fraction(one[key][0]) <= Fraction(high) and Fraction(low) <= Fraction(one[key][1])
            if key in (published if same is None else same) and not meets:
                raise AssertionError(f"{what}, {key}: {one[key]} and {(low, high)} have nothing in common")
        yield (what, key, f"{float(Fraction(high) - Fraction(low)):.1e}", *(width(one[key]) for one in found))


def width(bounds: tuple[float, float]) -> str:
    """The width as the table shows it."""
    return f"{np.nextafter(bounds[1] - bounds[0], np.inf):.1e}"


if __name__ == "__main__":
    main()
