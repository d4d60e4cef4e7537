"""Equilibria, relative equilibria and their stability."""
