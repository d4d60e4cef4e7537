"""Figures of results.  They see result objects and Datasets only, and import matplotlib when they draw."""

from liepoisson._lazy import unknown
from liepoisson.plot.diagrams import diagram, leaf_classes
from liepoisson.plot.exponents import convergence, exponent_distribution, window_scan
from liepoisson.plot.families import family
from liepoisson.plot.fits import orbit_fit
from liepoisson.plot.indicators import indicators, spectrum
from liepoisson.plot.molecules import molecule
from liepoisson.plot.orbits import orbit
from liepoisson.plot.results import draw, profile
from liepoisson.plot.rigid_body import rod, sleeping_diagram
from liepoisson.plot.section import section
from liepoisson.plot.style import house_style, save_figure
from liepoisson.plot.sweep import sweep

__all__ = [
    "convergence",
    "diagram",
    "draw",
    "exponent_distribution",
    "family",
    "house_style",
    "indicators",
    "leaf_classes",
    "molecule",
    "orbit",
    "orbit_fit",
    "profile",
    "rod",
    "save_figure",
    "section",
    "sleeping_diagram",
    "spectrum",
    "sweep",
    "window_scan",
]

__getattr__ = unknown(__name__, __all__)
