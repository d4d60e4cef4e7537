r"""Casimirs of Leibniz extensions in closed form, from the Casimirs of the Lie algebra itself.

g (x) R[z]/(z^n) is a generalised Takiff algebra.  If F is a Casimir of g, so are the n lowest coefficients of

$$F(\epsilon x_0 z^{n-1} + x_1 z^{n-2} + \dots + x_{n-1}) \mod z^n .$$

For so(3) and $F = |x|^2$ these are $C_k = \sum_{i+j=n-1+k} x_i \cdot x_j$, with epsilon in front of the terms that
contain $x_0$ (rescale $e_k$, $k \ge 1$, by $\epsilon^{k-1}$ in the formula for epsilon = 1; a common power drops out).

References: Rais and Tauvel, J. reine angew. Math. 425 (1992) 123, for their completeness when g is semisimple.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

from liepoisson.exact.parameters import Exact, is_zero

if TYPE_CHECKING:
    from liepoisson.exact.extension import Extension
    from liepoisson.exact.linear.coefficients import Coefficients
    from liepoisson.exact.poisson.casimir_search import Polynomial


def leibniz_strength(extension: Extension) -> Exact | None:
    """The number epsilon with e_0 e_mu = e_mu, e_mu e_nu = epsilon e_(mu+nu), or None if this is no such algebra."""
    W, n = extension.tensor, extension.dimension
    strength = W[2][1][1] if n > 2 else W[0][0][0]
    for lam, mu, nu in product(range(n), repeat=3):
        expected = 0 if mu + nu != lam else (strength if mu and nu else 1)
        if not is_zero(W[lam][mu][nu] - expected):
            return None
    return strength


def lifted(casimir: Polynomial, dimension: int, n: int, strength: Any, field: Coefficients) -> list[Polynomial]:
    """The n Casimirs of the Leibniz extension that come from one homogeneous Casimir of g.

    Args:
        casimir: F, its coefficients elements of the field.
        dimension: The dimension of g.
        n: Order of the extension.
        strength: Epsilon, an element of the field.
        field: Where the coefficients live.

    Returns:
        The coefficients of z^(n-1), ..., z^0, without common factors.
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
    return [primitive(polynomial, field) for polynomial in found]


def primitive(polynomial: Polynomial, field: Coefficients) -> Polynomial:
    """The polynomial without the content of its coefficients, most of which become positive.

    Functions of parameters are divided by their greatest common divisor, so that they have no denominators and, for one
    parameter, no common zero: the polynomial neither has a pole nor vanishes at any value.  Beyond this a polynomial is
    returned as it is if there are other numbers than rational ones among the coefficients.
    """
    if field.parameters:
        polynomial = _without_denominators(polynomial, field)
    numbers: list[Any] = [field.to_sympy(c).as_coeff_Mul()[0] for c in polynomial.values()]
    if not numbers or not all(number.is_Rational for number in numbers):
        return polynomial
    content = Fraction(gcd(*(int(q.p) for q in numbers)), lcm(*(int(q.q) for q in numbers)))
    sign = -1 if sum(1 if number > 0 else -1 for number in numbers) < 0 else 1
    return {monomial: c / field.number(sign * content) for monomial, c in polynomial.items()}


def _without_denominators(polynomial: Polynomial, field: Coefficients) -> Polynomial:
    """A multiple whose coefficients are polynomials in the parameters without a common factor."""
    functions: Any = field.domain.field
    denominator: Any = functions.ring.one
    for c in polynomial.values():
        denominator = denominator.lcm(c.denom)
    numerators = {monomial: c.numer * denominator.exquo(c.denom) for monomial, c in polynomial.items()}
    common: Any = functions.ring.zero
    for numerator in numerators.values():
        common = common.gcd(numerator)
    return {monomial: functions.new(numerator, common) for monomial, numerator in numerators.items()}
