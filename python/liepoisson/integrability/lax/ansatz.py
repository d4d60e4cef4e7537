r"""The matrices of the form in which Lax pairs are searched, and the linear equation for L; see `search`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.sparse_polynomials import add_multiple, multiply
from liepoisson.errors import ParameterError
from liepoisson.inputs.refusals import shown
from liepoisson.structure.lie.defining_matrices import defining_matrices

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System

Linear: TypeAlias = dict[tuple[int, ...], Fraction]
"""A polynomial in the coordinates by its exponents."""
EntryMatrix: TypeAlias = dict[tuple[int, int], Linear]
"""A matrix of polynomials by its nonzero entries."""
Vector: TypeAlias = dict[int, Fraction]


Part: TypeAlias = tuple[list[Linear], EntryMatrix]
"""The rates of the coordinates, and the angular velocity."""

_FORMS = ("algebra", "diagonal")


class Ansatz:
    """The matrices of the form, and the linear equation for L.

    Args:
        system: The system.
        form: "algebra" or "diagonal".
        parameters: Symbols of the system, of which its equations are rational functions.

    Attributes:
        parts: Rates and angular velocity, times their common denominator: the coefficients of the monomials in the
            parameters, by the exponents of these.
        denominator: That denominator.

    Raises:
        ParameterError: the system has no such form.
    """

    def __init__(self, system: System, form: str, parameters: Sequence[Symbol] = ()) -> None:
        if form not in _FORMS:
            raise ParameterError(f'form: wanted "algebra" or "diagonal"; got {shown(form)}')
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
        dual = [_numeric(m) for m in matrices.matrices]
        self.form = form
        self.movers = movers = [_numeric(matrices.movers[j]) for j in range(algebra.dimension)]
        size = algebra.dimension
        self.fields = [
            [(first + k, dual[k]) for k in range(size)] for first in range(0, self.n, size)
        ]  # each field as pairs of a coordinate and its matrix
        self.parameters = tuple(parameters)
        self.parts, self.denominator = self._read(movers)
        self.constants = dual if form == "algebra" else _all_matrices(self.size)
        self.partners = movers if form == "algebra" else [{(i, i): Fraction(1)} for i in range(1, self.size)]

    def _read(self, movers: Sequence[Mapping[tuple[int, int], Fraction]]) -> tuple[dict[tuple[int, ...], Part], Any]:
        """The parts of the equations by powers of the parameters, and what they were multiplied by."""
        from sympy import Integer, Poly, lcm

        system, x = self.system, self.system.variables
        rates: list[Any] = [e.together() for e in system.equations.values()]
        slopes: list[Any] = [system.hamiltonian.diff(v).together() for v in x[: len(movers)]]
        common: Any = Integer(1)
        for e in (*rates, *slopes):
            common = lcm(common, e.as_numer_denom()[1].as_coeff_Mul()[1])  # coefficients may be fractions
        parts: dict[tuple[int, ...], Part] = {}
        for k, e in enumerate((*rates, *slopes)):
            whole = (common * e).cancel().expand()
            if not whole.is_polynomial(*x, *self.parameters):
                raise ParameterError(f"system: wanted polynomial equations; got {shown(str(e))}")
            for monomial, c in Poly(whole, *x, *self.parameters).terms():
                if not c.is_Rational:
                    raise ParameterError(
                        f"system: wanted equations with rational coefficients; got {shown(str(c))}; give numbers for "
                        "parameters that are symbols, or look for their values with lax_families"
                    )
                powers, factors = tuple(map(int, monomial[self.n :])), tuple(map(int, monomial[: self.n]))
                if not c:
                    continue
                part = parts.setdefault(powers, ([{} for _ in x], {}))
                if k < self.n:
                    part[0][k][factors] = Fraction(int(c.p), int(c.q))
                    continue
                if sum(factors) > 1:
                    raise ParameterError(
                        f"system: wanted a Hamiltonian whose derivative by {x[k - self.n]} is linear; got "
                        f"{shown(str(e))}; verify a pair of your own with lax_pair"
                    )
                for place, factor in movers[k - self.n].items():
                    add_multiple(part[1].setdefault(place, {}), {factors: Fraction(int(c.p), int(c.q))}, factor)
        return parts, common

    @property
    def n_per_power(self) -> int:
        """Unknowns of one power of z: a number for each field, then the constant matrix."""
        return len(self.fields) + len(self.constants)

    def basis_matrix(self, k: int) -> EntryMatrix:
        """The matrix that belongs to an unknown of one power of z."""
        found: EntryMatrix = {}
        if k >= len(self.fields):
            return self._constant(self.constants[k - len(self.fields)])
        for x, matrix in self.fields[k]:
            for place, c in matrix.items():
                add_multiple(found.setdefault(place, {}), {_unit(x, self.n): c}, Fraction(1))
        return found

    def residual(self, k: int, part: Part) -> EntryMatrix:
        """The rate of the matrix of an unknown minus its commutator with Omega."""
        rates, omega = part
        e = self.basis_matrix(k)
        found: EntryMatrix = {}
        for place, entry in e.items():
            for monomial, c in entry.items():
                if any(monomial):
                    add_multiple(found.setdefault(place, {}), rates[monomial.index(1)], c)
        for place, value in _commutator(e, omega).items():
            add_multiple(found.setdefault(place, {}), value, Fraction(-1))
        return found

    def partner_terms(self, k: int) -> list[EntryMatrix]:
        """Minus the commutators of the matrix of an unknown with the directions of B."""
        e = self.basis_matrix(k)
        return [_commutator(self._constant(b), e) for b in self.partners]

    def _constant(self, matrix: Mapping[tuple[int, int], Fraction]) -> EntryMatrix:
        return {place: {(0,) * self.n: c} for place, c in matrix.items()}

    def pair(self, vector: Vector, b: Sequence[Fraction]) -> tuple[list[Any], list[Any]]:
        """L and M of a solution: matrices, or elements where the matrices are as many as their rows, as on so(3)."""
        from sympy import Integer, Symbol

        z = Symbol(self.spectral)
        first: dict[tuple[int, int], Any] = {}
        for column, c in vector.items():
            power, k = divmod(column, self.n_per_power)
            self._put(first, self.basis_matrix(k), c, z**power)
        second: dict[tuple[int, int], Any] = {}
        for _, omega in self.parts.values():  # one part: there are no parameters
            self._put(second, omega, Fraction(1), Integer(1))
        for component, matrix in zip(b, self.partners, strict=True):
            self._put(second, self._constant(matrix), component, z)
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


def _commutator(a: EntryMatrix, b: EntryMatrix) -> EntryMatrix:
    found: EntryMatrix = {}
    for first, second, sign in ((a, b, Fraction(1)), (b, a, Fraction(-1))):
        for (i, k), u in first.items():
            for (m, j), v in second.items():
                if m != k:
                    continue
                add_multiple(found.setdefault((i, j), {}), multiply(u, v), sign)
    return found
