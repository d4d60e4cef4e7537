r"""The matrices of the form in which Lax pairs are searched, and the linear equation for L; see `search`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.errors import ParameterError
from liepoisson.exact.lie.defining_matrices import defining_matrices
from liepoisson.integrability.derivation import derivation_of
from liepoisson.wrong_values import shown

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.system import System

Linear: TypeAlias = dict[tuple[int, ...], Fraction]
"""A polynomial in the coordinates by its exponents."""
EntryMatrix: TypeAlias = dict[tuple[int, int], Linear]
"""A matrix of polynomials by its nonzero entries."""
Vector: TypeAlias = dict[int, Fraction]


class Ansatz:
    """The matrices of the form, and the linear equation for L."""

    def __init__(self, system: System, form: str) -> None:
        algebra = system.bracket.algebra
        matrices = None if system.bracket.has_scalar_fields else defining_matrices(algebra)
        if matrices is None or matrices.order != 1:
            raise ParameterError(
                f"system: wanted one on so(p, q), gl(n), sl(n) or su(n), whose fields are matrices; got one on "
                f"{system.bracket!r}; verify a pair of your own with lax_pair"
            )
        if system.bracket.constant:
            raise ParameterError("system: wanted a bracket without a constant part; search after a translation")
        self.system, self.size = system, matrices.size
        self.n = len(system.variables)
        self.spectral = "z" if "z" not in {*system.component_names, *system.values} else "spectral"
        derivation, _ = derivation_of(system)
        if not derivation.field.is_rational:
            raise ParameterError(
                "system: wanted equations with rational coefficients; give numbers for parameters that are symbols"
            )
        self.rates: list[Linear] = [dict(component) for component in derivation.components]
        dual = [_numeric(m) for m in matrices.matrices]
        self.form = form
        self.movers = movers = [_numeric(matrices.movers[j]) for j in range(algebra.dimension)]
        size = algebra.dimension
        self.fields = [
            [(first + k, dual[k]) for k in range(size)] for first in range(0, self.n, size)
        ]  # each field as pairs of a coordinate and its matrix
        self.omega = self._angular_velocity(movers)
        self.constants = dual if form == "algebra" else _all_matrices(self.size)
        self.partners = movers if form == "algebra" else [{(i, i): Fraction(1)} for i in range(1, self.size)]

    def _angular_velocity(self, movers: Sequence[Mapping[tuple[int, int], Fraction]]) -> EntryMatrix:
        from sympy import Poly

        found: EntryMatrix = {}
        for x, mover in zip(self.system.variables, movers, strict=False):
            polynomial = Poly(self.system.hamiltonian.diff(x), *self.system.variables)
            if polynomial.total_degree() > 1:
                raise ParameterError(
                    f"system: wanted a Hamiltonian whose derivative by {x} is linear; got "
                    f"{shown(polynomial.as_expr())}; verify a pair of your own with lax_pair"
                )
            for monomial, c in polynomial.terms():
                if c:
                    term = {tuple(map(int, monomial)): Fraction(int(c.p), int(c.q))}
                    for place, factor in mover.items():
                        _add(found.setdefault(place, {}), term, factor)
        return found

    @property
    def n_per_power(self) -> int:
        """Unknowns of one power of z: a number for each field, then the constant matrix."""
        return len(self.fields) + len(self.constants)

    def basis_matrix(self, k: int) -> EntryMatrix:
        """The matrix that belongs to an unknown of one power of z."""
        found: EntryMatrix = {}
        if k >= len(self.fields):
            return {place: {(0,) * self.n: c} for place, c in self.constants[k - len(self.fields)].items()}
        for x, matrix in self.fields[k]:
            for place, c in matrix.items():
                _add(found.setdefault(place, {}), {_unit(x, self.n): c}, Fraction(1))
        return found

    def columns(self) -> list[tuple[EntryMatrix, list[EntryMatrix]]]:
        """For each unknown of one power of z: its rate minus [E, Omega], and -[E, b] for the directions b of B."""
        found: list[tuple[EntryMatrix, list[EntryMatrix]]] = []
        for k in range(self.n_per_power):
            e = self.basis_matrix(k)
            residual: EntryMatrix = {}
            for place, entry in e.items():
                for monomial, c in entry.items():
                    if any(monomial):
                        _add(residual.setdefault(place, {}), self.rates[monomial.index(1)], c)
            for place, value in _commutator(e, self.omega).items():
                _add(residual.setdefault(place, {}), value, Fraction(-1))
            partners: list[EntryMatrix] = []
            for b in self.partners:
                constant: EntryMatrix = {place: {(0,) * self.n: c} for place, c in b.items()}
                partners.append({p: {m: -c for m, c in v.items()} for p, v in _commutator(e, constant).items()})
            found.append((residual, partners))
        return found

    def pair(self, vector: Vector, b: Sequence[Fraction]) -> tuple[list[Any], list[Any]]:
        """L and M of a solution: matrices, or elements where the matrices are as many as their rows, as on so(3)."""
        from sympy import Integer, Symbol

        z = Symbol(self.spectral)
        first: dict[tuple[int, int], Any] = {}
        for column, c in vector.items():
            power, k = divmod(column, self.n_per_power)
            self._put(first, self.basis_matrix(k), c, z**power)
        second: dict[tuple[int, int], Any] = {}
        self._put(second, self.omega, Fraction(1), Integer(1))
        for component, matrix in zip(b, self.partners, strict=True):
            constant: EntryMatrix = {place: {(0,) * self.n: c} for place, c in matrix.items()}
            self._put(second, constant, component, z)
        if self.form == "algebra" and len(self.movers) == self.size:
            return self._components(first), self._components(second)
        rows = range(self.size)
        L, M = ([[found.get((i, j), Integer(0)) for j in rows] for i in rows] for found in (first, second))
        return L, M

    def _put(self, total: dict[tuple[int, int], Any], matrix: EntryMatrix, factor: Fraction, power: Any) -> None:
        from sympy import Integer, Rational

        for place, entry in matrix.items():
            for monomial, value in entry.items():
                x: Any = self.system.variables[monomial.index(1)] if any(monomial) else Integer(1)
                c = factor * value
                total[place] = total.get(place, Integer(0)) + Rational(c.numerator, c.denominator) * x * power

    def _components(self, matrix: Mapping[tuple[int, int], Any]) -> list[Expr]:
        """A matrix of the algebra in its basis."""
        from sympy import Integer, Rational

        found: list[Expr] = []
        for k, mover in enumerate(self.movers):
            others = {place for other in (*self.movers[:k], *self.movers[k + 1 :]) for place in other}
            place = next(place for place in mover if place not in others)
            value: Any = matrix.get(place, Integer(0)) / Rational(mover[place].numerator, mover[place].denominator)
            found.append(value)
        return found


def _numeric(matrix: Mapping[tuple[int, int], Any]) -> dict[tuple[int, int], Fraction]:
    return {place: sum((q for q, _ in roots), Fraction(0)) for place, roots in matrix.items()}


def _all_matrices(size: int) -> list[dict[tuple[int, int], Fraction]]:
    return [{(i, j): Fraction(1)} for i in range(size) for j in range(size)]


def _unit(x: int, n: int) -> tuple[int, ...]:
    return tuple(int(k == x) for k in range(n))


def _add(total: Linear, polynomial: Mapping[tuple[int, ...], Fraction], factor: Fraction) -> None:
    for monomial, c in polynomial.items():
        value = total.get(monomial, Fraction(0)) + factor * c
        if value:
            total[monomial] = value
        else:
            total.pop(monomial, None)


def _commutator(a: EntryMatrix, b: EntryMatrix) -> EntryMatrix:
    found: EntryMatrix = {}
    for first, second, sign in ((a, b, Fraction(1)), (b, a, Fraction(-1))):
        for (i, k), u in first.items():
            for (m, j), v in second.items():
                if m != k:
                    continue
                for monomial, c in u.items():
                    product = {tuple(map(sum, zip(monomial, n, strict=True))): c * e for n, e in v.items()}
                    _add(found.setdefault((i, j), {}), product, sign)
    return found
