"""Systems: a bracket and a Hamiltonian; their files and charts."""
