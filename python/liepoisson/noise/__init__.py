r"""Systems that are shaken and stay on their leaves: $dx = \{x,H\}\,dt + \sum_k\{x,H_k\}\circ dW_k$."""
