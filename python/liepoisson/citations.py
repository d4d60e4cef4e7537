"""How to cite liepoisson and the works that describe what was used."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
