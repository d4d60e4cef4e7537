"""Fits: of a model to observed orbits, and of laws to the mean exponent of an ensemble as a function of time."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
