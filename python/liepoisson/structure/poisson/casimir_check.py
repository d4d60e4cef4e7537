r"""Whether a function is a Casimir, $J \nabla C = 0$: decided in the field that all generate, or tried at points.

Of rational functions everything is decided.  Other parts, such as exp(x), are taken as independent, so that what
cancels is proved; what does not is tried at random points, in as many digits as its numbers need
(`liepoisson.algebra.decimals`): one point where a component is not zero refutes it, ten where all vanish are no proof,
and the answer says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.decimals import HAVE_VALUES, refuse_sizes, vanishes_at
from liepoisson.algebra.function_fields import RationalFunctions
from liepoisson.errors import BracketError, ParameterError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import listed_names
from liepoisson.structure.certificates import CasimirCertificate
from liepoisson.structure.circles import check_casimirs_on_circles
from liepoisson.structure.coordinates import read_function
from liepoisson.structure.given_functions import listed_functions
from liepoisson.structure.poisson.tensor_entries import N_POINTS

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket


def casimir_certificate(bracket: Bracket, function: Expr) -> CasimirCertificate:
    """The verdict on a function in the variables of the bracket.

    Raises:
        ParameterError: it has to be tried at points, and is defined at none.
    """
    slopes = {j: slope for j, slope in enumerate(bracket.gradient(function)) if slope != 0}
    rows = list(_rows(bracket, slopes))
    functions = _Functions([factor for _, row in rows for term in row for factor in term])
    left = [(i, row) for i, row in rows if functions.sum_of_products(row)]
    if not left:
        return CasimirCertificate(function, True, True, {}, _CANCEL)
    if functions.decides:
        i, row = left[0]
        residual = {bracket.coordinate_names_in_order[i]: _written(row, bracket)}
        return CasimirCertificate(function, False, True, residual, "proved: a bracket with a coordinate is not zero")
    tried = _tried(bracket, function, left)
    return CasimirCertificate(function, True, True, {}, _CANCEL) if tried.holds and _cancel(left) else tried


_CANCEL = "proved: all brackets with coordinates cancel"


def _cancel(rows: Sequence[tuple[int, list[tuple[Any, Any]]]]) -> bool:
    """Whether sums of products vanish in the field that their factors generate: numbers have relations there."""
    field = Coefficients.containing([factor for _, row in rows for term in row for factor in term])
    for _, row in rows:
        checkpoint("the brackets of a function with the coordinates")
        total: Any = field.zero
        for entry, slope in row:
            total = total + field.read(entry) * field.read(slope)
        if not field.vanishes(total):
            return False
    return True


def _written(row: Sequence[tuple[Any, Any]], bracket: Bracket) -> Expr:
    """A sum of products: a polynomial expanded, another function as it stands."""
    from sympy import Add, Mul

    total: Any = Add(*(Mul(*term) for term in row))
    return total.expand() if total.is_polynomial(*bracket.variables) else total


class _Functions:
    """Expressions as rational functions of symbols and of what is no rational function of these, taken as independent.

    Attributes:
        decides: Whether there are symbols only, so that what is not found zero is not zero.
    """

    def __init__(self, expressions: Sequence[Any]) -> None:
        self._parts: dict[Any, str] = {}
        for expression in expressions:
            self._collect(expression)
        self.decides = all(part.is_Symbol for part in self._parts)
        self._field = RationalFunctions([*self._parts.values()])
        gens = self._field.context.gens()
        self._elements: dict[Any, Any] = {
            part: self._field.element(gen) for part, gen in zip(self._parts, gens, strict=True)
        }

    def sum_of_products(self, row: Sequence[tuple[Any, Any]]) -> bool:
        """Whether a sum of products is not found zero."""
        total = self._field.zero
        for first, second in row:
            checkpoint("the brackets of a function with the coordinates")
            total = total + self._read(first) * self._read(second)
        return bool(total)

    def _collect(self, e: Any) -> None:
        if e.is_Rational:
            return
        if e.is_Add or e.is_Mul or (e.is_Pow and e.exp.is_Integer):
            for part in e.args[:1] if e.is_Pow else e.args:
                self._collect(part)
        else:
            self._parts.setdefault(_root(e)[0], f"g{len(self._parts)}")

    def _read(self, e: Any) -> Any:
        if e not in self._elements:
            self._elements[e] = self._made(e)
        return self._elements[e]

    def _made(self, e: Any) -> Any:
        if e.is_Rational:
            return self._field.number(Fraction(int(e.p), int(e.q)))
        if e.is_Add or e.is_Mul:
            total = self._read(e.args[0])
            for part in e.args[1:]:
                total = total + self._read(part) if e.is_Add else total * self._read(part)
            return total
        base, k = (e.base, int(e.exp)) if e.is_Pow and e.exp.is_Integer else _root(e)
        power, element = self._field.one, self._read(base)
        for _ in range(abs(k)):
            power = power * element
        return power if k > 0 else self._field.one / power


def _root(e: Any) -> tuple[Any, int]:
    """A part as an integer power of another one: u^(3/2) of u^(1/2), 1/x^a of x^a, exp(-u) of exp(u)."""
    from sympy import Pow, Rational, exp

    if e.is_Pow and e.exp.is_Rational:
        return Pow(e.base, Rational(1, int(e.exp.q))), int(e.exp.p)
    if e.is_Pow and e.exp.could_extract_minus_sign():
        return Pow(e.base, -e.exp), -1
    if isinstance(e, exp) and e.args[0].could_extract_minus_sign():
        return exp(-cast("Any", e.args[0])), -1
    return e, 1


def _rows(bracket: Bracket, slopes: Mapping[int, Any]) -> Iterator[tuple[int, list[tuple[Any, Any]]]]:
    r"""The sums $\sum_j J_{ij}\,\partial_j C$ that have a term, as pairs of factors."""
    sums: dict[int, list[tuple[Any, Any]]] = {}
    for (i, j), entry in bracket.formulas.entries.items():
        if j in slopes:
            sums.setdefault(i, []).append((entry, slopes[j]))
        if i in slopes:
            sums.setdefault(j, []).append((-entry, slopes[i]))
    yield from sorted(sums.items())


def _tried(bracket: Bracket, function: Expr, rows: Sequence[tuple[int, list[tuple[Any, Any]]]]) -> CasimirCertificate:
    from sympy import Add, Mul

    names = bracket.coordinate_names_in_order
    products: list[tuple[int, list[Any]]] = [(i, [Mul(*term) for term in row]) for i, row in rows]
    symbols = {symbol for _, terms in products for term in terms for symbol in term.free_symbols}
    tried = 0
    for point in _points([*bracket.variables, *symbols]):
        checkpoint("values of the brackets of a function")
        verdicts = [(i, terms, vanishes_at(terms, point)) for i, terms in products]
        if any(vanishes is None for *_, vanishes in verdicts):
            continue
        tried += 1
        for i, terms, vanishes in verdicts:
            if not vanishes:
                found = {names[i]: Add(*terms)}
                return CasimirCertificate(function, False, False, found, "not zero at a random point, in decimals")
    if not tried:
        raise ParameterError(
            f"a function that cannot be decided must {HAVE_VALUES} where coordinates lie between -1 and 1 and it is "
            f"tried; got {function!s:.60}, which is at none of {N_POINTS} points there. Move the coordinates."
        )
    refuse_sizes([term for _, terms in products for term in terms], "a function that cannot be decided")
    return CasimirCertificate(function, True, False, {}, f"tried at {tried} random points, in decimals")


def _points(symbols: Sequence[Any]) -> Iterator[dict[Any, Any]]:
    """Random points, of a fixed seed: all coordinates between 0 and 1 at every other one, else of either sign."""
    from sympy import Rational

    random, ordered = Random(1), sorted(set(symbols), key=str)
    for k in range(N_POINTS):
        yield {s: Rational(random.choice((1, -1)[: 1 + k % 2]) * random.randrange(1, 1000), 1000) for s in ordered}


def certificate_of(bracket: Bracket, given: Any, symbols: Sequence[str]) -> CasimirCertificate:
    """The verdict on a text or an expression.

    Raises:
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: it is neither, or has a part that is like a coordinate and none, or cannot be tried.
    """
    return casimir_certificate(bracket, read_phase_function(bracket, given, symbols, "a function on phase space"))


def read_phase_function(bracket: Bracket, given: Any, symbols: Sequence[str], what: str) -> Expr:
    """A function of the coordinates: a text in the grammar, or an expression.

    Raises:
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: it is neither, or has a part that is like a coordinate and none.
    """
    return read_function(
        bracket, read_expression(given, _scope(bracket, symbols)) if isinstance(given, str) else given, what
    )


def checked_casimirs(bracket: Bracket, given: Any, symbols: Sequence[str] = ()) -> tuple[Expr, ...]:
    """The Casimirs that a caller gives, each checked.

    Raises:
        BracketError: a function is no Casimir, or a constant.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: they are no list of functions, or one is not periodic in an angle.
    """
    items = listed_functions(given, "casimirs", f'["{bracket.coordinate_names_in_order[0]}^2"]')
    found = [read_phase_function(bracket, one, symbols, "a Casimir") for one in items]
    for function in found:
        if not function.free_symbols & {*bracket.variables}:
            raise BracketError(f"a Casimir must depend on the coordinates; got {function}, a constant. Leave it out.")
        if not (certificate := casimir_certificate(bracket, function)).holds:
            raise BracketError(f"a Casimir C must have J grad C = 0; got {certificate!s:.160}. Correct it.")
    check_casimirs_on_circles(bracket, found)
    return tuple(found)


def _scope(bracket: Bracket, symbols: Sequence[str]) -> Scope:
    """The names that a text may use: fields, coordinates, the symbols of the bracket and those that are declared."""
    declared = listed_names(symbols, "symbols")
    if declared is None or not all(isinstance(item, str) for item in declared):
        raise ParameterError(f'symbols must be a list of declarations; got {symbols!r:.60}. Write ["epsilon", "a[3]"].')
    scalars = bracket.coordinate_names_in_order if bracket.has_scalar_fields else ()
    bases = {} if scalars else dict.fromkeys(bracket.field_names, bracket.algebra.basis_names)
    own = Scope(symbols=[str(one) for one in declared]).numbers()
    more = sorted(bracket.symbols - own)
    return Scope(fields=bases, symbols=(*scalars, *(str(one) for one in declared), *more), scalars=scalars)
