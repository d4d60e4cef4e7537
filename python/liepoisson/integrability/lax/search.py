r"""Lax pairs of one form, searched exactly.

The fields $x_\mu$ of a bracket on an algebra of matrices are matrices $X_\mu = \sum_k x_{\mu k} F^k$, on which
coadjoint motion is conjugation: $\dot X_0 = [X_0, \Omega]$ for a free body, with the angular velocity
$\Omega = \sum_j e_j\,\partial H/\partial x_{0j}$, which must be linear in the coordinates. The form is

$$L(z) = \sum_{k=0}^{d} z^k\Bigl(\sum_\mu c_{k\mu} X_\mu + C_k\Bigr), \qquad M(z) = \Omega + z B,$$

with unknown numbers $c_{k\mu}$ and unknown constant matrices $C_k$ and B.

* `form="algebra"`: $C_k$ and B are in the Lie algebra. Lagrange's top and its twisted relatives have such pairs.
* `form="diagonal"`: B is diagonal, the $C_k$ are any matrices. Manakov's tops have such pairs.

For given B the equation $\dot L = [L, M]$ is linear in the others. A scaling of z makes the first component of B that
is not zero equal to 1; in the others the linear system is split into cases
(`liepoisson.integrability.parameter_cases`), so that "there is no other real B" is proved where all cases are decided.
Multiples of pairs by powers of z, and pairs whose eigenvalues are Casimirs only, are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, product
from typing import Any, TypeAlias

from sympy import Expr, Integer, Poly, Symbol, lcm

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.number_fields import as_fmpq, as_fraction
from liepoisson.algebra.sparse_polynomials import add_multiple, expression, multiply, value_at
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import CUT_SHORT, SEARCH_LIMIT, Deadline
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.lax.pair import LaxPair, lax_pair
from liepoisson.integrability.parameter_cases import Case, Cases, CaseSplitting
from liepoisson.model.system import System
from liepoisson.structure.lie.defining_matrices import defining_matrices

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

    The equations of motion are rational functions of the parameters. In `parts` are the rates and the angular velocity,
    times their common denominator: the coefficients of the monomials in the parameters, by the exponents of these.
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
        # each field as pairs of a coordinate and its matrix
        self.fields = [[(first + k, dual[k]) for k in range(size)] for first in range(0, self.n, size)]
        self.parameters = tuple(parameters)
        self.parts, self.denominator = self._read(movers)
        places = product(range(self.size), range(self.size))
        self.constants = dual if form == "algebra" else [{place: Fraction(1)} for place in places]
        self.partners = movers if form == "algebra" else [{(i, i): Fraction(1)} for i in range(1, self.size)]

    def _read(self, movers: Sequence[Mapping[tuple[int, int], Fraction]]) -> tuple[dict[tuple[int, ...], Part], Any]:
        """The parts of the equations by powers of the parameters, and what they were multiplied by."""
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
                    part[0][k][factors] = as_fraction(c)
                    continue
                if sum(factors) > 1:
                    raise ParameterError(
                        f"system: wanted a Hamiltonian whose derivative by {x[k - self.n]} is linear; got "
                        f"{shown(str(e))}; verify a pair of your own with lax_pair"
                    )
                for place, factor in movers[k - self.n].items():
                    add_multiple(part[1].setdefault(place, {}), {factors: as_fraction(c)}, factor)
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
            unit = tuple(int(j == x) for j in range(self.n))
            for place, c in matrix.items():
                add_multiple(found.setdefault(place, {}), {unit: c}, Fraction(1))
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
        for place, entry in matrix.items():
            written = expression(((m, factor * c) for m, c in entry.items()), self.system.variables)
            total[place] = total.get(place, Integer(0)) + written * power

    def _components(self, matrix: Mapping[tuple[int, int], Any]) -> list[Expr]:
        """A matrix of the algebra in its basis."""
        found: list[Expr] = []
        for k, mover in enumerate(self.movers):
            others = {place for other in (*self.movers[:k], *self.movers[k + 1 :]) for place in other}
            place = next(place for place in mover if place not in others)
            found.append(matrix.get(place, Integer(0)) / to_sympy(mover[place]))
        return found


def _numeric(matrix: Mapping[tuple[int, int], Any]) -> dict[tuple[int, int], Fraction]:
    return {place: sum((q for q, _ in roots), Fraction(0)) for place, roots in matrix.items()}


def _commutator(a: EntryMatrix, b: EntryMatrix) -> EntryMatrix:
    found: EntryMatrix = {}
    for first, second, sign in ((a, b, Fraction(1)), (b, a, Fraction(-1))):
        for (i, k), u in first.items():
            for (m, j), v in second.items():
                if m != k:
                    continue
                add_multiple(found.setdefault((i, j), {}), multiply(u, v), sign)
    return found


MOST_DEGREE = 8
_SAMPLES = tuple(map(Fraction, ("2", "3", "5", "1", "-1", "0", "-2", "1/2", "-1/2", "3/4", "4/3")))
"""Values of components of B that a case leaves free; each component begins with another one."""
_MOST_SAMPLES = 20_000


@dataclass(frozen=True, repr=False)
class LaxSearch:
    """What a search for Lax pairs found.

    Example:
        >>> found = lp.integrability.search_lax_pairs(lp.catalog.system("lagrange"), degree=2)
        >>> found.complete, found.pairs[0].elements[0]  # L is alpha + z l + z^2 e_3
        (True, (alpha1 + l1*z, alpha2 + l2*z, alpha3 + l3*z + z**2))

    Attributes:
        system: The system.
        form: "algebra" or "diagonal".
        degree: The largest degree of L in z.
        pairs: Pairs, lowest degree first, each verified. Where a whole family of B is possible, one member.
        complete: Whether it is proved that there are no others of this form with real B, but for combinations of pairs
            with one B, their multiples by powers of z, and, where there are families, their other members.
        n_families: Families of B, in which components are free.
        n_undecided: Cases that were not decided, or in which B is not rational.
        is_cut_short: Whether the time limit ended the search.
    """

    system: System
    form: str
    degree: int
    pairs: tuple[LaxPair, ...]
    complete: bool
    n_families: int
    n_undecided: int
    is_cut_short: bool = False

    def __repr__(self) -> str:
        n = len(self.pairs)
        found = f"{n} Lax pair{'s' * (n != 1)}" if n else "no Lax pair"
        state = "" if self.complete else ", incomplete" + CUT_SHORT * self.is_cut_short
        return f"<LaxSearch of {self.system.name}: {found} of degree up to {self.degree}, form {self.form}{state}>"

    def __str__(self) -> str:
        """The pairs, and what is proved."""
        where = "in the Lie algebra" if self.form == "algebra" else "diagonal"
        lines = [f"{self.system.name}: L of degree up to {self.degree} in z, M = Omega + z B with B {where}"]
        lines += [str(pair) for pair in self.pairs]
        proved = "there are no others of this form: proved" if self.pairs else "there is none of this form: proved"
        if self.n_families:
            proved = f"all B of this form are these and the members of {self.n_families} families: proved"
        left = f"not proved that these are all: {self.n_undecided} cases left{CUT_SHORT * self.is_cut_short}"
        lines.append(proved if self.complete else left)
        return "\n".join(lines)


@shows_progress
def search_lax_pairs(
    system: System,
    *,
    degree: int = 2,
    form: str = "algebra",
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> LaxSearch:
    r"""Lax pairs with $M = \Omega + zB$ and L a polynomial in z, linear in the coordinates.

    $L(z) = \sum_k z^k(\sum_\mu c_{k\mu} X_\mu + C_k)$ with numbers $c_{k\mu}$, the fields $X_\mu$ as matrices and
    constant matrices $C_k$; $\Omega$ is the angular velocity $\partial H/\partial x_0$. Not of this form are pairs
    whose L is quadratic in the coordinates (Clebsch), whose M has more terms, or whose matrices are larger than
    those of the algebra (Kovalevskaya).

    Example:
        >>> found = lp.integrability.search_lax_pairs(lp.catalog.system("lagrange"), degree=2)
        >>> found.pairs[0].integrals().is_complete
        True

    Args:
        system: A system without symbols, on so(p, q), gl(n), sl(n) or su(n) with any extension, with polynomial
            equations and a Hamiltonian that is quadratic in the first field.
        degree: The largest degree of L in z, from 1 to 8.
        form: "algebra", B and the C_k in the Lie algebra; or "diagonal", B diagonal and the C_k any matrices.
        time_limit: Seconds after which cases are left undecided.
        progress: As for `integrate`.

    Raises:
        ParameterError: the system is not such a one.

    References: [manakov1976]; [musso2005].
    """
    most = as_count(degree, "degree", least=1, most=MOST_DEGREE)
    deadline = as_deadline(time_limit)
    ansatz = Ansatz(system, form)
    pairs: list[LaxPair] = []
    trivial = trivial_vectors(ansatz)
    known: dict[tuple[Fraction, ...], list[tuple[int, Vector]]] = {}
    n_undecided, n_families, is_cut_short = 0, 0, False
    for d in range(1, most + 1):
        if d > 1 and not deadline.lasts():
            n_undecided, is_cut_short = n_undecided + 1, True
            break
        found, is_cut_short = _partners(ansatz, d, len(trivial), deadline)
        decided = [one for one in found if one is not None]
        n_undecided, n_families = len(found) - len(decided), sum(is_free for _, is_free in decided)
        for b in dict.fromkeys(b for b, _ in decided):
            pairs += pairs_with(ansatz, d, b, known.setdefault(b, [(0, v) for v in trivial]))
        if progress:
            progress(d / most)
    return LaxSearch(system, form, most, tuple(pairs), not n_undecided, n_families, n_undecided, is_cut_short)


_Partner: TypeAlias = tuple[tuple[Fraction, ...], bool]
"""A matrix B by its components, and whether it is a member of a family."""


def _partners(ansatz: Ansatz, degree: int, n_trivial: int, deadline: Deadline) -> tuple[list[_Partner | None], bool]:
    """The B for which there are solutions of this degree, None for each case not decided, and if time ran out."""
    n = len(ansatz.partners)
    found: list[_Partner | None] = []
    is_cut_short = False
    for first in range(n):  # the first component that is not zero
        free = n - first - 1
        context = rational_context([f"b{k}" for k in range(first + 1, n)] or ["unused"])
        components = [context.constant(0)] * first + [context.constant(1), *(context.gen(k) for k in range(free))]
        cases = split(CaseSplitting(context, frozenset(), []), ansatz, degree, components, n_trivial, deadline=deadline)
        for case in cases.found:
            b = member(case, free)
            is_free = len(case.solved) < free
            found.append(None if b is None else ((*(Fraction(0),) * first, Fraction(1), *b), is_free))
        found += [None] * len(cases.left)
        is_cut_short |= cases.is_cut_short
    return found, is_cut_short


def split(
    splitting: CaseSplitting,
    ansatz: Ansatz,
    degree: int,
    components: Sequence[Any],
    n_trivial: int,
    *,
    deadline: Deadline,
) -> Cases:
    """The cases in which there are solutions of a degree, besides the trivial ones times powers of z."""
    cases = Cases()
    rows = linear_system(ansatz, degree, components, splitting.context)
    with deadline.running():
        splitting.run(rows, (degree + 1) * ansatz.n_per_power, (degree + 1) * n_trivial, cases)
    splitting.settle(cases)
    return cases


def pairs_with(
    ansatz: Ansatz, degree: int, b: tuple[Fraction, ...], known: list[tuple[int, Vector]]
) -> Iterator[LaxPair]:
    """The pairs for one B, verified, that are new at a degree and have integrals."""
    for vector in new_vectors(ansatz, degree, b, known):
        L, M = ansatz.pair(vector, b)
        pair = lax_pair(ansatz.system, L, M, spectral=ansatz.spectral)
        if pair.integrals().n_independent:
            yield pair


def trivial_vectors(ansatz: Ansatz) -> list[Vector]:
    """Constant matrices that commute with M for every B, and for all parameters."""
    columns: list[dict[Any, Fraction]] = []
    for k in range(ansatz.n_per_power):
        parts = [*(ansatz.residual(k, part) for part in ansatz.parts.values()), *ansatz.partner_terms(k)]
        columns.append({(number, place, m): c for number, one in enumerate(parts) for place, m, c in _terms(one)})
    return list(nullspace(transposed(columns), ansatz.n_per_power, Coefficients()).vectors)


def linear_system(ansatz: Ansatz, degree: int, components: Sequence[Any], context: Any) -> list[dict[int, Any]]:
    """The equation for L, one row for each entry, power of z and monomial.

    Args:
        ansatz: The form, with parameters that are the first variables of the context.
        degree: Of L in z.
        components: Of B.
        context: FLINT's context of the entries of the matrix.
    """
    rows: dict[Any, dict[int, Any]] = {}

    def put(key: Any, column: int, value: Any) -> None:
        row = rows.setdefault(key, {})
        row[column] = row[column] + value if column in row else value

    factors = {p: context.from_dict({(*p, *(0,) * (context.nvars() - len(p))): 1}) for p in ansatz.parts}
    for k in range(ansatz.n_per_power):
        residuals = [(factors[powers], ansatz.residual(k, part)) for powers, part in ansatz.parts.items()]
        partners = ansatz.partner_terms(k)
        for power in range(degree + 1):
            column = power * ansatz.n_per_power + k
            for factor, residual in residuals:
                for place, monomial, c in _terms(residual):
                    put((place, power, monomial), column, factor * as_fmpq(c))
            for b, partner in zip(components, partners, strict=True):
                for place, monomial, c in _terms(partner) if b else ():
                    put((place, power + 1, monomial), column, b * as_fmpq(c))
    return [kept for row in rows.values() if (kept := {c: v for c, v in row.items() if v})]


def _terms(matrix: EntryMatrix) -> Iterator[tuple[tuple[int, int], tuple[int, ...], Fraction]]:
    return ((place, monomial, c) for place, entry in matrix.items() for monomial, c in entry.items())


def member(case: Case, n: int, positive: frozenset[int] = frozenset()) -> tuple[Fraction, ...] | None:
    """One point of a case with rational coordinates, some of them positive; None if none is found."""
    solved, number = {v for v, _, _ in case.solved}, Coefficients().number
    free = [v for v in range(n) if v not in solved]
    samples = [_SAMPLES[k % len(_SAMPLES) :] + _SAMPLES[: k % len(_SAMPLES)] for k in range(len(free))]
    for chosen in islice(product(*samples), _MOST_SAMPLES):
        at = dict(zip(free, chosen, strict=True))
        values = [at.get(v, Fraction(0)) for v in range(n)]
        if any(value_at(q.terms(), values, number) for q in case.unsolved) or not case.admits(values, number):
            continue
        point = case.completed(values, number)
        if point is not None and all(point[v] > 0 for v in positive):
            return tuple(point)
    return None


def new_vectors(ansatz: Ansatz, degree: int, b: tuple[Fraction, ...], known: list[tuple[int, Vector]]) -> list[Vector]:
    """Solutions for one B that are no combinations of those of lower degree and their multiples by powers of z."""
    context = rational_context(["unused"])
    components = [context.constant(as_fmpq(c)) for c in b]
    n = ansatz.n_per_power
    rows = [
        {column: as_fraction(value.leading_coefficient()) for column, value in row.items()}
        for row in linear_system(ansatz, degree, components, context)
    ]
    solutions = nullspace(rows, (degree + 1) * n, Coefficients()).vectors
    span = Echelon(Coefficients())  # by the last columns, which are negative to come first
    for d, vector in known:
        for shift in range(degree - d + 1):
            span.insert({-column - shift * n: c for column, c in vector.items()})
    found: list[Vector] = []
    for solution in solutions:
        if rest := span.reduce({-column: c for column, c in solution.items()}):
            span.insert(rest)
            of_first_field = (c for k, c in sorted(rest.items(), reverse=True) if k % n == 0)
            lead = next(of_first_field, rest[min(rest)])
            found.append({-k: c / lead for k, c in rest.items()})
            known.append((degree, found[-1]))
    return found
