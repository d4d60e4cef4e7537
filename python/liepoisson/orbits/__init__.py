"""Orbits, and what is seen along them: trajectories, attitudes in space, rods; periodic and homoclinic orbits."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
