"""Symplectic leaves and samples on them."""
