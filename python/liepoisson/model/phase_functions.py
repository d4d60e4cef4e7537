r"""Functions on phase space as functions of arrays: the Hamiltonian, Casimirs, any expression, with derivatives.

The expressions are the exact ones of a system, compiled to NumPy when they are first evaluated
(`liepoisson.compile.symbols`).

`BallFunctions` evaluates them in ball arithmetic, with exponents of any size and errors that are known.  In doubles
$e^{-\cosh q}$ is zero from q = 7.3 on, and so is $1-\tanh^2q$ from q = 19. Arb's balls have as many digits as are asked
for and exponents without bounds, and every ball contains the number that is meant: one that does not contain zero
belongs to a number that is not zero.

References: [johansson2017].
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, partial, reduce
from operator import add, mul
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.rational_polynomials import RationalPolynomial, expression_of, values_of
from liepoisson.compile.symbols import evaluated, first_of_equal, name_of_function
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_phase_points
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import ANGLE
from liepoisson.model.hamiltonian import is_expression
from liepoisson.portable import elementary

if TYPE_CHECKING:
    from flint import arb
    from sympy import Expr, Symbol

    from liepoisson.compile.field import TapeFunction
    from liepoisson.model.system import System
    from liepoisson.model.trace_values import TraceSum
    from liepoisson.structure.bracket import Bracket

_ANGLE = re.compile(rf"\s*{ANGLE}\(([^,()]*),([^,()]*)\)\s*")
"""The angle of a pair, each without brackets."""


@explains_its_methods
class PhaseFunction:
    """A function on phase space: its values, gradients and second derivatives at many states.

    Example:
        >>> top = lp.catalog.system("kovalevskaya")
        >>> energy = lp.systems.PhaseFunction(top, top.hamiltonian)
        >>> float(energy([1, 0, 1, 0, 0, 1])), energy.gradient([1, 0, 1, 0, 0, 1]).tolist()
        (0.75, [0.5, 0.0, 1.0, -1.0, 0.0, 0.0])

    Args:
        system: The system whose coordinates it depends on.
        expression: A function of them without free parameters: a text, a SymPy expression or a PhaseFunction, as
            `System.expression` takes it.

    Raises:
        ExpressionError: the text is not in the grammar, or a name in it is not known.
        ParameterError: it is none of these, or a parameter in it has no number.
    """

    def __init__(self, system: System, expression: str | Expr | PhaseFunction) -> None:
        read = cast("Expr", expression) if is_expression(expression) else system.expression(expression)
        free = {symbol for symbol in read.free_symbols if symbol not in system.variables}
        if free:
            names = ", ".join(sorted(map(str, free)))
            raise ParameterError(
                f"{system.name} must have numbers for all parameters; got none for {names}. Give values."
            )
        self._polynomial: RationalPolynomial | None = None
        self._pair: tuple[RationalPolynomial, RationalPolynomial] | None = None
        self._tape: TapeFunction | None = None
        self._given: Callable[[], Expr] = partial(_itself, read)
        self._components = system.component_names
        self._n = len(self._components)
        self._system = system
        self._fields = system.parts_of_state

    @classmethod
    def of_polynomial(
        cls, system: System, polynomial: RationalPolynomial, expression: Callable[[], Expr]
    ) -> PhaseFunction:
        """A polynomial, which needs no compilation, and what makes the expression that is the same."""
        function = cls.__new__(cls)
        function._polynomial, function._pair, function._tape, function._given = polynomial, None, None, expression
        function._components, function._fields, function._system = system.component_names, system.parts_of_state, system
        function._n = len(function._components)
        return function

    @classmethod
    def of_pair(
        cls, system: System, pair: tuple[RationalPolynomial, RationalPolynomial], expression: Callable[[], Expr]
    ) -> PhaseFunction:
        """The angle of a pair of polynomials y and x, which needs no compilation for its values and gradients."""
        function = cls.of_polynomial(system, pair[0], expression)
        function._polynomial, function._pair = None, pair
        return function

    @classmethod
    def of_text(cls, system: System, text: str, expression: Callable[[], Expr]) -> PhaseFunction:
        """A text that the core reads, whose values need no SymPy, and what makes the expression that is the same."""
        function = cls.of_polynomial(system, RationalPolynomial.constant(Fraction(0)), expression)
        function._polynomial, function._tape = None, system.function_tape(text)
        return function

    @property
    def expression(self) -> Expr:
        """The function as a SymPy expression."""
        return self._expression

    @cached_property
    def _expression(self) -> Expr:
        return self._given()

    @property
    def polynomial(self) -> RationalPolynomial | None:
        """The function as a polynomial that was read without SymPy; None if it was not."""
        return self._polynomial

    @property
    def n_coordinates(self) -> int:
        """Number of components of a state."""
        return self._n

    @property
    def is_constant(self) -> bool:
        """Whether no coordinate occurs in it."""
        if self._pair is not None:
            return not any(part.coordinates for part in self._pair)
        return not (self.expression.free_symbols if self.polynomial is None else self.polynomial.coordinates)

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates, as SymPy symbols."""
        return self._system.variables

    def __call__(self, states: ArrayLike) -> Array:
        """Values, shape (...), at states of shape (..., N)."""
        if self._polynomial is not None:
            return values_of([self._polynomial], self._states(states))[..., 0]
        if self._pair is not None:
            y, x = np.moveaxis(values_of(self._pair, self._states(states)), -1, 0)
            return elementary.arctan2(y, x)
        if self._tape is not None:
            return values_of_tape(self._tape, self._states(states))[..., 0]
        if self._traces is not None:
            return self._traces.value(self._states(states))
        return self._evaluate(self._values, states, ())

    def gradient(self, states: ArrayLike) -> Array:
        r"""Gradients $\partial f/\partial x_i$, shape (..., N)."""
        if self._polynomial is not None:
            return values_of(self.slopes, self._states(states))
        if self._pair is not None:
            state = self._states(states)
            y, x = np.moveaxis(values_of(self._pair, state)[..., None], -2, 0)
            up, across = (values_of([f.derivative(k) for k in range(self._n)], state) for f in self._pair)
            return (x * up - y * across) / (x * x + y * y)
        if self._traces is not None:
            return self._traces.gradient(self._states(states))
        return self._evaluate(self._gradient, states, (self._n,))

    def hessian(self, states: ArrayLike) -> Array:
        r"""Second derivatives $\partial^2 f/\partial x_i\partial x_j$, shape (..., N, N)."""
        if self._polynomial is not None:
            x = self._states(states)
            return values_of(self._curvatures, x).reshape(*x.shape[:-1], self._n, self._n)
        if self._traces is not None:
            return self._traces.hessian(self._states(states))
        return self._evaluate(self._hessian, states, (self._n, self._n))

    def gradient_in_balls(self, state: Sequence[arb]) -> list[arb]:
        """Balls that contain the first derivatives at one state of balls, with the digits that FLINT is set to."""
        return self._balls(state)[1:]

    def value_in_balls(self, state: Sequence[arb]) -> arb:
        """A ball that contains the value there."""
        return self._balls(state)[0]

    @property
    def is_polynomial(self) -> bool:
        """Whether the function is a polynomial in the coordinates."""
        if self._polynomial is not None or self._traces is not None:
            return True
        return bool(self.expression.is_polynomial(*self.variables))

    @cached_property
    def _traces(self) -> TraceSum | None:
        """The function as a sum of traces, which need no compilation; None if it is none."""
        from liepoisson.model.trace_values import TraceSum

        return TraceSum.of(self.expression, self.variables)

    def as_polynomial(self) -> tuple[PhaseFunction | None, Array | None]:
        """The function whose polynomial it is, of states that are multiplied with units; None where it is none."""
        return (self if self._polynomial is not None else None), None

    @cached_property
    def slopes(self) -> tuple[RationalPolynomial, ...]:
        """The derivatives of a polynomial by the coordinates."""
        assert self._polynomial is not None
        return tuple(self._polynomial.derivative(k) for k in range(self._n))

    @cached_property
    def _curvatures(self) -> tuple[RationalPolynomial, ...]:
        return tuple(slope.derivative(k) for slope in self.slopes for k in range(self._n))

    @cached_property
    def _values(self) -> tuple[Expr, ...]:
        return first_of_equal((self.expression,))

    @cached_property
    def _gradient(self) -> tuple[Expr, ...]:
        return first_of_equal(tuple(self.expression.diff(v) for v in self.variables))

    @cached_property
    def _hessian(self) -> tuple[Expr, ...]:
        return first_of_equal(tuple(slope.diff(v) for slope in self._gradient for v in self.variables))

    @cached_property
    def _balls(self) -> BallFunctions:

        return BallFunctions(self.variables, [self.expression, *self._gradient])

    def _evaluate(self, expressions: tuple[Expr, ...], x: ArrayLike, shape: tuple[int, ...]) -> Array:
        states = self._states(x)
        values = evaluated(self.variables, expressions, states)
        return values.reshape(states.shape[:-1] + shape)

    def _states(self, x: ArrayLike) -> Array:
        return as_phase_points(x, self._components, self._fields)

    def __repr__(self) -> str:
        return f"<PhaseFunction {self.expression}>"


def values_of_all(functions: Sequence[PhaseFunction], x: Array) -> Array:
    """The values of several functions of one system at states of shape (..., N), shape (..., function)."""
    if (read := _as_polynomials(functions, x)) is not None:
        polynomials, y, _ = read
        return values_of([p for f in polynomials if (p := f.polynomial) is not None], y)
    found = np.empty((*x.shape[:-1], len(functions)))
    for k, function in enumerate(functions):
        found[..., k] = function(x)
    return found


def gradients_of(functions: Sequence[PhaseFunction], x: Array) -> Array:
    """The gradients of several functions of one system, shape (..., function, N)."""
    if (read := _as_polynomials(functions, x)) is not None:
        polynomials, y, units = read
        slopes = values_of([slope for f in polynomials for slope in f.slopes], y)
        slopes = slopes.reshape(*x.shape[:-1], len(functions), x.shape[-1])
        return slopes if units is None else slopes * units
    found = np.empty((*x.shape[:-1], len(functions), x.shape[-1]))
    for k, function in enumerate(functions):
        found[..., k, :] = function.gradient(x)
    return found


def _as_polynomials(
    functions: Sequence[PhaseFunction], x: Array
) -> tuple[list[PhaseFunction], Array, Array | None] | None:
    """Functions that are polynomials, their states and units; None if one is none, or has other units."""
    read = [function.as_polynomial() for function in functions]
    polynomials, units = [one for one, _ in read if one is not None], read[0][1] if read else None
    if len(polynomials) < len(read) or any(own is not units for _, own in read):
        return None
    return polynomials, (x if units is None else x * units), units


class PhaseFunctions:
    """The functions on phase space that belong to a system, ready for arrays.

    Args:
        system: A system whose parameters are all numbers.
    """

    def __init__(self, system: System) -> None:
        self._system = system
        self._known: dict[Any, PhaseFunction] = {}

    @cached_property
    def energy(self) -> PhaseFunction:
        """The Hamiltonian."""
        system, polynomial = self._system, self._system.polynomial_hamiltonian
        if polynomial is not None:
            return self.of_polynomial(polynomial, partial(getattr, system, "hamiltonian"))
        if (text := system.typed_hamiltonian) is not None:
            return PhaseFunction.of_text(system, text, partial(getattr, system, "hamiltonian"))
        return self.of(system.hamiltonian)

    def of_text(self, text: str) -> PhaseFunction:
        """A text that the core reads, whose values need no SymPy."""
        return PhaseFunction.of_text(self._system, text, partial(self._system.expression, text))

    @cached_property
    def casimirs(self) -> dict[str, PhaseFunction]:
        """The Casimirs of the open stratum by name, C1, C2, ..."""
        system, bracket = self._system, self._system.bracket
        has_no_symbols = system.polynomial_hamiltonian is not None or system.typed_hamiltonian is not None
        polynomials = bracket.polynomial_casimirs() if has_no_symbols else None
        if polynomials is None:
            return {f"C{k}": self.of(casimir) for k, casimir in enumerate(bracket.casimirs(), start=1)}
        return {
            f"C{k + 1}": self.of_polynomial(polynomial, partial(_casimir, bracket, k))
            for k, polynomial in enumerate(polynomials)
        }

    def of(self, function: str | Expr | PhaseFunction) -> PhaseFunction:
        """Any function on phase space: a text, a SymPy expression or a PhaseFunction, as `System.expression` takes it.

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known.
            ParameterError: the function is none of these, or a parameter in it has no number.
        """
        if isinstance(function, PhaseFunction) and function.polynomial is not None:
            return self.of_polynomial(function.polynomial, partial(getattr, function, "expression"))
        polynomial = self._system.polynomial(function)
        if polynomial is not None:
            return self.of_polynomial(polynomial, partial(self._system.expression, function))
        if (pair := self._pair(function)) is not None:
            return PhaseFunction.of_pair(self._system, pair, partial(self._system.expression, function))
        expression = self._system.expression(function)
        known = self._known.get(expression)
        if known is None:
            known = self._known[expression] = PhaseFunction(self._system, expression)
        return known

    def _pair(self, function: Any) -> tuple[RationalPolynomial, RationalPolynomial] | None:
        """The polynomials of which a text is the angle, if it is that of two without brackets."""
        found = _ANGLE.fullmatch(function) if isinstance(function, str) else None
        if found is None:
            return None
        y, x = (self._system.polynomial(text) for text in found.groups())
        return None if y is None or x is None or not (y.coordinates or x.coordinates) else (y, x)

    def of_polynomial(
        self, polynomial: RationalPolynomial, expression: Callable[[], Expr] | None = None
    ) -> PhaseFunction:
        """A polynomial in the coordinates; `expression` makes the same as an expression, if there is one already."""
        known = self._known.get(polynomial)
        if known is None:
            expression = expression or partial(_in_variables, polynomial, self._system)
            known = self._known[polynomial] = PhaseFunction.of_polynomial(self._system, polynomial, expression)
        return known

    def poisson_tensor(self, states: ArrayLike) -> Array:
        r"""The Poisson tensor $J_{ij}(x) = \{x_i, x_j\}$, shape (..., N, N); zero for what is found by quadrature.

        Raises:
            ParameterError: a parameter of the bracket has no number.
        """
        if free := self._system.bracket.symbols:
            names = ", ".join(sorted(free))
            raise ParameterError(
                f"{self._system.name} must have numbers for all parameters of its bracket; got none for {names}. "
                "Give values."
            )
        n = len(self._system.component_names)
        states = as_phase_points(states, self._system.component_names, self._system.parts_of_state)
        tensor = np.zeros((*states.shape[:-1], n, n))
        if not self._system.bracket.is_linear:
            terms = self._system.bracket.terms()
            values = evaluated(self._system.variables, [cast("Expr", c) for *_, c in terms], states)
            for k, (i, j, *_) in enumerate(terms):
                tensor[..., i, j], tensor[..., j, i] = values[..., k], -values[..., k]
            return tensor
        for i, j, m, c in self._system.bracket.entries():
            tensor[..., i, j] += float(cast("Any", c)) * states[..., m]
            tensor[..., j, i] -= float(cast("Any", c)) * states[..., m]
        for (i, j), c in self._system.bracket.constant.items():
            tensor[..., i, j] += float(cast("Any", c))
            tensor[..., j, i] -= float(cast("Any", c))
        return tensor

    def poisson_slopes(self, states: ArrayLike) -> Array:
        r"""The derivatives $\partial J_{ij}/\partial x_m$ at [..., m, i, j], shape (..., N, N, N).

        Raises:
            ParameterError: a parameter of the bracket has no number.
        """
        system, n = self._system, len(self._system.component_names)
        states = as_phase_points(states, system.component_names, system.parts_of_state)
        if system.bracket.is_linear:
            at_zero = self.poisson_tensor(np.zeros(n))
            return np.broadcast_to(self.poisson_tensor(np.eye(n)) - at_zero, (*states.shape, n, n)).copy()
        terms, slopes = system.bracket.terms(), np.zeros((*states.shape, n, n))
        values = evaluated(
            system.variables, [cast("Expr", c).diff(x) for *_, c in terms for x in system.variables], states
        )
        for k, (i, j, *_) in enumerate(terms):
            slopes[..., i, j] = values[..., k * n : (k + 1) * n]
            slopes[..., j, i] = -slopes[..., i, j]
        return slopes

    def jacobian(self, states: ArrayLike) -> Array:
        r"""The derivative of the vector field, $\partial\dot x_i/\partial x_j$, shape (..., N, N)."""
        n = len(self._system.component_names)
        states = as_phase_points(states, self._system.component_names, self._system.parts_of_state)
        return evaluated(self._system.variables, self._jacobian, states).reshape(*states.shape[:-1], n, n)

    @cached_property
    def _jacobian(self) -> tuple[Expr, ...]:
        return tuple(cast("Any", self._system.jacobian).flat())


def _itself(expression: Expr) -> Expr:
    """For `partial`, which can be pickled."""
    return expression


def _in_variables(polynomial: RationalPolynomial, system: System) -> Expr:
    return expression_of(polynomial, system.variables)


def _casimir(bracket: Bracket, number: int) -> Expr:
    return bracket.casimirs()[number]


_SAME_NAME = frozenset({
    "exp", "log", "sin", "cos", "tan", "sec", "csc", "cot", "sinh", "cosh", "tanh", "sech", "csch", "coth",
    "asin", "acos", "atan", "asinh", "acosh", "atanh", "erf", "erfc",
})  # fmt: skip
"""Functions that SymPy and Arb call by one name."""

_GUARD = 15
"""Digits of SymPy's results that are not believed."""


class BallFunctions:
    """Several expressions in the same variables, with their common parts evaluated once.

    Args:
        variables: The variables, in their order.
        expressions: SymPy expressions in these.
    """

    def __init__(self, variables: Sequence[Symbol], expressions: Sequence[Expr]) -> None:
        from sympy import cse, numbered_symbols

        self._variables = tuple(variables)
        exact = [expression.replace(_is_cancelling, _without_cancelling) for expression in expressions]
        self._parts, self._expressions = cse(exact, symbols=numbered_symbols("_part"))

    def __call__(self, point: Sequence[arb]) -> list[arb]:
        """Balls that contain their values; not finite where they are not defined as real numbers."""
        known: dict[Any, arb] = dict(zip(self._variables, point, strict=True))
        for symbol, part in self._parts:
            known[symbol] = _ball(part, known)
        return [_ball(expression, known) for expression in self._expressions]


def _is_cancelling(expression: Any) -> bool:
    r"""Whether this is $1-\tanh^2u$, as SymPy writes the derivative of tanh: no number of digits is enough for it."""
    from sympy import tanh

    return expression.is_Add and any(expression == 1 - t**2 for t in expression.atoms(tanh))


def _without_cancelling(expression: Any) -> Any:
    from sympy import cosh, tanh

    return next(cosh(t.args[0]) ** -2 for t in expression.atoms(tanh) if expression == 1 - t**2)


def _ball(expression: Any, known: Mapping[Any, arb]) -> arb:
    if expression.is_Atom:
        return known[expression] if expression.is_Symbol else _number(expression)
    parts = [_ball(part, known) for part in expression.args]
    if expression.is_Add:
        return reduce(add, parts)
    if expression.is_Mul:
        return reduce(mul, parts)
    if expression.is_Pow:
        return parts[0] ** parts[1]
    name = name_of_function(expression)
    if name == "Abs":
        return abs(parts[0])
    return getattr(parts[0], name)() if name in _SAME_NAME else _of_sympy(expression, known)


def _number(value: Any) -> arb:
    """A rational number, or a floating-point one, which is rational, too; or one like pi."""
    from flint import arb, fmpq
    from sympy import Rational

    if not (value.is_Rational or value.is_Float):
        return _of_sympy(value, {})
    exact: Any = Rational(value)
    return arb(fmpq(int(exact.p), int(exact.q)))


def _of_sympy(expression: Any, known: Mapping[Any, arb]) -> arb:
    """What Arb has no function for, by SymPy's own arithmetic; its last digits are not trusted."""
    from flint import arb, ctx
    from sympy import Float

    digits = ctx.dps + _GUARD
    at = {s: Float(known[s].mid().str(digits, radius=False), digits) for s in expression.free_symbols}
    value = expression.xreplace(at).evalf(digits)
    if not value.is_Float and not value.is_Rational:
        return arb.nan()
    number = arb(str(value))
    return number + arb(0, abs(number).upper() * arb(10) ** (_GUARD - digits))
