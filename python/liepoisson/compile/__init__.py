"""A system as plain data for the core."""
