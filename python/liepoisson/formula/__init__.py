"""Under the formulas and files that users write: grammar, names, bounded arithmetic, TOML."""
