r"""The entries of L and M: what users write, and exact arithmetic with it.

An entry is a polynomial in the coordinates, in the parameters and their inverses, in the spectral parameter z and
1/z, in exponentials of the coordinates, and in $i = \sqrt{-1}$, with rational coefficients.  For the arithmetic each of
these is a variable of FLINT, inverses too; products are brought to a canonical form afterwards, $s\,s^{-1} = 1$ and
$i^2 = -1$.  Entries with other numbers, such as $\sqrt 2$, are SymPy expressions that are expanded.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import lcm
from typing import Any, TypeAlias, cast

from flint import Ordering, fmpq_mpoly_ctx
from sympy import Add, E, Expr, I, Mul, Rational, S, Symbol, collect, exp

from liepoisson.algebra.exact_numbers import is_zero, substituted, symbols_of, to_sympy
from liepoisson.algebra.flint_pickles import register
from liepoisson.algebra.matrices import Rows, characteristic_polynomial, product
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.grammar import parse
from liepoisson.formula.parameters import listed_rows
from liepoisson.inputs.given import listed
from liepoisson.inputs.names import check_name
from liepoisson.inputs.refusals import shown
from liepoisson.model.hamiltonian import scope_of
from liepoisson.model.system import System
from liepoisson.structure.given_expressions import read_expression_in, with_exact_numbers

Element: TypeAlias = Any
"""A polynomial of FLINT, or a SymPy expression."""

IMAGINARY = "i"
"""The name of the imaginary unit in texts, unless the system has something of this name."""

_DIRECTION = "lax_direction"
_RESERVED = {IMAGINARY, "w"}


def spectral_symbol(system: System, spectral: str | None) -> Symbol | None:
    """The symbol of the spectral parameter, a name that means nothing else in the system."""
    if spectral is None:
        return None
    name = str(spectral)
    check_name(name)
    taken = {str(s) for s in system.hamiltonian.free_symbols} | set(system.values) | system.symbolic_bracket.symbols
    if name in {*system.component_names, *system.bracket.field_names, *taken, *_RESERVED}:
        raise ParameterError(
            f"spectral: wanted a name that the system does not use; got {shown(name)}; write for example "
            'spectral="lam" (w is the eigenvalue and i the imaginary unit)'
        )
    return Symbol(name)


def read_entries(system: System, given: Any, spectral: Symbol | None, what: str) -> list[Expr] | list[list[Expr]]:
    """The rows of a matrix, or the components of an element of the Lie algebra."""
    reader = _Reader(system, spectral, what)
    if isinstance(given, str):
        return reader.vector(given)
    rows = listed_rows(given, what)
    if rows is None:
        raise ShapeError(f"{what}: wanted rows of a matrix or the components of a vector; got {shown(given)}")
    entries = [r if (inner := listed(r, what)) is None else inner for r in rows]
    if any(isinstance(r, list) for r in entries):
        if {len(r) if isinstance(r, list) else 0 for r in entries} == {1} and len(entries) > 1:  # a column
            return reader.components([r[0] for r in entries])
        if any(not isinstance(r, list) or len(r) != len(entries) for r in entries):
            raise ShapeError(
                f"{what}: wanted a square matrix, {len(entries)} rows of {len(entries)} entries; got {shown(given)}"
            )
        return [[reader.scalar(entry) for entry in row] for row in entries]
    return reader.components(entries)


class _Reader:
    def __init__(self, system: System, spectral: Symbol | None, what: str) -> None:

        self.system, self.what = system, what
        self.size = system.bracket.algebra.dimension
        names = [] if spectral is None else [str(spectral)]
        declared = (*system.as_given.symbols, *names)
        known = scope_of(system.symbolic_bracket, system.values, declared)
        in_values = set[str]().union(*map(symbols_of, system.parameters.values()))
        self.names = sorted((known.numbers() | in_values).difference(system.component_names))
        self.has_unit = known.owner(IMAGINARY) is None
        self.declared = (*declared, IMAGINARY) if self.has_unit else declared
        self.spectral = spectral

    def scalar(self, given: Any) -> Expr:
        """One entry."""
        if isinstance(given, str):
            return self._text(given, ())
        parameters = self.system.parameters
        entry: Any = read_expression_in(given, self.system.component_names, self.names, parameters)
        own = {s: self.spectral for s in entry.free_symbols if str(s) == str(self.spectral) and s != self.spectral}
        exact = self.system.bracket.in_own_variables(with_exact_numbers(entry.xreplace(own)))
        return to_sympy(substituted(exact, parameters)).expand()

    def components(self, given: Sequence[Any]) -> list[Expr]:
        """The components of an element of the algebra."""
        if len(given) != self.size:
            raise ShapeError(
                f"{self.what}: wanted the {self.size} components of an element of {self.system.bracket.algebra.name}, "
                f"or the rows of a matrix; got {len(given)} entries"
            )
        return [self.scalar(entry) for entry in given]

    def vector(self, text: str) -> list[Expr]:
        """The components of a text such as "z*l + alpha"."""
        if self.system.bracket.has_scalar_fields:
            raise ShapeError(f"{self.what}: the fields of this system are scalars; got {shown(text)}; give a matrix")
        directions = [Symbol(f"{_DIRECTION}{k + 1}") for k in range(self.size)]
        form = self._text(text, (f"{_DIRECTION}[{self.size}]",))
        return [cast("Expr", form.coeff(d)) for d in directions]

    def _text(self, text: str, further: tuple[str, ...]) -> Expr:
        parse(text)  # what is no formula is refused as it was written
        scope = scope_of(self.system.symbolic_bracket, self.system.values, (*self.declared, *further))
        try:
            read: Any = read_expression(f"dot({text}, {_DIRECTION})" if further else text, scope, insert_values=True)
        except ExpressionError as error:
            if not further:
                raise
            message = error.message.replace(f", {_DIRECTION}", "")  # which users have not written
            if "dot" in message:
                message = f"{self.what} must be a matrix, or an element of {self.system.bracket.algebra.name}"
            raise ExpressionError(message, text, max(error.position - len("dot("), 0)) from None
        return (read.xreplace({Symbol(IMAGINARY): I}) if self.has_unit else read).expand()


class EntryArithmetic:
    """Sums, products and canonical forms of entries."""

    def __init__(self, expressions: Iterable[Expr]) -> None:
        register()  # pairs keep their entries
        expanded = [e.expand() for e in expressions]
        self.steps = _steps(expanded)
        self.context: Any = None
        terms = [_terms(e, self.steps) for e in expanded]
        self.is_rational = all(t is not None for t in terms)
        if not self.is_rational:
            return
        signs = {(key, power > 0) for t in terms for powers in cast("Any", t) for key, power in powers}
        # each variable of FLINT is a symbol, an exponential or i, or its inverse
        self.variables = sorted(signs, key=str)
        self.index = {variable: k for k, variable in enumerate(self.variables)}
        self.pairs = [
            (k, self.index[key, False]) for (key, up), k in self.index.items() if up and (key, False) in signs
        ]
        self.unit = self.index.get((I, True))
        names = [f"g{k}" for k in range(len(self.variables))]
        self.context = fmpq_mpoly_ctx.get(names or ["g"], Ordering.lex)

    def read(self, expression: Expr) -> Element:
        """An entry as an element."""
        if not self.is_rational:
            return expression.expand()
        return self._made(cast("Any", _terms(expression.expand(), self.steps)))

    def number(self, value: Fraction | int) -> Element:
        """A rational number."""
        if not self.is_rational:
            return Rational(value.numerator, value.denominator)
        return self.context.constant(as_fmpq(value))

    def canonical(self, element: Element) -> Element:
        """The same element; it is zero only if this is."""
        if not self.is_rational:
            return element.expand()
        return self.context.from_dict(self._exponents(element))

    def vanishes(self, element: Element) -> bool:
        """Whether an element is zero."""
        if not self.is_rational:
            return is_zero(element)
        return not self.canonical(element)

    def write(self, element: Element) -> Expr:
        """An element as an expression."""
        if not self.is_rational:
            return element.expand()
        terms: list[Any] = []
        for exponents, c in self._exponents(element).items():
            exponent: Any = 0
            factors: list[Any] = [Rational(int(c.p), int(c.q))]
            for (key, up), n in zip(self.variables, exponents, strict=False):
                power = int(n) if up else -int(n)
                if n and isinstance(key, tuple):
                    exponent += key[1] * Rational(power, self.steps[key[1]])
                elif n:
                    factors.append(key**power)
            terms.append(Mul(*factors, exp(exponent)) if exponent else Mul(*factors))
        return Add(*terms)

    def commutator(self, first: Rows, second: Rows) -> list[list[Element]]:
        """The matrix AB - BA."""
        zero = self.number(0)
        ab, ba = product(first, second, zero, self.canonical), product(second, first, zero, self.canonical)
        return [[x - y for x, y in zip(r, s, strict=True)] for r, s in zip(ab, ba, strict=True)]

    def characteristic_coefficients(self, matrix: Rows) -> list[Element]:
        r"""The coefficients $c_k$ of $\det(w - A) = \sum_k c_k w^{n-k}$, with $c_0 = 1$."""
        return characteristic_polynomial(matrix, self.number, self.canonical)[::-1]

    def by_power(self, element: Element, symbol: Any) -> dict[int, Element]:
        """The coefficients of the powers of a symbol, negative ones too."""
        if not self.is_rational:
            found: Any = collect(element.expand(), symbol, evaluate=False)
            return {int(power.as_base_exp()[1]) if power != 1 else 0: c for power, c in found.items()}
        up, down = self.index.get((symbol, True)), self.index.get((symbol, False))
        split: dict[int, dict[Any, Any]] = {}
        for exponents, c in self._exponents(element).items():
            n = (0 if up is None else exponents[up]) - (0 if down is None else exponents[down])
            rest = tuple(0 if k in (up, down) else e for k, e in enumerate(exponents))
            split.setdefault(n, {})[rest] = c
        return {n: self.context.from_dict(terms) for n, terms in split.items()}

    def parts(self, element: Element) -> tuple[Element, Element]:
        """Real and imaginary part, symbols being real."""
        if not self.is_rational:
            expanded = element.expand()
            imaginary = expanded.coeff(I)
            return (expanded - I * imaginary).expand(), imaginary
        found = self.by_power(element, I)
        return found.get(0, self.number(0)), found.get(1, self.number(0))

    def _exponents(self, element: Element) -> dict[tuple[int, ...], Any]:
        r"""The terms by their exponents, with $s\,s^{-1} = 1$ and $i^2 = -1$."""
        found: dict[tuple[int, ...], Any] = {}
        for exponents, coefficient in element.terms():
            reduced, value = list(exponents), coefficient
            for up, down in self.pairs:
                common = min(reduced[up], reduced[down])
                reduced[up] -= common
                reduced[down] -= common
            if self.unit is not None:
                value = -coefficient if reduced[self.unit] % 4 > 1 else coefficient
                reduced[self.unit] %= 2
            key = tuple(reduced)
            found[key] = found[key] + value if key in found else value
        return {key: c for key, c in found.items() if c}

    def _made(self, terms: Mapping[tuple[tuple[Any, int], ...], Any]) -> Element:
        n = len(self.variables) or 1
        data: dict[tuple[int, ...], Any] = {}
        for powers, coefficient in terms.items():
            exponents = [0] * n
            for key, power in powers:
                exponents[self.index[key, power > 0]] = abs(power)
            data[tuple(exponents)] = as_fmpq(coefficient)
        return self.context.from_dict(data)


def _steps(expressions: Sequence[Any]) -> dict[Any, int]:
    """For each coordinate in an exponent the common denominator of its coefficients."""
    steps: dict[Any, int] = {}
    for argument in {e.args[0] for expression in expressions for e in expression.atoms(exp)}:
        for symbol, c in argument.as_coefficients_dict().items():
            steps[symbol] = lcm(steps.get(symbol, 1), int(c.q))
    return steps


def _terms(expanded: Any, steps: Mapping[Any, int]) -> dict[tuple[tuple[Any, int], ...], Any] | None:
    """The terms of an expanded expression by their powers; None if it is not of the kind that FLINT is given."""
    found: dict[tuple[tuple[Any, int], ...], Any] = {}
    for term in Add.make_args(expanded):
        coefficient: Any = S.One
        powers: dict[Any, int] = {}
        factors: Any = term.as_powers_dict()
        for base, power in factors.items():
            if base.is_Rational and power.is_Integer:
                coefficient *= base**power
            elif base.is_Integer and int(base) == -1 and (2 * power).is_Integer:  # so SymPy gives i as a factor
                powers[I] = powers.get(I, 0) + int(2 * power)
            elif (base.is_Symbol or base == I) and power.is_Integer:
                powers[base] = powers.get(base, 0) + int(power)
            elif base == E or isinstance(base, exp):
                argument = (power if base == E else base.args[0] * power).expand()
                for symbol, c in argument.as_coefficients_dict().items():
                    if not symbol.is_Symbol:
                        return None
                    key = ("exp", symbol)
                    powers[key] = powers.get(key, 0) + int(c * steps[symbol])
            else:
                return None
        turns = powers.pop(I, 0) % 4
        if turns % 2:
            powers[I] = 1
        key = tuple(sorted(((s, n) for s, n in powers.items() if n), key=str))
        found[key] = found.get(key, S.Zero) + (-coefficient if turns > 1 else coefficient)
    return {key: c for key, c in found.items() if c != 0}
