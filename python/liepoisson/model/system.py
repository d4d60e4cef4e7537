"""Systems: a bracket and a Hamiltonian, from which everything else follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, cast

from liepoisson.algebra.exact_numbers import Coefficient, symbols_of
from liepoisson.compile.field import Field, PiecesField, field_of, with_size_limits
from liepoisson.compile.typed import Names, names_of, read_system
from liepoisson.errors import ExpressionError, ParameterError, SystemFileError, did_you_mean
from liepoisson.facades import function_of
from liepoisson.formula.parameters import GivenValue, Kept, flattened, read_kept_values
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.names import check_title
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.inputs.refusals import not_a
from liepoisson.model.equations_of_motion import EquationsOfMotion, check_source
from liepoisson.model.hamiltonian import (
    Hamiltonian,
    apply_function,
    check_hamiltonian,
    is_expression,
    read_declarations,
    read_functions,
    read_pairs_of_functions,
    scope_of,
)
from liepoisson.model.time_dependence import check_period, check_rate_of_time, given_text, suspended
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.coordinates import with_coefficients
from liepoisson.structure.extension import Extension
from liepoisson.structure.given_expressions import check_real
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson._core import TypedSystem
    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.formula.scope import Scope
    from liepoisson.model.phase_functions import PhaseFunction, PhaseFunctions
    from liepoisson.model.polynomial_view import PolynomialView
    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.casimir_part import CasimirPart


def _bracket_hint(given: Any) -> str:
    """How a bracket is made of what was given in its place."""
    if isinstance(given, LieAlgebra):
        vectors = "; or so(3) @ semidirect(2), the same with two vectors l and alpha" if given.name == "se(3)" else ""
        return f"a Lie algebra is half of one: write {given!r} @ trivial(){vectors}"
    if isinstance(given, Extension):
        return "an extension is half of one: write so(3) @ extension"
    return "write for example so(3) @ leibniz(3, 1), or PoissonTensor(variables, entries)"


_NOT_PERIODIC = "Write it by sines and cosines of {name}, or leave {name} out of angles."
"""What to do about a formula that is none on the circle."""


class AsGiven(NamedTuple):
    """How a system was given: texts where it was texts.

    Attributes:
        hamiltonian: The text of the Hamiltonian; None if it was an expression or a function.
        symbols: Parameters that stay symbolic, as they were declared.
        integrals: By name.
        partial_integrals: By name, with the functions that vanish.
    """

    hamiltonian: str | None
    symbols: tuple[str, ...]
    integrals: dict[str, str | Expr]
    partial_integrals: dict[str, tuple[str | Expr, str | Expr]]


@explains_its_methods
class System(EquationsOfMotion):
    r"""A Hamiltonian system on a Poisson bracket, $\dot x = \{x, H\} = J(x) \nabla H(x)$.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, inv(I)*l)/2 + alpha3", {"I": [2, 2, 1]})
        >>> list(top.invariants)
        ['H', 'C1', 'C2']
        >>> top.vector_field([1, 0, 1, 0, 0, 1]).tolist()
        [0.0, -0.5, 0.0, 0.0, 0.5, 0.0]

    Args:
        bracket: The Lie-Poisson bracket, or a `PoissonTensor`.
        hamiltonian: A text such as `"dot(l, inv(I)*l)/2 + dot(a, alpha)"` (see `liepoisson.formula.expression`), a
            SymPy expression in `bracket.variables` and parameters that are declared, or a Python function that takes
            one SymPy column per field (l, alpha, beta for three fields) and returns such an expression.
        parameters: Values by name, for symbols that occur in the bracket or the Hamiltonian: numbers, vectors (lists)
            or matrices (lists of rows).
        period: After which time a Hamiltonian that depends on time repeats itself: a number, or a formula in the
            parameters, "2*pi/w".  Time is the name t in the formula, where nothing else is called so; then the state
            is followed by t and its momentum p_t (`liepoisson.structure.suspension`).
        name: How the system is called in texts and files.
        symbols: Parameters that stay symbolic, besides those of the bracket; a vector with its length, as in "a[3]".
        integrals: Further known integrals by name, as text or expressions.  They are claims: `inspect` proves them.
        partial_integrals: The same for integrals on an invariant set: name -> (integral, function that vanishes there).
        source: Where the system is described.

    Raises:
        ParameterError: the Hamiltonian is of none of these kinds, or has a part that is neither a coordinate nor a
            declared parameter, or a function that is not smooth, or is not periodic in an angle, or in time with the
            period, or contains p_t, the momentum of time, which is added by itself; `parameters` is not a
            mapping from names, or a parameter is not exact.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        BracketError: a parameter is named like a coordinate.
    """

    integrals_are_proved: bool = False
    """Whether the given integrals are constant, as was proved before; else they are looked at where they are used."""

    _knows_time: ClassVar[bool] = True
    """Whether t is time in the Hamiltonian."""

    @explains_its_arguments
    def __init__(
        self,
        bracket: Bracket,
        hamiltonian: Hamiltonian,
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        period: str | float | Expr | None = None,
        name: str | None = None,
        symbols: Sequence[str] = (),
        integrals: Mapping[str, str | Expr] | None = None,
        partial_integrals: Mapping[str, tuple[str | Expr, str | Expr]] | None = None,
        source: str | None = None,
    ) -> None:
        if not isinstance(bracket, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise not_a("a Bracket", bracket, "bracket", _bracket_hint(bracket))
        check_hamiltonian(hamiltonian, bracket)
        self._given_symbols, has_time = read_declarations(symbols), bracket.clock is not None
        if self._knows_time:
            bracket, hamiltonian = suspended(bracket, hamiltonian, parameters, self._given_symbols, period)
        self._given_hamiltonian = hamiltonian
        self._given_integrals = read_functions(integrals, "integrals")
        self._given_partial_integrals = read_pairs_of_functions(partial_integrals)
        self._kept_values: dict[str, Kept] = read_kept_values(parameters)
        self._numbers: dict[str, Coefficient] = flattened(self._kept_values)
        bracket.check_parameter_names(set(self._numbers).union(*map(symbols_of, self._numbers.values())))
        self._check_that_values_are_final()
        self.symbolic_bracket: Bracket = bracket
        of_bracket: Any = {name: value for name, value in self._numbers.items() if name in bracket.symbols}
        self.bracket: Bracket = bracket.substitute(of_bracket)
        is_lie_poisson = bracket.has_algebra and not bracket.constant_rows
        default = "Lie-Poisson system" if is_lie_poisson else "Hamiltonian system"
        self.name: str = default if name is None else check_title(name, "the name of a system")
        self.source: str | None = source if source is None else check_source(source)
        self.bracket = with_coefficients(self.bracket, self._parameter_names)
        self._check_hamiltonian()
        if has_time:
            check_rate_of_time(self.hamiltonian, self.variables[-1])
        if self.bracket.period is not None:
            check_period(self.hamiltonian, self.variables[-2], self.bracket.period)
        if self.bracket.angles:
            self._check_on_circles({"the Hamiltonian": self.hamiltonian}, _NOT_PERIODIC)

    def _check_hamiltonian(self) -> None:
        """Read the Hamiltonian, so that its errors come where it is written."""
        if isinstance(self._given_hamiltonian, str):
            try:
                _ = self.polynomial_hamiltonian or self._typed or self.hamiltonian
            except ExpressionError as error:  # about the formula as it was given
                raise ExpressionError(error.message, given_text(error.text), error.position) from None
        else:
            _ = self.symbolic_hamiltonian

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates of phase space, in the order of the state vector."""
        return self.bracket.variables

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the coordinates, in the order of the state vector."""
        return self.bracket.coordinate_names_in_order

    @cached_property
    def periods(self) -> dict[str, Expr]:
        r"""The periods of the coordinates that are points of circles, by name: $2\pi$ of an angle, that of time."""
        return self.bracket.periods

    @property
    def _names_of_angles(self) -> tuple[str, ...]:
        return self.bracket.angles

    @property
    def clock(self) -> str | None:
        """Name of the coordinate that is time, if the Hamiltonian depends on it: t."""
        return self.bracket.clock

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """What the state consists of, in messages: the fields, then what is found by quadrature."""
        return self.bracket.field_names

    @property
    def vector_length(self) -> int:
        """Number of components of each field: the dimension of the Lie algebra; all where fields are scalars."""
        lengths = {len(components) for components in self.bracket.vectors.values()}
        return lengths.pop() if lengths else self.bracket.dimension

    @property
    def as_given(self) -> AsGiven:
        """What a file of this system has to say, in the words in which it was given."""
        given = self._given_hamiltonian
        return AsGiven(
            given_text(given) if isinstance(given, str) else None,
            tuple(self._given_symbols),
            dict(self._given_integrals),
            dict(self._given_partial_integrals),
        )

    @cached_property
    def text(self) -> str | None:
        """The text of a system file from which `read_system` gives the same system; None if there is none."""
        try:
            return function_of("System.text")(self)
        except SystemFileError:
            return None

    @cached_property
    def symbolic_hamiltonian(self) -> Expr:
        """The Hamiltonian with its parameters as symbols, as it was given.

        Raises:
            ParameterError: the given function does not return a SymPy expression.
        """
        given: Any = self._given_hamiltonian
        if not isinstance(given, str) and not is_expression(given):
            given = apply_function(given, self.bracket)
        return self._read(given)

    @cached_property
    def hamiltonian(self) -> Expr:
        """The Hamiltonian as a SymPy expression, with the parameters inserted.

        Raises:
            ParameterError: a parameter does not occur, or the Hamiltonian is not finite and real.
        """
        self._check_that_parameters_occur()
        energy = self._with_parameters(self.symbolic_hamiltonian)
        check_real(energy)
        return energy

    @property
    def polynomial_hamiltonian(self) -> RationalPolynomial | None:
        """The Hamiltonian as a polynomial with rational coefficients, read without SymPy.

        None where it was not given as the text of one, and where the bracket or a parameter is not rational.
        """
        return None if self._polynomials is None else self._polynomials.hamiltonian

    @property
    def polynomial_rates(self) -> tuple[RationalPolynomial, ...] | None:
        """The equations of motion of such a Hamiltonian, derived from the bracket without SymPy; None for others."""
        return None if self._polynomials is None else self._polynomials.rates

    @cached_property
    def polynomial_invariants(self) -> dict[str, RationalPolynomial] | None:
        """The `invariants` of such a Hamiltonian without SymPy; None where one of them is no rational polynomial."""
        view = self._polynomials
        return None if view is None else view.invariants(self.top_parameters, self._given_integrals)

    @cached_property
    def _polynomials(self) -> PolynomialView | None:
        """The system in rational polynomials, if it consists of such."""
        given = self._given_hamiltonian
        if not isinstance(given, str) or self._given_symbols:
            return None
        from liepoisson.model.polynomial_view import PolynomialView

        return PolynomialView.of(self.symbolic_bracket, self.bracket, self._kept_values, given)

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, derived from the bracket, in the order of `variables`."""
        return ReadOnlyDict(zip(self.variables, self.bracket.vector_field(self.hamiltonian), strict=True))

    @cached_property
    def partial_integrals(self) -> dict[str, tuple[Expr, Expr]]:
        """Integrals on an invariant set, each with the function that vanishes there; claims, not proofs."""
        given = self._given_partial_integrals.items()
        return {name: (self._function(integral), self._function(zero)) for name, (integral, zero) in given}

    @cached_property
    def invariants(self) -> dict[str, Expr]:
        """What is known to be constant: H, the Casimirs C1, C2, ..., and the known integrals of this case.

        For a top (typed by hand or made by `Top`) see `liepoisson.model.known_integrals`; then the integrals that were
        given.

        Raises:
            ParameterError: a given integral is not constant.
        """
        from liepoisson.model.known_integrals import known_integrals

        found: dict[str, Expr] = {"H": self.hamiltonian}
        found |= {f"C{k}": casimir for k, casimir in enumerate(self.bracket.casimirs(), start=1)}
        top = self.top_parameters
        if top is not None:
            found |= known_integrals(top, *self.bracket.fields.values())
        return ReadOnlyDict(self._with_integrals(found))

    def derivative(self, function: str | Expr) -> Expr:
        r"""The time derivative $\{f, H\}$ of a function on phase space, simplified when it is not a polynomial.

        Args:
            function: A SymPy expression in `variables`, or a text like that of a Hamiltonian.
        """
        from sympy import simplify

        from liepoisson.structure.trace import abbreviated

        value: Any
        value, traces = abbreviated(self.bracket(self._function(function), self.hamiltonian))
        polynomial = value == 0 or value.is_polynomial(*self.variables, *traces)
        simplified: Any = value if polynomial else simplify(cast("Expr", value))
        return simplified.xreplace(traces)

    def is_casimir(self, function: str | Expr | PhaseFunction) -> bool:
        r"""Whether $\{f, x_j\} = 0$ for all coordinates, as for a number and a Casimir."""
        polynomial = self.polynomial(function)
        if polynomial is not None and self._polynomials is not None:
            known = self._polynomials.is_casimir(polynomial)
            if known is not None:
                return known
        return self.bracket.is_casimir(self.expression(function))

    @cached_property
    def top_parameters(self) -> TopParameters | None:
        """The exact parameters of the top with these equations, or None if there is no such top."""
        return self._recognise_top()

    def field(self) -> Field:
        """The vector field as plain data for the numeric core: a top, a quadratic field or a tape.

        The kind is found by matching the derived equations, not by how the system was made.

        Raises:
            UnsupportedFieldError: the Hamiltonian contains a function that is not smooth.
            ParameterError: a parameter is symbolic.
        """
        top = self.top_parameters
        field = self._general_field if top is None or not self._is_held_by(top) else top.field()
        return with_size_limits(field, self.size_limits)

    def _is_held_by(self, top: TopParameters) -> bool:
        """Whether the plain data of this top, whose moments are doubles, are the equations that were given."""
        return top.is_kept_by_doubles()

    @cached_property
    def _general_field(self) -> Field:
        if self._typed is not None:
            return field_of(self._typed.field(general=True))
        from liepoisson.compile.lowering import lower

        return lower(self.bracket, self.hamiltonian)

    @cached_property
    def _typed_invariants(self) -> dict[str, PhaseFunction] | None:
        """The `invariants` of a system that the core reads, by their texts and polynomials, without SymPy.

        None where the Casimirs are no rational polynomials, for a top, and where given integrals are not proved yet.
        """
        texts = {name: text for name, text in self._given_integrals.items() if isinstance(text, str)}
        read = self.typed_hamiltonian is not None and len(texts) == len(self._given_integrals)
        if not read or (texts and not self.integrals_are_proved) or self.top_parameters is not None:
            return None
        if self.bracket.polynomial_casimirs() is None:
            return None
        found = {"H": self.functions.energy, **self.functions.casimirs}
        return found | {name: self.functions.of_text(text) for name, text in texts.items() if name not in found}

    @property
    def typed_hamiltonian(self) -> str | None:
        """The text of the Hamiltonian, if the core reads it without SymPy, with numbers for all parameters."""
        given = self._given_hamiltonian
        return given if isinstance(given, str) and self._typed is not None else None

    @cached_property
    def _typed(self) -> TypedSystem | None:
        """The system as the core reads it; None where it was not given as a text, or where SymPy has to read that."""
        given = self._given_hamiltonian
        if not isinstance(given, str) or self._given_symbols:
            return None
        typed = read_system(names_of(self.bracket), self.bracket, given, self._kept_values)
        if typed is None:
            return None
        known = self.symbolic_bracket.symbols.union(typed.parameters())
        occur = all(known & set(flattened({name: value})) for name, value in self._kept_values.items())
        return typed if occur else None  # a parameter that drops out is refused where SymPy reads the formula

    def _scope_with(self, *further: str) -> Scope:
        values = cast("Mapping[str, GivenValue]", self._kept_values)
        return scope_of(self.symbolic_bracket, values, (*self._given_symbols, *further))

    @property
    def _given_functions(self) -> dict[str, str | Expr]:
        given = self._given_hamiltonian
        return {"H": given if isinstance(given, str) else self.hamiltonian, **self._given_integrals}

    @property
    def _names_of_state(self) -> Names:
        return names_of(self.bracket)

    def pieces(self) -> PiecesField:
        """The Hamiltonian as a sum of pieces with known flows, for splitting methods.

        Raises:
            UnsupportedFieldError: the Hamiltonian is not a polynomial, or has too many pieces.
            ParameterError: a parameter is symbolic.
        """
        from liepoisson.compile.split_terms import pieces_of

        return pieces_of(self.bracket, self.polynomial_hamiltonian or self.hamiltonian)

    @cached_property
    def casimir_part(self) -> CasimirPart:
        """What in the Hamiltonian is a function of the Casimirs, which moves nothing."""
        from liepoisson.structure.casimir_part import CasimirPart, casimir_part

        if len(self.component_names) != self.bracket.dimension:  # coordinates found by quadrature are none of a leaf
            return CasimirPart(None, {}, None)
        return casimir_part(self.bracket, self.polynomial_hamiltonian or self.hamiltonian)

    @cached_property
    def moving(self) -> System:
        """The system without `casimir_part` in its Hamiltonian; the system itself where there is none.

        The equations are the same, and on a leaf the energies differ by a number: what searches for states and orbits
        look at.
        """
        from liepoisson.model.hamiltonian import symbols_in
        from liepoisson.structure.casimir_part import CasimirPart

        energy: Any = self.casimir_part.moving
        if energy is None:
            return self
        symbols = () if isinstance(energy, str) else symbols_in(energy, self.component_names)
        found = System(self.bracket, energy, name=self.name, symbols=symbols, integrals=self.integrals)
        found.casimir_part = CasimirPart(None, {}, None)
        return found

    @cached_property
    def functions(self) -> PhaseFunctions:
        """Energy, Casimirs, Poisson tensor and any other function on phase space, as functions of arrays."""
        from liepoisson.model.phase_functions import PhaseFunctions

        return PhaseFunctions(self)

    def __str__(self) -> str:
        """The bracket, the Hamiltonian, the equations and the invariants; `inspect` has the full report."""
        return function_of("System.__str__")(self)

    def _repr_latex_(self) -> str:
        """What a notebook shows: Hamiltonian, equations and invariants."""
        return function_of("System._repr_latex_")(self)

    def __repr__(self) -> str:
        return f"<System {self.name!r} on {self.bracket!r}>"

    if not TYPE_CHECKING:  # for type checkers, what is not there has no type

        def __getattr__(self, name: str) -> object:
            """The error of a name that is not there, and where else it is: of the bracket or among the functions."""
            from liepoisson.model.phase_functions import PhaseFunctions

            message = f"{type(self).__name__!r} object has no attribute {name!r}"
            if not name.startswith("_"):
                parts = (("bracket", Bracket), ("functions", PhaseFunctions))
                found = [
                    f"system.{part}.{name}{'()' if callable(getattr(kind, name)) else ''}"
                    for part, kind in parts
                    if hasattr(kind, name)
                ]
                hint = did_you_mean(name, [other for other in dir(type(self)) if not other.startswith("_")]).strip()
                message += f"; write {' or '.join(found)}" if found else f". {hint}" if hint else ""
            raise AttributeError(message, name=name, obj=self)

    def _recognise_top(self) -> TopParameters | None:
        if self.bracket.dimension != 9 or not self.bracket.has_algebra or self.bracket.constant_rows:
            return None
        if self.polynomial_hamiltonian is None and self._typed is not None and self._general_field.kind == "tape":
            return None  # the equations of a top are of degree two
        from liepoisson.model.top_parameters import recognised_top

        return recognised_top(self)

    def _check_that_parameters_occur(self) -> None:
        known = self.symbolic_bracket.symbols | {str(symbol) for symbol in self.symbolic_hamiltonian.free_symbols}
        known -= set(self.component_names)
        for name, value in self.values.items():
            if not known & set(flattened({name: value})):
                raise ParameterError(
                    f"a parameter must occur in the bracket or in the Hamiltonian; {name!r} occurs in neither. "
                    + (f"Known there: {', '.join(sorted(known))}." if known else "Leave it out.")
                )
