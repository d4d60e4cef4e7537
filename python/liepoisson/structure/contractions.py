r"""Contractions: the limit of a bracket along a one-parameter group of changes of variables, with its functions.

In the basis $e'_\mu = \sum_\nu P_{\mu\nu}(t)\, e_\nu$ A has the products $W(t) = P P\, W P^{-1}$.  For $t \ne 0$
this is the same bracket in the fields $x'_\mu = \sum_\nu P_{\mu\nu} x_\nu$; its limit as t goes to 0, where there is
one, is another one, of which W is a deformation.

A function F of x is one of x' and t.  The first coefficient of its expansion in t is its limit.  Limits of independent
functions may depend on each other; then a relation R between them gives the function $R(F_1, F_2, \dots)$, which
vanishes at t = 0, and whose first coefficient is a new one.  Each step takes at least one power of t from
$dF_1 \wedge dF_2 \wedge \dots$, so it ends with independent limits, unless a relation is of too high a degree.

References: Inönü and Wigner, Proc. Natl. Acad. Sci. 39 (1953) 510; Saletan, J. Math. Phys. 2 (1961) 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from numbers import Integral
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.algebra.linear_algebra import nullspace, rank
from liepoisson.algebra.sparse_polynomials import Polynomial, add_multiple, gradient_at, multiply
from liepoisson.errors import ContractionError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, listed_rows, read_new_symbol, read_parameter
from liepoisson.formula.scalars import as_deadline
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import SEARCH_LIMIT, checkpoint
from liepoisson.inputs.given import is_named, listed, named, sequence
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.circles import angles_among
from liepoisson.structure.cohomology.change_of_basis import in_basis, inverse
from liepoisson.structure.coordinates import read_function
from liepoisson.structure.extension import Extension, Products
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    from sympy import Expr

Weights: TypeAlias = "Sequence[int] | Mapping[str, int]"
"""Powers of t, one for each field or basis element, in order or by name; those left out are 0."""

_LARGEST_WEIGHT = 1000
"""Of the powers of t; with 10^7 polynomials in t took seconds that no limit ended."""
MAX_RELATION = 8
"""The degree up to which relations between limits are looked for, in the coordinates: four times that of a Casimir."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class ContractedBracket:
    r"""A family of brackets and its limit.

    Example:
        >>> found = lp.brackets.contraction(lp.so(3) @ lp.leibniz(3), {"alpha": 1, "beta": 1})
        >>> found.family.extension.products[1, 1], found.contracted.extension.classify().name
        ({2: t}, 'R[x,y]/(x,y)^2')

    Attributes:
        bracket: The bracket itself.
        parameter: The name of t.
        family: The bracket in the new variables, with t as a symbol: for each $t \ne 0$ the same, up to them.
        contracted: Its limit as t goes to 0.
        casimirs: Limits of the Casimirs of the bracket, which are Casimirs of the limit; of those only that are written
            out, and not traces.
        integrals: Limits of the functions that were given.
        origins: What each of these is the limit of: a polynomial in t, the Casimirs C1, C2, ... and the functions F1,
            F2, ..., divided by the power of t with which it begins.
        independent: How many of the limits are proved to be functionally independent.
        is_saturated: Whether as many limits are independent as functions were before.
    """

    bracket: Bracket
    parameter: str
    family: Bracket
    contracted: Bracket
    casimirs: tuple[Expr, ...]
    integrals: tuple[Expr, ...]
    origins: tuple[Expr, ...]
    independent: int
    is_saturated: bool

    def __str__(self) -> str:
        return f"{self.bracket!r} goes to {self.contracted!r} as {self.parameter} goes to 0"

    def __repr__(self) -> str:
        return f"<ContractedBracket: {self}>"


@explains_its_arguments
def contraction(
    bracket: Bracket,
    weights: Weights | None = None,
    *,
    algebra_weights: Weights | None = None,
    matrix: Sequence[Sequence[Parameter]] | None = None,
    integrals: Sequence[Expr] = (),
    parameter: str = "t",
    time_limit: float = SEARCH_LIMIT,
) -> ContractedBracket:
    r"""The limit of a bracket g (x) A as t goes to 0, with the limits of its Casimirs and of integrals.

    Example:
        >>> spheres = lp.so(3) @ (lp.trivial() + lp.trivial())  # so(4), by its two halves
        >>> top = lp.brackets.contraction(spheres, matrix=[[1, 1], [0, "t"]])
        >>> top.contracted.extension.classify().name, top.casimirs
        ('R[x]/(x^2)', (-2*alpha1*l1 - 2*alpha2*l2 - 2*alpha3*l3, alpha1**2 + alpha2**2 + alpha3**2))

    Args:
        bracket: The bracket.
        weights: Field mu is multiplied by $t^{w_\mu}$.
        algebra_weights: Component i of every field is multiplied by $t^{v_i}$, besides.
        matrix: P(t) in place of weights of fields, with rational functions of t as entries, shape (n, n): field mu goes
            to the sum of P[mu][nu] times field nu.
        integrals: Functions of `bracket.variables` that are polynomials, for example first integrals.
        parameter: The name of t.
        time_limit: Seconds, for the limits of functions.

    Raises:
        ContractionError: there is no limit; the error names the product that grows, and how.
        BracketError: a coordinate that is an angle is scaled.
        ParameterError: a weight is not an integer, a name is unknown or taken, P(t) is not invertible, or an integral
            is no polynomial.
        ShapeError: not one weight, or row, for each.
        TimeLimitError: the time limit has passed.
    """
    if not isinstance(bracket, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a Bracket", bracket, "bracket", "write for example so(3) @ leibniz(3)")
    t = read_new_symbol(parameter, "parameter", bracket.symbols | bracket.coordinate_names | {*bracket.field_names})
    rows = _read_matrix(bracket, weights, matrix, t)
    powers = _read_weights(algebra_weights, bracket.algebra.basis_names, "algebra_weights")
    given = sequence(integrals, "integrals", "functions of bracket.variables", "[bracket.variables[0]]")
    with as_deadline(time_limit).running():
        group = _Group(bracket, t, rows, powers)
        functions = [read_function(bracket, function, f"integrals[{k}]") for k, function in enumerate(given)]
        family, limit = group.family(), group.limit()
        casimirs = [c for c in bracket.casimirs() if c.is_polynomial(*bracket.variables)]
        names = [f"C{k + 1}" for k in range(len(casimirs))] + [f"F{k + 1}" for k in range(len(functions))]
        found = _Limits(group, [*casimirs, *functions], names)
        found.saturate()
    limits = found.expressions()
    return ContractedBracket(
        bracket,
        t,
        family,
        limit,
        tuple(limits[: len(casimirs)]),
        tuple(limits[len(casimirs) :]),
        tuple(found.origins),
        found.independent,
        found.independent == found.wanted,
    )


def _read_weights(weights: Weights | None, names: Sequence[str], what: str) -> list[int]:
    if weights is None:
        return [0] * len(names)
    if is_named(weights):
        given = named(weights, what) or {}
        if wrong := [name for name in given if name not in names]:
            raise ParameterError(
                f"{what}: wanted the names {', '.join(names)}; got {wrong[0]!r:.60}. Correct the name."
            )
        items: list[Any] = [given.get(name, 0) for name in names]
    else:
        found = listed(weights, what, list(names))
        if found is None or len(found) != len(names):
            got = repr(weights) if found is None else f"{len(found)}"
            raise ShapeError(
                f"{what} must be {len(names)} integers; got {got:.60}. Give one for each of {', '.join(names)}."
            )
        items = found
    for value in items:
        if isinstance(value, bool) or not isinstance(value, Integral):
            raise ParameterError(
                f"{what}: wanted integers, the powers of t; got {value!r:.60}. Multiply all by one number."
            )
        if abs(int(value)) > _LARGEST_WEIGHT:
            raise ParameterError(
                f"{what}: wanted integers from {-_LARGEST_WEIGHT} to {_LARGEST_WEIGHT}; got {value}. Divide all by "
                "one number."
            )
    return [int(value) for value in items]


def _read_matrix(
    bracket: Bracket, weights: Weights | None, matrix: Sequence[Sequence[Parameter]] | None, t: str
) -> list[list[Any]]:
    from sympy import S, Symbol, cancel

    n = bracket.extension.dimension
    if matrix is None:
        powers = _read_weights(weights, bracket.field_names, "weights")
        return [[Symbol(t) ** power if i == j else S.Zero for j in range(n)] for i, power in enumerate(powers)]
    if weights is not None:
        raise ParameterError("a contraction takes weights or a matrix; got both. Leave one of them out.")
    rows = [listed(row, "matrix") for row in listed_rows(matrix, "matrix") or []]
    if len(rows) != n or any(row is None or len(row) != n for row in rows):
        raise ShapeError(f"matrix must have shape ({n}, {n}), one row per field; got {matrix!r:.60}.")
    read: list[list[Any]] = [
        [cancel(to_sympy(read_parameter(value, f"matrix[{i}][{j}]"))) for j, value in enumerate(row or [])]
        for i, row in enumerate(rows)
    ]
    taken = bracket.coordinate_names | {*bracket.field_names}
    for row in read:
        for value in row:
            if wrong := sorted({str(s) for s in value.free_symbols} & taken):
                raise ParameterError(
                    f"matrix: wanted functions of {t} and of symbols; got {wrong[0]}, a coordinate or field. Rename it."
                )
            if not value.is_rational_function(Symbol(t)):
                raise ParameterError(f"matrix: wanted rational functions of {t}; got {value}. Write powers of {t}.")
    return read


class _Group:
    """The change of variables with the parameter t, and what it makes of the bracket."""

    def __init__(self, bracket: Bracket, t: str, rows: list[list[Any]], powers: list[int]) -> None:
        from sympy import Symbol

        self.bracket, self.powers, self.t = bracket, powers, Symbol(t)
        self.rows = rows
        self._exact = [[read_parameter(value, "matrix") for value in row] for row in rows]
        try:
            inverted = inverse(self._exact)
        except ParameterError:
            raise ParameterError(
                f"matrix must be invertible for {t} != 0; got a determinant of 0. Correct its rows."
            ) from None
        self.inverse = [[to_sympy(value) for value in row] for row in inverted]

    @cached_property
    def products(self) -> dict[tuple[int, int, int], Any]:
        """W(t), its entries that are not zero."""
        moved = in_basis(self.bracket.extension.products, self._exact)
        return {(i, j, k): to_sympy(value) for (i, j), row in moved.items() for k, value in row.items()}

    def brackets(self) -> dict[tuple[int, int, int], tuple[Exact, int]]:
        """The structure constants of g, each with the power of t that it is multiplied by."""
        v = self.powers
        return {
            (i, j, k): (value, v[i] + v[j] - v[k])
            for (i, j), row in self.bracket.algebra.brackets.items()
            for k, value in row.items()
        }

    def constants(self) -> dict[tuple[int, int], Any]:
        """The constant part as a function of t."""
        n, found = self.bracket.algebra.dimension, dict[tuple[int, int], Any]()
        for (i, j), value in self.bracket.constant.items():
            (a, k), (b, m) = divmod(i, n), divmod(j, n)
            for mu in range(len(self.rows)):
                for nu in range(len(self.rows)):
                    pair = (mu * n + k, nu * n + m)
                    sign = 1 if pair[0] < pair[1] else -1
                    factor = self.rows[mu][a] * self.rows[nu][b] * self.t ** (self.powers[k] + self.powers[m])
                    if factor != 0 and pair[0] != pair[1]:
                        key = (min(pair), max(pair))
                        found[key] = found.get(key, 0) + sign * factor * to_sympy(value)
        return {pair: value for pair, entry in found.items() if (value := entry.cancel()) != 0}

    def family(self) -> Bracket:
        """The bracket in the new variables."""
        rows: dict[tuple[int, int], dict[int, Any]] = {}
        for (i, j, k), value in self.products.items():
            rows.setdefault((i, j), {})[k] = value
        brackets: dict[tuple[int, int], dict[int, Any]] = {}
        for (i, j, k), (value, power) in self.brackets().items():
            brackets.setdefault((i, j), {})[k] = value if not power else to_sympy(value) * self.t**power
        return self._bracket(rows, brackets, self.constants(), f" at {self.t}")

    @cached_property
    def angles(self) -> tuple[str, ...]:
        """The angles of the new variables.

        Raises:
            BracketError: one is scaled, and is none any more.
        """
        x, n = self.bracket.variables, self.bracket.algebra.dimension
        moved: dict[str, Any] = {
            str(x[mu * n + k]): sum(p * self.t**power * x[nu * n + k] for nu, p in enumerate(row))
            for mu, row in enumerate(self.rows)
            for k, power in enumerate(self.powers)
        }
        return angles_among(moved, self.bracket.angle_variables)

    def _bracket(self, products: Any, brackets: Any, constant: Any, suffix: str) -> Bracket:
        old, extension = self.bracket.algebra, self.bracket.extension
        algebra = old
        if any(self.powers) or not brackets:
            name = f"{old.name}{suffix}"
            algebra = LieAlgebra.from_brackets(old.dimension, brackets, name, old.basis_names, check=False)
        A = Extension.from_products(
            extension.dimension, products, f"{extension.name}{suffix}", extension.field_names, check=False
        )
        made = Bracket(algebra, A, self.bracket.field_names, constant=constant, check=False)
        return made.with_angles(self.angles)

    def limit(self) -> Bracket:
        """The limit as t goes to 0.

        Raises:
            ContractionError: there is none.
        """
        from sympy import Mul

        W = {key: _leading(value, self.t) for key, value in self.products.items()}
        c = self.brackets()
        first = min((power for _, power in W.values()), default=0)
        second = min((power for _, power in c.values()), default=0)
        if W and c and first + second < 0:
            i, j, k = min(key for key, (_, power) in W.items() if power == first)
            a, b, m = min(key for key, (_, power) in c.items() if power == second)
            parts = [f"e_{i} e_{j} along e_{k} like {self.t}^{first}"] if first else []
            basis = self.bracket.algebra.basis_names
            parts += [f"[{basis[a]}, {basis[b]}] along {basis[m]} like {self.t}^{second}"] if second else []
            raise ContractionError(" and ".join(parts), first + second)
        vanishes = first + second > 0
        products: Products = {}
        for (i, j, k), (value, power) in W.items():
            if power == first:
                products.setdefault((i, j), {})[k] = read_parameter(value, "W")
        brackets: dict[tuple[int, int], dict[int, Any]] = {}
        for (i, j, k), (value, power) in c.items():
            if power == second and not vanishes:
                brackets.setdefault((i, j), {})[k] = value
        constant: dict[tuple[int, int], Any] = {}
        for (i, j), entry in self.constants().items():
            value, power = _leading(entry, self.t)
            if power < 0:
                names = self.bracket.coordinate_names_in_order
                raise ContractionError(f"the constant part of {names[i]} and {names[j]} like {self.t}^{power}", power)
            if power == 0:
                constant[i, j] = Mul(value)
        return self._bracket(products, brackets, constant, ", contracted")

    def moved(self, function: Expr) -> Any:
        """A function in the new variables, times a power of t, as a polynomial in them and t."""
        n, variables = self.bracket.algebra.dimension, self.bracket.variables
        images: dict[Any, Any] = {}
        for k, x in enumerate(variables):
            mu, i = divmod(k, n)
            terms = [self.inverse[mu][nu] * variables[nu * n + i] for nu in range(len(self.rows))]
            images[x] = sum(terms, 0 * x) * self.t ** -self.powers[i]
        return function.subs(images, simultaneous=True)


def _leading(value: Any, t: Any) -> tuple[Any, int]:
    """The first coefficient of a rational function at t = 0, and its power."""
    from sympy import Poly, fraction

    above, below = (Poly(part, t) for part in fraction(value.cancel()))
    (top,), (bottom,) = min(above.monoms()), min(below.monoms())
    return (above.coeff_monomial(t**top) / below.coeff_monomial(t**bottom)).cancel(), top - bottom


class _Limits:
    """Functions of x' and t, polynomials that do not vanish at t = 0, and their values there."""

    def __init__(self, group: _Group, functions: Sequence[Expr], names: Sequence[str]) -> None:
        from sympy import Symbol

        self.variables, self.t = group.bracket.variables, group.t
        moved = [self._polynomial(group.moved(function), function) for function in functions]
        own = [value for polynomial, _ in moved for value in polynomial.values()]
        self.field = Coefficients.containing([read_parameter(value, "a coefficient") for value in own])
        read = [{m: self.field.read(read_parameter(c, "")) for m, c in polynomial.items()} for polynomial, _ in moved]
        self.functions, self.origins = [], list[Any]()
        for polynomial, name, (_, factor) in zip(read, names, moved, strict=True):
            self._take(polynomial, factor * Symbol(name))
        self.wanted = self._rank([self._at(f, self.field.number(Fraction(3, 7))) for f in self.functions])
        self.independent = self._rank(self.limits)

    def _polynomial(self, moved: Any, function: Any) -> tuple[dict[tuple[int, ...], Any], Any]:
        """A function as a polynomial in the coordinates and t, and what it was multiplied by for that."""
        from sympy import Poly, PolynomialError, fraction, together

        above, below = fraction(together(moved))
        if below.free_symbols & {*self.variables}:
            raise ParameterError(f"integrals: wanted polynomials in the coordinates; got {function}. Leave it out.")
        try:
            poly, content = Poly(above, *self.variables, self.t), Poly(below, self.t).LC()
        except PolynomialError:
            raise ParameterError(
                f"integrals: wanted polynomials in the coordinates; got {function}. Leave it out."
            ) from None
        return {m: c / content for m, c in poly.terms()}, (below / content).expand()

    def _take(self, polynomial: Polynomial, origin: Any, place: int | None = None) -> None:
        """Divide by the power of t, and keep the function."""
        power = min(m[-1] for m in polynomial)
        found = {(*m[:-1], m[-1] - power): c for m, c in polynomial.items()}
        divided = (origin / self.t**power).expand()
        if place is None:
            self.functions.append(found)
            self.origins.append(divided)
        else:
            self.functions[place], self.origins[place] = found, divided

    @property
    def limits(self) -> list[Polynomial]:
        """The functions at t = 0, as polynomials in the coordinates."""
        return [{m[:-1]: c for m, c in f.items() if not m[-1]} for f in self.functions]

    def _at(self, f: Polynomial, t: Any) -> Polynomial:
        """The function at a value of t, of which nothing is special."""
        total: Polynomial = {}
        for m, c in f.items():
            factor = self.field.one
            for _ in range(m[-1]):
                factor = factor * t
            add_multiple(total, {m[:-1]: c}, factor)
        return total

    def _rank(self, polynomials: Sequence[Polynomial]) -> int:
        """How many are independent at one point, which bounds the number of independent ones from below."""
        point = [self.field.number((7 * k * k + 3 * k + 2) % 31 - 15) for k in range(len(self.variables))]
        rows = [gradient_at(polynomial, point) for polynomial in polynomials]
        return rank([row for row in rows if row], self.field)

    def saturate(self) -> None:
        """Replace functions by polynomials in them until the limits are as independent as the functions are."""
        while self.independent < self.wanted:
            checkpoint("the limits of functions")
            if (relation := self._relation()) is None:
                return
            terms, place = relation
            total: Polynomial = {}
            origin: Any = 0
            for powers, value in terms.items():
                product: Polynomial = {(0,) * (len(self.variables) + 1): value}
                name: Any = self.field.to_sympy(value)
                for k, power in enumerate(powers):
                    for _ in range(power):
                        product = multiply(product, self.functions[k])
                        name = name * self.origins[k]
                add_multiple(total, product, self.field.one)
                origin = origin + name
            if not total:
                return
            self._take(total, origin, place)
            self.independent = self._rank(self.limits)

    def _relation(self) -> tuple[dict[tuple[int, ...], Any], int] | None:
        """A relation between the limits of the least degree, and a function in it."""
        limits = self.limits
        degrees = [max(sum(m) for m in limit) for limit in limits]
        for most in range(1, MAX_RELATION + 1):
            monomials = [powers for powers in _monomials(degrees, most) if any(powers)]
            columns: list[Polynomial] = []
            for powers in monomials:
                product: Polynomial = {(0,) * len(self.variables): self.field.one}
                for k, power in enumerate(powers):
                    for _ in range(power):
                        product = multiply(product, limits[k])
                columns.append(product)
            rows: dict[Any, dict[int, Any]] = {}
            for column, product in enumerate(columns):
                for m, value in product.items():
                    rows.setdefault(m, {})[column] = value
            for vector in nullspace(list(rows.values()), len(monomials), self.field).vectors:
                terms = {monomials[column]: value for column, value in vector.items()}
                involved = [k for k in range(len(limits)) if any(powers[k] for powers in terms)]
                return terms, involved[0]
        return None

    def expressions(self) -> list[Any]:
        """The limits as expressions."""
        from sympy import Add, Mul

        return [
            Add(
                *(
                    Mul(self.field.to_sympy(c), *(x**k for x, k in zip(self.variables, m, strict=True)))
                    for m, c in limit.items()
                )
            )
            for limit in self.limits
        ]


def _monomials(degrees: Sequence[int], most: int) -> list[tuple[int, ...]]:
    """The powers of functions of these degrees whose product has at most a degree."""
    found: list[tuple[int, ...]] = [()]
    for degree in degrees:
        found = [
            (*powers, k)
            for powers in found
            for k in range(most // max(degree, 1) + 1)
            if sum(p * d for p, d in zip((*powers, k), degrees, strict=False)) <= most
        ]
    return sorted(found, key=lambda powers: (sum(p * d for p, d in zip(powers, degrees, strict=True)), powers))
