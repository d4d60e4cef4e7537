r"""Canonical Hamiltonian systems: coordinates, momenta and a Hamiltonian, ready to be integrated.

$$\dot q_k = \partial H/\partial p_k, \qquad \dot p_k = -\partial H/\partial q_k .$$
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.arrays import Array
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.exact.formula.scope import Scope
from liepoisson.exact.hamiltonian import GivenValue, is_expression
from liepoisson.exact.names import check_name
from liepoisson.field import QuadraticField, TapeField, TapeFunction

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

    from liepoisson.exact.phase_functions import PhaseFunction


class CanonicalSystem:
    r"""A system in canonical coordinates, $\dot q_k = \partial H/\partial p_k$, $\dot p_k = -\partial H/\partial q_k$.

    The state is $z = (q_1, \dots, q_n, p_1, \dots, p_n)$, followed by what is found by quadrature.  It is integrated by
    `lp.integrate` like any system: a Hamiltonian with square roots and trigonometric functions becomes a tape.

    Args:
        coordinates: Names of the coordinates q.
        momenta: Names of the momenta p, in the order of the coordinates to which they belong.
        hamiltonian: A text in these names (see `liepoisson.exact.expression`), or a SymPy expression in symbols of
            these names.
        parameters: Values of other names in a text: numbers, vectors or matrices.
        quadratures: Further components of the state by name, with their rates as functions of q and p: the cyclic
            angle of a reduced system.
        name: How the system is called.

    Raises:
        ShapeError: there is not one momentum for each coordinate.
        ParameterError: a name stands for two things or is no identifier, or the Hamiltonian is of another kind.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
    """

    def __init__(
        self,
        coordinates: Sequence[str],
        momenta: Sequence[str],
        hamiltonian: str | Expr,
        *,
        parameters: Mapping[str, GivenValue] | None = None,
        quadratures: Mapping[str, str | Expr] | None = None,
        name: str = "canonical system",
    ) -> None:
        if not all(_are_names(names) for names in (coordinates, momenta)) or len(coordinates) != len(momenta):
            raise ShapeError(
                f"a canonical system needs one momentum for each coordinate; got {coordinates!r:.60} "
                f"and {momenta!r:.60}. "
                f'Write for example CanonicalSystem(["x"], ["p"], "p^2/2 + x^2/2").'
            )
        if quadratures is not None and not _is_mapping(quadratures):
            raise ParameterError(
                f"quadratures must be a mapping from names to rates; got {quadratures!r:.60}. Write for example "
                '{"psi": "p_psi"}.'
            )
        extra = dict(quadratures or {})
        self.name: str = name
        self.coordinates: tuple[str, ...] = tuple(coordinates)
        self.momenta: tuple[str, ...] = tuple(momenta)
        self.component_names: tuple[str, ...] = (*self.coordinates, *self.momenta, *extra)
        for component in self.component_names:
            check_name(component, "the name of a coordinate")
        self._scope = Scope(parameters=parameters or {}, symbols=self.component_names)
        self.hamiltonian: Expr = self.expression(hamiltonian)
        self.quadratures: dict[str, Expr] = {angle: self.expression(rate) for angle, rate in extra.items()}

    @property
    def n_degrees(self) -> int:
        """Number of degrees of freedom: pairs of a coordinate and its momentum."""
        return len(self.coordinates)

    @cached_property
    def variables(self) -> tuple[Symbol, ...]:
        """The components of the state as symbols."""
        from sympy import Symbol

        return tuple(Symbol(name) for name in self.component_names)

    @property
    def pairs(self) -> list[tuple[Symbol, Symbol]]:
        """Each coordinate with its momentum."""
        n = self.n_degrees
        return list(zip(self.variables[:n], self.variables[n : 2 * n], strict=True))

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, in the order of the state."""
        H: Any = self.hamiltonian
        rates = [H.diff(p) for _, p in self.pairs] + [-H.diff(q) for q, _ in self.pairs]
        return dict(zip(self.variables, (*rates, *self.quadratures.values()), strict=True))

    @property
    def jacobian(self) -> Matrix:
        r"""The matrix $\partial\dot z_i/\partial z_j$ of the equations of motion."""
        from sympy import Matrix

        return Matrix(list(self.equations.values())).jacobian(self.variables)

    def bracket(self, f: str | Expr, g: str | Expr) -> Expr:
        r"""The canonical bracket $\sum_k \partial_{q_k} f\,\partial_{p_k} g - \partial_{p_k} f\,\partial_{q_k} g$."""
        from sympy import Add

        first, second = cast("Any", self.expression(f)), cast("Any", self.expression(g))
        return Add(*(first.diff(q) * second.diff(p) - first.diff(p) * second.diff(q) for q, p in self.pairs))

    def field(self) -> QuadraticField | TapeField:
        """The vector field as plain data for the numeric core: sparse and quadratic if it can be, else a tape.

        Raises:
            UnsupportedFieldError: the Hamiltonian contains a function that is not smooth.
            ParameterError: a parameter is symbolic.
        """
        return self._field

    @cached_property
    def _field(self) -> QuadraticField | TapeField:
        from liepoisson.exact.lowering import quadratic_of_equations, tape_of_equations

        rates: list[Any] = list(self.equations.values())
        self._refuse_symbols(rates)
        if all(rate.is_polynomial(*self.variables) and self._degree(rate) <= 2 for rate in rates):
            return quadratic_of_equations(self.variables, rates)
        return tape_of_equations(self.variables, rates)

    def expression(self, function: str | Expr) -> Expr:
        """A function of the state: a text in the names of the components, or an expression as it is.

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: neither a text nor a SymPy expression.
        """
        from liepoisson.exact.expression import read_expression

        if isinstance(function, str):
            return read_expression(function, self._scope, insert_values=True)
        if not is_expression(function):
            raise ParameterError(
                f"a function must be a text or a SymPy expression; got {type(function).__name__}. "
                'Write for example "p_theta^2/2".'
            )
        return function

    def function_tape(self, *functions: str | Expr) -> TapeFunction:
        """Functions of the state as plain data for the numeric core, one output each.

        Raises:
            UnsupportedFieldError: a function is not smooth.
            ParameterError: a parameter is symbolic.
        """
        from liepoisson.exact.lowering import tape_of_functions

        return tape_of_functions(self.variables, [self.expression(function) for function in functions])

    @cached_property
    def functions(self) -> CanonicalFunctions:
        """The energy and any other function of the state, as functions of arrays."""
        return CanonicalFunctions(self)

    def vector_field(self, z: ArrayLike) -> Array:
        """The right-hand sides at many states, shape (..., N)."""
        return self.functions.rates(z)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: everything but the compiled functions."""
        return {name: value for name, value in self.__dict__.items() if name != "functions"}

    def __repr__(self) -> str:
        return f"<CanonicalSystem {self.name!r} in {', '.join(self.component_names)}>"

    def _degree(self, rate: Any) -> int:
        from sympy import Poly

        return 0 if rate == 0 else Poly(rate, *self.variables).total_degree()

    def _refuse_symbols(self, expressions: Sequence[Any]) -> None:
        free = {str(symbol) for expression in expressions for symbol in expression.free_symbols}
        if missing := sorted(free - set(self.component_names)):
            raise ParameterError(
                f"every parameter must be a number for numerical work; {', '.join(missing)} has none. Give values."
            )


def _are_names(given: object) -> bool:
    """Whether it is a sequence of texts, not empty."""
    if isinstance(given, str) or not isinstance(given, Sequence) or not given:
        return False
    return all(isinstance(name, str) for name in cast("Sequence[object]", given))


def _is_mapping(given: object) -> bool:
    return isinstance(given, Mapping)


class CanonicalFunctions:
    """The functions of the state of a canonical system, ready for arrays of shape (..., N)."""

    def __init__(self, system: CanonicalSystem) -> None:
        self._system = system

    @property
    def energy(self) -> PhaseFunction:
        """The Hamiltonian."""
        return self.of(self._system.hamiltonian)

    def of(self, function: str | Expr) -> PhaseFunction:
        """Any function of the state, with its derivatives."""
        from liepoisson.exact.phase_functions import PhaseFunction

        expression = self._system.expression(function)
        return PhaseFunction(cast("Any", _Named(self._system)), expression)

    def rates(self, z: ArrayLike) -> Array:
        """The right-hand sides of the equations of motion, shape (..., N)."""
        return self._evaluate(tuple(self._system.equations.values()), z)

    def jacobian(self, z: ArrayLike) -> Array:
        r"""Their derivatives $\partial\dot z_i/\partial z_j$, shape (..., N, N)."""
        n = len(self._system.component_names)
        values = self._evaluate(tuple(cast("Any", self._system.jacobian)), z)
        return values.reshape(*values.shape[:-1], n, n)

    def poisson_tensor(self, z: ArrayLike) -> Array:
        r"""The canonical tensor $\{z_i, z_j\}$, the same at every state, shape (..., N, N)."""
        n = self._system.n_degrees
        states = self._states(z)
        tensor = np.zeros((*states.shape, states.shape[-1]))
        for k in range(n):
            tensor[..., k, n + k], tensor[..., n + k, k] = 1.0, -1.0
        return tensor

    def _states(self, z: ArrayLike) -> Array:
        from liepoisson.exact.phase_functions import as_phase_points

        return as_phase_points(z, len(self._system.component_names), self._system.component_names)

    def _evaluate(self, expressions: tuple[Any, ...], z: ArrayLike) -> Array:
        from liepoisson.exact.phase_functions import evaluated

        return evaluated(self._system.variables, expressions, self._states(z))


class _Named:
    """What a function on phase space asks of its system: variables, and the names of the parts of the state."""

    def __init__(self, system: CanonicalSystem) -> None:
        self.name = system.name
        self.variables = system.variables
        self.bracket = self
        self.field_names = system.component_names
