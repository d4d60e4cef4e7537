"""Systems: a bracket and a Hamiltonian, from which everything else follows."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from liepoisson.algebra.exact_numbers import Exact, substituted, symbols_of, to_sympy
from liepoisson.algebra.rational_polynomials import values_of
from liepoisson.compile.field import Field, PiecesField, TapeFunction, field_of
from liepoisson.compile.typed import Names, names_of, read_system
from liepoisson.errors import ExpressionError, LiePoissonError, ParameterError, SystemFileError, did_you_mean
from liepoisson.facades import function_of
from liepoisson.formula.parameters import GivenValue, Value, flattened, read_values
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.names import check_title
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.model.hamiltonian import (
    RESERVED_NAME,
    Hamiltonian,
    apply_function,
    check_hamiltonian,
    check_real,
    is_expression,
    read_declarations,
    read_expression_in,
    read_functions,
    read_pairs_of_functions,
    scope_of,
    with_exact_numbers,
)
from liepoisson.structure.bracket import Bracket, with_coefficients
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray
    from sympy import Expr, Matrix, Symbol

    from liepoisson._core import TypedSystem
    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.formula.scope import Scope
    from liepoisson.model.phase_functions import PhaseFunction, PhaseFunctions
    from liepoisson.model.polynomial_view import PolynomialView
    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.casimir_part import CasimirPart

_NAME = re.compile(r"[A-Za-z_]\w*")


@lru_cache(maxsize=1024)
def _symbols_in(expressions: tuple[Expr, ...]) -> frozenset[Symbol]:
    """The symbols of expressions, which are looked through once."""
    return frozenset(cast("Symbol", symbol) for expression in expressions for symbol in expression.free_symbols)


def _check_source(source: object) -> str:
    if not isinstance(source, str) or not source.strip() or any("\ud800" <= c <= "\udfff" for c in source):
        raise ParameterError(f"source: wanted a text that says where the system is described; got {shown(source)}")
    return source


def _bracket_hint(given: Any) -> str:
    """How a bracket is made of what was given in its place."""
    if isinstance(given, LieAlgebra):
        vectors = "; or so(3) @ semidirect(2), the same with two vectors l and alpha" if given.name == "se(3)" else ""
        return f"a Lie algebra is half of one: write {given!r} @ trivial(){vectors}"
    if isinstance(given, Extension):
        return "an extension is half of one: write so(3) @ extension"
    return "write for example so(3) @ leibniz(3, 1), or PoissonTensor(variables, entries)"


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
class System:
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
        name: How the system is called in texts and files.
        symbols: Parameters that stay symbolic, besides those of the bracket; a vector with its length, as in "a[3]".
        integrals: Further known integrals by name, as text or expressions.  They are claims: `inspect` proves them.
        partial_integrals: The same for integrals on an invariant set: name -> (integral, function that vanishes there).
        source: Where the system is described.

    Raises:
        ParameterError: the Hamiltonian is of none of these kinds, or has a part that is neither a coordinate nor a
            declared parameter, or a function that is not smooth; `parameters` is not a mapping from names, or a
            parameter is not exact.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        BracketError: a parameter is named like a coordinate.
    """

    @explains_its_arguments
    def __init__(
        self,
        bracket: Bracket,
        hamiltonian: Hamiltonian,
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        name: str | None = None,
        symbols: Sequence[str] = (),
        integrals: Mapping[str, str | Expr] | None = None,
        partial_integrals: Mapping[str, tuple[str | Expr, str | Expr]] | None = None,
        source: str | None = None,
    ) -> None:
        if not isinstance(bracket, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise not_a("a Bracket", bracket, "bracket", _bracket_hint(bracket))
        check_hamiltonian(hamiltonian, bracket)
        self._given_hamiltonian = hamiltonian
        self._given_symbols = read_declarations(symbols)
        self._given_integrals = read_functions(integrals, "integrals")
        self._given_partial_integrals = read_pairs_of_functions(partial_integrals)
        self.values: dict[str, Value] = ReadOnlyDict(read_values(parameters))
        self.parameters: dict[str, Exact] = ReadOnlyDict(flattened(self.values))
        bracket.check_parameter_names(set(self.parameters).union(*map(symbols_of, self.parameters.values())))
        self._check_that_values_are_final()
        self.symbolic_bracket: Bracket = bracket
        of_bracket = {name: value for name, value in self.parameters.items() if name in bracket.symbols}
        self.bracket: Bracket = bracket.substitute(of_bracket)
        is_lie_poisson = bracket.has_algebra and not bracket.constant
        default = "Lie-Poisson system" if is_lie_poisson else "Hamiltonian system"
        self.name: str = default if name is None else check_title(name, "the name of a system")
        self.source: str | None = source if source is None else _check_source(source)
        self.bracket = with_coefficients(self.bracket, self._parameter_names)
        self._check_hamiltonian()

    def _check_hamiltonian(self) -> None:
        """Read the Hamiltonian, so that its errors come where it is written."""
        if isinstance(self._given_hamiltonian, str):
            _ = self.polynomial_hamiltonian or self._typed or self.hamiltonian
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

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """What the state consists of, in messages: the fields, then what is found by quadrature."""
        return self.bracket.field_names

    @property
    def vector_length(self) -> int:
        """Number of components of each field: the dimension of the Lie algebra; all where fields are scalars."""
        return self.bracket.dimension if self.bracket.has_scalar_fields else self.bracket.algebra.dimension

    @property
    def as_given(self) -> AsGiven:
        """What a file of this system has to say, in the words in which it was given."""
        given = self._given_hamiltonian
        return AsGiven(
            given if isinstance(given, str) else None,
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

    def polynomial(self, function: str | Expr | PhaseFunction) -> RationalPolynomial | None:
        """What `expression` returns, as a rational polynomial and without SymPy; None if it is not the text of one."""
        if not isinstance(function, str) or self._polynomials is None:
            return None
        name = function.strip()
        if RESERVED_NAME.fullmatch(name) or name in self._given_integrals:
            return None  # may be the name of an invariant
        return self._polynomials.read(function)

    @cached_property
    def _polynomials(self) -> PolynomialView | None:
        """The system in rational polynomials, if it consists of such."""
        given = self._given_hamiltonian
        if not isinstance(given, str) or self._given_symbols:
            return None
        from liepoisson.model.polynomial_view import PolynomialView

        return PolynomialView.of(self.symbolic_bracket, self.bracket, self.values, given)

    @cached_property
    def _names_in_formulas(self) -> Scope:

        return scope_of(self.symbolic_bracket, self.values, self._given_symbols)

    @cached_property
    def _parameter_names(self) -> tuple[str, ...]:
        """The names of all parameters, and those in their values."""
        in_values = set[str]().union(*map(symbols_of, self.parameters.values()))
        return tuple(sorted((self._names_in_formulas.numbers() | in_values).difference(self.component_names)))

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, derived from the bracket, in the order of `variables`."""
        return ReadOnlyDict(zip(self.variables, self.bracket.vector_field(self.hamiltonian), strict=True))

    @property
    def jacobian(self) -> Matrix:
        r"""The matrix $\partial\dot x_i / \partial x_j$ of the equations of motion, shape (N, N)."""
        from sympy import Matrix

        return Matrix(list(self.equations.values())).jacobian(self.variables)

    @cached_property
    def integrals(self) -> dict[str, Expr]:
        """The integrals that were given, with the parameters inserted; claims, not proofs."""
        return {name: self._function(text) for name, text in self._given_integrals.items()}

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
        for name, integral in self.integrals.items():
            if not self.is_constant(integral):
                raise ParameterError(
                    f"the integral {name} must be constant along the motion; got {integral}, which is not: "
                    f"its derivative is {self.derivative(integral)}. Correct it, or give it as a partial integral."
                )
            found.setdefault(name, integral)
        return ReadOnlyDict(found)

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

    def is_constant(self, function: str | Expr) -> bool:
        """Whether a function on phase space is found constant along every orbit.

        Exact for polynomials and rational functions; for others SymPy has to simplify the derivative to zero, so True
        is a proof and False may mean that it did not succeed.
        """
        polynomial = self.polynomial(function)
        if polynomial is not None and self._polynomials is not None:
            known = self._polynomials.is_constant(polynomial)
            if known is not None:
                return known
        from liepoisson.algebra.exact_numbers import is_zero
        from liepoisson.structure.trace import abbreviated

        return is_zero(abbreviated(self.derivative(function))[0])

    def is_casimir(self, function: str | Expr | PhaseFunction) -> bool:
        r"""Whether $\{f, x_j\} = 0$ for all coordinates, as for a number and a Casimir."""
        polynomial = self.polynomial(function)
        if polynomial is not None and self._polynomials is not None:
            known = self._polynomials.is_casimir(polynomial)
            if known is not None:
                return known
        f = self.expression(function)
        return all(self.bracket(f, component) == 0 for component in self.variables)

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
        return self._general_field if top is None or not self._is_held_by(top) else top.field()

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
    def _typed(self) -> TypedSystem | None:
        """The system as the core reads it; None where it was not given as a text, or where SymPy has to read that."""
        given = self._given_hamiltonian
        if not isinstance(given, str) or self._given_symbols:
            return None
        typed = read_system(names_of(self.bracket), self.bracket, given, self.values)
        if typed is None:
            return None
        known = self.symbolic_bracket.symbols.union(typed.parameters())
        occur = all(known & set(flattened({name: value})) for name, value in self.values.items())
        return typed if occur else None  # a parameter that drops out is refused where SymPy reads the formula

    @cached_property
    def _typed_functions(self) -> TypedSystem | None:
        """The same for functions of the state alone, which may be typed whatever the Hamiltonian is."""
        return None if self._given_symbols else read_system(self._names_of_state, None, "0", self.values)

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

        return pieces_of(self.bracket, self.hamiltonian)

    def vector_field(self, states: ArrayLike) -> NDArray[np.float64]:
        r"""The right-hand side $J \nabla H$ at many states.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            Time derivatives, shape (..., N).

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        import numpy as np

        if self.polynomial_rates is not None:
            return values_of(self.polynomial_rates, self._states(states))
        return np.stack(self._evaluate(list(self.equations.values()), states), axis=-1)

    def right_hand_side(self, time: float, state: ArrayLike) -> NDArray[np.float64]:
        """The vector field in the convention of SciPy, for `scipy.integrate.solve_ivp` and tools like it.

        Args:
            time: Not used: the system is autonomous.
            state: One state, shape (N,).
        """
        return self.vector_field(state)

    def invariant_values(self, states: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The invariants at many states.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            One array of shape (...) per name in `invariants`.

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        if (known := self.polynomial_invariants) is not None:
            values = values_of(known.values(), self._states(states))
            return {name: values[..., k].copy() for k, name in enumerate(known)}
        return dict(zip(self.invariants, self._evaluate(list(self.invariants.values()), states), strict=True))

    def without_value(self, states: ArrayLike) -> dict[str, NDArray[np.bool_]]:
        """Where the Hamiltonian and the given integrals are no real numbers, such as the logarithm of a negative one.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            One array of shape (...) for each of them that has a logarithm, a root, or an inverse sine or cosine.

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        import numpy as np

        if not self._partial_functions:
            return {}
        x = self._states(states)
        return {name: np.isnan(self._values(f, x)) for name, f in self._partial_functions.items()}

    def _values(self, function: TapeFunction | Expr, states: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        from liepoisson.compile.tape_values import values_of_tape

        if isinstance(function, TapeFunction):
            return values_of_tape(function, states)[..., 0]
        with np.errstate(all="ignore"):
            return self._evaluate([function], states)[0]

    @cached_property
    def _partial_functions(self) -> dict[str, TapeFunction | Expr]:
        """Those of the Hamiltonian and the given integrals that are not real at all states; of texts the tapes."""
        from liepoisson.compile.tape_values import has_partial_operations
        from liepoisson.formula.expression import is_partial
        from liepoisson.model.hamiltonian import has_partial_functions

        found: dict[str, TapeFunction | Expr] = {}
        for name, given in {"H": self._given_hamiltonian, **self._given_integrals}.items():
            if isinstance(given, str):
                if is_partial(given) and has_partial_operations(tape := self.function_tape(given)):
                    found[name] = tape
                continue
            function = self.hamiltonian if name == "H" else self._function(cast("Any", given))
            if has_partial_functions(function):
                found[name] = function
        return found

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

    def expression(self, function: str | Expr | PhaseFunction) -> Expr:
        """A function on phase space with the parameters inserted.

        Args:
            function: A text like that of a Hamiltonian, in which angles `atan2(y, x)` may occur, too; or the name of an
                invariant alone (one of the keys of `invariants`, such as "C1"); a SymPy expression; or a PhaseFunction.

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: the function is none of these, or a name alone stands for an invariant and for something
                else, such as C1 for a Casimir and for a component of a parameter C.
        """
        from liepoisson.model.phase_functions import PhaseFunction

        given: Any = function.expression if isinstance(function, PhaseFunction) else function
        if not isinstance(given, str):
            if not is_expression(given):
                raise ParameterError(
                    f"a function on phase space must be a text such as '{self.component_names[0]} - 1/2', a SymPy "
                    f"expression or a PhaseFunction; got {given!r:.60}."
                )
            return self._function(given)
        try:
            expression = self._function(given, angles=True)
        except ExpressionError as error:
            return self._named_invariant(given, error)
        self._check_that_it_names_one_thing(given, expression)
        return expression

    def _check_that_it_names_one_thing(self, text: str, expression: Expr) -> None:
        """Refuse a text that is both a formula and the name of an invariant, where they differ."""
        name = text.strip()
        if not (RESERVED_NAME.fullmatch(name) or name in self._given_integrals):
            return
        invariant = self.invariants.get(name)
        if invariant is not None and invariant != expression:
            raise ParameterError(
                f"a name must stand for one thing; {name} is {expression} in formulas, and the invariant {invariant}. "
                f"Write 1*{name} for the former, system.invariants[{name!r}] for the latter."
            )

    def _named_invariant(self, text: str, error: ExpressionError) -> Expr:
        """The invariant that a text names, which is no formula; if it only contains such a name, say what to write."""
        names = set(_NAME.findall(text))
        known = [name for name in self.invariants if name in names]
        if not known:
            raise error
        if text.strip() == known[0]:
            return self.invariants[known[0]]
        hint = ", ".join(f"system.invariants[{name!r}]" for name in known)
        raise ExpressionError(
            f"{error.message}; an invariant is known by its name only where that is the whole text. Build the "
            f"expression from {hint}",
            text,
            error.position,
        ) from None

    def function_of_invariants(self, text: str) -> Expr:
        """A text like that of a Hamiltonian in which the names of invariants may occur, too: "C1 - 2*H".

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
        """
        from sympy import Symbol

        from liepoisson.formula.expression import read_expression

        try:
            return self.expression(text)
        except ExpressionError:
            names = [name for name in self.invariants if name in set(_NAME.findall(text))]
            if not names:
                raise
        scope = scope_of(self.symbolic_bracket, self.values, (*self._given_symbols, *names))
        read: Any = self._with_parameters(read_expression(text, scope))
        return read.xreplace({Symbol(name): self.invariants[name] for name in names})

    def function_tape(self, *functions: str | Expr) -> TapeFunction:
        """Functions on phase space as plain data for the numeric core, one output each.

        Raises:
            UnsupportedFieldError: a function is not smooth.
            ParameterError: a parameter is symbolic.
        """
        from liepoisson.compile.lowering import functions_of, tape_of_functions

        texts = [function for function in functions if isinstance(function, str)]
        if len(texts) == len(functions) and self._typed_functions is not None:
            try:
                return functions_of(self._typed_functions.functions(texts))
            except LiePoissonError:  # SymPy says what is wrong
                pass
        return tape_of_functions(self.variables, [self._function(function, angles=True) for function in functions])

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: everything but what is made again when it is asked for."""
        made_again = {"functions", "moving", "_typed", "_typed_functions"}
        return {name: value for name, value in self.__dict__.items() if name not in made_again}

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
                    f"system.{part}.{name}{'()' if callable(vars(kind)[name]) else ''}"
                    for part, kind in parts
                    if name in vars(kind)
                ]
                hint = did_you_mean(name, [other for other in dir(type(self)) if not other.startswith("_")]).strip()
                message += f"; write {' or '.join(found)}" if found else f". {hint}" if hint else ""
            raise AttributeError(message, name=name, obj=self)

    def _recognise_top(self) -> TopParameters | None:
        if self.bracket.dimension != 9 or not self.bracket.has_algebra or self.bracket.constant:
            return None
        if self.polynomial_hamiltonian is None and self._typed is not None and self._general_field.kind == "tape":
            return None  # the equations of a top are of degree two
        return function_of("System.top_parameters")(self)

    def _states(self, x: ArrayLike) -> NDArray[np.float64]:
        from liepoisson.model.phase_functions import as_phase_points

        return as_phase_points(x, self.component_names, self.parts_of_state)

    def _evaluate(self, expressions: list[Expr], x: ArrayLike) -> list[NDArray[np.float64]]:
        from liepoisson.compile.symbols import evaluated

        states = self._states(x)
        free = _symbols_in(tuple(expressions)) - set(self.variables)
        if free:
            names = ", ".join(sorted(map(str, free)))
            raise ParameterError(
                f"{self.name} must have numbers for all parameters; got none for {names}. Give values."
            )
        values = evaluated(self.variables, expressions, states)
        return [values[..., k].copy() for k in range(len(expressions))]

    def _read(self, given: str | Expr, *, angles: bool = False) -> Expr:
        """A function on phase space with parameters as symbols: text is read in our grammar."""
        if not isinstance(given, str):
            return self.bracket.in_own_variables(with_exact_numbers(self._read_expression(given)))
        from liepoisson.formula.expression import read_expression

        return read_expression(given, self._names_in_formulas, angles=angles)

    def _read_expression(self, given: object) -> Expr:
        """A function on phase space that is given as an expression, as it is."""
        return read_expression_in(given, self.component_names, self._parameter_names, self.parameters)

    def _function(self, given: str | Expr, *, angles: bool = False) -> Expr:
        return self._with_parameters(self._read(given, angles=angles))

    def _with_parameters(self, expression: Expr) -> Expr:
        """The expression with the parameters inserted, by name: a symbol may have been made with assumptions."""
        return to_sympy(substituted(expression, self.parameters))

    def _check_that_values_are_final(self) -> None:
        """Refuse the value of a parameter that is, or contains, the name of another one with a value."""
        for name, value in self.parameters.items():
            if known := sorted(symbols_of(value) & self.parameters.keys() - {name}):
                raise ParameterError(
                    f"the value of a parameter must not depend on another one that has a value; {name} = {value}, and "
                    f"{known[0]} is {self.parameters[known[0]]}. Write the number."
                )

    def _check_that_parameters_occur(self) -> None:
        known = self.symbolic_bracket.symbols | {str(symbol) for symbol in self.symbolic_hamiltonian.free_symbols}
        known -= set(self.component_names)
        for name, value in self.values.items():
            if not known & set(flattened({name: value})):
                raise ParameterError(
                    f"a parameter must occur in the bracket or in the Hamiltonian; {name!r} occurs in neither. "
                    + (f"Known there: {', '.join(sorted(known))}." if known else "Leave it out.")
                )
