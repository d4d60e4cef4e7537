"""Lax pairs: verified over any algebra, their integrals and spectral curves, and a search for pairs of one form."""
