"""Proofs by computer: statements on orbits whose certificates are checked in rigorous arithmetic."""
