"""Lie algebras, commutative algebras, brackets, Casimirs, strata and symmetries."""
