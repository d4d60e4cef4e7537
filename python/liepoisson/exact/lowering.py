r"""From a system to plain data for the numeric core: a top, a sparse quadratic field, or a tape.

The Poisson tensor is of degree one, so a Hamiltonian of degree two gives a field of degree two,

$$\dot x_i = \sum_{jm} c_{ij}^m x_m\,\partial_j H + \sum_j k_{ij}\,\partial_j H ,$$

which is built term by term without expanding anything: 120 coordinates take a second.  So does one of degree three
where J is constant, as in canonical coordinates.  Any other smooth Hamiltonian gives a tape, in which a subexpression
that occurs twice is computed once.  A tape is written in private symbols: it does not depend on the names of the
coordinates, which would else decide in which order a sum is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.exact.parameters import as_float
from liepoisson.exact.private_symbols import in_private_symbols, name_of_function
from liepoisson.field import Instruction, QuadraticField, TapeField, TapeFunction

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.bracket import Bracket

Polynomial: TypeAlias = "dict[tuple[int, ...], Fraction]"
"""Coefficients by monomial; a monomial is the sorted tuple of the indices of its factors."""

_K = TypeVar("_K", bound=Hashable)

_DIGITS = 40
"""Decimal digits to which an irrational coefficient is known before it is rounded to a double."""

FUNCTIONS = ("exp", "log", "sin", "cos", "sinh", "cosh", "tanh", "asin", "acos", "atan")
"""Elementary functions that a tape knows, under the names of SymPy."""


def lower(bracket: Bracket, hamiltonian: Expr) -> QuadraticField | TapeField:
    """The field of a Hamiltonian as plain data.

    Raises:
        ParameterError: a parameter is symbolic (the message names it), or a coefficient does not fit into a double.
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    check_numeric(bracket, hamiltonian)
    energy = quadratic_polynomial(hamiltonian, bracket.variables)
    if energy is not None:
        return _quadratic_field(bracket, energy)
    if bracket.constant and not bracket.entries():
        rates = bracket.vector_field(hamiltonian)
        if all(_is_of_degree_two(rate, bracket.variables) for rate in rates):
            return quadratic_of_equations(bracket.variables, rates)
    return tape_of_bracket(bracket, hamiltonian)


def _is_of_degree_two(expression: Any, variables: Sequence[Symbol]) -> bool:
    """Whether it is a polynomial of degree at most two."""
    if not expression.is_polynomial(*variables):
        return False
    from sympy import Poly

    return expression == 0 or Poly(expression, *variables).total_degree() <= 2


def quadratic_polynomial(expression: Expr, variables: Sequence[Symbol]) -> Polynomial | None:
    """The polynomial of degree at most two that the expression is, or None if it is none; coefficients as rationals.

    Irrational coefficients are rounded to 40 digits.
    """
    from sympy import Add, expand

    positions = {variable: i for i, variable in enumerate(variables)}
    terms: list[tuple[tuple[int, ...], Fraction]] = []
    for term in Add.make_args(expand(expression)):
        coefficient, monomial = Fraction(1), []
        powers: Any = term.as_powers_dict()
        for base, exponent in powers.items():
            if base in positions:
                if exponent not in (1, 2):
                    return None
                monomial += [positions[base]] * int(exponent)
            elif base.free_symbols or exponent.free_symbols:
                return None
            else:
                coefficient *= rational(base**exponent)
        if len(monomial) > 2:
            return None
        terms.append((tuple(sorted(monomial)), coefficient))
    return _sums_that_do_not_cancel(lambda: terms)


def rational(value: Fraction | Expr) -> Fraction:
    """An exact number as a fraction; one that is irrational is rounded to 40 digits."""
    if isinstance(value, Fraction):
        return value
    from sympy import Rational

    return Fraction(int(value.p), int(value.q)) if isinstance(value, Rational) else _rounded(value)


def _rounded(value: Expr) -> Fraction:
    from sympy import Rational

    number = _ROUNDED.get(value)
    if number is None:
        evaluated: Any = value.evalf(_DIGITS)
        if not evaluated.is_Float:
            raise ParameterError(f"a coefficient must be a finite real number; got {value}. Check the parameters.")
        binary: Any = Rational(evaluated)
        number = _ROUNDED[value] = Fraction(int(binary.p), int(binary.q))
        if len(_ROUNDED) > 10_000:
            _ROUNDED.clear()
    return number


_ROUNDED: dict[Expr, Fraction] = {}


def check_numeric(bracket: Bracket, hamiltonian: Expr) -> None:
    """Refuse symbols without numbers.

    Raises:
        ParameterError: a parameter is symbolic; the message names it.
    """
    free = {str(symbol) for symbol in hamiltonian.free_symbols - set(bracket.variables)} | bracket.symbols
    if free:
        raise ParameterError(
            f"every parameter must be a number for numerical work; {', '.join(sorted(free))} has none. Give values."
        )


def _quadratic_field(bracket: Bracket, energy: Polynomial) -> QuadraticField:
    gradient: dict[int, Polynomial] = {}
    for monomial, coefficient in energy.items():
        for j in set(monomial):
            rest = list(monomial)
            rest.remove(j)
            slope = gradient.setdefault(j, {})
            slope[tuple(rest)] = slope.get(tuple(rest), Fraction(0)) + coefficient * monomial.count(j)

    def terms() -> Iterator[tuple[tuple[int, tuple[int, ...]], Fraction]]:
        entries = [((i, j), (m,), rational(c)) for i, j, m, c in bracket.entries()]
        constant = [(pair, (), rational(c)) for pair, c in bracket.constant.items()]
        for (i, j), factor, value in (*entries, *constant):
            for row, column, sign in ((i, j, value), (j, i, -value)):
                for rest, slope in gradient.get(column, {}).items():
                    yield (row, tuple(sorted((*factor, *rest)))), sign * slope

    kept = _sums_that_do_not_cancel(terms)
    return _field_of_terms(bracket.dimension, [(i, monomial, value) for (i, monomial), value in kept.items()])


_CANCELS = Fraction(1, 10**30)
"""Rounded coefficients that should cancel leave 1e-40 of their size."""


def _sums_that_do_not_cancel(terms: Callable[[], Iterable[tuple[_K, Fraction]]]) -> dict[_K, Fraction]:
    """The sums of terms with the same key, without those that are zero but for the rounding of their terms.

    Each is judged by its own terms: in suitable units coefficients differ by any factor.
    """
    sums: dict[_K, Fraction] = {}
    for key, value in terms():
        sums[key] = sums.get(key, Fraction(0)) + value
    largest = max((abs(value) for value in sums.values()), default=Fraction(0))
    sizes = {key: Fraction(0) for key, value in sums.items() if abs(value) <= largest * _CANCELS}
    if any(sums[key] for key in sizes):
        for key, value in terms():
            if key in sizes:
                sizes[key] += abs(value)
    return {key: value for key, value in sums.items() if key not in sizes or abs(value) > sizes[key] * _CANCELS}


def _field_of_terms(n: int, terms: Sequence[tuple[int, tuple[int, ...], Fraction]]) -> QuadraticField:
    """The field with these terms: component of the derivative, monomial, coefficient."""
    by_degree: list[list[tuple[Any, ...]]] = [[], [], []]
    for i, monomial, value in terms:
        if value:
            number = as_float(value, "the coefficient of " + (" ".join(f"x{j}" for j in monomial) or "1"))
            by_degree[len(monomial)].append((i, *monomial, number))
    constant, linear, quadratic = (tuple(sorted(entries)) for entries in by_degree)
    return QuadraticField(n, constant, linear, quadratic)


def tape_of_bracket(bracket: Bracket, hamiltonian: Expr) -> TapeField:
    """The field of any smooth Hamiltonian as a tape.

    Raises:
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    private, [energy] = in_private_symbols(bracket.variables, [hamiltonian])
    writer = _TapeWriter(private)
    slopes = [energy.diff(variable) for variable in private]
    gradient = writer.write_all(slopes)  # refuses what has no tape
    if _is_still(bracket, private, slopes):
        still = _TapeWriter(private)
        return TapeField(*still.parts([still.linear([], 0.0) for _ in private]))
    sums: list[list[tuple[int, float]]] = [[] for _ in bracket.variables]
    for i, j, m, c in bracket.entries():
        value = as_float(rational(c), "a structure constant")
        for row, column, sign in ((i, j, value), (j, i, -value)):
            if (slope := gradient[column]) is not None:
                sums[row].append((writer.product(m, slope), sign))
    for (i, j), c in bracket.constant.items():
        value = as_float(rational(c), "an entry of the constant part")
        for row, column, sign in ((i, j, value), (j, i, -value)):
            if (slope := gradient[column]) is not None:
                sums[row].append((slope, sign))
    return TapeField(*writer.parts([writer.linear(terms, 0.0) for terms in sums]))


_CANCELLED = 1e-9
"""A sum below this fraction of its terms may be zero, and is looked at exactly."""


def _is_still(bracket: Bracket, variables: Sequence[Symbol], slopes: Sequence[Expr]) -> bool:
    """Whether J times this gradient vanishes identically, as for a function of Casimirs; a tape would leave round-off.

    Most fields do not vanish at one state of no special position, and no more is computed for them.
    """
    from sympy import Add, Rational, expand

    rates: list[list[Any]] = [[] for _ in variables]
    for i, j, m, c in bracket.entries():
        value = Rational(rational(c))
        rates[i].append(value * variables[m] * slopes[j])
        rates[j].append(-value * variables[m] * slopes[i])
    for (i, j), c in bracket.constant.items():
        value = Rational(rational(c))
        rates[i].append(value * slopes[j])
        rates[j].append(-value * slopes[i])
    state = {x: Rational(2 * k + 3, k + 2) for k, x in enumerate(variables)}
    try:
        for terms in rates:
            values = [complex(term.subs(state)) for term in terms]
            if not abs(sum(values)) <= _CANCELLED * sum(abs(value) for value in values):
                return False
    except (TypeError, ValueError, OverflowError):  # it is not defined there
        return False
    return all(expand(Add(*terms)) == 0 for terms in rates)


def quadratic_of_equations(variables: Sequence[Symbol], derivatives: Sequence[Expr]) -> QuadraticField:
    r"""Equations $\dot x_i = f_i(x)$ of degree two as a quadratic field: for systems that are given by their equations.

    Raises:
        UnsupportedFieldError: a right-hand side is not a polynomial of degree at most two with numbers as coefficients.
    """
    terms: list[tuple[int, tuple[int, ...], Fraction]] = []
    for i, rate in enumerate(derivatives):
        polynomial = quadratic_polynomial(rate, variables)
        if polynomial is None:
            raise UnsupportedFieldError(
                f"the derivative of {variables[i]} must be a polynomial of degree at most two with numbers as "
                f"coefficients; got {rate!s:.60}. Use tape_of_equations."
            )
        terms += [(i, monomial, value) for monomial, value in polynomial.items()]
    return _field_of_terms(len(variables), terms)


def tape_of_equations(variables: Sequence[Symbol], derivatives: Sequence[Expr]) -> TapeField:
    r"""Any smooth equations $\dot x_i = f_i(x)$ as a tape: for systems that are not written as a Lie-Poisson bracket.

    Raises:
        UnsupportedFieldError: a function is not smooth or not known.
        ParameterError: a symbol is not among the variables.
    """
    private, rates = in_private_symbols(variables, derivatives)
    writer = _TapeWriter(private)
    registers = writer.write_all(rates)
    return TapeField(
        *writer.parts([writer.linear([], 0.0) if register is None else register for register in registers])
    )


def tape_of_functions(variables: Sequence[Symbol], functions: Sequence[Expr]) -> TapeFunction:
    """Functions of the variables as one tape.

    Raises:
        UnsupportedFieldError: a function is not smooth or not known.
        ParameterError: a symbol is not among the variables.
    """
    private, expressions = in_private_symbols(variables, functions)
    writer = _TapeWriter(private)
    registers = [writer.linear([], 0.0) if r is None else r for r in writer.write_all(expressions)]
    return TapeFunction(*writer.parts(registers))


class _TapeWriter:
    """Writes expressions in private symbols as instructions; equal instructions are written once."""

    def __init__(self, variables: Sequence[Symbol]) -> None:
        self._n = len(variables)
        self._registers: dict[Expr, int] = {variable: i for i, variable in enumerate(variables)}
        self._written: dict[Instruction, int] = {}

    def parts(self, outputs: Iterable[int]) -> tuple[int, tuple[Instruction, ...], tuple[int, ...]]:
        """What a tape is made of: number of components, instructions, outputs."""
        return self._n, tuple(self._written), tuple(outputs)

    def write_all(self, expressions: Sequence[Expr]) -> list[int | None]:
        """The register of each expression, None for one that is zero; common subexpressions are found first."""
        from sympy import cse, numbered_symbols

        # Sorted before the variables: after them the tape of the quaternion chart has two operations more.
        found: Any = cse(list(expressions), symbols=numbered_symbols("0c"), order="none")
        shared, reduced = found
        for symbol, expression in shared:
            self._registers[symbol] = self.write(expression)
        return [None if expression.is_zero else self.write(expression) for expression in reduced]

    def write(self, expression: Expr) -> int:
        known = self._registers.get(expression)
        if known is None:
            known = self._registers[expression] = self._write(expression)
        return known

    def linear(self, terms: Iterable[tuple[int, float]], constant: float) -> int:
        """A linear combination; a plain register stays what it is."""
        sums: dict[int, float] = {}
        for register, coefficient in terms:
            sums[register] = sums.get(register, 0.0) + coefficient
        kept = {register: coefficient for register, coefficient in sums.items() if coefficient != 0.0}
        if constant == 0.0 and list(kept.values()) == [1.0]:
            return next(iter(kept))
        return self._add("linear", tuple(kept), (*kept.values(), constant))

    def product(self, first: int, second: int) -> int:
        return self._add("product", tuple(sorted((first, second))))

    def _add(self, name: str, registers: tuple[int, ...], numbers: tuple[float, ...] = ()) -> int:
        return self._written.setdefault((name, registers, numbers), self._n + len(self._written))

    def _write(self, expression: Expr) -> int:
        if expression.is_number:
            return self.linear([], as_float(rational(expression), "a constant"))
        if expression.is_Add:
            return self._write_sum(expression)
        if expression.is_Mul:
            coefficient, rest = expression.as_coeff_Mul()
            register = self._write_product(rest) if rest.is_Mul else self.write(rest)
            return self.linear([(register, as_float(rational(coefficient), "a coefficient"))], 0.0)
        if expression.is_Pow:
            return self._write_power(*expression.as_base_exp())
        return self._write_function(expression)

    def _write_sum(self, expression: Expr) -> int:
        terms: list[tuple[int, float]] = []
        constant = Fraction(0)
        for term in cast("tuple[Expr, ...]", expression.args):
            coefficient, rest = term.as_independent(*term.free_symbols, as_Add=False)
            if not term.free_symbols:
                constant += rational(term)
            else:
                terms.append((self.write(rest), as_float(rational(coefficient), "a coefficient")))
        return self.linear(terms, as_float(constant, "a constant"))

    def _write_product(self, expression: Expr) -> int:
        from sympy import fraction

        numerator, denominator = fraction(expression)
        if denominator != 1:
            return self._add("quotient", (self.write(numerator), self.write(denominator)))
        constant, varying = expression.as_independent(*expression.free_symbols, as_Add=False)
        factors = [self.write(factor) for factor in varying.as_ordered_factors()]
        register = factors[0]
        for factor in factors[1:]:
            register = self.product(register, factor)
        return self.linear([(register, as_float(rational(constant), "a coefficient"))], 0.0)

    def _write_power(self, base: Expr, exponent: Expr) -> int:
        from sympy import E, Rational

        if base == E:
            return self._add("exp", (self.write(exponent),))
        if exponent.free_symbols:  # u^v = exp(v log u)
            logarithm = self._add("log", (self.write(base),))
            return self._add("exp", (self.product(self.write(exponent), logarithm),))
        if exponent == 2:
            register = self.write(base)
            return self.product(register, register)
        if exponent == Rational(1, 2):
            return self._add("sqrt", (self.write(base),))
        if exponent.is_negative:
            one = self.linear([], 1.0)
            return self._add("quotient", (one, self.write(base**-exponent)))
        return self._add("power", (self.write(base),), (as_float(rational(exponent), "an exponent"),))

    def _write_function(self, expression: Expr) -> int:
        name = name_of_function(expression)
        if name == "tan":
            return self._add("quotient", (self._function("sin", expression), self._function("cos", expression)))
        if name not in FUNCTIONS or len(expression.args) != 1:
            shown = str(expression)
            shown = shown if len(shown) < 60 else shown[:57] + "..."
            raise UnsupportedFieldError(
                "to be integrated, a field must be made of + - * / ^ sqrt exp log and trigonometric functions of the "
                f"variables; got {shown}. Replace it by a smooth expression."
            )
        return self._function(name, expression)

    def _function(self, name: str, expression: Expr) -> int:
        return self._add(name, (self.write(cast("Expr", expression.args[0])),))
