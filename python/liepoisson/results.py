"""What computations return, how it is read from a file, and how it is repeated."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
