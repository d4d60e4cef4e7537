"""Proofs in ball arithmetic (Arb)."""
