"""Canonical coordinates on symplectic leaves: charts with their domains, and reduced Hamiltonians."""
