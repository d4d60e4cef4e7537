"""Differential Galois obstructions: variational equations along a solution, their local and global monodromy."""
