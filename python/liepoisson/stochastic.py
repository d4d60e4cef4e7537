"""Systems with noise that stay on their leaves: ensembles, laws, first passages, exponents."""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
