"""Cohomology of commutative algebras: cocycles, the deformations that they begin, and their orbits."""
