r"""Periods and actions of the twisted Lagrange top as integrals on its spectral curve $y^2 = R(\lambda)$.

Where R > 0 on the real line its zeros are pairs $z_j, \bar z_j$ with $\operatorname{Im} z_j > 0$.  The integrals

$$ \gamma_j = 2\int_{\bar z_j}^{z_j}\frac{(\lambda^2, \lambda, 1)}{iy}\,d\lambda, \qquad
   J_j = \frac{1}{\pi i}\int_{\bar z_j}^{z_j}\frac{y}{\lambda^3}\,d\lambda, $$

with $y = +\sqrt R$ on the real line, along the straight lines, which cross neither it twice nor one another, are a
basis of the periods of the flows of $\ell_3$, h and p, and actions, $2\pi\,dJ_j = \gamma_j\cdot d(\ell_3, h, p)$.  In
the order in which they cross the line $\gamma_1 - \gamma_2 + \gamma_3 = (2\pi, 0, 0)$, the circle of $\ell_3$.  With
$\lambda = x + ib\sin\theta$ on the line of $z = x + ib$ the zeros at its ends cancel, and the integrand is periodic in
$\theta$: the rule with equal weights converges exponentially, at a rate that falls where another zero is near to the
line.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import OrbitError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.portable import elementary, linear
from liepoisson.tori.lagrange_diagrams import LagrangeDiagram, one_value_of

_FEWEST, _MOST = 2**5, 2**16
"""Places on one line, doubled until the integrals stay the same to round-off."""
_ROUND_OFF = 1e-13
"""Of two quadratures with n and 2n places, relative to the largest period; of two steps of Newton's method likewise."""
_POLISHED = 3
"""Steps of Newton's method for zeros of R, from eigenvalues that are right to a few digits at least."""


@explains_its_arguments
def lagrange_lattice(diagram: LagrangeDiagram, values: ArrayLike) -> Array:
    r"""The periods of the flows of H, l3 and P on the torus with given values, by quadrature on the spectral curve.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0.5, "C2": 0.2, "C3": 1}))
        >>> periods = lp.tori.lagrange_lattice(diagram, [3, 0.5, 0.2])
        >>> (periods[0] - periods[1] + periods[2]).round(12).tolist()  # the circle of l3
        [0.0, 6.28318530718, 0.0]

    Args:
        diagram: What `lagrange_diagram` returned for the leaf.
        values: Values of H, l3 and the third integral, shape (3,).

    Returns:
        A basis of the lattice as rows, shape (3, 3), see `PeriodLattice`.  Its errors are round-off; near to a thread,
        round-off divided by the distance.

    Raises:
        OrbitError: the values are not inside of the image, or so near to a critical value, or to one where two zeros of
            R have the same real part, that the quadrature does not converge.
    """
    given = one_value_of(values, diagram.integrals)
    return _by_flows(diagram, given, _integrals(diagram, given, _period))


@explains_its_arguments
def lagrange_actions(diagram: LagrangeDiagram, values: ArrayLike) -> Array:
    r"""The actions $J_j$ that belong to the periods of `lagrange_lattice`, shape (3,), up to constants of the leaf.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> diagram = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0.5, "C2": 0.2, "C3": 1}))
        >>> here, there = (lp.tori.lagrange_actions(diagram, [3, l3, 0.2]) for l3 in (0.5, 0.6))
        >>> (there[0] - there[1] + there[2] - here[0] + here[1] - here[2]).round(12)  # l3 is an action
        np.float64(0.1)

    Args:
        diagram: What `lagrange_diagram` returned for the leaf.
        values: Values of H, l3 and the third integral, shape (3,).

    Raises:
        OrbitError: as for `lagrange_lattice`; or a zero of R lies above or below $\lambda = 0$.
    """
    scaled = diagram.scaled
    # The bracket of scaled fields is that of the top: J has the unit of l
    return _integrals(diagram, one_value_of(values, diagram.integrals), _action)[:, 0] * scaled.unit


def _period(x: Any, rest: Any, height: float) -> Array:
    return 2 * np.pi * np.stack([_quotient(top, rest) for top in (linear.times(x, x), x, np.ones_like(x))], -1)


def _action(x: Any, rest: Any, height: float) -> Array:
    square = height * height - x.imag * x.imag  # b^2 cos^2
    return (square * _quotient(rest, linear.times(linear.times(x, x), x)))[..., None]


def _quotient(top: Any, bottom: Any) -> Array:
    """The real part of a quotient."""
    return (top.real * bottom.real + top.imag * bottom.imag) / (bottom.real**2 + bottom.imag**2)


def _root(real: Array, imaginary: Array) -> Any:
    """The square root whose real part is not negative, of numbers different from zero."""
    large = np.sqrt((elementary.hypot(real, imaginary) + np.abs(real)) / 2)
    small = np.abs(imaginary) / (2 * large)
    right = real >= 0
    return elementary.of_parts(np.where(right, large, small), np.copysign(np.where(right, small, large), imaginary))


def _upper_zeros(sextic: Array) -> Any:
    """The zeros of R in the upper half plane by their real parts, each relative to its own size; None if not found.

    Eigenvalues have errors relative to the largest one; where these are not small Newton's method follows.
    """
    slope = np.polyder(sextic)
    zeros = linear.roots(sextic)
    upper = zeros[zeros.imag > 0]
    for _ in range(_POLISHED):
        value, rate = _at(sextic, upper), _at(slope, upper)
        step = linear.times(value, rate.conj()) / (rate.real**2 + rate.imag**2)
        upper = np.where(np.abs(step) > _ROUND_OFF * np.abs(upper), upper - step, upper)
    if len(upper) != 3 or not (upper.imag > 0).all():
        return None
    return upper[np.argsort(upper.real, kind="stable")]


def _at(polynomial: Any, places: Any) -> Any:
    """Values of a polynomial, by Horner's rule."""
    found = np.zeros_like(places)
    for coefficient in polynomial:
        found = linear.times(found, places) + coefficient
    return found


def _integrals(diagram: LagrangeDiagram, given: Array, integrand: Callable[[Any, Any, float], Any]) -> Array:
    if not diagram.depth(given) > 0:
        raise OrbitError(
            f"values: wanted some inside of the image; {given.tolist()} are not, R has a real zero. See "
            "diagram.boundary(l3)."
        )
    upper = _upper_zeros(diagram.sextic(given))
    if upper is None:
        raise OrbitError(
            f"values: wanted some at which doubles resolve the zeros of R; at {given.tolist()} they are too near to "
            "one another or of too different sizes. Take others."
        )
    last: Array | None = None
    n = _FEWEST
    while n <= _MOST:
        # the integrand is even about the ends of the line: its middle points see one period
        angle = (np.arange(n) + 0.5) * (np.pi / n) - np.pi / 2
        rows = list[Array]()
        for j in range(3):
            height = upper[j].imag * elementary.sin(angle)
            x = elementary.of_parts(np.full(n, upper[j].real), height)
            rest = np.ones(n, dtype=np.complex128)
            for k in range(3):
                if k != j:
                    # off the real line its square is real only where it is positive: the root is continuous
                    side, other = upper[j].real - upper[k].real, upper[k].imag
                    real = side * side - height * height + other * other
                    rest = linear.times(rest, _root(real, 2 * side * height))
            rows.append(integrand(x, rest, float(upper[j].imag)).mean(axis=0))
        found = np.array(rows)
        if last is not None and np.abs(found - last).max() <= _ROUND_OFF * np.abs(found).max():
            return found
        last, n = found, 2 * n
    raise OrbitError(
        f"values: the quadrature at {given.tolist()} does not converge: two zeros of R have nearly the same real "
        "part, of actions one nearly the real part 0, or the values are nearly critical. Change them a little."
    )


def _by_flows(diagram: LagrangeDiagram, given: Array, scaled_periods: Array) -> Array:
    """From times of l3, h and p in units of the leaf to times of H, l3 and the third integral."""
    scaled = diagram.scaled
    unit, first, third = scaled.unit, float(scaled.first), float(scaled.third)
    l3 = float(given[1])
    spin, energy, last = (scaled_periods / np.array([1.0, unit, unit * unit])).T
    spin = spin - first * (1 / third - 1 / first) * l3 * energy
    return np.stack([first * energy, spin, last * (first if scaled.charge else float(scaled.field))], -1)
