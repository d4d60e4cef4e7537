"""Commutative algebras A, by which a Lie algebra g is extended to g (x) A."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
