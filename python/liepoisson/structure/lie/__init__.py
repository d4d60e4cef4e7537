"""Under the Lie algebras: what structure constants decide, matrices, the sine algebra."""
