r"""Casimirs of Leibniz extensions in closed form, from the Casimirs of the Lie algebra itself.

g (x) R[z]/(z^n) is a generalised Takiff algebra.  If F is a Casimir of g, so are the n lowest coefficients of

$$F(\epsilon x_0 z^{n-1} + x_1 z^{n-2} + \dots + x_{n-1}) \mod z^n .$$

For so(3) and $F = |x|^2$ these are $C_k = \sum_{i+j=n-2+k} x_i \cdot x_j$, $k = 1, \dots, n$, halved for odd n + k, as
each product then occurs twice (the leading coefficients are 1).  For n > 2 epsilon stands before the terms that
contain $x_0$: rescale $e_k$, $k \ge 1$, by $\epsilon^{k-1}$ in the formula for epsilon = 1; a common power drops out.

References: Rais and Tauvel, J. reine angew. Math. 425 (1992) 123, for their completeness when g is semisimple.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Exact, is_zero
from liepoisson.structure.poisson.leading_monomials import monic

if TYPE_CHECKING:
    from liepoisson.algebra.sparse_polynomials import Polynomial
    from liepoisson.structure.extension import Extension


def leibniz_strength(extension: Extension) -> Exact | None:
    """The number epsilon with e_0 e_mu = e_mu, e_mu e_nu = epsilon e_(mu+nu), or None if this is no such algebra."""
    W, n = extension.tensor, extension.dimension
    strength = W[2][1][1] if n > 2 else W[0][0][0]
    for lam, mu, nu in product(range(n), repeat=3):
        expected = 0 if mu + nu != lam else (strength if mu and nu else 1)
        if not is_zero(W[lam][mu][nu] - expected):
            return None
    return strength


def lifted(casimir: Polynomial, dimension: int, n: int, strength: Any) -> list[Polynomial]:
    """The n Casimirs of the Leibniz extension that come from one homogeneous Casimir of g.

    Args:
        casimir: F, its coefficients elements of a field.
        dimension: The dimension of g.
        n: Order of the extension.
        strength: Epsilon, an element of that field.

    Returns:
        The coefficients of z^(n-1), ..., z^0, each with leading coefficient 1.
    """
    degree = len(next(iter(casimir)))
    found: list[Polynomial] = [{} for _ in range(n)]
    for labels in product(range(n), repeat=degree):
        power = sum(n - 1 - label for label in labels)
        if power >= n:
            continue
        target = found[n - 1 - power]
        for monomial, coefficient in casimir.items():
            key = tuple(sorted(label * dimension + i for label, i in zip(labels, monomial, strict=True)))
            value = coefficient * strength if 0 in labels and n > 1 else coefficient
            target[key] = target[key] + value if key in target else value
    return [monic(polynomial, dimension) for polynomial in found]
