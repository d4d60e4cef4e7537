"""Systems: a bracket and a Hamiltonian, or equations alone, made in Python or read from a file, and the report on them."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
