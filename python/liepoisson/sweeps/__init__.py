"""Sweeps: one quantity over a grid of parameters, energies and Casimirs, on one machine or many."""
