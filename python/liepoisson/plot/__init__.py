"""Figures of results.  They see result objects and Datasets only, and import matplotlib when they draw."""

from liepoisson.plot.exponents import convergence, exponent_distribution, window_scan
from liepoisson.plot.style import house_style, save_figure

__all__ = ["convergence", "exponent_distribution", "house_style", "save_figure", "window_scan"]
