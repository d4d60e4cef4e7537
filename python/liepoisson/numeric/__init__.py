"""The numeric wing: trajectories and exponents, for one state or for millions, with one outcome per trajectory."""
