"""Sweeps: one quantity over a grid of parameters, energies and Casimirs, on one machine or many."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
