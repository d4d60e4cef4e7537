r"""Vector fields by their components, $\dot x_i = f_i(x)$, without a bracket and a Hamiltonian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, cast

from liepoisson.algebra.exact_numbers import symbols_of
from liepoisson.algebra.rational_polynomials import Expanded, RationalPolynomial, TooLargeError
from liepoisson.compile.field import Field, QuadraticField, TapeField, with_size_limits
from liepoisson.compile.typed import Names, read_system
from liepoisson.errors import ExpressionError, ParameterError, SystemFileError
from liepoisson.facades import function_of
from liepoisson.formula.parameters import GivenValue, flattened, read_kept_values
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import by_name
from liepoisson.inputs.names import check_name, check_title
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.inputs.refusals import NO_BRACKET, not_a
from liepoisson.model.equations_of_motion import EquationsOfMotion, check_source
from liepoisson.model.hamiltonian import is_expression, read_declarations, read_functions
from liepoisson.model.polynomial_view import bracket_with, occurring, read_polynomial
from liepoisson.structure.circles import read_angles, turn
from liepoisson.structure.given_expressions import check_real

if TYPE_CHECKING:
    from sympy import Expr, Symbol

_OF_TIME = '. For equations that depend on time make it a coordinate: {"t": "1"}'
_MISSING = frozenset({"bracket", "hamiltonian", "functions", "symbolic_bracket", "symbolic_hamiltonian"})
"""What a system has and a vector field has not."""


class AsGiven(NamedTuple):
    """How a vector field was given.

    Attributes:
        equations: The rates by the names of the coordinates.
        symbols: Parameters that stay symbolic, as they were declared.
        integrals: By name.
        angles: The coordinates that are angles.
    """

    equations: dict[str, str | Expr]
    symbols: tuple[str, ...]
    integrals: dict[str, str | Expr]
    angles: tuple[str, ...] = ()


@explains_its_methods
class VectorField(EquationsOfMotion):
    r"""A plain vector field, $\dot x_i = f_i(x)$: equations of motion without a bracket and a Hamiltonian.

    Orbits, sections, exponents, the searches for integrals and Darboux polynomials, and the test of Painlevé take one
    like a `System`.  What needs a bracket, such as leaves, energies and equilibria on them, does not.

    Example:
        >>> rates = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
        >>> lorenz = lp.VectorField(rates, {"sigma": 10, "rho": 28, "beta": "8/3"}, name="Lorenz")
        >>> lorenz, lorenz.divergence
        (<VectorField 'Lorenz' in x, y, z>, -41/3)
        >>> lorenz.vector_field([1, 2, 3]).tolist()
        [10.0, 23.0, -6.0]

    Args:
        equations: The rate of each coordinate by its name, in the order of the state: texts in these names and those of
            the parameters (see `liepoisson.formula.expression`), or SymPy expressions in symbols of these names.
        parameters: Values by name, for symbols that occur in the equations: numbers, vectors (lists) or matrices.
        name: How the vector field is called in texts and files.
        symbols: Parameters that stay symbolic; a vector with its length, as in "a[3]".
        angles: The coordinates that are angles, modulo $2\pi$, in which the equations must be periodic.
        integrals: Known integrals by name, as text or expressions.  They are claims, which `invariants` proves.
        source: Where the vector field is described.

    Raises:
        ParameterError: there is no equation, one is neither a text nor an expression or not finite and real, a name
            stands for two things or is no identifier, a parameter is not exact or does not occur, or an equation is not
            periodic in an angle.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        BracketError: an angle is none of the coordinates.
        ShapeError: the angles are no sequence of names.
    """

    _why_missing: ClassVar[str] = f"; {NO_BRACKET}"

    def __init__(
        self,
        equations: Mapping[str, str | Expr],
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        name: str | None = None,
        symbols: Sequence[str] = (),
        angles: Sequence[str] = (),
        integrals: Mapping[str, str | Expr] | None = None,
        source: str | None = None,
    ) -> None:
        self._given_equations = _read_equations(equations)
        self.angles = read_angles(angles, tuple(self._given_equations))
        self._given_symbols: tuple[str, ...] = read_declarations(symbols)
        self._given_integrals: dict[str, str | Expr] = read_functions(integrals, "integrals")
        self._kept_values = read_kept_values(parameters)
        self._numbers = flattened(self._kept_values)
        self.name = "vector field" if name is None else check_title(name, "the name of a vector field")
        self.source = source if source is None else check_source(source)
        self._check_that_values_are_final()
        _ = self._names_in_formulas
        for parameter, value in self.parameters.items():
            if both := sorted(symbols_of(value) & {*self.component_names}):
                raise ParameterError(
                    f"a parameter must be constant; got {parameter} = {value}, and {both[0]} is a coordinate. Write "
                    "the formula into the equations."
                )
        _ = self._polynomials or self._is_typed or self.equations
        if self.angles:
            rates = {f"the rate of {variable}": rate for variable, rate in self.equations.items()}
            self._check_on_circles(rates, "Write it by sines and cosines of {name}, or leave {name} out of angles.")

    @property
    def as_given(self) -> AsGiven:
        """What a file of this vector field has to say, in the words in which it was given."""
        return AsGiven(dict(self._given_equations), self._given_symbols, dict(self._given_integrals), self.angles)

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the coordinates, in the order of the state vector."""
        return tuple(self._given_equations)

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """The same: each coordinate is a scalar."""
        return self.component_names

    @property
    def vector_length(self) -> int:
        """Number of components that random starts give the length one together: all."""
        return len(self.component_names)

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates as symbols, in the order of the state vector."""
        from sympy import Symbol

        return tuple(Symbol(name) for name in self.component_names)

    def _at_values(self, values: Mapping[str, GivenValue]) -> Self:
        """The same with these values of all parameters; one that is the name itself makes the parameter a symbol."""
        known = self.as_given
        found: Any = VectorField(
            known.equations, values, name=self.name, symbols=known.symbols, angles=known.angles,
            integrals=known.integrals, source=self.source,
        )  # fmt: skip
        return found

    @property
    def _names_of_angles(self) -> tuple[str, ...]:
        return self.angles

    @cached_property
    def periods(self) -> dict[str, Expr]:
        r"""The periods of the coordinates that are points of circles, by name: $2\pi$ of an angle."""
        return dict.fromkeys(self.angles, turn()) if self.angles else {}

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides with the parameters inserted, in the order of `variables`.

        Raises:
            ParameterError: a parameter does not occur, or a right-hand side is not finite and real.
        """
        read = self._symbolic_equations
        self._check_that_parameters_occur(read)
        rates = {variable: self._with_parameters(rate) for variable, rate in zip(self.variables, read, strict=True)}
        for variable, rate in rates.items():
            check_real(rate, f"the rate of {variable}")
        return ReadOnlyDict(rates)

    @cached_property
    def _symbolic_equations(self) -> list[Expr]:
        """The right-hand sides with the parameters as symbols, as they were given."""
        found: list[Expr] = []
        for name, given in self._given_equations.items():
            try:
                found.append(self._read(given))
            except ExpressionError as error:
                of_time = "the name 't' is unknown" in error.message
                words = f"the rate of {name}: {error.message}" + _OF_TIME * of_time
                raise ExpressionError(words, error.text, error.position) from None
        return found

    def _check_that_parameters_occur(self, equations: Sequence[Expr]) -> None:
        known = {str(symbol) for rate in equations for symbol in rate.free_symbols} - {*self.component_names}
        for name, value in self.values.items():
            if not known & set(flattened({name: value})):
                raise ParameterError(
                    f"a parameter must occur in the equations; {name!r} occurs in none. "
                    + (f"Known there: {', '.join(sorted(known))}." if known else "Leave it out.")
                )

    @cached_property
    def invariants(self) -> dict[str, Expr]:
        """The integrals that were given, each proved constant.

        Raises:
            ParameterError: one is not constant.
        """
        return ReadOnlyDict(self._with_integrals({}))

    @property
    def polynomial_rates(self) -> tuple[RationalPolynomial, ...] | None:
        """The equations as rational polynomials that were read without SymPy; None where they are no such."""
        return None if self._polynomials is None else self._polynomials.rates

    @cached_property
    def polynomial_invariants(self) -> dict[str, RationalPolynomial] | None:
        """The `invariants` in the same way; None where one of them is no rational polynomial."""
        found: dict[str, RationalPolynomial] = {}
        for name, given in self._given_integrals.items():
            read = self._polynomials.read(given) if self._polynomials and isinstance(given, str) else None
            if read is None or not (self._polynomials and self._polynomials.is_constant(read)):
                return None
            found[name] = read
        return found if self._polynomials else None

    def derivative(self, function: str | Expr) -> Expr:
        r"""The time derivative $\sum_i f_i\,\partial g/\partial x_i$ of a function g, simplified if no polynomial.

        Args:
            function: A SymPy expression in `variables`, or a text like those of the equations.
        """
        from sympy import Add, simplify

        g: Any = self._function(function)
        rate: Any = Add(*(g.diff(x) * f for x, f in self.equations.items()))
        return rate.expand() if rate.is_polynomial(*self.variables) else simplify(rate)

    def field(self) -> Field:
        """The vector field as plain data for the numeric core: a quadratic field or a tape.

        Raises:
            UnsupportedFieldError: a right-hand side contains a function that is not smooth.
            ParameterError: a parameter is symbolic.
        """
        return with_size_limits(self._field, self.size_limits)

    @cached_property
    def _field(self) -> Field:
        rates = self.polynomial_rates
        if rates is not None and all(len(m) <= 2 for rate in rates for m in rate.expanded):
            return _quadratic_field([rate.expanded for rate in rates])
        if self._is_typed:  # as it is grouped in the texts
            tape = self.function_tape(*self._given_equations.values())
            if rates is not None or {name for name, *_ in tape.instructions} - {"linear", "product"}:
                return TapeField(tape.n_components, tape.instructions, tape.outputs)
        # polynomials with irrational numbers, which may be of degree two, and expressions
        from liepoisson.compile.lowering import field_of_equations

        rates = list(self.equations.values())
        if free := sorted({str(s) for rate in rates for s in rate.free_symbols} - {*self.component_names}):
            raise ParameterError(
                f"every parameter must be a number for numerical work; got none for {', '.join(free)}. Give values."
            )
        return field_of_equations(self.variables, rates)

    @cached_property
    def _is_typed(self) -> bool:
        """Whether the core reads all equations; where it does not, SymPy reads them, and says what is wrong."""
        if self._given_symbols:
            return False
        used: set[str] = set()
        for given in self._given_equations.values():
            read = read_system(self._names_of_state, None, given, self._kept_values) if isinstance(given, str) else None
            if read is None:
                return False
            used |= {*read.parameters()}
        return all(used & set(flattened({name: value})) for name, value in self.values.items())

    @cached_property
    def _polynomials(self) -> _PolynomialRates | None:
        """The equations, if they are rational polynomials that are read without SymPy."""
        if self._given_symbols or not all(isinstance(value, Fraction) for value in self.parameters.values()):
            return None
        scope, names, used = self._names_in_formulas, self.component_names, set[str]()
        rates: list[RationalPolynomial] = []
        for given in self._given_equations.values():
            read = read_polynomial(given, scope, names) if isinstance(given, str) else None
            if read is None or (found := occurring(cast("str", given), scope, names, read)) is None:
                return None
            rates.append(read)
            used |= found
        try:
            _ = [rate.expanded for rate in rates]
        except TooLargeError:
            return None
        return _PolynomialRates(scope, names, tuple(rates)) if used >= self.values.keys() else None

    @property
    def _names_of_state(self) -> Names:
        return list(self.component_names)

    def _scope_with(self, *further: str) -> Scope:
        names = self.component_names
        symbols = (*names, *self._given_symbols, *further)
        return Scope(parameters=cast("Any", self.values), symbols=symbols, scalars=names)

    @cached_property
    def text(self) -> str | None:
        """The text of a file from which the same vector field is read; None if there is none."""
        try:
            return self.file_text()
        except SystemFileError:
            return None

    def file_text(self) -> str:
        """The same, with the reason where there is none.

        Raises:
            SystemFileError: it has a function that the grammar does not have.
        """
        return function_of("VectorField.file_text")(self)

    def __str__(self) -> str:
        """The equations, the parameters and the integrals, as they were given."""
        lines = [f"{self.name}: a vector field in {', '.join(self.component_names)}"]
        lines += [f"{name}' = {_shown(given)}" for name, given in self._given_equations.items()]
        if self.parameters:
            lines.append(f"with {', '.join(f'{name} = {value}' for name, value in self.parameters.items())}")
        lines += [f"constant: {name} = {_shown(given)}" for name, given in self._given_integrals.items()]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<VectorField {self.name!r} in {', '.join(self.component_names)}>"

    if not TYPE_CHECKING:  # for type checkers, what is not there has no type

        def __getattr__(self, name: str) -> object:
            """The error of a name that is not there."""
            reason = self._why_missing if name in _MISSING else ""
            message = f"{type(self).__name__!r} object has no attribute {name!r}{reason}"
            raise AttributeError(message, name=name, obj=self)


@dataclass(frozen=True)
class _PolynomialRates:
    """Equations that are rational polynomials."""

    scope: Scope
    names: tuple[str, ...]
    rates: tuple[RationalPolynomial, ...]

    def read(self, text: str) -> RationalPolynomial | None:
        """A formula in the same names; None if it is no small polynomial."""
        return read_polynomial(text, self.scope, self.names)

    def is_constant(self, function: RationalPolynomial) -> bool | None:
        """Whether the derivative of a function along the motion vanishes; None if it is too large."""
        try:
            return not bracket_with(self.rates, function)
        except TooLargeError:
            return None


def _read_equations(equations: object) -> dict[str, str | Expr]:
    """The rates of the coordinates by name.

    Raises:
        ParameterError: not a mapping from names to texts or expressions, or an empty one.
    """
    given = by_name(equations, "equations", "rates", '{"x": "y", "y": "-x"}')
    if not given:
        raise not_a("the rate of each coordinate", equations, "equations", 'write {"x": "y", "y": "-x"}')
    for name, rate in given.items():
        check_name(name, "the name of a coordinate")
        if not isinstance(rate, str) and not is_expression(rate):
            raise not_a("a text or an expression", rate, f"equations: the rate of {name}", f'write "{rate!s:.40}"')
    return given


def _quadratic_field(rates: Sequence[Expanded]) -> QuadraticField:
    """The field of equations of degree two; each number is the double next to the rational one."""
    entries: dict[int, list[tuple[Any, ...]]] = {0: [], 1: [], 2: []}
    for i, rate in enumerate(rates):
        for monomial in sorted(rate):
            entries[len(monomial)].append((i, *monomial, float(rate[monomial])))
    return QuadraticField(len(rates), *(tuple(entries[degree]) for degree in (0, 1, 2)))


def _shown(given: object) -> str:
    return str(given).replace("**", "^")
