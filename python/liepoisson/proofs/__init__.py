"""Proofs by computer: certificates of chaos, checked in rigorous arithmetic, and how they are found."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
