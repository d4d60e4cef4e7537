"""The laboratory for Lie-Poisson (noncanonical Hamiltonian) dynamics.

The names that most people need are here, the rest is in chapters: `liepoisson.algebras`, `liepoisson.chaos` and so on.
`dir(liepoisson)` lists both. Names are loaded when they are first used: importing the package costs numpy's import and
no more, so that a new process has its first ensemble result early.
"""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
