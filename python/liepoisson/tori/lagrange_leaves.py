r"""The twisted Lagrange top in its scaled form, and the six classes of its leaves.

With $s = a_3I_1$, $u = \epsilon s^2$, $A = s\,(\alpha + (b_3/a_3)\beta)$ and $B = u\beta$ let

$$ M(\lambda) = \lambda^3e_3 + \lambda^2\ell + \lambda A + B,\qquad
   R = M\cdot M = \lambda^6 + 2\ell_3\lambda^5 + 2h\lambda^4 + 2p\lambda^3 + c_1\lambda^2 + 2c_2\lambda + c_3 . $$

The flows of $\ell_3$, h and p commute, $c_1, c_2, c_3$ are Casimirs, and $H = h/I_1 + (1/I_3 - 1/I_1)\ell_3^2/2$ but
for a constant.  The unit $c_3^{1/6}$ of $\lambda$ makes $c_3 = 1$.  A leaf then has two numbers, $C_1$ and $C_2$, and
$\lambda \to -\lambda$ changes the sign of $C_2$.

On each leaf there are two sleeping tops, $M = Qe_3$ with $Q = \lambda^3 + e\lambda^2 \pm C_2\lambda + 1$ up to the sign
of $\lambda$, $e = (C_1 - C_2^2)/2$.  Each is one of

- U: one real root, unstable;
- A: three real roots of both signs, stable;
- B: three real roots of one sign, stable.

Their two letters name the class, with the side of $C_1 = 3 + \tfrac43C_2^2$ for UU, where two threads of the diagram
exchange their ends.  All is decided exactly in the numbers of the leaf.

Reference: the spectral curve is that of [musso2005].
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.algebra.exact_numbers import as_float, is_zero
from liepoisson.errors import LeafError, ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind
from liepoisson.leaf.leaf import Leaf
from liepoisson.portable import elementary

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.model.top_parameters import TopParameters

CLASSES = ("AA", "AU", "UU-", "UU+", "BU", "AB")


@dataclass(frozen=True)
class ScaledLeaf:
    r"""The numbers of a twisted Lagrange top on a leaf.

    Attributes:
        first: The moment $I_1 = I_2$.
        third: The moment $I_3$.
        field: $s = a_3I_1$.
        twist: $u = \epsilon s^2$.
        charge: $b_3/a_3$.
        casimirs: $c_1, c_2, c_3$.
        rest: What the Hamiltonian has beside that of the top, a constant or Casimirs: a number on the leaf.
    """

    first: Fraction
    third: Fraction
    field: Fraction
    twist: Fraction
    charge: Fraction
    casimirs: tuple[Fraction, Fraction, Fraction]
    rest: float

    @classmethod
    def of(cls, leaf: Leaf) -> ScaledLeaf:
        """Read from a leaf.

        Raises:
            ParameterError: the system is no twisted Lagrange top.
            LeafError: beta vanishes on the leaf.
        """
        top = lagrange_top(leaf.system)
        if not leaf.is_regular:
            raise LeafError(
                f"leaf: wanted one with beta != 0, of dimension 6; got {leaf!r}. There the top is an ordinary one: "
                "take Top.lagrange."
            )
        first, third, a3, b3, epsilon = (
            v if isinstance(v, Fraction) else Fraction(as_float(v, "parameter"))
            for v in (top.inertia[0], top.inertia[2], top.a[2], top.b[2], top.epsilon)
        )
        one, two, three = (Fraction(leaf.casimirs[name]) for name in ("C1", "C2", "C3"))
        ratio, s = b3 / a3, a3 * first
        one, two = one + 2 * ratio * two + ratio**2 * three, two + ratio * three
        u = epsilon * s**2
        return cls(first, third, s, u, ratio, (s**2 * one, s * u * two, u**2 * three), _rest(leaf, top))

    @property
    def unit(self) -> float:
        r"""The unit $c_3^{1/6}$ of $\lambda$ and of $\ell$."""
        return float(elementary.power(float(self.casimirs[2]), 1 / 6))

    @property
    def normal(self) -> tuple[float, float]:
        """$C_1 = c_1/c_3^{2/3}$ and $C_2 = c_2/c_3^{5/6}$."""
        unit, (one, two, _) = self.unit, self.casimirs
        return float(one) / elementary.power(unit, 4), float(two) / elementary.power(unit, 5)

    def integrals(self, scaled: Array) -> Array:
        """Values of H, l3 and the third integral from those of l3, h, p in units of the leaf, shape (..., 3)."""
        unit, first, third = self.unit, float(self.first), float(self.third)
        powers = np.array([unit, unit * unit, elementary.power(unit, 3)])
        l3, h, p = np.moveaxis(scaled, -1, 0) * powers[(...,) + (None,) * (scaled.ndim - 1)]
        energy = h / first + (1 / third - 1 / first) * l3 * l3 / 2 + self.rest
        return np.stack([energy, l3, p / (first if self.charge else float(self.field))], -1)

    def scaled(self, values: Array) -> Array:
        """l3, h and p in units of the leaf from values of H, l3 and the third integral, shape (..., 3)."""
        unit, first, third = self.unit, float(self.first), float(self.third)
        energy, l3, third_value = np.moveaxis(values, -1, 0)
        h = first * (energy - self.rest - (1 / third - 1 / first) * l3 * l3 / 2)
        p = third_value * (first if self.charge else float(self.field))
        return np.stack([l3 / unit, h / (unit * unit), p / elementary.power(unit, 3)], -1)

    def states(self, scaled: Array) -> Array:
        """States of the top from l, A and B in units of the leaf, shape (..., 3, 3), as shape (..., 9)."""
        unit = self.unit
        beta = scaled[..., 2, :] * elementary.power(unit, 3) / float(self.twist)
        alpha = scaled[..., 1, :] * (unit * unit) / float(self.field) - float(self.charge) * beta
        return np.concatenate([scaled[..., 0, :] * unit, alpha, beta], -1)


@explains_its_arguments
def leaf_class(leaf: Leaf) -> str:
    r"""The class of a leaf of the twisted Lagrange top: "AA", "AU", "UU-", "UU+", "BU" or "AB".

    The letters are those of the two sleeping tops: U unstable; A stable, with roots of both signs; B stable, with roots
    of one sign, see `liepoisson.tori.lagrange_leaves`.  Leaves of one class have bifurcation diagrams of one kind.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> [lp.tori.leaf_class(lp.Leaf(top, {"C1": c1, "C2": c2, "C3": 1})) for c1, c2 in ((-5, 0), (0, 0.2), (8, 1))]
        ['AA', 'UU-', 'UU+']

    Args:
        leaf: A leaf with beta not zero.  Its Casimirs are taken as they are, exactly.

    Raises:
        ParameterError: the system is no twisted Lagrange top, charged or not.
        LeafError: the leaf is on a wall between two classes, or beta vanishes.
    """
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(top, {...})")
    return class_of(*ScaledLeaf.of(leaf).casimirs)


def class_of(c1: Fraction, c2: Fraction, c3: Fraction) -> str:
    r"""The class of a leaf by its scaled Casimirs.

    With $\alpha = (c_1 - c_2^2/c_3)/2c_3$, $\beta = c_2/c_3$ and $w = \pm\sqrt{c_3}$ the sleeping tops have $Q =
    \lambda^3 + \alpha w\lambda^2 + \beta w\lambda + w$, with the discriminant $c_3(\alpha^2\beta^2c_3 - 4\alpha^3c_3 -
    27 + (18\alpha\beta - 4\beta^3)w)$.

    Raises:
        LeafError: the leaf is on a wall.
    """
    alpha, beta = (c1 - c2**2 / c3) / (2 * c3), c2 / c3
    whole = alpha**2 * beta**2 * c3 - 4 * alpha**3 * c3 - 27
    letters = []
    for sign in (1, -1):
        discriminant = _sign(whole, sign * (18 * alpha * beta - 4 * beta**3), c3)
        if discriminant == 0:
            raise LeafError(
                "leaf: wanted one inside of a class; this one is on a wall, where a sleeping top changes its "
                "stability. Change C1 or C2."
            )
        is_of_one_sign = alpha > 0 and sign * beta > 0
        letters.append("U" if discriminant < 0 else "B" if is_of_one_sign else "A")
    name = "".join(sorted(letters))
    if name != "UU":
        return name
    height = c1 * c3 - Fraction(4, 3) * c2**2
    above = height**3 - 27 * c3**5 if height > 0 else Fraction(-1)
    if above == 0:
        raise LeafError(
            "leaf: wanted one inside of a class; this one is on the wall C1 = 3 + 4 C2^2/3, where two threads exchange "
            "their ends. Change C1 or C2."
        )
    return name + ("+" if above > 0 else "-")


def _sign(whole: Fraction, part: Fraction, square: Fraction) -> int:
    """The sign of whole + part sqrt(square)."""
    one, other = (whole > 0) - (whole < 0), (part > 0) - (part < 0)
    if one * other >= 0:
        return one or other
    difference = whole**2 - part**2 * square
    return one * ((difference > 0) - (difference < 0))


def _rest(leaf: Leaf, top: TopParameters) -> float:
    """The Hamiltonian less that of the top, which commutes with all, on a leaf."""
    from sympy import expand

    l1, l2, l3, _, _, alpha3, _, _, beta3 = leaf.system.variables
    kinetic = (l1**2 + l2**2) / top.inertia[0] + l3**2 / top.inertia[2]
    difference = expand(leaf.system.hamiltonian - kinetic / 2 - top.a[2] * alpha3 - top.b[2] * beta3)
    return float(leaf.system.functions.of(difference)(leaf.state))


def is_twisted_lagrange(system: System) -> bool:
    """Whether `lagrange_top` accepts a system."""
    try:
        lagrange_top(system)
    except ParameterError:
        return False
    return True


def lagrange_top(system: System) -> TopParameters:
    """The parameters of a twisted Lagrange top, charged or not.

    Raises:
        ParameterError: it is none.
    """
    top = system.top_parameters if len(system.variables) == 9 else None
    if top is None or top.symbols:
        raise ParameterError(
            f"system: wanted a top of nine variables with numbers for parameters; got {system.name!r}. Take "
            "Top.twisted_lagrange."
        )
    is_symmetric = is_zero(top.inertia[0] - top.inertia[1])
    if not is_symmetric or not all(is_zero(v) for v in (*top.a[:2], *top.b[:2])):
        raise ParameterError(
            f"system: wanted I1 = I2 and a, b along the third axis; got inertia {tuple(map(str, top.inertia))}, a = "
            f"{tuple(map(str, top.a))}, b = {tuple(map(str, top.b))}. Take Top.twisted_lagrange."
        )
    if is_zero(top.a[2]) or is_zero(top.epsilon):
        raise ParameterError(
            f"system: wanted a3 and epsilon different from zero; got a3 = {top.a[2]}, epsilon = {top.epsilon}. Without "
            "them the top is free or an ordinary Lagrange top."
        )
    return top
