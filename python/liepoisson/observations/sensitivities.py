r"""What a model says at the times of observations, and its derivatives by parameters and starts.

With the parameters p as components of the state that do not move, $x' = f(x, p)$, $p' = 0$, the derivative of an orbit
by a parameter is the tangent vector along p, and that by the start the one along x: both follow from one flow, by the
variational equations of the core.  Functions of the state, in which parameters may occur, too, have exact gradients.

References: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section I.14.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.compile.symbols import evaluated
from liepoisson.errors import ExpressionError, LiePoissonError, ParameterError, did_you_mean
from liepoisson.formula.parameters import flattened
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import shown
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.free_parameter import StateAndParameters, values_of, with_values
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import component_places
from liepoisson.observations.observations import Observations
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr


_SMALLER = 1024.0
"""By how much parameters are smaller than the state: methods find the norm of the state to a thousandth."""


@dataclass(frozen=True)
class Unknown:
    """A number that is looked for.

    Attributes:
        name: What it is called: "I1", or "theta(t0)" of a start, with its run where there are several.
        place: Its place in the state with the parameters behind it.
        run: The run whose start it belongs to; None of a parameter.
    """

    name: str
    place: int
    run: int | None = None


@dataclass(frozen=True)
class Prediction:
    """What a model says for each observation.

    Attributes:
        value: Shape (row, observable); NaN where a trajectory ended before.
        derivative: By the unknowns, shape (row, observable, unknown).
        outcome: How each run ended.
    """

    value: Array
    derivative: Array
    outcome: tuple[str, ...]


class Model:
    """A system beside observations: parameters and starts are numbers that may be unknown.

    Args:
        system: The system, with numbers for all parameters: a `System` or a `VectorField`.
        observed: The observations.
        names: Unknown parameters, by their components: "I1"; and components of the start of each run: "l1".
        guess: A start of each run, shape (run, component): its size decides in which units parameters stand beside it.

    Raises:
        ParameterError: a name is neither a parameter nor a component, or is given twice; a column is no function of
            the state.
    """

    def __init__(self, system: EquationsOfMotion, observed: Observations, names: Sequence[str], guess: Array) -> None:
        self.system, self.observed = system, observed
        parts, clock = parts_of(system), clock_of(system)
        bracketed = hasattr(system, "bracket")
        found = [part for name in names for part in _known(name, parts, has_bracket=bracketed)]
        if twice := sorted({name for name in found if found.count(name) > 1}):
            raise ParameterError(f"unknowns: wanted each number once; {twice[0]} comes twice, also in its vector.")
        components = system.component_names
        self.parameters = tuple(name for name in found if name not in components)
        of_starts = [components.index(name) for name in found if name in components]
        if clock in of_starts:
            raise ParameterError("unknowns: wanted numbers that the data can tell; t is time. Leave it out.")
        n, several = len(components), len(observed.runs) > 1
        self.unknowns: tuple[Unknown, ...] = (
            *(Unknown(name, n + k) for k, name in enumerate(self.parameters)),
            *(
                Unknown(f"{components[i]}(t0){f' of run {name}' if several else ''}", i, r)
                for r, name in enumerate(observed.runs)
                for i in of_starts
            ),
        )
        self.space: Any = system
        self.scale: Array = np.concatenate([np.ones(n), _units(self.numbers, guess)])
        symbolic = system
        if self.parameters:
            symbolic = with_values(system, {name: name for name in self.parameters})
            if symbolic.component_names != components:
                raise ParameterError(
                    "unknowns: wanted starts; the parameters of a system with quadratures cannot be looked for; give "
                    "the quadratures momenta"
                )
            self.space = StateAndParameters(cast("Any", symbolic), *self.parameters, units=self.scale[n:].tolist())
        self.functions = tuple(_function(symbolic, name) for name in observed.names)
        self.turns: Array = np.array([_turn_of(system, function) for function in self.functions])

    @property
    def numbers(self) -> Array:
        """The values that the system has for the unknown parameters."""
        values: Any = flattened(values_of(self.system))
        return np.array([float(values[name]) for name in self.parameters])

    def directions(self, run: int) -> Array:
        """The tangent vectors at the start of a run, one for each unknown, shape (unknown, component)."""
        n = len(self.system.component_names) + len(self.parameters)
        vectors = np.zeros((len(self.unknowns), n))
        for k, unknown in enumerate(self.unknowns):
            vectors[k, unknown.place] = unknown.run in (None, run)
        return vectors

    def starts(self, guess: Array, values: Array) -> Array:
        """The starts with the unknowns at these values, and the parameters behind them, shape (run, component)."""
        n = len(self.parameters)
        states = np.concatenate([guess, np.broadcast_to(values[:n], (len(guess), n))], axis=1)
        for unknown, value in zip(self.unknowns[n:], values[n:], strict=True):
            states[unknown.run, unknown.place] = value
        return states

    def prediction(self, states: Array, begins: Array, options: RunOptions) -> Prediction:
        """What the model says with these starts, and its derivatives.

        Args:
            states: With the parameters behind them, shape (run, component).
            begins: The time of each start.
            options: How it is integrated.
        """
        observed, m = self.observed, len(self.unknowns)
        value = np.full(observed.value.shape, np.nan)
        derivative = np.full((*observed.value.shape, m), np.nan)
        outcomes: list[str] = []
        for run in range(len(observed.runs)):
            rows = np.flatnonzero(observed.run == run)
            vectors = self.directions(run)
            state, tangent, outcome = self.orbit(
                states[run], vectors, begins[run], observed.time[rows], **options.inner()
            )
            value[rows], slopes = self.values(state), self._slopes(state)
            derivative[rows] = linear.matmul(slopes, np.swapaxes(tangent, -1, -2))
            outcomes.append(outcome)
        return Prediction(value, derivative, tuple(outcomes))

    def orbit(
        self, start: Array, vectors: Array, begin: float, times: Array, **options: Any
    ) -> tuple[Array, Array, str]:
        """States and tangent vectors at the times of a run, of which the first may be that of the start.

        The core has the parameters in units, powers of two, in which they are small beside the state: its norms are
        those of the state then, and the errors of the orbit those of the orbit alone.
        """
        grid = times if times[0] == begin else np.concatenate([[begin], times])
        if len(grid) == 1:
            return start[None], vectors[None], "finished"
        tangents = vectors if len(vectors) else None
        found = integrate(self.space, start / self.scale, times=grid, tangents=tangents, **options)
        first = len(grid) - len(times)
        own = np.array([self.scale[one.place] for one in self.unknowns[: len(vectors)]])
        tangent = found.tangent[0, first:] * self.scale / own[:, None]
        return found.state[0, first:] * self.scale, tangent, str(found.outcome[0])

    def values(self, states: Array) -> Array:
        """What would be observed at states with their parameters, shape (..., observable)."""
        with np.errstate(all="ignore"):
            return evaluated(self.space.variables, self.functions, states)

    def _slopes(self, states: Array) -> Array:
        with np.errstate(all="ignore"):
            values = evaluated(self.space.variables, self._derivatives, states)
        return values.reshape(*states.shape[:-1], len(self.functions), -1)

    @cached_property
    def _derivatives(self) -> tuple[Expr, ...]:
        functions: Any = self.functions
        return tuple(function.diff(x) for function in functions for x in self.space.variables)

    def residuals(self, value: Array) -> Array:
        """Model less observation; of an angle within half a turn.  NaN where a value is missing."""
        less = value - self.observed.value
        turns = np.where(np.isfinite(self.turns), self.turns, 1.0)
        return np.where(np.isfinite(self.turns), less - turns * np.round(less / turns), less)


def clock_of(system: EquationsOfMotion) -> int | None:
    """The place of the component that is time: a coordinate t whose rate is 1."""
    rates = {str(variable): rate for variable, rate in system.equations.items()}
    return list(rates).index("t") if rates.get("t") == 1 else None


def _units(numbers: Array, guess: Array) -> Array:
    """Powers of two in which numbers are a thousandth of the states."""
    size = np.abs(guess).sum(axis=1).mean() or 1.0
    return np.ldexp(1.0, np.frexp(_SMALLER * np.where(numbers == 0, 1.0, np.abs(numbers)) / size)[1])


def parts_of(system: EquationsOfMotion) -> dict[str, tuple[str, ...]]:
    """The names of numbers by what may be said for them: parameters, components, and vectors of either."""
    parts: dict[str, tuple[str, ...]] = {}
    for name, value in values_of(system).items():
        flat: dict[str, Any] = flattened({name: value})
        parts |= {name: tuple(flat), **{one: (one,) for one in flat}}
    names = system.component_names
    return parts | {name: tuple(names[k] for k in place) for name, place in component_places(system).items()}


_IN_THE_BRACKET = (
    " A number in the bracket is a parameter of the system if the bracket has a symbol for it and the system its "
    "value: make the bracket with symbols=[...] instead of parameters={...}, and give the value to System."
)


def _known(name: Any, parts: Mapping[str, tuple[str, ...]], *, has_bracket: bool) -> tuple[str, ...]:
    if not isinstance(name, str) or name not in parts:
        raise ParameterError(
            f"unknowns: wanted parameters and components of the start; got {shown(name)}. {did_you_mean(name, parts)}"
            f"Known: {', '.join(parts):.200}.{_IN_THE_BRACKET if has_bracket else ''}"
        )
    return parts[name]


def _function(system: EquationsOfMotion, name: str) -> Expr:
    """A column as a function of the state."""
    try:
        return system.expression(name)
    except LiePoissonError as error:
        why = error.message if isinstance(error, ExpressionError) else str(error)
        raise ParameterError(
            f"observations: wanted columns that are functions of the state; got {name!r:.80}: {why.rstrip('.')}. Say "
            "what it is, or which columns are compared: columns="
        ) from error


def _turn_of(system: EquationsOfMotion, function: Any) -> float:
    r"""By what an observed angle is known only up to multiples; infinite for other functions.

    A sum $\sum_k c_k\theta_k$ of angles of periods $P_k$ has the largest turn of which all $c_kP_k$ are multiples.
    """
    from sympy import atan2, expand

    from liepoisson.structure.circles import turn

    periods: dict[Any, Any] = {v: system.periods[str(v)] for v in system.variables if str(v) in system.periods}
    periods |= dict.fromkeys(function.atoms(atan2), turn())
    whole: Any = expand(function)
    turns: list[Any] = []
    for angle, period in periods.items():
        coefficient = whole.coeff(angle)
        if coefficient.free_symbols or (whole - coefficient * angle).expand().has(angle):
            return np.inf  # no multiple of the angle
        if coefficient != 0:
            turns.append(abs(coefficient * period))
    if not turns:
        return np.inf
    ratios: list[Any] = [one / turns[0] for one in turns]
    if not all(ratio.is_Rational for ratio in ratios):
        return np.inf
    parts = [Fraction(int(ratio.p), int(ratio.q)) for ratio in ratios]
    common = Fraction(gcd(*(part.numerator for part in parts)), lcm(*(part.denominator for part in parts)))
    return float(turns[0] * common.numerator / common.denominator)
