r"""All equilibria of a polynomial system on a regular leaf, proved to be all, where they are finitely many.

An equilibrium is a zero of $J\nabla H$ at which the Casimirs have the values of the leaf. Where bracket, Hamiltonian
and Casimirs are polynomials with rational coefficients, these equations are a polynomial system over the rationals
(doubles are rational), and `liepoisson.algebra.ideals` finds all of its real solutions. There are no multipliers in
them, so they hold at singular points of the level set, too. A solution at which J has the rank of the leaf lies on a
leaf of this level set; where ball arithmetic does not show this rank, nothing is decided.

Families of equilibria, real or complex, are left to the search.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, arb_mat

from liepoisson.algebra.ideals.certified_roots import ball, precision
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem, polynomial
from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf

LIMITS = Limits(work=3_000_000, degree=150)
"""What the proof may cost: about three seconds. Kirchhoff's equations have degree 30 in general and take one half."""

_MOST_COORDINATES, _MOST_TERMS = 12, 1000
_BITS = 100


@dataclass(frozen=True)
class AllEquilibria:
    """The equilibria of a leaf, all of them.

    Attributes:
        states: The states, rounded to doubles, shape (n, N).
        degree: How many complex solutions the equations have, with multiplicities.
    """

    states: Array
    degree: int


def polynomial_equilibria(leaf: Leaf, limits: Limits = LIMITS) -> AllEquilibria | None:
    """All equilibria on a leaf; None where this is not decided.

    That is so on singular leaves, for equations or Casimirs that are no polynomials with rational coefficients, where
    equilibria come in families, and where the limits are reached.

    Args:
        leaf: The leaf; on a level set of several leaves, such as the sheets of a hyperboloid, all of them are meant.
        limits: What it may cost.
    """
    if not leaf.is_regular or not leaf.place.is_known or len(leaf.state) > _MOST_COORDINATES:
        return None
    try:
        system = _equations(leaf, limits)
        if system is None or system.dimension > 0:
            return None
        points = [s.values for s in system.real_solutions(_BITS)]
    except (NotDecidedError, ParameterError):
        return None
    on_leaf = [_is_on_leaf(leaf, point) for point in points]
    if None in on_leaf:
        return None
    states = [[float(x.mid()) for x in point] for point, is_on in zip(points, on_leaf, strict=True) if is_on]
    return AllEquilibria(np.array(states).reshape(-1, len(leaf.state)), max(system.degree, 0))


def _equations(leaf: Leaf, limits: Limits) -> PolynomialSystem | None:
    """J grad H = 0 and C = c; None if they are too long to be read.

    Raises:
        ParameterError: they are no polynomials with rational coefficients.
    """
    from sympy import Rational

    from liepoisson.formula.arithmetic import expanded_terms

    system = leaf.system
    rates = [rate for rate in system.equations.values() if rate != 0]
    casimirs = {name: function.expression for name, function in leaf.casimir_functions.items()}
    if any(expanded_terms(e) > _MOST_TERMS for e in (*rates, *casimirs.values())):
        return None
    levels: list[Any] = [
        casimir - Rational(*leaf.casimirs[name].as_integer_ratio()) for name, casimir in casimirs.items()
    ]
    return PolynomialSystem.of([*rates, *levels], system.variables, limits=limits)


def _is_on_leaf(leaf: Leaf, point: tuple[arb, ...]) -> bool | None:
    """Whether J has the rank of the leaf at a point, if it has; else None.

    Its rank is at most that of the leaf, which is regular, and it has it if a principal minor of this size is not 0.
    """
    state = np.array([float(x.mid()) for x in point])
    chosen = _principal(np.asarray(leaf.system.functions.poisson_tensor(state)), leaf.rank)
    if chosen is None:
        return None
    tensor: Any = leaf.system.bracket.poisson_tensor()
    context = rational_context([str(v) for v in leaf.system.variables])
    with precision(4 * _BITS):
        minor = [[_value(polynomial(tensor[i, j], context), point) for j in chosen] for i in chosen]
        return None if arb_mat(minor).det().contains(0) else True


def _principal(matrix: Array, rank: int) -> list[int] | None:
    """Rows and columns of a principal part that is far from singular, two by two; None if there is none."""
    left, chosen = matrix.copy(), list[int]()
    for _ in range(rank // 2):
        i, j = (int(k) for k in np.unravel_index(int(np.argmax(np.abs(left))), left.shape))
        if not left[i, j]:
            return None
        chosen += [i, j]
        # what is left of an antisymmetric matrix when a 2 x 2 block is eliminated
        left = left + (np.outer(left[:, i], left[j]) - np.outer(left[:, j], left[i])) / left[i, j]
        left[[i, j]] = 0.0
        left[:, [i, j]] = 0.0
    return sorted(chosen)


def _value(p: Any, point: tuple[arb, ...]) -> arb:
    """A polynomial at balls."""
    total = arb(0)
    for powers, c in p.terms():
        term = ball(c)
        for x, k in zip(point, powers, strict=True):
            for _ in range(int(k)):
                term = term * x
        total += term
    return total
