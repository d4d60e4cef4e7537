"""Kovalevskaya-Painlevé analysis: balances, exponents, resonances, logarithms, and the verdict."""
