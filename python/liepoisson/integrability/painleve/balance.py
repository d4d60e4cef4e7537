r"""Balances: leading terms of singular solutions, with their exponents and what the test found about their series.

Of a series to double precision the terms up to the largest exponent are those of the exact one; beyond it the equations
$(k - K)\,c^{(k)} = R^{(k)}$ have one solution for each order.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from re import fullmatch
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from flint import acb, fmpq
from numpy.typing import NDArray
from sympy import Symbol

from liepoisson.algebra.function_fields import AlgebraicFunctions, AlgebraicNumbers, FunctionField
from liepoisson.algebra.ideals.coordinate_ring import CoordinateRing, RingElement
from liepoisson.algebra.ideals.groebner import groebner_basis
from liepoisson.algebra.ideals.limits import Limits
from liepoisson.algebra.ideals.solutions import solutions
from liepoisson.algebra.number_fields import Element, NumberField, as_fmpq
from liepoisson.algebra.sparse_polynomials import Polynomial, value_at
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.painleve.expansion import Expansion, Exponents, FreeConstant, Resonance
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
        point = [self._at[name] for name in p.context().names()]
        return value_at(p.terms(), point, lambda c: complex(_float(c)))


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


Status: TypeAlias = Literal["passes", "passes weakly", "fails", "undecided"]

_MOST_EQUATIONS = 9
"""Equations of a balance that are printed."""

_MOST_CONDITIONS = 2
"""Conditions for a series without logarithms that are printed."""


@dataclass(frozen=True, repr=False)
class Balance:
    r"""Leading terms $x_i = c_i\,\tau^{-g_i}$ of singular solutions: one balance with its conjugates, or a family.

    Attributes:
        variables: The coordinates.
        weights: The orders $g_i$ of the poles, for coordinates whose $c_i$ is not zero.
        equations: Polynomials in the names of the coordinates that vanish at c.
        family: Names of the coordinates whose leading coefficients are free; empty for an isolated balance.
        n_conjugates: How many balances these are, with the same exponents up to conjugation; for a family, how many for
            each value of its parameters.
        kovalevskaya: The exponents.
        resonances: The rational exponents with the dimensions of the kernels and with the conditions of compatibility.
        is_generic: False where a random member of a family was taken.
        obstructions: What makes solutions branch, in words; empty if nothing was found.
        left: What was not decided; empty if nothing is left.
    """

    variables: tuple[Symbol, ...]
    weights: tuple[Fraction, ...]
    equations: tuple[str, ...]
    family: tuple[str, ...]
    n_conjugates: int
    kovalevskaya: Exponents
    resonances: tuple[Resonance, ...]
    is_generic: bool
    obstructions: tuple[str, ...]
    left: str
    _point: tuple[Element, ...] = field(repr=False)
    _field: FunctionField = field(repr=False)
    _parameters: tuple[str, ...] = field(repr=False, default=())
    _expansion: Expansion | None = field(repr=False, default=None, hash=False)

    @property
    def exponents(self) -> tuple[Fraction, ...]:
        """The rational exponents, each as often as its multiplicity, in increasing order."""
        return tuple(r for r, k in self.kovalevskaya.rational for _ in range(k))

    @property
    def other_exponents(self) -> tuple[complex, ...]:
        """The irrational exponents, to double precision, of all conjugates; none where they depend on parameters."""
        return tuple(complex(float(z.real.mid()), float(z.imag.mid())) for z in self.kovalevskaya.others)

    @property
    def kernels(self) -> dict[Fraction, tuple[int, int]]:
        """For each rational exponent its multiplicity and the dimension of the kernel, which must be equal."""
        return {r.exponent: (r.multiplicity, r.kernel) for r in self.resonances}

    @property
    def constants(self) -> tuple[FreeConstant, ...]:
        """The free constants of the series, those of the family and the position of the singularity left out."""
        return () if self._expansion is None else tuple(self._expansion.constants)

    @property
    def n_constants(self) -> int:
        """The number of free constants of the solutions: the position of the singularity, the family, and others."""
        return 1 + len(self.family) + len(self.constants)

    @property
    def is_principal(self) -> bool:
        """Whether these are as many as a general solution has."""
        return self.n_constants == len(self.variables)

    @property
    def n_log_free(self) -> int | None:
        r"""The number of solutions without logarithms of the variational equation of $c\,\tau^{-g}$.

        None if not all exponents are rational.
        """
        if not self.kovalevskaya.all_rational:
            return None
        return sum(r.kernel for r in self.resonances)

    @property
    def has_branch_points(self) -> bool:
        """Whether exponents, or orders of poles, are rational numbers that are not whole."""
        orders = [g for g, c in zip(self.weights, self._point, strict=True) if c]
        rational = (r for r, _ in self.kovalevskaya.rational)
        return any(x.denominator > 1 for x in (*orders, *rational))

    @property
    def is_negative(self) -> bool:
        """Whether there are negative exponents besides -1, or -1 more than once."""
        return any(r < 0 and (r != -1 or k > 1) for r, k in self.kovalevskaya.rational)

    @property
    def symbols(self) -> tuple[str, ...]:
        """The symbols of the system, for general values of which this holds."""
        return self._parameters

    @property
    def status(self) -> Status:
        """What the test says of this balance."""
        if self.obstructions:
            return "fails"
        if self.left:
            return "undecided"
        return "passes weakly" if self.has_branch_points else "passes"

    def __repr__(self) -> str:
        return f"<Balance: exponents {self.kovalevskaya}; {self.status}>"

    def __str__(self) -> str:
        """The leading coefficients, the exponents and what was found."""
        many = f", {self.n_conjugates} conjugate" if self.n_conjugates > 1 else ""
        kind = f"a family, {', '.join(self.family)} free{many}" if self.family else f"isolated{many}"
        kind += "" if self.is_generic else ", at a random member"
        lines = [f"{self.status}: {kind}", f"  {self._leading()}", f"  exponents {self.kovalevskaya}"]
        lines += [f"  {text}" for text in self.obstructions]
        if self.left:
            lines.append(f"  {self.left}")
        if not self.obstructions:
            general = ", as a general solution" if self.is_principal else ""
            lines.append(f"  {self.n_constants} free constants{general}")
        return "\n".join(lines)

    def _leading(self) -> str:
        names = list(map(str, self.variables))
        shown = [(name, self._field.rational(c)) for name, c in zip(names, self._point, strict=True)]
        orders = dict(zip(names, self.weights, strict=True))
        simple = [_leading_term(name, str(c), orders[name]) for name, c in shown if c]
        zero = [name for name, c in shown if c is not None and not c]
        if all(c is not None for _, c in shown):
            return ", ".join(simple)
        # without those that say that one coordinate is a rational number
        rest = [e for e in self.equations if not fullmatch(r"\w+( [+-] [\d/]+)?", e)]
        more = f", ... ({len(rest)} equations)" if len(rest) > _MOST_EQUATIONS else ""
        text = [*simple, *(f"{e} = 0" for e in rest[:_MOST_EQUATIONS])]
        return f"{', '.join(text)}{more}" + (f"; {', '.join(zero)} = 0" if zero else "")

    @explains_its_arguments
    def series(
        self,
        constants: Mapping[str, complex] | None = None,
        *,
        n_terms: int = 40,
        conjugate: int = 0,
    ) -> LaurentSeries:
        r"""The series of one solution, $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$, to double precision.

        Args:
            constants: Values of the free constants C1, C2, ..., of the coordinates of `family`, and of parameters of
                the system; those that are left out are zero, and 1 for the family.
            n_terms: The number of terms.
            conjugate: Which of the conjugate balances, from 0.

        Raises:
            ParameterError: a name is no free constant, or the series has a logarithm or was not computed.
        """
        if self._expansion is None or self.status == "fails":
            raise ParameterError(
                f"series: wanted a balance whose series has no logarithm; got one that {self.status}; take another"
            )
        return laurent_series(
            self._expansion, self._point, dict(constants or {}), self._parameters, n_terms=n_terms, conjugate=conjugate
        )


def _leading_term(name: str, c: str, order: Fraction) -> str:
    if order.denominator > 1:
        return f"{name} = {c}*t^(-{order})"
    return f"{name} = {c}" + (f"/t^{order}" if order > 1 else "/t" if order else "")


def obstructions_of(exponents: Exponents, resonances: tuple[Resonance, ...], dimension: int) -> tuple[str, ...]:
    """What makes solutions branch."""
    found: list[str] = []
    if not exponents.all_rational:
        depends = exponents.field.parameters and len(exponents.rest) > 1
        whom = " for general values of what they depend on" if depends else ""
        found.append(f"irrational exponents{whom}: infinitely many branches")
    for r in resonances:
        if r.exponent == 0 and r.multiplicity > dimension:
            found.append(
                f"logarithm: the exponent 0 has multiplicity {r.multiplicity}, and the balances have {dimension} free "
                "constants"
            )
        elif r.has_jordan_block:
            found.append(
                f"logarithm: the exponent {r.exponent} has multiplicity {r.multiplicity}, and its kernel has dimension "
                f"{r.kernel}"
            )
        if r.conditions:
            found.append(f"logarithm at the exponent {r.exponent}{_unless(r.conditions, exponents.field.generator)}")
    return tuple(found)


def _unless(conditions: tuple[str, ...], generator: str) -> str:
    """Where there is no logarithm, as words; nothing if there is one in any case."""
    if "1" in conditions:
        return ""
    shown = conditions[:_MOST_CONDITIONS]
    short = [text if len(text) <= 100 else f"{text[:90]} ..." for text in shown]
    words = ", unless " + " and ".join(f"{text} = 0" for text in short)
    return words + (f", where {generator}" if any("theta" in text for text in shown) else "")


def as_record(balance: Balance) -> dict[str, Any]:
    """A balance as data that JSON can write."""
    return {
        "status": balance.status,
        "weights": {str(v): str(w) for v, w in zip(balance.variables, balance.weights, strict=True)},
        "equations": list(balance.equations),
        "family": list(balance.family),
        "conjugates": balance.n_conjugates,
        "exponents": [str(r) for r in balance.exponents],
        "other_exponents": [[z.real, z.imag] for z in balance.other_exponents],
        "resonances": [
            {
                "exponent": str(r.exponent),
                "multiplicity": r.multiplicity,
                "kernel": r.kernel,
                "conditions": None if r.conditions is None else list(r.conditions),
            }
            for r in balance.resonances
        ],
        "constants": balance.n_constants,
        "principal": balance.is_principal,
        "generic": balance.is_generic,
        "obstructions": list(balance.obstructions),
        "left": balance.left,
    }
