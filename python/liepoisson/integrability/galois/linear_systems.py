r"""Linear differential equations $dy/ds = A(s)\,y$ whose coefficients are rational functions over the rational numbers.

A change of variables $y = P z$ gives $z' = (P^{-1}AP - P^{-1}P')z$; the dual equations are $w' = -A^T w$, and a
solution w of them is an integral $w\cdot y$.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from flint import fmpq_poly
from sympy import QQ, Matrix, Symbol, together
from sympy import Symbol as SymPySymbol
from sympy.polys.matrices import DomainMatrix
from sympy.polys.polyerrors import CoercionFailed, PolynomialError
from sympy.utilities.iterables import connected_components

from liepoisson.algebra.exact_numbers import as_expression
from liepoisson.algebra.function_fields import over_common_denominator, root_text
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.parameters import listed_rows
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed, texts
from liepoisson.inputs.refusals import shown
from liepoisson.structure.given_expressions import with_exact_numbers

if TYPE_CHECKING:
    from liepoisson.integrability.galois.local_solutions import LocalSystem

MOST_COMPONENTS = 24
"""Size of the largest system."""


@dataclass(frozen=True, eq=False, repr=False)
class LinearSystem:
    r"""Equations $dy/ds = A(s)\,y$.

    Attributes:
        variable: s.
        entries: A, as a matrix over the field of rational functions.
        names: Names of the components of y.
    """

    variable: Symbol
    entries: Any
    names: tuple[str, ...]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied is the definition: SymPy's rational functions change while they are pickled."""
        return _restored, (self.variable, self.matrix, self.names, self.entries.domain.symbols)

    @property
    def n(self) -> int:
        """The number of components."""
        return len(self.names)

    @cached_property
    def matrix(self) -> Matrix:
        """A, shape (n, n)."""
        return self.entries.to_Matrix()

    @cached_property
    def polynomials(self) -> tuple[list[list[Any]], Any]:
        """A = M/d: the numerators M and the common denominator d, which has leading coefficient 1."""
        rows = [[fraction(entry) for entry in row] for row in self.entries.to_dense().rep.to_list()]
        tops, common = over_common_denominator([entry for row in rows for entry in row], fmpq_poly([1]))
        lead, left = common.leading_coefficient(), iter(tops)
        return [[next(left) / lead for _ in row] for row in rows], common / lead

    @cached_property
    def singular_points(self) -> tuple[Any, ...]:
        """The finite poles of A: monic irreducible polynomials whose roots they are."""
        _, denominator = self.polynomials
        return tuple(sorted((f for f, _ in denominator.factor()[1]), key=lambda f: (f.degree(), str(f))))

    @property
    def points(self) -> tuple[Any, ...]:
        """All singular points, with None for infinity if it is one."""
        return (*self.singular_points, None) if self.infinity_is_singular else self.singular_points

    def part(self, places: Sequence[int]) -> LinearSystem:
        """The equations of some components among themselves."""
        chosen = list(places)
        return LinearSystem(self.variable, self.entries.extract(chosen, chosen), tuple(self.names[k] for k in chosen))

    def changed(self, change: Any) -> LinearSystem:
        """The equations for z with y = P z, where P is an invertible matrix over the rational functions."""
        entries = change.inv() * (self.entries * change - derivative(change))
        return LinearSystem(self.variable, entries, tuple(f"z{k}" for k in range(1, self.n + 1)))

    @cached_property
    def dual(self) -> LinearSystem:
        """The equations of linear integrals."""
        return LinearSystem(self.variable, -self.entries.transpose(), self.names)

    @cached_property
    def at_infinity(self) -> LinearSystem:
        r"""The equations in $p = 1/s$: $dy/dp = -p^{-2} A(1/p)\,y$."""
        field = self.entries.domain
        s = field.gens[0]
        turned = self.entries.applyfunc(lambda entry: -reversed_fraction(entry, field) / s**2)
        return LinearSystem(self.variable, turned, self.names)

    @cached_property
    def infinity_is_singular(self) -> bool:
        """Whether A(1/p)/p^2 has a pole at p = 0."""
        _, denominator = self.at_infinity.polynomials
        return denominator.degree() > 0 and denominator[0] == 0

    def local(self, point: Any = None) -> LocalSystem:
        """The equations near a singular point.

        Args:
            point: An irreducible polynomial whose roots are the points; None for infinity.
        """
        from liepoisson.integrability.galois.local_solutions import LocalSystem

        key = None if point is None else str(point)
        if key not in self._local:
            self._local[key] = LocalSystem(self, point)
        return self._local[key]

    @cached_property
    def _local(self) -> dict[str | None, LocalSystem]:
        return {}

    @cached_property
    def summands(self) -> tuple[tuple[int, ...], ...]:
        """The components in groups that do not influence each other, the smallest partition."""
        rows = self.entries.to_dense().rep.to_list()
        influences = [(i, j) for i, row in enumerate(rows) for j, entry in enumerate(row) if entry]
        groups = connected_components((list(range(self.n)), influences))
        return tuple(sorted(tuple(sorted(group)) for group in groups))

    def __repr__(self) -> str:
        poles = ", ".join(root_text(f, self.variable) for f in self.singular_points)
        places = " and infinity" if self.infinity_is_singular else ""
        return f"<LinearSystem of {self.n} components, singular at {poles or 'no finite point'}{places}>"


@explains_its_arguments
def linear_system(matrix: Any, variable: Symbol, *, names: Sequence[str] | None = None) -> LinearSystem:
    r"""The linear equations $dy/ds = A(s)\,y$ with a matrix of rational functions.

    Example:
        >>> import sympy
        >>> s = sympy.Symbol("s")
        >>> bessel = lp.integrability.linear_system(sympy.Matrix([[0, 1], [4 / s**2 - 1, -1 / s]]), s)
        >>> bessel.local(bessel.singular_points[0]).exponents.text
        '-2, 2'

    Args:
        matrix: A, a SymPy matrix or rows of expressions, numbers or texts: rational functions of the variable with
            rational coefficients; doubles are read as the decimals that they print as.
        variable: The symbol s.
        names: Names of the components of y; y1, y2, ... by default.

    Raises:
        ExpressionError: a text is no formula.
        ShapeError: the matrix is not square, is too large, or has not as many rows as there are names.
        ParameterError: an entry is no rational function of the variable over the rational numbers.
    """
    if not isinstance(variable, SymPySymbol):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"variable: wanted a SymPy symbol; got {shown(variable)}")
    rows = _rows(matrix)
    n = len(rows)
    if {len(row) for row in rows} != {n} or n > MOST_COMPONENTS:
        shape = (n, max(map(len, rows), default=0))
        raise ShapeError(f"matrix must be square with 1 to {MOST_COMPONENTS} rows; got shape {shape}.")
    labels = (
        tuple(f"y{k}" for k in range(1, n + 1))
        if names is None
        else texts(names, "names", "names", 'names=("y", "dy")')
    )
    if len(labels) != n:
        raise ShapeError(f"names must be {n}, one for each row of the matrix; got {len(labels)}.")
    field = QQ.frac_field(variable)
    entries = [[rational_function(exact_expression(e, [variable], "matrix"), field) for e in row] for row in rows]
    return LinearSystem(variable, DomainMatrix(entries, (n, n), field), labels)


def _restored(variable: Symbol, matrix: Any, names: tuple[str, ...], symbols: tuple[Symbol, ...]) -> LinearSystem:
    """The equations of a pickle."""
    field = QQ.frac_field(*symbols)
    entries = [[field.from_sympy(entry) for entry in row] for row in matrix.tolist()]
    return LinearSystem(variable, DomainMatrix(entries, matrix.shape, field), names)


def _rows(matrix: Any) -> list[list[Any]]:
    """The rows of a matrix of SymPy or NumPy, or of lists."""
    given = listed_rows(matrix, "matrix")
    rows = [listed(row, "matrix") for row in given or ()]
    if given is None or any(row is None for row in rows):
        raise ParameterError(f"matrix: wanted a SymPy matrix; got {shown(matrix)}")
    return cast("list[list[Any]]", rows)


def exact_expression(given: Any, symbols: Sequence[Any], where: str) -> Any:
    """A SymPy expression: texts are read as formulas, never as code, and doubles as the decimals that they print as."""
    if isinstance(given, str):
        read: Any = read_expression(given, Scope(symbols=[str(s) for s in symbols]))
        return read.xreplace({Symbol(str(s)): s for s in symbols})
    return with_exact_numbers(as_expression(given, where))


def rational_function(expression: Any, field: Any) -> Any:
    """An element of a field of rational functions."""
    try:
        return field.from_sympy(together(expression))
    except (CoercionFailed, PolynomialError, ValueError, TypeError, AttributeError, ZeroDivisionError):
        raise ParameterError(
            f"wanted a rational function of {field.symbols[0]} with rational coefficients; got {shown(str(expression))}"
        ) from None


def derivative(matrix: Any) -> Any:
    """The derivative of a matrix of rational functions."""
    s = matrix.domain.gens[0]
    return matrix.applyfunc(lambda entry: entry.diff(s))


def fraction(entry: Any) -> tuple[Any, Any]:
    """Numerator and denominator of a rational function as polynomials of FLINT."""
    return _polynomial(entry.numer), _polynomial(entry.denom)


def from_polynomial(polynomial: Any, field: Any) -> Any:
    """A polynomial of FLINT as a rational function."""
    s, value = field.gens[0], field.zero
    for c in reversed(polynomial.coeffs()):
        value = value * s + field(QQ(c.p, c.q))
    return value


def reversed_fraction(entry: Any, field: Any) -> Any:
    """f(1/s) for a rational function f(s)."""
    top, bottom = fraction(entry)
    size = max(top.degree(), bottom.degree(), 0)
    turned = [fmpq_poly([f[size - k] for k in range(size + 1)]) for f in (top, bottom)]
    return from_polynomial(turned[0], field) / from_polynomial(turned[1], field)


def _polynomial(element: Any) -> Any:
    coefficients: list[Any] = list(reversed(element.to_dense())) if element else [0]
    return fmpq_poly([as_fmpq(c) for c in coefficients])
