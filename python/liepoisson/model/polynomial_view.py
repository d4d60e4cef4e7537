"""Systems that consist of rational polynomials: what a run asks of one, without SymPy.

Where the bracket and all parameters are rational numbers and the Hamiltonian is the text of a polynomial, the equations
of motion, the field and the invariants are rational polynomials, too.  They are the same as those that SymPy derives.

Formulas that are polynomials in the coordinates with rational coefficients, as most Hamiltonians and integrals are, are
read without SymPy.  What is anything else, or near to a limit of `liepoisson.formula.expression`, is
left to that module: it alone says what is wrong with a formula.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.rational_polynomials import (
    MOST_TERMS,
    Expanded,
    RationalPolynomial,
    TooLargeError,
    multiplied,
    power_of,
    product_of,
    sum_of,
)
from liepoisson.errors import LiePoissonError
from liepoisson.formula.arithmetic import Arithmetic, RefusedError
from liepoisson.formula.expression import Reader
from liepoisson.formula.grammar import Call, Node, Power, names_in, parse
from liepoisson.formula.parameters import Kept, flattened
from liepoisson.formula.scope import Scope
from liepoisson.formula.tensor_arithmetic import Matrix
from liepoisson.model.hamiltonian import scope_of
from liepoisson.model.known_integrals import known_polynomials

if TYPE_CHECKING:
    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.bracket import Bracket

_MOST_CHARACTERS, _MOST_NESTED, _MOST_BITS, _MOST_POWER = 10_000, 30, 256, 16
_MOST_DEGREE, _MOST_FACTORS, _MOST_BITS_WRITTEN_OUT = 64, 50_000, 2048
"""Far below the limits of formulas, so that none that is refused there is taken here."""
_MATRIX_FUNCTIONS = frozenset({"inv", "dot", "cross", "diag", "transpose", "trace"})


class _OtherKindError(Exception):
    """The formula is no polynomial with rational coefficients, or a large one."""


def read_polynomial(text: str, scope: Scope, coordinates: Sequence[str]) -> RationalPolynomial | None:
    """A formula with the values of the parameters, as a polynomial; None if it is none, or not a small one.

    A polynomial is returned only for a formula that `read_formula` takes and in which every parameter of the formula
    changes the polynomial.

    Args:
        text: The formula.
        scope: The names that it may use.
        coordinates: The names of the coordinates in their order.
    """
    if len(text) > _MOST_CHARACTERS:
        return None
    try:
        tree = parse(text)
        if not _is_plain(tree):
            return None
        return _read(tree, text, scope, coordinates)
    except (_OtherKindError, TooLargeError, RefusedError, LiePoissonError, ZeroDivisionError):
        return None


def occurring(
    text: str, scope: Scope, coordinates: Sequence[str], polynomial: RationalPolynomial
) -> frozenset[str] | None:
    """The parameters with values on which a polynomial depends, as is proved by changing them one by one.

    None if this leaves a parameter open whose name occurs in the formula.
    """
    tree, found = parse(text), set[str]()
    owners = {scope.owner(word) for word in names_in(tree)}
    for name in [name for name in scope.values if name in owners]:
        other = Scope(
            fields=scope.fields,
            parameters={**scope.parameters, name: _other(scope.values[name])},
            symbols=scope.symbols,
            scalars=scope.scalars,
        )
        try:
            changed = _read(tree, text, other, coordinates)
            if changed.expanded == polynomial.expanded:
                return None
        except (_OtherKindError, TooLargeError, RefusedError, LiePoissonError, ZeroDivisionError):
            return None
        found.add(name)
    return frozenset(found)


def _read(tree: Node, text: str, scope: Scope, coordinates: Sequence[str]) -> RationalPolynomial:
    value: Any = _PolynomialReader(text, scope, coordinates).read(tree)
    polynomial = value if isinstance(value, RationalPolynomial) else RationalPolynomial.constant(value)
    if len(polynomial.expanded) > MOST_TERMS:
        raise TooLargeError
    return polynomial


def _other(value: Kept) -> Any:
    """Another value of the same shape: no component vanishes, and no two differ as they did."""
    if isinstance(value, tuple):
        return tuple(_other(item) for item in value)
    if not isinstance(value, Fraction):
        raise _OtherKindError
    return value * Fraction(13, 11) + Fraction(3, 7)


def _is_plain(tree: Node) -> bool:
    """Whether no part of it is nested deeply, an elementary function, or a power with a parameter as exponent."""
    waiting = [(tree, 0)]
    while waiting:
        node, depth = waiting.pop()
        if depth > _MOST_NESTED or (isinstance(node, Call) and node.function not in _MATRIX_FUNCTIONS):
            return False
        if isinstance(node, Power) and names_in(node.children[1]):
            return False
        waiting += [(child, depth + 1) for child in node.children]
    return True


class _PolynomialArithmetic(Arithmetic):
    """Sums, products and powers of Fractions and polynomials."""

    def sum(self, terms: Sequence[Exact]) -> Any:
        return _checked(sum_of(_terms(terms)))

    def product(self, factors: Sequence[Exact]) -> Any:
        return _checked(product_of(_terms(factors)))

    def reciprocal(self, divisor: Exact) -> Any:
        if not isinstance(divisor, Fraction) or divisor == 0:
            raise _OtherKindError
        return 1 / divisor

    def power(self, base: Exact, exponent: Exact) -> Any:
        if not isinstance(exponent, Fraction) or exponent.denominator != 1 or abs(exponent) > _MOST_POWER:
            raise _OtherKindError
        if isinstance(base, Fraction):
            return _checked(RationalPolynomial.constant(base ** int(exponent)))
        if exponent < 0:
            raise _OtherKindError
        return _checked(power_of(_terms([base])[0], int(exponent)))


def _terms(values: Sequence[Any]) -> list[Any]:
    if not all(isinstance(value, (Fraction, RationalPolynomial)) for value in values):
        raise _OtherKindError
    return list(values)


def _checked(result: RationalPolynomial) -> Fraction | RationalPolynomial:
    """The result, as a Fraction if it is a number."""
    if any(_bits(c) > _MOST_BITS for c in result.terms.values()) or result.degree > _MOST_DEGREE:
        raise _OtherKindError
    n_terms, bits = result.written_out
    if n_terms * max(result.degree, 1) > _MOST_FACTORS or bits > _MOST_BITS_WRITTEN_OUT:
        raise _OtherKindError
    if not result:
        return Fraction(0)
    return result.terms.get((), result) if len(result.terms) == 1 else result


def _bits(number: Fraction) -> int:
    return number.numerator.bit_length() + number.denominator.bit_length()


class _PolynomialReader(Reader):
    """Turns a tree into a polynomial in the coordinates, with the values of the parameters."""

    def __init__(self, text: str, scope: Scope, coordinates: Sequence[str]) -> None:
        super().__init__(text, scope, insert_values=True, scalars=_PolynomialArithmetic())
        self._numbers: Mapping[str, int] = {name: number for number, name in enumerate(coordinates)}

    def symbol(self, name: str) -> Any:
        if name not in self._numbers:
            raise _OtherKindError
        return RationalPolynomial.coordinate(self._numbers[name])

    def circle_number(self) -> Exact:
        raise _OtherKindError

    def call(self, node: Call, arguments: Sequence[Any]) -> Any:
        if node.function == "inv" and isinstance(arguments[0], Matrix):  # with symbols it may be refused
            raise _OtherKindError
        return super().call(node, arguments)


class PolynomialView:
    """The rational polynomials of a system.

    Args:
        bracket: The bracket with numbers.
        scope: The names that formulas may use.
        hamiltonian: The Hamiltonian.

    Attributes:
        hamiltonian: The Hamiltonian.
    """

    def __init__(self, bracket: Bracket, scope: Scope, hamiltonian: RationalPolynomial) -> None:
        self._bracket, self._scope = bracket, scope
        self.hamiltonian = hamiltonian

    @classmethod
    def of(cls, symbolic: Bracket, bracket: Bracket, values: Mapping[str, Kept], text: str) -> PolynomialView | None:
        """The view of a system; None where its numbers are not rational or its Hamiltonian is no polynomial.

        Args:
            symbolic: The bracket with names for its parameters.
            bracket: The same with values.
            values: Of the parameters of the bracket and the Hamiltonian.
            text: The Hamiltonian.
        """
        known = flattened(values)
        if not all(isinstance(value, Fraction) for value in known.values()) or not bracket.is_rational:
            return None
        scope, names = scope_of(symbolic, cast("Any", values)), bracket.coordinate_names_in_order
        hamiltonian = read_polynomial(text, scope, names)
        if hamiltonian is None:
            return None
        found = occurring(text, scope, names, hamiltonian)
        if found is None or any(
            name not in found and not symbolic.symbols & set(flattened({name: value})) for name, value in values.items()
        ):
            return None  # a parameter that drops out is refused where SymPy reads the formula
        return cls(bracket, scope, hamiltonian)

    def read(self, text: str) -> RationalPolynomial | None:
        """A formula in the names of the system; None if it is no small polynomial."""
        return read_polynomial(text, self._scope, self._bracket.coordinate_names_in_order)

    @cached_property
    def rates(self) -> tuple[RationalPolynomial, ...] | None:
        """The equations of motion, derived from the bracket; None if they are too large."""
        try:
            return rates_of(self._bracket, self.hamiltonian)
        except TooLargeError:
            return None

    def invariants(
        self, top: TopParameters | None, given: Mapping[str, object]
    ) -> dict[str, RationalPolynomial] | None:
        """What is known to be constant, by name; None where something in it is no rational polynomial, or not constant.

        Args:
            top: The top with these equations.
            given: Further integrals, texts or expressions, which are claims.
        """
        casimirs = self._bracket.polynomial_casimirs()
        known = {} if top is None else known_polynomials(top)
        if self.rates is None or casimirs is None or known is None:
            return None
        found = {"H": self.hamiltonian, **{f"C{k}": casimir for k, casimir in enumerate(casimirs, start=1)}, **known}
        for name, claim in given.items():
            integral = self.read(claim) if isinstance(claim, str) else None
            if integral is None or not self.is_constant(integral):
                return None
            found.setdefault(name, integral)
        return found

    def is_constant(self, function: RationalPolynomial) -> bool | None:
        """Whether the derivative of a function along the motion vanishes; None if it is too large."""
        try:
            return None if self.rates is None else not bracket_with(self.rates, function)
        except TooLargeError:
            return None

    def is_casimir(self, function: RationalPolynomial) -> bool | None:
        """Whether the bracket of a function with every coordinate vanishes; None if one of them is too large."""
        try:
            return not any(rate.expanded for rate in rates_of(self._bracket, function))
        except TooLargeError:
            return None


def rates_of(bracket: Bracket, hamiltonian: RationalPolynomial) -> tuple[RationalPolynomial, ...]:
    r"""$J\nabla H$, one polynomial for each coordinate; the bracket must be rational.

    They are expanded where the Hamiltonian is; a square of a sum in it stays one, whose terms do not cancel.

    Raises:
        TooLargeError: an expanded polynomial has too many terms.
    """
    slopes = [hamiltonian.derivative(k) for k in range(bracket.dimension)]
    rates: list[list[RationalPolynomial]] = [[] for _ in slopes]

    def add(i: int, j: int, factor: RationalPolynomial) -> None:
        own = slopes[j].terms
        parts = [RationalPolynomial({monomial: value}) for monomial, value in own.items()]
        rates[i] += [product_of([factor, part]) for part in parts]

    for i, j, m, c in bracket.entries():
        assert isinstance(c, Fraction)
        add(i, j, product_of([c, RationalPolynomial.coordinate(m)]))
        add(j, i, product_of([-c, RationalPolynomial.coordinate(m)]))
    for (i, j), c in bracket.constant.items():
        assert isinstance(c, Fraction)
        add(i, j, RationalPolynomial.constant(c))
        add(j, i, RationalPolynomial.constant(-c))
    found = tuple(sum_of(rate) for rate in rates)
    for rate in found:
        _ = rate.expanded  # which others ask for, and which refuses what is too large
    return found


def bracket_with(rates: Sequence[RationalPolynomial], function: RationalPolynomial) -> RationalPolynomial:
    r"""$\{f, H\} = \nabla f\cdot\dot x$, expanded, from the rates $\dot x = J\nabla H$.

    Raises:
        TooLargeError: an expanded polynomial has too many terms.
    """
    total: Expanded = {}
    for number in function.coordinates:
        for monomial, value in multiplied(function.derivative(number).expanded, rates[number].expanded).items():
            total[monomial] = total.get(monomial, Fraction(0)) + value
    return RationalPolynomial.of(total)
