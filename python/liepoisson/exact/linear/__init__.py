"""Number fields and linear algebra over them, exact."""
