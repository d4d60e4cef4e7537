"""Observed orbits beside a model: data, their sensitivities to what is unknown, and fits by least squares."""
