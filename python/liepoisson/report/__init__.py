"""Under the report of `inspect`: vector notation recognised, facts gathered, lines written in a style."""
