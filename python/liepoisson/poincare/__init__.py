"""Surfaces of section and returns to them."""
