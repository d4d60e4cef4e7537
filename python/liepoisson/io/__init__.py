"""Results, files and tables."""
