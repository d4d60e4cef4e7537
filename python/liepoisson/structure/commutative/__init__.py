"""Under the extensions: the structure of commutative algebras and the way to their normal forms."""
