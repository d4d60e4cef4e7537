r"""What the cohomology of a Lie algebra is used for: central extensions, derivations, deformations.

A deformation $[x, y]_\epsilon = [x, y] + \sum_k \epsilon^k \mu_k(x, y)$ obeys the Jacobi identity if and only if

$$d\mu_k = \sum_{i+j=k} \mathrm{Jac}(\mu_i, \mu_j) \quad (i, j \ge 1), \qquad
  \mathrm{Jac}(a, b)(x, y, z) = a(b(x, y), z) + \text{cyclic}$$

for all k.  So $\mu_1$ is a 2-cocycle with adjoint coefficients, and the right-hand side is a 3-cocycle whose class is
the obstruction of order k.

References: Nijenhuis and Richardson, Bull. Amer. Math. Soc. 70 (1964) 406, and 72 (1966) 1; Gerstenhaber, Annals of
Math. 79 (1964) 59.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, is_zero, sum_of, symbols_of, to_sympy
from liepoisson.algebra.matrices import solved
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import read_new_symbol
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.formula.tensors import read_names
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import SEARCH_LIMIT, checkpoint
from liepoisson.inputs.given import is_named, listed
from liepoisson.structure.lie.cochains import (
    Cochain,
    Indices,
    Vector,
    check_closed,
    combination,
    field_of,
    read_cochain,
    read_module,
)
from liepoisson.structure.lie.cohomology import AlgebraLike, LieCohomology, cohomology, read_algebra
from liepoisson.structure.lie_algebra import LieAlgebra, joined_names

if TYPE_CHECKING:
    from liepoisson.structure.lie.cohomology import CochainLike

_ONE = Fraction(1)


@explains_its_arguments
def central_extension(
    given: AlgebraLike,
    cocycles: CochainLike | Sequence[CochainLike],
    name: str | None = None,
    central_names: Sequence[str] | None = None,
) -> LieAlgebra:
    r"""The central extension $[x, y]_c = [x, y] + \sum_r f_r(x, y)\,c_r$ by 2-cocycles with trivial coefficients.

    Example:
        >>> galilei = lp.algebras.galilei(3)
        >>> (mass,) = lp.algebras.cohomology(galilei, 2).representatives
        >>> bargmann = lp.algebras.central_extension(galilei, mass, "bargmann", ["M"])
        >>> [str(casimir) for casimir in (bargmann @ lp.trivial()).casimirs(2)]  # the mass, and the internal energy
        ['lM', '-2*lH*lM + lP1**2 + lP2**2 + lP3**2']
        >>> plane = lp.algebras.central_extension(lp.algebras.abelian(2), {("e1", "e2"): 1})
        >>> plane.brackets == lp.algebras.heisenberg(1).brackets
        True

    Args:
        given: A Lie algebra, or a bracket without constant part.
        cocycles: One cocycle or several: cochains, or values by pairs of basis elements, {("K1", "P1"): 1}.
        name: How it is printed.
        central_names: Names of the $c_r$; "c", or "c1", "c2", ... if left out.

    Raises:
        CochainError: one of them is no cocycle; the error names the triple and the residual.
        BracketError: an unknown basis element, or one pair twice.
        ShapeError: not one name per cocycle, or a cochain of another algebra, degree or module.
        ParameterError: an entry is not exact, or a name is that of a basis element.
    """
    algebra = read_algebra(given)
    n, module = algebra.dimension, read_module(algebra, "trivial")
    one = isinstance(cocycles, Cochain) or is_named(cocycles)
    items = [cocycles] if one else listed(cocycles, "cocycles")
    forms = [read_cochain(algebra, module, 2, item, "cocycles") for item in ([cocycles] if items is None else items)]
    if not forms:
        raise ShapeError("cocycles: wanted at least one cocycle; got none. Give one, or several in a list.")
    default = ("c",) if len(forms) == 1 else tuple(f"c{r + 1}" for r in range(len(forms)))
    names = read_names(central_names, "central_names", default)
    if len(names) != len(forms):
        raise ShapeError(f"central_names must be {len(forms)} names; got {len(names)}. Give one per cocycle.")
    own = {*algebra.basis_names, *(f"e{name}" for name in algebra.basis_names)}  # e1 is another way to write "1"
    if central_names is not None and (clash := sorted(own & {*names})):
        raise ParameterError(
            f"central_names: wanted names that no basis element of {algebra.name} has; got {clash[0]!r}. Take another."
        )
    brackets = {pair: dict(row) for pair, row in algebra.brackets.items()}
    for r, form in enumerate(forms):
        check_closed(form)
        for place, row in form.values.items():
            brackets.setdefault((place[0], place[1]), {})[n + r] = row[0]
    if algebra.basis_names == tuple(str(i + 1) for i in range(n)) and central_names is None:
        names = tuple(str(n + r + 1) for r in range(len(forms)))
    return LieAlgebra.from_brackets(
        n + len(forms),
        brackets,
        f"central extension of {algebra.name}" if name is None else name,
        joined_names(algebra.basis_names, names),
        check=False,
    )


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Derivations:
    r"""The derivations of a Lie algebra, $D[x, y] = [Dx, y] + [x, Dy]$, as matrices on its basis.

    Example:
        >>> found = lp.algebras.derivations_of(lp.algebras.heisenberg(1))
        >>> len(found.inner), len(found.outer), found.algebra().dimension
        (2, 4, 6)

    Attributes:
        inner: A basis of the inner ones, some of the $\operatorname{ad}_i$.
        outer: A basis of a complement, one for each dimension of $H^1(g, g)$.
    """

    inner: tuple[ExactMatrix, ...]
    outer: tuple[ExactMatrix, ...]

    @property
    def dimension(self) -> int:
        """The dimension of the space of derivations."""
        return len(self.inner) + len(self.outer)

    def algebra(self) -> LieAlgebra:
        """The Lie algebra of all derivations, inner ones first.

        Raises:
            ShapeError: there are none.
        """
        return LieAlgebra.from_matrices([*self.inner, *self.outer], "Der")

    def __repr__(self) -> str:
        return f"{self.dimension} derivations: {len(self.inner)} inner, {len(self.outer)} outer"


@explains_its_arguments
def derivations_of(given: AlgebraLike, *, time_limit: float = SEARCH_LIMIT) -> Derivations:
    r"""The derivations of a Lie algebra: inner ones, and outer ones that span $H^1(g, g)$.

    Example:
        >>> lp.algebras.derivations_of(lp.algebras.se(3))  # the outer one scales the translations
        7 derivations: 6 inner, 1 outer

    Args:
        given: A Lie algebra, or a bracket without constant part.  Symbols are generic.
        time_limit: Seconds after which the search is given up.

    Raises:
        ParameterError: not an algebra, or the search is too large.
        BracketError: the bracket has a constant part.
        TimeLimitError: the time has passed.
    """
    algebra = read_algebra(given)
    found = cohomology(algebra, 1, "adjoint", time_limit=time_limit)
    module = read_module(algebra, "adjoint")
    field, inner = field_of(algebra, module), list[ExactMatrix]()
    span = Echelon(field)
    for i, rho in enumerate(module.action):
        row = {(a, b): field.read(c) for a, image in enumerate(rho) for b, c in image.items()}
        if span.insert(row):
            inner.append(Cochain(algebra, module, 1, {(a,): image for a, image in enumerate(module.action[i])}).matrix)
    return Derivations(tuple(inner), tuple(one.matrix for one in found.representatives))


@explains_its_methods
@dataclass(frozen=True, eq=False)
class LieDeformation:
    r"""A deformation of a Lie algebra with a given first order, or what obstructs it.

    Example:
        >>> found = lp.algebras.deformation(lp.algebras.se(2), {("t1", "t2"): {"r": 1}})
        >>> found.closes, found.algebra.substitute({"epsilon": 1}).is_semisimple  # a rotation group
        (True, True)

    Attributes:
        cocycle: The first order $\mu_1$ that was asked for.
        coordinates: Its class in the basis `representatives` of $H^2(g, g)$; all zero for a trivial deformation.
        terms: $\mu_1, \mu_2, \dots$ of `representative`.
        closes: Whether the Jacobi identity holds to all orders.
        order: The order in the parameter up to which it holds; of an algebra that closes the degree in it.
        representative: The deformation along the harmonic cocycle of the class, or along the given one if that is a
            deformation as it is; None if it does not close.
        change_of_basis: P with $e'_i = \sum_j$ `P[i][j]` $e_j$, which takes `representative` to `algebra`:
            $P = 1 + \epsilon\varphi$, where the given cocycle is the first order of `representative` plus $d\varphi$.
        algebra: The deformation whose first order is the given cocycle, if it closes; where P is not the identity its
            constants are rational functions of the parameter.
        obstruction: The class in $H^3(g, g)$ that obstructs the next order, by its harmonic cocycle; None if none does.
        decided: Whether it is known that the class closes or that it does not.  An obstruction of order 2 or 3 holds
            for all deformations of the class; one of higher order for the lower orders that were chosen, and the
            orders that were asked for may be too few.
    """

    cocycle: Cochain
    coordinates: tuple[Exact, ...]
    terms: tuple[Cochain, ...]
    closes: bool
    order: int
    representative: LieAlgebra | None
    change_of_basis: ExactMatrix
    algebra: LieAlgebra | None
    obstruction: Cochain | None
    decided: bool

    @property
    def is_trivial(self) -> bool:
        """Whether the first order is a coboundary: `change_of_basis` then takes the algebra itself to `algebra`."""
        return all(map(is_zero, self.coordinates))

    def __str__(self) -> str:
        name = self.cocycle.algebra.name
        if self.closes:
            kind = "trivial deformation" if self.is_trivial else f"deformation of degree {self.order}"
            return f"{kind} of {name}: {self.algebra!r}"
        if self.obstruction is None:
            return f"deformation of {name} to order {self.order}; whether it goes on is undecided"
        end = "" if self.decided else ", for the lower orders that were chosen"
        return f"no deformation of {name} of order {self.order + 1}{end}: obstruction {self.obstruction}"

    def __repr__(self) -> str:
        return str(self)


@explains_its_arguments
def deformation(
    given: AlgebraLike,
    cocycle: CochainLike,
    *,
    parameter: str = "epsilon",
    order: int = 8,
    time_limit: float = SEARCH_LIMIT,
) -> LieDeformation:
    r"""The deformation of a Lie algebra whose first order is a 2-cocycle with adjoint coefficients, order by order.

    A cocycle $\mu_1$ that is no coboundary and has $\mathrm{Jac}(\mu_1, \mu_1) = 0$ is a deformation as it is.
    Otherwise its class is deformed along the harmonic representative; where the equation of an order has no solution,
    multiples of representatives are added to the order below.  A coboundary is undone by a change of basis, which the
    answer carries.

    Example:
        >>> plane = lp.algebras.abelian(2)
        >>> print(lp.algebras.deformation(plane, {("1", "2"): {"1": 1}}).algebra.brackets)
        {(0, 1): {0: epsilon}}

    Args:
        given: A Lie algebra, or a bracket without constant part.
        cocycle: A cochain, or its values by pairs of basis elements, {("t1", "t2"): {"r": 1}}.
        parameter: Name of $\epsilon$.
        order: The largest order that is looked at.
        time_limit: Seconds after which the search is given up.

    Raises:
        CochainError: the cochain is no cocycle; the error names the triple and the residual.
        BracketError: an unknown basis element, one pair twice, or the bracket has a constant part.
        ParameterError: not an algebra, the parameter is a symbol of the algebra, or the search is too large.
        TimeLimitError: the time has passed.

    References: Nijenhuis and Richardson (1966).
    """
    with as_deadline(time_limit).running():
        algebra, most = read_algebra(given), as_count(order, "order", least=1)
        first = read_cochain(algebra, read_module(algebra, "adjoint"), 2, cocycle)
        own = {name for row in first.values.values() for value in row.values() for name in symbols_of(value)}
        parameter = read_new_symbol(parameter, "parameter", own | set(algebra.symbols))
        check_closed(first)
        space = cohomology(algebra, 2, "adjoint", time_limit=time_limit)
        coordinates, potential = space.split(first)
        if not all(map(is_zero, coordinates)) and not _sum_of_squares([(first, first)], first):
            along, potential = first, Cochain(algebra, first.module, 1, {})
        else:
            along = combination(list(zip(coordinates, space.representatives, strict=True)), first)
        series = _Series(space, along)
        series.run(most)
        representative, made = None, None
        P = _near_identity(potential, parameter)
        if series.closes:
            representative = _deformed(algebra, series.terms, parameter)
            made = _in_basis(representative, P, parameter) if potential else representative
        return LieDeformation(
            cocycle=first,
            coordinates=coordinates,
            terms=tuple(series.terms),
            closes=series.closes,
            order=series.order,
            representative=representative,
            change_of_basis=P,
            algebra=made,
            obstruction=series.obstruction,
            decided=series.closes or (series.obstruction is not None and series.order < _LAST_DECIDED),
        )


_LAST_DECIDED = 3
"""Up to this order an obstruction is that of the class: the order below is free only by cocycles, which are tried."""


class _Series:
    """The orders of a deformation, from the first one."""

    def __init__(self, space: LieCohomology, first: Cochain) -> None:
        self.space, self.terms = space, [first]
        self.obstruction: Cochain | None = None
        self.closes = False

    @property
    def order(self) -> int:
        return len(self.terms)

    def run(self, most: int) -> None:
        """Go on until it closes, is obstructed, or has the largest order."""
        while not self._closed():
            if self.order == most:
                return
            checkpoint("the deformation")
            target = self._right_side(self.order + 1)
            term = self._solution(target)
            if term is None:
                self.obstruction = self._class_of(target)
                return
            self.terms.append(term)
        while len(self.terms) > 1 and not self.terms[-1]:
            self.terms.pop()

    def _closed(self) -> bool:
        self.closes = not any(self._right_side(k) for k in range(self.order + 1, 2 * self.order + 1))
        return self.closes

    def _right_side(self, k: int) -> Cochain:
        pairs = [(i, k - i) for i in range(1, k) if i <= self.order and k - i <= self.order]
        return _sum_of_squares([(self.terms[i - 1], self.terms[j - 1]) for i, j in pairs], self.terms[0])

    def _solution(self, target: Cochain) -> Cochain | None:
        of = self.space.complex
        if not target:
            return Cochain(target.algebra, target.module, 2, {})
        if (found := of.solved(target)) is not None:
            return found[1]
        if self.order < 2:
            return None
        first, free = self.terms[0], self.space.representatives
        changes = [_sum_of_squares([(first, one), (one, first)], first) for one in free]
        if (found := of.solved(target, changes)) is None:
            return None
        self.terms[-1] = combination(
            [(_ONE, self.terms[-1]), *((-c, one) for c, one in zip(found[0], free, strict=True))], first
        )
        return found[1]

    def _class_of(self, target: Cochain) -> Cochain:
        space = cohomology(self.space.algebra, 3, "adjoint")
        coordinates, _ = space.split(target)
        return combination(list(zip(coordinates, space.representatives, strict=True)), target)


def _sum_of_squares(pairs: Sequence[tuple[Cochain, Cochain]], like: Cochain) -> Cochain:
    """The sum of Jac(a, b) for some pairs, a 3-cochain."""
    values = [v for pair in pairs for f in pair for row in f.values.values() for v in row.values()]
    field = Coefficients.containing(values)
    total: Vector = {}
    for a, b in pairs:
        _add_square(total, _table(a, field), b, field)
    # of degree 2 in the values, which matters where these have a common power of pi
    written: dict[Indices, dict[int, Exact]] = {}
    for (place, k), value in sorted(total.items()):
        if not field.vanishes(value):
            written.setdefault(place, {})[k] = field.write(value, 2)
    return Cochain(like.algebra, like.module, 3, written)


def _table(cochain: Cochain, field: Coefficients) -> list[dict[int, dict[int, Any]]]:
    """The values of a 2-cochain by both elements, in both orders."""
    found: list[dict[int, dict[int, Any]]] = [{} for _ in range(cochain.algebra.dimension)]
    for (i, j), row in cochain.values.items():
        found[i][j] = {k: field.read(v) for k, v in row.items()}
        found[j][i] = {k: -v for k, v in found[i][j].items()}
    return found


def _add_square(total: Vector, outer: list[dict[int, dict[int, Any]]], inner: Cochain, field: Coefficients) -> None:
    """Add a(b(x, y), z) + cyclic."""
    for (i, j), row in inner.values.items():
        for s, value in row.items():
            first = field.read(value)
            for k, second in outer[s].items():
                if k in (i, j):
                    continue
                place = tuple(sorted((i, j, k)))
                for m, other in second.items():
                    # for i < k < j the cyclic sum has b(e_j, e_i)
                    term = -(first * other) if i < k < j else first * other
                    key = place, m
                    total[key] = total[key] + term if key in total else term


def _deformed(algebra: LieAlgebra, terms: Sequence[Cochain], parameter: str) -> LieAlgebra:
    """The algebra with all orders; the Jacobi identity is verified."""
    from sympy import Symbol

    if not any(terms):
        return algebra
    epsilon = Symbol(parameter)
    brackets = {pair: dict(row) for pair, row in algebra.brackets.items()}
    for k, term in enumerate(terms, start=1):
        for place, row in term.values.items():
            into = brackets.setdefault((place[0], place[1]), {})
            for m, value in row.items():
                more = to_sympy(value) * epsilon**k
                into[m] = sum_of(into[m], more) if m in into else more
    return LieAlgebra.from_brackets(
        algebra.dimension, brackets, f"{algebra.name}, deformed", algebra.basis_names, check=True
    )


def _near_identity(potential: Cochain, parameter: str) -> ExactMatrix:
    r"""The matrix $1 + \epsilon\varphi$, row by row the images of the basis."""
    from sympy import Symbol

    n, unit = potential.algebra.dimension, [_ONE, _ONE - _ONE]
    if not potential:
        return tuple(tuple(unit[i != j] for j in range(n)) for i in range(n))
    epsilon = Symbol(parameter)
    images = [potential.values.get((i,), {}) for i in range(n)]
    return tuple(
        tuple(to_sympy(unit[i != j]) + epsilon * to_sympy(row.get(j, unit[1])) for j in range(n))
        for i, row in enumerate(images)
    )


def _in_basis(algebra: LieAlgebra, P: ExactMatrix, parameter: str) -> LieAlgebra:
    """The same algebra in the basis whose elements are the rows of P."""
    from sympy import Symbol

    n = algebra.dimension
    entries = [v for row in P for v in row]
    constants = [c for row in algebra.brackets.values() for c in row.values()]
    field = Coefficients.containing([*constants, *entries, Symbol(parameter)])
    basis = [[field.read(v) for v in row] for row in P]
    table = {pair: {k: field.read(c) for k, c in row.items()} for pair, row in algebra.brackets.items()}
    right: list[list[Any]] = []
    pairs = [(i, j) for i in range(n) for j in range(i + 1, n)]
    for i, j in pairs:
        total = [field.zero] * n
        for (a, b), row in table.items():
            weight = basis[i][a] * basis[j][b] - basis[i][b] * basis[j][a]
            if weight:
                for k, c in row.items():
                    total[k] = total[k] + weight * c
        right.append(total)
    # the new coordinates y of an element x obey y P = x
    columns = [[basis[i][k] for i in range(n)] for k in range(n)]
    found = solved(columns, [[row[k] for row in right] for k in range(n)], field)
    brackets = {pair: {k: field.write(found[k][r]) for k in range(n) if found[k][r]} for r, pair in enumerate(pairs)}
    return LieAlgebra.from_brackets(
        n, {pair: row for pair, row in brackets.items() if row}, algebra.name, algebra.basis_names, check=False
    )
