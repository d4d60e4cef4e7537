"""Is a system integrable? First integrals searched exactly, proofs that there are none, and certificates."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
