r"""Units of the fields on a leaf, in which its states are of order one.

Fields have units of their own: $\ell\cdot\alpha = 10^{-6}$ and $|\alpha|^2 = 1$ with a weak field in H is a top in slow
units, like any other.  Its states are found, compared and moved in coordinates $y_b = x_b/u_b$ with a number $u_b$ for
each field, for which

- the terms of each Casimir are of the order of its value or larger, as large as it where it is a sum of squares;
- the terms of H are of one order, and not all smaller than an energy that is asked for, nor than a function in it that
  is no polynomial, such as a sine; the argument of such a function is of order one, and a sum of which a root is taken
  of that of its constant;
- the linear part of the bracket is of the order of its constant part, if it has both.

The logarithms of these conditions are linear in those of the units, and the sum of their violations is made least.  The
units are powers of two, so that coordinates change without round-off, and 1 where no two fields differ by more than
`ORDINARY` and none is further than `FAR` from 1 (`ORDINARY`, if there is one field only): systems in ordinary units are
untouched.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.algebra.rational_polynomials import RationalPolynomial, powers_of
from liepoisson.inputs.arrays import Array
from liepoisson.leaf.lengths import unit_groups
from liepoisson.portable import elementary, linear
from liepoisson.streams import generator

if TYPE_CHECKING:
    from sympy import Symbol

    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket

ORDINARY, FAR = 16.0, 1024.0
"""Fields whose sizes differ by less than the first are in one unit; a length within the second of 1 is ordinary."""

_IMPOSSIBLE, _LARGE, _BALANCED, _CANCELLED, _UNDETERMINED = 100.0, 4.0, 1.0, 0.05, 1e-3
"""Weights: of terms that are too small for the value, of terms that are larger than the others, of terms that are
smaller, of a value that is small beside its terms, and of sizes about which nothing is known. A small perturbation such
as $10^{-9}q$ is no reason to measure all in its units."""

_SWEEPS, _CLOSE = 60, 0.1
"""Steps of the least-squares problem, in which violations below the second, of a logarithm, count as none."""

_LONGEST = 300.0
"""Units beyond this power of two are not taken: J in them would leave the doubles."""

_MOST_TERMS = 2000
"""A function with more terms is not looked at."""

_STILL = 1e-10
"""A vector field is zero if it is below this fraction of the sizes of its factors, at a random state."""


@dataclass(frozen=True)
class _Sizes:
    """The terms of a function: their degrees in the fields, shape (class, field), and log2 of their coefficients."""

    degrees: Array
    logarithms: Array
    is_sum_of_squares: bool


def field_units(
    system: System,
    casimirs: Mapping[str, PhaseFunction],
    values: Array,
    energy: float | None = None,
    state: Array | None = None,
) -> Array:
    """A unit for each coordinate, shape (N,): one number for each field.

    Args:
        system: A system whose parameters are all numbers.
        casimirs: The functions that are constant on the leaf.
        values: Their values.
        energy: The energy that the states are to have, if any.
        state: A state, whose largest component is the unit where nothing else says how long states are.
    """
    bracket = system.bracket
    groups = unit_groups(bracket)
    n_groups, ones = 1 + max(groups), np.ones(bracket.dimension)
    length = float(np.abs(state).max()) if state is not None and bracket.constant else 0.0
    problem = _Problem(n_groups, length or 1.0)
    for sizes, constant in _blocks(bracket):
        problem.add(sizes, constant, weight=_BALANCED, above=_BALANCED, below=_BALANCED)
    for function, value in zip(casimirs.values(), values.tolist(), strict=True):
        problem.add(_sizes(function, groups), value, weight=_IMPOSSIBLE)
    own = _sizes(system.functions.energy, groups)
    others = _other_terms(system.functions.energy, groups)
    problem.add(_moving(system, own, casimirs), energy or 0.0, weight=_BALANCED, others=others)
    for sizes, constant in _arguments(system.functions.energy, groups):
        problem.add(sizes, constant, weight=_BALANCED, above=_BALANCED, below=_BALANCED)
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
        others: _Sizes | None = None,
    ) -> None:
        """A function whose terms are of the order of its scale, which is at least that of the value.

        Args:
            sizes: Its terms; None for a function that says nothing.
            value: Its value.
            weight: What it counts if the only terms are not of the order of the scale.
            above: What it counts if the scale is above the value.
            below: What it counts if the scale is below the value.
            others: Its terms that are no polynomials, whose arguments are of order one: the scale is not below them.
        """
        if sizes is None:
            return
        scale, one_class = self._n_functions, len(sizes.degrees) == 1 and others is None
        self._n_functions += 1
        if others is not None:
            for degree, logarithm in zip(others.degrees, others.logarithms, strict=True):
                self._rows.append((degree, scale, float(logarithm), _IMPOSSIBLE, _BALANCED))
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
    """The terms of a function that are polynomials; None where there are none, or too many."""
    if function.polynomial is not None:
        terms = powers_of(function.polynomial, len(groups))
        return None if len(function.polynomial.terms) > _MOST_TERMS else _sizes_of_terms(terms, groups)
    polynomial = _polynomial_part(function.expression, function.variables)
    return None if polynomial is None else _sizes_of_terms(_terms(polynomial, function.variables), groups)


def _terms(polynomial: Any, variables: tuple[Symbol, ...]) -> list[tuple[tuple[int, ...], Any]]:
    """The terms of a SymPy polynomial: powers and coefficients."""
    from sympy import Poly

    return cast("Any", Poly(polynomial, *variables)).terms()


def _polynomial_part(expression: Any, variables: tuple[Symbol, ...]) -> Any:
    """The terms of an expression that are polynomials; None for too many."""
    from sympy import Add

    if len(terms := Add.make_args(expression)) > _MOST_TERMS:
        return None
    if expression.is_polynomial(*variables):
        return expression
    return Add(*(term for term in terms if term.is_polynomial(*variables)))


def _degree(monomial: tuple[int, ...], groups: tuple[int, ...]) -> tuple[int, ...]:
    """The degree of a monomial in the coordinates of each group."""
    return tuple(np.bincount(groups, weights=monomial).astype(int).tolist())


def _sizes_of_terms(
    terms: Iterable[tuple[tuple[int, ...], Any]], groups: tuple[int, ...], *, with_constant: bool = False
) -> _Sizes | None:
    """The terms of a polynomial by their degrees in the fields, each with its largest coefficient."""
    classes: dict[tuple[int, ...], float] = {}
    is_sum_of_squares = True
    for monomial, coefficient in terms:
        degree = _degree(monomial, groups)
        if not any(degree) and not with_constant:
            continue
        size = float(coefficient)
        is_sum_of_squares &= size > 0 and all(power % 2 == 0 for power in monomial)
        classes[degree] = max(classes.get(degree, 0.0), abs(size))
    if not classes or not all(0 < size < np.inf for size in classes.values()):
        return None
    return _Sizes(np.array([*classes], dtype=float), elementary.log2([*classes.values()]), is_sum_of_squares)


@lru_cache(maxsize=256)
def _arguments(function: PhaseFunction, groups: tuple[int, ...]) -> tuple[tuple[_Sizes, float], ...]:
    """The polynomials inside of what is no polynomial, with the size that they are to have."""
    if function.polynomial is not None:
        return ()
    from sympy import Add, Pow, preorder_traversal

    variables = function.variables
    found: dict[Any, float] = {}
    for term in Add.make_args(function.expression):
        if term.is_polynomial(*variables) or len(found) > _MOST_TERMS:
            continue
        for node in cast("Iterable[Any]", preorder_traversal(term)):
            if not node.args or node.is_Add or node.is_Mul or node.is_polynomial(*variables):
                continue
            base: Any = node.base if isinstance(node, Pow) and not node.exp.has(*variables) else None
            parts: tuple[Any, ...] = (base,) if base is not None else node.args
            for part in parts:
                if part.has(*variables) and part.is_polynomial(*variables):
                    constant = part.expand().as_independent(*variables, as_Add=True)[0] if base is not None else 1
                    found[part] = abs(float(constant))
    sizes = [(_sizes_of_terms(_terms(part.expand(), variables), groups), constant) for part, constant in found.items()]
    return tuple((one, constant) for one, constant in sizes if one is not None)


@lru_cache(maxsize=256)
def _other_terms(function: PhaseFunction, groups: tuple[int, ...]) -> _Sizes | None:
    """The terms that are no polynomials: the degrees and the coefficients of their polynomial factors."""
    if function.polynomial is not None:
        return None
    from sympy import Add, Mul

    variables = function.variables
    classes: dict[tuple[int, ...], float] = {}
    for term in Add.make_args(function.expression):
        if term.is_polynomial(*variables):
            continue
        factors = [factor for factor in Mul.make_args(term) if factor.is_polynomial(*variables)]
        sizes = _sizes_of_terms(_terms(Mul(*factors).expand(), variables), groups, with_constant=True)
        if sizes is not None:
            for degree, logarithm in zip(sizes.degrees, sizes.logarithms, strict=True):
                key = tuple(degree.astype(int).tolist())
                classes[key] = max(classes.get(key, -np.inf), float(logarithm))
    if not classes or len(classes) > _MOST_TERMS:
        return None
    return _Sizes(np.array([*classes], dtype=float), np.array([*classes.values()]), is_sum_of_squares=False)


def _moving(system: System, sizes: _Sizes | None, casimirs: Mapping[str, PhaseFunction]) -> _Sizes | None:
    """The terms of H without those that move nothing, as a multiple of a Casimir."""
    groups = unit_groups(system.bracket)
    constant = [_sizes(function, groups) for function in casimirs.values()]
    degrees = {tuple(row) for one in constant if one is not None for row in one.degrees.tolist()}
    if sizes is None or not degrees & {tuple(row) for row in sizes.degrees.tolist()}:
        return sizes
    kept = [tuple(row) not in degrees or _moves(system, row) for row in sizes.degrees.tolist()]
    return replace(sizes, degrees=sizes.degrees[kept], logarithms=sizes.logarithms[kept]) if any(kept) else None


def _part(system: System, degree: list[float], groups: tuple[int, ...]) -> PhaseFunction:
    """The terms of H of these degrees in the fields."""
    polynomial = system.polynomial_hamiltonian
    if polynomial is not None:
        own = {p: c for p, c in powers_of(polynomial, len(groups)) if list(_degree(p, groups)) == degree}
        return system.functions.of_polynomial(RationalPolynomial.of_powers(own))
    from sympy import Poly

    x = system.variables
    terms = _terms(_polynomial_part(system.hamiltonian, x), x)
    own = [(m, c) for m, c in terms if list(_degree(m, groups)) == degree]
    return system.functions.of(cast("Any", Poly(dict(own), *x)).as_expr())


def _moves(system: System, degree: list[float]) -> bool:
    """Whether the terms of H of these degrees in the fields have a vector field."""
    groups = unit_groups(system.bracket)
    state = generator(0).standard_normal(len(groups))
    slope, poisson = _part(system, degree, groups).gradient(state), system.functions.poisson_tensor(state)
    return bool(linear.norm(linear.matmul(poisson, slope)) > _STILL * linear.norm(poisson) * linear.norm(slope))
