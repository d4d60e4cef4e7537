r"""Canonical Hamiltonian systems: coordinates, momenta and a Hamiltonian, and what is found by quadrature.

$$\dot q_k = \partial H/\partial p_k, \qquad \dot p_k = -\partial H/\partial q_k .$$
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from liepoisson.compile.field import Field
from liepoisson.compile.typed import Names
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import GivenValue
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import by_name, listed_names
from liepoisson.inputs.names import check_name
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.model.hamiltonian import Hamiltonian, is_expression, read_declarations
from liepoisson.model.system import System
from liepoisson.structure.canonical_bracket import canonical

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson._core import TypedSystem


@explains_its_methods
class CanonicalSystem(System):
    r"""A system in canonical coordinates, $\dot q_k = \partial H/\partial p_k$, $\dot p_k = -\partial H/\partial q_k$.

    A `System` on `canonical(names=coordinates, momenta=momenta)`, whose state $z = (q_1, \dots, q_n, p_1, \dots, p_n)$
    may be followed by quadratures: components that follow the motion and do not act on it.  They belong to no bracket,
    so that leaves and equilibria are those of a system without them.

    Example:
        >>> H, turns = "p^2/2 - cos(theta)", {"turns": "p/(2*pi)"}
        >>> pendulum = lp.systems.CanonicalSystem(["theta"], ["p"], H, quadratures=turns)
        >>> pendulum.equations
        {theta: p, p: -sin(theta), turns: p/(2*pi)}
        >>> run = lp.integrate(pendulum, {"p": 3}, t_end=10)
        >>> round(float(run.end_state[0, 2]), 6)  # it goes over the top
        4.163196

    Args:
        coordinates: Names of the coordinates q.
        momenta: Names of the momenta p, in the order of the coordinates to which they belong.
        hamiltonian: A text in these names (see `liepoisson.formula.expression`), or a SymPy expression in symbols of
            these names.
        parameters: Values of other names in a text: numbers, vectors or matrices.
        quadratures: Further components of the state by name, with their rates as functions of q and p: the cyclic
            angle of a reduced system.  Neither the Hamiltonian nor a rate may contain them.
        symbols: Names that stay symbolic; a vector with its length, as in "a[3]".
        angles: The coordinates that are angles, modulo $2\pi$, in which all formulas must be periodic.
        name: How the system is called.
        integrals: Further known integrals by name; claims, which `inspect` proves.
        source: Where the system is described.

    Raises:
        ShapeError: there is not one momentum for each coordinate.
        ParameterError: a name stands for two things or is no identifier, the Hamiltonian is of another kind, or it or
            the rate of a quadrature contains a quadrature.
        BracketError: a parameter is named like a coordinate, or an angle is no coordinate.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
    """

    _knows_time = False

    def __init__(
        self,
        coordinates: Sequence[str],
        momenta: Sequence[str],
        hamiltonian: Hamiltonian,
        *,
        parameters: Mapping[str, GivenValue] | None = None,
        quadratures: Mapping[str, str | Expr] | None = None,
        symbols: Sequence[str] = (),
        angles: Sequence[str] = (),
        name: str = "canonical system",
        integrals: Mapping[str, str | Expr] | None = None,
        source: str | None = None,
    ) -> None:
        given = f"{coordinates!r:.60} and {momenta!r:.60}"
        coordinates, momenta = _names(coordinates, "coordinates"), _names(momenta, "momenta")
        if not coordinates or len(coordinates) != len(momenta):
            raise ShapeError(
                f"a canonical system needs one momentum for each coordinate; got {given}. "
                f'Write for example CanonicalSystem(["x"], ["p"], "p^2/2 + x^2/2").'
            )
        parameters = {} if parameters is None else by_name(parameters, "parameters", "values", '{"k": 1}')
        rates = {} if quadratures is None else quadratures
        extra = by_name(rates, "quadratures", "rates", '{"psi": "p_psi"}')
        for component in (*coordinates, *momenta, *extra):
            check_name(component, "the name of a coordinate")
        self._scope = Scope(
            parameters=parameters, symbols=(*coordinates, *momenta, *extra, *read_declarations(symbols))
        )
        self._quadrature_names: tuple[str, ...] = tuple(extra)
        bracket = canonical(names=coordinates, momenta=momenta, angles=angles)
        super().__init__(
            bracket,
            hamiltonian,
            parameters,
            name=name,
            symbols=(*extra, *symbols),
            integrals=integrals,
            source=source,
        )
        self.quadratures: dict[str, Expr] = {angle: self._function(rate) for angle, rate in extra.items()}
        if extra:
            self._refuse_quadratures("the Hamiltonian", self.hamiltonian)
            for angle, rate in self.quadratures.items():
                self._refuse_quadratures(f"the rate of {angle}", rate)
            rates_on_circles = {f"the rate of {angle}": rate for angle, rate in self.quadratures.items()}
            self._check_on_circles(rates_on_circles, "Leave {name} out of angles.")

    def _refuse_quadratures(self, name: str, expression: Any) -> None:
        """What acts on the motion is no quadrature."""
        if found := sorted(str(symbol) for symbol in expression.free_symbols & {*self._quadrature_symbols}):
            raise ParameterError(
                f"{name} must be a function of the coordinates and momenta; got {expression!s:.60} with the quadrature "
                f"{', '.join(found)}, which follows the motion and does not act on it. Make it a coordinate with a "
                "momentum."
            )

    @property
    def n_degrees(self) -> int:
        """Number of degrees of freedom: pairs of a coordinate and its momentum."""
        return self.bracket.dimension // 2

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return self.bracket.coordinate_names_in_order[: self.n_degrees]

    @property
    def momenta(self) -> tuple[str, ...]:
        """Names of the momenta."""
        return self.bracket.coordinate_names_in_order[self.n_degrees :]

    @property
    def component_names(self) -> tuple[str, ...]:
        """Coordinates, momenta and quadratures, in the order of the state."""
        return (*self.bracket.coordinate_names_in_order, *self._quadrature_names)

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """The same: each component is a scalar."""
        return self.component_names

    @property
    def vector_length(self) -> int:
        """Number of components that random starts give the length one together: three if they are triples, else all."""
        n = len(self.component_names)
        return 3 if n % 3 == 0 else n

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The components of the state as symbols."""
        return (*self.bracket.variables, *self._quadrature_symbols)

    @cached_property
    def _quadrature_symbols(self) -> tuple[Symbol, ...]:
        from sympy import Symbol

        return tuple(Symbol(name) for name in self._quadrature_names)

    @property
    def pairs(self) -> list[tuple[Symbol, Symbol]]:
        """Each coordinate with its momentum."""
        n = self.n_degrees
        return list(zip(self.variables[:n], self.variables[n : 2 * n], strict=True))

    @cached_property
    def hamiltonian(self) -> Expr:
        """The Hamiltonian as a SymPy expression, with the parameters inserted."""
        given: Any = self._given_hamiltonian
        return self._function(given if isinstance(given, str) else self.symbolic_hamiltonian)

    @cached_property
    def _polynomials(self) -> None:
        """None: quadratures, which belong to no bracket, are read by SymPy."""
        return

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, in the order of the state; not expanded."""
        H: Any = self.hamiltonian
        rates = [H.diff(p) for _, p in self.pairs] + [-H.diff(q) for q, _ in self.pairs]
        return ReadOnlyDict(zip(self.variables, (*rates, *self.quadratures.values()), strict=True))

    def derivative(self, function: str | Expr) -> Expr:
        r"""The time derivative of a function of the state, $\{f, H\}$ and the rates of the quadratures in it."""
        from sympy import Symbol, simplify

        f: Any = self._function(function)
        total: Any = super().derivative(f)
        for name, rate in self.quadratures.items():
            total += f.diff(Symbol(name)) * rate
        return total if total.is_polynomial(*self.variables) else simplify(total)

    @cached_property
    def _typed(self) -> TypedSystem | None:
        """As of any system; None where there are quadratures, which belong to no bracket."""
        return None if self._quadrature_names else super()._typed

    @property
    def _names_of_state(self) -> Names:
        return self.component_names

    @cached_property
    def _general_field(self) -> Field:
        from liepoisson.compile.lowering import field_of_equations

        if self._typed is not None:
            return super()._general_field
        rates: list[Any] = list(self.equations.values())
        self._refuse_symbols(rates)
        return field_of_equations(self.variables, rates)

    def _read(self, given: str | Expr, *, angles: bool = False) -> Expr:
        """A function of the state with parameters as symbols; expressions are taken as they are."""
        return super()._read(given, angles=angles) if isinstance(given, str) else self._read_expression(given)

    def _function(self, given: str | Expr, *, angles: bool = False) -> Expr:
        """A function of the state with values for the parameters.

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: neither a text nor a SymPy expression.
        """
        from liepoisson.formula.expression import read_expression

        if isinstance(given, str):
            return read_expression(given, self._scope, insert_values=True, angles=angles)
        if not is_expression(given):
            raise ParameterError(
                f"a function must be a text or a SymPy expression; got {type(given).__name__}. "
                'Write for example "p_theta^2/2".'
            )
        expression = self._read_expression(given)
        return self._with_parameters(expression) if self.parameters else expression

    def __repr__(self) -> str:
        return f"<CanonicalSystem {self.name!r} in {', '.join(self.component_names)}>"

    def _refuse_symbols(self, expressions: Sequence[Any]) -> None:
        free = {str(symbol) for expression in expressions for symbol in expression.free_symbols}
        if missing := sorted(free - set(self.component_names)):
            raise ParameterError(
                f"every parameter must be a number for numerical work; got none for {', '.join(missing)}. Give values."
            )


def _names(given: object, what: str) -> tuple[str, ...]:
    """A sequence of texts; none where it is something else."""
    names = listed_names(given, what) or []
    return tuple(names) if all(isinstance(name, str) for name in names) else ()
