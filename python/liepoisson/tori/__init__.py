"""Integrable systems: momentum maps, critical values, tori with their periods and frequencies, monodromy."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
