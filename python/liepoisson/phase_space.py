"""Phase space: leaves and samples on them, bounds, equilibria."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
