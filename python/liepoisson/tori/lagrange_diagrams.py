r"""The bifurcation diagram of the twisted Lagrange top on a leaf: all critical values of (H, l3, P), in closed form.

With M and R of `liepoisson.tori.lagrange_leaves` and the flow of $\tfrac12|M(\mu)|^2$,

$$ M' = -\mu^3\,\frac{M(\lambda)\times M(\mu)}{\lambda - \mu} , $$

the rank of $d(\ell_3, h, p)$ on the leaf is three minus the degree of the greatest common divisor of the components of
M (with $dR = 2M\cdot dM$, where dM is any vector polynomial of degree two, and Sylvester's matrix):

- **Image.**  A value is attained if and only if $R \ge 0$ on the real line.  Necessary: $R = |M|^2$.  Sufficient: R is
  $p^2 + q^2$ with p monic of degree 3 and q of degree at most 2, and $M = (q, 0, p)$.
- **Regular fibres** are one torus $T^3$ each.
- **Rank 2**: $M = (\lambda - \mu)N$ with real $\mu$; R has a double root, and the fibre is on the boundary of the
  image.
- **Rank 1**: $M = q(\lambda)(\lambda e_3 + n)$, $q = \lambda^2 + q_1\lambda + q_0$: the relative equilibria.  For
  $c_3 = 1$, with $Q_2 = |\lambda e_3 + n|^2 = \lambda^2 + 2gC\lambda + g^2$, $g = 1/q_0$ and $q_1 = (C_2 - C/g)/g$,

  $$ g^3 - e\,g^2 + C_2\,C g + \tfrac12(1 - 3C^2) = 0, \qquad -1 \le C \le 1, \quad e = (C_1 - C_2^2)/2 . $$

  Where q has real roots the curve is an edge of the boundary, elliptic in two directions; where they are complex it is
  a thread of the interior, focus-focus.  They meet at $q = (\lambda - \mu)^2$, Hamiltonian Hopf points.  Edges go to
  infinity at g = 0.
- **Rank 0**: the sleeping tops $M = Qe_3$, two of them, at $C = \pm1$.

A real root of the divisor is an elliptic direction of frequency $|\mu|^3\sqrt{R(\lambda)/(\lambda - \mu)^2}$ at
$\lambda = \mu$: nothing is hyperbolic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import LeafError, ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_count, as_finite
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind
from liepoisson.leaf.leaf import Leaf
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import elementary, linear
from liepoisson.tori.lagrange_leaves import ScaledLeaf, class_of
from liepoisson.tori.momentum_maps import MomentumMap

if TYPE_CHECKING:
    from liepoisson.model.system import System

_LARGEST = 1e40
"""Values below this have seventh powers within the range of doubles."""
N_POINTS = 200
"""Points of a curve between two special ones."""


@dataclass(frozen=True, eq=False)
class CriticalCurve(ReadOnlyArrays):
    """Values of a family of relative equilibria, where the differentials of the integrals have rank 1.

    Example:
        >>> leaf = lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 8, "C2": 1, "C3": 1})
        >>> curve = lp.tori.lagrange_diagram(leaf).threads[1]
        >>> curve.ends, curve.values.shape
        (('S+', 'S-'), (200, 3))

    Attributes:
        kind: "edge", elliptic in two directions; "thread", focus-focus, with regular values around it.
        ends: "S+" and "S-", the sleeping tops; "HH", Hamiltonian Hopf; "infinity".
        values: H, l3 and the third integral along the curve, shape (point, 3).
        states: A relative equilibrium for each value, shape (point, 9); the others are its turns about the axis.
    """

    kind: str
    ends: tuple[str, str]
    values: Array
    states: Array

    def __repr__(self) -> str:
        return f"<{self.kind} from {self.ends[0]} to {self.ends[1]}: {len(self.values)} values>"


@dataclass(frozen=True, eq=False)
class LagrangeDiagram(SavedWhole):
    r"""The bifurcation diagram of a twisted Lagrange top on a leaf.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> found = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 0.5, "C2": 0.2, "C3": 1}))
        >>> found
        <Diagram of class UU- of 'twisted Lagrange top': 3 edges, 2 threads, 2 Hamiltonian Hopf points>
        >>> found.sleeping_tops["S+"].shape
        (9,)

    Attributes:
        leaf: The leaf.
        integrals: Names of the integrals: H, l3 and P or P'.
        leaf_class: See `leaf_class`.
        curves: Edges and threads.
        sleeping_tops: The two equilibria at which the rank is 0, as states, by the names that ends of curves have.
        hopf_values: Values at which a thread meets an edge, shape (point, 3).
        scaled: The numbers of the leaf.
    """

    kind = "diagram of a twisted Lagrange top"
    made_by = "lp.tori.lagrange_diagram"
    row = "value"

    leaf: Leaf
    integrals: tuple[str, str, str]
    leaf_class: str
    curves: tuple[CriticalCurve, ...]
    sleeping_tops: dict[str, Array]
    hopf_values: Array
    scaled: ScaledLeaf = field(repr=False)

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.leaf.system

    @cached_property
    def momentum(self) -> MomentumMap:
        """The momentum map, in the order of `integrals`."""
        system = self.leaf.system
        return MomentumMap(system, {name: system.functions.of(system.invariants[name]) for name in self.integrals})

    @property
    def edges(self) -> tuple[CriticalCurve, ...]:
        """The curves of the boundary."""
        return tuple(curve for curve in self.curves if curve.kind == "edge")

    @property
    def threads(self) -> tuple[CriticalCurve, ...]:
        """The curves of the interior."""
        return tuple(curve for curve in self.curves if curve.kind == "thread")

    def sextic(self, values: ArrayLike) -> Array:
        r"""The coefficients of R in units of the leaf, from that of $\lambda^6$ = 1 down, shape (..., 7)."""
        return _sextic(*self.scaled.normal, self.scaled.scaled(values_of(values, self.integrals)))

    def depth(self, values: ArrayLike) -> Array:
        r"""The least value of $R/(1 + \lambda^2)^3$ on the real line, shape (...).

        Positive inside of the image, where the fibre is one torus but for the threads; zero on its boundary; negative
        outside.
        """
        sextic = self.sextic(values)
        flat = sextic.reshape(-1, 7)
        return np.array([_depth(row) for row in flat]).reshape(sextic.shape[:-1])

    def boundary(self, l3: float, n_points: int = 2000) -> list[Array]:
        r"""The boundary of the image at one value of l3, as curves of (H, third integral), shape (point, 2).

        Where R has a double root $\mu$ and is not negative.
        """
        spin, unit = as_finite(l3, "l3"), self.scaled.unit
        half = as_count(n_points, "n_points", least=4) // 2
        angle = (np.arange(half) + 0.5) * (np.pi / 2 / half)
        places = np.concatenate([-elementary.tan(angle)[::-1], elementary.tan(angle)])
        c1, c2 = self.scaled.normal
        x, s = places, spin / unit
        # R = R' = 0 at x, linear in h and p: 2 x^4 h + 2 x^3 p = -r, 8 x^3 h + 6 x^2 p = -r'.
        third, fourth = elementary.power(x, 3), elementary.power(x, 4)
        r = (x + 2 * s) * x * fourth + c1 * x * x + 2 * c2 * x + 1
        slope = (6 * x + 10 * s) * fourth + 2 * c1 * x + 2 * c2
        h = (3 * r - x * slope) / (2 * fourth)
        p = (x * slope - 4 * r) / (2 * third)
        scaled = np.stack([np.full_like(x, s), h, p], -1)
        sextic = _sextic(c1, c2, scaled)
        inside = np.array([_is_not_negative(row, at) for row, at in zip(sextic, x, strict=True)])
        values = self.scaled.integrals(scaled)[:, [0, 2]]
        cuts = np.flatnonzero(np.diff(inside.astype(int))) + 1
        parts = [
            part for part in np.split(np.arange(len(x)), sorted({*cuts, half})) if len(part) > 1 and inside[part[0]]
        ]
        return [values[part] for part in parts]

    def __len__(self) -> int:
        """How many critical values it has."""
        return sum(len(one.values) for one in self.curves)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each critical value of rank 1 its curve, the kind of it and the values."""
        lengths = [len(one.values) for one in self.curves]
        rows: dict[str, NDArray[Any]] = {"curve": np.repeat(np.arange(len(self.curves)), lengths)}
        rows["kind"] = np.repeat(np.array([one.kind for one in self.curves]), lengths)
        return rows | dict(zip(self.integrals, np.concatenate([one.values for one in self.curves]).T, strict=True))

    def __repr__(self) -> str:
        return (
            f"<Diagram of class {self.leaf_class} of {self.leaf.system.name!r}: {len(self.edges)} edges, "
            f"{len(self.threads)} threads, {len(self.hopf_values)} Hamiltonian Hopf points>"
        )


@explains_its_arguments
def lagrange_diagram(leaf: Leaf) -> LagrangeDiagram:
    r"""The critical values of (H, l3, P) of the twisted Lagrange top on a leaf, charged or not, in closed form.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> found = lp.tori.lagrange_diagram(lp.Leaf(top, {"C1": 8, "C2": 1, "C3": 1}))
        >>> found.threads
        (<thread from HH to HH: 600 values>, <thread from S+ to S-: 200 values>)

    Args:
        leaf: A leaf with beta not zero.

    Raises:
        ParameterError: the system is no twisted Lagrange top.
        LeafError: beta vanishes on the leaf, or the leaf is on a wall between two classes or too near to it.
    """
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(top, {...})")
    scaled = ScaledLeaf.of(leaf)
    name = class_of(*scaled.casimirs)
    if not all(abs(value) < _LARGEST for value in scaled.normal):
        raise LeafError(
            f"leaf: wanted one with C1 and C2 below {_LARGEST:g} in units where C3 = 1; got {scaled.normal}"
        )
    curve = _Curve(*scaled.normal)
    curves = [_critical_curve(curve, chain, scaled) for chain in curve.chains()]
    hopf = [point for point in curve.special if point.name == "HH"]
    found = len(curves), len(hopf)
    if found != _COUNTS[name]:
        raise LeafError(
            f"leaf: wanted one away from the walls; this one is of class {name}, but so near to another class, or its "
            f"numbers so large, that doubles find {found[0]} edges and threads and {found[1]} Hamiltonian Hopf points, "
            f"where there are {_COUNTS[name][0]} and {_COUNTS[name][1]}. Change C1 or C2."
        )
    third = "P'" if scaled.charge else "P"
    return LagrangeDiagram(
        leaf,
        ("H", "l3", third),
        name,
        tuple(sorted(curves, key=lambda one: (one.kind, one.ends))),
        {name: scaled.states(curve.sleeping(sign)) for name, sign in (("S+", 1), ("S-", -1))},
        scaled.integrals(np.array([curve.values(np.array(p.g), np.array(p.c)) for p in hopf]).reshape(-1, 3)),
        scaled,
    )


_COUNTS = {"AA": (5, 0), "AU": (5, 1), "UU-": (5, 2), "UU+": (5, 2), "BU": (7, 3), "AB": (7, 2)}
"""Edges and threads, and Hamiltonian Hopf points, of each class."""


class _Special(NamedTuple):
    name: str
    g: float
    c: float


@dataclass(frozen=True)
class _Arc:
    """A piece of the curve over an interval of g, on one of the two branches of C; its ends are told by `nodes`."""

    kind: str
    sign: int
    ends: tuple[float, float]
    nodes: tuple[Any, Any]


class _Curve:
    """The curve of rank 1 in the plane of g and C, where it is of degree two in C, in units of the leaf."""

    def __init__(self, c1: float, c2: float) -> None:
        self.c1, self.c2 = c1, c2
        self.e = (c1 - c2 * c2) / 2
        self.special = [*self._ends(), *self._hopf(), *(_Special("infinity", 0.0, s / 3**0.5) for s in (1, -1))]

    def _ends(self) -> Iterator[_Special]:
        for name, sign in (("S+", 1), ("S-", -1)):
            for g in _real_roots([1, -self.e, sign * self.c2, -1]):
                yield _Special(name, g, float(sign))

    def _hopf(self) -> Iterator[_Special]:
        for mu in _real_roots([1, 0, 0, 0, -self.c1, -8 * self.c2, -10]):
            cosine = (self.c2 + 2 / mu) / (mu * mu)
            if abs(cosine) <= 1:
                yield _Special("HH", 1 / (mu * mu), cosine)

    def cosine(self, g: Array, sign: int) -> Array:
        return (self.c2 * g + sign * np.sqrt(np.maximum(self._square(g), 0))) / 3

    def _square(self, g: Any) -> Any:
        return (self.c2 * self.c2 + 6 * (g - self.e)) * g * g + 3

    def chains(self) -> list[list[tuple[_Arc, bool]]]:
        """Arcs that follow one another from a special point to another, each with whether g grows along it."""
        arcs = self._arcs()
        at: dict[Any, list[_Arc]] = {}
        for arc in arcs:
            for node in arc.nodes:
                at.setdefault(node, []).append(arc)
        left, found = set(arcs), list[list[tuple[_Arc, bool]]]()
        for first in arcs:
            for node in first.nodes:
                if first not in left or not isinstance(node, _Special):
                    continue
                chain, here, arc = [], node, first
                while True:
                    left.discard(arc)
                    grows = arc.nodes[0] == here
                    chain.append((arc, grows))
                    here = arc.nodes[1 if grows else 0]
                    following = [one for one in at[here] if one in left]
                    if isinstance(here, _Special) or not following:
                        break
                    arc = following[0]
                found.append(chain)
        return found

    def _arcs(self) -> list[_Arc]:
        turns = _real_roots([6, self.c2 * self.c2 - 6 * self.e, 0, 3])
        places = sorted({*turns, *(point.g for point in self.special)})
        named = {(p.g, min((1, -1), key=lambda s: abs(self.cosine(np.array(p.g), s) - p.c))): p for p in self.special}
        arcs = list[_Arc]()
        for low, high in pairwise(places):
            middle = (low + high) / 2
            for sign in (1, -1):
                cosine = float(self.cosine(np.array(middle), sign))
                if self._square(middle) <= 0 or abs(cosine) >= 1:
                    continue
                twice = self.c2 - cosine / middle
                kind = "thread" if twice * twice < 4 * middle else "edge"
                nodes = [(g, 0) if g in turns else named.get((g, sign), (g, sign)) for g in (low, high)]
                arcs.append(_Arc(kind, sign, (low, high), (nodes[0], nodes[1])))
        return arcs

    def points(self, arc: _Arc, *, grows: bool) -> tuple[Array, Array]:
        """Places g and C along an arc, without those at infinity, denser towards its ends."""
        low, high = arc.ends
        share = (1 - elementary.cos(np.pi * (np.arange(N_POINTS) + 0.0) / (N_POINTS - 1))) / 2
        if 0.0 in arc.ends:
            share = (np.arange(N_POINTS) + 1) / N_POINTS if low == 0.0 else (np.arange(N_POINTS) + 0.0) / N_POINTS
        g = low + (high - low) * share
        c = np.clip(self.cosine(g, arc.sign), -1, 1)
        return (g, c) if grows else (g[::-1], c[::-1])

    def values(self, g: Array, c: Array) -> Array:
        """l3, h, p: half of the coefficients of the fifth to the third power in q^2 Q2."""
        q0, q1 = 1 / g, (self.c2 - c / g) / g
        square = q1 * q1 + 2 * q0
        l3 = q1 + g * c
        h = (square + 4 * q1 * g * c + g * g) / 2
        p = q0 * q1 + square * g * c + q1 * g * g
        return np.stack([l3, h, p], -1)

    def states(self, g: Array, c: Array) -> Array:
        """l, A and B of M = q (lambda e3 + n), shape (..., 3, 3)."""
        q0, q1 = 1 / g, (self.c2 - c / g) / g
        n = np.stack([np.abs(g) * np.sqrt(1 - c * c), np.zeros_like(g), g * c], -1)
        axis = np.array([0.0, 0.0, 1.0])
        return np.stack([n + q1[..., None] * axis, q1[..., None] * n + q0[..., None] * axis, q0[..., None] * n], -2)

    def sleeping(self, sign: int) -> Array:
        """l, A and B of a sleeping top: Q(lambda) = lambda^3 + sign e lambda^2 + c2 sign lambda + sign."""
        found = np.zeros((3, 3))
        found[:, 2] = sign * np.array([self.e, self.c2, 1.0])
        return found


def _critical_curve(curve: _Curve, chain: list[tuple[_Arc, bool]], scaled: ScaledLeaf) -> CriticalCurve:
    parts = [curve.points(arc, grows=grows) for arc, grows in chain]
    g, c = (np.concatenate(each) for each in zip(*parts, strict=True))
    (first, begins), (last, goes_on) = chain[0], chain[-1]
    ends = [first.nodes[0 if begins else 1], last.nodes[1 if goes_on else 0]]
    names = tuple(end.name if isinstance(end, _Special) else "turn" for end in ends)
    # One kind along the chain; where special points differ by round-off an arc is too short to tell it
    widest = max((arc for arc, _ in chain), key=lambda arc: arc.ends[1] - arc.ends[0])
    return CriticalCurve(
        widest.kind,
        (names[0], names[1]),
        scaled.integrals(curve.values(g, c)),
        scaled.states(curve.states(g, c)),
    )


def _real_roots(coefficients: Sequence[float]) -> list[float]:
    """The roots of a real polynomial whose imaginary part is round-off; 0 is none, but for round-off, and left out."""
    roots = [root for root in linear.roots(coefficients) if abs(root) > 1 / _LARGEST]
    return [float(root.real) for root in roots if abs(root.imag) <= 1e-9 * abs(root)]


def values_of(given: ArrayLike, names: Sequence[str], what: str = "values") -> Array:
    """Values of the three integrals, in order, shape (..., 3)."""
    values = as_array(given, what, names)
    if values.shape[-1:] != (3,):
        raise ShapeError(f"{what}: wanted H, l3 and the third integral, shape (..., 3); got shape {values.shape}.")
    if not (np.abs(values) < _LARGEST).all():
        raise ParameterError(f"{what}: wanted finite ones below {_LARGEST:g}, whose powers are numbers")
    return values


def one_value_of(given: ArrayLike, names: Sequence[str], what: str = "values") -> Array:
    """Values of the three integrals at one place, shape (3,)."""
    values = values_of(given, names, what)
    if values.shape != (3,):
        raise ShapeError(f"{what}: wanted H, l3 and the third integral, shape (3,); got shape {values.shape}")
    return values


def _sextic(c1: float, c2: float, scaled: Array) -> Array:
    l3, h, p = np.moveaxis(scaled, -1, 0)
    one = np.ones_like(l3)
    return np.stack([one, 2 * l3, 2 * h, 2 * p, c1 * one, 2 * c2 * one, one], -1)


def _depth(sextic: Array) -> float:
    r"""The least value of $R/(1 + \lambda^2)^3$: at infinity, 1, or where $R'(1 + \lambda^2) = 6\lambda R$."""
    slope = np.asarray(
        np.polymul(np.polyder(sextic), [1.0, 0.0, 1.0]) - np.polymul([6.0, 0.0], sextic), dtype=np.float64
    )
    places = [root.real for root in linear.roots(slope) if abs(root.imag) <= 1e-6 * (1 + abs(root))]
    return min([1.0, *(float(np.polyval(sextic, x) / elementary.power(1 + x * x, 3)) for x in places)])


def _is_not_negative(sextic: Array, double: float) -> bool:
    """Whether a sextic with a double real root is nowhere negative: by its other factor."""
    quartic = np.asarray(np.polydiv(sextic, [1.0, -2 * double, double * double])[0], dtype=np.float64)
    slope = np.asarray(np.polyder(quartic), dtype=np.float64)
    places = [root.real for root in linear.roots(slope) if abs(root.imag) <= 1e-9 * (1 + abs(root))]
    return all(float(np.polyval(quartic, x)) >= 0 for x in places)
