"""Deformations of integrable systems: which integrals survive, order by order, and what stops the others."""
