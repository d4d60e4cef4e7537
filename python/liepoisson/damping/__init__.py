"""Damping that keeps the geometry: double brackets and metriplectic flows, derived from the bracket."""
