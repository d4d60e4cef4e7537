"""Proofs by computer: rigorous enclosures of orbits, equilibria and periodic orbits, and certificates of chaos."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
