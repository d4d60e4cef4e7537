r"""Variational equations along a particular solution, as a linear system with rational coefficients, and their flags.

With $\dot x = f(x)$ and a solution x(s), $\dot s = p(s)$, the variations obey $d\delta/ds = p^{-1} Df(x(s))\,\delta$.
Where the solution contains a root y, $y^2 = Q(s)$, the components of $\delta$ are divided into even and odd ones, the
odd ones written as y times a function; a reverser of the solution makes the coefficients rational then.  The points of
the s plane are those of the curve up to a double covering, which changes the Galois group by a finite group only.
Without such a reverser $\delta = u + y v$ gives twice as many equations: they are solved by the variations for both
signs of y, and their group has an abelian identity component if and only if that of the variations has.

A **flag** is a chain of invariant subspaces $0 = F_0 \subset F_1 \subset \dots \subset F_r = V$, found from

- components that do not influence others (coordinate subspaces),
- solutions that are rational functions of s (each spans a line), and
- linear integrals with such coefficients, $w\cdot\delta$ (each has an invariant kernel).

The matrix P whose first columns span the subspaces is a polynomial one with a constant determinant as far as integrals
and solutions are concerned, so that no new singular points appear at finite s.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import accumulate, product
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly
from sympy.polys.matrices import DomainMatrix
from sympy.utilities.iterables import connected_components, strongly_connected_components

from liepoisson.algebra.echelon import dense, null_vectors, sparse
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import not_a
from liepoisson.integrability.galois.linear_systems import LinearSystem, from_polynomial
from liepoisson.integrability.galois.solutions import Arithmetic, ParticularSolution, degrees
from liepoisson.model.system import System

_MOST_UNKNOWNS = 600
"""Of the search for rational solutions."""


@explains_its_arguments
def variational_equations(system: System, solution: ParticularSolution) -> LinearSystem:
    r"""The variational equations along a solution, with coefficients that are rational functions of its variable.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> equations = lp.integrability.variational_equations(top, lp.integrability.particular_solutions(top)[0])
        >>> [len(part) for part in equations.summands]
        [5, 4]

    Args:
        system: The system.
        solution: A solution of it, as `particular_solution` or `particular_solutions` give it.

    Raises:
        ParameterError: the solution is that of another system.
    """
    if not isinstance(solution, ParticularSolution):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a ParticularSolution", solution, "solution", "write particular_solution(system, ...)")
    same = solution.system is system or (
        solution.system.variables == system.variables and solution.system.equations == system.equations
    )
    if not same:
        raise ParameterError(f"solution: wanted one of {system.name}; got one of {solution.system.name}")
    arithmetic = Arithmetic(solution.variable, solution.root)
    values = [arithmetic.read(f, name) for name, f in solution.state.items()]
    speed = arithmetic.read(solution.rate, "rate")
    powers = [arithmetic.powers(v, d) for v, d in zip(values, degrees(system), strict=True)]
    jacobian: Any = system.jacobian
    n = len(system.variables)
    entries = [[arithmetic.at(jacobian[i, j].expand(), system.variables, powers) for j in range(n)] for i in range(n)]
    names = tuple(f"d{name}" for name in system.component_names)
    if solution.root is None:
        rows = [[entry[0] / speed[0] for entry in row] for row in entries]
        return LinearSystem(solution.variable, DomainMatrix(rows, (n, n), arithmetic.field), names)
    odd = _parities(entries)
    square, c = arithmetic.square, speed[1]
    root = str(solution.root[0])
    if odd is None:
        rows = _doubled(entries, square, c, arithmetic)
        names = (*names, *(f"{name}/{root}" for name in names))
        return LinearSystem(solution.variable, DomainMatrix(rows, (2 * n, 2 * n), arithmetic.field), names)
    rows = []
    for i in range(n):
        row: list[Any] = []
        for j in range(n):
            even_part, odd_part = entries[i][j]
            # (A0 + A1 y) / (c y), between components that are y^odd times a function
            value = odd_part / c if odd[i] == odd[j] else even_part / c / (square if odd[i] else arithmetic.one)
            if i == j and odd[i]:
                value = value - square.diff(arithmetic.s) / (2 * square)
            row.append(value)
        rows.append(row)
    names = tuple(f"{name}/{root}" if odd[k] else name for k, name in enumerate(names))
    return LinearSystem(solution.variable, DomainMatrix(rows, (n, n), arithmetic.field), names)


@dataclass(frozen=True, eq=False)
class Flag:
    r"""A chain of invariant subspaces of a linear system."""

    system: LinearSystem  # the system
    basis: Any  # P; the first columns span the first subspace, and so on
    sizes: tuple[int, ...]  # the dimensions of the quotients of a subspace by the one before it

    @cached_property
    def triangular(self) -> LinearSystem:
        """The equations in this basis, block triangular."""
        return self.system.changed(self.basis)

    @cached_property
    def dimensions(self) -> tuple[int, ...]:
        """The dimensions of F_0, F_1, ..., F_r."""
        return tuple(accumulate(self.sizes, initial=0))

    def quotient(self, low: int, high: int) -> LinearSystem:
        """The equations on F_high / F_low."""
        key = (low, high)
        if key not in self._quotients:
            self._quotients[key] = self.triangular.part(range(self.dimensions[low], self.dimensions[high]))
        return self._quotients[key]

    @cached_property
    def _quotients(self) -> dict[tuple[int, int], LinearSystem]:
        return {}

    @cached_property
    def annihilators(self) -> Any:
        """The inverse of P: a solution lies in F_k if the rows from the dimension of F_k on vanish on it."""
        return self.basis.inv()


def flag(system: LinearSystem) -> Flag:
    """A flag that is as fine as these means give, and verified: the matrix in its basis is block triangular."""
    basis, sizes = _refined(system)
    found = Flag(system, basis, tuple(sizes))
    rows = found.triangular.entries.to_dense().rep.to_list()
    d = found.dimensions
    for k in range(len(sizes)):
        assert not any(rows[i][j] for i in range(d[k + 1], system.n) for j in range(d[k], d[k + 1]))
    return found


def rational_solutions(system: LinearSystem) -> tuple[Any, ...]:
    """A basis of the solutions that are rational functions, columns with polynomial entries up to a common factor.

    It is empty where a singular point is not recognised as regular, which then proves nothing.
    """
    if (bounds := _bounds(system)) is None:
        return ()
    numerators, denominator = system.polynomials
    bottom, top_degree = bounds
    n, count = system.n, top_degree + 1
    if n * count > _MOST_UNKNOWNS:
        return ()
    # y = q / b: d b q' - d b' q - b M q = 0
    columns: list[list[Any]] = []
    height = 0
    for j in range(n):
        for k in range(count):
            power = fmpq_poly([0] * k + [1])
            entries = [-bottom * numerators[i][j] * power for i in range(n)]
            entries[j] += denominator * (bottom * power.derivative() - bottom.derivative() * power)
            columns.append(entries)
            height = max(height, *(e.degree() + 1 for e in entries))
    rows = [[column[i][m] for column in columns] for i in range(n) for m in range(height)]
    reduced, rank = fmpq_mat(rows).rref()
    field = system.entries.domain
    found: list[Any] = []
    for vector in null_vectors(map(sparse, reduced.tolist()[:rank]), n * count, fmpq(1)):
        values = dense(vector, range(n * count), fmpq(0))
        parts = [fmpq_poly(values[j * count : (j + 1) * count]) for j in range(n)]
        column = [[from_polynomial(part, field) / from_polynomial(bottom, field)] for part in parts]
        found.append(DomainMatrix(column, (n, 1), field))
    return tuple(found)


def _bounds(system: LinearSystem) -> tuple[Any, int] | None:
    """A denominator of all rational solutions, and a bound of the degree of their numerators; None if there are none.

    They have integer exponents at each singular point.
    """
    bottom, degree = fmpq_poly([1]), 0
    for point in system.points:
        local = system.local(point)
        if not local.is_regular:
            return None
        whole = [e for e in local.exponents.rational if e.denominator == 1]
        if not whole:
            return None
        pole = int(max(local.weights or ()) - min(whole))
        if point is None:
            degree = pole
        else:
            bottom *= point ** max(pole, 0)
    return None if bottom.degree() + degree < 0 else (bottom, bottom.degree() + degree)


def _refined(system: LinearSystem) -> tuple[Any, list[int]]:
    """P and the dimensions of the quotients of a flag."""
    n, field = system.n, system.entries.domain
    groups = _components(system)
    if len(groups) > 1:
        order = [k for group in groups for k in group]
        permutation = DomainMatrix.eye(n, field).to_dense().extract(list(range(n)), order)
        parts = [_refined(system.part(group)) for group in groups]
        blocks = _block_diagonal([part[0] for part in parts], field)
        return permutation * blocks, [size for _, sizes in parts for size in sizes]
    if n == 1:
        return DomainMatrix.eye(1, field).to_dense(), [1]
    if solutions := rational_solutions(system):
        chosen = solutions[0].hstack(*solutions[1:])
        k = len(solutions)
        basis = _completed(chosen)
        if k == n:
            return basis, [1] * k
        rest = _refined(system.changed(basis).part(range(k, n)))
        blocks = _block_diagonal([DomainMatrix.eye(k, field).to_dense(), rest[0]], field)
        return basis * blocks, [1] * k + rest[1]
    if integrals := rational_solutions(system.dual):
        k = len(integrals)
        chosen = integrals[0].hstack(*integrals[1:])
        # columns 0 .. k-1 of the completed matrix W are the integrals; those of W^-T from k on span their kernel
        dual = _completed(chosen).inv().transpose()
        places = [*range(k, n), *reversed(range(k))]  # the last of them is combined from all
        basis = dual.extract(list(range(n)), places)
        kernel = _refined(system.changed(basis).part(range(n - k)))
        blocks = _block_diagonal([kernel[0], DomainMatrix.eye(k, field).to_dense()], field)
        return basis * blocks, kernel[1] + [1] * k
    return DomainMatrix.eye(n, field).to_dense(), [n]


def _completed(columns: Any) -> Any:
    """An invertible matrix whose first columns span what these columns span, polynomial, with constant determinant.

    Rows are reduced by Euclid's algorithm until the columns are those of the identity; the inverse steps give the
    matrix.
    """
    n, k = columns.shape
    ring = columns.domain.get_ring()
    work = _cleared(columns).to_dense().rep.to_list()
    undo = [[ring.one if i == j else ring.zero for j in range(n)] for i in range(n)]
    for c in range(k):
        while True:
            best = min((i for i in range(c, n) if work[i][c]), key=lambda i: work[i][c].degree())
            work[c], work[best] = work[best], work[c]
            for row in undo:
                row[c], row[best] = row[best], row[c]
            others = [i for i in range(c + 1, n) if work[i][c]]
            if not others:
                break
            for i in others:
                factor = work[i][c].div(work[c][c])[0]
                work[i] = [a - factor * b for a, b in zip(work[i], work[c], strict=True)]
                for row in undo:  # undo * (row i += factor row c): column c gains factor times column i
                    row[c] = row[c] + factor * row[i]
    return DomainMatrix(undo, (n, n), ring).convert_to(columns.domain)


def _cleared(columns: Any) -> Any:
    """Each column times a rational function so that its entries are polynomials without a common divisor."""
    found: list[Any] = []
    for column in columns.transpose().to_dense().rep.to_list():
        common = columns.domain.get_ring().one
        for entry in column:
            common = common.lcm(entry.denom)
        tops = [entry.numer * common.quo(entry.denom) for entry in column]
        divisor = reduce(lambda a, b: a.gcd(b), tops)
        found.append([top.quo(divisor) for top in tops])
    return DomainMatrix(found, columns.shape[::-1], columns.domain.get_ring()).transpose()


def _block_diagonal(blocks: list[Any], field: Any) -> Any:
    n = sum(block.shape[0] for block in blocks)
    rows = [[field.zero] * n for _ in range(n)]
    start = 0
    for block in blocks:
        for i, row in enumerate(block.to_dense().rep.to_list()):
            rows[start + i][start : start + len(row)] = row
        start += block.shape[0]
    return DomainMatrix(rows, (n, n), field)


def _components(system: LinearSystem) -> list[list[int]]:
    """The strongly connected components, those that influence no others first."""
    rows, places = system.entries.to_dense().rep.to_list(), range(system.n)
    influences = [(i, j) for i in places for j in places if rows[j][i]]
    return [sorted(group) for group in strongly_connected_components((list(places), influences))]


def _doubled(entries: list[list[tuple[Any, Any]]], square: Any, c: Any, arithmetic: Arithmetic) -> list[list[Any]]:
    """The equations for u and v, where the variations are u + y v."""
    n, zero = len(entries), arithmetic.zero
    slope = square.diff(arithmetic.s) / (2 * square)
    rows = [[zero] * (2 * n) for _ in range(2 * n)]
    for i in range(n):
        for j in range(n):
            even_part, odd_part = entries[i][j]
            rows[i][j] = rows[n + i][n + j] = odd_part / c
            rows[i][n + j], rows[n + i][j] = even_part / c, even_part / (c * square)
        rows[n + i][n + i] = rows[n + i][n + i] - slope
    return rows


def _parities(entries: list[list[tuple[Any, Any]]]) -> list[bool] | None:
    """Which components are y times a function, so that the coefficients become rational; None if none are."""
    n, odd = len(entries), dict[int, bool]()
    # an even part of an entry joins components of different parity, an odd one those of the same
    joined = [
        ((i, p), (j, p ^ (1 - k)))
        for i, j, p in product(range(n), range(n), (0, 1))
        for k, part in enumerate(entries[i][j])
        if part
    ]
    for group in connected_components((list(product(range(n), (0, 1))), joined)):
        if len({i for i, _ in group}) < len(group):
            return None
        if not min(group)[1]:
            odd |= {i: bool(p) for i, p in group}
    return [odd[k] for k in range(n)]
