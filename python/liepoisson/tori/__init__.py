"""Invariant tori and their frequencies."""
