r"""From a system to plain data for the numeric core: a top, a sparse quadratic field, or a tape.

The Poisson tensor is of degree one, so a Hamiltonian of degree two gives a field of degree two,

$$\dot x_i = \sum_{jm} c_{ij}^m x_m\,\partial_j H + \sum_j k_{ij}\,\partial_j H ,$$

which is built term by term without expanding anything: 120 coordinates take a second.  So does one of degree three
where J is constant, as in canonical coordinates.  Any other smooth Hamiltonian gives a tape, in which a subexpression
that occurs twice is computed once.  A tape is written in private symbols: it does not depend on the names of the
coordinates, which would else decide in which order a sum is taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import as_coefficient
from liepoisson.algebra.rounded import ONE, ZERO, Rounded, of_degree_two, rational, rounded
from liepoisson.compile.cancellation import MOST_TERMS, MinorProduct, n_terms, regrouped, without_overflow
from liepoisson.compile.field import Instruction, QuadraticField, TapeField, TapeFunction
from liepoisson.compile.symbols import in_compiler_symbols, name_of_function
from liepoisson.errors import ParameterError, UnsupportedFieldError

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.structure.bracket import Bracket

Polynomial: TypeAlias = "dict[tuple[int, ...], Fraction]"
"""Coefficients by monomial; a monomial is the sorted tuple of the indices of its factors."""

FUNCTIONS = ("exp", "log", "sin", "cos", "sinh", "cosh", "tanh", "asin", "acos", "atan")
"""Elementary functions that a tape knows, under the names of SymPy."""


def lower(bracket: Bracket, hamiltonian: Expr) -> QuadraticField | TapeField:
    """The field of a Hamiltonian as plain data.

    Raises:
        ParameterError: a parameter is symbolic (the message names it), or a coefficient does not fit into a double.
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    check_numeric(bracket, hamiltonian)
    energy = _quadratic_sums(hamiltonian, bracket.variables)
    if energy is not None:
        return _quadratic_field(bracket, energy)
    if bracket.constant and not bracket.entries():
        rates = bracket.vector_field(hamiltonian)
        if all(_is_of_degree_two(rate, bracket.variables) for rate in rates):
            return quadratic_of_equations(bracket.variables, rates)
    return tape_of_bracket(bracket, hamiltonian)


def lower_polynomial(
    bracket: Bracket, hamiltonian: RationalPolynomial, rates: Sequence[RationalPolynomial]
) -> QuadraticField | None:
    """The same for a polynomial Hamiltonian, without SymPy; None where the field is no quadratic one.

    Args:
        bracket: A bracket with rational numbers.
        hamiltonian: The Hamiltonian.
        rates: The equations of motion.

    Raises:
        ParameterError: a coefficient does not fit into a double.
    """
    energy = of_degree_two(hamiltonian)
    if energy is not None:
        return _quadratic_field(bracket, energy)
    if bracket.entries():
        return None
    terms: list[tuple[int, tuple[int, ...], Rounded]] = []
    for i, rate in enumerate(rates):
        polynomial = of_degree_two(rate)
        if polynomial is None:
            return None
        terms += [(i, monomial, value) for monomial, value in polynomial.items()]
    return _field_of_terms(bracket.dimension, terms)


def tape_of_polynomials(n_components: int, polynomials: Sequence[RationalPolynomial]) -> TapeFunction:
    """Polynomials in the coordinates as one tape, as they are written: powers of sums stay, and do not cancel."""
    writer = _TapeWriter(())
    writer.start_after(n_components)
    return TapeFunction(*writer.parts([_write_polynomial(writer, polynomial) for polynomial in polynomials]))


def _write_polynomial(writer: _TapeWriter, polynomial: RationalPolynomial) -> int:
    terms: list[tuple[int, Rounded]] = []
    constant = ZERO
    for monomial in polynomial.monomials_in_order:
        value = polynomial.terms[monomial]
        if not monomial:
            constant += rounded(value)
            continue
        factors = [
            writer.power(atom if isinstance(atom, int) else _write_polynomial(writer, atom), power)
            for atom, power in monomial
        ]
        register = factors[0]
        for factor in factors[1:]:
            register = writer.product(register, factor)
        terms.append((register, rounded(value)))
    return writer.linear(terms, constant)


def _is_of_degree_two(expression: Any, variables: Sequence[Symbol]) -> bool:
    """Whether it is a polynomial of degree at most two."""
    if not expression.is_polynomial(*variables):
        return False
    from sympy import Poly

    return expression == 0 or Poly(expression, *variables).total_degree() <= 2


def quadratic_polynomial(expression: Expr, variables: Sequence[Symbol]) -> Polynomial | None:
    """The polynomial of degree at most two that the expression is, or None if it is none; coefficients as rationals.

    Irrational coefficients are rounded to 40 digits; sums of them that are zero to these digits are zero.
    """
    sums = _quadratic_sums(expression, variables)
    return None if sums is None else {monomial: coefficient.number for monomial, coefficient in sums.items()}


def _quadratic_sums(expression: Expr, variables: Sequence[Symbol]) -> dict[tuple[int, ...], Rounded] | None:
    """The same, with what has been rounded in each coefficient."""
    from sympy import Add, expand

    positions = {variable: i for i, variable in enumerate(variables)}
    polynomial: dict[tuple[int, ...], Rounded] = {}
    for term in Add.make_args(expand(expression)):
        coefficient, monomial = ONE, []
        powers: Any = term.as_powers_dict()
        for base, exponent in powers.items():
            if base in positions:
                if exponent not in (1, 2):
                    return None
                monomial += [positions[base]] * int(exponent)
            elif base.free_symbols or exponent.free_symbols:
                return None
            else:
                coefficient *= rounded(base**exponent)
        if len(monomial) > 2:
            return None
        key = tuple(sorted(monomial))
        polynomial[key] = polynomial.get(key, ZERO) + coefficient
    return {monomial: coefficient.settled() for monomial, coefficient in polynomial.items()}


def check_numeric(bracket: Bracket, hamiltonian: Expr) -> None:
    """Refuse symbols without numbers.

    Raises:
        ParameterError: a parameter is symbolic; the message names it.
    """
    free = {str(symbol) for symbol in hamiltonian.free_symbols - set(bracket.variables)} | bracket.symbols
    if free:
        raise ParameterError(
            f"every parameter must be a number for numerical work; got none for {', '.join(sorted(free))}. Give values."
        )


def _quadratic_field(bracket: Bracket, energy: Mapping[tuple[int, ...], Rounded]) -> QuadraticField:
    gradient: dict[int, dict[tuple[int, ...], Rounded]] = {}
    for monomial, coefficient in energy.items():
        for j in set(monomial):
            rest = list(monomial)
            rest.remove(j)
            slope = gradient.setdefault(j, {})
            power = rounded(Fraction(monomial.count(j)))
            slope[tuple(rest)] = slope.get(tuple(rest), ZERO) + coefficient * power
    sums: dict[tuple[int, tuple[int, ...]], Rounded] = {}
    for i, j, m, c in bracket.entries():
        value = rounded(c)
        for row, column, sign in ((i, j, value), (j, i, -value)):
            for rest, slope in gradient.get(column, {}).items():
                key = row, tuple(sorted((m, *rest)))
                sums[key] = sums.get(key, ZERO) + sign * slope
    for (i, j), c in bracket.constant.items():
        value = rounded(c)
        for row, column, sign in ((i, j, value), (j, i, -value)):
            for rest, slope in gradient.get(column, {}).items():
                sums[row, rest] = sums.get((row, rest), ZERO) + sign * slope
    return _field_of_terms(bracket.dimension, [(i, monomial, value) for (i, monomial), value in sums.items()])


def _field_of_terms(n: int, terms: Sequence[tuple[int, tuple[int, ...], Rounded]]) -> QuadraticField:
    """The field with these terms: component of the derivative, monomial, coefficient."""
    by_degree: list[list[tuple[Any, ...]]] = [[], [], []]
    for i, monomial, value in terms:
        if value.number:
            number = as_coefficient(value.number, "the coefficient of " + (" ".join(f"x{j}" for j in monomial) or "1"))
            by_degree[len(monomial)].append((i, *monomial, number))
    constant, linear, quadratic = (tuple(sorted(entries)) for entries in by_degree)
    return QuadraticField(n, constant, linear, quadratic)


def tape_of_bracket(bracket: Bracket, hamiltonian: Expr) -> TapeField:
    """The field of any smooth Hamiltonian as a tape.

    Raises:
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    from sympy import S

    private, [energy] = in_compiler_symbols(bracket.variables, [hamiltonian])
    slopes = [energy.diff(variable) for variable in private]
    writer = _TapeWriter(private)
    gradient = writer.write_all(slopes)  # refuses what has no tape
    if _is_still(bracket, private, slopes):
        still = _TapeWriter(private)
        return TapeField(*still.parts([still.linear([], ZERO) for _ in private]))
    rates = _rates(bracket)
    rows: list[Expr | None] = [None] * len(rates)
    if n_terms(rates, slopes) <= MOST_TERMS:
        rows = [regrouped(products, slopes, private) for products in rates]
    if any(row is not None for row in rows):
        used = {product.slope for products, row in zip(rates, rows, strict=True) if row is None for product in products}
        writer = _TapeWriter(private)
        written = [slope if j in used else S.Zero for j, slope in enumerate(slopes)]
        together = writer.write_all([*written, *(row for row in rows if row is not None)])
        gradient, regroup = together[: len(slopes)], iter(together[len(slopes) :])
    else:
        regroup = iter(())
    outputs: list[int] = []
    for products, row in zip(rates, rows, strict=True):
        if row is not None:
            register = next(regroup)
            outputs.append(writer.linear([], ZERO) if register is None else register)
            continue
        terms: list[tuple[int, Rounded]] = []
        for product in products:
            if (slope := gradient[product.slope]) is not None:
                register = slope if product.coordinate is None else writer.product(product.coordinate, slope)
                terms.append((register, rounded(product.coefficient)))
        outputs.append(writer.linear(terms, ZERO))
    return TapeField(*writer.parts(outputs))


def _rates(bracket: Bracket) -> list[list[MinorProduct]]:
    """The terms of each component of J times a gradient."""
    rates: list[list[MinorProduct]] = [[] for _ in bracket.variables]
    for i, j, m, c in bracket.entries():
        rates[i].append(MinorProduct(c, m, j))
        rates[j].append(MinorProduct(-c, m, i))
    for (i, j), c in bracket.constant.items():
        rates[i].append(MinorProduct(c, None, j))
        rates[j].append(MinorProduct(-c, None, i))
    return rates


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
    terms: list[tuple[int, tuple[int, ...], Rounded]] = []
    for i, rate in enumerate(derivatives):
        polynomial = _quadratic_sums(rate, variables)
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
    private, rates = in_compiler_symbols(variables, derivatives)
    writer = _TapeWriter(private)
    registers = writer.write_all(rates)
    return TapeField(
        *writer.parts([writer.linear([], ZERO) if register is None else register for register in registers])
    )


def tape_of_functions(variables: Sequence[Symbol], functions: Sequence[Expr]) -> TapeFunction:
    """Functions of the variables as one tape.

    Raises:
        UnsupportedFieldError: a function is not smooth or not known.
        ParameterError: a symbol is not among the variables.
    """
    private, expressions = in_compiler_symbols(variables, [_without_pairs(function) for function in functions])
    writer = _TapeWriter(private)
    registers = [writer.linear([], ZERO) if r is None else r for r in writer.write_all(expressions)]
    return TapeFunction(*writer.parts(registers))


def _without_pairs(function: Any) -> Any:
    """The angle of a pair by that of one number: half of it has the tangent y/(sqrt(x^2 + y^2) + x)."""
    from sympy import atan, atan2, sqrt

    return function.replace(atan2, lambda y, x: 2 * atan(y / (sqrt(x**2 + y**2) + x)))


class _TapeWriter:
    """Writes expressions in private symbols as instructions; equal instructions are written once."""

    def __init__(self, variables: Sequence[Symbol]) -> None:
        self._n = len(variables)
        self._registers: dict[Expr, int] = {variable: i for i, variable in enumerate(variables)}
        self._written: dict[Instruction, int] = {}

    def start_after(self, n_components: int) -> None:
        """Let registers 0 to n - 1 be coordinates that have no symbols."""
        self._n = n_components

    def parts(self, outputs: Iterable[int]) -> tuple[int, tuple[Instruction, ...], tuple[int, ...]]:
        """What a tape is made of: number of components, instructions, outputs."""
        return self._n, tuple(self._written), tuple(outputs)

    def write_all(self, expressions: Sequence[Expr]) -> list[int | None]:
        """The register of each expression, None for one that is zero; common subexpressions are found first."""
        from sympy import cse, numbered_symbols

        expressions = [without_overflow(expression) for expression in expressions]
        # Sorted before the variables: after them the tape of the quaternion chart has two operations more.
        found: Any = cse(list(expressions), symbols=numbered_symbols("0c"), order="none")
        shared, reduced = found
        numbers: dict[Any, Any] = {}  # stay in their sums: whether these cancel is seen in exact numbers only
        for symbol, expression in shared:
            whole = expression.xreplace(numbers) if numbers else expression
            if whole.is_number:
                numbers[symbol] = whole
            else:
                self._registers[symbol] = self.write(whole)
        whole = [expression.xreplace(numbers) if numbers else expression for expression in reduced]
        return [None if expression.is_zero else self.write(expression) for expression in whole]

    def write(self, expression: Expr) -> int:
        known = self._registers.get(expression)
        if known is None:
            known = self._registers[expression] = self._write(expression)
        return known

    def linear(self, terms: Iterable[tuple[int, Rounded]], constant: Rounded) -> int:
        """A linear combination; a plain register stays what it is."""
        sums: dict[int, Rounded] = {}
        for register, coefficient in terms:
            sums[register] = sums.get(register, ZERO) + coefficient
        kept = {register: as_coefficient(c.number, "a coefficient") for register, c in sums.items() if c.number}
        added = as_coefficient(constant.number, "a constant")
        if added == 0.0 and list(kept.values()) == [1.0]:
            return next(iter(kept))
        return self._add("linear", tuple(kept), (*kept.values(), added))

    def product(self, first: int, second: int) -> int:
        return self._add("product", tuple(sorted((first, second))))

    def power(self, register: int, exponent: int) -> int:
        """A whole power, at least the first."""
        if exponent <= 2:
            return register if exponent == 1 else self.product(register, register)
        return self._add("power", (register,), (float(exponent),))

    def _add(self, name: str, registers: tuple[int, ...], numbers: tuple[float, ...] = ()) -> int:
        return self._written.setdefault((name, registers, numbers), self._n + len(self._written))

    def _write(self, expression: Expr) -> int:
        if expression.is_number:
            return self.linear([], rounded(expression))
        if expression.is_Add:
            return self._write_sum(expression)
        if expression.is_Mul:
            coefficient, rest = expression.as_coeff_Mul()
            register = self._write_product(rest) if rest.is_Mul else self.write(rest)
            return self.linear([(register, rounded(coefficient))], ZERO)
        if expression.is_Pow:
            return self._write_power(*expression.as_base_exp())
        return self._write_function(expression)

    def _write_sum(self, expression: Expr) -> int:
        terms: list[tuple[int, Rounded]] = []
        constant = ZERO
        for term in cast("tuple[Expr, ...]", expression.args):
            coefficient, rest = term.as_independent(*term.free_symbols, as_Add=False)
            if not term.free_symbols:
                constant += rounded(term)
            else:
                terms.append((self.write(rest), rounded(coefficient)))
        return self.linear(terms, constant)

    def _write_product(self, expression: Expr) -> int:
        from sympy import fraction

        numerator, denominator = fraction(expression, exact=True)  # exp(-u) stays what it is
        if denominator != 1:
            return self._add("quotient", (self.write(numerator), self.write(denominator)))
        constant, varying = expression.as_independent(*expression.free_symbols, as_Add=False)
        factors = [self.write(factor) for factor in varying.as_ordered_factors()]
        register = factors[0]
        for factor in factors[1:]:
            register = self.product(register, factor)
        return self.linear([(register, rounded(constant))], ZERO)

    def _write_power(self, base: Expr, exponent: Expr) -> int:
        from sympy import E, exp

        if base == E or isinstance(base, exp):  # a power of a real exponential, for any exponent
            return self._add("exp", (self.write(exponent if base == E else exponent * base.args[0]),))
        if exponent.free_symbols:  # u^v = exp(v log u)
            logarithm = self._add("log", (self.write(base),))
            return self._add("exp", (self.product(self.write(exponent), logarithm),))
        if exponent == 2:
            register = self.write(base)
            return self.product(register, register)
        if exponent.is_negative:
            one = self.linear([], ONE)
            return self._add("quotient", (one, self.write(base**-exponent)))
        return self._write_positive_power(base, exponent)

    def _write_positive_power(self, base: Expr, exponent: Expr) -> int:
        from sympy import Rational

        half = Rational(1, 2)
        if exponent == half:
            return self._add("sqrt", (self.write(base),))
        if exponent.is_Rational and (2 * exponent).is_Integer and not exponent.is_Integer:
            # a root has a value where the base is beyond the range, and what is divided by it is zero
            return self.product(self.write(base ** (exponent - half)), self.write(base**half))
        return self._add("power", (self.write(base),), (as_coefficient(rational(exponent), "an exponent"),))

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
