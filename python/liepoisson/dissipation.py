"""Damping that keeps the geometry: double brackets, metriplectic flows, relaxation to equilibria."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
