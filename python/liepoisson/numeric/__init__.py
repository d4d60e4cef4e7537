"""Methods, starts, runs: trajectories for one state or for millions, with one outcome per trajectory."""
