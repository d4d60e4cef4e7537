"""Lie-Poisson brackets, and what is proved about them."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
