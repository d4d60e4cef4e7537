r"""A leaf in coordinates of order one: the states divided by a unit for each field, and all functions of them.

Fields have units of their own: $\ell\cdot\alpha = 10^{-6}$ and $|\alpha|^2 = 1$ with a weak field in H is a top in slow
units, like any other.  Its states are found, compared and moved in coordinates $y_b = x_b/u_b$ with a number $u_b$ for
each field, for which

- the terms of each Casimir are of the order of its value or larger, as large as it where it is a sum of squares;
- the terms of H that move anything are of one order, and not all smaller than an energy that is asked for, if H is a
  polynomial; any other one says nothing;
- the linear part of the bracket is of the order of its constant part, if it has both.

The logarithms of these conditions are linear in those of the units, and the sum of their violations is made least.  The
units are powers of two, so that coordinates change without round-off, and 1 where no two fields differ by more than
`ORDINARY` and none is further than `FAR` from 1 (`ORDINARY`, if there is one field only): systems in ordinary units are
untouched.

A Lie-Poisson bracket proper is homogeneous: x and any multiple of it look alike, so that only ratios to the length of x
itself have a meaning, and the origin is a leaf of its own.  With a constant part the origin is a point like others, and
lengths are compared with 1 + |x|, in the units of the leaf.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.rational_polynomials import powers_of
from liepoisson.errors import LeafError
from liepoisson.inputs.arrays import Array
from liepoisson.leaf.leaf_projection import Equations
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.portable import elementary, linear
from liepoisson.structure.casimir_part import ORDINARY

if TYPE_CHECKING:
    from flint import arb
    from sympy import Expr, Symbol

    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket

FAR = 1024.0
"""A length within this factor of 1 is ordinary; fields whose sizes differ by less than `ORDINARY` are in one unit."""

_IMPOSSIBLE, _LARGE, _BALANCED, _CANCELLED, _UNDETERMINED = 100.0, 4.0, 1.0, 0.05, 1e-3
"""Weights: of terms that are too small for the value, of terms that are larger than the others, of terms that are
smaller, of a value that is small beside its terms, and of sizes about which nothing is known. A small perturbation such
as $10^{-9}q$ is no reason to measure all in its units."""

_ROUNDED = 8 * float(np.finfo(float).eps)
"""A value that is less than this part of its terms, at a state that has it, is what rounding leaves of them."""

_SWEEPS, _CLOSE = 60, 0.1
"""Steps of the least-squares problem, in which violations below the second, of a logarithm, count as none."""

_LONGEST = 300.0
"""Units beyond this power of two are not taken: J in them would leave the doubles."""

_MOST_TERMS = 2000
"""A function with more terms is not looked at."""


@dataclass(frozen=True)
class _Sizes:
    """The terms of a function: their degrees in the fields, shape (class, field), and log2 of their coefficients."""

    degrees: Array
    logarithms: Array
    is_sum_of_squares: bool


def scaling(
    system: System,
    casimirs: Mapping[str, PhaseFunction],
    values: Array,
    energy: float | None = None,
    state: Array | None = None,
) -> Array:
    """A unit for each coordinate, shape (N,): one number for each field.

    Args:
        system: A system whose parameters are all numbers, with no function of the Casimirs in H (`System.moving`).
        casimirs: The functions that are constant on the leaf.
        values: Their values.
        energy: The energy that the states are to have, if any.
        state: A state, whose largest component is the unit where nothing else says how long states are.
    """
    bracket = system.bracket
    groups = unit_groups(bracket)
    n_groups, ones = 1 + max(groups), np.ones(bracket.dimension)
    length = float(np.abs(state).max()) if state is not None and unit_length(bracket) else 0.0
    problem = _Problem(n_groups, length or 1.0)
    for sizes, constant in _blocks(bracket):
        problem.add(sizes, constant, weight=_BALANCED, above=_BALANCED, below=_BALANCED)
    for function, value in zip(casimirs.values(), values.tolist(), strict=True):
        terms = 0.0 if state is None else float(np.abs(state * function.gradient(state)).sum())
        is_rounding = abs(value) <= _ROUNDED * terms
        problem.add(_sizes(function, groups), 0.0 if is_rounding else value, weight=_IMPOSSIBLE)
    problem.add(_sizes(system.functions.energy, groups), energy or 0.0, weight=_BALANCED)
    logarithms = problem.solution()
    if not np.isfinite(logarithms).all() or np.abs(logarithms).max() > _LONGEST:
        return ones
    far = FAR if n_groups > 1 else ORDINARY
    if np.ptp(logarithms) < elementary.log2(ORDINARY) and np.abs(logarithms).max() < elementary.log2(far):
        return ones
    return np.ldexp(1.0, np.round(logarithms).astype(int))[list(groups)]


class _Problem:
    """Rows of a linear problem for the logarithms of the units and one scale for each function."""

    def __init__(self, n_groups: int, length: float) -> None:
        self._n_groups, self._length = n_groups, length
        self._n_functions = 0
        self._rows: list[tuple[Array, int, float, float, float]] = []

    def add(
        self,
        sizes: _Sizes | None,
        value: float,
        *,
        weight: float,
        above: float | None = None,
        below: float = _IMPOSSIBLE,
    ) -> None:
        """A function whose terms are of the order of its scale, which is at least that of the value.

        Args:
            sizes: Its terms; None for a function that says nothing.
            value: Its value.
            weight: What it counts if the only terms are not of the order of the scale.
            above: What it counts if the scale is above the value.
            below: What it counts if the scale is below the value.
        """
        if sizes is None:
            return
        scale, one_class = self._n_functions, len(sizes.degrees) == 1
        self._n_functions += 1
        for degree, logarithm in zip(sizes.degrees, sizes.logarithms, strict=True):
            over, under = (weight, weight) if one_class else (_LARGE, _BALANCED)
            self._rows.append((degree, scale, float(logarithm), over, under))
        if value:
            if above is None:
                above = _IMPOSSIBLE if sizes.is_sum_of_squares else _CANCELLED
            self._rows.append((np.zeros(self._n_groups), scale, float(elementary.log2(abs(value))), below, above))

    def solution(self) -> Array:
        """The logarithms of the units: the weighted sum of absolute violations is made least, by weighted squares."""
        k, m = self._n_groups, self._n_functions
        matrix, right = np.zeros((len(self._rows) + k, k + m)), np.zeros(len(self._rows) + k)
        above, below = (np.full(len(right), _UNDETERMINED) for _ in range(2))
        for row, (degree, scale, constant, over, under) in enumerate(self._rows):
            # a term, or the value, minus the scale
            matrix[row, :k], matrix[row, k + scale] = degree, -1.0
            right[row], above[row], below[row] = -constant, over, under
        matrix[len(self._rows) :, :k], right[len(self._rows) :] = np.eye(k), elementary.log2(self._length)
        x: Array = np.zeros(k + m)
        for _ in range(_SWEEPS):
            excess = linear.matmul(matrix, x) - right
            weights = np.sqrt(np.where(excess > 0, above, below) / np.maximum(np.abs(excess), _CLOSE))
            x = np.asarray(linear.lstsq(weights[:, None] * matrix, weights * right)[0], dtype=np.float64)
        return x[:k]


def _blocks(bracket: Bracket) -> list[tuple[_Sizes, float]]:
    """The linear parts of those blocks {field, field} that have a constant part, with the size of that part."""
    if not bracket.is_linear:
        return []
    groups = unit_groups(bracket)
    constants: dict[tuple[int, int], float] = {}
    for (i, j), c in bracket.constant.items():
        block = (groups[i], groups[j])
        constants[block] = max(constants.get(block, 0.0), abs(float(cast("Any", c))))
    found: list[tuple[_Sizes, float]] = []
    for block, constant in constants.items():
        sizes: dict[int, float] = {}
        for i, j, m, c in bracket.entries():
            if (groups[i], groups[j]) == block:
                sizes[groups[m]] = max(sizes.get(groups[m], 0.0), abs(float(cast("Any", c))))
        if sizes and constant:
            degrees = np.eye(1 + max(groups))[[*sizes]]
            found.append((_Sizes(degrees, elementary.log2([*sizes.values()]), is_sum_of_squares=False), constant))
    return found


@lru_cache(maxsize=256)
def _sizes(function: PhaseFunction, groups: tuple[int, ...]) -> _Sizes | None:
    """The terms of a polynomial; None for any other function, and for too many terms."""
    if function.polynomial is not None:
        terms = powers_of(function.polynomial, len(groups))
        return None if len(function.polynomial.terms) > _MOST_TERMS else _sizes_of_terms(terms, groups)
    from sympy import Add, Poly

    expression: Any = function.expression
    if len(Add.make_args(expression)) > _MOST_TERMS or not expression.is_polynomial(*function.variables):
        return None
    return _sizes_of_terms(cast("Any", Poly(expression, *function.variables)).terms(), groups)


def _degree(monomial: tuple[int, ...], groups: tuple[int, ...]) -> tuple[int, ...]:
    """The degree of a monomial in the coordinates of each group."""
    return tuple(np.bincount(groups, weights=monomial).astype(int).tolist())


def _sizes_of_terms(terms: Iterable[tuple[tuple[int, ...], Any]], groups: tuple[int, ...]) -> _Sizes | None:
    """The terms of a polynomial by their degrees in the fields, each with its largest coefficient."""
    classes: dict[tuple[int, ...], float] = {}
    is_sum_of_squares = True
    for monomial, coefficient in terms:
        degree = _degree(monomial, groups)
        if not any(degree):
            continue
        size = float(coefficient)
        is_sum_of_squares &= size > 0 and all(power % 2 == 0 for power in monomial)
        classes[degree] = max(classes.get(degree, 0.0), abs(size))
    if not classes or not all(0 < size < np.inf for size in classes.values()):
        return None
    return _Sizes(np.array([*classes], dtype=float), elementary.log2([*classes.values()]), is_sum_of_squares)


_MOST = 100
"""Coordinates beyond which the gradings are not looked for."""


@lru_cache(maxsize=64)
def unit_groups(bracket: Bracket) -> tuple[int, ...]:
    r"""Which coordinates are in one unit: a number for each, equal for those that are.

    Those of one field are, unless weights tell them apart with $w_i + w_j = w_m$ whenever $x_m$ occurs in
    $\{x_i, x_j\}$: then $x_i\to s^{w_i}x_i$ keeps the bracket, as for rotations and translations in se(n).  Where the
    bracket is only constant, or not linear, each coordinate has a unit of its own: canonical coordinates are lengths,
    angles and what else one likes.
    """
    n, N = bracket.field_lengths[0], bracket.dimension
    entries = bracket.entries() if bracket.is_linear else ()
    if not entries:
        return tuple(range(N))
    keys = [(i // n, *weights) for i, weights in enumerate(_weights(entries, N))]
    number = {key: k for k, key in enumerate(dict.fromkeys(keys))}
    return tuple(number[key] for key in keys)


def _weights(entries: Iterable[tuple[int, int, int, Any]], n: int) -> list[tuple[Any, ...]]:
    """The weights of each coordinate in a basis of all gradings of the linear part."""
    if n > _MOST:
        return [()] * n
    relations: set[tuple[tuple[int, int], ...]] = set()
    for i, j, m, _ in entries:
        relation = Counter((i, j))
        relation[m] -= 1
        relations.add(tuple(sorted((k, c) for k, c in relation.items() if c)))
    rows = [{k: Fraction(c) for k, c in relation} for relation in sorted(relations)]
    basis = nullspace(rows, n, Coefficients()).vectors
    return [tuple(vector.get(i, 0) for vector in basis) for i in range(n)]


def unit_length(bracket: Bracket) -> float:
    """What is added to the length of a state: 0 where the bracket is linear without a constant part, else 1."""
    return 1.0 if not bracket.is_linear or bracket.constant else 0.0


class FunctionInUnits(PhaseFunction):
    r"""The function $y\mapsto f(uy)$ with $uy = (u_1y_1,\ldots,u_Ny_N)$.

    Args:
        function: f.
        units: u, shape (N,).
    """

    def __init__(self, function: PhaseFunction, units: Array) -> None:
        self._function, self._units = function, units

    @property
    def is_polynomial(self) -> bool:
        """Whether f is a polynomial."""
        return self._function.is_polynomial

    @property
    def n_coordinates(self) -> int:
        """Number of components of a state."""
        return self._function.n_coordinates

    @property
    def variables(self) -> tuple[Symbol, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Those of f itself."""
        return self._function.variables

    @property
    def expression(self) -> Expr:  # pyright: ignore[reportIncompatibleVariableOverride]
        """That of f itself."""
        return self._function.expression

    @property
    def polynomial(self) -> RationalPolynomial | None:
        """That of f itself."""
        return self._function.polynomial

    def as_polynomial(self) -> tuple[PhaseFunction | None, Array | None]:
        """The function f and u, if f is a polynomial of states that have no other units."""
        function, units = self._function.as_polynomial()
        return (function, self._units) if units is None else (None, None)

    def __call__(self, states: ArrayLike) -> Array:
        """Values, shape (...), at y of shape (..., N)."""
        return self._function(np.asarray(states) * self._units)

    def gradient(self, states: ArrayLike) -> Array:
        """Derivatives with respect to y, shape (..., N)."""
        return self._function.gradient(np.asarray(states) * self._units) * self._units

    def gradient_in_balls(self, state: Sequence[arb]) -> list[arb]:
        """Balls that contain the derivatives with respect to y."""
        units = [*map(float, self._units)]
        slopes = self._function.gradient_in_balls([u * y for u, y in zip(units, state, strict=True)])
        return [u * slope for u, slope in zip(units, slopes, strict=True)]

    def value_in_balls(self, state: Sequence[arb]) -> arb:
        """A ball that contains the value."""
        return self._function.value_in_balls([float(u) * y for u, y in zip(self._units, state, strict=True)])

    def hessian(self, states: ArrayLike) -> Array:
        """Second derivatives with respect to y, shape (..., N, N)."""
        return self._function.hessian(np.asarray(states) * self._units) * np.outer(self._units, self._units)


@dataclass(frozen=True)
class FunctionsInUnits:
    """The functions on phase space of a system, as functions of y."""

    system: System
    units: Array

    @cached_property
    def energy(self) -> PhaseFunction:
        """The Hamiltonian."""
        return self.of(self.system.functions.energy)

    def of(self, function: str | Expr | PhaseFunction) -> PhaseFunction:
        """Any function on phase space."""
        return in_units(self.system.functions.of(function), self.units)

    def poisson_tensor(self, states: Array) -> Array:
        r"""The brackets $\{y_i, y_j\}$, shape (..., N, N)."""
        return self.system.functions.poisson_tensor(states * self.units) / np.outer(self.units, self.units)

    def poisson_slopes(self, states: Array) -> Array:
        r"""Their derivatives, [..., m, i, j] along y_m, shape (..., N, N, N)."""
        slopes = self.system.functions.poisson_slopes(states * self.units)
        return slopes * self.units[:, None, None] / np.outer(self.units, self.units)


@dataclass(frozen=True)
class SystemInUnits:
    """What the numerical searches ask of a system, with its functions of y.

    Attributes:
        bracket: That of the system itself.
        functions: The functions of y.
    """

    bracket: Bracket
    functions: FunctionsInUnits


@dataclass(frozen=True)
class LeafInUnits:
    """A leaf with its states divided by units.

    Attributes:
        itself: What the leaf is called in messages.
        source: The system.
        rank: The dimension of the leaf.
        own_state: The state of the leaf, not divided.
        equations_for: The equations of the leaf, of an energy surface on it and of a surface f = 0, not divided.
        units: A positive number for each coordinate, shape (N,); those of one field are equal.
        still_energy: What was taken out of H on this leaf.
    """

    itself: str
    source: System
    rank: int
    own_state: Array
    equations_for: Callable[[float | None, str | Expr | PhaseFunction | None], Equations]
    units: Array
    still_energy: float = 0.0

    @cached_property
    def system(self) -> SystemInUnits:
        """The system in these units."""
        return SystemInUnits(self.source.bracket, FunctionsInUnits(self.source, self.units))

    @cached_property
    def state(self) -> Array:
        """The leaf's own state."""
        return self.own_state / self.units

    @cached_property
    def equations(self) -> Equations:
        """The equations of the leaf."""
        return self.constraints(None)

    def constraints(self, energy: float | None, surface: str | Expr | PhaseFunction | None = None) -> Equations:
        """The equations of the leaf, and those of the energy surface and of a surface f = 0."""
        return equations_in_units(self.equations_for(energy, surface), self.units, self.source.bracket)

    def tangent_basis(self, y: Array) -> Array:
        """Orthonormal bases of the tangent spaces of the leaf, as columns, shape (..., N, rank)."""
        tensor = self.system.functions.poisson_tensor(y)
        if not np.isfinite(tensor).all():
            raise LeafError(
                "the states of this leaf have components beyond the range of numbers, or of very different sizes; "
                "give the Casimirs in other units."
            )
        vectors, sizes, _ = linear.svd(tensor)
        if self.rank and not np.all(sizes[..., self.rank - 1] > 0):
            raise LeafError(f"J must have rank {self.rank} on this leaf; it is lower at one of the states.")
        return vectors[..., : self.rank]

    def __repr__(self) -> str:
        return self.itself


def in_units(function: PhaseFunction, units: Array) -> PhaseFunction:
    """A function of y; the function itself where all units are 1."""
    return function if (units == 1.0).all() else FunctionInUnits(function, units)


def equations_in_units(equations: Equations, units: Array, bracket: Bracket) -> Equations:
    """The same equations for y; they themselves where all units are 1, so that the fields are of one order."""
    if (units == 1.0).all():
        return equations
    rows = linear.qr((equations.pinned * units).T)[0].T
    functions = tuple(in_units(function, units) for function in equations.functions)
    groups, unit = unit_groups(bracket), unit_length(bracket)
    return replace(equations, pinned=rows, functions=functions, groups=groups, unit=unit)
