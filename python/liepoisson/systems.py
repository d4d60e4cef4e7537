"""Systems, by a bracket and a Hamiltonian or by their equations, from Python or a file, and the report on them."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
