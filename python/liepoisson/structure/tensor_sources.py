r"""Poisson tensors from less than all their entries: log-canonical, Nambu, products, in other coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.errors import BracketError, ShapeError
from liepoisson.formula.parameters import GivenValue, Parameter, read_parameter
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import by_name, listed
from liepoisson.inputs.names import check_name
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.circles import angles_among
from liepoisson.structure.given_functions import check_distinct, read_function, read_variables, scope_with
from liepoisson.structure.tensor_bracket import PoissonTensor, tensor_of

if TYPE_CHECKING:
    from sympy import Expr


@explains_its_arguments
def log_canonical(matrix: Sequence[Sequence[Parameter]], variables: Sequence[str] | None = None) -> PoissonTensor:
    r"""The bracket $\{x_i, x_j\} = c_{ij}\, x_i x_j$ of an antisymmetric matrix c, as of Lotka-Volterra systems.

    Every antisymmetric matrix gives one.  With $H = \sum_i (x_i - b_i \log x_i)$ the equations are
    $\dot x_i = x_i \sum_j c_{ij} (x_j - b_j)$.  A null vector k of c gives the Casimir $\prod_j x_j^{k_j}$.

    Example:
        >>> bracket = lp.brackets.log_canonical([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])
        >>> bracket.casimirs()
        [x1*x2*x3]

    Args:
        matrix: c, numbers or names of parameters that stay symbolic, shape (n, n).
        variables: Names of the coordinates; x1, ..., xn by default.

    Raises:
        ShapeError: the matrix is not square, or not one name per row.
        BracketError: it is not antisymmetric, and the message names the entry; or it depends on a coordinate.
        ParameterError: an entry is not exact, or a name is none that a user may choose.

    References: Plank, J. Math. Phys. 36 (1995) 3520.
    """
    rows = [listed(row, "matrix") for row in listed(matrix, "matrix") or []]
    n = len(rows)
    if not n or any(row is None or len(row) != n for row in rows):
        raise ShapeError(f"matrix must have shape (n, n); got {matrix!r:.60}. Give n rows of n numbers.")
    read = [
        [to_sympy(read_parameter(c, f"matrix[{i}][{j}]")) for j, c in enumerate(row or ())]
        for i, row in enumerate(rows)
    ]
    names = read_variables([f"x{k}" for k in range(1, n + 1)] if variables is None else variables)
    if len(names) != n:
        raise ShapeError(f"variables must be {n} names, one per row; got {len(names)}. Name all of them.")
    for i in range(n):
        for j in range(i + 1):
            if not is_zero(cast("Any", read[i][j]) + read[j][i]):
                raise BracketError(
                    f"the matrix must be antisymmetric; got {read[i][j]} at ({i}, {j}) and {read[j][i]} at ({j}, {i}). "
                    "Correct one of them."
                )
    from sympy import Symbol

    x: list[Any] = [Symbol(name) for name in names]
    check_distinct(names, {str(s) for row in read for c in row for s in c.free_symbols})
    entries = {(i, j): read[i][j] * x[i] * x[j] for i in range(n) for j in range(i + 1, n)}
    return tensor_of(names, entries, jacobi="proved")


@explains_its_arguments
def nambu(
    casimir: str | Expr,
    variables: Sequence[str],
    parameters: Mapping[str, GivenValue] | None = None,
    *,
    factor: str | Expr = "1",
    symbols: Sequence[str] = (),
) -> PoissonTensor:
    r"""The Nambu bracket of a function C in three dimensions, $\dot x = f\,\nabla C\times\nabla H$.

    $J = f\,\nabla C\times$, $\{x_1, x_2\} = -f\,\partial C/\partial x_3$, and so on in turn; C is its Casimir,
    whatever the factor f is.  With $C = |x|^2/2$ this is the bracket of so(3).

    Example:
        >>> bracket = lp.brackets.nambu("x^2 + y^2 - z", ["x", "y", "z"])
        >>> bracket.casimirs(), bracket.poisson_tensor()[0, 2]
        ([x**2 + y**2 - z], 2*y)

    Args:
        casimir: C, a function of the three coordinates.
        variables: Their names.
        parameters: Values of other names.
        factor: f.
        symbols: Names that stay symbolic.

    Raises:
        ShapeError: not three names.
        BracketError: C is constant.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: a name is none that a user may choose.

    References: Nambu, Phys. Rev. D 7 (1973) 2405.
    """
    names = read_variables(variables)
    if len(names) != 3:
        raise ShapeError(
            f"variables must be three names; got {len(names)}. A Nambu bracket here has three coordinates."
        )
    scope = scope_with(names, parameters, symbols)
    C, f = (cast("Any", read_function(one, scope, what)) for one, what in ((casimir, "casimir"), (factor, "factor")))
    from sympy import Symbol

    x, y, z = (Symbol(name) for name in names)
    entries = {(0, 1): -f * C.diff(z), (0, 2): f * C.diff(y), (1, 2): -f * C.diff(x)}
    if all(is_zero(entry) for entry in entries.values()):
        raise BracketError(
            f"wanted a function of the three coordinates; got {C} with the factor {f}, whose bracket is 0."
        )
    return tensor_of(names, entries, casimirs=[C], jacobi="proved")


@explains_its_arguments
def product(first: Bracket, second: Bracket) -> PoissonTensor:
    """The bracket of two phase spaces together, in which functions of the one commute with those of the other.

    Example:
        >>> both = lp.brackets.product(lp.so(3) @ lp.trivial(), lp.canonical(1))
        >>> both.coordinate_names_in_order, both.rank()
        (('l1', 'l2', 'l3', 'q1', 'p1'), 4)

    Args:
        first: A bracket.
        second: Another one, whose coordinates have other names.

    Raises:
        ParameterError: one is no bracket.
        BracketError: a coordinate of the one is a coordinate or a parameter of the other, or one has time.
    """
    for given, what in ((first, "first"), (second, "second")):
        if not isinstance(given, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise not_a("a Bracket", given, what, "write for example lp.canonical(1)")
        given.check_without_time("a product")
    own, other = first.coordinate_names_in_order, second.coordinate_names_in_order
    if clash := sorted({*own} & ({*other} | second.symbols) | {*other} & first.symbols):
        raise BracketError(f"a name must stand for one thing; {clash[0]} occurs in both brackets. Use bracket.rename.")
    n = len(own)
    moved = {(i + n, j + n): entry for (i, j), entry in entries_of(second).items()}
    casimirs = [*known_casimirs(first), *known_casimirs(second)]
    made = tensor_of((*own, *other), entries_of(first) | moved, casimirs=casimirs)
    made.angles = (*first.angles, *second.angles)
    return made


def changed(
    bracket: Bracket, variables: Mapping[str, str | Expr], inverse: Mapping[str, str | Expr], *, check: bool
) -> PoissonTensor:
    """A bracket in other coordinates; see `Bracket.in_variables`."""
    from sympy import S, Symbol

    bracket.check_without_time("a bracket in other coordinates")
    old = bracket.coordinate_names_in_order
    given = by_name(variables, "variables", "functions of the coordinates", '{"y": "x + z^2"}')
    new = tuple(check_name(name, "the name of a coordinate") for name in given)
    back = by_name(inverse, "inverse", "functions of the new coordinates", '{"x": "y - z^2"}')
    if {*back} != {*old} or len(new) != len(old):
        missing = next((name for name in old if name not in back), None)
        got = f"{len(new)} new ones" if missing is None else f"none for {missing}"
        raise BracketError(f"wanted as many new coordinates as old ones, {len(old)}, and all of these; got {got}.")
    check_distinct(new, bracket.symbols)
    here, there = (scope_with(names, None, sorted(bracket.symbols)) for names in (old, new))
    forward: list[Any] = [read_function(given[name], here, name) for name in new]
    inserted: Any = {Symbol(name): read_function(back[name], there, name) for name in old}
    real: Any = {Symbol(name): Symbol(name, real=True) for name in (*new, *bracket.symbols)}  # so that log(exp(x)) is x
    for name, function in zip(new, forward, strict=True):
        if not is_zero((found := function.xreplace(inserted).xreplace(real)) - real[Symbol(name)]):
            raise BracketError(
                f"the functions must be inverse to each other; with `inverse` inserted {name} becomes "
                f"{found.expand()!s:.80}. Correct one of them."
            )
    angles = angles_among(dict(zip(new, forward, strict=True)), bracket.angle_variables)
    slopes = [{i: f.diff(Symbol(x)) for i, x in enumerate(old)} for f in forward]
    entries: dict[tuple[int, int], Any] = {}
    for a in range(len(new)):
        for b in range(a + 1, len(new)):
            total: Any = sum(
                (
                    (slopes[a][i] * slopes[b][j] - slopes[a][j] * slopes[b][i]) * J
                    for (i, j), J in entries_of(bracket).items()
                ),
                S.Zero,
            )
            entries[a, b] = _shortened(total.xreplace(inserted), new)
    casimirs = [_shortened(cast("Any", casimir).xreplace(inserted), new) for casimir in known_casimirs(bracket)]
    made = tensor_of(new, entries, casimirs=casimirs, jacobi=None if check else "not checked")
    made.angles = angles
    return made


def entries_of(bracket: Bracket) -> dict[tuple[int, int], Any]:
    """The nonzero entries of any bracket, by (i, j) with i < j."""
    J: Any = bracket.poisson_tensor()
    n = bracket.dimension
    return {(i, j): J[i, j] for i in range(n) for j in range(i + 1, n) if J[i, j] != 0}


def known_casimirs(bracket: Bracket) -> Sequence[Expr]:
    """The Casimirs that are given, or found."""
    if isinstance(bracket, PoissonTensor) and bracket.given_casimirs:
        return bracket.given_casimirs
    return bracket.casimirs()


def _shortened(expression: Any, names: Sequence[str]) -> Any:
    """A polynomial or a rational function in its normal form; any other function as it stands."""
    from sympy import Symbol

    variables = [Symbol(name) for name in names]
    if expression.is_polynomial(*variables):
        return expression.expand()
    return expression.cancel() if expression.is_rational_function(*variables) else expression
