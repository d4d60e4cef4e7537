"""Trajectories, and what is seen along them: attitudes in space, rods, the natural unit of time."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
