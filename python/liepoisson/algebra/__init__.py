"""Exact algebra without physics: number fields, polynomials, elimination."""
