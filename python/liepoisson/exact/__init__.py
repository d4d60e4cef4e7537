"""The exact wing: brackets, Hamiltonians and what follows from them, in exact arithmetic (SymPy at the surface)."""
