"""What callers give, read once, and what is said where it is refused."""
