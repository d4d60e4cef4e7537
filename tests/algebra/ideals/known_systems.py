"""Polynomial systems whose number of solutions is known."""

from liepoisson.algebra.ideals.groebner import rational_context


def cyclic(n):
    """The cyclic n-roots: sums of products of k neighbours vanish for k < n, and the product of all is 1."""
    context = rational_context([f"x{i}" for i in range(n)])
    x = context.gens()
    equations = []
    for k in range(1, n + 1):
        total = context.constant(0)
        for i in range(n if k < n else 1):
            term = context.constant(1)
            for j in range(k):
                term = term * x[(i + j) % n]
            total = total + term
        equations.append(total - (k == n))
    return equations


def katsura(n):
    """u_m = sum_i u_|i| u_|m-i| for m < n, and u_0 + 2 (u_1 + ... + u_n) = 1: 2^n solutions."""
    context = rational_context([f"u{i}" for i in range(n + 1)])
    u = [*context.gens(), *[context.constant(0)] * (2 * n + 1)]
    around = range(-n, n + 1)
    first = sum((u[abs(i)] for i in around), context.constant(0)) - 1
    return [first, *(sum((u[abs(i)] * u[abs(m - i)] for i in around), context.constant(0)) - u[m] for m in range(n))]
