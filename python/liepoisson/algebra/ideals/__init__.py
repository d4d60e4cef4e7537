"""Systems of polynomial equations over the rational numbers: Gröbner bases, all solutions, components, elimination."""
