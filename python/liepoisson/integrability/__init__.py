"""Is a system integrable? First integrals searched exactly, proofs that there are none, and certificates."""
