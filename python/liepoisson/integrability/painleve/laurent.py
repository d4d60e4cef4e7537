r"""Laurent and Puiseux series of solutions around a singularity, to double precision.

The exact series goes up to the largest exponent; beyond it the equations $(k - K)\,c^{(k)} = R^{(k)}$ have one solution
for each order.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, cast

import numpy as np
from flint import acb, fmpq
from numpy.typing import NDArray

from liepoisson.algebra.function_fields import AlgebraicFunctions, AlgebraicNumbers, FunctionField
from liepoisson.algebra.ideals.coordinate_ring import CoordinateRing, RingElement
from liepoisson.algebra.ideals.groebner import groebner_basis
from liepoisson.algebra.ideals.limits import Limits
from liepoisson.algebra.ideals.solutions import solutions
from liepoisson.algebra.number_fields import Element, NumberField, as_fmpq
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.painleve.expansion import Expansion
from liepoisson.integrability.painleve.quasi_homogeneous import LocalField


@dataclass(frozen=True)
class LaurentSeries:
    r"""A solution near a singularity at $\tau = 0$, $x_i = \tau^{-g_i}\sum_j c_{ij}\,\tau^{j/q}$.

    Attributes:
        weights: The orders $g_i$.
        denominator: q; 1 for a Laurent series.
        coefficients: c, shape (component, order), complex.
    """

    weights: tuple[Fraction, ...]
    denominator: int
    coefficients: NDArray[np.complex128]

    def __call__(self, tau: complex) -> NDArray[np.complex128]:
        r"""The state at a time $\tau$ after the singularity, shape (component,); complex times are allowed."""
        logarithm = cmath.log(complex(tau))
        root = cmath.exp(logarithm / self.denominator)
        powers = root ** np.arange(self.coefficients.shape[1])
        leading = np.array([cmath.exp(-float(g) * logarithm) for g in self.weights])
        return leading * (self.coefficients @ powers)

    @property
    def radius(self) -> float:
        """An estimate of the radius of convergence, from the growth of the last coefficients."""
        sizes = np.abs(self.coefficients).max(axis=0)
        n = len(sizes)
        last = [k for k in range(n // 2, n) if sizes[k] > 0]
        if not last:
            return float("inf")
        rates = [sizes[k] ** (-self.denominator / k) for k in last[-8:]]
        return float(min(rates))


class _Complex(NumberField):
    """Complex numbers, rounded, in the place of the field of a balance."""

    def number(self, value: Any) -> complex:
        """A rational number."""
        return complex(_float(value))


def _float(value: Any) -> float:
    if isinstance(value, fmpq):
        return int(value.p) / int(value.q)
    return float(value)


class _Values:
    """Elements of the field of a balance as complex numbers, at values of its parameters."""

    def __init__(self, field: FunctionField, parameters: Mapping[str, complex], conjugate: int) -> None:
        self._at = dict(parameters)
        self._theta = 0j
        n = field.degree
        if not 0 <= conjugate < n:
            raise ParameterError(f"conjugate: wanted a number from 0 to {n - 1}; got {conjugate}; take 0")
        if isinstance(field, AlgebraicNumbers):
            coefficients = [complex(_float(c)) for c in field.modulus.coeffs()]
        elif isinstance(field, AlgebraicFunctions):
            coefficients = [*map(self.value, field.modulus), 1 + 0j]
        else:
            if isinstance(field, CoordinateRing):
                self._at |= _member(field, self._at, conjugate)
            return
        roots: list[complex] = [complex(z) for z in np.roots(coefficients[::-1])]
        self._theta = sorted(roots, key=lambda z: (round(z.real, 9), round(z.imag, 9)))[conjugate]

    def value(self, element: Element) -> complex:
        """The number."""
        if isinstance(element, fmpq):
            return complex(_float(element))
        if isinstance(element, RingElement):
            return self._polynomial(element.polynomial)
        if (polynomial := getattr(element, "polynomial", None)) is not None:
            return self._horner([complex(_float(c)) for c in polynomial.coeffs()])
        if (coefficients := getattr(element, "coefficients", None)) is not None:
            return self._horner([self.value(c) for c in coefficients])
        return self._polynomial(element.numerator) / self._polynomial(element.denominator)

    def _horner(self, coefficients: Sequence[complex]) -> complex:
        total = 0j
        for c in reversed(coefficients):
            total = total * self._theta + c
        return total

    def _polynomial(self, p: Any) -> complex:
        names = p.context().names()
        total = 0j
        for m, c in p.terms():
            term = complex(_float(c))
            for name, k in zip(names, m, strict=True):
                term *= self._at[name] ** int(k)
            total += term
        return total


def _member(ring: CoordinateRing, parameters: Mapping[str, complex], conjugate: int) -> dict[str, complex]:
    """The coordinates of one member of a family whose parameters have these values."""
    gens = dict(zip(ring.basis.names, ring.basis.context.gens(), strict=True))
    given = {name: Fraction(parameters[name].real) for name in ring.parameters}
    if any(parameters[name].imag for name in given):
        raise ParameterError(f"constants: wanted real numbers for {', '.join(given)}; got {shown(dict(parameters))}")
    budget = Limits().budget()
    fixed = [gens[name] - as_fmpq(value) for name, value in given.items()]
    found = solutions(groebner_basis([*ring.basis.polynomials, *fixed], budget), budget).complex()
    if conjugate >= len(found):
        raise ParameterError(f"conjugate: wanted a number from 0 to {len(found) - 1}; got {conjugate}; take 0")
    at = [acb(x) for x in found[conjugate].values]
    return {
        name: complex(float(z.real.mid()), float(z.imag.mid())) for name, z in zip(ring.basis.names, at, strict=True)
    }


def laurent_series(
    exact: Expansion,
    point: Sequence[Element],
    constants: Mapping[str, complex],
    parameters: Sequence[str],
    *,
    n_terms: int,
    conjugate: int,
) -> LaurentSeries:
    """The series at values of its free constants; see `Balance.series`."""
    wanted = as_count(n_terms, "n_terms", least=len(exact.coefficients))
    field = exact.local.field
    free = [c.name for c in exact.constants]
    names = [*field.parameters, *(p for p in parameters if p not in field.parameters)]
    for name in constants:
        if name not in (*names, *free):
            raise ParameterError(
                f"constants: wanted names of {', '.join((*names, *free)) or 'no constants'}; got {name!r}"
            )
    at = {name: complex(constants.get(name, 1)) for name in names}
    values = _Values(field, at, as_count(conjugate, "conjugate"))
    given = [complex(constants.get(name, 0)) for name in free]
    n = len(point)
    local = LocalField(
        cast("FunctionField", _Complex()),  # an expansion asks for numbers only
        exact.local.weights,
        tuple(tuple((m, values.value(c), d) for m, c, d in of_one) for of_one in exact.local.terms),
    )
    leading = [values.value(c) for c in point]
    series = Expansion(local, exact.denominator, [])
    for of_order in exact.coefficients:
        series.coefficients.append([{(): _at(p, values, given)} for p in of_order])
    matrix = np.array(local.kovalevskaya_matrix(leading))
    while len(series.coefficients) < wanted:
        j = len(series.coefficients)
        right = np.array([p.get((), 0j) for p in series.right_hand_side(j)])
        found = np.linalg.solve(j / exact.denominator * np.eye(n) - matrix, right)
        series.coefficients.append([{(): complex(c)} for c in found])
    array = np.array([[p[()] for p in of_order] for of_order in series.coefficients[:wanted]]).T
    coefficients = np.ascontiguousarray(array)
    coefficients.flags.writeable = False
    return LaurentSeries(exact.local.weights, exact.denominator, coefficients)


def _at(polynomial: Polynomial, values: _Values, constants: Sequence[complex]) -> complex:
    total = 0j
    for m, c in polynomial.items():
        term = values.value(c)
        for k, power in enumerate(m):
            term *= constants[k] ** power
        total += term
    return total
