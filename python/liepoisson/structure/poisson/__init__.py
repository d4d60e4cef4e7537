"""Under the brackets: linear Poisson tensors, the search for Casimirs, where a rank drops."""
